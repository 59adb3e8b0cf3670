"""Tables 1 to 5 of the first paper: printed beside recomputed, cell by cell."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...datasets.published_loop import (
    PRINTED_ELEMENTS,
    PRINTED_Q4_TORQUE,
    PRINTED_SLOPES,
    TABLE_4,
    TABLE_5,
    TRANSITION_NEG,
    TRANSITION_POS,
    VERTICES,
)
from .fits import Fits
from .loop import derived_limits, element_sum, printed_limits, stiffnesses
from .printed import TABLE_1_DECIMALS, TABLE_2_DECIMALS, TABLE_3_DECIMALS
from .rounding import half_step, interval, verdict

__all__ = ["METRICS", "Compared", "table_1", "table_2", "table_3", "table_4_and_5"]

Floats = NDArray[np.float64]
METRICS = ("mae", "mre", "rmse")
CLOSE = 1.1
SAME_SIZE = 2.0


@dataclass(frozen=True)
class Compared:
    """One cell of a table: ``printed`` is NaN where the paper has none."""

    table: int
    cell: str
    how: str
    unit: str
    printed: float
    recomputed: float
    ratio: float
    verdict: str


def _compared(table: int, cell: str, how: str, unit: str, printed: float, recomputed: float, said: str) -> Compared:
    ratio = recomputed / printed if printed else float("nan")
    return Compared(table, cell, how, unit, printed, recomputed, ratio, said)


def table_1() -> list[Compared]:
    """The twelve slopes from the twelve vertices, k_ij = (T_i − T_j)/(x_i − x_j)."""
    rows = []
    for name, printed in PRINTED_SLOPES.items():
        values, halves = [], []
        for vertex in name:
            x, torque = VERTICES[vertex]
            at_origin = vertex in "AG"
            decimals = 3 if vertex == "F" else TABLE_1_DECIMALS["x"]
            values += [x, torque]
            halves += [0.0, 0.0] if at_origin else [half_step(decimals), half_step(TABLE_1_DECIMALS["torque"])]
        # The ends of the stroke are printed as exactly ±1 and scale everything else.
        for k, vertex in enumerate(name):
            if vertex in "DJ":
                halves[2 * k] = 0.0

        def chord(x1: float, y1: float, x2: float, y2: float) -> float:
            return (y2 - y1) / (x2 - x1)

        recomputed = chord(*values)
        said = verdict(printed, TABLE_1_DECIMALS["slope"], recomputed, interval(chord, values, halves))
        label = {"CD": "K+ (CD)", "IJ": "K− (IJ)"}.get(name, f"k_{name}")
        rows.append(
            _compared(1, label, f"chord of {name[0]} and {name[1]}", "N·m/unit of x", printed, recomputed, said)
        )
    return rows


def table_2() -> list[Compared]:
    """The torques of Table 2: the ends from Table 1, the inner points from Table 3's elements through Eqs. 2 and 3."""
    rows = []
    for label, transition, marks, ends in (
        ("P", TRANSITION_POS, ("k", "eta"), ("C", "D")),
        ("Q", TRANSITION_NEG, ("k'", "eta'"), ("I", "J")),
    ):
        k, eta = (np.array(PRINTED_ELEMENTS[m]) for m in marks)
        sign = 1.0 if label == "P" else -1.0
        distance = np.abs(transition[:, 0] - transition[0, 0])
        built = transition[0, 1] + sign * element_sum(distance, k, eta)
        half = half_step(TABLE_2_DECIMALS["torque"])
        # Rounding of k over the distance, of x over the stiffness and of every limit.
        slack = sum(
            half_step(a) * distance + half_step(b)
            for a, b in zip(TABLE_3_DECIMALS[marks[0]], TABLE_3_DECIMALS[marks[1]], strict=True)
        )
        for i in range(transition.shape[0]):
            printed = float(transition[i, 1])
            if label == "Q" and i == 3:
                printed = PRINTED_Q4_TORQUE
            name = f"τ({label}{i + 1})"
            if i in (0, transition.shape[0] - 1):
                vertex = ends[0 if i == 0 else 1]
                torque = VERTICES[vertex][1]
                said = verdict(printed, TABLE_2_DECIMALS["torque"], torque, (torque - half, torque + half))
                rows.append(_compared(2, name, f"vertex {vertex} of Table 1", "N·m", printed, torque, said))
            if i > 0:
                allowed = (built[i] - slack[i] - 2 * half, built[i] + slack[i] + 2 * half)
                said = verdict(printed, TABLE_2_DECIMALS["torque"], float(built[i]), allowed)
                rows.append(
                    _compared(2, name, "elements of Table 3 by Eqs. 2, 3", "N·m", printed, float(built[i]), said)
                )
    return rows


