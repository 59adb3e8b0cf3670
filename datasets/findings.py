"""What an inspection found, in words, and which models it leaves.

Each finding is judged: ``good``, ``note`` (know it), ``warn`` (it will show in the errors) or ``unknown`` (the recording
cannot tell; the text says what would).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .column_roles import quantity
from .inspection import Estimate, Inspection
from .loops import Loop

__all__ = ["Applicability", "Finding", "applicable_models", "findings"]

NEGLIGIBLE = 0.05
"""Effects on the loops below this share are not warned of, however significant they are."""

NOTABLE_GAP = 0.02
NO_LOOP = 0.005
"""Mean distance of the branches, as a share of the output's range, that counts as none."""

SYMMETRIC = 0.05
CROSSING = 0.1
PINCHED = 0.7
STEPS_IN_RANGE = 256
SAMPLES_IN_HALF_CYCLE = 20


@dataclass(frozen=True)
class Finding:
    """One line of the result: what it is about, how it is judged, and the figures."""

    subject: str
    judged: str
    text: str


@dataclass(frozen=True)
class Applicability:
    """Whether a model can follow what was found: ``yes``, ``partly`` or ``no``, and why."""

    model: str
    judged: str
    why: str


def findings(
    inspection: Inspection, x_column: str, y_column: str, notes: Sequence[str] = (), untimed: str = ""
) -> list[Finding]:
    """Everything worth saying of a recording, in a fixed order.

    Parameters
    ----------
    inspection : Inspection
    x_column, y_column : str
        Column names, from which units are read.
    notes : sequence of str
        What the reader of the file had to assume of the columns.
    untimed : str
        What it had to assume of the sample times where the file has none.
    """
    x_unit, y_unit = quantity(x_column)[1], quantity(y_column)[1]
    return [
        *(Finding("file", "note", note) for note in (*notes, untimed) if note),
        *_sampling(inspection, numbered=bool(untimed)),
        *_units(inspection, x_column, y_column),
        *_channels(inspection, x_unit, y_unit),
        *_turns(inspection, x_unit),
        *_loops(inspection, x_unit, y_unit),
        *_memory(inspection),
        *_dependence(inspection),
    ]


def _figure(value: float, unit: str = "") -> str:
    return f"{value:.3g} {unit}".rstrip()


def _percent(estimate: Estimate) -> str:
    return f"{estimate.value:+.1%} (95 %: {estimate.low:+.1%} to {estimate.high:+.1%}, {estimate.n} loops)"


def _sampling(found: Inspection, numbered: bool) -> list[Finding]:
    s = found.sampling
    if numbered:
        told = [Finding("sampling", "note", f"{s.samples} samples without times: rates below are per sample")]
    else:
        jitter = f"jitter {s.jitter:.1%}" if s.jitter >= 0.001 else "even"
        judged = "note" if s.jitter > 0.05 else "good"
        text = f"{s.samples} samples over {_figure(s.duration, 's')}, {_figure(1.0 / s.interval)} a second, {jitter}"
        told = [Finding("sampling", judged, text)]
    if s.gaps:
        longest = max(s.gaps, key=lambda gap: gap.length)
        text = (
            f"{len(s.gaps)} of more than three intervals, the longest {_figure(longest.length, 's')} at "
            f"{_figure(longest.at, 's')}: memory may change unseen there"
        )
        told.append(Finding("gaps", "warn", text))
    return told


def _units(found: Inspection, x_column: str, y_column: str) -> list[Finding]:
    told = []
    for column, signal in ((x_column, found.x), (y_column, found.y)):
        name, unit = quantity(column)
        largest = max(abs(signal.low), abs(signal.high))
        if not unit:
            told.append(Finding("units", "note", f"{column}: none in its name; nothing is converted"))
        elif unit == "rad" and largest > 4.0 * np.pi:
            text = f"{column}: up to {_figure(largest)} rad is {largest / (2.0 * np.pi):.0f} revolutions; are these degrees?"
            told.append(Finding("units", "warn", text))
        elif unit == "°" and signal.span < 0.5:
            text = f"{column}: {_figure(signal.span)}° in all is little; are these radians ({_figure(np.rad2deg(signal.span))}°)?"
            told.append(Finding("units", "warn", text))
        else:
            told.append(Finding("units", "good", f"{column}: taken as {name} in {unit}"))
    return told


