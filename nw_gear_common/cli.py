"""The command line `nw_gear`: collects the commands of the packages and turns errors into exit codes.

Commands are found through the entry point group `nw_gear.commands` (name -> function, or a `typer.Typer` for a group of
commands), so that this shared package imports neither the simulator nor the monitor. Exit codes: 0 success, 2 wrong
arguments or input, 1 other foreseen failure, 130 and 143 after SIGINT and SIGTERM.
"""

from __future__ import annotations

import signal
import sys
from collections.abc import Sequence
from importlib.metadata import entry_points
from types import FrameType
from typing import Any, cast

import typer

import nw_gear_common
from nw_gear_common.errors import NwGearError

GROUP = "nw_gear.commands"

Refusal = cast(type[Any], typer.BadParameter.__mro__[2])
"""ClickException, the root of all refused arguments; recent typers bring a click of their own."""


class Interrupted(BaseException):
    """A signal asked the command to end; commands tidy up in `finally` and let it pass."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.code = 128 + number


def _interrupt(number: int, _frame: FrameType | None) -> None:
    raise Interrupted(number)


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"nw_gear {nw_gear_common.__version__}")
        raise typer.Exit


def _options(
    _version: bool = typer.Option(
        False, "--version", callback=_show_version, is_eager=True, help="Show the version and exit."
    ),
) -> None:
    """Virtual condition monitoring of a wind turbine's planetary gearbox."""


def build() -> typer.Typer:
    """Build the application from every installed command."""
    app = typer.Typer(no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)
    app.callback()(_options)
    for point in sorted(entry_points(group=GROUP), key=lambda p: p.name):
        command = point.load()
        if isinstance(command, typer.Typer):
            app.add_typer(command, name=point.name)
        else:
            app.command(point.name)(command)
    return app


def main(arguments: Sequence[str]) -> int:
    """Run one command and return the exit code."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _interrupt)
    try:
        result = typer.main.get_command(build()).main(list(arguments), prog_name="nw_gear", standalone_mode=False)
        return result if isinstance(result, int) else 0
    except typer.Exit as end:
        return end.exit_code
    except Refusal as error:
        print(f"nw_gear: {error.format_message()}", file=sys.stderr)
        return 2
    except NwGearError as error:
        print(f"nw_gear: {error}", file=sys.stderr)
        return error.exit_code
    except Interrupted as end:
        return end.code
    except typer.Abort:
        return 130
