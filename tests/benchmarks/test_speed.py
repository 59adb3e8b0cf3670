"""Speed of the models: `nox -s bench` runs this and writes docs/speed.md from it.

Compilation (numba, cached on disk) happens before the first round and is never counted.
"""

from __future__ import annotations

import os
import resource
from collections.abc import Callable
from pathlib import Path
from typing import Any

import c_kernels
import numpy as np
import peers
import pytest
from workloads import AGAINST_C, ALONE, SIGNALS, Floats, bouc_wen, play_operators, relays, sines, stop_operators

from hystbench import models


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    reason = c_kernels.missing()
    if reason:
        pytest.skip(reason)
    return c_kernels.build(tmp_path_factory.mktemp("roof"))


def measure(benchmark: Any, call: Callable[[], Any], section: str, row: str, rounds: int = 15, **told: Any) -> Any:
    benchmark.extra_info.update(section=section, row=row, load=os.getloadavg()[0], **told)
    return benchmark.pedantic(call, rounds=rounds, warmup_rounds=1, iterations=1)


@pytest.mark.parametrize("signal", SIGNALS)
@pytest.mark.parametrize("name", AGAINST_C)
def test_predict_against_c(benchmark: Any, program: Path, name: str, signal: str) -> None:
    make, timed, same = AGAINST_C[name]
    model, x = make(), SIGNALS[signal]()
    # Just before, so that both see the machine under the same load.
    kernels = c_kernels.run(program, x)
    y = measure(
        benchmark, lambda: model.predict(x), f"c-{signal}", name, samples=x.size, kernel=timed,
        c_median=kernels[timed].median, c_least=kernels[timed].least,
    )  # fmt: skip
    if same is not None:
        benchmark.extra_info["difference"] = difference = float(np.max(np.abs(y - kernels[same].output)) / np.ptp(y))
        # Runge-Kutta's own error is what is left for Bouc-Wen.
        assert difference < (1e-4 if "bouc-wen" in name else 1e-9)


@pytest.mark.parametrize("name", ALONE)
def test_predict(benchmark: Any, name: str) -> None:
    model, x = ALONE[name](), sines()
    measure(benchmark, lambda: model.predict(x), "alone", name, samples=x.size)


