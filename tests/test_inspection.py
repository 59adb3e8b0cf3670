"""`hystbench data check`: each property is planted in a synthetic recording and must be found, and only there."""

from __future__ import annotations

import json
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hystbench import models
from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.datasets import Recording
from hystbench.datasets.findings import Finding, applicable_models, findings
from hystbench.datasets.inspection import Inspection, inspect_recording, quantum

RATE = 500.0
Floats = np.ndarray


def triangle(*turns: float, speed: float = 2.0) -> Floats:
    """Even motion through the given inputs, ``RATE`` samples a second."""
    legs = [np.linspace(a, b, max(round(abs(b - a) / speed * RATE), 10), endpoint=False) for a, b in pairwise(turns)]
    return np.concatenate([*legs, [turns[-1]]])


def stops(x: Floats) -> Floats:
    """A symmetric clockwise loop without rate dependence: wiping-out and congruent."""
    model = models.get("prandtl-ishlinskii").from_parameters(weights=[1.0, -0.3, -0.3], thresholds=[0.0, 0.1, 0.3])
    return np.asarray(model.predict(x))


def recording(x: Floats, y: Floats, time: Floats | None = None) -> Recording:
    return Recording("planted", np.arange(x.size) / RATE if time is None else time, x, y)


def told(
    x: Floats, y: Floats, time: Floats | None = None, names: tuple[str, str] = ("deflection_rad", "torque_nm")
) -> dict[str, Finding]:
    return {one.subject: one for one in findings(inspect_recording(recording(x, y, time)), *names)}


CYCLES = triangle(0.0, *([1.0, -1.0] * 8), 0.0)


def noisy(values: Floats, sigma: float, seed: int) -> Floats:
    return values + sigma * np.random.default_rng(seed).standard_normal(values.size)


# ---- a healthy recording --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("sigma", [0.0, 0.005])
def test_nothing_stands_out_in_a_healthy_recording(sigma: float) -> None:
    x = triangle(0.0, *([1.0, -1.0] * 4), 1.0, 0.2, 0.8, -0.5, -0.1, -1.0, *([0.6, -0.6] * 4), 0.0)
    y = stops(x)
    lines = told(noisy(x, sigma, 1), noisy(y, sigma, 2))
    assert [one.subject for one in lines.values() if one.judged == "warn"] == []
    assert "clockwise" in lines["sense"].text
    assert not lines["sense"].text.startswith("counter")
    assert lines["wiping-out"].judged == "good"
    assert lines["amplitudes"].judged == "good"


# ---- sampling, noise, steps -----------------------------------------------------------------------------------------


def test_gaps_and_jitter_are_found_where_they_are() -> None:
    generator = np.random.default_rng(0)
    intervals = (1.0 + 0.1 * generator.standard_normal(CYCLES.size - 1)) / RATE
    intervals[1000] = 0.05
    intervals[2000] = 0.2
    time = np.concatenate([[0.0], np.cumsum(intervals)])
    found = inspect_recording(recording(CYCLES, stops(CYCLES), time)).sampling
    assert found.interval == pytest.approx(1.0 / RATE, rel=0.02)
    assert found.jitter == pytest.approx(0.1, rel=0.1)
    assert [gap.length for gap in found.gaps] == pytest.approx([0.05, 0.2])
    assert [gap.at for gap in found.gaps] == pytest.approx([time[1000], time[2000]])
    even = inspect_recording(recording(CYCLES, stops(CYCLES), 1e6 + np.arange(CYCLES.size) / RATE)).sampling
    assert (even.jitter, even.gaps) == (0.0, ())


@pytest.mark.parametrize("sigma", [0.002, 0.01])
def test_the_noise_level_is_measured_and_does_not_make_turns(sigma: float) -> None:
    found = inspect_recording(recording(noisy(CYCLES, sigma, 1), noisy(stops(CYCLES), 2.0 * sigma, 2)))
    assert found.x.noise == pytest.approx(sigma, rel=0.1)
    assert found.y.noise == pytest.approx(2.0 * sigma, rel=0.1)
    assert found.coverage.turns == 16
    assert found.coverage.raw_turns > 500
    assert found.closing is not None
    assert found.closing.low < 0.0 < found.closing.high


