"""Keys of recipes: what all their tables share, and errors that name the key in one line."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from typing import Self


class RecipeError(ClerestoryError):
    """A recipe that cannot be followed; the text names the key, what is wrong and the remedy."""


class Keys(BaseModel):
    """A table of a recipe. Unknown keys are refused with the nearest known one."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, strict=True, use_attribute_docstrings=True
    )

    @model_validator(mode="before")
    @classmethod
    def _known(cls, data: Any) -> Any:  # noqa: ANN401 (anything that TOML can hold)
        if isinstance(data, dict):
            for key in data:
                if key not in cls.model_fields:
                    raise wrong(str(key), f"there is no such key ({suggestion(str(key), cls.model_fields)})")
        return data

    @classmethod
    def of(cls, tables: Mapping[str, Any]) -> Self:
        """From its tables, as `tomllib` reads them.

        Raises
        ------
        RecipeError
            The first key that is wrong, as `room.width_m: what (what to do)`.
        """
        data = dict(tables)
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            raise RecipeError(one_line(error, data)) from None


def wrong(key: str, text: str) -> PydanticCustomError:
    """A fault of one key (or `key.of.a.table`) of the table that is being checked."""
    # Braces would be taken for places to fill in.
    return PydanticCustomError("wrong", "{text}", {"key": key, "text": text})


def suggestion(name: str, known: Iterable[str]) -> str:
    """Which known name a wrong one may stand for, as the remedy of an error."""
    names = list(known)
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    if near:
        return f"did you mean {near[0]}?"
    return f"give {names[0]}" if len(names) == 1 else f"known are {', '.join(names[:-1])} and {names[-1]}"


def _number(value: object) -> object:
    # TOML tells 80 and 80.0 apart; a person who writes a length does not.
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


Number = Annotated[float, BeforeValidator(_number)]
"""A number."""
Positive = Annotated[Number, Field(gt=0.0)]
"""A number above 0."""
NotNegative = Annotated[Number, Field(ge=0.0)]
"""A number of 0 or more."""
Fraction = Annotated[Number, Field(ge=0.0, le=1.0)]
"""A number from 0 to 1."""
Slope = Annotated[Number, Field(ge=-90.0, le=90.0)]
"""An angle from −90° to 90°."""


def one_line(error: ValidationError, data: object) -> str:
    """The first fault of a table as `key: what (what to do)`."""
    faults = error.errors(include_url=False)
    first = faults[0]
    place = _place(first["loc"], data)
    context = first.get("ctx") or {}
    if first["type"] == "wrong":
        key = f"{place}.{context['key']}".strip(".")
        return f"{key}: {context['text']}"
    kind, message, value = first["type"], first["msg"], first.get("input")
    if kind == "missing":
        return f"{place}: is missing (add it)"
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        known = [tag.strip("' ") for tag in str(context.get("expected_tags", "")).split(",")]
        known = known if known != [""] else _tags(context)
        if kind == "union_tag_not_found":
            return f"{place}.kind: is missing (say what it is; the guide lists the kinds)"
        return f"{place}.kind: {context['tag']!r} is not known ({suggestion(str(context['tag']), known)})"
    if kind == "literal_error":
        return f"{place}: {value!r} is not known (give {context['expected']})"
    message = message.removeprefix("Input should be ").removeprefix("Value error, ")
    wanted = f"give {_article(message)}" if first["msg"].startswith("Input should be") else message
    shown = repr(value) if not isinstance(value, (dict, list)) or len(repr(value)) < 40 else "this value"
    return f"{place}: {shown} does not fit ({wanted})"


def _tags(context: dict[str, Any]) -> list[str]:
    return [str(context.get("discriminator", ""))]


def _article(message: str) -> str:
    if message.startswith("valid "):
        return f"a {message}"
    if message.startswith(("greater", "less")):
        return f"a number {message}"
    return message


def _place(location: Sequence[int | str], data: object) -> str:
    """A place as it is written in TOML: without the kinds that pydantic puts between the keys."""
    words = ""
    here: Any = data
    for item in location:
        if isinstance(item, int):
            words += f"[{item + 1}]"
            here = here[item] if isinstance(here, (list, tuple)) and item < len(here) else None
            continue
        if isinstance(here, dict) and item not in here and here.get("kind") == item:
            continue
        words += f".{item}" if words else item
        here = here.get(item) if isinstance(here, dict) else None
    return words
