"""Torque against deflection of a cycloidal robot actuator, output locked, from the vector figures of a thesis.

Measured: a 3D-printed cycloidal drive, output locked, motor torque ramped to and fro, deflection on the motor's side
referred to the output (Jelmer V., "Anti-Backlash Mechanisms for Cycloidal Drive Robotic Actuators: Design and
Evaluation", MSc thesis). Two prototypes: a baseline, new and after run-in, and one with a conic disk, new, after
run-in and with its preload raised in four steps; for each a small "play" loop (4 N·m) and a full "stiffness" loop.

The measured files are not in the repository: the mean loops are the lines of its SVG figures. Matplotlib writes a
line's vertices with six decimals, so data values follow from the places of the axis ticks to better than 1e-5 of the
range.

Defects and their handling:

- Matplotlib leaves out vertices that move a line by less than 1/9 point: the lines are exact to that tolerance, not
  sample by sample. The benchmark takes points along them at even nominal times.
- There is no time. It is rebuilt from the torque's nominal ramp rate (play 4 N·m/s, stiffness 8 N·m/s).
- Each line is a mean over 5 (play) or 3 (stiffness) ramps, so what differs between repetitions is gone; the steps that
  remain are the printed gear's.
- The torque is the motor's current times a constant, referred to the output; it is no torque sensor's.
- The third prototype's figure (split pinwheel) is not in the catalogue.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import ClassVar
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .base import Dataset, DatasetSource, Recording
from .recorded import until_first_turn
from .store import require

__all__ = ["Cycloidal", "loops"]

Floats = NDArray[np.float64]

FIGURES = {
    "baseline": "Test Scripts/figures/torque-displacement of Baseline.svg",
    "conic disk": "Test Scripts/figures/torque-displacement of Conic Disk.svg",
}
TESTS = {"Play tests": ("play", 4.0), "Stiffness tests": ("stiffness", 8.0)}
"""Title of the axes: name of the test, nominal ramp rate in N·m/s."""

TRAIN_STATES, TEST_STATES = (
    ("initial", "preload 25 %", "preload 75 %"),
    ("after run-in", "preload 50 %", "preload 100 %"),
)
STATES = {
    "initial": "initial", "after run-in": "after run-in", "preload increase 1": "preload 25 %",
    "preload increase 2": "preload 50 %", "preload increase 3": "preload 75 %", "preload increase 4": "preload 100 %",
}  # fmt: skip
"""Legend entry: state of the drive."""

POINTS = 400
TORQUE_TOLERANCE = 0.021
ANGLE_TOLERANCE = 9.4e-5
"""N·m and rad: 1/9 point of the conic disk's stiffness axes, by which a line may be off."""

NAMESPACES = {"svg": "http://www.w3.org/2000/svg"}


class Cycloidal(DatasetSource):
    """Conic disk: trained new and at two preloads, tested after run-in and at two other preloads."""

    id: ClassVar[str] = "cycloidal"
    title: ClassVar[str] = "cycloidal drive with backlash, locked output"
    summary: ClassVar[str] = (
        "recorded: mean torque-deflection loops of a cycloidal drive in six states of wear and preload"
    )
    kind: ClassVar[str] = "recorded"
    licence: ClassVar[str] = "CC-BY-SA-4.0"
    extended: ClassVar[bool] = True

    def recordings(self) -> dict[str, Recording]:
        """Every published mean loop, vertex by vertex.

        Raises
        ------
        DatasetUnavailableError
            If the files are not on this machine.
        """
        files = require(self.id)
        found = {}
        for prototype, path in FIGURES.items():
            for (test, rate), state, torque, degrees in loops(files[path]):
                # Vertices of equal torque would be simultaneous: they are told apart by the clock's last digits.
                steps = np.maximum(np.abs(np.diff(torque)), 1e-9)
                name = f"{prototype}, {test}, {state}"
                found[name] = until_first_turn(
                    Recording(
                        name,
                        np.concatenate([[0.0], np.cumsum(steps)]) / rate,
                        np.deg2rad(degrees),
                        torque,
                        conditions={"prototype": prototype, "test": test, "state": state, "rate": f"{rate:g} N·m/s"},
                    ),
                    0.5,
                )
        return found

    def load(self) -> Dataset:
        recordings = self.recordings()
        train, test = (
            [_even(recordings[f"conic disk, {test}, {state}"]) for state in states for test, _ in TESTS.values()]
            for states in (TRAIN_STATES, TEST_STATES)
        )
        return Dataset(
            id=self.id,
            title=self.title,
            train=train,
            test=test,
            split=(
                "Conic disk: trained new and at 25 and 75 % more preload, tested after run-in and at 50 and 100 % more; small "
                "and full loops in both."
            ),
            x_name="deflection",
            x_unit="rad",
            y_name="torque",
            y_unit="N·m",
            source="Jelmer V., MSc thesis; figures of JelmerV/Anti-Backlash-Cycloidal-Actuator",
            licence=self.licence,
            x_sigma=ANGLE_TOLERANCE,
            y_sigma=TORQUE_TOLERANCE,
            timed=False,
            assumptions=(
                "The loops are means over 3 or 5 ramps, taken from the lines of the published figures; the stated noise is the "
                "tolerance to which matplotlib simplifies such lines.",
                f"Time is rebuilt from the nominal ramp rates; {POINTS} points a loop are taken along the lines at even times.",
                "The torque was imposed and the deflection followed; the models are given the deflection.",
                "The play differs between states (by the figures 2.3° after run-in, 0.7 to 1.3° otherwise): what a model misses "
                "after run-in is mostly wear.",
                "Each loop is one cycle; scores begin at its first turn.",
            ),
        )


