"""Settings that all tests share."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, settings

# Numba compiles at the first call, so single examples may be slow; the same examples in every run keep CI steady.
settings.register_profile(
    "hystbench", max_examples=25, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("hystbench")

COUNTED_ELSEWHERE = {
    f"test_diagnosis_{name}"
    for name in (
        "counted", "elements", "fitted_models", "inside_the_joint", "laws", "long_recordings", "other_hands", "own_parts",
        "refitting", "several_effects", "simulator_off", "softening", "verdicts", "withheld",
    )
}  # fmt: skip
"""Modules that compute for long through code that the others go through as well."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    # Counting statements would take a sixth of their time.
    for item in items:
        if item.path.stem in COUNTED_ELSEWHERE:
            item.add_marker(pytest.mark.no_cover)
