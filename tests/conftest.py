"""Settings that all tests share."""

from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import HealthCheck, settings

# Numba compiles at the first call, so single examples may be slow; the same examples in every run keep CI steady.
settings.register_profile(
    "hystbench", max_examples=25, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("hystbench")

COUNTED_ELSEWHERE = {
    "test_cli_fuzz", "test_interruption", "test_laws", "test_model_contract",
    *(
        f"test_diagnosis_{name}"
        for name in (
            "ambiguity", "another_motion", "corrected", "counted", "elements", "fitted_models", "formulas", "inside_the_joint",
            "laws", "long_recordings", "noise", "operators_of_matter", "other_hands", "own_parts", "passing_for_noise",
            "precision", "refitting", "several_effects", "several_recordings", "simulator_off", "softening", "verdicts",
            "withheld",
        )
    ),
}  # fmt: skip
"""Modules that compute for long through code that the others go through as well."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--thorough", action="store_true", help="run every case, also of tests that are marked `thorough`")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    # Counting statements would take a sixth to a third of their time.
    for item in items:
        if item.path.stem in COUNTED_ELSEWHERE:
            item.add_marker(pytest.mark.no_cover)
    # A test that is asked for by its name runs.
    if not (config.getoption("--thorough") or any("::" in argument for argument in config.args)):
        _leave_to_thorough(config, items)


def _leave_to_thorough(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Take out what is marked ``thorough``, but every so-manieth case of a test that is marked ``thorough(but_one_in=…)``."""
    cases: Counter[str] = Counter()
    left: list[pytest.Item] = []
    for item in items:
        if marker := item.get_closest_marker("thorough"):
            test = item.nodeid.split("[")[0]
            one_in = marker.kwargs.get("but_one_in")
            if one_in is None or cases[test] % one_in:
                left.append(item)
            cases[test] += 1
    config.hook.pytest_deselected(items=left)
    gone = set(left)
    items[:] = [item for item in items if item not in gone]
