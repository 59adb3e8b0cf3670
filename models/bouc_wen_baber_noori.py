"""The Bouc-Wen model with Baber and Noori's degradation and pinching, and Wang and Wen's asymmetry.

Source: T. T. Baber, M. N. Noori, "Modeling general hysteresis behavior and random vibration application", J. Vibration,
Acoustics, Stress and Reliability in Design 108(4), 1986; the pinching function as in G. C. Foliente, "Hysteresis
modeling of wood joints and structural systems", J. Structural Engineering 121(6), 1995; the asymmetry as in C.-H. Wang,
Y.-K. Wen, "Evaluation of pre-Northridge low-rise steel buildings. I: modeling", J. Structural Engineering 126(10), 2000.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numba import njit

from ..errors import InputError
from .base import Condition, Floats, HysteresisModel, Run, parameter_array, parameter_number
from .separable import fit_separable, powers, unscaled
from .stepping import KernelStepper

__all__ = ["BoucWenBaberNoori"]

# State: last input, hysteretic state z, absorbed energy, started.
_X, _Z, _ENERGY, _STARTED = 0, 1, 2, 3

SUBSTEPS = 20_000
"""Bound on the substeps of one sample; only a state that grows without bound needs more."""

SHAPE = ("beta", "gamma", "n", "phi")
EXTRAS = ("zeta_s", "q", "p", "psi", "delta_psi", "lambda_", "delta_nu", "delta_eta")

FINE, COARSE = 1.0, 16.0
"""Length of the integration's steps relative to the one that keeps its error below 1e-6 of the range."""

# ln z_u, (gamma − beta) / (beta + gamma), n, phi / (beta + gamma); for unit amplitude, A = 1 and without degradation.
# gamma <= beta, so that the hysteretic part absorbs energy; a spring that stiffens is the polynomial's business.
SHAPE_RANGE = ((np.log(0.02), -3.0, 1.0, -0.45), (np.log(3.0), 0.0, 6.0, 0.45))
# The rest in the order of EXTRAS; what multiplies the energy is relative to the energy absorbed in the recording.
EXTRAS_RANGE = ((0.0, 0.0, 0.5, 0.05, 0.0, 0.05, 0.0, 0.0), (0.95, 0.6, 200.0, 2.0, 1.0, 1.0, 5.0, 5.0))
# Hardly any of either, pinching alone, degradation alone, both.
GUESSES = (
    (0.01, 0.1, 2.0, 0.2, 0.05, 0.2, 0.02, 0.02),
    (0.7, 0.2, 20.0, 0.2, 0.05, 0.2, 0.02, 0.02),
    (0.05, 0.1, 2.0, 0.2, 0.05, 0.2, 0.5, 0.5),
    (0.7, 0.2, 5.0, 0.2, 0.05, 0.2, 0.5, 0.5),
)


def _initial_state(capacity: int) -> Floats:
    return np.zeros(4)


@njit(cache=True)
def _rate(q, energy, c_pos, c_neg, total, law):
    """dq over the distance travelled, where q is z seen in the direction of motion; also its bend and the pinch's width."""
    a, n, zeta_s, mid, p, psi, delta_psi, lambda_, delta_nu, delta_eta, _ = law
    energy = max(energy, 0.0)
    nu = 1.0 + delta_nu * energy
    c = nu * (c_pos if q > 0.0 else c_neg)
    rate = (a - c * abs(q) ** n) / (1.0 + delta_eta * energy)
    width = np.inf
    zeta = zeta_s * -np.expm1(-p * energy)
    if zeta > 0.0:
        width = (psi + delta_psi * energy) * (lambda_ + zeta)
        ultimate = (a / (nu * total)) ** (1.0 / n) if a > 0.0 and total > 0.0 else 0.0
        rate *= 1.0 - zeta * np.exp(-(((q - mid * ultimate) / width) ** 2))
    return rate, width


