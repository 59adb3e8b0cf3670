"""``hystbench blind``: make recordings, seal their labels, diagnose, unseal, score."""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from joblib import Parallel, delayed
from rich.console import Console
from rich.progress import Progress

from ...datasets.recording_files import DEFAULT_TIME, DEFAULT_X, DEFAULT_Y, write_recording
from ...errors import InputError
from ...files import replacing, write_text
from .cases import TEST_PLANTS, bank, group
from .plants import OUTSIDE, Case, make
from .scoring import is_right, score

__all__ = ["FIRST_SEED", "check", "diagnose_blind", "seal"]

FIRST_SEED = 90_000
"""Seeds of the test bank; the development bank used seeds below 10,000."""
QUICK_EVERY = 6


def check(out: Path, seeds: int = 1, jobs: int | None = None, quick: bool = False) -> list[str]:
    """Run the blind check, write its results to ``out`` and return the lines for the terminal.

    Writes ``tasks.json`` (what the diagnosis may see), ``labels.json`` (sealed), ``seal.json`` (the labels' SHA-256,
    written before the first diagnosis), ``verdicts.json``, ``scores.json``, ``cases.csv`` and ``blind.html``.

    Raises
    ------
    InputError
        If ``out`` is a file, or the labels were touched between sealing and scoring.
    """
    if out.exists() and not out.is_dir():
        raise InputError(f"--out {out} is a file; name a folder")
    workers = jobs or os.cpu_count() or 1
    began = time.perf_counter()
    cases = bank(TEST_PLANTS, seeds, FIRST_SEED, QUICK_EVERY if quick else 1)
    tasks = seal(cases, out, workers)
    verdicts = []
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        bar = progress.add_task("diagnoses", total=len(tasks))
        for record in Parallel(n_jobs=workers, return_as="generator")(
            delayed(diagnose_blind)(out, task) for task in tasks
        ):
            verdicts.append(record)
            progress.advance(bar)
    write_text(out / "verdicts.json", json.dumps(verdicts, indent=1) + "\n")
    labels = unseal(out)
    scores = score(verdicts, labels)
    scores["run"] = {
        "seeds": seeds, "first_seed": FIRST_SEED, "quick": quick, "plants": list(TEST_PLANTS), "elapsed_s": time.perf_counter() - began,
        "cases": len(cases), "sealed": json.loads((out / "seal.json").read_text(encoding="utf-8"))["sha256"],
    }  # fmt: skip
    write_text(out / "scores.json", json.dumps(scores, indent=1) + "\n")
    rows = [
        {**{k: labels[r["id"]][k] for k in ("plant", "group", "ratio", "base_error", "motion", "seed", "oracle_closed")},
         "truth": " + ".join(labels[r["id"]]["truth"]), "verdict": " + ".join(r["verdict"]),
         "right": is_right(r["verdict"], labels[r["id"]]),
         **{k: r[k] for k in ("id", "confidence", "closed", "where", "baseline_fit", "baseline_correlation", "seconds")},
         "ambiguous": "; ".join(" / ".join(pair) for pair in r["ambiguous"])}
        for r in verdicts
    ]  # fmt: skip
    with replacing(out / "cases.csv") as temporary:
        pd.DataFrame(rows).to_csv(temporary, index=False)
    from ...reports.diagnosis_page import write_blind

    page = write_blind(scores, rows, out)
    return [*lines(scores), str(page)]


def seal(cases: Sequence[Case], out: Path, workers: int) -> list[dict[str, Any]]:
    """Write recordings, tasks and sealed labels; return the tasks, shuffled so that their order tells nothing."""
    out.mkdir(parents=True, exist_ok=True)
    order = np.random.default_rng(FIRST_SEED).permutation(len(cases))
    names = [f"{k:04d}" for k in range(len(cases))]
    made = Parallel(n_jobs=workers)(
        delayed(_write_case)(cases[k], out, name) for k, name in zip(order, names, strict=True)
    )
    labels = {label["id"]: label for label, _ in made}
    text = json.dumps(labels, indent=1, sort_keys=True) + "\n"
    write_text(out / "labels.json", text)
    write_text(out / "seal.json", json.dumps({"sha256": hashlib.sha256(text.encode()).hexdigest()}) + "\n")
    tasks = [task for _, task in made]
    write_text(out / "tasks.json", json.dumps(tasks, indent=1) + "\n")
    return tasks


