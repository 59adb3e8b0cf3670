"""The corrected simulator: it closes what the diagnosis says it does, also on a motion that was not recorded."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from joints import sliders
from numpy.typing import NDArray

from hystbench import models
from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.datasets.recording_files import read_recording, write_recording
from hystbench.diagnosis.corrected import calibrated, corrected_simulator, formula
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.operators.memory import lowpass
from hystbench.diagnosis.recording.signals import Signals
from hystbench.diagnosis.result import Diagnosis
from hystbench.errors import InputError

Floats = NDArray[np.float64]
NOISE = 0.01
INTERVAL = 0.01


def motion(low: float, high: float, size: int = 3000) -> tuple[Floats, Floats]:
    """Two tones of changing size from rest."""
    time = np.arange(size) * INTERVAL
    slow, fast = np.sin(2 * np.pi * low * time), np.sin(2 * np.pi * high * time)
    return time, (slow * (0.5 + 0.3 * np.sin(2 * np.pi * 0.043 * time)) + 0.25 * fast) * (1.0 - np.exp(-time / 0.5))


def joint(x: Floats, spring: float = 1.0, friction: float = 1.0) -> Floats:
    """A hardening spring and sliders; each part times a factor."""
    elements = ((5.0 * friction, 0.15 * friction), (1.0 * friction, 0.1 * friction), (0.3 * friction, 0.1 * friction))
    return spring * (4.0 * x + 1.2 * x**3) + sliders(x, elements)


def damped(time: Floats, x: Floats) -> Floats:
    return joint(x) + 0.1 * np.gradient(x, time)


def diagnosed(real: Floats, sim: Floats, time: Floats, x: Floats) -> Diagnosis:
    noise = NOISE * np.random.default_rng(4).standard_normal(x.size)
    return diagnose(Signals(time, x, real + noise, sim, [slice(0, x.size)], {}))


def closed_by(corrected: Floats, real: Floats, sim: Floats) -> float:
    return 1.0 - float(np.mean(np.square(real - corrected)) / np.mean(np.square(real - sim)))


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("damping", [0.0, 0.1])
def test_a_simulator_that_is_off_is_calibrated_anew_in_the_corrected_one(damping: float) -> None:
    made = [(time, x, joint(x) + damping * np.gradient(x, time), joint(x, 0.96, 1.05))
            for time, x in (motion(0.31, 1.13), motion(0.17, 0.83))]  # fmt: skip
    time, x, real, sim = made[0]
    found = diagnosed(real, sim, time, x)
    assert set(found.verdict) == {"miscalibration"} | ({"viscous_friction"} if damping else set())
    corrected = corrected_simulator(found, calibrated(found, None))
    for _, x, real, sim in made:
        assert closed_by(corrected.predict(x), real, sim) > 0.97


def test_what_relaxed_before_the_recording_began_is_told_and_left_out_elsewhere() -> None:
    def relaxing(time: Floats, x: Floats) -> Floats:
        return joint(x) + 1.5 * (x - lowpass(time, x, 3.0))

    time, x = motion(0.31, 1.13, 4000)
    amid = slice(230, None)
    real = relaxing(time, x)[amid]
    found = diagnosed(real, joint(x)[amid], time[amid] - time[230], x[amid])
    assert found.verdict == ["stress_relaxation"]
    told = found.choice.hypothesis.parameters("stress_relaxation")
    assert told["time_constant"] == pytest.approx(3.0, rel=0.03)
    assert told["stiffness"] == pytest.approx(1.5, rel=0.01)
    assert told["held"] == pytest.approx(1.5 * (x - lowpass(time, x, 3.0))[230], abs=0.05)
    assert "held" in formula(found, calibrated(found, None))
    corrected = corrected_simulator(found, calibrated(found, None))
    other = motion(0.17, 0.83)
    assert closed_by(corrected.predict(other[1]), relaxing(*other), joint(other[1])) > 0.99


def pressed(x: Floats, level: Floats, stretch: float) -> Floats:
    """Force of a contact of constant stiffness that gives way at ``level`` (n,)."""
    force, out = 0.0, np.zeros_like(x)
    for i in range(1, x.size):
        force = float(np.clip(force + (x[i] - x[i - 1]) / stretch, -level[i], level[i]))
        out[i] = force
    return out


LAWS = {
    "a bore that narrows both ways": lambda time, x: 0.06 * (1.0 + 1.8 * x**2) * np.gradient(x, time),
    "a bore that narrows one way": lambda time, x: 0.1 * (1.0 + 0.8 * x) * np.gradient(x, time),
    "teeth that spread under load": lambda time, x: (
        0.03 * np.abs(joint(x)) ** 1.2 * np.tanh(np.gradient(x, time) / 0.02)
    ),
    "a wedge": lambda time, x: 0.02 * joint(x) ** 2 * np.tanh(np.gradient(x, time) / 0.02),
    "a sensor that compresses": lambda time, x: joint(x) * (0.15 - 0.008 * np.abs(joint(x))),
    "rollers that are pressed on": lambda time, x: 0.1 * pressed(x, np.abs(joint(x)), 0.05),
}


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("law", LAWS)
def test_a_law_is_the_same_on_a_motion_of_another_size(law: str) -> None:
    def real(time: Floats, x: Floats) -> Floats:
        return joint(x) + LAWS[law](time, x)

    time, x = motion(0.31, 1.13)
    found = diagnosed(real(time, x), joint(x), time, x)
    corrected = corrected_simulator(found, calibrated(found, None))
    again = type(corrected).from_parameters(**corrected.parameters_)
    small, other = motion(0.17, 0.83)
    other = 0.2 * other
    assert closed_by(again.predict(other), real(small, other), joint(other)) > 0.97


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize(("effect", "periods", "size"), [("viscous_friction", 30.0, 0.3), ("inertia", 15.0, 0.01)])
def test_what_a_joint_has_of_its_own_follows_its_own_motion_where_the_encoder_errs(
    effect: str, periods: float, size: float
) -> None:
    """The encoder's error changes so fast along the way that its speed is quite another."""

    def real(time: Floats, x: Floats) -> Floats:
        turned = x
        for _ in range(100):
            turned = x + 0.012 * np.sin(periods * turned - 0.4)
        speed = np.gradient(turned, time)
        return joint(turned) + size * (np.gradient(speed, time) if effect == "inertia" else speed)

    time, x = motion(0.31, 1.13)
    found = diagnosed(real(time, x), joint(x), time, x)
    assert set(found.verdict) == {"encoder_eccentricity", effect}
    (law,) = [reported.law for reported in found.effects if reported.name == effect]
    assert law.endswith(", by the joint's own motion")
    assert "by the deflection that encoder eccentricity leaves:" in formula(found, calibrated(found, None))
    corrected = corrected_simulator(found, calibrated(found, None))
    again = type(corrected).from_parameters(**corrected.parameters_)
    other = motion(0.17, 0.83)
    assert closed_by(again.predict(other[1]), real(*other), joint(other[1])) > 0.97
    told = [{**entry, "behind": "yes"} for entry in corrected.parameters_["effects"]]
    with pytest.raises(InputError, match="behind must be true or false; it is 'yes'"):
        type(corrected).from_parameters(**{**corrected.parameters_, "effects": told})


