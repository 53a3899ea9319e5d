"""Where in the tables of a product a parameter stands."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, get_args

from clerestory.trace.keys import RecipeError
from clerestory.trace.kinds import AnySample

if TYPE_CHECKING:
    from collections.abc import Iterator

    from clerestory.trace.kinds.common import Kind

Place = tuple[str | int, ...]
"""Keys of tables and numbers of lists, from the outermost."""

_KINDS: dict[str, type[Kind]] = {
    get_args(model.model_fields["kind"].annotation)[0]: model for model in get_args(get_args(AnySample)[0])
}


def find(tables: dict[str, Any], parameter: str) -> Place:
    """The place of a parameter.

    Parameters
    ----------
    tables
        Of the product.
    parameter
        A key's name, or a place such as `layers[1].recipe.sample.tilt_deg`, of which the end will do.

    Raises
    ------
    RecipeError
        It is nowhere, or in several places; the text lists them.
    """
    *_, key = parameter.split(".")
    found = [place for place in _places(tables, key) if _matches(words(place), parameter)]
    if not found:
        known = sorted({str(place[-1]) for place in _places(tables, None)})
        raise RecipeError(
            f"family.parameter: the product has no {parameter} with a number (it has {', '.join(known) or 'none'})"
        )
    if len(found) > 1:
        places = ", ".join(words(place) for place in found)
        raise RecipeError(f"family.parameter: {parameter} stands in several places (give one of {places})")
    return found[0]


def get(tables: dict[str, Any], place: Place) -> Any:  # noqa: ANN401 (what TOML can hold)
    """What stands at a place."""
    here: Any = tables
    for step in place:
        here = here[step]
    return here


def put(tables: dict[str, Any], place: Place, value: float) -> dict[str, Any]:
    """The tables with another value at a place; what is not changed is shared."""
    made: dict[str, Any] = _put(tables, place, value)
    return made


def _put(held: Any, place: Place, value: float) -> Any:  # noqa: ANN401
    if not place:
        return value
    step, *rest = place
    if isinstance(step, int):
        return [_put(member, tuple(rest), value) if k == step else member for k, member in enumerate(held)]
    return {**held, step: _put(held.get(step), tuple(rest), value)}


def words(place: Place) -> str:
    """A place as it is written in TOML, lists counted from 1."""
    text = ""
    for step in place:
        text += f"[{step + 1}]" if isinstance(step, int) else f".{step}"
    return text.removeprefix(".")


def _matches(place: str, parameter: str) -> bool:
    return (
        place == parameter or place.endswith(f".{parameter}") or re.sub(r"\.recipe\.sample\b", "", place) == parameter
    )


def _places(held: Any, key: str | None, at: Place = ()) -> Iterator[Place]:  # noqa: ANN401
    """All places with a number under a key; all numbers without one."""
    if isinstance(held, list):
        for k, member in enumerate(held):
            yield from _places(member, key, (*at, k))
    if not isinstance(held, dict):
        return
    for name, member in held.items():
        if isinstance(member, (int, float)) and not isinstance(member, bool) and key in (name, None):
            yield (*at, name)
        yield from _places(member, key, (*at, name))
    # Keys that samples have without naming them, such as a tilt of 0.
    kind = _KINDS.get(str(held.get("kind")))
    if kind is not None and key in kind.model_fields and key not in held and kind.model_fields[key].default is not None:
        yield (*at, key)
