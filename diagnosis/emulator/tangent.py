"""Where the parameters of what the built-in emulator identified would lead: the tangent of its output, along any motion."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..recording.signals import Signals
from .elements import tangents, torque_of, uncancelled
from .generalised import (
    DEGREE,
    ELEMENTS,
    PLACES,
    as_seen,
    drag_of,
    elements_of,
    motion_of,
    parts_of,
    predict_beside,
    rates_of,
    spacing,
)
from .kind import MEMORY
from .motion import Motion

__all__ = ["tangent"]

Floats = NDArray[np.float64]
SMALL = 1e-3
"""Relative change of the deflection's scale by which the output's is told."""


def tangent(parameters: Mapping[str, Any], signals: Signals) -> tuple[Floats, Floats, Floats]:
    """Columns (n, m) of structure and bulk, each the change for a relative error of one of some parameter.

    The third are of friction, damping, mass and the like, each one parameter of the simulator's.

    Parameters
    ----------
    parameters : dict
        As :meth:`hystbench.diagnosis.emulator.generalised.Generalised.parameters` gives them.
    signals : Signals
        The motion, n samples.
    """
    motion, x = as_seen(parameters, motion_of(signals)), signals.x
    thresholds, lengths, weights = (np.asarray(parameters[name]) for name in ("thresholds", "lengths", "weights"))
    elastic, stops, placed = parts_of(motion, parameters["reach"], thresholds, lengths)
    # A spring has no torque at rest, so neither has the change of a stiffness; a preload may be off by itself.
    at_rest = np.polynomial.legendre.legvander(0.0, DEGREE)
    preload = np.full((x.size, 1), float(at_rest[0] @ parameters["elastic"]))
    sprung = elastic[:, 1:] - at_rest[:, 1:]
    curve = sprung * np.asarray(parameters["elastic"])[1:]
    odd, even = curve[:, ::2].sum(axis=1), curve[:, 1::2].sum(axis=1)
    further = parameters["further"]
    width = stops @ weights + placed @ parameters["placed"] + torque_of(further, motion, MEMORY)
    size_odd, size_even = float(np.std(odd)), float(np.std(even))
    unit = sprung / np.maximum(np.std(sprung, axis=0), 1e-300)
    shapes = unit * np.array([size_odd if k % 2 == 0 else size_even for k in range(DEGREE)]) * 0.4
    stretched = (
        predict_beside(parameters, signals, (1.0 + SMALL) * x) - predict_beside(parameters, signals, (1.0 - SMALL) * x)
    ) / (2.0 * SMALL)
    stronger = _stronger(motion, thresholds, lengths)
    fine, coarse = tangents(further, motion)
    structure = np.hstack([_each(stops, weights, thresholds.size), _each(stronger, weights, thresholds.size), fine])
    rates = uncancelled(rates_of(motion.speed, motion.acceleration, parameters["fast"]) * parameters["rates"])
    by_place = (placed * parameters["placed"]).reshape(x.size, PLACES, -1).sum(axis=2)
    bulk = np.column_stack([
        shapes, odd, even, preload, width, uncancelled(by_place), stretched, rates, coarse,
    ])  # fmt: skip
    # What of one parameter takes several elements to follow: all friction, all that follows the speed alone.
    dry = width + rates[:, 2:].sum(axis=1)
    dragging = drag_of(parameters, motion) - rates[:, 1]
    return structure, bulk, np.column_stack([width, dry, dragging, rates, coarse])


def _each(elements: Floats, weights: Floats, stops: int) -> Floats:
    """So many stops and then bristles (n, all of them), each with its weight."""
    sizes, every = np.abs(weights), spacing(stops)
    # An element that the sparse fit left out shares its neighbours' size: its parameters are unknown, not exact.
    nearest = np.rint(np.arange(stops) / every).astype(int)
    coarse = np.concatenate([nearest, ELEMENTS + np.arange(sizes.size - stops)])
    whole = np.bincount(coarse, sizes)
    shared = 0.5 * np.convolve(whole, np.ones(3) / 3.0, mode="same")
    central = np.concatenate([np.arange(0, stops, every), np.arange(stops, sizes.size)])
    small = whole < shared
    kept = ~small[coarse] & (sizes > 0.0)
    return np.hstack([elements[:, kept] * sizes[kept], elements[:, central[small]] * shared[small]])


def _stronger(motion: Motion, thresholds: Floats, lengths: Floats) -> Floats:
    """Change of each element for a relative change by one of its strength at the same stiffness."""
    wider, narrower = (elements_of(motion, scale * thresholds, scale * lengths) for scale in (1.05, 0.95))
    return np.asarray((wider - narrower) / 0.1)
