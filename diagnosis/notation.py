"""The words in which laws are written as equations that a simulator can carry out."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType

__all__ = ["GENERAL", "WORDS", "explained"]

GENERAL = (
    "x: deflection, the simulator's input; v, a: its speed and acceleration; t: time since the start (s); y: the simulator's "
    "torque, with what was added before; functions as in numpy"
)
"""What is said of every equation."""
WORDS: Mapping[str, str] = MappingProxyType({
    "y_spring": "elastic part of the simulator's torque, its preload with it, without its friction",
    "y_memory": "the rest of the simulator's torque, its friction",
    "stronger": "stronger(g): what y gains where friction has 1 + g times the strength at the same stiffness",
    "stiffer": "stiffer(g): what y gains where all is 1 + g times as stiff and friction has the same strength",
    "dahl": "dahl(x, d, h): s with ds/dx = (sign(dx) - s / h) / d and s = 0 at the start; h = 1 where it is left out (Dahl's friction)",
    "slip": "slip(x, d, h): s with ds/dx = 1 / d, kept within -h and h, and s = 0 at the start; h = 1 where it is left out (a spring and a slider)",
    "film": "film(x, d, w): s with ds/dt = (v - w s) / d, kept within -1 and 1, and s = 0 at the start (a spring behind a regularised slider)",
    "play": "play(x, h): p with p = clip(p, x - h, x + h) at each step, 0 at the start (lost motion)",
    "plays": "plays(x, h1, h2): mean of seven p with p = clip(p, x - h, x + h) at each step, h evenly from h1 to h2",
    "lowpass": "lowpass(u, T): w with T dw/dt = u - w and w = u at the start",
    "creep": "creep(u, T, p, L): f with df/dt = du/dt - (f / T) abs(f / L)**(p - 1) and f = 0 at the start (a spring behind a dashpot)",
    "fractional": "fractional(u, p): derivative of u of the order p (0 to 1), from u at the start (Grünwald and Letnikov)",
    "heat": "heat(u, T): w with T dw/dt = abs(u) - w and w = 0 at the start",
    "late": "late(u, T): u(t - T)",
    "resonator": "resonator(u, w, d): z with d²z/dt² + 2 d w dz/dt + w² z = w² u, from rest, or settled where it was moving",
    "rise": "rise(u): u less its first value",
    "travel": "way that the deflection has gone since the start, ∫|dx|",
    "farthest": "largest deflection to either side since the start, max |x|",
    "work": "∫|y dx| since the start",
    "damage": "∫y² |dx| since the start",
    "losses": "∫ y_memory dx since the start, the most that it has been",
    "swings": "∫x² |dx| since the start",
    "reversals": "turns of the deflection since the start",
    "turns": "turns of the deflection since the start, small ones as well",
})  # fmt: skip
"""Words that are not numpy's, and what each means."""


def explained(equations: Sequence[str]) -> list[str]:
    """What the words in some equations mean, a line each."""
    used = set(re.findall(r"\w+", " ".join(equations)))
    # One word may be explained by another.
    used |= {word for other in used & WORDS.keys() for word in re.findall(r"\w+", WORDS[other])}
    return [
        meaning if meaning.startswith(f"{word}(") else f"{word}: {meaning}"
        for word, meaning in WORDS.items()
        if word in used
    ]
