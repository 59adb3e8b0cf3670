"""Whether the operators of matter that changes, flows, breaks away, leaks, aligns or yields are the solutions of their equations."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from simulators import motion

from hystbench.diagnosis.operators.chambers import chamber
from hystbench.diagnosis.operators.kernels import kernel
from hystbench.diagnosis.operators.levels import elastoplastic
from hystbench.diagnosis.operators.magnetic import magnetised
from hystbench.diagnosis.operators.memory import plays
from hystbench.diagnosis.operators.steel import yielding_again
from hystbench.diagnosis.operators.viscoplastic import viscoplastic

Floats = NDArray[np.float64]


def course(interval: float) -> tuple[Floats, Floats]:
    time = np.arange(0.0, 8.0, interval)
    return time, 0.5 * np.sin(1.9 * time) + 0.2 * np.sin(5.3 * time)


def speed(time: float) -> float:
    return float(1.9 * np.cos(1.9 * time) * 0.5 + 5.3 * np.cos(5.3 * time) * 0.2)


@pytest.mark.parametrize(("tau", "power"), [(0.02, 1.0), (0.5, 1.0), (0.05, 2.5), (0.002, 1.0), (0.05, 0.6)])
def test_viscoplastic_slider_is_the_solution_of_its_equation(tau: float, power: float) -> None:
    level = 0.1

    def rate(time: float, stretch: Floats) -> list[float]:
        over = max(abs(stretch[0]) / level - 1.0, 0.0)
        return [speed(time) - np.sign(stretch[0]) * level / tau * over**power]

    time, x = course(0.01)
    wanted = solve_ivp(rate, (0.0, 8.0), [0.0], t_eval=time, rtol=1e-8, atol=1e-10, method="LSODA", max_step=0.01).y[0]
    assert np.max(np.abs(viscoplastic(time, x, level, tau, power) - wanted)) < 2e-3 * np.max(wanted)


def test_viscoplastic_slider_that_flows_at_once_is_a_stop_and_one_that_never_does_a_spring() -> None:
    time, x = course(0.01)
    stop = viscoplastic(time, x, 0.1, 1e-9, 1.0)
    assert np.max(np.abs(stop)) == pytest.approx(0.1)
    assert viscoplastic(time, x, 0.1, 1e12, 1.0) == pytest.approx(x)
    assert viscoplastic(np.zeros(4), np.array([0.0, 0.3, 0.6, 0.1]), 0.1, 0.5, 1.0)[-1] == pytest.approx(0.1)


@pytest.mark.parametrize(("breakaway", "damping"), [(0.2, 0.0), (0.7, 0.0), (0.7, 0.05), (0.99, 0.0)])
def test_elasto_plastic_bristle_is_the_solution_of_its_equation(breakaway: float, damping: float) -> None:
    length = 0.08

    def share(stretch: float, time: float) -> float:
        """Of the way that is elastic, where it yields at one."""
        if stretch * speed(time) <= 0.0 or abs(stretch) < breakaway:
            return 1.0
        plastic = 0.5 - 0.5 * np.cos(np.pi * min((abs(stretch) - breakaway) / (1.0 - breakaway), 1.0))
        return float(1.0 - plastic * abs(stretch))

    time, x = course(0.002)
    solved = solve_ivp(
        lambda time, z: [speed(time) / length * share(float(z[0]), time)],
        (0.0, 8.0), [0.0], t_eval=time, rtol=1e-8, atol=1e-10, max_step=0.002,
    ).y[0]  # fmt: skip
    wanted = solved + damping * np.array([speed(t) / length * share(z, t) for t, z in zip(time, solved, strict=True)])
    found = elastoplastic(time, x, np.ones(time.size), length, breakaway, damping)
    # Of the first sample the speed is not known.
    assert np.std((found - wanted)[1:]) < 0.01 * np.std(wanted)


def test_elasto_plastic_bristle_does_not_creep_below_its_breakaway_and_stays_bounded_however_stiff() -> None:
    x = np.concatenate([[0.0], np.tile([0.05, 0.02], 200)])
    time = np.arange(x.size) * 0.01
    assert elastoplastic(time, x, np.ones(x.size), 0.1, 0.6)[-1] == pytest.approx(0.2)
    time, x = motion(60.0, 0.0, 1.0, 2.0)
    for length in (1e-3, 1e-5):
        assert np.max(np.abs(elastoplastic(time, x, np.full(x.size, 1.5), length, 0.7))) < 1.5 + 1e-9
    # A file may hold a level that no motion reaches: it does not take for ever.
    assert np.all(np.isfinite(elastoplastic(time, x, np.full(x.size, 1e300), 1e-12, 0.7)))


def test_kernel_wipes_out_closes_its_loops_and_does_not_know_how_it_is_sampled() -> None:
    turns = [0.0, 0.9, 0.45, 0.75, 0.45, 0.9, -0.4, 1.3]
    x = np.interp(np.arange(0.0, 7.001, 0.02), np.arange(8.0), turns)
    found = kernel(x, 0.2, 0.5, 0.3)
    # Nothing until 0.5, then along with the deflection, and nothing lost on the way back until 0.2 less than that.
    assert found[:26] == pytest.approx(np.zeros(26), abs=1e-12)
    at = {turn: float(found[50 * turn]) for turn in range(8)}
    assert at[1] == pytest.approx(0.4)
    assert at[2] == pytest.approx(0.15)
    assert at[3] == pytest.approx(0.25)
    # A loop between the same turns comes back to where it began, and one that is left wipes it out.
    assert (at[4], at[5]) == (pytest.approx(at[2]), pytest.approx(at[1]))
    assert at[6] == 0.0
    assert at[7] == pytest.approx(0.5)
    assert kernel(np.array([0.0, *turns]), 0.2, 0.5, 0.3)[1:] == pytest.approx(list(at.values()))


def test_kernel_that_takes_no_way_is_a_relay() -> None:
    _, x = motion(60.0, 0.0, 1.0, 2.0)
    state, wanted = 0.0, []
    for at in x:
        state = 1.0 if at > 0.3 else 0.0 if at < 0.1 else state
        wanted.append(state)
    assert kernel(x, 0.2, 1e-9, 0.1) / 1e-9 == pytest.approx(np.array(wanted))


def test_chamber_follows_its_gas_law_and_forgets_its_pressure_by_its_leak() -> None:
    time, x = course(0.01)
    tight = chamber(time, x, 0.05, 0.4, 0.0, 1.3, 0.0, 0.05)
    assert tight == pytest.approx(1.0 - (1.0 + 0.4 * x) ** -1.3)
    # One that shrinks as the deflection grows pushes back.
    assert chamber(time, x, 0.05, -0.4, 0.0, 1.3, 0.0, 0.05) == pytest.approx((1.0 - 0.4 * x) ** -1.3 - 1.0)

    def rate(time: float, over: Floats) -> list[float]:
        volume = 1.0 - 0.8 * float(np.interp(time, *held))
        shrinks = -0.8 * 0.5 / 0.5 if time < 0.5 else 0.0
        leak = 0.6 / volume * over[0] / np.sqrt(abs(over[0]) + 0.05)
        return [-1.3 * (1.0 + over[0]) * shrinks / volume - leak]

    held = np.array([0.0, 0.5, 6.0]), np.array([0.0, 0.5, 0.5])
    time = np.arange(0.0, 6.0, 0.002)
    wanted = solve_ivp(rate, (0.0, 6.0), [0.0], t_eval=time, rtol=1e-9, atol=1e-12, max_step=0.005).y[0]
    found = chamber(time, np.interp(time, *held), 0.05, -0.8, 0.6, 1.3, 0.0, 0.05)
    assert np.max(np.abs(found - wanted)) < 5e-3 * np.max(wanted)
    assert found[-1] < 1e-3 * np.max(found)


def test_seal_of_a_chamber_rubs_by_the_pressure() -> None:
    x = np.array([0.0, 0.2, 0.4, 0.38, 0.2])
    over = (1.0 - 0.5 * x) ** -1.0 - 1.0
    found = chamber(np.zeros(5), x, 0.05, -0.5, 0.1, 1.0, 0.3, 0.1)
    # Wholly after a tenth of a radian, half of it back after a fifth of that from the other side.
    assert found - over == pytest.approx(0.3 * over * np.array([0.0, 1.0, 1.0, 0.8, -1.0]))


def langevin(u: float) -> float:
    return u / 3.0 if abs(u) < 1e-4 else float(1.0 / np.tanh(u) - 1.0 / u)


@pytest.mark.parametrize("free", [0.05, 0.4])
@pytest.mark.parametrize("coupling", [0.0, 0.05])
def test_magnet_is_the_solution_of_its_equation(coupling: float, free: float) -> None:
    time, x = course(0.002)
    pinning, shape = 0.15, 0.2

    def of_both(at: float, held: float) -> tuple[float, float]:
        """Where all domains would be, and where they are."""
        whole = held
        for _ in range(60):
            aligned = langevin((at + coupling * whole) / shape)
            whole = free * aligned + (1.0 - free) * held
        return aligned, whole

    def rate(now: float, held: Floats) -> list[float]:
        going, place = speed(now), float(0.5 * np.sin(1.9 * now) + 0.2 * np.sin(5.3 * now))
        apart = of_both(place, held[0])[0] - held[0]
        return [abs(going) * apart / (pinning - coupling * abs(apart)) if apart * going > 0.0 else 0.0]

    held = solve_ivp(rate, (0.0, 8.0), [0.0], t_eval=time, rtol=1e-8, atol=1e-10, max_step=0.005).y[0]
    wanted = np.array([of_both(*each)[1] for each in zip(x, held, strict=True)])
    assert np.max(np.abs(magnetised(x, pinning, shape, coupling, free) / (3.0 * shape) - wanted)) < 1e-3


@pytest.mark.parametrize("sizes", [(0.01, 0.01, 1.0, 0.01), (0.01, 3.0, 1.0, 0.9), (2.0, 0.01, 1e-3, 0.9)])
def test_magnet_is_never_more_than_aligned(sizes: tuple[float, float, float, float]) -> None:
    _, x = motion(60.0, 0.0, 1.0, 2.0)
    assert np.max(np.abs(magnetised(x, *sizes))) <= 3.0 * sizes[1]


def test_steel_that_bends_sharply_is_a_stop_and_a_spring() -> None:
    # Where it yields before it turns round: it does not remember what it left before that.
    ends = [0.0, 1.0, -0.9, 0.7, -0.2, 0.6, 0.0]
    x = np.concatenate([np.linspace(a, b, 200) for a, b in itertools.pairwise(ends)])
    stop = x - plays(x, np.array([0.2]))[:, 0]
    assert yielding_again(x, 0.2, 0.1, 300.0, 0.0, 1.0) == pytest.approx(0.9 * stop + 0.1 * x, abs=1e-3)


def test_steel_bends_the_less_sharply_the_farther_it_was_yielded() -> None:
    way = np.concatenate([np.linspace(0.0, 1.0, 400), np.linspace(1.0, -1.0, 800)])
    firm, soft = (yielding_again(way, 0.2, 0.05, 8.0, most, 0.3) for most in (0.0, 0.6))
    # The same bar at first. Where the asymptotes meet on the way back, an exponent R leaves 2^(-1/R) of the way between.
    assert soft[:400] == pytest.approx(firm[:400])
    met = (-0.2 * 0.95 - firm[399] + 1.0) / 0.95
    far = abs(-0.2 - met) / 0.2
    for force, exponent in ((firm, 8.0), (soft, 8.0 * (1.0 - 0.6 * far / (0.3 + far)))):
        there = np.interp(-met, -way[400:], force[400:])
        assert (there - force[399]) / (met - 1.0) == pytest.approx(0.05 + 0.95 * 0.5 ** (1.0 / exponent), abs=2e-4)


@pytest.mark.parametrize("step", [0.0, 1e-17, 1e-16, 1e-12, 1e-6])
def test_steel_that_trembles_where_it_yields_stays_on_its_asymptote(step: float) -> None:
    x = np.concatenate([np.linspace(0.0, 1.0, 50), 1.0 - step * np.arange(200) % (3.0 * step or 1.0), [1.0, 1.01]])
    force = yielding_again(x, 0.2, 0.05, 40.0, 0.5, 0.2)
    assert np.all(np.isfinite(force))
    assert force[-1] == pytest.approx(0.2 * 0.95 + 0.05 * 1.01, abs=1e-4)
