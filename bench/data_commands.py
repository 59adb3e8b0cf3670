"""The commands of ``hystbench data``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import click

from ..errors import InputError
from .console import EXIT_CHECK_FAILED, CommandGroup, message

__all__ = ["data"]


@click.group(cls=CommandGroup)
def data() -> None:
    """Recorded datasets, and a look at recordings of your own.

    \b
    Example:
      hystbench data fetch mr-damper
    """


@data.command(name="list")
@click.option("--json", "as_json", is_flag=True, help="Machine-readable.")
@click.option("--datapackage", "as_package", is_flag=True, help="The catalogue as a Frictionless data package.")
def list_(as_json: bool, as_package: bool) -> None:
    """List the recorded datasets, their licences, sizes and whether they are on this machine.

    \b
    Examples:
      hystbench data list
      hystbench data list --datapackage > datapackage.json
    """
    if as_package:
        from ..datasets.datapackage import catalogue_package

        click.echo(json.dumps(catalogue_package(), indent=1, ensure_ascii=False))
        return
    from ..datasets.catalogue import catalogue
    from ..datasets.store import data_folder, state

    rows: list[dict[str, Any]] = []
    for found in catalogue().values():
        present = sum(state(file) == "present" for file in found.files)
        rows.append(
            {
                "id": found.id,
                "title": found.title,
                "licence": found.licence,
                "bytes": found.bytes,
                "files": len(found.files),
                "present": present,
                "citation": found.citation,
            }
        )
    if as_json:
        click.echo(json.dumps({"folder": str(data_folder()), "datasets": rows}, indent=1, ensure_ascii=False))
        return
    for row in rows:
        there = "present" if row["present"] == row["files"] else f"{row['present']}/{row['files']} files"
        click.echo(f"{row['id']:<26}{row['bytes'] / 1e6:>5.1f} MB  {row['licence']:<14}{there:<12}{row['title']}")
    message(f"data folder: {data_folder()}")


@data.command()
@click.argument("ids", nargs=-1, metavar="[ID]...")
@click.option("--accept-licence", is_flag=True, help="Accept share-alike licences (CC BY-SA).")
def fetch(ids: tuple[str, ...], accept_licence: bool) -> None:
    """Download recorded datasets from their pinned commits; what is there already is kept.

    Without an ID all that need no acceptance of their licence are fetched.

    \b
    Examples:
      hystbench data fetch mr-damper pneumatic-seal
      hystbench data fetch friction-backlash-damper --accept-licence
    """
    from rich.console import Console
    from rich.progress import BarColumn, DownloadColumn, Progress, TextColumn

    from ..datasets.catalogue import CatalogueFile, catalogue, entry
    from ..datasets.store import data_folder
    from ..datasets.store import fetch as fetch_files

    wanted = [entry(name) for name in ids] if ids else list(catalogue().values())
    if not ids and not accept_licence:
        for left in [found for found in wanted if found.share_alike]:
            message(f"{left.id} left out: {left.licence} must be accepted with --accept-licence")
        wanted = [found for found in wanted if not found.share_alike]
    console = Console(stderr=True)
    with Progress(
        TextColumn("{task.description}"), BarColumn(), DownloadColumn(),
        console=console, transient=True, disable=not console.is_terminal,
    ) as progress:  # fmt: skip
        for found in wanted:
            task = progress.add_task(found.id, total=found.bytes)

            def advance(file: CatalogueFile, task: Any = task) -> None:
                progress.update(task, advance=file.bytes)

            new = fetch_files(found, accept_licence=accept_licence, advance=advance)
            click.echo(f"{found.id}: {new} files fetched, {len(found.files) - new} were there; cite: {found.citation}")
    message(f"data folder: {data_folder()}")


@data.command()
@click.argument("ids", nargs=-1, metavar="[ID]...")
def verify(ids: tuple[str, ...]) -> int:
    """Check recorded files against their published SHA-256; exit 1 if one is damaged, or absent from a named dataset.

    \b
    Example:
      hystbench data verify
    """
    from ..datasets.catalogue import catalogue, entry
    from ..datasets.store import data_folder, state

    bad = 0
    for found in [entry(name) for name in ids] if ids else catalogue().values():
        states = [state(file) for file in found.files]
        for file, what in zip(found.files, states, strict=True):
            if what == "damaged" or (what == "absent" and (ids or "present" in states)):
                click.echo(f"{what:<8} {data_folder() / file.place}")
                bad += what == "damaged" or bool(ids)
        counts = ", ".join(
            f"{states.count(what)} {what}" for what in ("present", "absent", "damaged") if what in states
        )
        click.echo(f"{found.id}: {counts}")
    return EXIT_CHECK_FAILED if bad else 0


@data.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--x", metavar="COL", help="Input column (default deflection_rad, else found by name).")
@click.option("--y", metavar="COL", help="Output column (default torque_nm, else found by name).")
@click.option("--time", metavar="COL", help="Time column (default time_s, else found by name).")
@click.option("--out", type=click.Path(path_type=Path), help="Folder for check.html, the findings with pictures.")
@click.option("--json", "as_json", is_flag=True, help="Machine-readable.")
def check(file: Path, x: str | None, y: str | None, time: str | None, out: Path | None, as_json: bool) -> None:
    """Tell what is in a recording before anything is fitted to it, and which models it suits.

    Lines marked ! will show in a model's errors; ? is what the recording cannot tell.

    \b
    Example:
      hystbench data check loop.csv --x angle --y torque --out check
    """
    import numpy as np

    from ..datasets import Recording
    from ..datasets.findings import applicable_models, findings
    from ..datasets.inspection import inspect_recording
    from ..datasets.recording_files import read_columns

    if out is not None and out.exists() and not out.is_dir():
        raise InputError(f"--out {out} is a file; name a folder")
    columns = read_columns(file, {"x": x, "y": y}, time)
    names = (columns.names["x"], columns.names["y"])
    for axis, name in zip("xy", names, strict=True):
        if np.ptp(columns[axis]) == 0.0:
            raise InputError(f"{file}: column {name!r} is constant: there is no loop in it; record a motion")
    recording = Recording(file.name, columns.time, columns["x"], columns["y"])
    found = inspect_recording(recording)
    told, judged = (
        findings(found, *names, notes=columns.notes, untimed=columns.untimed),
        applicable_models(found),
    )
    if as_json:
        document = {
            "schema": "hystbench/check/1",
            "file": str(file),
            "columns": {"time": columns.names["time"], "x": names[0], "y": names[1]},
            "findings": [vars(one) for one in told],
            "models": [vars(one) for one in judged],
            "measured": found.document(),
        }
        click.echo(json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False))
    else:
        marks = {"good": " ", "note": " ", "warn": "!", "unknown": "?"}
        for finding in told:
            click.echo(f"{marks[finding.judged]} {finding.subject:<16} {finding.text}")
        click.echo("")
        for model in judged:
            click.echo(f"  {model.model:<28} {model.judged:<7} {model.why}")
    if out is not None:
        from ..reports.check_page import write_check_page

        message(str(write_check_page(out, recording, found, told, judged, names)))


@data.command()
@click.argument("name", metavar="ID")
@click.option("--out", required=True, type=click.Path(), help="Folder to write.")
def export(name: str, out: str) -> None:
    """Write a dataset, recorded or synthetic, as CSV files with a Frictionless datapackage.json.

    \b
    Example:
      hystbench data export vsa-physical --out vsa-physical
    """
    from ..datasets import DatasetUnavailableError, get
    from ..datasets.datapackage import write_datapackage

    try:
        dataset = get(name)().load()
    except DatasetUnavailableError as error:
        raise InputError(str(error)) from None
    click.echo(str(write_datapackage(dataset, out)))
    sys.stdout.flush()
