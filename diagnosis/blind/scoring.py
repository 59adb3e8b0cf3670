"""Scores of sealed verdicts."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..names import MISCALIBRATION

__all__ = ["BINS", "CARRIED", "expected_calibration_error", "is_right", "score", "settled", "wilson"]

Floats = NDArray[np.float64]
Pair = tuple[Mapping[str, Any], Mapping[str, Any]]
BINS = 10
RESAMPLES = 1000
POOR = "a poor recording: one sine"
CLEAR = ("one effect, gap/noise 4", "one effect, gap/noise 8", "one effect, gap/noise 16")
CARRIED = (*CLEAR, "two effects")
"""Groups whose named effects are carried over to another motion in the table."""
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
        named.discard(MISCALIBRATION)
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


def settled(record: Mapping[str, Any], label: Mapping[str, Any]) -> list[bool]:
    """For each stated ambiguous pair with one true member: whether the designed recording settled it.

    It did if, both recordings together, the pair is no longer stated, the true member is named and the other is not.
    """
    truth = {*label["truth"], *((MISCALIBRATION,) if label["base_error"] > 0.0 else ())}
    again = record["again"]
    judged = []
    for pair in record["ambiguous"]:
        true, false = [name for name in pair if name in truth], [name for name in pair if name not in truth]
        if len(true) == 1:
            judged.append(
                again is not None
                and list(pair) not in again["ambiguous"]
                and true[0] in again["verdict"]
                and false[0] not in again["verdict"]
            )
    return judged


def poor_is_right(record: Mapping[str, Any], label: Mapping[str, Any]) -> bool:
    """Right, or the truth is in a stated ambiguity that the designed recording settled."""
    if is_right(record["verdict"], label):
        return True
    return with_ambiguity(record, label) and record["again"] is not None and is_right(record["again"]["verdict"], label)


def expected_calibration_error(confidence: Sequence[float], right: Sequence[bool], bins: int = BINS) -> float:
    """Mean distance of stated confidence and frequency right over equally filled bins."""
    order = np.argsort(confidence, kind="stable")
    stated, true = np.asarray(confidence)[order], np.asarray(right, dtype=float)[order]
    parts = np.array_split(np.arange(stated.size), min(bins, max(stated.size, 1)))
    return float(sum(p.size * abs(stated[p].mean() - true[p].mean()) for p in parts if p.size) / max(stated.size, 1))


def score(
    records: Sequence[Mapping[str, Any]], labels: Mapping[str, Mapping[str, Any]], cost: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """All figures of the check.

    Parameters
    ----------
    records : sequence of mapping
        One a recording: ``id, verdict, confidence, ambiguous, closed, where, baseline_fit, baseline_correlation, seconds,
        next_settles, again, carried``.
    labels : mapping
        The unsealed labels by id: ``truth, group, base_error, ratio, oracle_closed, effects, plant``.
    cost : mapping, optional
        ``by_length`` (each ``samples, seconds, peak_mb``) and ``exponent``.
    """
    pairs = [(record, labels[record["id"]]) for record in records]
    by_group: dict[str, list[Pair]] = defaultdict(list)
    for record, label in pairs:
        by_group[label["group"]].append((record, label))
    groups = {
        name: {
            **_frequency(members, right),
            "with_ambiguity": _frequency(members, with_ambiguity)["share"],
            "best_fit": _frequency(members, lambda r, label: is_right([r["baseline_fit"]], label))["share"],
            "correlation": _frequency(members, lambda r, label: is_right([r["baseline_correlation"]], label))["share"],
        }
        for name, members in sorted(by_group.items())
    }
    single = [pair for name, members in by_group.items() if name.startswith("one effect, gap") for pair in members]
    confusion: dict[str, dict[str, int]] = defaultdict(lambda: defaultdict(int))
    for record, label in single:
        confusion[label["effects"][0]][" + ".join(sorted(record["verdict"])) or "no gap"] += 1
    truths = [right(record, label) for record, label in pairs]
    stated = [record["confidence"] for record in records]
    return {
        "table": _table(pairs, cost),
        "groups": groups,
        "effects": {
            name: _frequency([pair for pair in single if pair[1]["effects"] == [name]], right)
            for name in sorted(confusion)
        },
        "plants": {
            name: _frequency([pair for pair in pairs if pair[1]["plant"] == name], right)
            for name in sorted({label["plant"] for _, label in pairs})
        },
        "confusion": {name: dict(row) for name, row in sorted(confusion.items())},
        "calibration": {
            "expected_calibration_error": expected_calibration_error(stated, truths),
            "brier": float(np.mean((np.asarray(stated) - np.asarray(truths, dtype=float)) ** 2)) if stated else None,
            "bins": _bins(stated, truths),
        },
        "seconds": {
            "mean": float(np.mean([r["seconds"] for r in records])),
            "most": float(max(r["seconds"] for r in records)),
        },
        "cost": dict(cost) if cost else None,
        "all": {"right": int(sum(truths)), "of": len(truths)},
    }


def _frequency(pairs: Sequence[Pair], judge: Callable[[Any, Any], bool]) -> dict[str, Any]:
    return _share([bool(judge(record, label)) for record, label in pairs])


def _share(judged: Sequence[bool]) -> dict[str, Any]:
    hits, count = int(sum(judged)), len(judged)
    low, high = wilson(hits, count)
    return {"right": hits, "of": count, "share": hits / count if count else None, "low": low, "high": high}


def right(record: Mapping[str, Any], label: Mapping[str, Any]) -> bool:
    """Whether a record's verdict is right."""
    return is_right(record["verdict"], label)


