"""The keys of recipes as tables in Markdown.

`python -m clerestory.trace.reference docs/recipes.md` renews them in the guide, from its heading on bands to its end.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from clerestory.trace.bands import Bands
from clerestory.trace.kinds import AnySample
from clerestory.trace.materials import Material
from clerestory.trace.media import Medium

if TYPE_CHECKING:
    from clerestory.trace.keys import Keys

HEAD = "## Bands: `[bands]`"
SHARED = ("name", "z_mm")
"""Keys of all kinds of samples."""


def tables() -> str:
    """All kinds of samples, materials and media with their keys."""
    samples = get_args(get_args(AnySample)[0])
    materials = get_args(get_args(Material)[0])
    parts = [HEAD, _table(Bands), "## Samples: `[sample]`", "Every kind has these keys:"]
    parts.append(_table(samples[0], only=("kind", *SHARED)))
    for model in samples:
        parts += [f"### `{_kind(model)}`", _first(model), _table(model, skip=("kind", *SHARED))]
        parts += _below(model)
    parts.append("## Materials: `[materials.NAME]`")
    for model in materials:
        parts += [f"### `{_kind(model)}`", _first(model)]
        if set(model.model_fields) > {"kind"}:
            parts.append(_table(model, skip=("kind",)))
    parts += ["## Media: `[media.NAME]`", _first(Medium), _table(Medium)]
    return "\n\n".join(parts) + "\n"


def _kind(model: type[Keys]) -> str:
    return str(get_args(model.model_fields["kind"].annotation)[0])


def _first(model: type[Keys]) -> str:
    return " ".join((model.__doc__ or "").split("\n\n")[0].split())


def _table(model: type[Keys], *, only: tuple[str, ...] = (), skip: tuple[str, ...] = ()) -> str:
    schema = model.model_json_schema()
    rows = ["| key | value | default | |", "| --- | --- | --- | --- |"]
    for name, field in schema["properties"].items():
        if name in skip or (only and name not in only):
            continue
        if name == "kind":
            rows.append("| `kind` | text | | What it is: one of the headings below. |")
            continue
        default = "" if name in schema.get("required", ()) else _literal(field.get("default"))
        about = " ".join(field.get("description", "").split())
        rows.append(f"| `{name}` | {_words(field)}{_limits(model, name)} | {default} | {about} |")
    return "\n".join(rows)


def _literal(value: object) -> str:
    return "–" if value is None else f"`{json.dumps(value, ensure_ascii=False)}`"


def _below(model: type[Keys]) -> list[str]:
    """Tables of the tables within a kind."""
    schema = model.model_json_schema()
    found = []
    for name, field in schema["properties"].items():
        item = field.get("items", field)
        target = item.get("$ref") or next((a.get("$ref") for a in item.get("allOf", ())), None)
        if target is None:
            continue
        inner = next(m for m in _inner_models(model, name) if m.__name__ == target.rsplit("/", 1)[1])
        twin = next((n for n, f in schema["properties"].items() if f.get("$ref") == target), name)
        if "items" not in field and twin != name:
            continue
        names = [n for n, f in schema["properties"].items() if f.get("items", f).get("$ref") == target]
        heads = " and ".join(
            f"`[[sample.{n}]]`" if "items" in schema["properties"][n] else f"`[sample.{n}]`" for n in names
        )
        found += [f"{heads}: {_first(inner)[:1].lower()}{_first(inner)[1:]}", _table(inner)]
    return found


def _inner_models(model: type[Keys], name: str) -> list[Any]:
    annotation = model.model_fields[name].annotation
    return [annotation, *get_args(annotation)]


def _words(field: dict[str, Any]) -> str:
    """The values that a key can have, from its schema."""
    if "anyOf" in field:
        options = [f for f in field["anyOf"] if f.get("type") != "null"]
        kinds = [f.get("type") for f in options]
        if kinds == ["number", "object"]:
            return "number, or table by band"
        return " or ".join(_words({**f, "description": ""}) for f in options)
    if "enum" in field:
        return ", ".join(f"`{v}`" for v in field["enum"])
    if "const" in field:
        return f"`{field['const']}`"
    if "$ref" in field or "allOf" in field:
        return "table"
    kind = field.get("type")
    if kind == "array":
        return f"list of {_plural(_words(field['items']))}" if "items" in field else "list"
    if kind == "object":
        return "table"
    return {"string": "text", "number": "number", "boolean": "true or false", "integer": "whole number"}.get(
        str(kind), str(kind)
    )


def _plural(words: str) -> str:
    for one, many in (("number", "numbers"), ("table", "tables"), ("text", "texts"), ("list", "lists")):
        if words.startswith(one):
            return many + words[len(one) :]
    return words


def _limits(model: type[Keys], name: str) -> str:
    """The limits of a number, in words."""
    info = model.model_fields[name]
    marks = {}
    for mark in (*info.metadata, *_marks(info.annotation)):
        for word in ("gt", "ge", "lt", "le"):
            if getattr(mark, word, None) is not None:
                marks[word] = f"{getattr(mark, word):g}".replace("-", "−")
    if "ge" in marks and "le" in marks:
        return f", {marks['ge']} to {marks['le']}"
    words = {"gt": "above", "ge": "at least", "lt": "below", "le": "at most"}
    return "".join(f", {words[w]} {marks[w]}" for w in words if w in marks)


def _marks(annotation: object) -> list[object]:
    """What is annotated on the members of a union."""
    return [
        inner
        for member in get_args(annotation)
        for mark in getattr(member, "__metadata__", ())
        for inner in (mark, *getattr(mark, "metadata", ()))
    ]


def renew(path: Path) -> None:
    """Write the tables into the guide."""
    text = path.read_text(encoding="utf-8")
    path.write_text(text[: text.index(HEAD)] + tables(), encoding="utf-8")


if __name__ == "__main__":
    renew(Path(sys.argv[1]))
