"""The same laws by other means: a NumPy loop, SciPy's integrator, OpenSees, and a regression model of SysIdentPy."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
from scipy.integrate import odeint
from workloads import OPERATORS, Floats


def missing(name: str) -> str | None:
    """Why a peer cannot be run here; None if it can."""
    try:
        importlib.import_module(name)
    # A compiled package may fail on import in its own way, for want of a system library for instance.
    except Exception as error:
        return " ".join(f"{type(error).__name__}: {error}".split())[:160]
    return None


def numpy_plays(x: Floats) -> Floats:
    """100 play operators, all at once at each sample."""
    i = np.arange(OPERATORS)
    weights, thresholds = 3.0 * np.exp(-3.0 * i / OPERATORS) / OPERATORS, i / OPERATORS
    play, out = np.zeros(OPERATORS), np.empty_like(x)
    for k, value in enumerate(x.tolist()):
        np.clip(play, value - thresholds, value + thresholds, out=play)
        out[k] = weights @ play
    return out


def scipy_bouc_wen(x: Floats) -> Floats:
    """Bouc-Wen with n = 1 by LSODA over the sample number, the input linear between samples."""
    rates = np.append(np.diff(x), 0.0)

    def slope(z: Floats, t: float) -> float:
        rate = rates[min(int(t), rates.size - 1)]
        return float(rate * (1.0 - abs(z[0]) * (3.0 * np.sign(rate * z[0]) + 1.0)))

    z = odeint(slope, 0.0, np.arange(x.size), hmax=1.0)[:, 0]
    return 0.3 * x + 0.7 * z


def _opensees(x: Floats, define: Any) -> Floats:
    import openseespy.opensees as ops

    ops.wipe()
    define(ops)
    ops.testUniaxialMaterial(1)
    out = np.empty_like(x)
    for k, value in enumerate(x.tolist()):
        ops.setStrain(value)
        out[k] = ops.getStress()
    ops.wipe()
    return out


def opensees_bouc_wen(x: Floats) -> Floats:
    def define(ops: Any) -> None:
        ops.uniaxialMaterial("BoucWen", 1, 0.3, 1.0, 1.0, 1.0, 3.0, 1.0, 0.0, 0.0, 0.0)

    return _opensees(x, define)


def opensees_stops(x: Floats) -> Floats:
    """Parallel elastic-perfectly-plastic springs: Maxwell-slip."""
    i = np.arange(OPERATORS)
    stiffness = 3.0 * np.exp(-3.0 * i / OPERATORS) / OPERATORS

    def define(ops: Any) -> None:
        for k in range(OPERATORS):
            ops.uniaxialMaterial("ElasticPP", k + 2, float(stiffness[k]), (k + 1.0) / OPERATORS)
        ops.uniaxialMaterial("Parallel", 1, *range(2, OPERATORS + 2))

    return _opensees(x, define)


def sysidentpy_narx(x: Floats, y: Floats) -> Any:
    """A polynomial NARX model of degree 2 with two lags, fitted to (x, y); returns its free-run prediction."""
    from sysidentpy.basis_function import Polynomial
    from sysidentpy.model_structure_selection import FROLS
    from sysidentpy.parameter_estimation import LeastSquares

    model = FROLS(
        order_selection=True,
        n_info_values=8,
        ylag=2,
        xlag=2,
        estimator=LeastSquares(),
        basis_function=Polynomial(degree=2),
    )
    model.fit(X=x[:, None], y=y[:, None])

    def predict(u: Floats, first: Floats) -> Floats:
        return np.asarray(model.predict(X=u[:, None], y=first[:, None]))[:, 0]

    return predict
