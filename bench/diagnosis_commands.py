"""The commands of the diagnosis: ``diagnose`` and ``blind``."""

from __future__ import annotations

from pathlib import Path

import click

from .console import DebugCommand
from .options import column_options, names

__all__ = ["blind", "diagnose"]


@click.command(cls=DebugCommand)
@click.argument("real", metavar="REAL.csv...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--sim", required=True, multiple=True, type=click.Path(path_type=Path), metavar="SIM.csv|MODEL.json",
              help="What the simulator says at the recording's times, one for each recording; or a saved model.")  # fmt: skip
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder for the page, the corrected simulator and next.csv."
)
@click.option(
    "--json",
    "json_file",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Write the diagnosis as JSON (- for stdout).",
)
@click.option(
    "--exclude", metavar="EFFECT,…", callback=names, help="Effects not to consider, see `hystbench list effects`."
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the bootstrap intervals.")
@column_options("x", "y", "time")
def diagnose(
    real: tuple[Path, ...], sim: tuple[Path, ...], out: Path | None, json_file: Path | None, exclude: list[str] | None,
    seed: int, x: str | None, y: str | None, time: str | None,
) -> None:  # fmt: skip
    """Tell where a simulator and a recording disagree, which effect causes it, and how far the gap shrinks.

    \b
    Example:
      hystbench diagnose real.csv --sim sim.csv --out diagnosis --json diagnosis.json
    """
    from ..diagnosis.delivery import deliver

    for line in deliver(real, sim, out, json_file, exclude or [], seed, {"x": x, "y": y, "time": time}):
        click.echo(line)


@click.command(cls=DebugCommand)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("hystbench-blind"),
    show_default=True,
    help="Folder for the results and the page.",
)
@click.option("--seeds", type=click.IntRange(1, 1000), default=1, show_default=True, help="Recordings of each case.")
@click.option("--jobs", type=click.IntRange(1, 1024), help="Processes (default: one a core).")
@click.option("--quick", is_flag=True, help="A part of the bank, for a first look.")
def blind(out: Path, seeds: int, jobs: int | None, quick: bool) -> None:
    """Check the diagnosis on recordings whose cause is sealed, and write the figures and a page.

    The recordings are made by an analytic plant and, where the package mujoco is installed (the extra "blind"), by a
    plant that MuJoCo simulates. Takes 12 to 14 minutes on two cores, with --quick less than two.

    \b
    Example:
      hystbench blind --out blind --seeds 2
    """
    from ..diagnosis.blind.check import check

    for line in check(out, seeds, jobs, quick):
        click.echo(line)