def test_wear_by_every_turn_goes_on_where_there_are_few() -> None:
    def worn(time: Floats, x: Floats) -> Floats:
        turned = np.diff(x[1:]) * np.diff(x[:-1]) < 0.0
        return joint(x) * (1.0 - 0.001 * np.cumsum(np.r_[0.0, turned, 0.0]))

    time, x = motion(0.31, 1.13)
    x = x + 0.03 * np.sin(2.0 * np.pi * 5.0 * time) * (np.sin(0.55 * time) > 0.0)
    found = diagnosed(worn(time, x), joint(x), time, x)
    assert found.effects[0].law.endswith("of turns")
    corrected = corrected_simulator(found, calibrated(found, None))
    slow = 0.8 * np.sin(2.0 * np.pi * 0.15 * time)
    assert np.sum(np.diff(slow[1:]) * np.diff(slow[:-1]) < 0.0) == 9
    assert closed_by(corrected.predict(slow), worn(time, slow), joint(slow)) > 0.6


def test_a_corrected_simulator_whose_sizes_or_laws_are_none_is_refused() -> None:
    time, x = motion(0.31, 1.13)
    found = diagnosed(damped(time, x), joint(x), time, x)
    made = corrected_simulator(found, calibrated(found, None))
    for wrong in ({"reach": 1.0}, {**made.parameters_["sizes"], "stroke": -1.0}, [1.0, 2.0, 3.0]):
        with pytest.raises(InputError, match="parameter sizes must"):
            type(made).from_parameters(**{**made.parameters_, "sizes": wrong})
    stop = {"effect": "end_stop", "form": "upper, rubbing", "shape": [0.5, 1.0], "coefficients": [1.0, 0.5]}
    with pytest.raises(InputError, match="'upper, rubbing' of end_stop is written otherwise"):
        type(made).from_parameters(**{**made.parameters_, "effects": [stop]})
    # Files from before sizes were told.
    type(made).from_parameters(**{name: value for name, value in made.parameters_.items() if name != "sizes"})