@pytest.mark.parametrize("samples", [100_000, 1_000_000, 10_000_000, 100_000_000])
@pytest.mark.parametrize("name", ["prandtl-ishlinskii, 100 plays", "preisach, 5050 relays"])
def test_cost_grows_with_samples(benchmark: Any, name: str, samples: int) -> None:
    x = sines()
    stepper = AGAINST_C[name][0]().stepper()

    def stream() -> None:
        stepper.reset()
        for _ in range(samples // x.size):
            stepper.steps(x)

    measure(benchmark, stream, "samples", f"{name}, {samples:,} samples", 3, samples=samples)
    benchmark.extra_info["peak_mb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


@pytest.mark.parametrize("size", [1, 10, 100, 1000])
def test_blocks(benchmark: Any, size: int) -> None:
    stepper, x = play_operators().stepper(), sines()[:10_000]
    parts = np.split(x, x.size // size)

    def blocks() -> None:
        stepper.reset()
        for part in parts:
            stepper.steps(part)

    measure(benchmark, blocks, "blocks", f"prandtl-ishlinskii, 100 plays, blocks of {size:,}", samples=x.size)


@pytest.mark.parametrize("operators", [10, 100, 1000, 10_000])
def test_cost_does_not_grow_with_plays(benchmark: Any, operators: int) -> None:
    x = sines()
    model = models.get("prandtl-ishlinskii").from_parameters(
        weights=np.full(operators, 1.0 / operators), thresholds=np.arange(operators) / operators
    )
    measure(
        benchmark, lambda: model.predict(x), "operators", f"prandtl-ishlinskii, {operators:,} plays", samples=x.size
    )


@pytest.mark.parametrize("cells", [10, 32, 100, 316])
def test_cost_hardly_grows_with_relays(benchmark: Any, cells: int) -> None:
    model, x = relays(cells), sines()
    row = f"preisach, {cells * (cells + 1) // 2:,} relays"
    measure(benchmark, lambda: model.predict(x), "operators", row, samples=x.size)


@pytest.mark.parametrize("name", [*AGAINST_C, *ALONE])
def test_step(benchmark: Any, name: str) -> None:
    stepper = (AGAINST_C[name][0] if name in AGAINST_C else ALONE[name])().stepper()
    values = sines()[:2000].tolist()

    def steps() -> None:
        stepper.reset()
        for value in values:
            stepper.step(value)

    measure(benchmark, steps, "step", name, samples=len(values))


def decaying(samples: int) -> Floats:
    t = np.linspace(0.0, 1.0, samples)
    return np.sin(60.0 * np.pi * t) * np.exp(-2.0 * t)


LINEAR: dict[str, tuple[str, dict[str, int]]] = {
    "prandtl-ishlinskii, 100 plays": ("prandtl-ishlinskii", {"operators": 100}),
    "preisach, 105 cells": ("preisach", {"levels": 14}),
    "preisach": ("preisach", {}),
    "cubic": ("cubic", {}),
    "linear": ("linear", {}),
    "elastic": ("elastic", {}),
    "modified-prandtl-ishlinskii, 100 plays": ("modified-prandtl-ishlinskii", {"operators": 100}),
}
NONLINEAR = ("bouc-wen", "maxwell-slip", "choi-backlash", "dahl", "duhem", "lugre", "generalized-maxwell-slip",
             "bouc-wen-baber-noori")  # fmt: skip


@pytest.mark.parametrize("name", [*LINEAR, *NONLINEAR])
def test_fit(benchmark: Any, name: str) -> None:
    x = decaying(100_000 if name in LINEAR else 20_000)
    y = bouc_wen(1.5).predict(x) + 0.3 * x**3
    model, hyper = LINEAR.get(name, (name, {}))
    measure(benchmark, lambda: models.get(model)(**hyper).fit(x, y), "fit", name, 3, samples=x.size)


PEERS: dict[str, tuple[Callable[[Floats], Floats], Callable[[], Any], str]] = {
    "NumPy loop, 100 plays": (peers.numpy_plays, play_operators, "numpy"),
    "SciPy odeint, Bouc-Wen n = 1": (peers.scipy_bouc_wen, lambda: bouc_wen(1.0), "scipy"),
    "OpenSeesPy BoucWen, n = 1": (peers.opensees_bouc_wen, lambda: bouc_wen(1.0), "openseespy.opensees"),
    "OpenSeesPy Parallel of 100 ElasticPP": (peers.opensees_stops, stop_operators, "openseespy.opensees"),
}


@pytest.mark.parametrize("name", PEERS)
def test_peer(benchmark: Any, name: str) -> None:
    run, make, package = PEERS[name]
    reason = peers.missing(package)
    if reason:
        pytest.skip(reason)
    x = sines()
    wanted = make().predict(x)
    found = measure(benchmark, lambda: run(x), "peers", name, 3, samples=x.size)
    benchmark.extra_info["difference"] = float(np.max(np.abs(found - wanted)) / np.ptp(wanted))


def test_peer_narx(benchmark: Any) -> None:
    reason = peers.missing("sysidentpy")
    if reason:
        pytest.skip(reason)
    x = sines()
    y = play_operators().predict(x)
    predict = peers.sysidentpy_narx(x[:5000], y[:5000])
    found = measure(
        benchmark,
        lambda: predict(x[:10_000], y[:2]),
        "peers",
        "SysIdentPy NARX, degree 2, 2 lags, fitted to 5,000 samples of 100 plays, then run freely",
        3,
        samples=10_000,
    )
    benchmark.extra_info["difference"] = float(np.max(np.abs(found - y[:10_000])) / np.ptp(y[:10_000]))
