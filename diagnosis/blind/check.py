"""``hystbench blind``: make recordings, seal their labels, diagnose, unseal, score."""

from __future__ import annotations

import hashlib
import json
import os
import time
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
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
from ..diagnosis import diagnose
from ..excitation import design_next
from ..hypotheses.heldout import closed_share
from ..inputs import read_inputs
from ..result import Diagnosis
from .baselines import by_correlation, by_fit
from .carry_over import found_closed, named_effects, predicted_closed, signal_on
from .cases import SINE, TEST_PLANTS, USUAL, available, bank, group, outside_of, quick_part
from .cost import LENGTHS, growth, measure
from .motions import MOTIONS
from .plant import Case, Plant, Recorded
from .plants import plant_of
from .scoring import is_right, score

__all__ = ["FIRST_SEED", "Laboratory", "check", "diagnose_blind", "examine", "lines", "seal", "unseal"]

FIRST_SEED = 250_000
"""Seeds of the test bank; the development bank used seeds below 10,000."""
SECONDS, RATE = 45.0, 100.0


@dataclass(frozen=True)
class Laboratory:
    """Where further recordings of a sealed plant are made on request; it tells nothing but the recording."""

    case: Case
    plant: Plant

    def record(self, time: np.ndarray, x: np.ndarray, request: int) -> Recorded:
        """Drive the case's plant along another motion; ``request`` numbers the requests (its noise is another)."""
        return self.plant.drive(time, x, np.random.default_rng([self.case.seed, 3, request]))

    def other_motion(self) -> tuple[np.ndarray, np.ndarray]:
        """A motion of another kind than the case's."""
        other = next(kind for kind in USUAL if kind != self.case.motion)
        return MOTIONS[other](np.random.default_rng([self.case.seed, 4]), self.plant.joint.reach, SECONDS, RATE)


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
    names = available()
    cases = bank(names, seeds, FIRST_SEED)
    if quick:
        cases = quick_part(cases)
    tasks, laboratories = seal(cases, out, workers)
    examined = (delayed(examine)(out, task, laboratories[task["id"]]) for task in tasks)
    verdicts = _progress("diagnoses", Parallel(n_jobs=workers, return_as="generator")(examined), len(tasks))
    write_text(out / "verdicts.json", json.dumps(verdicts, indent=1) + "\n")
    costs = measure(LENGTHS)
    labels = unseal(out)
    scores = score(verdicts, labels, {"by_length": costs, "exponent": growth(costs)})
    scores["run"] = {
        "seeds": seeds, "first_seed": FIRST_SEED, "quick": quick, "plants": list(names),
        "left_out": [name for name in TEST_PLANTS if name not in names], "elapsed_s": time.perf_counter() - began,
        "cases": len(cases), "sealed": json.loads((out / "seal.json").read_text(encoding="utf-8"))["sha256"],
    }  # fmt: skip
    write_text(out / "scores.json", json.dumps(scores, indent=1) + "\n")
    rows = [_row(record, labels[record["id"]]) for record in verdicts]
    with replacing(out / "cases.csv") as temporary:
        pd.DataFrame(rows).to_csv(temporary, index=False)
    from ...reports.blind_page import write_blind

    page = write_blind(scores, rows, out)
    return [*lines(scores), str(page)]


def _progress(what: str, results: Iterable[Any], total: int) -> list[Any]:
    """All results, with a bar on a terminal while they come."""
    console = Console(stderr=True)
    with (
        Progress(console=console, transient=True, disable=not console.is_terminal) as progress,
        warnings.catch_warnings(),
    ):
        # A worker that has grown is replaced by a fresh one; nothing is lost.
        warnings.filterwarnings("ignore", message="A worker stopped while some jobs were given")
        return list(progress.track(results, total=total, description=what))


def _row(record: Mapping[str, Any], label: Mapping[str, Any]) -> dict[str, Any]:
    """A line of ``cases.csv``."""
    again, carried = record["again"] or {}, record["carried"] or {}
    return {
        **{k: label[k] for k in ("plant", "group", "ratio", "base_error", "motion", "seed", "oracle_closed")},
        "truth": " + ".join(label["truth"]), "effects": " + ".join(label["effects"]),
        "verdict": " + ".join(record["verdict"]), "right": is_right(record["verdict"], label),
        **{k: record[k] for k in ("id", "confidence", "closed", "where", "baseline_fit", "baseline_correlation", "seconds")},
        "ambiguous": _pairs(record["ambiguous"]), "next_settles": _pairs(record["next_settles"]),
        "verdict_again": " + ".join(again.get("verdict", [])), "ambiguous_again": _pairs(again.get("ambiguous", [])),
        "closed_predicted": carried.get("predicted"), "closed_found": carried.get("found"),
    }  # fmt: skip


def _pairs(pairs: Sequence[Sequence[str]]) -> str:
    return "; ".join(" / ".join(pair) for pair in pairs)


def seal(cases: Sequence[Case], out: Path, workers: int) -> tuple[list[dict[str, Any]], dict[str, Laboratory]]:
    """Write recordings, tasks and sealed labels.

    Returns the tasks, shuffled so that their order tells nothing, and by their ids the laboratories that record more.
    """
    out.mkdir(parents=True, exist_ok=True)
    order = np.random.default_rng(FIRST_SEED).permutation(len(cases))
    names = [f"{k:04d}" for k in range(len(cases))]
    written = (delayed(_write_case)(cases[k], out, name) for k, name in zip(order, names, strict=True))
    made = _progress("recordings", Parallel(n_jobs=workers, return_as="generator")(written), len(cases))
    labels = {label["id"]: label for label, _, _ in made}
    text = json.dumps(labels, indent=1, sort_keys=True) + "\n"
    write_text(out / "labels.json", text)
    write_text(out / "seal.json", json.dumps({"sha256": hashlib.sha256(text.encode()).hexdigest()}) + "\n")
    tasks = [task for _, task, _ in made]
    write_text(out / "tasks.json", json.dumps(tasks, indent=1) + "\n")
    return tasks, {task["id"]: laboratory for _, task, laboratory in made}