@given(step=st.floats(1e-4, 0.05), offset=st.floats(-10.0, 10.0), seed=st.integers(0, 99))
def test_the_step_of_quantised_values_is_found(step: float, offset: float, seed: int) -> None:
    x = noisy(np.sin(np.linspace(0.0, 20.0, 3000)), 0.01, seed)
    assert quantum(offset + step * np.round(x / step)) == pytest.approx(step, rel=1e-3)
    assert quantum(offset + x) is None


def test_an_even_motion_has_no_steps() -> None:
    assert quantum(triangle(0.0, 1.0, -1.0, 1.0, speed=1.7)) is None
    assert quantum(np.linspace(0.0, 1.0, 50)) is None


def test_coarse_steps_are_warned_of() -> None:
    y = stops(CYCLES)
    lines = told(CYCLES, 0.02 * np.round(y / 0.02))
    assert lines["y quantisation"].judged == "warn"
    assert "steps of 0.02 N·m" in lines["y quantisation"].text
    assert "x quantisation" not in lines


# ---- loops ----------------------------------------------------------------------------------------------------------


def test_area_and_width_of_a_loop_of_known_size() -> None:
    # A stop of radius 0.1 makes a parallelogram: ∮ y dx = 2 · 0.1 · (2 − 2 · 0.1) · 2 / 2 in a clockwise sense.
    x = CYCLES
    play = np.asarray(
        models.get("prandtl-ishlinskii").from_parameters(weights=[0.0, 1.0], thresholds=[0.0, 0.1]).predict(x)
    )
    found = inspect_recording(recording(x, x - play))
    area = float(np.mean([loop.area for loop in found.main_loops]))
    assert area == pytest.approx(4.0 * 0.1 * (1.0 - 0.1), rel=1e-3)
    assert len(found.loops) == 7
    against = inspect_recording(recording(x, play - x))
    assert np.mean([loop.area for loop in against.main_loops]) == pytest.approx(-area)
    assert told(x, play - x)["sense"].text.startswith("counter-clockwise")


def test_an_elastic_curve_has_no_loop_and_suits_models_without_memory() -> None:
    x = noisy(CYCLES, 0.002, 1)
    y = noisy(CYCLES + 0.3 * CYCLES**3, 0.01, 2)
    lines = told(x, y)
    assert "no loop" in lines["hysteresis"].text
    assert "sense" not in lines
    assert "hysteresis" not in told(x, noisy(stops(CYCLES), 0.01, 2))


def test_branches_that_cross_are_told() -> None:
    x = np.sin(2.0 * np.pi * np.arange(4000) / 500.0)
    y = x + 0.2 * np.sin(2.0 * np.arcsin(np.clip(x, -1, 1))) * np.sign(np.gradient(x))
    assert told(x, y)["crossing"].judged == "warn"
    assert "crossing" not in told(CYCLES, stops(CYCLES))


def test_pinching_is_told() -> None:
    x = np.sin(2.0 * np.pi * np.arange(4000) / 500.0)
    y = 2.0 * x**3 + 0.15 * np.sign(np.gradient(x)) * x**2 * (1.0 - x**8)
    lines = told(x, y)
    assert lines["pinching"].judged == "warn"
    assert "crossing" not in lines
    pinched = judged(inspect_recording(recording(x, y)))
    assert pinched["bouc-wen"] == pinched["prandtl-ishlinskii"] == "partly"
    assert pinched["bouc-wen-baber-noori"] == pinched["preisach"] == "yes"
    assert "pinching" not in told(CYCLES, stops(CYCLES))


def test_asymmetry_is_measured() -> None:
    y = stops(CYCLES)
    lines = told(CYCLES, y + 0.3 * np.maximum(CYCLES, 0.0))
    assert lines["symmetry"].judged == "note"
    assert told(CYCLES, y + 5.0)["symmetry"].judged == "good"


def test_an_open_piece_still_tells_sense_and_width() -> None:
    x = triangle(0.0, 1.0, -1.0, 0.5)
    found = inspect_recording(recording(x, stops(x)))
    assert found.loops == ()
    assert found.main_loops[0].area > 0.0
    assert found.main_loops[0].half_width == pytest.approx(
        inspect_recording(recording(CYCLES, stops(CYCLES))).main_loops[0].half_width, rel=0.15
    )
    monotone = told(np.linspace(0.0, 1.0, 100), np.linspace(0.0, 1.0, 100) ** 2)
    assert monotone["loops"].judged == "unknown"


