"""How the command line speaks: results on stdout, messages on stderr, errors in one line, exit codes 0, 1, 2."""

from __future__ import annotations

import os
import sys
import traceback
import warnings
from typing import Any

import click

from ..datasets import DatasetUnavailableError
from ..datasets.column_roles import AssumptionWarning
from ..errors import InputError
from ..models import InverseError

__all__ = ["EXIT_BAD_INPUT", "EXIT_CHECK_FAILED", "EXIT_INTERNAL", "CommandGroup", "DebugCommand", "execute", "message"]

EXIT_CHECK_FAILED = 1
EXIT_BAD_INPUT = 2
EXIT_INTERNAL = 70
EXIT_INTERRUPTED = 130


class DebugCommand(click.Command):
    """A command that takes ``--debug`` like every other one."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.params.append(
            click.Option(["--debug"], is_flag=True, expose_value=False, is_eager=True, callback=_set_debug,
                         help="Show the traceback of an error.")
        )  # fmt: skip


class CommandGroup(click.Group):
    """A group whose commands keep their order of definition and all take ``--debug``."""

    command_class = DebugCommand
    group_class = type

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(self.commands)


def _set_debug(ctx: click.Context, parameter: click.Parameter, value: bool) -> None:
    if value:
        ctx.find_root().ensure_object(dict)["debug"] = True


def message(text: str) -> None:
    """One line for people, on stderr."""
    click.echo(f"hystbench: {text}", err=True)


def _show_warning(text: Warning | str, category: type[Warning], *args: Any, **more: Any) -> None:
    kind = "note" if issubclass(category, AssumptionWarning) else "warning"
    message(f"{kind}: {' '.join(str(text).split())}")


def execute(command: click.Command, arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit code."""
    warnings.showwarning = _show_warning  # type: ignore[assignment]  # its arguments differ in name only
    given = sys.argv[1:] if arguments is None else arguments
    try:
        result = command.main(given, prog_name="hystbench", standalone_mode=False)
        return result if isinstance(result, int) else 0
    except click.exceptions.Exit as error:
        return error.exit_code
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message(), err=True)
        return EXIT_BAD_INPUT
    except click.ClickException as error:
        path = error.ctx.command_path if isinstance(error, click.UsageError) and error.ctx else "hystbench"
        return _fail(f"{' '.join(error.format_message().split())} (see `{path} --help`)", given)
    except (InputError, DatasetUnavailableError, InverseError) as error:
        return _fail(str(error), given)
    except (KeyboardInterrupt, click.Abort):
        message("interrupted")
        return EXIT_INTERRUPTED
    except BrokenPipeError:
        # The reader of a pipe went away (`| head`): nobody is left to tell.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return _fail(f"{where}{error.strerror or error}; check the path, the permissions and the free space", given)
    except Exception as error:
        _fail(f"internal error, {type(error).__name__}: {error}; run again with --debug and report it", given)
        return EXIT_INTERNAL


def _fail(text: str, arguments: list[str]) -> int:
    if "--debug" in arguments:
        traceback.print_exc()
    message(f"error: {' '.join(text.split())}")
    return EXIT_BAD_INPUT
