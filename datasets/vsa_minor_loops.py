"""Decaying and nested loops within the published loop, so that memory is tested."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .base import Dataset, DatasetSource, Recording
from .published_loop import lower_branch, upper_branch
from .trajectories import decaying, reversals
from .vsa_published import ANGLE_SIGMA, TORQUE_SIGMA

__all__ = ["STOP_THRESHOLDS", "STOP_WEIGHTS", "VsaMinorLoops", "minor_loop_plant"]

Floats = NDArray[np.float64]

STOP_THRESHOLDS = np.array([0.01, 0.025, 0.045, 0.075])
"""rad. Assumed: after a turn the last element slips again at twice the largest, the published transition's 0.15 rad."""

STOP_WEIGHTS = np.array([0.25, 0.25, 0.25, 0.25])
"""Shares of the half width of the loop. Assumed equal."""


@njit(cache=True)
def _stops(x, thresholds, weights, out):
    z = np.zeros(thresholds.size)
    last = 0.0
    for i in range(x.size):
        total = 0.0
        for j in range(z.size):
            z[j] = min(max(z[j] + x[i] - last, -thresholds[j]), thresholds[j])
            total += weights[j] * z[j] / thresholds[j]
        last = x[i]
        out[i] = total


def minor_loop_plant(time: Floats, x: Floats) -> Floats:
    """Torque, N·m, shape (n,): the loop's middle plus its half width times stop operators.

    y = M(x) + H(x) Σ w_i s_i / r_i with the mean M and the half difference H of the published branches and stop
    operators s_i of thresholds r_i. Its memory wipes out and minor loops close; it is none of the benchmarked models.
    """
    upper, lower = upper_branch(), lower_branch()
    on_upper, on_lower = (np.interp(x, branch[:, 0], branch[:, 1]) for branch in (upper, lower))
    # Beyond the published stroke both branches go on with the slope of the loop's end.
    for limit, slope in ((1.0, 8.4667), (-1.0, 8.8533)):
        beyond = np.maximum(np.sign(limit) * (x - limit), 0.0) * np.sign(limit) * slope
        on_upper, on_lower = on_upper + beyond, on_lower + beyond
    share = np.empty_like(x)
    _stops(np.ascontiguousarray(x), STOP_THRESHOLDS, STOP_WEIGHTS, share)
    return 0.5 * (on_upper + on_lower) + 0.5 * (on_upper - on_lower) * share


class VsaMinorLoops(DatasetSource):
    """Loops that shrink, and loops within loops, on the published loop's branches."""

    id: ClassVar[str] = "vsa-minor-loops"
    title: ClassVar[str] = "variable stiffness actuator, decaying and nested loops"
    summary: ClassVar[str] = "decaying and nested loops within the published one: tests memory"
    kind: ClassVar[str] = "synthetic"
    licence: ClassVar[str] = "facts from the paper; generated data CC0-1.0"

    def load(self) -> Dataset:
        motions = {
            "train": {
                "decaying from 1 to 0.1": decaying(1.0, 0.1, 14),
                "nested in the upper half": [0, 1, -1, 1, -0.2, 0.9, 0.1, 0.8, 0.3, 0.7, 0.5, 0.9, -1, 0.6, -0.6, 0.4],
                "nested in the lower half": [0, -1, 1, -1, 0.1, -0.8, -0.2, -0.7, -0.4, -0.6, -0.5, -0.9, 1, -0.5],
            },
            "test": {
                "decaying from 0.95 to 0.15, first down": [-p for p in decaying(0.95, 0.15, 12)],
                "nested, other turning points": [0, 1, -0.75, 0.85, -0.1, 0.65, 0.25, 0.55, 0.35, 0.75, -0.9, 0.5, -0.35],
                "first-order reversals": [0, 1, -0.8, 1, -0.5, 1, -0.15, 1, 0.3, 1, 0.6, 1, -1, 0.7, -1, 0.35, -1, -0.1],
            },
        }  # fmt: skip
        parts: dict[str, list[Recording]] = {}
        for part, named in motions.items():
            parts[part] = []
            rate = 100.0 if part == "train" else 95.0
            for name, points in named.items():
                time, x = reversals(points, speed=0.8, rate=rate)
                # Up to the first turn the motion is on the way from the unloaded start.
                warm_up = round(abs(points[1]) / 0.8 * rate)
                parts[part].append(Recording(name, time, x, minor_loop_plant(time, x), warm_up))
        return Dataset(
            id=self.id,
            title=self.title,
            train=parts["train"],
            test=parts["test"],
            split="Trained and tested on different turning points, nesting orders and first directions.",
            x_name="virtual deformation",
            x_unit="rad",
            y_name="torque",
            y_unit="N·m",
            source="branches from Qin et al., Tables 1 and 2; memory assumed",
            licence=self.licence,
            x_sigma=ANGLE_SIGMA,
            y_sigma=TORQUE_SIGMA,
            plant=minor_loop_plant,
            assumptions=(
                "The paper shows no minor loop. Between its two branches the torque is assumed to move by four stop "
                "operators with thresholds 0.01 to 0.075 rad, so that a turn takes the published 0.15 rad; this is "
                "none of the benchmarked models.",
                f"White sensor noise of {TORQUE_SIGMA} N·m and {ANGLE_SIGMA} rad, as in vsa-published.",
            ),
        )