def _channels(found: Inspection, x_unit: str, y_unit: str) -> list[Finding]:
    told = []
    for axis, signal, unit in (("x", found.x, x_unit), ("y", found.y, y_unit)):
        share = signal.noise / signal.span if signal.span > 0.0 else 0.0
        text = (
            f"{_figure(signal.low)} to {_figure(signal.high, unit)}; white noise {_figure(signal.noise, unit)} "
            f"({share:.2%} of the range)"
        )
        told.append(Finding(f"{axis} range", "warn" if share > 0.02 else "good", text))
        if signal.quantum is not None:
            coarse = signal.quantum > 2.0 * signal.noise
            steps = signal.span / signal.quantum
            text = f"steps of {_figure(signal.quantum, unit)}, {steps:.0f} over the range, "
            text += "coarser than the noise" if coarse else "hidden by the noise"
            judged = "warn" if steps < STEPS_IN_RANGE else "note" if coarse else "good"
            told.append(Finding(f"{axis} quantisation", judged, text))
    return told


def _turns(found: Inspection, x_unit: str) -> list[Finding]:
    c = found.coverage
    false = c.raw_turns - c.turns
    text = f"{c.turns} turns of more than {_figure(c.dead_band, x_unit)}"
    text += f"; {false} further changes of sign are noise: decide direction with a dead band" if false else ""
    told = [Finding("reversals", "note" if false else "good", text)]
    inner = c.swings[1:-1] if c.swings.size > 2 else c.swings
    speeds = c.speeds[1:-1] if c.speeds.size > 2 else c.speeds
    levels = _levels(inner, 0.05 * found.x.span)
    text = f"half cycles of {_figure(float(inner.min()))} to {_figure(float(inner.max()), x_unit)}, {levels} different sizes"
    text += "" if levels > 1 else ": nothing is learnt of other amplitudes"
    told.append(Finding("amplitudes", "good" if levels > 2 else "note", text))
    ratio = float(speeds.max() / speeds.min())
    unit = f"{x_unit}/s".lstrip("/") if x_unit else "a second"
    text = f"mean speeds of {_figure(float(speeds.min()))} to {_figure(float(speeds.max()), unit)} (1 : {ratio:.3g})"
    told.append(Finding("rates", "good" if ratio > 2.0 else "note", text))
    per_half = found.sampling.samples / max(c.turns + 1, 1)
    if per_half < SAMPLES_IN_HALF_CYCLE:
        told.append(Finding("resolution", "warn", f"only {per_half:.0f} samples a half cycle: turns are cut off"))
    return told


def _levels(values: np.ndarray, apart: float) -> int:
    ordered = np.sort(values)
    return 1 + int(np.count_nonzero(np.diff(ordered) > apart))


def _loops(found: Inspection, x_unit: str, y_unit: str) -> list[Finding]:
    main = found.main_loops
    if not main:
        text = "none: the input must turn twice; without that direction, width and memory cannot be seen"
        return [Finding("loops", "unknown", text)]
    area = float(np.mean([loop.area for loop in main]))
    width = float(np.mean([loop.half_width for loop in main]))
    rng = float(np.mean([loop.range for loop in main]))
    told = []
    if found.loops:
        nested = sum(loop.nested for loop in found.loops)
        told.append(
            Finding("loops", "good", f"{len(found.loops)} closed by the input, {nested} of them within larger ones")
        )
        gap = found.closing
        if gap is not None:
            open_ = gap.excludes_zero and abs(gap.value) > NOTABLE_GAP
            text = f"output on return {_percent(gap)} of its range from where it was"
            told.append(Finding("closing", "warn" if open_ else "good", text))
    else:
        told.append(Finding("loops", "note", "none is closed: the input never comes back to a turn"))
    if _flat(found, main):
        told.append(Finding("hysteresis", "note", "no loop beyond the noise: a curve without memory may do"))
    else:
        sense = "clockwise (it dissipates, as force against displacement does)" if area > 0.0 else "counter-clockwise"
        mixed = sum(np.sign(loop.area) != np.sign(area) for loop in main)
        text = (
            f"{sense}; ∮ y dx = {_figure(area, f'{y_unit} {x_unit}'.strip())}, half width {_figure(abs(width), y_unit)}"
        )
        text += f" ({abs(width) / rng:.1%} of the loops' output range)"
        text += f"; {mixed} of {len(main)} the other way round" if mixed else ""
        told.append(Finding("sense", "warn" if mixed else "good", text))
        crossing = float(np.mean([loop.crossing for loop in main]))
        if crossing > CROSSING:
            text = f"branches cross: {crossing:.0%} of the area runs the other way round (a butterfly)"
            told.append(Finding("crossing", "warn", text))
        waist = float(np.mean([loop.waist for loop in main]))
        if crossing <= CROSSING and waist < PINCHED:
            text = f"the loop is {waist:.0%} as wide in its middle as towards its ends"
            told.append(Finding("pinching", "warn", text))
        asymmetry = float(np.mean([loop.asymmetry for loop in main]))
        text = f"branches differ by {asymmetry:.1%} of the output range from being turned by half a turn"
        told.append(Finding("symmetry", "note" if asymmetry > SYMMETRIC else "good", text))
    return told


