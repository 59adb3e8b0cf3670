"""What ``hystbench diagnose`` reads and writes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from ..errors import InputError
from ..files import write_text
from .from_benchmark import diagnose_as_is_or_fitted
from .inputs import read_inputs
from .wording import summary

__all__ = ["deliver"]


def deliver(
    real: Sequence[Path],
    simulators: Sequence[Path],
    out: Path | None,
    json_file: Path | None,
    exclude: Sequence[str],
    seed: int,
    columns: Mapping[str, str | None],
) -> list[str]:
    """Diagnose files, write what was asked for and return the lines for the terminal.

    Raises
    ------
    InputError
        If an input is bad or an output cannot be written; one line.
    """
    if out is not None and out.exists() and not out.is_dir():
        raise InputError(f"--out {out} is a file; name a folder")
    if json_file is not None and json_file.is_dir():
        raise InputError(f"--json {json_file} is a folder; name a file")
    signals, model = read_inputs(real, simulators, **columns)
    found = diagnose_as_is_or_fitted(signals, model, exclude, seed)
    lines = []
    if out is not None:
        from ..reports.diagnosis_page import write_diagnosis

        found = write_diagnosis(found, out, model, [str(file) for file in real], [str(file) for file in simulators])
        lines.append(str(out / "diagnosis.html"))
    elif json_file is not None and str(json_file) != "-":
        from .excitation import design_next

        found = replace(found, next_recording=design_next(found, json_file.parent / f"{json_file.stem}-next.csv"))
    if json_file is not None:
        if str(json_file) == "-":
            return [found.to_json().rstrip("\n")]
        write_text(json_file, found.to_json())
    return [*summary(found, designed=out is not None or json_file is not None), *lines]