def table_3() -> list[Compared]:
    """Table 2 → Table 3: stiffnesses by Eq. 16, limit torques by Eq. 17 as printed and as derived."""
    rows = []
    for transition, stiffness_mark, limit_mark in (
        (TRANSITION_POS, "k", "eta"),
        (TRANSITION_NEG, "k'", "eta'"),
    ):
        count = transition.shape[0] - 1
        half = np.tile([half_step(TABLE_2_DECIMALS["x"]), half_step(TABLE_2_DECIMALS["torque"])], count + 1)
        # The stroke's end is printed as exactly ±1.
        half[-2] = 0.0
        for mark, how, function, unit in (
            (stiffness_mark, "Eq. 16", stiffnesses, "N·m/unit of x"),
            (limit_mark, "Eq. 17 as printed", printed_limits, "N·m"),
            (limit_mark, "Eq. 17 as derived", derived_limits, "N·m"),
        ):
            for i in range(count):

                def value(*flat: float, i: int = i, function: Callable[[Floats], Floats] = function) -> float:
                    return float(function(np.reshape(flat, (-1, 2)))[i])

                recomputed = value(*transition.ravel())
                # Only the vertices that the figure depends on may move; the others stay.
                used = {0, i, i + 1, i + 2} if mark == limit_mark else {i, i + 1, i + 2}
                halves = [h if k // 2 in used else 0.0 for k, h in enumerate(half)]
                printed = PRINTED_ELEMENTS[mark][i]
                allowed = interval(value, list(transition.ravel()), halves)
                said = verdict(printed, TABLE_3_DECIMALS[mark][i], recomputed, allowed)
                name = mark.replace("eta", "η").replace("'", "′")
                name = f"{name[0]}{name[1:]}_{i + 1}"
                rows.append(_compared(3, name, how, unit, printed, recomputed, said))
    return rows


def table_4_and_5(fits: Fits) -> list[Compared]:
    """Errors of every registered model on the published loop, medians over the seeds, beside what the paper prints."""
    rows = []
    for table, task, printed_table, unit in ((4, "forward", TABLE_4, "N·m"), (5, "inverse", TABLE_5, "rad")):
        for model in fits.models:
            for metric in METRICS:
                recomputed = fits.median(model, task, metric)
                printed = printed_table.get(model, {}).get(metric, float("nan"))
                ratio = recomputed / printed
                if np.isnan(printed):
                    said = "not in the paper"
                elif np.isnan(recomputed):
                    said = "failed"
                elif max(ratio, 1.0 / ratio) <= CLOSE:
                    said = "within 10 %"
                elif max(ratio, 1.0 / ratio) <= SAME_SIZE:
                    said = "within a factor of 2"
                else:
                    said = "smaller" if ratio < 1.0 else "larger"
                rows.append(
                    Compared(
                        table,
                        f"{model} {metric.upper()}",
                        f"fitted and tested on vsa-published, condition {fits.condition}",
                        "1" if metric == "mre" else unit,
                        printed,
                        recomputed,
                        ratio,
                        said,
                    )
                )
    return rows
