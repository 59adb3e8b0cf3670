"""Scores of sealed verdicts."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

__all__ = ["BINS", "expected_calibration_error", "is_right", "score", "wilson"]

BINS = 10
WHERE: dict[str, tuple[str, ...]] = {
    "viscous_friction": ("speed",),
    "coulomb_friction": ("direction",),
    "stribeck_friction": ("speed", "direction"),
    "load_dependent_friction": ("load",),
    "stress_relaxation": ("time",),
    "thermal_drift": ("time",),
    "cyclic_softening": ("travel",),
    "torque_offset": ("load",),
    "torque_gain": ("load",),
    "sensor_delay": ("speed",),
    "backlash": ("distance_since_reversal",),
    "end_stop": ("position",),
    "inertia": ("acceleration",),
    "encoder_eccentricity": ("position",),
    "deflection_offset": ("position",),
    "stiffness_asymmetry": ("position",),
    "torque_saturation": ("load",),
}
"""Coordinates that count as right."""


def wilson(hits: int, count: int) -> tuple[float, float]:
    """95 % interval of a frequency (Wilson 1927)."""
    if count == 0:
        return 0.0, 1.0
    z = 1.959964
    p = hits / count
    centre = (p + z * z / (2 * count)) / (1 + z * z / count)
    half = z * np.sqrt(p * (1 - p) / count + z * z / (4 * count * count)) / (1 + z * z / count)
    return float(max(centre - half, 0.0)), float(min(centre + half, 1.0))


def is_right(verdict: Sequence[str], label: Mapping[str, Any]) -> bool:
    """Whether a verdict is the truth, nothing more and nothing less.

    Where the simulator's parameters are off as well, ``miscalibration`` may be named beside.
    """
    named = set(verdict)
    if label["base_error"] > 0.0:
        named.discard("miscalibration")
    return named == set(label["truth"])


def with_ambiguity(record: Mapping[str, Any], label: Mapping[str, Any]) -> bool:
    """Right, or the truth is what a stated ambiguity would make of the verdict."""
    if is_right(record["verdict"], label):
        return True
    for a, b in record["ambiguous"]:
        for out, into in ((a, b), (b, a)):
            if out in record["verdict"]:
                other = [into if name == out else name for name in record["verdict"]]
                if is_right(other, label):
                    return True
    return False


def expected_calibration_error(confidence: Sequence[float], right: Sequence[bool], bins: int = BINS) -> float:
    """Mean distance of stated confidence and frequency right over equally filled bins."""
    order = np.argsort(confidence, kind="stable")
    stated, true = np.asarray(confidence)[order], np.asarray(right, dtype=float)[order]
    parts = np.array_split(np.arange(stated.size), min(bins, max(stated.size, 1)))
    return float(sum(p.size * abs(stated[p].mean() - true[p].mean()) for p in parts if p.size) / max(stated.size, 1))


def score(records: Sequence[Mapping[str, Any]], labels: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """All figures of the check.

    Parameters
    ----------
    records : sequence of mapping
        One a recording: ``id, verdict, confidence, ambiguous, closed, where, baseline_fit, baseline_correlation, seconds``.
    labels : mapping
        The unsealed labels by id: ``truth, group, base_error, ratio, oracle_closed, effects, plant``.
    """
    by_group: dict[str, list[tuple[Any, Any]]] = defaultdict(list)
    for record in records:
        label = labels[record["id"]]
        by_group[label["group"]].append((record, label))

    def frequency(pairs: Sequence[tuple[Any, Any]], judge: Callable[[Any, Any], bool]) -> dict[str, Any]:
        hits = sum(judge(r, label) for r, label in pairs)
        low, high = wilson(hits, len(pairs))
        return {
            "right": hits,
            "of": len(pairs),
            "share": hits / len(pairs) if pairs else None,
            "low": low,
            "high": high,
        }

    groups = {
        name: {
            **frequency(pairs, lambda r, label: is_right(r["verdict"], label)),
            "with_ambiguity": frequency(pairs, with_ambiguity)["share"],
            "best_fit": frequency(pairs, lambda r, label: is_right([r["baseline_fit"]], label))["share"],
            "correlation": frequency(pairs, lambda r, label: is_right([r["baseline_correlation"]], label))["share"],
        }
        for name, pairs in sorted(by_group.items())
    }
    single = [(r, label) for g, pairs in by_group.items() if g.startswith("one effect, gap") for r, label in pairs]
    effects: dict[str, Any] = {}
    confusion: dict[str, dict[str, int]] = defaultdict(lambda: defaultdict(int))
    for record, label in single:
        confusion[label["effects"][0]][" + ".join(sorted(record["verdict"])) or "no gap"] += 1
    for name in sorted(confusion):
        effects[name] = frequency(
            [p for p in single if p[1]["effects"] == [name]], lambda r, label: is_right(r["verdict"], label)
        )
    correct = [(r, label) for r, label in single if is_right(r["verdict"], label)]
    distance = [r["closed"] - label["oracle_closed"] for r, label in correct]
    right = [is_right(r["verdict"], labels[r["id"]]) for r in records]
    stated = [r["confidence"] for r in records]
    unknown = [p for g in ("withheld from the registry", "outside the registry") for p in by_group.get(g, [])]
    return {
        "groups": groups,
        "effects": effects,
        "confusion": {name: dict(row) for name, row in sorted(confusion.items())},
        "coordinate": frequency(correct, lambda r, label: r["where"] in WHERE[label["effects"][0]]),
        "false_alarms": frequency(by_group.get("no effect", []), lambda r, label: r["verdict"] != []),
        "honest_unknown": frequency(unknown, lambda r, label: r["verdict"] == ["unknown"]),
        "closed": {
            "median_distance": float(np.median(np.abs(distance))) if distance else None,
            "within_0.03": float(np.mean(np.abs(distance) <= 0.03)) if distance else None,
        },
        "calibration": {
            "expected_calibration_error": expected_calibration_error(stated, right),
            "brier": float(np.mean((np.asarray(stated) - np.asarray(right, dtype=float)) ** 2)) if stated else None,
            "bins": _bins(stated, right),
        },
        "seconds": {
            "mean": float(np.mean([r["seconds"] for r in records])),
            "most": float(max(r["seconds"] for r in records)),
        },
        "all": {"right": int(sum(right)), "of": len(right)},
    }


def _bins(stated: Sequence[float], right: Sequence[bool]) -> list[dict[str, float]]:
    order = np.argsort(stated, kind="stable")
    made = []
    for part in np.array_split(order, min(BINS, max(len(stated), 1))):
        if part.size:
            hits = int(sum(right[k] for k in part))
            low, high = wilson(hits, part.size)
            made.append({
                "stated": float(np.mean([stated[k] for k in part])), "right": hits / part.size, "low": low, "high": high, "count": int(part.size),
            })  # fmt: skip
    return made
