"""The command line: one thin file a command.

A command is a function of its file's name; `_COMMANDS` lists them in the order in which a person meets them. Its module
is imported when the command is asked for (`lazy`), and imports only the standard library, typer and
`clerestory.cli.common` at its head and everything heavy inside the function, so that help answers at once. Its
docstring is its help and ends with a line `Example: …`. What goes wrong leaves a command as an exception; `main` turns
it into one line.
"""

from __future__ import annotations

import os
import sys
from importlib import import_module
from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import UsageError, in_one_line, is_expected
from clerestory.cli.lazy import group_of

if TYPE_CHECKING:
    from collections.abc import Sequence

_COMMANDS = (
    "info",
    "check",
    "query",
    "convert",
    "plot",
    "trace",
    "weather",
    "sky",
    "render",
    "glare",
    "annual",
    "photo",
    "photo-compare",
    "compare",
    "roundrobin",
    "cache",
)
# Commands of a group, whose sentence is the docstring of its package.
_GROUPS: dict[str, tuple[str, ...]] = {
    "measure": (
        "plan",
        "camera",
        "import",
        "list",
        "show",
        "note",
        "remove",
        "plot",
        "check",
        "prepare",
        "fit",
        "formula",
        "hybrid",
        "calibrate",
        "export",
    ),
    "system": ("build", "rate", "curve", "family", "export"),
}

app = typer.Typer(
    name="clerestory",
    cls=group_of("clerestory.cli", _COMMANDS),
    add_completion=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help: its layout takes a third of the time that rich's does
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
)


def _print_version(*, wanted: bool) -> None:
    if wanted:
        from clerestory import __version__

        typer.echo(f"clerestory {__version__}")
        raise typer.Exit


@app.callback()
def clerestory(
    *,
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Print the version.", callback=lambda value: _print_version(wanted=value), is_eager=True
        ),
    ] = False,
) -> None:
    """Say how window systems scatter light, and compare what laboratories say about one."""
    del version  # its callback acts


for _group, _names in _GROUPS.items():
    _package = f"clerestory.cli.{_group}"
    _members = typer.Typer(cls=group_of(_package, _names), rich_markup_mode=None, no_args_is_help=True)
    app.add_typer(_members, name=_group, help=import_module(_package).__doc__)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Parameters
    ----------
    arguments
        Words after the program's name; those of the process by default.

    Returns
    -------
    Exit code: 0 done, 1 failed, 2 wrong usage, 130 interrupted.
    """
    words = list(sys.argv[1:] if arguments is None else arguments) or ["--help"]
    try:
        code = app(words, prog_name="clerestory", standalone_mode=False)
        sys.stdout.flush()
    except typer.TyperException as error:
        return _fail(error.format_message(), getattr(error, "exit_code", 1), getattr(error, "ctx", None))
    except BrokenPipeError:
        # The reader has left (`clerestory info x.xml | head -1`): nothing to say, also not when Python shuts down.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        code = 130
    except Exception as error:
        if not is_expected(error):
            raise
        return _fail(in_one_line(error), 2 if isinstance(error, UsageError) else 1)
    if code == 130:
        return _fail("interrupted", 130)
    return code if isinstance(code, int) else 0


def _fail(message: str, code: int, context: object = None) -> int:
    message = " ".join(message.split())
    command = getattr(context, "command_path", None)
    if command is not None:  # typer's sentence about wrong usage
        message = f"{message[:1].lower()}{message[1:].rstrip('.')} (see `{command} --help`)"
    if message:
        typer.echo(f"error: {message}", err=True)
    return code
