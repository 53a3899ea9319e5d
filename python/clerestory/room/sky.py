"""The sky over a room, from the keys of its recipe."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from clerestory import _core
from clerestory.room.recipe import LEVELS, Recipe
from clerestory.trace.keys import RecipeError

if TYPE_CHECKING:
    from clerestory.sky import Sky


def sky_of(recipe: Recipe) -> Sky:
    """The sky that a recipe describes.

    Raises
    ------
    RecipeError
        Its light does not go with its kind, or cannot be; the text names the key.
    """
    from clerestory.sky import Place, Sky, SunPosition

    given = recipe.sky
    options: dict[str, Any] = {name: getattr(given, name) for name in LEVELS if getattr(given, name) is not None}
    options |= {
        "preset": given.preset,
        "ground_reflectance": given.ground_reflectance,
        "north_deg": given.north_deg,
    }
    # The traditional skies take what the general ones do.
    make = getattr(Sky, given.kind)
    known = inspect.signature(make if given.kind in ("perez", "preetham") else Sky.cie).parameters
    for name in LEVELS:
        if name in options and name not in known:
            raise RecipeError(
                f"sky.{name}: a sky of kind {given.kind} takes none "
                f"(give one of {', '.join(level for level in LEVELS if level in known)})"
            )
    sun: Any = None
    try:
        if given.time is not None and recipe.place is not None:
            place = Place(recipe.place.latitude, recipe.place.longitude, recipe.place.timezone)
            sun = SunPosition.at(place, given.time, method="radiance" if given.preset == "radiance" else "spa")
        elif given.sun_deg is not None:
            sun = (given.sun_deg[0], given.sun_deg[1])
        if given.kind == "cie":
            return Sky.cie(given.type or 0, sun, **options)
        made: Sky = make(**options) if sun is None else make(sun, **options)
    except _core.ClerestoryError as error:
        raise RecipeError(f"sky: {error}") from error
    return made
