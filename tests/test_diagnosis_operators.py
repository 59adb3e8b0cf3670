"""Whether operators with memory and mass are the solutions of their equations."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from simulators import INTERVAL, motion

from hystbench.diagnosis.operators.levels import attracted, yielding
from hystbench.diagnosis.operators.masses import held_by_load, sliding
from hystbench.diagnosis.operators.memory import held_inside, hyperbolic, orifice, plays
from hystbench.diagnosis.operators.smooth_loops import pinched, smooth
from hystbench.diagnosis.operators.superelastic import superelastic
from hystbench.diagnosis.operators.tables import bumps
from hystbench.models.dahl import friction as dahl_friction

Floats = NDArray[np.float64]


def test_a_mass_whose_samples_are_far_apart_stays_on_its_spring() -> None:
    time = np.array([*np.arange(0.0, 1.0, INTERVAL), *np.arange(5.0, 9.0, 0.8)])
    x = np.sin(3.0 * time)
    for frequency in (30.0, 600.0):
        assert np.max(np.abs(sliding(time, x, 0.05, frequency, 0.05, 1.0, 0.0))) < 2.0


@pytest.mark.parametrize("sudden", [False, True])
def test_slip_element_that_is_sudden_slips_on_where_the_motion_stops_and_lets_go_at_once_where_its_level_falls(
    sudden: bool,
) -> None:
    time = np.arange(600) * INTERVAL
    # Forth at full speed, a rest, slowly on, slowly back and then fast.
    x = np.interp(time, [0.0, 1.0, 2.0, 3.0, 4.0, 6.0], [0.0, 1.0, 1.0, 1.1, 1.05, -1.0])
    fast = np.abs(np.gradient(x, time)) > 0.5
    force = attracted(time, x, np.where(fast, 0.5, 1.0), 0.2, 0.3, sudden)
    assert force[95] == pytest.approx(0.1, abs=1e-9)
    # At rest it creeps up to what it holds there, or stays as it is.
    assert force[195] == pytest.approx(0.2 if sudden else 0.1, abs=0.01)
    back = 400 + int(np.argmax(fast[400:]))
    assert force[back - 1] > 0.14
    assert (force[back] < 0.1 + 1e-9) == sudden
    assert force[-1] == pytest.approx(-0.1, abs=1e-6)


@pytest.mark.parametrize("exponent", [0.4, 1.0, 1.0 + 1e-7, 1.6, 2.5])
def test_dahl_friction_is_the_solution_of_its_equation(exponent: float) -> None:
    turns, length, z, wanted = [0.0, 0.3, -0.2, -0.1, -0.5, 0.6], 0.12, 0.0, [0.0]
    for a, b in itertools.pairwise(turns):
        way = np.sign(b - a)
        solved = solve_ivp(
            lambda _, z, way: way / length * np.maximum(1.0 - way * z, 0.0) ** exponent,
            (0.0, abs(b - a)), [z], args=(way,), rtol=1e-9, atol=1e-11, max_step=0.002,
        )  # fmt: skip
        z = float(solved.y[0, -1])
        wanted.append(z)
    found = dahl_friction(np.interp(np.arange(0.0, 5.01, 0.05), np.arange(6.0), turns), length, exponent)
    assert found[::20] == pytest.approx(wanted, abs=1e-5)


def test_dahl_friction_of_hardly_any_exponent_is_a_stop() -> None:
    _, x = motion(20.0, 0.0, 1.0, 2.0)
    stop = (x - plays(x, np.array([0.1]))[:, 0]) / 0.1
    assert dahl_friction(x, 0.1, 1e-9) == pytest.approx(stop, abs=1e-6)


@pytest.mark.parametrize(("pace", "back"), [(0.3, 1.0), (0.3, 4.0), (20.0, 1.0), (0.01, 0.5)])
def test_spring_behind_a_throttle_is_the_solution_of_its_equation(pace: float, back: float) -> None:
    length = 0.05

    def rate(time: float, stretch: Floats) -> list[float]:
        bent = 1.0 if stretch[0] > 0.0 else back
        # The speed at which it leaks: of (q/pace) + bent (q/pace)² = |stretch|/length.
        leak = pace * (np.sqrt(1.0 + 4.0 * bent * abs(stretch[0]) / length) - 1.0) / (2.0 * bent)
        return [1.9 * np.cos(1.9 * time) * 0.5 + 5.3 * np.cos(5.3 * time) * 0.2 - np.sign(stretch[0]) * leak]

    time = np.arange(0.0, 8.0, 0.002)
    x = 0.5 * np.sin(1.9 * time) + 0.2 * np.sin(5.3 * time)
    wanted = solve_ivp(rate, (0.0, 8.0), [0.0], t_eval=time, rtol=1e-8, atol=1e-10, method="LSODA").y[0]
    assert np.max(np.abs(orifice(time, x, length, pace, back) - wanted)) < 5e-3 * np.max(np.abs(wanted))


def test_spring_behind_a_throttle_is_a_spring_where_no_time_passes() -> None:
    x = np.array([0.0, 0.2, 0.5, 0.1])
    assert orifice(np.zeros(4), x, 0.05, 0.3, 1.0) == pytest.approx(x)


def test_bumps_of_a_table_add_up_to_one_and_follow_a_parabola() -> None:
    x, places = np.linspace(-1.0, 1.0, 201), np.linspace(-1.4, 1.4, 29)
    one, intervals = np.ones(29), np.full(29, 0.1)
    assert bumps(x, places, intervals, one) == pytest.approx(1.0)
    # A cubic B-spline widens a parabola by a third of the interval squared.
    assert bumps(x, places, intervals, places**2) == pytest.approx(x**2 + 0.1**2 / 3.0)


def test_hyperbolic_friction_is_half_way_after_its_length_and_does_not_know_time() -> None:
    x = np.concatenate([np.linspace(0.0, 0.1, 11), np.linspace(0.1, -0.5, 61)[1:]])
    f = hyperbolic(x, 0.1)
    assert f[10] == pytest.approx(0.5)
    # From there back the length is 0.1 (1 + f): half of the way from 0.5 to −1.
    assert f[25] == pytest.approx(-0.25)
    finer = hyperbolic(np.interp(np.arange(0.0, x.size - 1, 0.25), np.arange(x.size), x), 0.1)
    assert finer[::4] == pytest.approx(f[:-1])


@pytest.mark.parametrize("pinch", [(), (0.3, 0.1, 0.4), (0.95, 0.9, 0.08), (0.95, 0.005, 1.5)])
@pytest.mark.parametrize(("exponent", "share"), [(1.0, 0.3), (1.0, 1.0), (2.0, 0.6), (7.0, 2.0)])
def test_smooth_and_pinched_loops_are_solutions_of_their_equation(
    exponent: float, share: float, pinch: tuple[float, ...]
) -> None:
    length, turns = 0.15, [0.0, 0.4, -0.05, 0.02, -0.6, -0.55, -0.7, 0.3]
    samples = [np.linspace(a, b, 40)[1:] for a, b in itertools.pairwise(turns)]
    # Noise turns round at any time, and a rest is no turn.
    shaken = turns[-1] + 0.004 * np.random.default_rng(3).standard_normal(30)
    x = np.concatenate([[0.0], *samples, [turns[-1]] * 3, shaken])

    def slope(_: float, z: Floats, way: float) -> Floats:
        into = way * z / length
        level = 1.0 - (share * np.sign(into) + 1.0 - share) * np.abs(into) ** exponent
        depth, place, width = pinch or (0.0, 0.0, 1.0)
        return way * (1.0 - depth * np.exp(-(((into - place) / width) ** 2))) * level

    z, wanted = np.zeros(1), [0.0]
    for step in np.diff(x):
        if step:
            z = solve_ivp(
                slope, (0.0, abs(step)), z, args=(np.sign(step),), rtol=1e-9, atol=1e-10, max_step=0.1 * length
            ).y[:, -1]
        wanted.append(float(z[0]))
    found = pinched(x, length, exponent, share, *pinch) if pinch else smooth(x, length, exponent, share)
    assert found == pytest.approx(wanted, abs=6e-5 * length)


@pytest.mark.parametrize("lowest", [0.3, 1.0])
@pytest.mark.parametrize("exponent", [0.5, 1.0, 2.0, "smooth"])
def test_elements_at_a_level_that_changes_hold_on_to_what_they_held(exponent: float | str, lowest: float) -> None:
    length, share, smoothly = 0.15, 0.6, 2.0
    turns = [0.0, 0.5, -0.05, 0.02, -0.6, -0.55, -0.7, 0.3]
    x = np.concatenate([[0.0], *(np.linspace(a, b, 300)[1:] for a, b in itertools.pairwise(turns))])
    level = lowest + 1.5 * np.sin(np.linspace(0.0, 9.0, x.size)) ** 2

    def share_of_the_way(z: float, way: float, most: float) -> float:
        into = way * z / (length * most)
        if exponent == "smooth":
            return 1.0 - (share * np.sign(into) + 1.0 - share) * abs(into) ** smoothly
        left = 1.0 - into
        return float(np.sign(left) * abs(left) ** float(exponent))

    z, wanted, parts = 0.0, [0.0], 50
    for step, most in zip(np.diff(x), level[1:], strict=True):
        for _ in range(parts):
            z += step / parts * share_of_the_way(z, np.sign(step), most)
        wanted.append(z)
    if exponent == "smooth":
        found = smooth(x, length, smoothly, share, level)
    else:
        found = length * yielding(x, level, length, float(exponent))
    assert found == pytest.approx(wanted, abs=0.005 * length)


def test_spring_that_is_held_inside_a_drive_is_the_solution_of_its_equations() -> None:
    friction, creep, after, damping, hardening = 0.06, 0.01, 1.5, 0.08, 0.75

    def deflection(time: Floats) -> Floats:
        return np.asarray(0.5 * np.sin(1.9 * time) + 0.2 * np.sin(5.3 * time))

    def slopes(time: float, state: Floats) -> list[float]:
        place, built_up = state
        twist = float(deflection(np.array(time))) - place
        speed = (twist + hardening * twist**3 - after * place - friction * built_up) / damping
        return [speed, (speed - abs(speed) * built_up) / creep]

    time = np.arange(0.0, 8.0, 0.002)
    solved = solve_ivp(slopes, (0.0, 8.0), [0.0, 0.0], t_eval=time, rtol=1e-8, atol=1e-10, method="LSODA")
    twist = deflection(time) - solved.y[0]
    wanted = twist + hardening * twist**3
    found = held_inside(time, deflection(time), friction, creep, after, damping, hardening)
    assert np.max(np.abs(found - wanted)) < 3e-3 * np.max(np.abs(wanted))


@pytest.mark.parametrize("by_speed", [False, True])
def test_spring_that_is_held_by_a_load_is_the_solution_of_its_equations(by_speed: bool) -> None:
    friction, frequency, damping, after, hardening, late = 0.05, 18.0, 0.15, 0.4, 0.75, 0.004
    width, excess, pace = 0.05 if by_speed else 0.01, 0.6, 0.3

    def deflection(time: Floats) -> Floats:
        return np.asarray(0.5 * np.sin(1.9 * time) + 0.2 * np.sin(5.3 * time))

    def driven(time: Floats) -> Floats:
        return np.asarray(0.95 * np.cos(1.9 * time) + 1.06 * np.cos(5.3 * time))

    def torque(time: Floats, place: Floats, speed: Floats) -> Floats:
        twist = deflection(time) - place
        return np.asarray(twist + hardening * twist**3 + late * (driven(time) - speed))

    def slopes(time: float, state: Floats) -> list[float]:
        place, speed, built_up = state
        level = 1.0 + excess * np.exp(-((speed / pace) ** 2))
        rubs = level * np.tanh(speed / width) if by_speed else built_up
        pull = float(torque(np.array(time), place, speed)) - after * place - friction * rubs
        return [
            speed,
            frequency**2 * pull - 2.0 * damping * frequency * speed,
            (speed - abs(speed) * built_up / level) / width,
        ]

    time = np.arange(0.0, 8.0, 0.002)
    solved = solve_ivp(slopes, (0.0, 8.0), [0.0, 0.0, 0.0], t_eval=time, rtol=1e-8, atol=1e-10, method="LSODA")
    wanted = torque(time, solved.y[0], solved.y[1])
    # A motion that begins at once pulls the dashpot after the first sample.
    found = held_by_load(
        time, deflection(time), friction, frequency, damping, width, after, hardening, late, excess, pace, by_speed
    )
    assert np.max(np.abs(found - wanted)[1:]) < 5e-4 * np.max(np.abs(wanted))


def test_friction_that_is_strong_beside_the_mass_holds_a_load_however_slowly_it_is_sampled() -> None:
    """By a sign of the speed that is hardly smooth beside what friction does in a step."""

    def swung(rate: float) -> Floats:
        time = np.arange(0.0, 4.0, 1.0 / rate)
        return held_by_load(time, 0.5 * np.sin(6.28 * time), 0.2, 100.0, 0.1, 0.001, 0.5, 0.0, by_speed=True)

    fine, coarse = swung(8000.0)[::80], swung(100.0)
    assert np.std(coarse - fine) < 0.003 * np.std(fine)


@pytest.mark.parametrize("by_speed", [False, True])
def test_spring_that_is_held_by_a_load_stays_bounded_however_slowly_it_is_sampled(by_speed: bool) -> None:
    time = np.arange(0.0, 60.0, 0.05)
    x = 0.5 * np.sin(1.9 * time) + 0.3 * np.sin(13.0 * time)
    found = held_by_load(time, x, 0.01, 200.0, 0.3, 0.05, 5.0, 12.0, 0.01, by_speed=by_speed)
    assert np.max(np.abs(found)) < 20.0


@pytest.mark.parametrize(
    "sizes", [*itertools.product((0.003, 1.8), (1.0, 8.0), (0.003, 3.0), (0.003, 4.5), (0.3, 50.0))]
)
def test_superelastic_wire_stays_bounded_whatever_its_sizes(sizes: tuple[float, ...]) -> None:
    _, x = motion(60.0, 0.0, 1.0, 2.0)
    length, _, after, tail, _ = sizes
    force = superelastic(x + 0.8, *sizes)
    # Between its bounds about the back stress, or elastic before it is at them.
    assert np.max(np.abs(force)) < after * np.max(np.abs(x + 0.8)) + tail + 2.0 * (1.0 + after) * (length + 0.1)


def test_superelastic_wire_does_not_know_how_it_is_sampled() -> None:
    _, x = motion(60.0, 0.0, 1.0, 2.0)
    finer = np.interp(np.arange(0.0, x.size - 1, 0.05), np.arange(x.size), x)
    sizes = 0.13, 2.6, 0.15, 0.1, 4.0
    force = superelastic(x, *sizes)
    assert superelastic(finer, *sizes)[::20] == pytest.approx(force[:-1], abs=2e-4 * np.std(force))