def unseal(out: Path) -> dict[str, Any]:
    """The labels, if nobody has touched them since they were sealed."""
    text = (out / "labels.json").read_text(encoding="utf-8")
    sealed = json.loads((out / "seal.json").read_text(encoding="utf-8"))["sha256"]
    if hashlib.sha256(text.encode()).hexdigest() != sealed:
        raise InputError(f"{out / 'labels.json'}: does not match its seal; run the check again")
    return json.loads(text)


def _write_recording(out: Path, name: str, made: Recorded) -> tuple[str, str]:
    """Write what was recorded and what the simulator says; return the two files' names in ``out``."""
    real, sim = f"recordings/{name}-real.parquet", f"recordings/{name}-sim.parquet"
    (out / "recordings").mkdir(exist_ok=True)
    for file, y in ((real, made.y_real), (sim, made.y_sim)):
        write_recording(out / file, {DEFAULT_TIME: made.time, DEFAULT_X: made.x, DEFAULT_Y: y})
    return real, sim


def _write_case(case: Case, out: Path, name: str) -> tuple[dict[str, Any], dict[str, Any], Laboratory]:
    plant, time_s, x = plant_of(case, SECONDS, RATE)
    made = plant.record(time_s, x, np.random.default_rng([case.seed, 3]))
    real, sim = _write_recording(out, name, made)
    hidden = set(case.effects) & {*case.excluded, *outside_of(case.plant)}
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
    task = {"id": name, "real": real, "sim": sim, "exclude": list(case.excluded)}
    return label, task, Laboratory(case, plant)


def examine(out: Path, task: Mapping[str, Any], laboratory: Laboratory) -> dict[str, Any]:
    """Diagnose a sealed recording; then record what the diagnosis asks for, and see whether it keeps its word.

    Where effects stay ambiguous, the designed motion is recorded and both recordings are diagnosed together. Where
    effects are named, what they close on another kind of motion is predicted, recorded and compared.
    """
    record, found = diagnose_blind(out, task)
    record |= {"next_settles": [], "again": None, "carried": None}
    following = out / "recordings" / f"{task['id']}-next.csv"
    designed = design_next(found, following)
    if designed is not None:
        record["next_settles"] = designed["settles"]
        record["again"] = _diagnose_again(out, task, laboratory, following)
    if named_effects(found) and laboratory.case.motion != SINE:
        record["carried"] = _carry_over(found, laboratory)
    return record


def diagnose_blind(out: Path, task: Mapping[str, Any]) -> tuple[dict[str, Any], Diagnosis]:
    """Diagnose one sealed recording as a user would: from its two files."""
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
        "baseline_fit": by_fit(found.library),
        "baseline_correlation": by_correlation(found.library),
        "seconds": seconds,
    }, found


def _diagnose_again(out: Path, task: Mapping[str, Any], laboratory: Laboratory, motion: Path) -> dict[str, Any]:
    planned = pd.read_csv(motion)
    made = laboratory.record(planned[DEFAULT_TIME].to_numpy(), planned[DEFAULT_X].to_numpy(), 1)
    real, sim = _write_recording(out, f"{task['id']}-next", made)
    signals, _ = read_inputs([out / task["real"], out / real], [out / task["sim"], out / sim])
    found = diagnose(signals, exclude=task["exclude"])
    return {"verdict": found.verdict, "confidence": found.confidence, "ambiguous": found.ambiguous}


def _carry_over(found: Diagnosis, laboratory: Laboratory) -> dict[str, float]:
    made = laboratory.record(*laboratory.other_motion(), 2)
    signal = signal_on(found, made.time, made.x, made.y_sim)
    return {"predicted": predicted_closed(found, signal), "found": found_closed(made.signals, signal)}


def lines(scores: Mapping[str, Any]) -> list[str]:
    """The figures for the terminal."""
    made = [
        f"left out: the {name} plant, because the package {name} is not installed" for name in scores["run"]["left_out"]
    ]
    made.append(f"{'':<58}{'measured':>9}  {'95 % interval':<19}{'of':>4}  target")
    for row in scores["table"]:
        interval = f"{row['low']:.3g} to {row['high']:.3g}" if row["low"] is not None else ""
        value = "-" if row["value"] is None else f"{row['value']:.3g}"
        made.append(f"{row['what']:<58}{value:>9}  {interval:<19}{row['of'] or '':>4}  {row['target']}: {row['told']}")
    made += ["", f"{'':<34}right    interval      with ambiguity  best fit  correlation"]
    for name, row in scores["groups"].items():
        made.append(
            f"{name:<34}{row['right']:>3}/{row['of']:<3}  {row['low']:.2f}-{row['high']:.2f}"
            f"{row['with_ambiguity']:>12.2f}{row['best_fit']:>12.2f}{row['correlation']:>12.2f}"
        )
    made.append(
        f"Brier score {scores['calibration']['brier']:.3f}; {scores['seconds']['mean']:.1f} s a diagnosis; "
        f"{scores['run']['cases']} recordings, {scores['run']['elapsed_s']:.0f} s in all"
    )
    return made
