"""Options that several commands have."""

from __future__ import annotations

from typing import Any

import click

from ..errors import InputError

__all__ = ["column_options", "names"]


def names(ctx: click.Context, parameter: click.Parameter, value: str | None) -> list[str] | None:
    """The callback of an option whose value is ids separated by commas; raises InputError where it holds none."""
    if value is None:
        return None
    found = [name.strip() for name in value.split(",") if name.strip()]
    if not found:
        raise InputError(f"--{parameter.name} is empty; give ids separated by commas, see `hystbench list`")
    return found


def column_options(*roles: str) -> Any:
    """Options by which a user names a file's columns: its time, x and y as far as ``roles`` says."""
    texts = {
        "time": "Time column (default time_s, else found by name and unit; if there is none, samples are numbered).",
        "x": "Input column (default deflection_rad, else found by name and unit).",
        "y": "Output column (default torque_nm, else found by name and unit).",
    }

    def decorate(function: Any) -> Any:
        for role in reversed(roles):
            function = click.option(f"--{role}", metavar="COL", help=texts[role])(function)
        return function

    return decorate