# ---- memory ---------------------------------------------------------------------------------------------------------

NESTED = triangle(0.0, 1.0, -1.0, 0.5, 0.0, 1.0, 0.2, 0.7, -1.0, -0.2, -0.6, 1.0, -1.0, 0.0, speed=2.0)


def test_wiping_out_holds_for_stops_and_its_violation_is_measured() -> None:
    y = stops(NESTED)
    good = inspect_recording(recording(NESTED, y)).wiping_out
    assert good is not None
    assert good.n == 3
    assert max(abs(good.low), abs(good.high)) < 1e-3
    # A trace of every path that is never wiped out: three nested loops of swings 0.5, 0.5 and 0.4, both ways.
    path = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(NESTED)))])
    bad = inspect_recording(recording(NESTED, y + 0.1 * path)).wiping_out
    assert bad is not None
    assert bad.value * np.ptp(y + 0.1 * path) == pytest.approx(0.1 * 2.0 * (0.5 + 0.5 + 0.4) / 3.0, rel=0.02)
    assert told(NESTED, y + 0.1 * path)["wiping-out"].judged == "warn"
    assert told(CYCLES, stops(CYCLES))["wiping-out"].judged == "unknown"


EQUAL = triangle(0.0, 1.0, -0.2, 0.2, -0.2, 0.2, -1.0, 0.2, -0.2, 0.2, -0.2, 1.0, 0.0)


def test_congruency_holds_for_stops_and_its_violation_is_measured() -> None:
    y = stops(EQUAL)
    good = inspect_recording(recording(EQUAL, y)).congruency
    assert good is not None
    assert good.defect.high < 0.01
    # The small loop is stiffer after a large positive input than after a negative one, as in nothing congruent.
    slack = models.get("prandtl-ishlinskii").from_parameters(weights=[0.0, 1.0], thresholds=[0.0, 0.5]).predict(EQUAL)
    stiffened = y + 0.5 * EQUAL * np.asarray(slack)
    bad = inspect_recording(recording(EQUAL, stiffened)).congruency
    assert bad is not None
    assert bad.defect.low > 0.05
    assert told(EQUAL, stiffened)["congruency"].judged == "warn"
    assert told(EQUAL, y)["congruency"].judged == "good"
    assert told(CYCLES, stops(CYCLES))["congruency"].judged == "unknown"


# ---- rate, drift, softening -----------------------------------------------------------------------------------------


def changing_speeds() -> tuple[Floats, Floats]:
    """The same cycles at speeds of 1, 4, 2, … and the time of each sample."""
    speeds = [1.0, 4.0, 2.0, 1.0, 4.0, 2.0, 4.0, 1.0]
    x = np.concatenate([triangle(-1.0, 1.0, -1.0, speed=v)[:-1] for v in speeds])
    return x, np.gradient(x) * RATE


def test_rate_dependence_is_told_from_its_absence() -> None:
    x, v = changing_speeds()
    still = inspect_recording(recording(x, noisy(stops(x), 0.002, 1)))
    assert still.speed_ratio == pytest.approx(4.0, rel=0.1)
    assert still.rate_width is not None
    assert abs(still.rate_width.value) < 0.03
    assert told(x, noisy(stops(x), 0.002, 1))["rate dependence"].judged == "good"
    width = still.main_loops[0].half_width
    viscous = inspect_recording(recording(x, noisy(stops(x) + 0.1 * width * v, 0.002, 1)))
    assert viscous.rate_width is not None
    # From 1 to 4 a second the half width grows by 0.3 of what it was without, so by 0.3 / 1.2 of the mean.
    assert viscous.rate_width.low < 0.3 / 1.23 < viscous.rate_width.high
    assert told(x, noisy(stops(x) + 0.1 * width * v, 0.002, 1))["rate dependence"].judged == "warn"
    assert told(CYCLES, stops(CYCLES))["rate dependence"].judged == "unknown"


