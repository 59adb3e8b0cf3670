"""Which column of a recording is the time, the input and the output, where nobody said so: by name, then by unit."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from ..errors import InputError

__all__ = ["AssumptionWarning", "guess_columns", "quantity", "seconds"]


class AssumptionWarning(UserWarning):
    """What had to be assumed of a recording because neither its file nor the caller says it."""


UNITS = {
    "rad": "rad", "mrad": "mrad", "deg": "°", "m": "m", "mm": "mm", "um": "µm", "in": "in", "n": "N", "kn": "kN", "nm": "N·m",
    "mnm": "mN·m", "knm": "kN·m", "pa": "Pa", "kpa": "kPa", "mpa": "MPa", "bar": "bar", "v": "V", "a": "A", "s": "s", "ms": "ms",
    "us": "µs", "min": "min", "percent": "%",
}  # fmt: skip
"""Unit by the last part of a column name, in small letters."""

SECONDS = {"s": 1.0, "ms": 1e-3, "µs": 1e-6, "min": 60.0}

WORDS = {
    "time": {"time", "timestamp", "seconds", "sec"},
    "x": {
        "deflection", "angle", "position", "pos", "displacement", "disp", "theta", "phi", "strain", "stroke", "elongation",
        "extension", "deformation", "rotation", "travel",
    },
    "y": {"torque", "force", "load", "moment", "tau", "effort", "stress"},
}  # fmt: skip
ALONE = {"time": {"t"}, "x": {"x", "q", "input"}, "y": {"y", "f", "output"}}
"""Words that tell a role only if they are the whole name."""

ROLE_UNITS = {
    "time": {"s", "ms", "µs", "min"},
    "x": {"rad", "mrad", "°", "m", "mm", "µm"},
    "y": {"N", "kN", "N·m", "mN·m", "kN·m", "Pa", "kPa", "MPa"},
}
OTHER = {
    "velocity", "vel", "speed", "omega", "rate", "acceleration", "accel", "acc", "current", "voltage", "temperature", "temp",
    "pressure", "power", "pwm", "error", "status", "index", "frequency",
}  # fmt: skip
"""Words of channels that are neither time nor input nor output."""

SECONDARY = {
    "ref",
    "reference",
    "desired",
    "target",
    "setpoint",
    "cmd",
    "command",
    "sim",
    "simulated",
    "model",
    "predicted",
}
"""Words of what was wanted or computed: taken only where nothing was measured."""

UNLIKELY = 3


def quantity(column: str) -> tuple[str, str]:
    """Name and unit of a column: ``torque_nm``, ``torque [Nm]`` and ``torque (N·m)`` are a torque in N·m.

    The unit is empty where the name does not end in a known one.
    """
    found = re.fullmatch(r"(.*?)[\s_]*[\[(]\s*([^\])]+?)\s*[\])]\s*", column) or re.fullmatch(
        r"(.+)_([A-Za-zµ]+)", column
    )
    if found:
        spelled = re.sub(r"[·*.\s]", "", found[2]).replace("°", "deg").replace("µ", "u").replace("%", "percent").lower()
        if spelled in UNITS and found[1]:
            return found[1].replace("_", " ").strip(), UNITS[spelled]
    return column, ""


def seconds(column: str) -> float:
    """Seconds in one unit of a time column, by its name; 1 where that tells no unit of time."""
    return SECONDS.get(quantity(column)[1], 1.0)


def guess_columns(
    path: Path, names: Sequence[str], known: Mapping[str, str], wanted: Sequence[str], dispensable: Collection[str] = ()
) -> dict[str, str]:
    """Columns for the ``wanted`` roles among those that no ``known`` role has.

    Parameters
    ----------
    path : Path
        For messages.
    names : sequence of str
        All columns.
    known : mapping of str to str
        Column by role, as far as it is settled.
    wanted : sequence of str
        Of ``time``, ``x`` and ``y``.
    dispensable : collection of str
        Those of them that are left out as well where several columns are equally likely.

    Returns
    -------
    dict of str to str
        Column by role; a role without a candidate is left out.

    Raises
    ------
    InputError
        If several columns are equally likely for a role that is not dispensable; the message names them.
    """
    free = [name for name in names if name not in known.values()]
    found: dict[str, str] = {}
    for role in wanted:
        ranks = {name: rank for name in free if (rank := _rank(name, role)) is not None}
        best = [name for name in ranks if ranks[name] == min(ranks.values())]
        if len(best) > 1 and role not in dispensable:
            raise InputError(
                f"{path}: {', '.join(map(repr, best))} may each be the {TITLES[role]}; choose one with --{role} COLUMN"
            )
        if len(best) == 1:
            found[role] = best[0]
    return found


TITLES = {"time": "time", "x": "input x", "y": "output y"}


def _words(name: str) -> set[str]:
    apart = re.sub(r"([a-z])([A-Z])", r"\1 \2", quantity(name)[0])
    return set(re.findall(r"[a-z]+", apart.lower()))


def _role_words(name: str) -> set[str]:
    """Roles that a word in the name speaks for."""
    return {role for role, words in WORDS.items() if _words(name) & words}


def _rank(name: str, role: str) -> int | None:
    """How well a column suits a role, 0 best; None if it does not."""
    words, (stem, unit) = _words(name), quantity(name)
    last = re.findall(r"[a-z]+", stem.lower())[-1:]
    # What is left of rad_s is a unit again: the column is a rate.
    if words & OTHER or (unit and last and last[0] in UNITS and len(words) > 1):
        return None
    unlikely = UNLIKELY if words & SECONDARY else 0
    if stem.strip().lower() in WORDS[role] | ALONE[role]:
        return unlikely
    spoken = _role_words(name)
    if spoken:
        return 1 + unlikely if spoken == {role} else None
    if any(stem.strip().lower() in alone for alone in ALONE.values()):
        return None
    return 2 + unlikely if unit in ROLE_UNITS[role] else None
