"""Which models a run takes, and that times reach those that use them and no others."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from hystbench import models
from hystbench.bench.arguments import interval_arguments, time_argument
from hystbench.bench.cli import cli
from hystbench.bench.run import plan_run
from hystbench.models.base import HysteresisModel


def extended(name: str) -> bool:
    return bool(getattr(models.get(name), "extended", False))


def test_a_run_leaves_extended_models_out_unless_asked() -> None:
    plain = plan_run(None, ["vsa-minor-loops"], True).models
    assert {"maxwell-slip", "cubic", "bouc-wen", "preisach", "prandtl-ishlinskii", "choi-backlash"} <= set(plain)
    assert not any(extended(name) for name in plain)
    everything = plan_run(["all"], ["vsa-minor-loops"], True).models
    assert everything == models.benchmarked_ids()
    assert "corrected-simulator" not in everything
    assert plan_run(["corrected-simulator"], ["vsa-minor-loops"], True).models == ["corrected-simulator"]
    assert set(everything) - set(plain) == {name for name in everything if extended(name)} != set()
    assert plan_run(["lugre", "cubic", "lugre"], ["vsa-minor-loops"], True).models == ["lugre", "cubic"]


def test_times_go_to_models_that_take_and_use_them() -> None:
    time = np.array([0.0, 0.1, 0.3])

    class Old:
        def predict(self, x: Any, groups: Any = None) -> Any: ...

    class New:
        def predict(self, x: Any, groups: Any = None, *, time: Any = None) -> Any: ...

    assert time_argument(Old().predict, time) == {}
    assert time_argument(New().predict, time) == {"time": time}
    assert time_argument(models.get("lugre")().predict, time) == {"time": time}
    assert time_argument(models.get("cubic")().predict, time) == {}
    truth = models.get("dahl").from_parameters(stiffness=1.0, friction=1.0, exponent=1.0)
    assert interval_arguments(truth.stepper().step, time) == [(), (), ()]
    gms = models.get("lugre").from_parameters(
        stiffness=1.0, damping=0.0, viscous=1.0, coulomb=1.0, static=1.0, stribeck_speed=1.0
    )
    np.testing.assert_allclose(interval_arguments(gms.stepper().step, time), [[0.0], [0.1], [0.2]])


@pytest.mark.parametrize("name", ["lugre", "generalized-maxwell-slip"])
def test_fit_and_predict_on_the_command_line_read_the_time_column(name: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    time = np.cumsum(rng.uniform(0.005, 0.02, 800))
    x = np.sin(2.0 * np.pi * 0.5 * time)
    y = 2.0 * x + 0.5 * np.tanh(5.0 * np.gradient(x, time))
    source, model, out = tmp_path / "loop.csv", tmp_path / "model.json", tmp_path / "out.csv"
    table = np.column_stack([time, x, y])
    np.savetxt(source, table, delimiter=",", header="time_s,deflection_rad,torque_nm", comments="", fmt="%.17g")
    for command in (
        ["fit", str(source), "--model", name, "--out", str(model)],
        ["predict", str(model), str(source), "--out", str(out)],
    ):
        result = CliRunner().invoke(cli, command)
        assert result.exit_code == 0, result.output
    cls: type[HysteresisModel] = models.get(name)
    wanted = cls().fit(x, y, time=time).predict(x, time=time)
    found = np.loadtxt(out, delimiter=",", skiprows=1)[:, 2]
    np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9)
    assert np.max(np.abs(found - cls().fit(x, y).predict(x))) > 1e-6
