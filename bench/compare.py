"""Did a model get worse? Two result tables, compared cell by cell."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from ..errors import InputError
from .results import TIME_COLUMNS

__all__ = ["KINDS", "WORSE", "Comparison", "Difference", "changed_data", "compare", "parse_tolerance", "why_not_timed"]

Floats = NDArray[np.float64]
KEYS = ["model", "dataset", "condition", "task"]
FLOOR = 1e-9
"""NRMSE below which a difference is rounding: two exact fits may differ by any ratio."""
SIGNIFICANCE = 0.05
"""Of one cell's paired test over its seeds."""
MODEL_SIGNIFICANCE = 0.01
"""Of one model's signed-rank test over its cells; there are fewer of these, and they look for smaller changes."""
BREAKDOWN = 2.0
"""Growth of one seed's error that counts whatever the other seeds do: a fit that broke down is not noise."""
TIME_TOLERANCE = 0.5
TIME_FLOORS = {"fit_s": 0.02, "predict_ns_per_sample": 20.0, "step_ns": 300.0}
"""Differences smaller than these are the timer's and the scheduler's, whatever their ratio."""

KINDS = (
    "failed",
    "missing",
    "regression",
    "slower",
    "unsure",
    "failing",
    "changed data",
    "improvement",
    "faster",
    "new",
)
WORSE = frozenset(KINDS[:4])


@dataclass(frozen=True)
class Difference:
    """One cell (or model) that differs between base and new; ``kind`` is one of :data:`KINDS`.

    ``base`` and ``new`` are NRMSE, or a time in the unit of its column; NaN where there is none.
    """

    kind: str
    cell: str
    base: float
    new: float
    message: str


@dataclass(frozen=True)
class Comparison:
    """What :func:`compare` found: differences worst first, and how many cells and times they were found among."""

    compared: int
    timed: int
    tolerance: float
    differences: Sequence[Difference]

    @property
    def worse(self) -> int:
        """Number of differences that fail a check."""
        return sum(d.kind in WORSE for d in self.differences)


def parse_tolerance(text: str, option: str = "--tolerance") -> float:
    """``"5%"`` or ``"0.05"`` as 0.05."""
    try:
        value = float(text.rstrip("%")) / (100.0 if text.endswith("%") else 1.0)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < 10.0:
        raise InputError(f"{option} must be a percentage such as 5% or a fraction such as 0.05; it is {text!r}")
    return value


def changed_data(base: Mapping[str, Any], new: Mapping[str, Any]) -> set[str]:
    """Datasets whose samples differ between two runs, by their ``run.json``: their errors cannot be compared."""
    old, now = ({k: v.get("sha256") for k, v in run.get("data", {}).items()} for run in (base, new))
    return {name for name in old.keys() & now.keys() if old[name] != now[name]}


def why_not_timed(base: Mapping[str, Any], new: Mapping[str, Any]) -> str:
    """Why the times of two runs cannot be compared, by their ``run.json``; empty if they can."""
    old, now = base.get("sessions", []), new.get("sessions", [])
    if len(old) == len(now) == 1 and old == now:
        return ""
    return "they were not measured in one session (one machine, one boot, one day)"