@njit(cache=True)
def _flow(q, energy, d, c_pos, c_neg, total, law):
    """(q, energy) after the distance ``d``, by Runge-Kutta of fourth order with steps that follow the state."""
    a, n, delta_nu, grain = law[0], law[1], law[8], law[10]
    largest = max(abs(c_pos), abs(c_neg)) * (1.0 + delta_nu * max(energy, 0.0))
    scale = (abs(a) / largest) ** (1.0 / n) if largest > 0.0 and a != 0.0 else np.inf
    for _ in range(SUBSTEPS):
        k1, width = _rate(q, energy, c_pos, c_neg, total, law)
        # Saturated: the rest of the way changes nothing but the absorbed energy.
        if abs(k1) * d <= 1e-16 * abs(q) and delta_nu == 0.0:
            return q, energy + q * d
        h = min(d, 0.2 * grain * scale / abs(a)) if a != 0.0 else d
        if a != 0.0 and scale < np.inf:
            # |q|^n is not smooth at zero, and the law changes there.
            h = min(h, max(0.5 * abs(q), 2e-4 * grain * grain * scale) / abs(a))
        if k1 != 0.0:
            h = min(h, min(0.08 * grain, 0.5) * width / abs(k1))
        ahead = min(abs(q) + abs(a) * h, max(abs(q), scale))
        bend = n * largest * ahead ** (n - 1.0)
        if bend > 0.0:
            # The error of a step goes with the rate, which fades towards saturation.
            h = min(h, min(0.05 * grain * (abs(a) / max(abs(k1), 1e-12 * abs(a))) ** 0.25, 1.0) / bend)
        q2 = q + 0.5 * h * k1
        k2 = _rate(q2, energy + 0.5 * h * q, c_pos, c_neg, total, law)[0]
        q3 = q + 0.5 * h * k2
        k3 = _rate(q3, energy + 0.5 * h * q2, c_pos, c_neg, total, law)[0]
        q4 = q + h * k3
        k4 = _rate(q4, energy + h * q3, c_pos, c_neg, total, law)[0]
        energy += h * (q + 2.0 * q2 + 2.0 * q3 + q4) / 6.0
        q += h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
        d -= h
        if d <= 0.0:
            return q, energy
    return np.inf, np.inf


@njit(cache=True)
def _advance(x, state, params):
    spring, hysteretic, beta, gamma, phi, law = params
    if state[_STARTED] == 0.0:
        state[_STARTED] = 1.0
        state[_X] = x
    dx = x - state[_X]
    if dx != 0.0:
        sign = 1.0 if dx > 0.0 else -1.0
        q, energy = _flow(
            sign * state[_Z], state[_ENERGY], abs(dx), gamma + beta + 2.0 * sign * phi, gamma - beta, beta + gamma, law
        )
        state[_Z] = sign * q
        state[_ENERGY] = energy
        state[_X] = x
    y = 0.0
    for k in range(spring.size - 1, -1, -1):
        y = y * x + spring[k]
    return y + hysteretic * state[_Z]


@njit(cache=True)
def _step(x, state, params, commit):
    return _advance(x, state if commit else state.copy(), params)


@njit(cache=True)
def _run(x, state, params, out):
    for i in range(x.size):
        out[i] = _advance(x[i], state, params)