@pytest.mark.parametrize(
    ("subject", "change", "expected"),
    [
        ("drift", lambda y, s: y + 0.3 * s, 0.3 * 6.0 / 8.0 / 2.0),
        ("softening", lambda y, s: y * (1.0 - 0.3 * s), -0.3 * 6.0 / 8.0 / 0.85),
        ("narrowing", lambda y, s: CYCLES * 0.4 + (y - CYCLES * 0.4) * (1.0 - 0.4 * s), -0.1),
    ],
)
def test_what_changes_from_cycle_to_cycle_is_measured(subject: str, change: object, expected: float) -> None:
    share = np.linspace(0.0, 1.0, CYCLES.size)
    before = inspect_recording(recording(CYCLES, stops(CYCLES)))
    for attribute in ("drift", "softening", "narrowing"):
        estimate = getattr(before, attribute)
        assert abs(estimate.value) < 1e-3
    y = change(stops(CYCLES), share)  # type: ignore[operator]
    estimate = getattr(inspect_recording(recording(CYCLES, noisy(y, 0.001, 4))), subject)
    assert estimate.excludes_zero
    assert np.sign(estimate.value) == np.sign(expected)
    if subject != "narrowing":
        main = before.main_loops[0]
        scale = 2.0 / main.range if subject == "drift" else main.height / main.range
        assert estimate.value == pytest.approx(expected * scale, rel=0.1)
    assert told(CYCLES, noisy(y, 0.001, 4))[subject].judged == "warn"


# ---- units and models -----------------------------------------------------------------------------------------------


def test_units_that_cannot_be_are_questioned() -> None:
    y = stops(CYCLES)
    asked = findings(inspect_recording(recording(30.0 * CYCLES, y)), "deflection_rad", "torque_nm")
    assert any("are these degrees" in one.text and one.judged == "warn" for one in asked)
    asked = findings(inspect_recording(recording(0.1 * CYCLES, y)), "angle_deg", "torque_nm")
    assert any("are these radians" in one.text and one.judged == "warn" for one in asked)
    plain = findings(inspect_recording(recording(CYCLES, y)), "angle", "torque_nm")
    assert [one.judged for one in plain if one.subject == "units"] == ["note", "good"]


def judged(found: Inspection) -> dict[str, str]:
    return {one.model: one.judged for one in applicable_models(found)}


def test_models_are_judged_by_what_they_take_for_granted() -> None:
    known = {"bouc-wen", "prandtl-ishlinskii", "preisach", "maxwell-slip", "cubic", "choi-backlash"}
    healthy = judged(inspect_recording(recording(CYCLES, stops(CYCLES))))
    assert {name for name in known if healthy[name] != "yes"} == set()
    why = {one.model: one.why for one in applicable_models(inspect_recording(recording(CYCLES, stops(CYCLES))))}
    assert why["preisach"].endswith("not tested: wiping-out, congruency, rate")
    assert why["lugre"] == "nothing found speaks against it"
    nested = judged(inspect_recording(recording(NESTED, stops(NESTED))))
    assert nested["cubic"] == "partly"
    assert nested["preisach"] == "yes"
    bent = judged(inspect_recording(recording(CYCLES, stops(CYCLES) + 0.3 * np.maximum(CYCLES, 0.0))))
    assert {name for name in known if bent[name] == "partly"} == {"bouc-wen", "prandtl-ishlinskii"}
    x, v = changing_speeds()
    viscous = {one.model: one for one in applicable_models(inspect_recording(recording(x, stops(x) + 0.05 * v)))}
    for name in known:
        assert viscous[name].judged == "partly"
        assert "rate" in viscous[name].why


def test_a_plug_in_can_say_what_it_takes_for_granted(monkeypatch: pytest.MonkeyPatch) -> None:
    class Mine:
        assumes = ("symmetry",)

    bent = inspect_recording(recording(CYCLES, stops(CYCLES) + 0.3 * np.maximum(CYCLES, 0.0)))
    monkeypatch.setattr(models.registry, "ids", lambda: ["mine"])
    monkeypatch.setattr(models, "get", lambda name: Mine)
    (only,) = applicable_models(bent)
    assert (only.model, only.judged) == ("mine", "partly")
    assert "symmetric" in only.why


# ---- hostile input --------------------------------------------------------------------------------------------------


