"""Recorded datasets: what the loaders must give, against independent conversions, physical laws and made-up files."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from hystbench import models
from hystbench.bench.cells import data_hash
from hystbench.bench.metrics import score
from hystbench.datasets import Dataset, DatasetUnavailableError, Recording, concatenate, get, ids
from hystbench.datasets.cycloidal import ANGLE_TOLERANCE, Cycloidal, loops
from hystbench.datasets.friction_backlash_damper import PUBLISHED_PREDICTION, FrictionBacklashDamper, scatter
from hystbench.datasets.inspection import inspect_recording
from hystbench.datasets.mr_damper import MrDamper
from hystbench.datasets.pneumatic_seal import PneumaticSeal, effective_area
from hystbench.datasets.recorded import thinned, until_first_turn
from hystbench.datasets.servo_pendulum import ServoLog, ServoPendulum, drive_constants
from hystbench.datasets.steel_coupons import CONSTANT, GROWING, VARIABLE, SteelCoupons
from hystbench.datasets.timber_walls import PLATE, WALL, TimberWalls

RECORDED = (
    "mr-damper",
    "pneumatic-seal",
    "friction-backlash-damper",
    "servo-pendulum",
    "steel-coupons",
    "timber-walls",
    "cycloidal",
)
CSV_DIGITS = 1e-5
"""The conversions were written with six significant digits."""


@cache
def load(name: str) -> Dataset:
    try:
        return get(name)().load()
    except DatasetUnavailableError as error:
        pytest.skip(str(error))


@cache
def recordings(source: type) -> dict[str, Recording]:
    try:
        return source().recordings()
    except DatasetUnavailableError as error:
        pytest.skip(str(error))


def converted(name: str) -> pd.DataFrame:
    folder = Path(os.environ.get("HYSTBENCH_DATA", "nowhere")).parent / "recorded"
    if not folder.is_dir():
        pytest.skip("the independent conversions are not beside HYSTBENCH_DATA")
    return pd.read_csv(folder / name)


def work(recording: Recording) -> float:
    x, y = recording.x[recording.warm_up :], recording.y[recording.warm_up :]
    return float(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(x)))


def assert_same(found: np.ndarray, expected: pd.Series, offset: float = 0.0) -> None:
    values = expected.to_numpy(np.float64)
    assert found.shape == values.shape
    assert found == pytest.approx(values - offset, rel=CSV_DIGITS, abs=CSV_DIGITS * np.abs(values).max())


# ---- what every recorded dataset must be ---------------------------------------------------------------------------


@pytest.mark.parametrize("name", RECORDED)
def test_datasets_are_complete_and_the_same_every_time(name: str) -> None:
    assert name in ids()
    data = load(name)
    assert data.kind == get(name).kind == "recorded"
    assert data.licence == get(name).licence
    assert all((data.title, data.split, data.source, data.x_name, data.y_name, data.x_unit, data.y_unit))
    assert data.assumptions
    assert data_hash(data) == data_hash(get(name)().load())
    parts = [*data.train, *data.test]
    assert len({r.name for r in parts}) == len(parts)
    assert sum(r.x.size for r in data.train) < 7000
    assert sum(r.x.size for r in data.test) < 7000
    for recording in parts:
        assert recording.time[0] == 0.0
        assert np.all(np.diff(recording.time) > 0.0)
        assert recording.conditions
        for series in (recording.x, recording.y, *recording.channels.values()):
            assert np.all(np.isfinite(series))
        # Something must be left to score, and the noise must be small against the signal.
        assert recording.warm_up < recording.x.size // 2
        assert 0.0 < data.x_sigma < 0.02 * np.ptp(recording.x)
        assert 0.0 < data.y_sigma < 0.02 * np.ptp(recording.y)


@pytest.mark.parametrize("name", RECORDED)
def test_recorded_loops_dissipate(name: str) -> None:
    data = load(name)
    for recording in (*data.train, *data.test):
        assert work(recording) > 0.0, recording.name


@pytest.mark.parametrize("name", RECORDED)
def test_absent_files_are_said_to_be_absent(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HYSTBENCH_DATA", str(tmp_path))
    with pytest.raises(DatasetUnavailableError, match=f"hystbench data fetch {name}"):
        get(name)().load()


# ---- against independent conversions -------------------------------------------------------------------------------


def test_the_mr_damper_equals_the_conversion() -> None:
    found = recordings(MrDamper)
    assert len(found) == 18
    for recording in found.values():
        amplitude, frequency, current = (part.split()[0] for part in recording.name.split(", "))
        table = converted(f"mr_damper_sine/amp{int(amplitude):02d}mm_{frequency}hz_{float(current):.2f}a.csv")
        thin = thinned(recording, -(-recording.x.size // len(table)))
        assert_same(thin.time, table["time_s"])
        assert_same(thin.x, table["displacement_mm"])
        assert_same(thin.y, table["force_n"])
        assert_same(thin.channels["velocity_mm_s"], table["velocity_mm_s"])


def test_the_unfiltered_mr_damper_equals_the_conversion() -> None:
    table = converted("mr_damper_sine/raw_unfiltered_2mm5Hz_all_currents.csv")
    recording = MrDamper().unfiltered()
    thin = thinned(recording, -(-recording.x.size // len(table)))
    assert_same(thin.time, table["time_s"])
    assert_same(thin.x, table["displacement_mm"])
    assert_same(thin.y, table["force_n"])


def test_the_pneumatic_seal_equals_the_conversion() -> None:
    found = recordings(PneumaticSeal)
    assert len(found) == 8
    for recording in found.values():
        seal, bar = recording.name.lower().split(", ")
        table = converted(f"pneumatic_seal_friction/{seal}_{bar.replace(' ', '')}.csv")
        thin = thinned(recording, -(-recording.x.size // len(table)))
        assert_same(thin.time, table["time_s"], offset=table["time_s"].iloc[0])
        assert_same(thin.x, table["displacement_mm"])
        assert_same(thin.channels["pressure_bar"], table["pressure_bar"])
        assert_same(thin.channels["force_n"], table["force_n"])


def with_prediction() -> list[Recording]:
    return [r for r in recordings(FrictionBacklashDamper).values() if PUBLISHED_PREDICTION in r.channels]


def test_the_friction_damper_equals_the_conversion() -> None:
    for recording in with_prediction():
        amplitude, frequency = recording.name.removesuffix(" Hz").split(" in, ")
        table = converted(f"brfd_friction_backlash/amp{float(amplitude):.1f}in_{frequency}hz_36lb.csv")
        thin = thinned(recording, round(recording.x.size / len(table)))
        assert_same(thin.time, table["time_s"])
        assert_same(thin.x, table["displacement_m"])
        assert_same(thin.y, table["force_n"])
        assert_same(thin.channels["velocity_m_s"], table["velocity_m_s"])
        assert_same(thin.channels[PUBLISHED_PREDICTION], table["lugre_published_force_n"])


def test_the_friction_damper_at_other_tensions_equals_the_conversion() -> None:
    for tension in (20, 25, 70):
        recording = recordings(FrictionBacklashDamper)[f"1 in, 1 Hz, {tension} lb"]
        table = converted(f"brfd_friction_backlash/tension_series_1hz_{tension}lb.csv")
        thin = thinned(recording, round(recording.x.size / len(table)))
        assert_same(thin.x, table["displacement_m"])
        assert_same(thin.y, table["force_n"])
        assert_same(thin.channels["velocity_m_s"], table["velocity_m_s"])


def test_the_published_lugre_prediction_scores_as_tabulated() -> None:
    table = converted("brfd_friction_backlash/published_lugre_errors.csv").set_index(["amplitude", "frequency_hz"])
    for recording in with_prediction():
        amplitude, frequency = recording.name.removesuffix(" Hz").split(" in, ")
        row = table.loc[(f"{float(amplitude):.1f}in", float(frequency))]
        scores = score(recording.y, recording.channels[PUBLISHED_PREDICTION])
        assert scores["n"] == row["n"]
        assert scores["rmse"] == pytest.approx(row["lugre_rmse_n"], rel=CSV_DIGITS)
        assert scores["nrmse"] == pytest.approx(row["lugre_nrmse"], rel=CSV_DIGITS)


def test_the_servo_logs_equal_the_conversion() -> None:
    for recording in recordings(ServoPendulum).values():
        trajectory, gain = recording.name.split(", gain ")
        table = converted(f"bam_xl330_pendulum/{trajectory}_kp{gain}.csv")
        cut = (len(table) - recording.x.size) // 2
        table = table.iloc[cut:-cut]
        assert_same(recording.time, table["time_s"], offset=table["time_s"].iloc[0])
        assert_same(recording.x, table["position_rad"])
        for channel in (
            "goal_position_rad",
            "speed_rad_s",
            "pwm_duty",
            "supply_v",
            "temperature_c",
            "gravity_torque_nm",
        ):
            assert_same(recording.channels[channel], table[channel])


def test_the_steel_coupons_equal_the_conversion() -> None:
    names = {CONSTANT: "resspylab_example_1", VARIABLE: "resspylab_example_2", GROWING: "hem320c_lp8"}
    for name, recording in recordings(SteelCoupons).items():
        table = converted(f"steel_cyclic_coupons/{names[name]}.csv")
        assert_same(recording.x, table["strain"])
        assert_same(recording.y, table["stress_mpa"])
        if "time_s" in table:
            assert_same(recording.time, table["time_s"], offset=table["time_s"].iloc[0])


def test_the_timber_walls_equal_the_conversion() -> None:
    plate, table = recordings(TimberWalls)[PLATE], converted("timber_wall_dampers/perforated_plate_spc1.csv")
    assert_same(plate.time[::2], table["sample"])
    assert_same(plate.x[::2], table["displacement_mm"])
    assert_same(plate.y[::2], table["force_kn"])
    wall, table = recordings(TimberWalls)[WALL], converted("timber_wall_dampers/clt_wall_ts1.csv")
    assert_same(wall.x, table["drift_ratio_or_disp"])
    assert_same(wall.y, table["shear_force"])


def test_the_cycloidal_loops_equal_the_conversion() -> None:
    files = {"initial": "initial", "after run-in": "after_runin"}
    files |= {f"preload {share} %": f"preload{share:03d}" for share in (25, 50, 75, 100)}
    found = recordings(Cycloidal)
    assert len(found) == 16
    for name, recording in found.items():
        prototype, test, state = name.split(", ")
        table = converted(f"cycloidal_backlash/mean_{test}_{prototype.split()[0]}_{files[state]}.csv")
        assert_same(recording.x, table["deflection_rad"])
        assert_same(recording.y, table["torque_nm"])


# ---- the known cause is in the data --------------------------------------------------------------------------------


def test_the_force_of_the_mr_damper_grows_with_speed() -> None:
    peaks = {r.name: np.quantile(np.abs(r.y[r.warm_up :]), 0.9) for r in load("mr-damper").train}
    assert peaks["25 mm, 0.5 Hz, 0.5 A"] > 1.15 * peaks["25 mm, 0.1 Hz, 0.5 A"]


def test_the_loops_of_the_mr_damper_repeat_at_half_an_ampere_only() -> None:
    def spread(name: str) -> float:
        areas = [loop.area for loop in inspect_recording(recordings(MrDamper)[name]).main_loops]
        return float(np.ptp(areas) / np.mean(areas))

    for frequency in (0.1, 0.25):
        assert spread(f"25 mm, {frequency} Hz, 0.5 A") < 0.01
        for current in (0, 1):
            assert spread(f"25 mm, {frequency} Hz, {current} A") > 0.04


def test_stick_slip_of_the_friction_damper_bounds_what_a_function_of_the_motion_can_reach() -> None:
    shares = {}
    for recording in with_prediction():
        kept = slice(recording.warm_up, None)
        published = score(recording.y[kept], recording.channels[PUBLISHED_PREDICTION][kept])["nrmse"]
        shares[recording.name] = scatter(recording) / published
    tested = [shares[r.name] for r in load("friction-backlash-damper").test]
    assert min(tested) == pytest.approx(0.18, abs=0.01)
    assert max(tested) == pytest.approx(0.40, abs=0.01)


def test_scatter_is_that_of_the_cycles_alone() -> None:
    phase = np.arange(8 * 1024) / 1024.0
    x = np.sin(2.0 * np.pi * phase)
    y = 10.0 * np.sign(np.cos(2.0 * np.pi * phase + 0.3))
    conditions = {"frequency": "1 Hz"}
    assert scatter(Recording("made up", phase, x, y, conditions=conditions)) == 0.0
    noisy = y + 0.5 * np.random.default_rng(0).standard_normal(y.size)
    found = scatter(Recording("made up", phase, x, noisy, conditions=conditions))
    assert found == pytest.approx(0.5 / np.ptp(noisy), rel=0.02)


def test_an_asymmetric_model_beats_the_published_one_on_the_friction_damper() -> None:
    data = load("friction-backlash-damper")
    model = models.get("modified-prandtl-ishlinskii")()
    x, y, groups = concatenate(data.train)
    model.fit(x, y, groups=groups)
    ratios = []
    for recording in data.test:
        kept = slice(recording.warm_up, None)
        published = score(recording.y[kept], recording.channels[PUBLISHED_PREDICTION][kept])["nrmse"]
        ratios.append(score(recording.y[kept], model.predict(recording.x)[kept])["nrmse"] / published)
    # The target of 0.65 is met on four of seven tests; 0.5 in at 2 Hz is as bad as published.
    assert sum(ratio <= 0.65 for ratio in ratios) >= 4
    assert np.mean(ratios) < 0.7
    assert max(ratios) < 1.1


def test_the_friction_of_the_seal_grows_with_pressure() -> None:
    widths = []
    data = load("pneumatic-seal")
    for recording in sorted((*data.train, *data.test), key=lambda r: r.channels["pressure_bar"].mean()):
        middle = (recording.x > 10.0) & (recording.x < 25.0)
        rising = np.gradient(recording.x) > 0.0
        strokes = [recording.y[middle & side] for side in (rising, ~rising)]
        widths.append(0.5 * (np.median(strokes[0]) - np.median(strokes[1])))
        # Both strokes lie about evenly around no friction: the pressure force is gone.
        assert abs(np.median(strokes[0]) + np.median(strokes[1])) < 0.5 * (
            np.median(strokes[0]) - np.median(strokes[1])
        )
    assert np.all(np.diff(widths) > 0.5)


def test_wear_widens_the_play_of_the_cycloidal_drive() -> None:
    def play(state: str) -> float:
        loop = recordings(Cycloidal)[f"conic disk, play, {state}"]
        return float(np.ptp(loop.x))

    assert play("after run-in") > 1.5 * play("initial")
    assert play("preload 25 %") > 1.5 * play("preload 100 %")


def test_blocks_of_the_timber_protocol_are_whole_cycles_about_their_primary() -> None:
    data = load("timber-walls")
    for block in (*data.train, *data.test):
        size = float(block.conditions["primary"].split()[0])
        assert np.abs(block.x).max() == pytest.approx(size, abs=0.1)
        # After the primary cycle the trailing cycles reach three quarters of it.
        assert block.x[block.warm_up :].max() == pytest.approx(0.75 * size, rel=0.03)


# ---- made-up files: the parsers without the data -------------------------------------------------------------------


def servo_log(gain: int, frequency: float) -> tuple[ServoLog, np.ndarray]:
    """A made-up log of a servo of known constants and Coulomb friction, and that friction."""
    time = 0.0034 + np.arange(1200) * 0.00525
    omega = 2.0 * np.pi * frequency
    position, speed = 0.8 * np.sin(omega * time), 0.8 * omega * np.cos(omega * time)
    friction = 0.04 * np.sign(speed)
    torque = 0.49 * 9.80665 * 0.1 * np.sin(position) - 0.007 * omega**2 * position + friction
    counts = np.round((9.0 * torque + 0.4 * speed) / 7.4 * 885.0).astype(int)
    entries = [
        {
            "position": p, "speed": s, "load": int(c) % 65536, "input_volts": 7.3, "temp": 30, "timestamp": t,
            "goal_position": p, "torque_enable": True,
        }
        for p, s, c, t in zip(position, speed, counts, time, strict=True)
    ]  # fmt: skip
    document = {"mass": 0.49, "length": 0.1, "kp": gain, "vin": 7.4, "trajectory": "made up", "entries": entries}
    return ServoLog(document), friction


def test_inverse_dynamics_recovers_the_constants_and_the_friction_of_a_made_up_servo() -> None:
    pairs = [servo_log(200, 0.7), servo_log(800, 1.6)]
    constants = drive_constants([log for log, _ in pairs])
    assert constants[0] == pytest.approx(9.0, rel=0.01)
    assert constants[1] / constants[0] == pytest.approx(0.007, rel=0.03)
    assert constants[2] == pytest.approx(0.4, rel=0.03)
    assert constants[3] / constants[0] == pytest.approx(0.04, rel=0.03)
    for log, friction in pairs:
        recording = log.recording(constants)
        cut = (friction.size - recording.x.size) // 2
        moving = np.abs(log.speed[cut:-cut]) > 0.5
        assert recording.y[moving] == pytest.approx(friction[cut:-cut][moving], abs=4e-3)
        assert np.abs(recording.channels["pwm_duty"]).max() < 1.0


def test_loops_come_back_from_a_figure_to_the_precision_of_its_digits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    angle = np.linspace(0.0, 2.0 * np.pi, 60)
    labels = {"initial": "initial", "after run-in": "after run-in"}
    figure = Figure(figsize=(13.5, 5.0))
    drawn = {}
    for axes, title, size in zip(figure.subplots(1, 2), ("Play tests", "Stiffness tests"), (4.0, 25.0), strict=True):
        for k, label in enumerate(labels):
            torque, degrees = size * np.sin(angle), 0.1 * size * np.sin(angle - 0.3 - 0.2 * k)
            axes.plot(torque, degrees, label=label, linewidth=1.5)
            drawn[title.split()[0].lower(), label] = torque, degrees
        axes.set(title=title, xlabel="Motor Torque [Nm]", ylabel="Deflection [deg]")
        axes.grid(True)
    axes.legend()
    path = tmp_path / "figure.svg"
    with matplotlib.rc_context({"svg.fonttype": "none", "path.simplify": False}):
        figure.savefig(path)
    found = loops(path)
    assert len(found) == 4
    for (test, _), state, torque, degrees in found:
        expected = drawn[test, state]
        assert torque == pytest.approx(expected[0], abs=1e-5 * 50.0)
        assert np.deg2rad(degrees) == pytest.approx(np.deg2rad(expected[1]), abs=0.01 * ANGLE_TOLERANCE)


def test_the_effective_area_is_free_of_friction() -> None:
    x = 20.0 + 20.0 * np.sin(np.linspace(0.0, 40.0, 4000))
    tests = []
    for bar in (1.0, 5.0):
        pressure = bar + 0.1 * np.sign(np.gradient(x))
        force = 49.0 * pressure + 2.0 * bar * np.sign(np.gradient(x))
        tests.append(np.array([x, x, x, x, x, pressure, force]))
    assert effective_area(tests) == pytest.approx(49.0, rel=1e-3)


def test_thinning_keeps_channels_together_and_the_warm_up_in_place() -> None:
    x = np.sin(np.linspace(0.0, 20.0, 1001))
    recording = Recording("made up", np.arange(1001.0), x, 2.0 * x, warm_up=101, channels={"double": 2.0 * x})
    thin = thinned(recording, 4)
    assert np.array_equal(thin.y, 2.0 * thin.x)
    assert np.array_equal(thin.channels["double"], thin.y)
    assert thin.time[thin.warm_up] >= recording.time[recording.warm_up]
    assert thin.time[thin.warm_up - 1] < recording.time[recording.warm_up]


def test_the_warm_up_ends_at_the_first_turn_that_counts() -> None:
    x = np.concatenate([np.linspace(0.0, 0.02, 20), np.linspace(0.02, 0.0, 20), np.linspace(0.0, 1.0, 100)])
    x = np.concatenate([x, np.linspace(1.0, -1.0, 200)])
    settled = until_first_turn(Recording("made up", np.arange(x.size, dtype=float), x, x), 0.05)
    assert settled.x[settled.warm_up] == 1.0
