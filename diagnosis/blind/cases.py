"""The cases of the blind check."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec

import numpy as np

from . import plants, varied_plant
from .plant import BASE_ERROR, Case
from .plants import MUJOCO, PLANTS, VARIED

__all__ = ["DEVELOPMENT_PLANTS", "TEST_PLANTS", "available", "bank", "effects_of", "group", "outside_of", "quick_part"]

DEVELOPMENT_PLANTS = ("slip", "bouc-wen", VARIED)
"""Every constant of the diagnosis was chosen on these."""
TEST_PLANTS = ("asymmetric", MUJOCO)
"""Only these are reported."""
RATIOS = (2.0, 4.0, 8.0, 16.0)
WITHOUT = 30
"""Recordings without an effect of each plant; every third has a badly calibrated simulator."""
USUAL = ("rich", "sweeps")
SINE = "one sine"


def available(names: Sequence[str] = TEST_PLANTS) -> tuple[str, ...]:
    """Those of the plants that can be run here: MuJoCo is an optional dependency."""
    return tuple(name for name in names if name != MUJOCO or find_spec("mujoco") is not None)


def effects_of(plant: str) -> tuple[str, ...]:
    """Ids of the registry's effects that the plant can have."""
    if plant == MUJOCO:
        from . import mujoco_plant

        return tuple(mujoco_plant.EFFECTS)
    if plant == VARIED:
        return tuple(varied_plant.LAWS)
    return tuple(plants.EFFECTS)


def outside_of(plant: str) -> tuple[str, ...]:
    """Names of the plant's effects that no entry of the registry describes."""
    if plant == MUJOCO:
        from . import mujoco_plant

        return tuple(mujoco_plant.OUTSIDE)
    if plant == VARIED:
        return tuple(varied_plant.OUTSIDE)
    return tuple(plants.OUTSIDE)


def bank(names: Sequence[str], seeds: int, first_seed: int) -> list[Case]:
    """All cases of a bank on the named plants.

    Each effect at four gap-to-noise ratios, each with the simulator's own parameters off as well, each withheld from
    the registry, pairs of effects, effects outside the registry, no effect at all, and a poor recording of
    each effect.
    """
    assert set(names) <= {*PLANTS, MUJOCO, VARIED}
    cases: list[Case] = []

    def add(
        plant: str,
        effects: tuple[str, ...],
        ratio: float,
        error: float = 0.0,
        excluded: tuple[str, ...] = (),
        motion: str = "",
    ) -> None:
        seed = first_seed + len(cases)
        cases.append(Case(plant, effects, ratio, error, motion or USUAL[len(cases) % 2], seed, excluded))

    for plant in names:
        for repeat in range(seeds):
            rng = np.random.default_rng([first_seed, repeat, len(cases)])
            effects = effects_of(plant)
            for name in effects:
                for ratio in RATIOS:
                    add(plant, (name,), ratio)
                add(plant, (name,), float(rng.choice(RATIOS[1:])), BASE_ERROR)
                add(plant, (name,), 8.0, excluded=(name,))
                other = str(rng.choice([e for e in effects if e != name]))
                add(plant, (name, other), float(rng.choice([4.0, 8.0])))
            for name in outside_of(plant):
                for ratio in RATIOS:
                    add(plant, (name,), ratio)
            for k in range(WITHOUT):
                add(plant, (), 0.0, BASE_ERROR if k % 3 == 2 else 0.0)
            for name in effects:
                add(plant, (name,), 4.0, motion=SINE)
    return cases


def quick_part(cases: Sequence[Case]) -> list[Case]:
    """One case of each group and plant, each time of another effect."""
    chosen: dict[tuple[str, str], Case] = {}
    for label in sorted({(case.plant, group(case)) for case in cases}):
        members = [case for case in cases if (case.plant, group(case)) == label]
        chosen[label] = members[5 * len(chosen) % len(members)]
    return list(chosen.values())


def group(case: Case) -> str:
    """The line of the table in which a case counts."""
    off = ", simulator off" if case.base_error else ""
    if case.motion == SINE:
        return "a poor recording: one sine"
    if case.excluded:
        return "withheld from the registry"
    if not case.effects:
        return f"no effect{off}"
    if set(case.effects) & set(outside_of(case.plant)):
        return "outside the registry"
    if len(case.effects) > 1:
        return "two effects"
    return f"one effect, gap/noise {case.ratio:g}" if not off else f"one effect{off}"