def _flat(found: Inspection, main: Sequence[Loop]) -> bool:
    """Whether the branches, meant over the main loops, are no further apart than noise makes them."""
    apart = float(np.mean(np.abs(np.mean([loop.down - loop.up for loop in main], axis=0))))
    samples = sum(loop.end - loop.start for loop in main) / (2.0 * main[0].up.size)
    noise = found.y.noise / np.sqrt(max(samples, 1.0))
    return apart < max(3.0 * noise, NO_LOOP * float(np.mean([loop.range for loop in main])))


def _memory(found: Inspection) -> list[Finding]:
    told = []
    wiped = found.wiping_out
    if wiped is None:
        text = "fewer than two loops within larger ones: cannot be tested; turn back in mid-stroke and go on"
        told.append(Finding("wiping-out", "unknown", text))
    else:
        text = f"after a smaller loop the output is {_percent(wiped)} of its range from where the loop began"
        told.append(Finding("wiping-out", "warn" if _breaks_wiping_out(found) else "good", text))
    equal = found.congruency
    if equal is None:
        text = "no equal loops with different histories: cannot be tested; repeat a small loop on both branches"
        told.append(Finding("congruency", "unknown", text))
    else:
        d = equal.defect
        text = (
            f"equal loops with other histories differ in shape by {d.value:.1%} of their range (95 %: {d.low:.1%} to "
            f"{d.high:.1%}, {d.n} pairs); repeats by {equal.repeats:.1%}"
        )
        told.append(Finding("congruency", "warn" if _breaks_congruency(found) else "good", text))
    return told


def _dependence(found: Inspection) -> list[Finding]:
    told = []
    if found.rate_width is None or found.rate_stiffness is None:
        text = (
            "no three loops between the same inputs at different speeds: cannot be told; repeat a cycle at other rates"
        )
        told.append(Finding("rate dependence", "unknown", text))
    else:
        text = (
            f"1 : {found.speed_ratio:.2g} in speed changes the width by {_percent(found.rate_width)}, the height by "
            f"{_percent(found.rate_stiffness)}"
        )
        told.append(Finding("rate dependence", "warn" if _depends_on_rate(found) else "good", text))
    if found.drift is None:
        text = "fewer than four loops between the same inputs: cannot be told; repeat one cycle"
        told.append(Finding("drift", "unknown", text))
        return told
    for subject, estimate, what in (
        ("drift", found.drift, "the level moves by {} of the loops' range from the first to the last"),
        ("softening", found.softening, "the height changes by {} of their range"),
        ("narrowing", found.narrowing, "the area changes by {}"),
    ):
        if estimate is not None:
            told.append(Finding(subject, "warn" if _matters(estimate) else "good", what.format(_percent(estimate))))
    return told


# ---- judgements ----------------------------------------------------------------------------------------------------


def _matters(estimate: Estimate | None) -> bool:
    return estimate is not None and estimate.excludes_zero and abs(estimate.value) > NEGLIGIBLE


def _breaks_wiping_out(found: Inspection) -> bool:
    wiped = found.wiping_out
    return wiped is not None and wiped.excludes_zero and abs(wiped.value) > NOTABLE_GAP


