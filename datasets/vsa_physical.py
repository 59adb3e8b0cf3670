"""An independent synthetic actuator: the paper's geometry with a viscoelastic belt and dry friction.

Geometry (Qin et al., appendix A.1-A.4, A.9): a branch is a triangle with crank l1, link l3 and belt length l2 opposite
the deflection θ, l2² = l1² + l3² − 2 l1 l3 cos θ. At θ = 0 the belt is shortest, l2 = l3 − l1, so the closed belt is
longer by δ = 2 (l1 + l2 − l3) >= 0 for any θ, and its lever arm is J = dl2/dθ = l1 l3 sin θ / l2.

Belt: preload F0, an elastic spring k and two Maxwell branches (generalised standard linear solid); each branch force
obeys df/dt = k_i dδ/dt − f/τ_i, solved exactly for a δ that is linear between samples.

Friction: each belt runs over two pulleys; dry friction there is proportional to the belt force and builds up over a
presliding angle θ_b: ds/dθ = (1 − s sgn dθ) / θ_b, solved exactly; torque μ r s F at each pulley.

None of the benchmarked models has these equations: the loop depends on rate, and its width on the load.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .base import Dataset, DatasetSource, Recording
from .trajectories import sines
from .vsa_published import ANGLE_SIGMA, TORQUE_SIGMA

__all__ = ["CONSTANTS", "VsaPhysical", "physical_plant"]

Floats = NDArray[np.float64]

CONSTANTS = {
    "branches": 6.0,  # the paper's N
    "preload_n": 5.0,  # the paper's
    "crank_m": 0.020,  # l1, assumed
    "link_m": 0.045,  # l3, assumed
    "belt_stiffness_n_m": 1050.0,  # assumed: polyurethane of 3 mm diameter, about 0.1 m long
    "branch_1_stiffness_n_m": 230.0,  # assumed
    "branch_1_time_s": 0.25,  # assumed
    "branch_2_stiffness_n_m": 180.0,  # assumed
    "branch_2_time_s": 4.0,  # assumed
    "friction_arm_m": 6e-4,  # μ r: 0.15 on a pulley bearing of 4 mm, assumed
    "presliding_rad": 0.03,  # θ_b, assumed
}
"""Constants of the plant. With them the torque at 1 rad and the loop's width are of the published loop's size."""


@njit(cache=True)
def _simulate(time, theta, c, out):
    branches, preload, l1, l3, k, k1, tau1, k2, tau2, arm, presliding = c
    force_1 = force_2 = bristle = 0.0
    last_stretch = last_theta = 0.0
    for i in range(theta.size):
        l2 = np.sqrt(l1 * l1 + l3 * l3 - 2.0 * l1 * l3 * np.cos(theta[i]))
        stretch = 2.0 * (l1 + l2 - l3)
        lever = l1 * l3 * np.sin(theta[i]) / l2
        # The first sample is reached from rest at θ = 0 within one ordinary step.
        step = time[i] - time[i - 1] if i > 0 else (time[1] - time[0] if time.size > 1 else 1.0)
        rise = stretch - last_stretch
        decay_1, decay_2 = np.exp(-step / tau1), np.exp(-step / tau2)
        force_1 = force_1 * decay_1 + k1 * tau1 / step * (1.0 - decay_1) * rise
        force_2 = force_2 * decay_2 + k2 * tau2 / step * (1.0 - decay_2) * rise
        moved = theta[i] - last_theta
        towards = 1.0 if moved > 0.0 else -1.0
        bristle = towards + (bristle - towards) * np.exp(-abs(moved) / presliding)
        force = max(preload + k * stretch + force_1 + force_2, 0.0)
        out[i] = branches * force * (lever + 2.0 * arm * bristle)
        last_stretch = stretch
        last_theta = theta[i]


def physical_plant(time: Floats, x: Floats) -> Floats:
    """Torque of the plant, N·m, shape (n,), from rest, for the deflection ``x`` in rad at ``time`` in s."""
    y = np.empty_like(x)
    _simulate(np.ascontiguousarray(time), np.ascontiguousarray(x), np.array(list(CONSTANTS.values())), y)
    return y


class VsaPhysical(DatasetSource):
    """Sines of several amplitudes and rates on the physical plant."""

    id: ClassVar[str] = "vsa-physical"
    title: ClassVar[str] = "variable stiffness actuator from geometry, viscoelasticity and friction"
    summary: ClassVar[str] = "independent plant: belt geometry, viscoelastic belt, load-dependent friction"
    kind: ClassVar[str] = "synthetic"
    licence: ClassVar[str] = "CC0-1.0"

    def load(self) -> Dataset:
        motions = {
            "train": ([1.0, 0.7, 0.4, 1.0, 0.2], [0.25, 0.5, 0.25, 0.5, 0.5], [3, 4, 3, 3, 4]),
            "test": ([0.9, 0.55, 0.3, 0.8, 0.95], [0.35, 0.8, 0.4, 0.15, 0.6], [3, 5, 3, 2, 4]),
        }
        recordings = {}
        for part, (amplitudes, frequencies, cycles) in motions.items():
            time, x = sines(amplitudes, frequencies, cycles, rate=80.0)
            # The first half cycle leads from rest onto the loop.
            warm_up = round(0.5 / frequencies[0] * 80.0)
            told = ", ".join(f"{a:g} rad at {f:g} Hz" for a, f in zip(amplitudes, frequencies, strict=True))
            recordings[part] = [Recording(told, time, x, physical_plant(time, x), warm_up)]
        return Dataset(
            id=self.id,
            title=self.title,
            train=recordings["train"],
            test=recordings["test"],
            split="Trained on 0.2 to 1 rad at 0.25 and 0.5 Hz, tested on other amplitudes at 0.15 to 0.8 Hz.",
            x_name="deflection",
            x_unit="rad",
            y_name="torque",
            y_unit="N·m",
            source="geometry of Qin et al., appendix A.1-A.9; belt and friction laws are this project's",
            licence=self.licence,
            x_sigma=ANGLE_SIGMA,
            y_sigma=TORQUE_SIGMA,
            plant=physical_plant,
            assumptions=(
                "The paper gives no lengths or belt data; they are assumed such that the torque at 1 rad and the "
                "loop's width are of the published size: "
                + ", ".join(f"{name} = {value:g}" for name, value in CONSTANTS.items()),
                "Elongation is read as 2 (l1 + l2 − l3), which is zero at rest and grows with |θ|.",
                f"White sensor noise of {TORQUE_SIGMA} N·m and {ANGLE_SIGMA} rad, as in vsa-published.",
            ),
        )
