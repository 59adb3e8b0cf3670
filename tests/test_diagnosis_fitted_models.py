"""Fitted models as simulators, and recorded data whose cause is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hardening_joint import NOISE, rich_motion, spring
from numpy.typing import NDArray

from hystbench import datasets, models
from hystbench.bench.cells import fitted_on
from hystbench.datasets import Dataset, DatasetUnavailableError, Recording, concatenate
from hystbench.datasets.recording_files import write_recording
from hystbench.diagnosis.from_benchmark import diagnose_model, gap_signals
from hystbench.diagnosis.inputs import read_inputs
from hystbench.diagnosis.known_causes import KNOWN_CAUSES, KnownCause, known_cause

Floats = NDArray[np.float64]


def test_a_model_that_depends_on_rate_gets_the_recordings_times(tmp_path: Path) -> None:
    time, x = rich_motion(1500)
    model = models.get("lugre")().fit(x, spring(x) + 0.05 * np.gradient(x, time), time=time)
    model.save(tmp_path / "model.json")
    write_recording(tmp_path / "real.csv", {"time_s": time, "deflection_rad": x, "torque_nm": spring(x)})
    signals, _ = read_inputs([tmp_path / "real.csv"], [tmp_path / "model.json"])
    assert np.allclose(signals.y_sim, model.predict(x, time=time), rtol=1e-4, atol=1e-5)


def _sines(rates: tuple[float, ...], amplitudes: tuple[float, ...]) -> list[Recording]:
    made = []
    for k, (rate, amplitude) in enumerate(zip(rates, amplitudes, strict=True)):
        time = np.arange(1200) / 1200.0 * 6.0 / rate
        x = amplitude * np.sin(2 * np.pi * rate * time)
        y = spring(x, 0.0, 0.0) + 0.05 * np.gradient(x, time) + NOISE * np.random.default_rng(k).standard_normal(x.size)
        made.append(Recording(f"{rate} Hz", time, x, y, warm_up=60, channels={"published_nm": y}))
    return made


def test_a_fitted_model_without_rate_lacks_viscous_friction() -> None:
    data = Dataset(
        "made", "made", _sines((0.1, 0.12), (0.8, 0.4)), _sines((0.1, 0.5, 2.0), (0.6, 0.8, 0.5)),
        "other rates", "angle", "rad", "torque", "mN·m", "here", "CC0-1.0", 1e-6, NOISE,
        references={"published": "published_nm"},
    )  # fmt: skip
    model = models.get("prandtl-ishlinskii")().fit(*concatenate(data.train))
    seen = gap_signals(model, data)
    # Warm-ups are there, because they make memory, and are not judged.
    assert seen.x.size == sum(r.x.size for r in data.test)
    assert int(seen.judged.sum()) == sum(r.x.size - r.warm_up for r in data.test)
    assert not seen.channels
    found = diagnose_model(model, data)
    assert found.verdict == ["viscous_friction"]
    assert found.document()["gap"]["unit"] == "mN·m"
    assert diagnose_model(model, data, exclude=("viscous_friction",)).verdict != ["viscous_friction"]


@pytest.mark.parametrize(
    ("dataset", "model"),
    [
        *(("mr-damper", model) for model in ("choi-backlash", "maxwell-slip", "prandtl-ishlinskii")),
        *(
            pytest.param("mr-damper", model, marks=pytest.mark.thorough)
            for model in ("modified-prandtl-ishlinskii", "preisach")
        ),
        *(("pneumatic-seal", model) for model in ("prandtl-ishlinskii", "preisach", "dahl", "linear")),
        pytest.param("friction-backlash-damper", "lugre", marks=pytest.mark.thorough),
        ("friction-backlash-damper", "dahl"),
        ("cycloidal", "dahl"),
        ("cycloidal", "bouc-wen"),
    ],
)
def test_the_known_cause_is_found_in_recorded_data(dataset: str, model: str) -> None:
    cause, verdict = _told(dataset, model)
    assert cause.agrees(verdict)


@pytest.mark.parametrize(
    ("dataset", "model"),
    [
        pytest.param("friction-backlash-damper", "bouc-wen", marks=pytest.mark.thorough),
        pytest.param("cycloidal", "lugre", marks=pytest.mark.thorough),
    ],
)
def test_where_the_known_cause_is_not_found_no_other_is_named(dataset: str, model: str) -> None:
    cause, verdict = _told(dataset, model)
    assert cause.agrees(verdict) or verdict == ["unknown"]


def _told(dataset: str, model: str) -> tuple[KnownCause, list[str]]:
    """The known cause of a model's error on recorded data, and the verdict on that error."""
    try:
        data = datasets.source(dataset).load()
    except DatasetUnavailableError as reason:
        pytest.skip(str(reason))
    fitted, _ = fitted_on(model, data.train)
    cause = known_cause(fitted, dataset)
    assert cause is not None
    return cause, diagnose_model(fitted, data).verdict


def test_known_causes_name_registered_datasets_models_and_effects() -> None:
    from hystbench.diagnosis import registry

    for dataset, cause in KNOWN_CAUSES.items():
        assert dataset in datasets.ids()
        assert cause.effects <= set(registry.ids())
        assert cause.models <= set(models.ids())
    assert known_cause(models.get("lugre"), "mr-damper") is None
