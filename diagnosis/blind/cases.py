"""The cases of the blind check."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .plants import EFFECTS, OUTSIDE, PLANTS, Case

__all__ = ["DEVELOPMENT_PLANTS", "TEST_PLANTS", "bank", "group"]

DEVELOPMENT_PLANTS = ("slip", "bouc-wen")
"""Every constant of the diagnosis was chosen on these."""
TEST_PLANTS = ("asymmetric",)
"""Only these are reported."""
RATIOS = (2.0, 4.0, 8.0, 16.0)
BASE_ERROR = 0.04


def bank(plants: Sequence[str], seeds: int, first_seed: int, every: int = 1) -> list[Case]:
    """All cases of a bank; ``every`` takes only each so-manieth of them.

    Each effect at four gap-to-noise ratios, each with the simulator's own parameters off as well, each withheld from
    the registry, pairs of effects, effects outside the registry, no effect at all, and a poor recording of
    each effect.
    """
    assert set(plants) <= set(PLANTS)
    cases: list[Case] = []
    effects = list(EFFECTS)

    def add(
        plant: str,
        names: tuple[str, ...],
        ratio: float,
        error: float = 0.0,
        excluded: tuple[str, ...] = (),
        motion: str = "",
    ) -> None:
        seed = first_seed + len(cases)
        usual = ("rich", "sweeps")[len(cases) % 2]
        cases.append(Case(plant, names, ratio, error, motion or usual, seed, excluded))

    for plant in plants:
        for repeat in range(seeds):
            rng = np.random.default_rng([first_seed, repeat, len(cases)])
            for name in effects:
                for ratio in RATIOS:
                    add(plant, (name,), ratio)
                add(plant, (name,), float(rng.choice(RATIOS[1:])), BASE_ERROR)
                add(plant, (name,), 8.0, excluded=(name,))
                other = str(rng.choice([e for e in effects if e != name]))
                add(plant, (name, other), float(rng.choice([4.0, 8.0])))
            for name in OUTSIDE:
                for ratio in RATIOS:
                    add(plant, (name,), ratio)
            for k in range(10):
                add(plant, (), 0.0, BASE_ERROR if k % 2 else 0.0)
            for name in effects:
                add(plant, (name,), 4.0, motion="one sine")
    return cases[:: max(every, 1)]


def group(case: Case) -> str:
    """The line of the table in which a case counts."""
    off = ", simulator off" if case.base_error else ""
    if case.motion == "one sine":
        return "a poor recording: one sine"
    if case.excluded:
        return "withheld from the registry"
    if not case.effects:
        return f"no effect{off}"
    if set(case.effects) & set(OUTSIDE):
        return "outside the registry"
    if len(case.effects) > 1:
        return "two effects"
    return f"one effect, gap/noise {case.ratio:g}" if not off else f"one effect{off}"
