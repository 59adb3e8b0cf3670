"""The ``hystbench`` command."""

from __future__ import annotations

import json
import re
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import click

from .. import __version__
from ..errors import InputError
from . import threads  # noqa: F401 (before anything that imports NumPy)
from .console import EXIT_CHECK_FAILED, CommandGroup, execute, message
from .data_commands import data
from .diagnosis_commands import blind, diagnose
from .model_commands import fit, invert, predict
from .options import column_options, names

__all__ = ["cli", "main"]


def _part(ctx: click.Context, parameter: click.Parameter, value: str | None) -> tuple[int, int] | None:
    if value is None:
        return None
    found = re.fullmatch(r"([1-9]\d{0,5})/([1-9]\d{0,5})", value)
    if found is None or int(found[1]) > int(found[2]):
        raise InputError(f"--array must be I/N with 1 <= I <= N, such as 3/20; it is {value!r}")
    return int(found[1]), int(found[2])


def _with_columns(datasets: list[str] | None, **columns: str | None) -> list[str] | None:
    """Give the files among ``datasets`` the columns that the options name."""
    from ..datasets.user_recording import is_file, with_columns

    named = [f"--{role}" for role, column in columns.items() if column is not None]
    if not named:
        return datasets
    if not any(is_file(name) for name in datasets or []):
        raise InputError(f"{named[0]} names a column of a file, but --datasets names no file")
    return [with_columns(name, **columns) if is_file(name) else name for name in datasets or []]


