"""EnergyPlus' objects as its input files: IDF text, and epJSON."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from clerestory._core import __version__
from clerestory.system.energyplus.fields import FIELDS, VERSION, json_name

if TYPE_CHECKING:
    from collections.abc import Iterable

    from clerestory.system.energyplus.objects import Object

_WIDTH = 110


def idf(objects: Iterable[Object]) -> str:
    """Objects as IDF text, to be put into the input of a building."""
    parts = [f"! Written by Clerestory {__version__} for EnergyPlus {VERSION}\n"]
    for made in objects:
        words = FIELDS[made.kind]
        held = [word for word in words if word in made.fields]
        # Fields behind the last that is given can be left out; those before it are blank.
        shown = words[: words.index(held[-1]) + 1] if held else ()
        lines = [(made.name, "Name"), *((_text(made.fields.get(word, "")), word) for word in shown)]
        body = [f"  {value},".ljust(60) + f"  !- {word}" for value, word in lines]
        if made.values:
            body += _wrapped(made)
        else:
            value, word = lines[-1]
            body[-1] = f"  {value};".ljust(60) + f"  !- {word}"
        parts.append(f"{made.kind},\n" + "\n".join(body) + "\n")
    return "\n".join(parts)


def epjson(objects: Iterable[Object]) -> str:
    """Objects as epJSON, to be merged into the input of a building."""
    found: dict[str, dict[str, Any]] = {}
    for made in objects:
        fields: dict[str, Any] = {json_name(word): value for word, value in made.fields.items()}
        if made.values:
            fields["values"] = [{"value": value} for value in made.values]
        found.setdefault(made.kind, {})[made.name] = fields
    return json.dumps(found, indent=1, ensure_ascii=False) + "\n"


def _text(value: str | float) -> str:
    return value if isinstance(value, str) else f"{value:.10g}" if isinstance(value, float) else str(value)


def _wrapped(made: Object) -> list[str]:
    """Values of a matrix, each row on lines of its own."""
    columns = int(made.fields["Number of Columns"])
    lines: list[str] = []
    for first in range(0, len(made.values), columns):
        line = " "
        for value in made.values[first : first + columns]:
            word = f" {value:.8g},"
            if len(line) + len(word) > _WIDTH:
                lines.append(line)
                line = " "
            line += word
        lines.append(line)
    lines[-1] = f"{lines[-1][:-1]};"
    return lines
