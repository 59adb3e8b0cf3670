"""Where the parameters of a fitted model would go if it were fitted again beside each effect.

A model that was fitted to recordings of a joint has taken up a part of every effect that it lacks, by parameters that are
wrong for it. Its error alone therefore points at what its own parameters cannot make, not at the cause. The model is
fitted again to what each effect leaves, and the changes of its output span the few directions in which its parameters
may have gone; beside these every effect is judged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from ...bench.arguments import time_argument
from ...errors import InputError
from ..effects.base import INPUT, Effect, Form
from ..emulator.emulation import AskingScene, Emulator, SimulatorScene, answers_of
from ..recording.signals import Signals
from .boxed import boxed_least_squares

__all__ = ["fitted_again", "refitted_beside"]

Floats = NDArray[np.float64]
SIZES, STEPS = 5, 6
"""Sizes of each law of an effect on the input beside which the model is fitted, and then about the best."""
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
        Of the model, see :func:`hystbench.diagnosis.emulator.emulation.emulate`.
    effects : sequence of Effect
        Beside which it is fitted again, one at a time.

    Returns
    -------
    Emulator
        The given one where the model cannot be fitted to these recordings, or stays what it is.
    """
    first = _again(signals, model, emulator, signals.x, signals.y_real)
    if first is None:
        return emulator
    changes, on_input = [first.scene.torque - signals.y_sim], first
    for effect in effects:
        if effect.acts_on == INPUT:
            beside = _best_on_input(effect, signals, model, first)
            if beside is not None and beside.left < on_input.left:
                on_input = beside
        else:
            added = _best_alone(effect, first.scene)
            # From anywhere: what an effect adds may leave a loop far from the model's.
            beside = None if added is None else _again(signals, model, emulator, signals.x, signals.y_real - added)
        if beside is not None:
            changes.append(beside.scene.torque - signals.y_sim)
    if on_input.left < (1.0 - PROMISING) * first.left:
        # What an effect on the input adds is asked of the model that it was fitted beside.
        emulator = on_input.scene.emulator
    left, size, _ = np.linalg.svd(np.column_stack(changes), full_matrices=False)
    kept = size > max(DISTINCT * size[0], 1e-9 * float(np.linalg.norm(signals.y_real)))
    if not np.any(kept):
        return emulator
    return replace(emulator, structure=np.empty((signals.x.size, 0)), bulk=left[:, kept] * size[kept] / STEP)


def fitted_again(
    model: Any, signals: Signals, x: Floats, y: Floats, near: Any | None = None
) -> tuple[Any, Floats] | None:
    """A model of the same kind fitted to ``y`` (n,) over ``x`` (n,) in the recordings' runs, and its output (n,) there.

    None where it cannot be fitted, or its output is not finite. It starts from where a fit ``near`` ended, if its kind can.
    """
    try:
        fit = getattr(near, "refit", None) or type(model)().fit
        again = fit(x, y, signals.groups, **time_argument(fit, signals.time))
        reached = answers_of(again, signals)(x)
    except (AttributeError, InputError, np.linalg.LinAlgError, RuntimeError, TypeError):
        # Not every model can be fitted anew, or to everything.
        return None
    return (again, reached) if np.all(np.isfinite(reached)) else None


@dataclass(frozen=True)
class _Refit:
    """A model fitted again: the recording beside it, and the energy that it leaves of what it was fitted to."""

    model: Any
    scene: SimulatorScene
    left: float


def _again(
    signals: Signals, model: Any, emulator: Emulator, x: Floats, y: Floats, near: Any | None = None
) -> _Refit | None:
    """A model like this one fitted to ``y`` (n,) over the deflection ``x`` (n,); None where it cannot be."""
    again = fitted_again(model, signals, x, y, near)
    if again is None:
        return None
    answers, reached = answers_of(again[0], signals), again[1]
    output = reached if x is signals.x else answers(signals.x)
    if not np.all(np.isfinite(output)):
        return None
    emulator = replace(emulator, predict=answers, refitted=True)
    scene = SimulatorScene(replace(signals, y_sim=output), emulator, base=output)
    return _Refit(again[0], scene, float(np.sum(np.square(y - reached)[signals.judged])))


def _best_on_input(effect: Effect, signals: Signals, model: Any, first: _Refit) -> _Refit | None:
    """The model fitted to the deflection that the effect leaves, for the law and the size beside which it fits best.

    Model and effect are fitted together: a model that was fitted without a clearance is soft where it should be stiff,
    and asks for next to none.
    """
    laws = (f for f in effect.forms(first.scene) if len(f.shapes) == 1 and tuple(f.lower) == (1.0,) and f.grid)
    begun = [found for found in (_from_small_to_large(law, signals, model, first) for law in laws) if found is not None]
    # A fit takes its time: only of the best law other sizes are tried than those it starts from.
    return _between(min(begun, key=lambda each: each.best.left), signals, model) if begun else None


@dataclass(frozen=True)
class _Sized:
    """A law of one size, the model fitted beside the best of those it starts from, and the sizes next to that."""

    law: Form
    best: _Refit
    neighbours: tuple[float, float]


def _from_small_to_large(law: Form, signals: Signals, model: Any, first: _Refit) -> _Sized | None:
    """A law with the best of the sizes it starts from, as far as the model fits better and better; None if none is better than no
    effect.
    """
    sizes = [shape[0] for shape in law.grid[:: -(-len(law.grid) // SIZES)]]
    best, at = first, 0
    for k, size in enumerate(sizes):
        found = _beside(law, size, signals, model, best)
        if found is None or found.left >= best.left:
            break
        best, at = found, k
    if best is first:
        return None
    low, high = sorted((sizes[max(at - 1, 0)], sizes[min(at + 1, len(sizes) - 1)]))
    return _Sized(law, best, (low, high))


def _between(begun: _Sized, signals: Signals, model: Any) -> _Refit:
    """The model fitted beside the best size between neighbours."""
    tried = [begun.best]

    def left(size: float) -> float:
        found = _beside(begun.law, size, signals, model, begun.best)
        if found is None:
            return np.inf
        tried.append(found)
        return found.left

    minimize_scalar(left, bounds=begun.neighbours, method="bounded", options={"maxiter": STEPS})
    return min(tried, key=lambda refit: refit.left)


def _beside(law: Form, size: float, signals: Signals, model: Any, last: _Refit) -> _Refit | None:
    """The model fitted to the deflection that a law of this size leaves; None where it cannot be.

    Where the effect acts may depend on the torque: the model that was fitted ``last``, beside a smaller one, tells it. And
    this one's parameters are near that one's.
    """
    scene = AskingScene(signals, last.scene.emulator, base=last.scene.torque)
    law.columns(scene, (size,))
    if scene.asked is None:
        return None
    return _again(signals, model, last.scene.emulator, scene.asked, signals.y_real, last.model)


def _best_alone(effect: Effect, scene: SimulatorScene) -> Floats | None:
    """What the effect's best law and starting shape alone add to the simulator, N·m, shape (n,); None if that is little."""
    rows = scene.signals.judged
    gap = scene.signals.gap[rows]
    best, most = None, PROMISING * float(gap @ gap)
    for form in effect.forms(scene):
        for shape in form.grid:
            columns = form.columns(scene, shape)
            if not np.all(np.isfinite(columns)):
                continue
            looked = columns[rows]
            coefficients, reduction = boxed_least_squares(
                (looked.T @ looked)[None],
                (looked.T @ gap)[None],
                np.array(form.lower),
                np.array(form.upper),
            )
            if reduction[0] > most:
                best, most = columns @ coefficients[0], float(reduction[0])
    return best