def _breaks_congruency(found: Inspection) -> bool:
    equal = found.congruency
    return equal is not None and equal.defect.low > max(NEGLIGIBLE, 2.0 * equal.repeats)


def _depends_on_rate(found: Inspection) -> bool:
    return _matters(found.rate_width) or _matters(found.rate_stiffness)


# ---- models --------------------------------------------------------------------------------------------------------

ASSUMES = {
    "linear": ("no memory",),
    "elastic": ("no memory",),
    "cubic": ("one amplitude",),
    "choi-backlash": ("closing",),
    "bouc-wen": ("symmetry", "one sense", "no waist"),
    "bouc-wen-baber-noori": ("one sense",),
    "dahl": ("symmetry", "one sense", "no waist"),
    "duhem": ("one sense",),
    "lugre": ("symmetry", "one sense", "no waist"),
    "prandtl-ishlinskii": ("symmetry", "one sense", "no waist", "wiping-out", "congruency", "closing"),
    "modified-prandtl-ishlinskii": ("one sense", "wiping-out", "closing"),
    "generalized-maxwell-slip": ("symmetry", "one sense", "no waist"),
    "maxwell-slip": ("one sense", "wiping-out", "closing"),
    "preisach": ("wiping-out", "congruency", "closing"),
}
"""What each model takes for granted. A plug-in says so itself: a class attribute ``assumes`` with any of these words."""


def applicable_models(found: Inspection) -> list[Applicability]:
    """For every model that stands for itself whether what it takes for granted was found in the recording."""
    from .. import models

    return [_judge(found, name, models.get(name)) for name in models.benchmarked_ids()]


def _judge(found: Inspection, name: str, cls: Any) -> Applicability:
    if found.x.span == 0.0 or found.sampling.samples < getattr(cls, "minimum_samples", 0):
        return Applicability(name, "no", "the input is constant, or there are too few samples")
    assumed = getattr(cls, "assumes", ASSUMES.get(name, ()))
    main = found.main_loops
    flat = not main or _flat(found, main)
    if "no memory" in assumed:
        if flat:
            return Applicability(name, "yes", "no loop beyond the noise was found")
        return Applicability(name, "no", "it has no memory, and there is a loop")
    broken = [what for word, holds, what in _conditions(found, main, flat) if word in assumed and not holds]
    still = getattr(cls, "rate_independent", True)
    if still and _depends_on_rate(found):
        broken.append("the loops depend on the rate, which it cannot follow")
    if broken:
        return Applicability(name, "partly", "; ".join(broken))
    tests = {"wiping-out": found.wiping_out, "congruency": found.congruency, "closing": found.drift}
    untested = [word for word, estimate in tests.items() if word in assumed and estimate is None]
    untested += ["rate"] if still and found.rate_width is None else []
    why = "nothing found speaks against it"
    return Applicability(name, "yes", f"{why}; not tested: {', '.join(untested)}" if untested else why)


def _conditions(found: Inspection, main: Sequence[Loop], flat: bool) -> list[tuple[str, bool, str]]:
    """What models may assume: the word, whether it holds as far as the recording tells, and what to say if not."""
    inner = found.coverage.swings[1:-1] if found.coverage.swings.size > 2 else found.coverage.swings
    mean = {}
    for key in ("asymmetry", "crossing", "waist"):
        mean[key] = float(np.mean([getattr(loop, key) for loop in main])) if main else 0.0
    drifting = _matters(found.drift) or _matters(found.softening) or _matters(found.narrowing)
    return [
        ("symmetry", flat or mean["asymmetry"] <= SYMMETRIC, "it makes symmetric loops only, these are not"),
        ("one sense", flat or mean["crossing"] <= CROSSING, "the branches cross, its own do not"),
        ("no waist", flat or mean["waist"] >= PINCHED, "the loops are pinched, which it follows poorly"),
        (
            "one amplitude",
            _levels(inner, 0.05 * found.x.span) == 1,
            "it has one curve a direction, and amplitudes differ",
        ),
        ("wiping-out", not _breaks_wiping_out(found), "smaller loops leave a trace, which it wipes out"),
        ("congruency", not _breaks_congruency(found), "equal loops differ with their history, its own are congruent"),
        ("closing", not drifting, "the loops change from cycle to cycle, its own repeat"),
    ]
