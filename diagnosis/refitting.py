"""Where the parameters of a fitted model would go if it were fitted again beside each effect.

A model that was fitted to recordings of a joint has taken up a part of every effect that it lacks, by parameters that are
wrong for it. Its error alone therefore points at what its own parameters cannot make, not at the cause. The model is
fitted again to what each effect leaves, and the changes of its output span the few directions in which its parameters
may have gone; beside these every effect is judged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..bench.arguments import time_argument
from ..errors import InputError
from .effects.base import INPUT, Effect
from .emulation import Emulator, SimulatorScene, answers_of
from .evidence import boxed_least_squares
from .signals import Signals

__all__ = ["refitted_beside"]

Floats = NDArray[np.float64]
ROUNDS = 3
STEP = 0.1
"""Relative error of the bulk that stands for one whole refit."""
PROMISING = 0.03
"""Share of what the refitted model leaves that an effect must take for another fit beside it."""
DISTINCT = 0.02
"""Size of the smallest direction, over the largest, that is more than the accident of one fit."""


def refitted_beside(signals: Signals, model: Any, emulator: Emulator, effects: Sequence[Effect]) -> Emulator:
    """The emulator with the changes of a fitted model's output, when fitted again, as its tangents.

    The directions come from the whole recording; how far the model goes along each is fitted on the samples that a fit
    sees, like every coefficient.

    Parameters
    ----------
    signals : Signals
        With the model's output as the simulator's.
    model : fitted model
        Of a class with ``fit``; it stays as it is.
    emulator : Emulator
        Of the model, see :func:`hystbench.diagnosis.emulation.emulate`.
    effects : sequence of Effect
        Beside which it is fitted again, one at a time.

    Returns
    -------
    Emulator
        The given one where the model cannot be fitted to these recordings, or stays what it is.
    """
    first = _again(signals, model, emulator, np.zeros_like(signals.gap))
    if first is None:
        return emulator
    changes = [first.torque - signals.y_sim]
    for effect in effects:
        beside = first
        # What an effect on the input adds depends on the model, so it is asked again beside the one fitted with it.
        for _ in range(ROUNDS if effect.acts_on == INPUT else 1):
            added = _best_alone(effect, beside)
            again = None if added is None else _again(signals, model, emulator, added)
            if again is None:
                break
            beside = again
        if beside is not first:
            changes.append(beside.torque - signals.y_sim)
    left, size, _ = np.linalg.svd(np.column_stack(changes), full_matrices=False)
    kept = size > max(DISTINCT * size[0], 1e-9 * float(np.linalg.norm(signals.y_real)))
    if not np.any(kept):
        return emulator
    return replace(emulator, structure=np.empty((signals.x.size, 0)), bulk=left[:, kept] * size[kept] / STEP)


def _again(signals: Signals, model: Any, emulator: Emulator, explained: Floats) -> SimulatorScene | None:
    """The recording beside a model like this one, fitted to it less what is explained (n,); None where it cannot be."""
    try:
        again = type(model)()
        time = time_argument(again.fit, signals.time)
        again.fit(signals.x, signals.y_real - explained, signals.groups, **time)
        answers = answers_of(again, signals)
        output = answers(signals.x)
    except (AttributeError, InputError, np.linalg.LinAlgError, RuntimeError, TypeError):
        # Not every model can be fitted anew, or to everything.
        return None
    if not np.all(np.isfinite(output)):
        return None
    return SimulatorScene(replace(signals, y_sim=output), replace(emulator, predict=answers), base=output)


def _best_alone(effect: Effect, scene: SimulatorScene) -> Floats | None:
    """What the effect's best law and starting shape alone add to the simulator, N·m, shape (n,); None if that is little."""
    best, most = None, PROMISING * float(scene.signals.gap @ scene.signals.gap)
    for form in effect.forms(scene):
        for shape in form.grid:
            columns = form.columns(scene, shape)
            if not np.all(np.isfinite(columns)):
                continue
            coefficients, reduction = boxed_least_squares(
                (columns.T @ columns)[None],
                (columns.T @ scene.signals.gap)[None],
                np.array(form.lower),
                np.array(form.upper),
            )
            if reduction[0] > most:
                best, most = columns @ coefficients[0], float(reduction[0])
    return best
