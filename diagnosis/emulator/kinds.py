"""The kinds of elements that simulators of joints are made of besides stops, bristles, a polynomial and rates.

Springs with kinks, rubber, smooth yielding, masses, viscoelasticity, friction behind a dashpot or a lag, loops that bend with
the place.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ...models.dahl import friction
from ..operators.levels import slid, yielding
from ..operators.masses import held_by_load, sliding
from ..operators.memory import dashed, hardening, held_inside, leaky, orifice, pressed
from ..operators.smooth_loops import pinched, smooth
from ..operators.steel import yielding_again
from ..operators.viscoplastic import viscoplastic
from .kind import ELASTIC, MEMORY, RATE, Kind, at_level, by_row, timed_by, timeless, timeless_at_level, with_each
from .motion import Extent, Motion
from .single_elements import (
    at_low_speed,
    behind_play,
    belt,
    beyond_clearance,
    breaking_away,
    by_speed,
    by_speed_and_side,
    capstan,
    corner,
    curved,
    curved_together,
    damping,
    damping_beyond,
    gripping,
    in_contact,
    kink,
    lag,
    lagging,
    lagging_together,
    leaking_chamber,
    leaning,
    leaves,
    levered,
    magnet,
    preload,
    pressed_by_speed,
    ripple,
    rubber,
    rubber_splined,
    saturating,
    slipping,
    snubber,
    softly_beyond_clearance,
    stops,
    stribeck,
    stribeck_pressed,
    stronger_at_rest,
    stronger_in_motion,
    switching,
    tendon,
    wire,
)
from .tables import looked_up, looked_up_together, nodes, rubbing, rubbing_together

__all__ = ["FRICTION_TABLE", "KERNELS", "KINDS", "KINKS", "SHARP", "SPRING_TABLE"]

Floats = NDArray[np.float64]
KINKS, SHARP, SLIP = "kinks", "a few sharp sliders", "a few slip elements"
KERNELS = "Krasnosel'skii-Pokrovskii kernels"
SPRING_TABLE, FRICTION_TABLE = "a spring from a table", "friction from a table"
PLACES = 49
"""Places of a kink that are tried."""
BODIES = (0.003, 0.003, 0.02, 0.0005, 0.001, 0.001, 0.01), (3.0, 6.0, 20.0, 3.0, 50.0, 50.0, 1.0)
"""Limits of the sizes of a slider with mass, in :attr:`Extent.body`."""


def _smooth_sizes(extent: Extent) -> Floats:
    others = (1.0, 0.75), (1.0, 0.5), (2.0, 1.0), (2.0, 0.75), (2.0, 0.5)
    return with_each(extent.reach * np.geomspace(0.02, 1.0, 6), *others)


def _stribeck_sizes(extent: Extent) -> Floats:
    others = itertools.product((0.03 * extent.fast, 0.1 * extent.fast, 0.3 * extent.fast, extent.fast), (0.5, 1.5))
    return with_each(extent.reach * np.array([0.004, 0.012, 0.04, 0.12]), *others)


def _slip_elements(column: Callable[..., Floats], like: str = "") -> Kind:
    others = tuple(itertools.product((0.2, 0.6, 2.0), (0.4,), (1.0, 8.0), (1.5,)))
    return Kind(
        MEMORY, True,
        lambda extent: np.asarray(extent.slipping * with_each(np.geomspace(0.003, 0.7, 9), *others)),
        by_row(column),
        {3: (0.0, np.inf)},
        timed=True,
        limits=lambda extent: np.asarray(extent.slipping * [[0.001, 0.003, 0.02, 0.05, 0.5], [1.0, 5.0, 6.0, 100.0, 3.0]]),
        exact=(4,),
        # They rub in the same grease.
        shared=(1, 2, 3, 4),
        by_speed=True,
        like=like,
    )  # fmt: skip


def _held_by_load(
    units: Callable[[Extent], Floats], width: Sequence[float], *more: Sequence[float], by_speed: bool = False
) -> Kind:
    """A spring held by a load, in which ``units`` its sizes are, and of those that differ where one begins and its limits."""
    first, least, most = np.array([width, *more]).T
    loads = itertools.product(
        (0.03, 0.1), (4.0, 10.0, 25.0, 60.0), (0.05, 0.3), first[:1], (0.03, 0.5), (0.1,), (0.03,)
    )
    begun = np.array([(*load, *first[1:]) for load in loads])
    lowest = np.array([1e-3, 1.0, 1e-3, least[0], 1e-3, 3e-3, 1e-3, *least[1:]])
    highest = np.array([1.0, 300.0, 3.0, most[0], 20.0, 100.0, 100.0, *most[1:]])
    positive = (1, 3, 8) if more else (1, 3)
    return Kind(
        MEMORY, True,
        lambda extent: units(extent) * begun,
        timed_by(functools.partial(held_by_load, by_speed=by_speed)),
        dict.fromkeys(positive, (0.0, np.inf)),
        timed=True,
        limits=lambda extent: units(extent) * [lowest, highest],
        # And the frequency: how a load swings bends with it.
        corners=(0, 1),
        evident=True,
    )  # fmt: skip


def _rubber(column: Callable[..., Floats]) -> Kind:
    return Kind(
        MEMORY, True,
        lambda extent: extent.reach * np.geomspace(0.01, 1.0, 10)[:, None],
        by_row(column),
    )  # fmt: skip


def _ripples(power: int) -> Kind:
    return Kind(
        ELASTIC, False,
        lambda extent: np.array(list(itertools.product(
            extent.reach / np.arange(3.0, 110.0, 0.75), np.pi * np.array([0.9, 1.25, 1.6])
        ))),
        by_row(functools.partial(ripple, power=power)),
        {0: (0.0, np.inf)},
        limits=lambda extent: np.array([[extent.reach / 150.0, 0.4 * np.pi], [extent.reach / 2.0, 2.6 * np.pi]]),
        corners=(),
        exact=(0,),
    )  # fmt: skip


def _at_places(extent: Extent, widths: Sequence[float], *others: tuple[float, ...]) -> Floats:
    """Several places, each with each of these widths, as shares of the reach, and with each of the other sizes."""
    places = extent.reach * np.array([-0.7, -0.4, -0.15, 0.0, 0.15, 0.4, 0.7])
    return with_each(places, *((width * extent.reach, *other) for width in widths for other in others or ((),)))


def _engaging(columns: Callable[[Motion, Floats], Floats]) -> Kind:
    return Kind(
        MEMORY, True,
        lambda extent: extent.reach * with_each(np.array([0.02, 0.06, 0.2]), (0.06,), (0.15,), (0.3,), (0.5,), (0.7,)),
        columns,
        limits=lambda extent: extent.reach * np.array([[0.003, 0.01], [1.0, 0.95]]),
        corners=(0, 1),
    )  # fmt: skip


KINDS: Mapping[str, Kind] = MappingProxyType({
    # A stiffer spring that engages, an end stop, a table.
    KINKS: Kind(
        ELASTIC, False,
        lambda extent: extent.reach * np.linspace(-0.96, 0.96, PLACES)[:, None],
        by_row(kink),
        signed=(0,),
    ),
    # Lookup tables of block diagrams and measured characteristics.
    SPRING_TABLE: Kind(
        ELASTIC, False,
        nodes,
        by_row(looked_up),
        {1: (0.0, np.inf)},
        together=looked_up_together,
        signed=(0,),
        table=(0, 1),
    ),
    # Detents, motors with poles and slots, teeth in mesh.
    "a few ripples": _ripples(0),
    "a few ripples of the stiffness": _ripples(1),
    # Springs with a preload.
    "a few preloads": Kind(
        ELASTIC, False,
        lambda extent: _at_places(extent, (0.01, 0.03, 0.1)),
        by_row(preload),
        {1: (0.0, np.inf)},
        limits=lambda extent: extent.reach * np.array([[-1.0, 0.003], [1.0, 0.5]]),
        signed=(0,),
    ),
    # Gears whose catalogue tells a stiffness for each range of the torque, springs in stages.
    "a few corners": Kind(
        ELASTIC, False,
        lambda extent: extent.reach * with_each(np.linspace(0.06, 0.94, 23), (0.01,), (0.04,)),
        by_row(corner),
        {0: (0.0, np.inf), 1: (0.0, np.inf)},
        limits=lambda extent: extent.reach * np.array([[0.02, 0.001], [1.0, 0.06]]),
        # One between two corners follows both a little, and leads to neither.
        pairs=True,
    ),
    # Rubber: the friction of Berg (Vehicle System Dynamics 30, 1998).
    "rubber": _rubber(rubber),
    "rubber along a spline": _rubber(rubber_splined),
    # Sliders at sharp deflections between those that are there in any case.
    SHARP: Kind(
        MEMORY, True,
        lambda extent: extent.reach * np.geomspace(0.02, 1.0, 12)[:, None],
        stops,
        yielding=timeless_at_level(lambda x, length, level: length * slid(x, level, length)),
        limits=lambda extent: extent.reach * np.array([[0.003], [3.0]]),
    ),
    # Dampers of clutches and flywheels, whose stages rub once they engage, or once a play is taken up.
    "a few sliders beyond a clearance": _engaging(by_row(beyond_clearance)),
    "a few sliders behind a play": _engaging(behind_play),
    "a few smooth sliders beyond a clearance": Kind(
        MEMORY, True,
        lambda extent: extent.reach * with_each(
            np.array([0.02, 0.06, 0.2]), (0.1, 0.02), (0.25, 0.04), (0.4, 0.05), (0.6, 0.05)
        ),
        by_row(softly_beyond_clearance),
        limits=lambda extent: extent.reach * np.array([[0.003, 0.01, 0.001], [1.0, 0.95, 0.2]]),
        corners=(0, 1),
    ),
    # Linkages, cams, tendons: the friction inside has a lever that changes with the place.
    "a few sliders on a lever": Kind(
        MEMORY, True,
        lambda extent: extent.lever * with_each(
            np.geomspace(0.006, 0.3, 5), *(way for way in itertools.product((-0.5, 0.0, 0.5), (-0.4, 0.0, 0.4)) if any(way))
        ),
        by_row(levered),
        limits=lambda extent: extent.lever * [[0.003, -1.0, -1.0], [1.0, 1.0, 1.0]],
        signed=(1, 2),
    ),
    # Half of the width of a measured loop, by the place.
    FRICTION_TABLE: Kind(
        MEMORY, True,
        lambda extent: np.array([
            (length, exponent, interval, place)
            for length in extent.reach * np.geomspace(0.01, 0.3, 6)
            for exponent in (0.1, 1.0)
            for place, interval in nodes(extent)
        ]),
        by_row(rubbing),
        {0: (0.0, np.inf), 2: (0.0, np.inf)},
        together=rubbing_together,
        limits=lambda extent: extent.reach * np.array([[0.002, 0.02 / extent.reach, 0.01, -1.2], [1.0, 3.0 / extent.reach, 1.0, 1.2]]),
        exact=(2, 3),
        signed=(3,),
        shared=(0, 1, 2),
        table=(2, 3),
    ),
    "smooth yielding": Kind(
        MEMORY, True,
        _smooth_sizes,
        timeless(smooth),
        {1: (0.0, np.inf)},
        yielding=timeless_at_level(smooth),
    ),
    "a few smooth sliders": Kind(
        MEMORY, True,
        _smooth_sizes,
        timeless(smooth),
        {1: (0.0, np.inf)},
        yielding=timeless_at_level(smooth),
        limits=lambda extent: np.array([[0.004 * extent.reach, 1.0, 0.3], [3.0 * extent.reach, 8.0, 3.0]]),
    ),
    # Dahl (Aerospace Corporation TOR-158, 1968), whose exponent tells how sharply a slider yields.
    "a few Dahl sliders": Kind(
        MEMORY, True,
        lambda extent: with_each(extent.reach * np.geomspace(0.006, 0.6, 8), (0.4,), (1.0,), (1.8,)),
        timeless(lambda x, length, exponent: length * friction(x, length=length, exponent=exponent)),
        {1: (0.0, np.inf)},
        yielding=timeless_at_level(
            lambda x, length, exponent, level: length * yielding(x, level, length, exponent)
        ),
        limits=lambda extent: np.array([[0.002 * extent.reach, 0.02], [3.0 * extent.reach, 3.0]]),
        last=True,
        alone=True,
    ),
    # Tendons and Bowden cables, with a bristle where they turn round: Palli, Borghesan and Melchiorri (IEEE T-RO 28, 2012).
    "a few capstans": Kind(
        MEMORY, True,
        lambda extent: extent.capstan * with_each(
            np.geomspace(0.01, 0.3, 5), *itertools.product((1.0,), (-0.8, -0.2, 0.2, 0.8), (-1.5, -0.5, 0.5, 1.5))
        ),
        by_row(capstan),
        {1: (0.0, np.inf)},
        limits=lambda extent: extent.capstan * [[0.002, 0.02, -2.0, -4.0], [1.0, 3.0, 2.0, 4.0]],
        signed=(2, 3),
        shared=(0, 1),
    ),
    # Tensioners of belts, whose arms rub by what they carry, more or less as they are pressed or let go.
    "a few belts": Kind(
        MEMORY, True,
        lambda extent: extent.capstan * with_each(
            np.geomspace(0.01, 0.3, 5), *itertools.product((1.0,), (0.5, 1.0, 2.0), (-0.8, -0.3, 0.3, 0.8))
        ),
        by_row(belt),
        {1: (0.0, np.inf), 2: (0.0, np.inf)},
        limits=lambda extent: extent.capstan * [[0.002, 0.02, 0.1, -2.0], [1.0, 3.0, 10.0, 2.0]],
        signed=(3,),
        shared=(0, 1),
    ),
    # Friction wedges of bogies, and leaves, which hold better on one way than on the other.
    "a few snubbers": Kind(
        MEMORY, True,
        lambda extent: extent.capstan * with_each(
            np.geomspace(0.01, 0.3, 5), *itertools.product((1.0,), (0.5, 1.0, 2.0), (0.5, 2.0))
        ),
        by_row(snubber),
        {1: (0.0, np.inf), 2: (0.0, np.inf)},
        limits=lambda extent: extent.capstan * [[0.002, 0.02, 0.1, 0.01], [1.0, 3.0, 10.0, 20.0]],
        shared=(0, 1),
    ),
    # Antagonists whose tendons go slack, on springs that stiffen.
    "a few capstans of slack tendons": Kind(
        MEMORY, True,
        lambda extent: extent.tendon * with_each(
            np.geomspace(0.01, 0.2, 4), *itertools.product((1.0,), (0.2, 0.8), (-1.2, -0.7, 0.7, 1.2), (0.1,))
        ),
        by_row(tendon),
        {1: (0.0, np.inf), 2: (0.0, np.inf), 4: (0.0, np.inf)},
        limits=lambda extent: extent.tendon * [[0.002, 0.02, 0.01, -3.0, 0.01], [1.0, 3.0, 3.0, 3.0, 0.5]],
        signed=(3,),
        shared=(0, 1, 2, 4),
        # One of two antagonists follows little.
        pairs=True,
        starts=1,
    ),
    # Magnetic and magnetostrictive drives: Jiles and Atherton (J. Magn. Magn. Mater. 61, 1986).
    "a few magnets": Kind(
        MEMORY, True,
        lambda extent: extent.magnet * with_each(
            np.array([0.05, 0.1, 0.2, 0.4]), *itertools.product((0.05, 0.15, 0.4), (0.03,), (0.1, 0.4))
        ),
        by_row(magnet),
        {1: (0.0, np.inf), 3: (0.0, 1.0)},
        limits=lambda extent: extent.magnet * [[0.01, 0.01, 1e-3, 0.01], [2.0, 3.0, 1.0, 0.9]],
        evident=True,
        starts=1,
    ),
    # Steel that yields each time less sharply: Menegotto and Pinto (IABSE Symposium, Lisbon, 1973).
    "a few steel bars": Kind(
        MEMORY, True,
        lambda extent: extent.steel * with_each(
            np.array([0.05, 0.1, 0.2, 0.4]), *itertools.product((0.05,), (3.0, 8.0, 20.0), (0.5, 0.9), (0.2,))
        ),
        timeless(yielding_again),
        {1: (0.0, 1.0), 2: (0.0, np.inf), 3: (0.0, 1.0), 4: (0.0, np.inf)},
        limits=lambda extent: extent.steel * [[0.01, 1e-3, 1.5, 0.03, 0.02], [2.0, 0.5, 40.0, 0.98, 3.0]],
        evident=True,
        starts=1,
    ),
    # Friction that the spring's load presses, as in gears, belts and cams.
    "a few sliders pressed by the load": Kind(
        MEMORY, True,
        lambda extent: with_each(
            extent.reach * np.geomspace(0.01, 0.2, 5),
            *itertools.product(extent.reach * np.array([0.3, 1.0, 3.0]), (1.0, 2.0)),
        ),
        timeless(pressed),
        {2: (0.0, np.inf)},
        yielding=timeless_at_level(pressed),
        limits=lambda extent: np.array([
            [0.003 * extent.reach, 0.1 * extent.reach, 0.5], [1.0 * extent.reach, 30.0 * extent.reach, 4.0],
        ]),
    ),
    # And by a load that only presses from one side, as a weight or a preload.
    "a few sliders pressed from one side": Kind(
        MEMORY, True,
        lambda extent: extent.lever[:2] * with_each(np.geomspace(0.01, 0.4, 6), (-0.9,), (-0.4,), (0.4,), (0.9,)),
        by_row(leaning),
        limits=lambda extent: extent.lever[:2] * [[0.003, -3.0], [2.0, 3.0]],
        signed=(1,),
        shared=(1,),
        last=True,
        alone=True,
    ),
    # Magnetic couplings and piezo stages: stops that share an envelope, as plays do in generalised Prandtl-Ishlinskii models.
    "a few stops that saturate": Kind(
        MEMORY, True,
        lambda extent: with_each(extent.reach * np.geomspace(0.01, 1.0, 8), (0.7,), (1.5,), (3.0,)),
        saturating,
        limits=lambda extent: np.array([[0.003 * extent.reach, 0.1], [2.0 * extent.reach, 6.0]]),
        shared=(1,),
    ),
    # Timber, bolts and concrete: a loop that is slack in its middle.
    "a few pinched sliders": Kind(
        MEMORY, True,
        lambda extent: with_each(
            extent.reach * np.geomspace(0.05, 1.0, 5), *itertools.product((1.0, 2.0), (0.75,), (0.5,), (0.1, 0.3), (0.3,))
        ),
        timeless(pinched),
        {1: (0.0, np.inf), 3: (0.0, 1.0), 5: (0.01, np.inf)},
        yielding=timeless_at_level(pinched),
        limits=lambda extent: np.array([
            [0.02 * extent.reach, 1.0, 0.3, 0.02, 0.005, 0.08], [3.0 * extent.reach, 4.0, 1.5, 0.95, 0.9, 1.5],
        ]),
    ),
    # Wires and hinges of shape memory alloy: Graesser and Cozzarelli (J. Eng. Mech. 117, 1991).
    "a few superelastic wires": Kind(
        MEMORY, True,
        lambda extent: extent.wire * with_each(
            np.array([0.05, 0.1, 0.2, 0.4]), *itertools.product((2.0,), (0.1,), (0.03, 0.1, 0.3), (2.0, 4.0, 8.0))
        ),
        by_row(wire),
        limits=lambda extent: extent.wire * [[0.003, 1.0, 0.003, 0.003, 0.3], [2.0, 8.0, 3.0, 5.0, 50.0]],
        evident=True,
    ),
    # Alloys that change their phase wire by wire, piezo stages: Krasnosel'skii and Pokrovskii (Systems with Hysteresis, 1989).
    KERNELS: Kind(
        MEMORY, True,
        lambda extent: extent.reach * with_each(
            np.array([0.05, 0.1, 0.2, 0.4, 0.8]),
            *itertools.product((0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0), np.linspace(-1.4, 0.9, 16)),
        ),
        by_row(switching),
        limits=lambda extent: extent.reach * np.array([[0.01, 0.005, -2.0], [2.0, 2.0, 1.0]]),
        signed=(2,),
        shared=(1,),
        many=True,
    ),
    # Gels and metals that flow the faster the more they are beyond their yield point: Perzyna (Advances in Applied Mechanics 9, 1966).
    "a few viscoplastic sliders": Kind(
        MEMORY, True,
        lambda extent: extent.flowing * with_each(np.array([0.02, 0.06, 0.2]), (0.003, 1.0), (0.03, 1.0), (0.3, 1.0)),
        timed_by(viscoplastic),
        {1: (0.0, np.inf), 2: (0.0, np.inf)},
        timed=True,
        limits=lambda extent: extent.flowing * [[0.002, 0.001, 0.3], [2.0, 100.0, 6.0]],
        last=True,
    ),
    # Dampers of magnetorheological fluid with their accumulator: Spencer et al. (J. Eng. Mech. 123, 1997).
    "a few sliders behind dashpots": Kind(
        MEMORY, True,
        lambda extent: extent.dashed * with_each(
            np.geomspace(0.05, 1.0, 4), *itertools.product((1.0, 2.0), (0.75,), (2.0, 10.0, 50.0), (0.3, 3.0), (0.1,))
        ),
        timed_by(dashed),
        {1: (0.0, np.inf), 3: (0.0, np.inf)},
        timed=True,
        limits=lambda extent: extent.dashed * [
            [0.004, 1.0, 0.3, 0.5, 0.01, 1e-3], [3.0, 8.0, 3.0, 1000.0, 100.0, 10.0],
        ],
        evident=True,
    ),
    # Harmonic drives, and springs before a gear: what rubs inside is compliant on both sides.
    "a few springs held by friction": Kind(
        MEMORY, True,
        lambda extent: extent.drive * with_each(
            np.array([0.03, 0.12]), *itertools.product((0.01,), (1.5,), (0.01, 0.1), (0.1, 1.0))
        ),
        timed_by(held_inside),
        {1: (0.0, np.inf)},
        timed=True,
        limits=lambda extent: extent.drive * [[0.003, 0.001, 0.05, 0.001, 0.003], [2.0, 0.2, 20.0, 2.0, 10.0]],
        evident=True,
    ),
    # Joints of an engine for rigid bodies (MuJoCo and its like) have mass, damping and dry friction that creeps.
    "a few sliders with mass": Kind(
        MEMORY, True,
        lambda extent: extent.body * with_each(
            np.geomspace(0.02, 1.0, 8),
            *itertools.product((0.03, 0.1, 0.4, 1.6), (0.3, 2.0), (0.003, 0.05), (0.01,), (0.01,), (0.1,)),
            # One that swings is found near its own frequency only.
            *itertools.product(np.geomspace(0.1, 1.0, 8), (0.05,), (0.05,), (0.01,), (0.01,), (0.1,)),
        ),
        timed_by(sliding),
        {1: (0.0, np.inf), 3: (0.0, np.inf)},
        timed=True,
        limits=lambda extent: extent.body * BODIES,
        later=(5, 6),
        starts=3,
        alone=True,
    ),
    # Series elastic actuators and gears whose load swings behind the spring and rubs there: by a bristle (Dahl, LuGre) or by the
    # sign of its speed, made smooth.
    "a few springs held by a load": _held_by_load(lambda extent: extent.load[:7], (0.02, 1e-3, 0.3)),
    "a few springs held by a sliding load": _held_by_load(
        lambda extent: extent.sliding_load, (0.05, 3e-3, 3.0), by_speed=True
    ),
    "a few springs held by a load with Stribeck friction": _held_by_load(
        lambda extent: extent.load, (0.02, 1e-3, 0.3), (0.3, 0.02, 3.0), (0.2, 0.01, 5.0)
    ),
    # Metal that yields: its back stresses recall themselves.
    "a few hardening sliders": Kind(
        MEMORY, True,
        lambda extent: extent.metal * with_each(
            np.geomspace(0.01, 0.4, 9), *itertools.product((0.3, 0.8, 2.0), (0.03, 0.1, 0.3), (0.2,), (1.0,), (0.03,), (3.0,))
        ),
        timeless(hardening),
        {2: (0.0, np.inf), 4: (0.0, np.inf), 6: (0.0, np.inf)},
        limits=lambda extent: extent.metal * [
            [0.003, 0.02, 0.01, 0.01, 0.1, 1e-3, 0.1], [1.0, 10.0, 1.0, 3.0, 10.0, 3.0, 100.0],
        ],
    ),
    # Leaf springs: Fancher et al. (SAE paper 800905, 1980).
    "a few leaves": Kind(
        MEMORY, True,
        lambda extent: extent.leaf * with_each(np.geomspace(0.01, 0.3, 6), (0.4, 0.3), (1.0, 0.6), (2.5, 0.3)),
        by_row(leaves),
        {1: (0.0, np.inf)},
        yielding=at_level(leaves),
        limits=lambda extent: extent.leaf * [[0.002, 0.1, 0.01], [2.0, 10.0, 10.0]],
        all_along=True,
    ),
    # The same pressed by a spring with a preload that hardens, nil well within the stroke: else it stands in for what was before.
    "a few leaves under a preload": Kind(
        MEMORY, True,
        lambda extent: extent.loaded_leaf * with_each(np.geomspace(0.01, 0.3, 6), *itertools.product((1.0,), (0.5, 2.0), (-0.2, 0.0, 0.2), (0.01, 1.0))),
        by_row(leaves),
        {1: (0.0, np.inf)},
        yielding=at_level(leaves),
        limits=lambda extent: extent.loaded_leaf * [[0.002, 0.1, 0.01, -0.5, 0.001], [2.0, 10.0, 30.0, 0.5, 30.0]],
        later=(1, 4),
        signed=(3,),
        all_along=True,
        starts=1,
    ),
    # A simulator with Stribeck friction: Canudas de Wit et al. (IEEE TAC 40, 1995).
    "Stribeck friction": Kind(
        MEMORY, True,
        _stribeck_sizes,
        by_row(stribeck),
        yielding=at_level(stribeck),
        by_speed=True,
    ),
    "a few Stribeck sliders": Kind(
        MEMORY, True,
        lambda extent: np.insert(_stribeck_sizes(extent), [3, 3], [0.03 * extent.interval, 2.0], axis=1),
        by_row(stribeck),
        yielding=at_level(stribeck),
        limits=lambda extent: extent.slipping * [[0.001, 0.003, 0.02, 0.003, 0.5], [1.0, 5.0, 6.0, 30.0, 3.0]],
        later=(3, 4),
        exact=(4,),
        by_speed=True,
    ),
    # The same in gears and bearings that the spring's load presses.
    "a few Stribeck sliders pressed by the load": Kind(
        MEMORY, True,
        lambda extent: extent.geared * with_each(
            np.array([0.004, 0.012, 0.04, 0.12]), *itertools.product((0.1, 0.5), (0.5, 1.5), (0.5, 3.0))
        ),
        by_row(stribeck_pressed),
        limits=lambda extent: extent.geared * [[0.001, 0.003, 0.02, 0.02], [1.0, 5.0, 6.0, 30.0]],
        by_speed=True,
        like="a few Stribeck sliders",
    ),
    # The same that does not creep at small torques: Dupont et al. (IEEE TAC 47, 2002).
    "a few elasto-plastic sliders": Kind(
        MEMORY, True,
        lambda extent: extent.sticky[[0, 1, 2, 3, 2]] * with_each(
            np.array([0.004, 0.012, 0.04, 0.12]), *itertools.product((0.05, 0.3), (0.7,), (0.3,), (0.6,))
        ),
        by_row(breaking_away),
        {1: (0.0, np.inf)},
        limits=lambda extent: extent.sticky[[0, 1, 2, 3, 2]] * [[0.001, 0.003, 0.02, 0.003, 0.05], [1.0, 5.0, 6.0, 30.0, 0.98]],
        by_speed=True,
        last=True,
        evident=True,
        like="a few Stribeck sliders",
    ),
    # Friction by the Stribeck curve times a direction that builds up over a distance, as gears and screws are often written.
    "a few bristles stronger at rest": Kind(
        MEMORY, True,
        lambda extent: np.insert(_stribeck_sizes(extent), 3, 2.0, axis=1),
        by_row(gripping),
        limits=lambda extent: extent.slipping[[0, 1, 2, 4]] * [[0.001, 0.003, 0.02, 0.5], [1.0, 5.0, 6.0, 3.0]],
        later=(3,),
        exact=(3,),
        by_speed=True,
        like="a few Stribeck sliders",
    ),
    # Generalised Maxwell slip: Lampaert, Al-Bender and Swevers (Physics and Control, 2003).
    SLIP: _slip_elements(slipping),
    # The same as it is often written.
    "a few sudden slip elements": _slip_elements(functools.partial(slipping, sudden=True), like=SLIP),
    # Hysteresis that as a whole is stronger at rest, as rolling friction: Swevers et al. (IEEE TAC 45, 2000).
    "a few stops stronger at rest": Kind(
        MEMORY, True,
        lambda extent: extent.sticky[:2] * with_each(np.geomspace(0.01, 0.6, 6), (0.2,), (0.6,), (2.0,)),
        stronger_at_rest,
        {1: (0.0, np.inf)},
        limits=lambda extent: extent.sticky[:2] * [[0.003, 0.01], [3.0, 5.0]],
        by_speed=True,
        last=True,
    ),
    # Hysteresis that is stronger the faster it is gone through: pneumatic muscles, rate-dependent Prandtl-Ishlinskii models.
    "a few stops stronger in motion": Kind(
        MEMORY, True,
        lambda extent: extent.sticky[:2] * with_each(np.geomspace(0.01, 0.6, 6), (0.1,), (0.5,), (2.0,)),
        stronger_in_motion,
        {1: (0.0, np.inf)},
        limits=lambda extent: extent.sticky[:2] * [[0.003, 0.003], [3.0, 20.0]],
        shared=(1,),
        by_speed=True,
        last=True,
    ),
    # Joints of such an engine up to joint limits or pads.
    "a few sliders with mass between stops": Kind(
        MEMORY, True,
        lambda extent: extent.stopped * with_each(
            np.array([0.05, 0.15, 0.4]),
            *(
                (*body, 0.01, 0.01, 0.01, 0.1, stop, 1.0, hold, 0.03)
                for *body, stop, hold in itertools.product((0.1, 0.4, 1.6), (0.3, 2.0), (0.35, 0.55, 0.75), (0.3, 1.0))
            ),
        ),
        timed_by(sliding),
        {1: (0.0, np.inf), 3: (0.0, np.inf)},
        timed=True,
        limits=lambda extent: extent.stopped * np.hstack([BODIES, [[0.1, 0.3, 0.02, 0.005], [1.0, 3.0, 5.0, 1.0]]]),
        later=(5, 6),
    ),
    # Spreadsheets, and engines for rigid bodies asked for the torque of a given motion: the sign of the speed, made smooth.
    "friction by speed": Kind(
        RATE, False,
        lambda extent: extent.rigid * with_each(
            np.geomspace(0.0005, 0.3, 12), *itertools.product((0.2, 5.0), (0.003, 0.3))
        ),
        by_row(by_speed),
        {0: (0.0, np.inf), 1: (0.0, np.inf)},
        limits=lambda extent: extent.rigid * [[1e-4, 0.05, 1e-3], [3.0, 50.0, 50.0]],
        by_speed=True,
    ),
    # Friction of a drive line's simulator: Simscape's rotational friction (Armstrong and Canudas de Wit, 1996), Tustin's.
    "friction at low speed": Kind(
        RATE, False,
        lambda extent: extent.fast * with_each(np.geomspace(0.02, 1.0, 8), (0.05,), (0.5,)),
        by_row(at_low_speed),
        {0: (0.0, np.inf), 1: (0.0, np.inf)},
        limits=lambda extent: extent.fast * np.array([[0.003, 0.001], [5.0, 20.0]]),
        by_speed=True,
    ),
    # Friction between teeth.
    "friction by speed and load": Kind(
        RATE, False,
        lambda extent: extent.fast * np.geomspace(0.003, 0.3, 6)[:, None] * [1.0, 0.0] + [0.0, 1.0],
        by_row(pressed_by_speed),
        limits=lambda extent: np.array([[1e-3 * extent.fast, 0.3], [3.0 * extent.fast, 4.0]]),
        by_speed=True,
    ),
    # Orifices, door closers, shock absorbers.
    "damping by direction": Kind(
        RATE, False,
        lambda extent: np.array(list(itertools.product((0.5, 1.0, 1.5, 2.0), (0.0, 1.0)))),
        by_row(damping),
        timed=True,
    ),
    "damping by direction and place": Kind(
        RATE, False,
        lambda extent: np.array(list(itertools.product((1.0, 2.0), (0.0, 1.0), (1, 2)))),
        by_row(damping),
        timed=True,
    ),
    "damping beyond a place": Kind(
        RATE, False,
        lambda extent: _at_places(extent, (0.02, 0.1), (0.1,), (1.0,), (10.0,)),
        by_row(damping_beyond),
        {1: (0.0, np.inf)},
        timed=True,
        limits=lambda extent: np.array([[-extent.reach, 0.003 * extent.reach, 0.01], [extent.reach, 0.5 * extent.reach, 100.0]]),
        signed=(0,),
    ),
    # Its backlash and stops: they damp only where they touch.
    "damping in contact": Kind(
        RATE, False,
        lambda extent: extent.reach * with_each(np.geomspace(0.02, 0.8, 10), (0.01,), (0.05,)),
        by_row(in_contact),
        {0: (0.0, np.inf), 1: (0.0, np.inf)},
        timed=True,
        limits=lambda extent: extent.reach * np.array([[0.003, 0.001], [1.0, 0.3]]),
    ),
    # Dampers of magnetorheological fluid by a formula without memory: Kwok et al. (Smart Mater. Struct. 15, 2006).
    "friction by speed and side": Kind(
        RATE, False,
        lambda extent: extent.sided * with_each(
            np.geomspace(0.03, 1.0, 6), *itertools.product((0.3, 1.5), (0.03, 0.3), (0.03,))
        ),
        by_row(by_speed_and_side),
        {0: (0.0, np.inf), 2: (0.0, np.inf), 3: (0.0, np.inf)},
        limits=lambda extent: extent.sided * [[0.003, 0.01, 0.003, 0.003], [5.0, 20.0, 3.0, 50.0]],
        later=(3,),
        by_speed=True,
    ),
    "relaxation": Kind(
        RATE, False,
        lambda extent: np.geomspace(4.0 * extent.interval, extent.duration / 3.0, 7)[:, None],
        by_row(lag),
    ),
    # A Maxwell arm whose slider gives way, as in dampers of magnetorheological fluid: Spencer et al. (J. Eng. Mech. 123, 1997).
    "leaky sliders": Kind(
        MEMORY, True,
        lambda extent: with_each(
            extent.reach * np.geomspace(0.02, 1.2, 8),
            *((constant,) for constant in np.geomspace(3.0 * extent.interval, extent.duration / 10.0, 6)),
        ),
        timed_by(leaky),
        {1: (0.0, np.inf)},
        timed=True,
    ),
    # Hydraulic dampers: oil in a chamber is compressed and leaks through a gap and a hole.
    "a few springs behind throttles": Kind(
        MEMORY, False,
        lambda extent: extent.throttled * np.array(list(itertools.product(
            np.geomspace(0.003, 0.3, 5), (0.03, 0.3, 3.0), (0.5, 1.0, 2.0)
        ))),
        timed_by(orifice),
        {0: (0.0, np.inf), 1: (0.0, np.inf)},
        timed=True,
        limits=lambda extent: extent.throttled * [[1e-4, 1e-3, 0.1], [100.0, 100.0, 10.0]],
        evident=True,
    ),
    # Pneumatic drives: chambers of gas that leak.
    "a few leaking chambers": Kind(
        MEMORY, True,
        lambda extent: extent.chambered * with_each(
            np.array([0.05]), *itertools.product((0.8, 0.5, 0.25, -0.25, -0.5, -0.8), (0.01, 0.1, 1.0), (1.2,), (0.03,), (0.03,))
        ),
        by_row(leaking_chamber),
        {3: (0.0, 5.0), 5: (0.0, np.inf)},
        timed=True,
        limits=lambda extent: extent.chambered * [[1e-3, -0.9, 1e-3, 1.0, 1e-3, 2e-3], [3.0, 0.9, 30.0, 1.67, 1.0, 1.0]],
        # The first size is scaled with the strength of friction, which gas has none of: here it hardly matters.
        corners=(),
        signed=(1,),
        shared=(0, 2, 3, 4, 5),
        many=True,
        last=True,
    ),
    # Torque that is told late.
    "lagging stops": Kind(
        MEMORY, False,
        lambda extent: with_each(
            extent.reach * np.geomspace(0.02, 0.8, 6),
            *((constant,) for constant in np.geomspace(3.0 * extent.interval, extent.duration / 20.0, 5)),
        ),
        lagging,
        {1: (0.0, np.inf)},
        timed=True,
        together=lagging_together,
    ),
    "curved plays": Kind(
        MEMORY, False,
        lambda extent: with_each(
            extent.reach * np.geomspace(0.009, 0.55, 6), (2.0, 0.0), (3.0, 0.0), (1.0, 2.0), (2.0, 1.0)
        ),
        curved,
        together=curved_together,
    ),
})  # fmt: skip
