"""Tables 1 to 5 of the first source paper (Qin et al.), as printed.

The one change: the torque of Q4 is printed as 5.62 and used as -5.62. All its neighbours are negative, and only the
negative value gives the element stiffnesses k'_3 = 3.24 and k'_4 = 1.18 that Table 3 prints.
"""

from __future__ import annotations

import numpy as np

__all__ = [
    "ASCENDING",
    "DESCENDING",
    "PRINTED_ELEMENTS",
    "PRINTED_Q4_TORQUE",
    "PRINTED_SLOPES",
    "TABLE_4",
    "TABLE_5",
    "TRANSITION_NEG",
    "TRANSITION_POS",
    "VERTICES",
    "lower_branch",
    "upper_branch",
]

VERTICES = {
    "A": (0.0, 0.0), "B": (0.41, 0.72), "C": (0.85, 3.75), "D": (1.0, 5.02), "E": (0.6639, 1.93), "F": (0.395, 0.43),
    "G": (0.0, 0.0), "H": (-0.4461, -1.00), "I": (-0.8814, -4.61), "J": (-1.0, -5.66), "K": (-0.6750, -2.56),
    "L": (-0.3898, -0.66),
}  # fmt: skip
"""Table 1: point -> (x, torque in N·m)."""

PRINTED_SLOPES = {
    "AB": 1.7561, "BC": 6.8864, "DE": 9.1929, "EF": 5.5781, "FG": 1.0887, "GH": 2.2416, "HI": 8.2931, "JK": 9.5385,
    "KL": 6.6620, "LA": 1.6932, "CD": 8.4667, "IJ": 8.8533,
}  # fmt: skip
"""Table 1: the slopes k, with K+ as CD and K− as IJ."""

TRANSITION_POS = np.array([(0.85, 3.75), (0.91, 4.60), (0.93, 4.81), (0.95, 4.93), (1.0, 5.02)])
"""Table 2: P1 to P5."""

TRANSITION_NEG = np.array([(-0.8814, -4.61), (-0.9153, -5.28), (-0.9322, -5.47), (-0.9661, -5.62), (-1.0, -5.66)])
"""Table 2: Q1 to Q5, with the sign of Q4's torque mended."""

PRINTED_Q4_TORQUE = 5.62

PRINTED_ELEMENTS = {
    "k": (14.1667, 10.5, 6.0, 1.8), "eta": (0.22, 0.09, 0.116, 0.638),
    "k'": (8.52, 6.82, 3.24, 1.18), "eta'": (0.29, 0.35, 0.27, 0.14),
}  # fmt: skip
"""Table 3."""

TABLE_4 = {
    "maxwell-slip": {"mae": 0.063, "mre": 0.187, "rmse": 0.081},
    "cubic": {"mae": 0.095, "mre": 0.271, "rmse": 0.162},
    "bouc-wen": {"mae": 0.182, "mre": 0.242, "rmse": 0.211},
}
"""Torque errors, printed in N·m (MRE too)."""

TABLE_5 = {
    "maxwell-slip": {"mae": 0.038, "mre": 0.183, "rmse": 0.051},
    "cubic": {"mae": 0.048, "mre": 0.219, "rmse": 0.056},
    "bouc-wen": {"mae": 0.217, "mre": 0.622, "rmse": 0.243},
}
"""Deflection errors of the inverse models, printed in rad (MRE too)."""

ASCENDING = np.array([VERTICES[name] for name in "JKLABC"])
DESCENDING = np.array([VERTICES[name] for name in "DEFGHI"])


def upper_branch() -> np.ndarray:
    """Vertices (x, torque) that rising motion passes from J to D, shape (10, 2)."""
    return np.vstack([ASCENDING, TRANSITION_POS[1:]])


def lower_branch() -> np.ndarray:
    """Vertices (x, torque) that falling motion passes, in increasing x from J to D, shape (10, 2)."""
    return np.vstack([DESCENDING, TRANSITION_NEG[1:]])[::-1]