def test_the_formula_says_what_to_scale() -> None:
    time, x = motion(0.31, 1.13)
    found = diagnosed(damped(time, x), joint(x, 0.95, 1.08), time, x)
    told = formula(found, calibrated(found, None))
    spring, friction = (float(value) for value in re.findall(r"times ([0-9.]+[0-9])", told))
    assert spring == pytest.approx(1.0 / 0.95, abs=0.01)
    assert friction == pytest.approx(1.0 / 1.08, abs=0.04)
    assert "damping" in told


def test_the_formula_of_an_effect_that_describes_no_parameters_has_their_values(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    time, x = motion(0.31, 1.13)
    found = diagnosed(damped(time, x), joint(x), time, x)
    (effect,) = [term.effect for term in found.choice.hypothesis.terms]
    monkeypatch.setattr(type(effect), "parameters", ())
    (damping,) = re.findall(r"damping = ([0-9.]+)", formula(found, calibrated(found, None)))
    assert float(damping) == pytest.approx(0.1, rel=0.01)


def test_a_model_is_calibrated_anew_as_a_model_of_its_kind(tmp_path: Path) -> None:
    time, x = motion(0.31, 1.13)
    model = models.get("prandtl-ishlinskii")().fit(x, joint(x, 0.95, 1.06))
    model.save(tmp_path / "model.json")
    real = damped(time, x)
    noise = NOISE * np.random.default_rng(4).standard_normal(x.size)
    write_recording(tmp_path / "real.csv", {"time_s": time, "deflection_rad": x, "torque_nm": real + noise})
    command = ["diagnose", str(tmp_path / "real.csv"), "--sim", str(tmp_path / "model.json"), "--out", str(tmp_path)]
    assert execute(cli, command) == 0
    corrected = models.load(tmp_path / "corrected.json")
    assert corrected.parameters_["base"]["model"] == "prandtl-ishlinskii"
    assert (
        execute(
            cli,
            ["predict", str(tmp_path / "corrected.json"), str(tmp_path / "real.csv"), "--out", str(tmp_path / "p.csv")],
        )
        == 0
    )
    assert closed_by(read_recording(tmp_path / "p.csv").y, real, model.predict(x)) > 0.95


def test_nothing_is_calibrated_beside_an_effect_that_the_file_cannot_hold() -> None:
    # It follows a channel, which a model file does not see: what was calibrated beside it would be wrong without.
    time, x = motion(0.31, 1.13)
    pressure = 1.0 + 0.6 * np.sin(2 * np.pi * 0.021 * time)
    extra = sliders(x, ((8.0, 0.3),)) * pressure
    noise = NOISE * np.random.default_rng(4).standard_normal(x.size)
    sim = joint(x, 0.95, 1.08)
    seen = Signals(time, x, joint(x) + extra + noise, sim, [slice(0, x.size)], {"pressure_bar": pressure})
    found = diagnose(seen)
    assert "load_dependent_friction" in found.verdict
    assert any("pressure_bar" in term.form.name for term in found.choice.hypothesis.terms)
    left_out = corrected_simulator(found, calibrated(found, None))
    assert not left_out.parameters_["effects"]
    assert "not in corrected.json" in formula(found, calibrated(found, None))
    assert np.std(left_out.predict(x) - sim) < 0.02 * np.std(sim)


# ---- warm-ups --------------------------------------------------------------------------------------------------------


def test_a_warm_up_makes_memory_and_is_not_judged() -> None:
    time, x = motion(0.31, 1.13)
    real, sim = damped(time, x) + NOISE * np.random.default_rng(4).standard_normal(x.size), joint(x)
    start = 400
    history = np.arange(x.size) < start
    # Before the first samples that count anything may have been: it changes no figure.
    spoilt = replace(
        Signals(time, x, np.where(history, real + 3.0 * np.exp(-time), real), sim, [slice(0, x.size)], {}),
        warm_up=history,
    )
    found = diagnose(spoilt)
    assert found.verdict == ["viscous_friction"]
    gap = (real - sim)[start:]
    assert found.rmse == pytest.approx(float(np.sqrt(np.mean(gap**2))))
    assert found.closed_in_all > 0.98