@click.group(cls=CommandGroup, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(__version__, prog_name="hystbench")
def cli() -> None:
    """Benchmark, identify and compensate hysteresis.

    \b
    Examples:
      hystbench run --quick --out report      all models on all loops, then open report/report.html
      hystbench fit loop.csv --model bouc-wen --out model.json
      hystbench predict model.json motion.csv --out torque.csv
    """


@cli.command()
@click.option(
    "--models",
    metavar="A,B",
    callback=names,
    help="Model ids; `all`: every registered one (default: all but the extended ones).",
)
@click.option(
    "--datasets",
    metavar="A,B",
    callback=names,
    help="Dataset ids, or paths of recordings (default: all datasets that are on this machine).",
)
@click.option("--out", type=click.Path(path_type=Path), default=Path("hystbench-report"), show_default=True,
              help="Folder for results.parquet, run.json and report.html.")  # fmt: skip
@click.option("--jobs", type=click.IntRange(1, 1024), help="Processes (default: one a core).")
@click.option("--quick", is_flag=True, help="One seed and fewer conditions, for a first look.")
@click.option("--diagnose/--no-diagnose", default=None,
              help="What each model lacks on each recorded dataset (default: what the best one lacks; --quick: none).")  # fmt: skip
@click.option("--resume/--fresh", default=True, help="Keep cells that --out holds already (default), or compute all.")
@click.option("--backend", type=click.Choice(["loky", "dask"]), default="loky", show_default=True,
              help="loky: processes on this machine; dask: the workers of a dask.distributed scheduler.")  # fmt: skip
@click.option("--scheduler", metavar="ADDR", help="Address of the dask scheduler, such as tcp://host:8786.")
@click.option(
    "--array", metavar="I/N", callback=_part, help="Only the I-th of N parts, for a batch cluster's array jobs."
)
@column_options("x", "y", "time")
def run(
    models: list[str] | None,
    datasets: list[str] | None,
    out: Path,
    jobs: int | None,
    quick: bool,
    diagnose: bool | None,
    resume: bool,
    backend: str,
    scheduler: str | None,
    array: tuple[int, int] | None,
    x: str | None,
    y: str | None,
    time: str | None,
) -> None:
    """Run models on datasets and write the HTML report.

    A recording in a file is a dataset too: its last third is held out. --x, --y and --time name the columns of all files;
    loop.csv?x=angle&y=torque those of one.

    \b
    Examples:
      hystbench run --models maxwell-slip,cubic --datasets vsa-published --out report
      hystbench run --datasets loop.csv --x angle --y torque --time t --out report
      hystbench run --backend dask --scheduler tcp://head:8786
      hystbench run --array 3/20 --out part-3          then: hystbench report part-* --out report
    """
    import os

    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from ..reports import render
    from .run import part_of, plan_run
    from .run import run as compute

    if (backend == "dask") != (scheduler is not None):
        raise InputError("--backend dask and --scheduler ADDR go together; start one with `dask scheduler`")
    if backend == "dask" and jobs is not None:
        raise InputError("--jobs is for this machine; with --backend dask the workers' threads are the processes")
    if out.exists() and not out.is_dir():
        raise InputError(f"--out {out} is a file; name a folder")
    plan = plan_run(models, _with_columns(datasets, x=x, y=y, time=time), quick, diagnose)
    if plan.absent:
        message(
            f"recorded data not on this machine, left out: {', '.join(plan.absent)}; `hystbench data fetch` gets them"
        )
    if array is not None:
        plan = part_of(plan, *array)
    out.mkdir(parents=True, exist_ok=True)
    counts: dict[str, Counter[str]] = {"cells": Counter(), "diagnoses": Counter()}
    console = Console(stderr=True)
    with Progress(
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(),
        console=console, transient=True, disable=not console.is_terminal,
    ) as progress:  # fmt: skip
        task = progress.add_task("cells", total=plan.errands)

        def advance(cell: dict[str, Any]) -> None:
            counts["diagnoses" if "diagnosis" in cell else "cells"].update(row["status"] for row in cell["rows"])
            progress.update(task, advance=1, description=f"{cell['model']} on {cell['dataset']}")

        command = ["hystbench", *sys.argv[1:]]
        compute(plan, out, jobs or os.cpu_count() or 1, not resume, command, advance, scheduler)
        progress.update(task, description="report")
        page = render(out) if plan.cells else out / "results.parquet"
    for kind, number in (("cells", len(plan.cells)), ("diagnoses", counts["diagnoses"].total())):
        if number or kind == "cells":
            told = ", ".join(f"{count} {status}" for status, count in sorted(counts[kind].items()))
            message(f"{number} {kind}: {told}")
    click.echo(str(page))


@cli.command()
@click.argument("folders", metavar="DIR...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Folder for the merged run and its report.")
@click.option("--export", "as_files", is_flag=True,
              help="Also write DIR/figures (SVG, PDF, PNG) and DIR/tables (CSV, LaTeX booktabs).")  # fmt: skip
def report(folders: tuple[Path, ...], out: Path | None, as_files: bool) -> None:
    """Render DIR/report.html again from the results in DIR, or merge several runs into one and report that.

    \b
    Examples:
      hystbench report hystbench-report --export
      hystbench report part-1 part-2 part-3 --out report
    """
    from ..reports import export, render
    from .merge import merge

    if out is None and len(folders) > 1:
        raise InputError("several folders are merged into a new one; name it with --out DIR")
    folder = folders[0] if out is None else merge(folders, out)
    page = render(folder)
    if as_files:
        message(f"{len(export(folder))} files in {folder / 'figures'} and {folder / 'tables'}")
    click.echo(str(page))


@cli.command()
@click.argument("base", type=click.Path(path_type=Path))
@click.argument("new", type=click.Path(path_type=Path))
@click.option("--tolerance", default="5%", show_default=True, help="Allowed growth of a cell's NRMSE.")
@click.option("--time-tolerance", default="50%", show_default=True, help="Allowed growth of a model's times.")
@click.option("--format", "form", type=click.Choice(["text", "markdown", "json"]), default="text", show_default=True,
              help="markdown is for $GITHUB_STEP_SUMMARY.")  # fmt: skip
def compare(base: Path, new: Path, tolerance: str, time_tolerance: str, form: str) -> int:
    """Compare two runs cell by cell: exit 1 if NEW is worse than BASE anywhere, 2 if nothing could be compared.

    A cell is worse if its NRMSE grew by more than the tolerance and a paired test over its seeds agrees, if it failed or
    is missing; a model, if all its cells together grew by more than half the tolerance. Times are compared if both runs
    were made on one machine, one boot and one day.

    \b
    Example:
      hystbench compare main-report branch-report --tolerance 3%
    """
    from .compare import changed_data, parse_tolerance, why_not_timed
    from .compare import compare as compare_tables
    from .comparison_output import write
    from .results import read_document, read_results

    limit, time_limit = parse_tolerance(tolerance), parse_tolerance(time_tolerance, "--time-tolerance")
    tables = read_results(base), read_results(new)
    documents = read_document(base), read_document(new)
    untimed = why_not_timed(*documents)
    comparison = compare_tables(
        *tables, limit, time_tolerance=None if untimed else time_limit, changed=changed_data(*documents)
    )
    if not comparison.compared and not comparison.worse:
        raise InputError(f"no cell of {base} has a result in {new}: nothing was compared")
    click.echo(write(comparison, form, untimed))
    return EXIT_CHECK_FAILED if comparison.worse else 0


@cli.command()
@click.argument("folders", metavar="DIR...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), default=Path("hystbench-history"), show_default=True,
              help="Folder for history.html, history.csv and changes.json.")  # fmt: skip
def history(folders: tuple[Path, ...], out: Path) -> None:
    """Plot the errors and times of many runs by model, oldest first, and mark where they changed.

    \b
    Example:
      hystbench history runs/* --out history
    """
    from ..reports.history import write_history

    click.echo(str(write_history(folders, out)))


@cli.command(name="list")
@click.argument("what", type=click.Choice(["models", "datasets", "effects"]))
@click.option("--json", "as_json", is_flag=True, help="Machine-readable.")
def list_(what: str, as_json: bool) -> None:
    """List what is registered, one line each.

    \b
    Example:
      hystbench list models
    """
    from .. import datasets, diagnosis, models

    registry = {"models": models.registry, "datasets": datasets.registry, "effects": diagnosis.registry}[what]
    entries = []
    for name in registry.ids():
        plugin: Any = registry.get(name)
        entry = {"id": name, "title": getattr(plugin, "title", name), "summary": getattr(plugin, "summary", "")}
        for key in ("kind", "licence", "source"):
            if hasattr(plugin, key):
                entry[key] = getattr(plugin, key)
        entries.append(entry)
    if as_json:
        click.echo(json.dumps(entries, indent=1))
        return
    width = max((len(entry["id"]) for entry in entries), default=0)
    for entry in entries:
        click.echo(f"{entry['id']:<{width}}  {entry['summary'] or entry['title']}")
    if not entries:
        message(f"no {what} are registered")


@cli.command()
@click.option("--out", type=click.Path(path_type=Path), default=Path("hystbench-paper"), show_default=True,
              help="Folder for paper.html, the figures and the data.")  # fmt: skip
def paper(out: Path) -> None:
    """Rebuild the tables and figures of the two source papers and audit them.

    \b
    Example:
      hystbench paper --out paper      then open paper/paper.html
    """
    from ..reports.paper import write_paper

    click.echo(str(write_paper(out)))


for command in (fit, predict, invert, diagnose, blind, data):
    cli.add_command(command)


def main() -> None:
    """Entry point of the ``hystbench`` command."""
    sys.exit(execute(cli))
