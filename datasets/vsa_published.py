"""The loop that Tables 1 and 2 of the first source paper determine."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from .base import Dataset, DatasetSource, Recording
from .published_loop import ASCENDING, DESCENDING, TRANSITION_NEG, TRANSITION_POS
from .trajectories import reversals

__all__ = ["ANGLE_SIGMA", "TORQUE_SIGMA", "VsaPublished", "published_plant"]

TORQUE_SIGMA = 0.02
"""N·m. Assumed: 0.1 % of the 20 N·m full scale of the torque sensor that the paper names (Forsentek FTE-20)."""

ANGLE_SIGMA = 1e-3
"""rad. Assumed: about one step of a 12-bit turn (1.5 mrad) of the non-contact angle sensor that the paper names."""

Floats = NDArray[np.float64]


def published_plant(time: Floats, x: Floats) -> Floats:
    """Torque of the published loop, N·m, shape (n,); transitions within the loop by Eqs. 11-17."""
    # Imported here so that listing datasets does not compile kernels.
    from ..models.maxwell_slip import MaxwellSlip

    return MaxwellSlip.from_parameters(
        ascending=ASCENDING, descending=DESCENDING, transition_pos=TRANSITION_POS, transition_neg=TRANSITION_NEG
    ).predict(x)


class VsaPublished(DatasetSource):
    """Full-stroke cycles of the published loop at constant speed; the paper's start in A = (0, 0)."""

    id: ClassVar[str] = "vsa-published"
    title: ClassVar[str] = "variable stiffness actuator, the loop of Tables 1 and 2"
    summary: ClassVar[str] = "the source paper's published loop at full stroke, with assumed sensor noise"
    kind: ClassVar[str] = "synthetic"
    licence: ClassVar[str] = "facts from the paper; generated data CC0-1.0"

    def load(self) -> Dataset:
        cycle = [1.0, -1.0]
        train_time, train_x = reversals([0.0, *cycle * 4, 0.0], speed=0.8, rate=200.0)
        test_time, test_x = reversals([0.0, *cycle * 3, 0.0], speed=0.5, rate=150.0, shift=0.37)
        # Scores begin at the first top: on the way there the motion is not yet on the closed loop.
        return Dataset(
            id=self.id,
            title=self.title,
            train=[Recording("0.8 rad/s", train_time, train_x, published_plant(train_time, train_x), 250)],
            test=[Recording("0.5 rad/s", test_time, test_x, published_plant(test_time, test_x), 300)],
            split="Trained on four cycles at 0.8 rad/s, tested on three other cycles at 0.5 rad/s with other sampling points.",
            x_name="virtual deformation",
            x_unit="rad",
            y_name="torque",
            y_unit="N·m",
            source="Qin et al., Tables 1 and 2",
            licence=self.licence,
            x_sigma=ANGLE_SIGMA,
            y_sigma=TORQUE_SIGMA,
            plant=published_plant,
            assumptions=(
                f"The paper gives no noise: white noise of {TORQUE_SIGMA} N·m (0.1 % of the named torque sensor's "
                f"20 N·m) and {ANGLE_SIGMA} rad (a 12-bit angle sensor) is assumed.",
                "The paper tabulates the loop over the virtual deformation x from -1 to 1 and plots it in rad; x is "
                "taken as the measured input, in rad.",
                "Q4's torque is printed as +5.62 and used as -5.62.",
                "These data are of the maxwell-slip model's own kind: its score here measures identification and "
                "noise, not how well it describes a real actuator. vsa-physical and the recorded loops do that.",
            ),
        )
