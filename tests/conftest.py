"""Settings that all tests share."""

from __future__ import annotations

from hypothesis import HealthCheck, settings

# Numba compiles at the first call, so single examples may be slow; the same examples in every run keep CI steady.
settings.register_profile(
    "hystbench", max_examples=25, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("hystbench")
