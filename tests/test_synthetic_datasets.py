"""The synthetic plants: the published loop to its last digit, memory laws, and an independent integration."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hystbench.datasets import get, ids
from hystbench.datasets.published_loop import DESCENDING, TRANSITION_NEG, TRANSITION_POS, VERTICES
from hystbench.datasets.trajectories import decaying, reversals, sines
from hystbench.datasets.vsa_minor_loops import minor_loop_plant
from hystbench.datasets.vsa_physical import CONSTANTS, physical_plant
from hystbench.datasets.vsa_published import published_plant

SYNTHETIC = ("vsa-published", "vsa-minor-loops", "vsa-physical")
PLANTS = (published_plant, minor_loop_plant, physical_plant)


def motion(*points: float, step: float = 0.002) -> np.ndarray:
    pieces = [np.linspace(a, b, max(2, round(abs(b - a) / step) + 1))[1:] for a, b in pairwise(points)]
    return np.concatenate([[points[0]], *pieces])


def clock(x: np.ndarray) -> np.ndarray:
    return 0.01 * np.arange(x.size)


@pytest.mark.parametrize("name", SYNTHETIC)
def test_datasets_are_complete_and_the_same_every_time(name: str) -> None:
    assert name in ids()
    one, other = get(name)().load(), get(name)().load()
    assert one.kind == "synthetic"
    assert one.plant is not None
    assert one.split
    assert one.source
    assert one.licence
    assert one.assumptions
    assert one.x_unit == "rad"
    assert one.y_unit == "N·m"
    for part, same in ((one.train, other.train), (one.test, other.test)):
        for recording, again in zip(part, same, strict=True):
            assert np.array_equal(recording.y, again.y)
            assert np.all(np.diff(recording.time) > 0)
            assert recording.y == pytest.approx(one.plant(recording.time, recording.x), abs=1e-12)
            assert 0 < recording.warm_up < recording.x.size // 2


@pytest.mark.parametrize("name", SYNTHETIC)
def test_train_and_test_differ(name: str) -> None:
    data = get(name)().load()
    turns = []
    for part in (data.train, data.test):
        turns.append({round(float(v), 3) for r in part for v in r.x[1:-1][np.diff(r.x)[1:] * np.diff(r.x)[:-1] < 0]})
    if name == "vsa-published":
        assert data.train[0].time[1] != data.test[0].time[1]
    else:
        assert len(turns[1] - turns[0]) > 0.5 * len(turns[1])


def test_the_published_plant_passes_through_every_vertex_of_tables_1_and_2() -> None:
    # The second of two full cycles visits the vertices exactly; A lies on the way up at 0 after the first cycle.
    up = sorted({VERTICES[n][0] for n in "JKLABC"} | {p[0] for p in TRANSITION_POS})
    down = sorted({VERTICES[n][0] for n in "DEFGHI"} | {p[0] for p in TRANSITION_NEG}, reverse=True)
    x = np.array([0.0, 1.0, *down, *up, *down, *up])
    y = published_plant(clock(x), x)
    last = x.size - len(up)
    rising = dict(zip(x[last:].tolist(), y[last:].tolist(), strict=True))
    falling = dict(zip(x[last - len(down) : last].tolist(), y[last - len(down) : last].tolist(), strict=True))
    for name in "JKLABC":
        assert rising[VERTICES[name][0]] == pytest.approx(VERTICES[name][1], abs=1e-9)
    for name in "DEFGHI":
        assert falling[VERTICES[name][0]] == pytest.approx(VERTICES[name][1], abs=1e-9)
    for px, py in TRANSITION_POS[:-1]:
        assert rising[px] == pytest.approx(py, abs=1e-9)
    for px, py in TRANSITION_NEG:
        assert falling[px] == pytest.approx(py, abs=1e-9)
    assert DESCENDING[0].tolist() == [1.0, 5.02]


@pytest.mark.parametrize("plant", PLANTS)
def test_closed_loops_dissipate(plant) -> None:
    for low, high in ((-1.0, 1.0), (-0.5, 0.8), (0.1, 0.6), (-0.9, -0.3)):
        x = motion(0.0, high, low, high, low, high)
        y = plant(clock(x), x)
        start = x.size - motion(high, low, high).size
        work = np.sum(0.5 * (y[start + 1 :] + y[start:-1]) * np.diff(x[start:]))
        assert work > 0.0


@pytest.mark.parametrize("plant", PLANTS[:2])
def test_an_inner_loop_is_wiped_out_when_it_closes(plant) -> None:
    plain, nested = motion(0.0, 0.9, -0.6, 0.7), motion(0.0, 0.9, -0.6, 0.4, -0.1, 0.4, 0.7)
    a, b = plant(clock(plain), plain), plant(clock(nested), nested)
    tail = motion(0.4, 0.7).size - 2
    assert b[-tail:] == pytest.approx(np.interp(nested[-tail:], plain[-tail - 1 :], a[-tail - 1 :]), abs=2e-3)


def test_only_the_physical_plant_depends_on_rate() -> None:
    x = motion(0.0, 1.0, -1.0, 1.0)
    for plant in PLANTS:
        slow, fast = (plant(rate * clock(x), x) for rate in (1.0, 0.1))
        gap = np.abs(slow - fast).max()
        assert gap > 0.05 if plant is physical_plant else gap == 0.0


def test_the_physical_plant_equals_an_independent_integration() -> None:
    time = np.linspace(0.0, 6.0, 6001)
    speed = 2.0 * np.pi * 0.4

    def theta(t: float) -> float:
        return 0.9 * np.sin(speed * t)

    c = CONSTANTS
    l1, l3, presliding = c["crank_m"], c["link_m"], c["presliding_rad"]

    def geometry(angle: float) -> tuple[float, float]:
        l2 = np.sqrt(l1**2 + l3**2 - 2.0 * l1 * l3 * np.cos(angle))
        return 2.0 * (l1 + l2 - l3), l1 * l3 * np.sin(angle) / l2

    def rates(t: float, state: np.ndarray) -> list[float]:
        angular = 0.9 * speed * np.cos(speed * t)
        stretching = 2.0 * geometry(theta(t))[1] * angular
        return [
            c["branch_1_stiffness_n_m"] * stretching - state[0] / c["branch_1_time_s"],
            c["branch_2_stiffness_n_m"] * stretching - state[1] / c["branch_2_time_s"],
            (angular - state[2] * abs(angular)) / presliding,
        ]

    solved = solve_ivp(rates, (0.0, 6.0), [0.0, 0.0, 0.0], t_eval=time, rtol=1e-9, atol=1e-10, max_step=0.01)
    expected = []
    for t, f1, f2, bristle in zip(time, *solved.y, strict=True):
        stretch, lever = geometry(theta(t))
        force = c["preload_n"] + c["belt_stiffness_n_m"] * stretch + f1 + f2
        expected.append(c["branches"] * force * (lever + 2.0 * c["friction_arm_m"] * bristle))
    found = physical_plant(time, 0.9 * np.sin(speed * time))
    assert np.abs(found - expected).max() < 2e-3 * np.ptp(expected)


def test_trajectories() -> None:
    time, x = reversals([0.0, 1.0, -1.0], speed=0.5, rate=100.0)
    assert np.abs(np.diff(x)).max() == pytest.approx(0.005)
    assert time[-1] == pytest.approx(6.0, abs=0.011)
    points = decaying(1.0, 0.1, 5)
    assert points[0] == 0.0
    assert np.all(np.diff(np.abs(points[1:])) < 0)
    assert np.all(np.array(points[1:-1]) * np.array(points[2:]) < 0)
    time, x = sines([1.0, 0.5], [1.0, 2.0], [2, 4], rate=200.0)
    assert x.size == time.size == 800
    assert np.abs(x[:400]).max() == pytest.approx(1.0, abs=1e-3)
    assert np.abs(x[400:]).max() == pytest.approx(0.5, abs=1e-3)
