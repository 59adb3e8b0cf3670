"""Which model for what: short rules, each computed from the results and with the figures that it rests on."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np
import pandas as pd

from .ranking import Ranking
from .run_directory import RunDirectory
from .tables import number

__all__ = ["accuracy_and_cost", "advice"]

NEAR = 1.25
"""Errors within this ratio of the best one are called close."""


def _typical(rows: pd.DataFrame) -> float:
    """Geometric mean of the NRMSE over datasets (median over seeds); NaN if any is missing."""
    if rows.empty or (rows["status"] != "ok").any():
        return math.nan
    medians = rows.groupby("dataset")["nrmse"].median().clip(lower=1e-9)
    return float(np.exp(np.log(medians).mean()))


def _rows(run: RunDirectory, model: str, task: str, datasets: Iterable[str], condition: str = "") -> pd.DataFrame:
    parts = [run.rows(d, condition or run.reference_condition(d), task, model) for d in datasets]
    return pd.concat(parts) if parts else run.table.iloc[:0]


def _least(values: dict[str, float]) -> tuple[str, list[str]] | None:
    """The model with the smallest figure and those close to it."""
    finite = {m: v for m, v in values.items() if math.isfinite(v)}
    if not finite:
        return None
    best = min(finite, key=lambda m: finite[m])
    return best, [m for m, v in finite.items() if m != best and v <= NEAR * finite[best]]


def advice(run: RunDirectory, rankings: dict[str, Ranking]) -> list[tuple[str, str]]:
    """Pairs of a purpose and what this run says for it."""
    told: list[tuple[str, str]] = []

    def least(purpose: str, values: dict[str, float], figure: Callable[[str], str]) -> None:
        found = _least(values)
        if found is not None and len([v for v in values.values() if math.isfinite(v)]) > 1:
            best, close = found
            text = f"{run.model_title(best)} ({figure(best)})"
            if close:
                text += "; close: " + ", ".join(f"{run.model_title(m)} ({figure(m)})" for m in close)
            told.append((purpose, text))

    purposes = {
        "forward": "Predicting the output",
        "inverse": "Finding the input for a wanted output",
        "compensation": "Compensation by the inverse",
    }
    for task, purpose in purposes.items():
        if (ranking := rankings.get(task)) is not None:
            first = [m for m, place in zip(ranking.models, ranking.place, strict=True) if place.rstrip("=") == "1"]
            names = ", ".join(run.model_title(m) for m in first)
            how = "not told apart" if len(first) > 1 else "ahead of the others"
            told.append((purpose, f"{names}: {how} over {len(ranking.datasets)} datasets"))
    for kind, purpose in (
        ("synthetic", "Smallest typical error, known plants"),
        ("recorded", "Smallest typical error, recorded data"),
    ):
        chosen = [d for d in run.datasets if run.dataset(d).get("kind") == kind]
        errors = {m: _typical(_rows(run, m, "forward", chosen)) for m in run.models}
        least(purpose, errors, lambda m, errors=errors: f"NRMSE {number(errors[m])}")  # type: ignore[misc]
    noisy = [d for d in run.datasets if {"clean", "noisy"} <= set(run.conditions(d))]
    growth = {
        m: _typical(_rows(run, m, "forward", noisy, "noisy")) / _typical(_rows(run, m, "forward", noisy, "clean"))
        for m in run.models
    }
    least(
        "Unfiltered sensor noise hurts least",
        growth,
        lambda m: f"error {number(growth[m], 2)} times that without noise",
    )
    steps = {m: _seconds(run, m, "step_ns") for m in run.models}
    least("Fastest sample by sample, in a control loop", steps, lambda m: f"{number(steps[m])} ns")
    fits = {m: _seconds(run, m, "fit_s") for m in run.models}
    least("Fastest to identify", fits, lambda m: f"{number(fits[m], 2)} s")
    return told


def _seconds(run: RunDirectory, model: str, column: str) -> float:
    rows = run.table[(run.table["model"] == model) & (run.table["status"] == "ok")]
    return float(rows[column].median()) if not rows.empty else math.nan


def accuracy_and_cost(run: RunDirectory) -> pd.DataFrame:
    """Time of prediction (ns/sample) and typical forward NRMSE of each model, and whether any is better in both."""
    rows = []
    for model in run.models:
        error = _typical(_rows(run, model, "forward", run.datasets))
        rows.append({"model": model, "time": _seconds(run, model, "predict_ns_per_sample"), "error": error})
    table = pd.DataFrame(rows).dropna().reset_index(drop=True)
    table["front"] = [
        not ((table["time"] <= t) & (table["error"] <= e) & ((table["time"] < t) | (table["error"] < e))).any()
        for t, e in zip(table["time"], table["error"], strict=True)
    ]
    return table
