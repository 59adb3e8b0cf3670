"""The tests' own joints are what they say."""

from __future__ import annotations

import numpy as np
from hardening_joint import rich_motion
from joints import clearance


def test_clearance_in_series_with_a_spring_is_a_dead_zone() -> None:
    _, x = rich_motion()
    inner = x - np.clip(x, -0.1, 0.1)
    across = clearance(x, inner, 0.1)
    away = np.abs(inner) > 0.02
    assert np.allclose((x - across)[away], inner[away], atol=1e-9)
    assert np.all(np.abs(across) <= 0.1)
