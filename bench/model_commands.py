"""The commands that identify, evaluate and invert one model: ``fit``, ``predict`` and ``invert``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ..errors import InputError
from .console import DebugCommand, message
from .options import column_options

__all__ = ["fit", "invert", "predict"]

PARAMETERS_SHOWN = 14
UNCERTAINTY_WORK = 20_000_000
"""Samples times parameters up to which `fit` tells standard errors: a few seconds."""


@click.command(cls=DebugCommand)
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--model", "model_id", required=True, metavar="ID", help="Model id, see `hystbench list models`.")
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Model file to write (JSON).")
@click.option("--tune", is_flag=True, help="First choose the hyperparameters by blocked cross-validation.")
@column_options("x", "y", "time")
def fit(file: Path, model_id: str, out: Path, tune: bool, x: str | None, y: str | None, time: str | None) -> None:
    """Identify a model from a recording.

    \b
    Example:
      hystbench fit loop.csv --model maxwell-slip --out model.json --x angle --y torque
    """
    import numpy as np

    from .. import models
    from ..datasets.recording_files import read_recording
    from .arguments import time_argument
    from .metrics import score

    cls = models.get(model_id)
    recording = read_recording(file, x=x, y=y, time=time)
    try:
        model = _tuned(cls, recording) if tune else cls()
        model.fit(recording.x, recording.y, **time_argument(model.fit, recording.time))
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    model.save(out)
    predicted = model.predict(recording.x, **time_argument(model.predict, recording.time))
    figures = score(recording.y, np.asarray(predicted))
    click.echo(
        f"{out}: {model_id} fitted to {recording.x.size} samples, RMSE {figures['rmse']:.4g}, NRMSE {figures['nrmse']:.4g}"
    )
    for condition in getattr(model, "conditions_", []):
        message(f"{'holds' if condition.holds else 'VIOLATED'}: {condition.name} ({condition.detail})")
    for note in [*getattr(model, "notes_", []), *_assumed(model, str(recording.conditions.get("untimed", "")))]:
        message(f"note: {note}")
    for line in _determined(model, recording):
        click.echo(line)


def _assumed(model: Any, untimed: str) -> list[str]:
    """What the reader of a file had to assume of its times, for models to which they matter."""
    return [untimed] if untimed and not getattr(model, "rate_independent", True) else []


def _tuned(cls: type[Any], recording: Any) -> Any:
    """An unfitted model with the hyperparameters of the least held-out error; what was tried is told."""
    from ..models.selection import choose_hyperparameters

    if not getattr(cls, "search_grid", None):
        message(f"{cls.id} has no hyperparameters to choose")
        return cls()
    candidates = choose_hyperparameters(cls, recording.x, recording.y, time=recording.time)
    for candidate in candidates:
        setting = ", ".join(f"{name}={candidate.hyperparameters[name]}" for name in cls.search_grid)
        message(f"held-out NRMSE {candidate.nrmse:.4g} ± {candidate.spread:.2g}: {setting}")
    return cls().set_params(**candidates[0].hyperparameters)


def _determined(model: Any, recording: Any) -> list[str]:
    """What the recording tells of each parameter; only for models whose class can say which parameters it chooses."""
    from ..models.uncertainty import parameter_uncertainty

    if not hasattr(model, "coordinates"):
        return []
    labels, values, _ = model.coordinates()
    if recording.x.size * values.size > UNCERTAINTY_WORK:
        return [
            f"{values.size} parameters; standard errors left out, they would take long on {recording.x.size} samples"
        ]
    found = parameter_uncertainty(model, recording.x, recording.y, time=recording.time)
    lines = []
    if values.size <= PARAMETERS_SHOWN:
        lines = [
            f"  {label} = {value:.6g} ± {found.standard_errors[label]:.2g}"
            for label, value in zip(labels, values.tolist(), strict=True)
        ]
    if found.undetermined:
        shown = ", ".join(found.undetermined[:PARAMETERS_SHOWN]) + (
            " …" if len(found.undetermined) > PARAMETERS_SHOWN else ""
        )
        lines.append(
            f"this recording does not determine {len(found.undetermined)} of {values.size} parameters: {shown}"
        )
    return lines


@click.command(cls=DebugCommand)
@click.argument("model", metavar="MODEL.json", type=click.Path(path_type=Path))
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--out", required=True, type=click.Path(path_type=Path), help="File to write (.csv or .parquet).")
@column_options("x", "y", "time")
def predict(model: Path, file: Path, out: Path, x: str | None, y: str | None, time: str | None) -> None:
    """Predict the output over the input column of FILE.

    \b
    Example:
      hystbench predict model.json motion.csv --out torque.csv
    """
    from .. import models
    from ..datasets.recording_files import DEFAULT_Y, read_columns, write_recording
    from .arguments import time_argument

    fitted = models.load(model)
    columns = read_columns(file, {"x": x}, time=time)
    for note in _assumed(fitted, columns.untimed):
        message(f"note: {note}")
    predicted = fitted.predict(columns["x"], **time_argument(fitted.predict, columns.time))
    write_recording(
        out, {columns.names["time"]: columns.clock, columns.names["x"]: columns["x"], y or DEFAULT_Y: predicted}
    )
    click.echo(str(out))


@click.command(cls=DebugCommand)
@click.argument("model", metavar="MODEL.json", type=click.Path(path_type=Path))
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--out", required=True, type=click.Path(path_type=Path), help="File to write (.csv or .parquet).")
@column_options("x", "y", "time")
@click.option(
    "--x0", type=float, default=0.0, show_default=True, help="Input from which the first sample is looked for."
)
@click.option("--approximate", is_flag=True, help="Where no input gives the wanted output, take the nearest.")
def invert(
    model: Path, file: Path, out: Path, x: str | None, y: str | None, time: str | None, x0: float, approximate: bool
) -> None:
    """Find the input that gives the output column of FILE.

    \b
    Example:
      hystbench invert model.json reference.csv --out deflection.csv
    """
    from .. import models
    from ..datasets.recording_files import DEFAULT_X, read_columns, write_recording
    from .arguments import time_argument

    fitted = models.load(model)
    columns = read_columns(file, {"y": y}, time=time)
    for note in _assumed(fitted, columns.untimed):
        message(f"note: {note}")
    times = time_argument(fitted.invert, columns.time)
    found = fitted.invert(columns["y"], x0=x0, approximate=approximate, **times)
    write_recording(
        out, {columns.names["time"]: columns.clock, x or DEFAULT_X: found, columns.names["y"]: columns["y"]}
    )
    click.echo(str(out))
