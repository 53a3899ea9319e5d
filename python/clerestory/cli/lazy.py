"""Groups of commands whose modules are imported when one of them is asked for."""

from __future__ import annotations

from importlib import import_module
from inspect import cleandoc
from keyword import iskeyword
from pathlib import Path
from typing import TYPE_CHECKING, Any

from typer.core import TyperCommand, TyperGroup
from typer.main import get_command_from_info
from typer.models import CommandInfo

if TYPE_CHECKING:
    from collections.abc import Sequence

_ROOT = Path(__file__).parents[2]
"""Folder of the package clerestory."""


def group_of(package: str, names: Sequence[str]) -> type[TyperGroup]:
    """A kind of group that has the commands of a package, each a function of its file's name.

    The file of a command that is named by a word of Python's ends with an underscore. To list commands their files are
    read for the sentences at their functions' heads, but not run.
    """

    class Commands(TyperGroup):
        def __init__(self, **attributes: Any) -> None:  # noqa: ANN401 (typer's)
            super().__init__(**attributes)
            listed = {name: TyperCommand(name, help=_about(_docstring(package, name))[0]) for name in names}
            self.commands = {**listed, **self.commands}

        def resolve_command(self, ctx: Any, args: list[str]) -> Any:  # noqa: ANN401 (typer's)
            name, command, rest = super().resolve_command(ctx, args)
            return name, loaded(package, name) if name is not None and name in names else command, rest

    return Commands


def loaded(package: str, name: str) -> TyperCommand:
    """A command with its options; the example at the end of its docstring is kept on a line of its own."""
    home = _home(name)
    function = getattr(import_module(f"{package}.{home}"), home)
    text, example = _about(function.__doc__)
    info = CommandInfo(name=name, callback=function, help=text, epilog=f"\b\nExample: {example}")
    made = get_command_from_info(info, pretty_exceptions_short=False, rich_markup_mode=None)
    assert isinstance(made, TyperCommand)
    return made


def _home(name: str) -> str:
    return name.replace("-", "_") + ("_" if iskeyword(name) else "")


def _docstring(package: str, name: str) -> str:
    """Of a command's function, from the text of its file."""
    home = _home(name)
    text = _ROOT.joinpath(*package.split("."), f"{home}.py").read_text(encoding="utf-8")
    return text.partition(f"\ndef {home}(")[2].split('"""', 2)[1]


def _about(docstring: str) -> tuple[str, str]:
    """Help and example."""
    text, _, example = cleandoc(docstring).partition("\n\nExample: ")
    return text, example