def _even(loop: Recording) -> Recording:
    """The loop at evenly spaced nominal times."""
    time = np.linspace(0.0, loop.time[-1], POINTS)
    return replace(
        loop,
        time=time,
        x=np.interp(time, loop.time, loop.x),
        y=np.interp(time, loop.time, loop.y),
        warm_up=int(np.searchsorted(time, loop.time[loop.warm_up])),
    )


def loops(figure: Path) -> list[tuple[tuple[str, float], str, Floats, Floats]]:
    """Test and ramp rate, state, torque (N·m) and deflection (°) of every line of a figure."""
    root = ElementTree.parse(figure).getroot()
    # The legend stands in the second axes only; colours are common to both.
    legend = _only(root, ".//svg:g[@id='legend_1']")
    texts = [_text(group) for group in _groups(legend, "text_")]
    colours = [_colour(_only(group, "svg:path")) for group in _groups(legend, "line2d_")]
    states = {colour: STATES[text] for colour, text in zip(colours, texts, strict=True)}
    found: list[tuple[tuple[str, float], str, Floats, Floats]] = []
    for axes in root.iterfind(".//svg:g", NAMESPACES):
        if not axes.get("id", "").startswith("axes_"):
            continue
        test = next(TESTS[_text(group)] for group in _groups(axes, "text_"))
        to_torque, to_degrees = _scale(axes, "xtick_", "x"), _scale(axes, "ytick_", "y")
        for group in _groups(axes, "line2d_"):
            path = _only(group, "svg:path")
            points = np.array(re.findall(r"[ML] (\S+) (\S+)", path.get("d", "")), dtype=np.float64)
            torque, degrees = points.T * [[to_torque[0]], [to_degrees[0]]] + [[to_torque[1]], [to_degrees[1]]]
            found.append((test, states[_colour(path)], torque, degrees))
    if len(found) != 2 * len(states):
        raise InputError(f"{figure}: {len(found)} lines, not {2 * len(states)}; fetch the file again")
    return found


def _only(parent: ElementTree.Element, path: str) -> ElementTree.Element:
    found = parent.find(path, NAMESPACES)
    if found is None:
        raise InputError(f"the figure has no {path}: it is not the published one; fetch it again")
    return found


def _groups(parent: ElementTree.Element, prefix: str) -> list[ElementTree.Element]:
    return [group for group in parent.iterfind("svg:g", NAMESPACES) if group.get("id", "").startswith(prefix)]


def _text(group: ElementTree.Element) -> str:
    """A group's text; LaTeX labels are written as \\ld{…}."""
    text = "".join(group.itertext()).strip()
    return text[4:-1] if text.startswith("\\ld{") else text


def _colour(path: ElementTree.Element) -> str:
    return path.get("style", "").partition("stroke: ")[2][:7]


def _scale(axes: ElementTree.Element, prefix: str, coordinate: str) -> Floats:
    """Slope and intercept from points of the page to data values, from the ticks of an axis."""
    places, values = [], []
    for tick in axes.iterfind(".//svg:g", NAMESPACES):
        if tick.get("id", "").startswith(prefix):
            places.append(float(_only(tick, ".//svg:use").get(coordinate, "")))
            values.append(float("".join(tick.itertext()).replace("−", "-")))
    return np.polyfit(places, values, 1)