def compare(
    base: pd.DataFrame,
    new: pd.DataFrame,
    tolerance: float,
    *,
    time_tolerance: float | None = None,
    changed: Collection[str] = (),
) -> Comparison:
    """Compare two result tables.

    The errors of a cell are paired over its seeds. A cell is worse if its NRMSE grew by more than ``tolerance``
    (geometric mean over the seeds) and a one-sided paired t-test of the log ratios says that this is not chance; with
    one seed, or if one seed's error doubled, the growth alone decides. A model is worse if the geometric mean over all
    its cells grew by more than half the tolerance and a signed-rank test over the cells agrees: a small loss
    everywhere is as certain as a large one in one place. Times are compared by model, relative to what the other
    models' times did, with a ratio and an absolute floor.

    Parameters
    ----------
    base, new : DataFrame
        As :func:`hystbench.bench.results.read_results` returns them.
    tolerance : float
        Allowed growth of the NRMSE, 0.05 for 5 %.
    time_tolerance : float, optional
        Allowed growth of a time; None: times are not compared.
    changed : collection of str
        Datasets whose samples are not the same, see :func:`changed_data`.
    """
    base, new = _sound(base), _sound(new)
    old, now = dict(tuple(base.groupby(KEYS))), dict(tuple(new.groupby(KEYS)))
    growth: dict[str, list[float]] = {}
    found: list[Difference] = []
    for key in sorted(old.keys() | now.keys()):
        name = " / ".join(map(str, key))
        if key not in now:
            if (old[key]["status"] == "ok").all():
                found.append(Difference("missing", name, _error(old[key]), math.nan, "in BASE only"))
        elif key not in old:
            found.append(Difference("new", name, math.nan, _error(now[key]), "in NEW only"))
        elif key[1] in changed:
            found.append(
                Difference("changed data", name, _error(old[key]), _error(now[key]), "not compared: its samples differ")
            )
        else:
            difference, ratio = _compare_cell(name, old[key], now[key], tolerance)
            if ratio is not None:
                growth.setdefault(str(key[0]), []).append(ratio)
            if difference is not None:
                found.append(difference)
    compared = sum(map(len, growth.values()))
    blamed = {d.cell.split(" / ")[0] for d in found if d.kind == "regression"}
    for model, ratios in growth.items():
        if model not in blamed and (difference := _compare_model(model, np.array(ratios), tolerance)):
            found.append(difference)
    timed, slower = (0, []) if time_tolerance is None else _compare_times(base, new, time_tolerance)
    found += slower
    found.sort(key=lambda d: (KINDS.index(d.kind), -_growth(d)))
    return Comparison(compared, timed, tolerance, found)


def _growth(difference: Difference) -> float:
    ratio = difference.new / max(difference.base, FLOOR)
    return ratio if math.isfinite(ratio) else 0.0


def _sound(table: pd.DataFrame) -> pd.DataFrame:
    """The table with cells whose error is no finite figure as failed ones, whatever they say of themselves."""
    errors = table["nrmse"].fillna(table["rmse"])
    lost = table["status"].eq("ok") & ~np.isfinite(errors.to_numpy(dtype=float))
    return table.assign(
        status=table["status"].mask(lost, "failed"), message=table["message"].mask(lost, "its error is not finite")
    )


def _values(rows: pd.DataFrame) -> pd.Series:
    """NRMSE by seed; the RMSE where the truth has no range to divide by."""
    return rows.set_index("seed")["nrmse"].fillna(rows.set_index("seed")["rmse"])


def _error(rows: pd.DataFrame) -> float:
    return float(_values(rows).median())


def _told(rows: pd.DataFrame) -> str:
    bad = rows[rows["status"] != "ok"]
    seeds = f" (seed {', '.join(map(str, bad['seed']))} of {len(rows)} seeds)" if 0 < len(bad) < len(rows) else ""
    return f"{bad['status'].iloc[0]}: {bad['message'].iloc[0]}{seeds}"


