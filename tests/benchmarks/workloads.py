"""What the benchmarks run: two inputs of 1e5 samples, and every model with the constants of the C kernels."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hystbench import models

Floats = NDArray[np.float64]
SAMPLES = 100_000
OPERATORS = 100


def sines() -> Floats:
    """Three sines within −1 .. 1: the input that the C kernels come with, about 600 reversals."""
    t = np.linspace(0.0, 100.0, SAMPLES)
    u = 0.5 * np.sin(np.pi * t) + 0.3 * np.sin(2.74 * np.pi * t + 0.4) + 0.2 * np.sin(6.2 * np.pi * t + 1.0)
    u -= u[0] * np.exp(-5.0 * t)
    return u / (np.abs(u).max() * 1.0000001)


def walk() -> Floats:
    """A random walk within −1 .. 1: about every second sample is a reversal."""
    u = np.cumsum(np.random.default_rng(0).normal(size=SAMPLES))
    u -= u[0]
    return u / (np.abs(u).max() * 1.0000001)


SIGNALS = {"sines": sines, "walk": walk}


def _weights() -> tuple[Floats, Floats]:
    i = np.arange(OPERATORS)
    return 3.0 * np.exp(-3.0 * i / OPERATORS) / OPERATORS, i / OPERATORS


def play_operators() -> Any:
    weights, thresholds = _weights()
    return models.get("prandtl-ishlinskii").from_parameters(weights=weights, thresholds=thresholds)


def stop_operators() -> Any:
    """Maxwell-slip elements in parallel: a stop operator is the input less the play operator of its threshold."""
    weights, thresholds = _weights()
    return models.get("prandtl-ishlinskii").from_parameters(
        weights=np.concatenate([[weights.sum()], -weights]),
        thresholds=np.concatenate([[0.0], thresholds + 1.0 / OPERATORS]),
    )


def relays(cells: int = 100) -> Any:
    centres = -1.0 + (np.arange(cells) + 0.5) * 2.0 / cells
    alpha, beta = (v.ravel() for v in np.meshgrid(centres, centres, indexing="ij"))
    alpha, beta = alpha[alpha >= beta], beta[alpha >= beta]
    weights = np.exp(-((((alpha - beta) / 2.0 - 0.3) / 0.2) ** 2) - ((alpha + beta) / 0.6) ** 2)
    return models.get("preisach").from_parameters(alpha=alpha, beta=beta, weights=weights / weights.sum(), offset=0.0)


def bouc_wen(n: float) -> Any:
    return models.get("bouc-wen").from_parameters(stiffness=1.0, alpha=0.3, A=1.0, beta=3.0, gamma=1.0, n=n)


def choi() -> Any:
    up, down = [0.1, 1.0, 0.1, -0.2, 0.05, 0.02], [-0.1, 0.9, -0.1, 0.15, -0.02, 0.01]
    return models.get("choi-backlash").from_parameters(
        ascending_pos=up, ascending_neg=up, descending_pos=down, descending_neg=down, slope_pos=5.0, slope_neg=5.0
    )


def maxwell_slip() -> Any:
    """Curves of 5 segments and transitions of 100 elements that follow each turn."""
    away = np.linspace(0.0, 1.0, OPERATORS + 1)
    bow = 1.0 - (1.0 - away) ** 2
    return models.get("maxwell-slip").from_parameters(
        ascending=np.column_stack([np.linspace(-0.6, 1.0, 6), np.linspace(-0.3, 1.1, 6)]),
        descending=np.column_stack([np.linspace(-1.0, 0.6, 6), np.linspace(-1.1, 0.3, 6)]),
        transition_pos=np.column_stack([1.0 - 0.4 * away, 1.1 - 0.35 * away - 0.45 * bow])[::-1],
        transition_neg=np.column_stack([-1.0 + 0.4 * away, -1.1 + 0.35 * away + 0.45 * bow]),
    )


def modified_prandtl_ishlinskii() -> Any:
    weights, thresholds = _weights()
    return models.get("modified-prandtl-ishlinskii").from_parameters(
        weights=weights, thresholds=thresholds, dead_zone_weights=[0.1, 1.0, 0.1], dead_zone_thresholds=[-0.3, 0.0, 0.3]
    )


SPRING = [0.0, 1.0, 0.0, 0.2]

AGAINST_C: dict[str, tuple[Any, str, str | None]] = {
    "prandtl-ishlinskii, 100 plays": (play_operators, "play100_revstack", "play100_revstack"),
    "prandtl-ishlinskii, 100 stops": (stop_operators, "play100_revstack", "maxwell100"),
    "preisach, 5050 relays": (relays, "preisach_relay_staircase", "preisach_relay100x100"),
    "bouc-wen, n = 1": (lambda: bouc_wen(1.0), "boucwen_rk4_n1", "boucwen_exact_n1"),
    "bouc-wen, n = 1.5": (lambda: bouc_wen(1.5), "boucwen_rk4_pow1.5", "boucwen_rk4_pow1.5"),
    "bouc-wen, n = 2": (lambda: bouc_wen(2.0), "boucwen_rk4_n2", "boucwen_rk4_n2"),
    "choi-backlash, degree 5": (choi, "choi_backlash_poly", None),
    "maxwell-slip, 100 elements": (maxwell_slip, "play100_revstack", None),
    "modified-prandtl-ishlinskii, 100 plays": (modified_prandtl_ishlinskii, "play100_revstack", None),
}
"""Name: the model, the C kernel it is timed against, and the one that gives the same output (None: another law)."""

ALONE: dict[str, Any] = {
    "cubic": lambda: models.get("cubic").from_parameters(ascending=[0.1, 1.0, 0.0, 0.1], descending=[-0.1, 1.0, 0.0, 0.1]),
    "linear": lambda: models.get("linear").from_parameters(stiffness=5.0),
    "elastic, 16 segments": lambda: models.get("elastic").from_parameters(
        vertices=np.column_stack([np.linspace(-1.0, 1.0, 17)] * 2)
    ),
    "dahl": lambda: models.get("dahl").from_parameters(stiffness=5.0, friction=0.5, exponent=1.5, spring=SPRING),
    "duhem": lambda: models.get("duhem").from_parameters(curve=SPRING, loss=[1.0, 0.0, 1.0], rate=5.0),
    "lugre": lambda: models.get("lugre").from_parameters(
        stiffness=5.0, damping=0.1, viscous=0.1, coulomb=0.5, static=0.7, stribeck_speed=0.1, spring=SPRING
    ),
    "generalized-maxwell-slip, 10 elements": lambda: models.get("generalized-maxwell-slip").from_parameters(
        stiffness=np.linspace(5.0, 1.0, 10), strength=np.linspace(0.1, 0.3, 10), static_ratio=1.5, stribeck_speed=0.1,
        attraction=10.0, viscous=0.1, spring=SPRING,
    ),
    "bouc-wen-baber-noori": lambda: models.get("bouc-wen-baber-noori").from_parameters(
        spring=[0.0, 0.3], hysteretic=0.7, A=1.0, beta=3.0, gamma=1.0, n=1.5, zeta_s=0.5, p=1.0, psi=0.3, delta_nu=0.01
    ),
}  # fmt: skip
"""Models without a counterpart among the C kernels."""