@given(
    values=st.lists(st.floats(-1e6, 1e6, allow_nan=False), min_size=16, max_size=60),
    scale=st.sampled_from([1e-9, 1.0, 1e9]),
)
def test_no_recording_breaks_the_inspection(values: list[float], scale: float) -> None:
    x = scale * np.array(values)
    if np.ptp(x) == 0.0 or np.ptp(x[::-1].cumsum()) == 0.0:
        return
    found = inspect_recording(recording(x, x[::-1].cumsum()))
    assert findings(found, "a", "b")
    assert applicable_models(found)
    json.dumps(found.document(), allow_nan=False)


# ---- the command ----------------------------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    x = noisy(NESTED, 0.002, 1)
    y = noisy(stops(NESTED), 0.002, 2)
    frame = pd.DataFrame({"time_s": np.arange(x.size) / RATE, "deflection_rad": x, "torque_nm": y})
    frame.to_csv(tmp_path / "loop.csv", index=False)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_command_prints_findings_and_models(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(cli, ["data", "check", "loop.csv"]) == 0
    told = capsys.readouterr()
    lines = told.out.splitlines()
    assert any("white noise 0.002" in line for line in lines)
    assert any(line.startswith("? congruency") for line in lines)
    assert [line.split()[0] for line in lines[lines.index("") + 1 :]] == models.benchmarked_ids()
    assert told.err == ""
    pd.read_csv("loop.csv").drop(columns="time_s").to_csv("untimed.csv", index=False)
    assert execute(cli, ["data", "check", "untimed.csv"]) == 0
    assert "samples are numbered" in capsys.readouterr().out


def test_the_command_for_machines(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(cli, ["data", "check", "loop.csv", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "hystbench/check/1"
    assert document["measured"]["coverage"]["turns"] == 12
    assert document["measured"]["congruency"] is None
    assert document["measured"]["wiping_out"]["n"] == 3
    assert {one["model"] for one in document["models"]} == set(models.benchmarked_ids())


class Tags(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.pictures: list[str] = []
        self.sources: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if tag == "svg":
            assert given["role"] == "img"
            self.pictures.append(given["aria-label"] or "")
        self.sources += [value or "" for key, value in attrs if key in ("src", "href", "xlink:href")]


def test_the_page_stands_alone_and_is_the_same_every_time(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pages = []
    for name in ("one", "two"):
        assert execute(cli, ["data", "check", "loop.csv", "--out", name]) == 0
        assert f"{name}/check.html" in capsys.readouterr().err
        pages.append((folder / name / "check.html").read_text(encoding="utf-8"))
    assert pages[0] == pages[1]
    page = Tags(pages[0])
    assert len(page.pictures) == 3
    assert all(source.startswith(("#", "data:")) for source in page.sources)
    assert all(name in pages[0] for name in ("wiping-out", "maxwell-slip", "loop.csv"))


def test_repeated_loops_get_a_picture_of_their_own(folder: Path) -> None:
    frame = pd.DataFrame({"deflection_rad": CYCLES, "torque_nm": stops(CYCLES)})
    frame.to_parquet("cycles.parquet")
    assert execute(cli, ["data", "check", "cycles.parquet", "--out", "o"]) == 0
    assert len(Tags((folder / "o" / "check.html").read_text(encoding="utf-8")).pictures) == 4


def test_names_from_the_file_cannot_write_markup(folder: Path) -> None:
    frame = pd.read_csv("loop.csv").rename(columns={"torque_nm": "<script>alert(1)</script>"})
    frame.to_csv("bad.csv", index=False)
    assert execute(cli, ["data", "check", "bad.csv", "--y", "<script>alert(1)</script>", "--out", "o"]) == 0
    assert "<script" not in (folder / "o" / "check.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere.csv"], ["nowhere.csv", "no such file"]),
        (["loop.csv", "--x", "angle"], ["angle", "--x"]),
        (["loop.csv", "--out", "loop.csv"], ["loop.csv", "folder"]),
        (["constant.csv"], ["constant.csv", "deflection_rad", "constant"]),
    ],
)
def test_bad_input_is_one_line(
    arguments: list[str], words: list[str], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pd.read_csv("loop.csv").assign(deflection_rad=1.0).to_csv("constant.csv", index=False)
    assert execute(cli, ["data", "check", *arguments]) == 2
    told = capsys.readouterr()
    assert (told.out, told.err.count("\n")) == ("", 1)
    assert all(word in told.err for word in words)