class BoucWenBaberNoori(HysteresisModel):
    """Bouc-Wen with asymmetry, pinching and degradation.

    ``y = Σ spring_k x^k + hysteretic·z``,
    ``dz = h {A − ν |z|^n [beta sgn(dx z) + gamma + phi (sgn(dx) + sgn(z))]} dx / η``,
    ``ν = 1 + delta_nu ε`` (strength), ``η = 1 + delta_eta ε`` (stiffness), ``ε = ∫ z dx``, counted where positive,
    ``h = 1 − ζ1 exp(−((z sgn(dx) − q z_u) / ζ2)²)``, ``ζ1 = zeta_s (1 − exp(−p ε))``,
    ``ζ2 = (psi + delta_psi ε)(lambda_ + ζ1)``, ``z_u = (A / (ν (beta + gamma)))^(1/n)``. z and ε are 0 at the first
    sample; the memory of ε never fades. In Bouc-Wen's terms spring = (offset, alpha·stiffness) and
    hysteretic = (1 − alpha)·stiffness.

    Parameters
    ----------
    spring_degree : int
        Degree of the spring's polynomial.
    starts : int
        Points of the global search for the shape; pinching and degradation are then refined from four guesses.
    seed : int
        Seed of the global search.

    Notes
    -----
    ``from_parameters`` takes ``spring`` (k,), coefficients in increasing powers, ``hysteretic``, ``A``, ``beta``,
    ``gamma``, ``n`` and optionally ``phi``, ``zeta_s``, ``q``, ``p``, ``psi``, ``delta_psi``, ``lambda_``, ``delta_nu``
    and ``delta_eta``; what is left out has no effect.
    """

    id: ClassVar[str] = "bouc-wen-baber-noori"
    title: ClassVar[str] = "Bouc-Wen-Baber-Noori"
    summary: ClassVar[str] = "Bouc-Wen with asymmetry, pinching and degradation of strength and stiffness with energy"
    use_for: ClassVar[str] = "joints, walls and connections that pinch, weaken or soften from cycle to cycle"
    not_for: ClassVar[str] = (
        "recordings of a few like cycles, which do not tell its parameters apart; and where loops must close"
    )
    source: ClassVar[str] = "Baber & Noori 1986; Foliente 1995; Wang & Wen 2000"
    references: ClassVar[tuple[str, ...]] = ("baber-noori1986",)
    extended: ClassVar[bool] = True

    def __init__(self, spring_degree: int = 5, starts: int = 128, seed: int = 0) -> None:
        self.spring_degree = spring_degree
        self.starts = starts
        self.seed = seed

    # ---- identification --------------------------------------------------------------------------------------------

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.spring_degree < 0 or self.starts < 1:
            raise InputError("bouc-wen-baber-noori needs spring_degree >= 0 and starts >= 1")
        scale = max(float(np.max(np.abs(run.x))) for run in runs)
        nothing = np.zeros(1)
        amplitude = 0.5 * max(float(np.ptp(run.x)) for run in runs)
        absorbed = 1.0

        def states(point: Floats, run: Run) -> tuple[Floats, float]:
            z, state = np.empty_like(run.x), _initial_state(0)
            p = {"spring": nothing, "hysteretic": 1.0, **_physical(point, absorbed)}
            _run(run.x / amplitude, state, _kernel_parameters(p, COARSE), z)
            # A state that grows without bound must cost more than any other, not stop the search.
            return np.nan_to_num(z, nan=1e6, posinf=1e6, neginf=-1e6).clip(-1e6, 1e6), float(state[_ENERGY])

        def regressors(point: Floats, run: Run) -> Floats:
            return np.column_stack([powers(run.x / scale, self.spring_degree), states(point, run)[0]])

        free = [False] * (self.spring_degree + 2)
        near = None if self.search_from is None else self.search_from[: len(SHAPE)]
        point, _ = fit_separable(regressors, runs, *SHAPE_RANGE, free, self.starts, self.seed, near=near)
        energies = [states(point, run)[1] for run in runs]
        absorbed = max(max(energies), 1e-3) if np.all(np.isfinite(energies)) else 1.0
        lower, upper = (np.concatenate(pair) for pair in zip(SHAPE_RANGE, EXTRAS_RANGE, strict=True))
        guesses = [np.concatenate([point, guess]) for guess in GUESSES]
        point, found = fit_separable(
            regressors, runs, lower, upper, free, 0, self.seed, guesses, rounds=10, near=self.search_from
        )
        self.search_ended_ = point
        self._tell(point, lower, upper)
        p = _physical(point, absorbed)
        # Back to the input's units with A = 1: z goes with x, the energy with its square.
        for name in ("beta", "gamma", "phi"):
            p[name] *= amplitude ** -p["n"]
        p["psi"] *= amplitude
        p["delta_psi"] /= amplitude
        for name in ("p", "delta_nu", "delta_eta"):
            p[name] /= amplitude**2
        return {"spring": unscaled(found[:-1], scale), "hysteretic": float(found[-1]) / amplitude, **p}

    def _tell(self, point: Floats, lower: Floats, upper: Floats) -> None:
        self.notes_.append(
            "A is fixed to 1: the equations do not change when z, A, beta, gamma and phi are rescaled together"
        )
        names = ("z_u", "(gamma - beta) / (beta + gamma)", "n", "phi", *EXTRAS)
        near = np.minimum(point - lower, upper - point) < 1e-4 * (upper - lower)
        # Zero is where an effect is absent, so that bound is an answer.
        near &= (lower != 0.0) | (point > 0.5 * upper)
        if np.any(near):
            told = ", ".join(name for name, is_near in zip(names, near, strict=True) if is_near)
            self.notes_.append(f"at the bound of the search, so not determined by this recording: {told}")
        if point[len(SHAPE)] < 0.02:
            self.notes_.append("no pinching was found: q, p, psi, delta_psi and lambda_ mean nothing")

    # ---- parameters ------------------------------------------------------------------------------------------------

    @classmethod
    def _check_parameters(
        cls,
        spring: Any,
        hysteretic: Any,
        A: Any,
        beta: Any,
        gamma: Any,
        n: Any,
        phi: Any = 0.0,
        zeta_s: Any = 0.0,
        q: Any = 0.0,
        p: Any = 0.0,
        psi: Any = 1.0,
        delta_psi: Any = 0.0,
        lambda_: Any = 1.0,
        delta_nu: Any = 0.0,
        delta_eta: Any = 0.0,
    ) -> dict[str, Any]:
        values = {
            "hysteretic": hysteretic, "A": A, "beta": beta, "gamma": gamma, "n": n, "phi": phi,
            "zeta_s": zeta_s, "q": q, "p": p, "psi": psi, "delta_psi": delta_psi, "lambda_": lambda_,
            "delta_nu": delta_nu, "delta_eta": delta_eta,
        }  # fmt: skip
        checked: dict[str, Any] = {name: parameter_number(name, value) for name, value in values.items()}
        if checked["n"] < 1.0:
            raise InputError(f"parameter n must be at least 1; it is {checked['n']}")
        if not 0.0 <= checked["zeta_s"] < 1.0:
            raise InputError(f"parameter zeta_s must lie in [0, 1); it is {checked['zeta_s']}")
        for name in ("p", "delta_psi", "delta_nu", "delta_eta"):
            if checked[name] < 0.0:
                raise InputError(f"parameter {name} must not be negative; it is {checked[name]}")
        for name in ("psi", "lambda_"):
            if checked[name] <= 0.0:
                raise InputError(f"parameter {name} must be positive; it is {checked[name]}")
        return {"spring": parameter_array("spring", spring, (None,)), **checked}

    def _prepare(self) -> None:
        self._params = _kernel_parameters(self.parameters_, FINE)

    def _check_conditions(self) -> list[Condition]:
        p = self.parameters_
        rising = p["beta"] + p["gamma"] - 2.0 * abs(p["phi"])
        bounded = p["A"] > 0.0 and rising > 0.0 and p["beta"] - p["gamma"] >= 0.0
        told = f"A = {p['A']:.4g}, beta = {p['beta']:.4g}, gamma = {p['gamma']:.4g}, phi = {p['phi']:.4g}"
        return [
            Condition("the state stays bounded: A > 0, beta + gamma > 2 |phi|, gamma <= beta", bounded, told),
            Condition("the hysteretic part acts against the motion: hysteretic >= 0", p["hysteretic"] >= 0.0,
                      f"hysteretic {p['hysteretic']:.4g}"),
        ]  # fmt: skip

    # ---- evaluation ------------------------------------------------------------------------------------------------

    def _predict_run(self, x: Floats) -> Floats:
        y = np.empty_like(x)
        _run(x, _initial_state(0), self._params, y)
        if not np.isfinite(y[-1]):
            bad = int(np.flatnonzero(~np.isfinite(y))[0])
            raise InputError(
                f"the state z grows without bound at sample {bad} (x = {x[bad]:.6g}): "
                "the model only holds for smaller inputs"
            )
        return y

    def stepper(self) -> KernelStepper:
        self._require_fitted()
        return KernelStepper(_step, _initial_state, self._params, _run)


def _physical(point: Floats, absorbed: float) -> dict[str, float]:
    """Parameters for unit amplitude from the search's coordinates; effects that ``point`` leaves out are absent."""
    ratio, n, phi = float(point[1]), float(point[2]), float(point[3])
    total = float(np.exp(-n * point[0]))
    result = {
        "A": 1.0,
        "beta": 0.5 * total * (1.0 - ratio),
        "gamma": 0.5 * total * (1.0 + ratio),
        "n": n,
        "phi": phi * total,
    }
    extras = point[len(SHAPE) :].tolist() or [0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]
    result.update(zip(EXTRAS, extras, strict=True))
    for name in ("p", "delta_psi", "delta_nu", "delta_eta"):
        result[name] /= absorbed
    return result


def _kernel_parameters(p: dict[str, Any], grain: float) -> tuple[Any, ...]:
    law = (p["A"], p["n"], *(p[name] for name in EXTRAS), grain)
    return p["spring"], p["hysteretic"], p["beta"], p["gamma"], p["phi"], law
