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
from .emulation import Emulator, SimulatorScene
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
    first = _again(signals, model, np.zeros_like(signals.gap))
    if first is None:
        return emulator
    changes = [_answer(first, signals, signals.x) - signals.y_sim]
    for effect in effects:
        fitted = first
        # What an effect on the input adds depends on the model, so it is asked again beside the one fitted with it.
        for _ in range(ROUNDS if effect.acts_on == INPUT else 1):
            added = _best_alone(effect, _scene(signals, fitted, emulator))
            again = None if added is None else _again(signals, model, added)
            if again is None:
                break
            fitted = again
        if fitted is not first:
            changes.append(_answer(fitted, signals, signals.x) - signals.y_sim)
    left, size, _ = np.linalg.svd(np.column_stack(changes), full_matrices=False)
    kept = size > max(DISTINCT * size[0], 1e-9 * float(np.linalg.norm(signals.y_real)))
    if not np.any(kept):
        return emulator
    return replace(emulator, structure=np.empty((signals.x.size, 0)), bulk=left[:, kept] * size[kept] / STEP)


def _groups(signals: Signals) -> NDArray[np.intp]:
    return np.repeat(np.arange(len(signals.runs)), [run.stop - run.start for run in signals.runs])


def _answer(model: Any, signals: Signals, x: Floats) -> Floats:
    return np.asarray(model.predict(x, _groups(signals), **time_argument(model.predict, signals.time)))


def _scene(signals: Signals, model: Any, emulator: Emulator) -> SimulatorScene:
    """The recording beside another model of the same class."""
    beside = replace(signals, y_sim=_answer(model, signals, signals.x))
    return SimulatorScene(beside, replace(emulator, predict=lambda x: _answer(model, signals, x)))


def _again(signals: Signals, model: Any, explained: Floats) -> Any | None:
    """A model like this one, fitted to the recording less what is explained (n,); None where it cannot be."""
    try:
        again = type(model)()
        again.fit(signals.x, signals.y_real - explained, _groups(signals), **time_argument(again.fit, signals.time))
        output = _answer(again, signals, signals.x)
    except (AttributeError, InputError, np.linalg.LinAlgError, RuntimeError, TypeError):
        # Not every model can be fitted anew, or to everything.
        return None
    return again if np.all(np.isfinite(output)) else None


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