def _compare_cell(
    name: str, old: pd.DataFrame, now: pd.DataFrame, tolerance: float
) -> tuple[Difference | None, float | None]:
    """The difference of one cell, if any, and the logarithm of its growth, if it has one."""
    was_ok, is_ok = ((rows["status"] == "ok").all() for rows in (old, now))
    before, after = _values(old[old["status"] == "ok"]), _values(now[now["status"] == "ok"])
    if was_ok and not is_ok:
        return Difference("failed", name, _error(old), math.nan, _told(now)), None
    if not is_ok:
        fails = {*old["status"], *now["status"]} & {"failed", "timeout"}
        return (Difference("failing", name, math.nan, math.nan, f"in both; {_told(now)}") if fails else None), None
    if not was_ok:
        return Difference("improvement", name, math.nan, _error(now), f"was {_told(old)}"), None
    lost = sorted(set(before.index) - set(after.index))
    if lost:
        what = f"seed {', '.join(map(str, lost))} in BASE only"
        return Difference("missing", name, _error(old), _error(now), what), None
    shared = sorted(set(before.index) & set(after.index))
    first, second = (np.maximum(v.loc[shared].to_numpy(dtype=float), FLOOR) for v in (before, after))
    ratios = np.log(second / first)
    grown = float(np.mean(ratios))
    # Two fits to rounding may differ by any ratio.
    if np.max(np.abs(second - first)) <= FLOOR:
        return None, 0.0
    kind = ""
    if grown > math.log1p(tolerance) or np.max(ratios) > max(math.log(BREAKDOWN), math.log1p(tolerance)):
        sure = np.max(ratios) > math.log(BREAKDOWN) or _chance(ratios) < SIGNIFICANCE
        kind = "regression" if sure else "unsure"
    elif grown < -math.log1p(tolerance):
        kind = "improvement"
    if not kind:
        return None, grown
    message = f"{math.expm1(grown):+.1%}"
    if len(shared) > 1:
        message += f" over {len(shared)} seeds ({math.expm1(ratios.min()):+.1%} to {math.expm1(ratios.max()):+.1%})"
    return Difference(kind, name, float(np.median(first)), float(np.median(second)), message), grown


def _chance(ratios: Floats) -> float:
    """P value of the one-sided paired t-test that the log ratios are not above 0."""
    # One seed has no spread to test against, and equal seeds have none: what is deterministic is not chance.
    if ratios.size < 2 or np.ptp(ratios) < 1e-9:
        return 0.0
    return float(stats.ttest_1samp(ratios, 0.0, alternative="greater").pvalue)


def _compare_model(model: str, ratios: Floats, tolerance: float) -> Difference | None:
    """A small loss over all cells of a model; each cell counts once, because its seeds are not independent of it."""
    grown = float(np.mean(ratios))
    if grown <= math.log1p(tolerance / 2.0):
        return None
    p = float(stats.wilcoxon(ratios, alternative="greater", zero_method="zsplit").pvalue)
    if p >= MODEL_SIGNIFICANCE:
        return None
    message = f"{math.expm1(grown):+.1%} in the mean of its {ratios.size} cells (signed-rank test, p = {p:.1g})"
    return Difference("regression", f"{model} / all its cells", 1.0, math.exp(grown), message)


def _compare_times(base: pd.DataFrame, new: pd.DataFrame, tolerance: float) -> tuple[int, list[Difference]]:
    """Times by model. The rows of a cell's tasks repeat its times, so one task stands for all."""
    keys = ["model", "dataset", "condition", "seed"]
    old, now = (t[t["status"] == "ok"].groupby(keys)[list(TIME_COLUMNS)].first() for t in (base, new))
    both = old.merge(now, left_index=True, right_index=True, suffixes=(" base", " new"))
    timed, found = 0, []
    for column in TIME_COLUMNS:
        pairs = both[[f"{column} base", f"{column} new"]].dropna()
        pairs = pairs[(pairs > 0).all(axis=1)]
        timed += len(pairs)
        ratios = pairs[f"{column} new"] / pairs[f"{column} base"]
        medians = ratios.groupby(level="model").median()
        for model, group in ratios.groupby(level="model"):
            others = medians.drop(model)
            # What slows all other models down as well is the machine (or a neighbour on it), not this model.
            common = float(others.median()) if len(others) > 1 else 1.0
            relative = group.to_numpy() / common
            before, after = (
                float(np.median(pairs.loc[[model], f"{column} {side}"].to_numpy())) for side in ("base", "new")
            )
            kind = ""
            if (
                np.median(relative) > 1.0 + tolerance
                and np.quantile(relative, 0.25) > 1.0 + tolerance / 2.0
                and after / common - before > TIME_FLOORS[column]
            ):
                kind = "slower"
            elif np.median(relative) < 1.0 / (1.0 + tolerance) and before - after / common > TIME_FLOORS[column]:
                kind = "faster"
            if kind:
                message = f"{np.median(relative):.2f} times the time in the median of {group.size} cells"
                if len(others) > 1:
                    message += f", the other models' change ({common:.2f} times) taken out"
                found.append(Difference(kind, f"{model} / {column}", before, after, message))
    return timed, found
