"""Computing everything that the page shows, and writing it."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import fields
from pathlib import Path
from typing import Any

from rich.console import Console

from ...errors import InputError
from ...files import write_text
from .appendix_a import equation_checks, stiffness_checks
from .audit import audit
from .expectation import expectation
from .figures import FIGURES, save
from .fits import fit_models
from .page import Drawn, render_page
from .parallel import DEFAULT_JOBS
from .passivity import (
    choi_conditions_of_published_loop,
    example_choi,
    integrals,
    objectives,
)
from .results import Results
from .sensitivity import sensitivity
from .tables import table_1, table_2, table_3, table_4_and_5

__all__ = ["collect", "write", "write_paper"]


def collect(names: Sequence[str] | None = None, seeds: Sequence[int] = (0, 1, 2), jobs: int = DEFAULT_JOBS) -> Results:
    """Recompute all tables, the audit, the appendices and the sensitivity study.

    Parameters
    ----------
    names : sequence of str, optional
        Models of Tables 4 and 5; must include the paper's three (default: all registered).
    seeds : sequence of int
        Seeds of the assumed sensor noise; Tables 4 and 5 show medians.
    jobs : int
        Processes.
    """
    fits = fit_models(names, seeds=seeds, jobs=jobs)
    fitted = {name: fits.first(name).model for name in fits.models if fits.first(name).torque is not None}
    conditions = {"the published loop (Tables 1 and 2)": choi_conditions_of_published_loop()}
    conditions["the polynomial example"] = example_choi().conditions_
    for name, model in fitted.items():
        if getattr(model, "conditions_", None):
            conditions[f"{name} identified on the published loop"] = list(model.conditions_)
    return Results(
        fits,
        [*table_1(), *table_2(), *table_3(), *table_4_and_5(fits)],
        audit(),
        equation_checks(),
        stiffness_checks(),
        conditions,
        objectives(),
        integrals(fitted),
        sensitivity(fits, jobs),
    )


def write(results: Results, out: Path) -> Path:
    """Write page, data and figures to the folder ``out`` and return the page's path.

    The same results give the same bytes.
    """
    drawn = [Drawn(figure, *save(figure, results.fits, out / "figures")) for figure in FIGURES]
    _csv(out / "tables.csv", results.tables)
    _csv(out / "audit.csv", results.audit, leave_out=("values",))
    _csv(out / "appendix_a.csv", results.equations, extra={"agrees": lambda r: r.agrees})
    _csv(out / "stiffness.csv", results.stiffness)
    _csv(out / "passivity.csv", results.integrals)
    _csv(
        out / "sensitivity.csv",
        results.sensitivity,
        extra={
            "order": lambda r: r.order,
            "as_printed": lambda r: r.as_printed,
            "closest": lambda r: _figure(r.closest),
        },
    )
    write_text(out / "audit.json", _json([_plain(row) for row in results.audit]))
    write_text(out / "expectation.json", _json(expectation(results)))
    page = out / "paper.html"
    write_text(page, render_page(results, drawn))
    return page


def write_paper(out: Path) -> Path:
    """Recompute both papers and write everything to ``out``; return the page's path.

    Raises
    ------
    InputError
        If ``out`` is a file.
    """
    if out.exists() and not out.is_dir():
        raise InputError(f"--out {out} is a file; name a folder")
    out.mkdir(parents=True, exist_ok=True)
    console = Console(stderr=True)
    with console.status("recomputing both papers") if console.is_terminal else nullcontext():
        return write(collect(), out)


def _figure(value: Any) -> Any:
    """Six significant digits: enough to compare, and free of the last bits in which machines differ."""
    return float(f"{value:.6g}") if isinstance(value, float) else value


def _plain(row: Any) -> dict[str, Any]:
    found = {}
    for f in fields(row):
        value = getattr(row, f.name)
        found[f.name] = {k: _figure(v) for k, v in value.items()} if isinstance(value, dict) else _figure(value)
    return found


def _json(document: Any) -> str:
    return json.dumps(document, indent=1, ensure_ascii=False, sort_keys=False) + "\n"


def _csv(path: Path, rows: Sequence[Any], leave_out: Sequence[str] = (), extra: dict[str, Any] | None = None) -> None:
    stream = io.StringIO()
    records = []
    for row in rows:
        plain: dict[str, Any] = {}
        for name, value in _plain(row).items():
            if name in leave_out:
                continue
            if isinstance(value, dict):
                plain |= value
            else:
                plain[name] = value
        records.append(plain | {name: function(row) for name, function in (extra or {}).items()})
    writer = csv.DictWriter(stream, list(records[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(records)
    write_text(path, stream.getvalue())