def unseal(out: Path) -> dict[str, Any]:
    """The labels, if nobody has touched them since they were sealed."""
    text = (out / "labels.json").read_text(encoding="utf-8")
    sealed = json.loads((out / "seal.json").read_text(encoding="utf-8"))["sha256"]
    if hashlib.sha256(text.encode()).hexdigest() != sealed:
        raise InputError(f"{out / 'labels.json'}: does not match its seal; run the check again")
    return json.loads(text)


def _write_case(case: Case, out: Path, name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    made = make(case)
    real, sim = f"recordings/{name}-real.parquet", f"recordings/{name}-sim.parquet"
    (out / "recordings").mkdir(exist_ok=True)
    for file, y in ((real, made.y_real), (sim, made.y_sim)):
        write_recording(out / file, {DEFAULT_TIME: made.time, DEFAULT_X: made.x, DEFAULT_Y: y})
    hidden = set(case.effects) & (set(case.excluded) | set(OUTSIDE))
    label = {
        "id": name,
        "plant": case.plant,
        "effects": list(case.effects),
        "truth": ["unknown"] if hidden else sorted(case.effects),
        "group": group(case),
        "ratio": case.ratio,
        "base_error": case.base_error,
        "motion": case.motion,
        "seed": case.seed,
        "oracle_closed": made.oracle_closed,
    }
    return label, {"id": name, "real": real, "sim": sim, "exclude": list(case.excluded)}


def diagnose_blind(out: Path, task: dict[str, Any]) -> dict[str, Any]:
    """Diagnose one sealed recording as a user would: from its two files."""
    from ..diagnosis import diagnose
    from ..heldout import closed_share
    from ..inputs import read_inputs
    from .baselines import by_correlation, by_fit

    signals, _ = read_inputs([out / task["real"]], [out / task["sim"]])
    began = time.perf_counter()
    found = diagnose(signals, exclude=task["exclude"])
    seconds = time.perf_counter() - began
    return {
        "id": task["id"],
        "verdict": found.verdict,
        "confidence": found.confidence,
        "ambiguous": found.ambiguous,
        "closed": closed_share(signals.gap, signals.gap - found.choice.held.signal, found.noise_floor, found.seed)[1],
        "where": found.places[0].coordinate if found.places else "",
        "baseline_fit": by_fit(found.evidence, task["exclude"]),
        "baseline_correlation": by_correlation(found.evidence, task["exclude"]),
        "seconds": seconds,
    }


def lines(scores: dict[str, Any]) -> list[str]:
    """The figures for the terminal."""
    made = [f"{'':<34}right    interval      with ambiguity  best fit  correlation"]
    for name, row in scores["groups"].items():
        made.append(
            f"{name:<34}{row['right']:>3}/{row['of']:<3}  {row['low']:.2f}-{row['high']:.2f}"
            f"{row['with_ambiguity']:>12.2f}{row['best_fit']:>12.2f}{row['correlation']:>12.2f}"
        )
    calibration, closed = scores["calibration"], scores["closed"]
    made.append(f"false alarms without an effect: {scores['false_alarms']['right']} of {scores['false_alarms']['of']}")
    made.append(f"leading coordinate right: {scores['coordinate']['right']} of {scores['coordinate']['of']}")
    if closed["median_distance"] is not None:
        made.append(
            f"closed against the oracle: {closed['median_distance']:.3f} in the median, {100 * closed['within_0.03']:.0f} % within 0.03"
        )
    made.append(
        f"expected calibration error {calibration['expected_calibration_error']:.3f}, Brier score {calibration['brier']:.3f}"
    )
    made.append(f"{scores['seconds']['mean']:.1f} s a diagnosis; {scores['run']['elapsed_s']:.0f} s in all")
    return made