def _table(pairs: Sequence[Pair], cost: Mapping[str, Any] | None) -> list[dict[str, Any]]:
    """What must be reached: each figure with its 95 % interval, its target, and whether it is reached."""

    def of(*names: str) -> list[Pair]:
        return [(r, label) for r, label in pairs if label["group"] in names]

    clear = of(*CLEAR)
    faint = of("one effect, gap/noise 2")
    hidden = of("withheld from the registry", "outside the registry")
    correct = [(r, label) for r, label in clear + faint if right(r, label)]
    known = [(r, label) for r, label in pairs if label["truth"] != ["unknown"]]
    asked = [judged for r, label in known for judged in settled(r, label)]
    carried = [r["carried"] for r, label in of(*CARRIED) if r["carried"] is not None]
    distance = [abs(r["closed"] - label["oracle_closed"]) for r, label in correct]
    share = [r["closed"] / label["oracle_closed"] for r, label in correct]
    stated = np.array([(r["confidence"], float(right(r, label))) for r, label in pairs]).reshape(-1, 2)
    rows = [
        _line("one effect, gap/noise 4 and more: right, alone", _frequency(clear, right), 0.95),
        _line("the same, counting a stated ambiguity that contains it", _frequency(clear, with_ambiguity), 0.98),
        _line("one effect, gap/noise 2", _frequency(faint, right), 0.85),
        _line("no effect: no gap", _frequency(of("no effect"), right), 0.99),
        _line("outside the registry, or withheld: unknown", _frequency(hidden, right), 0.90),
        _line("the same, counting explanations that close half or more", _frequency(hidden, _not_misled), 0.90),
        _line("simulator off too: right", _frequency(of("one effect, simulator off"), right), 0.92),
        _line("simulator off alone: miscalibration or no gap", _frequency(of("no effect, simulator off"), right), 0.92),
        _line("two effects: both, nothing else", _frequency(of("two effects"), right), 0.85),
        _line("leading coordinate", _frequency(correct, _place_is_right), 0.95),
        _measure("closed, median distance from the oracle", distance, np.median, 0.03, at_most=True),
        _measure("closed, median share of the oracle's", share, np.median, 0.95),
        _measure("expected calibration error", stated, _calibration_error, 0.05, at_most=True),
        _line("one sine: right, or ambiguous and settled afterwards", _frequency(of(POOR), poor_is_right), 0.95),
        _line("ambiguous pairs settled by one designed recording", _share(asked), 0.90),
        _line(
            "closed elsewhere within 0.10 of what was predicted",
            _share([abs(c["predicted"] - c["found"]) <= 0.10 for c in carried]),
            0.80,
        ),
    ]
    if cost:
        longest = max(cost["by_length"], key=lambda row: row["samples"])
        label = f"{longest['samples']} samples, whole registry"
        rows.append(_row(f"{label}, s", longest["seconds"], None, None, None, 20.0, True))
        rows.append(_row(f"{label}, peak MB", longest["peak_mb"], None, None, None, 1000.0, True))
        rows.append(_row("growth of time: exponent of the samples", cost["exponent"], None, None, None, 1.1, True))
    return rows


def _not_misled(record: Mapping[str, Any], label: Mapping[str, Any]) -> bool:
    """Whether no effect is presented as the cause that closes less than half of the gap."""
    return record["verdict"] == ["unknown"] or (record["verdict"] != [] and record["closed"] >= 0.5)


def _place_is_right(record: Mapping[str, Any], label: Mapping[str, Any]) -> bool:
    return record["where"] in WHERE[label["effects"][0]]


def _calibration_error(stated: Floats) -> float:
    return expected_calibration_error(stated[:, 0].tolist(), (stated[:, 1] > 0.5).tolist())


def _line(what: str, found: Mapping[str, Any], target: float) -> dict[str, Any]:
    return _row(what, found["share"], found["low"], found["high"], found["of"], target, False)


def _measure(
    what: str, values: Sequence[float] | Floats, statistic: Callable[..., Any], target: float, at_most: bool = False
) -> dict[str, Any]:
    """A statistic over recordings with the percentile interval of its bootstrap."""
    sample = np.asarray(values, dtype=float)
    if not sample.size:
        return _row(what, None, None, None, 0, target, at_most)
    rng = np.random.default_rng(0)
    drawn = [float(statistic(sample[rng.integers(0, len(sample), len(sample))])) for _ in range(RESAMPLES)]
    low, high = np.percentile(drawn, [2.5, 97.5])
    return _row(what, float(statistic(sample)), float(low), float(high), len(sample), target, at_most)


def _row(
    what: str,
    value: float | None,
    low: float | None,
    high: float | None,
    count: int | None,
    target: float,
    at_most: bool,
) -> dict[str, Any]:
    if value is None:
        told = "not measured"
    else:
        told = "reached" if (value <= target if at_most else value >= target) else "missed"
    return {
        "what": what, "value": value, "low": low, "high": high, "of": count,
        "target": f"{'≤' if at_most else '≥'} {target:g}", "told": told,
    }  # fmt: skip


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
