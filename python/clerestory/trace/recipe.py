"""Recipes: TOML files that describe a sample."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import Field

from clerestory.trace.bands import Bands
from clerestory.trace.keys import Keys, RecipeError
from clerestory.trace.kinds import AnySample
from clerestory.trace.materials import Material
from clerestory.trace.media import Medium

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping


class Recipe(Keys):
    """A recipe: what a sample looks like and what it is made of."""

    bands: Bands = Field(default_factory=Bands)
    """The bands that are traced."""
    sample: AnySample
    """The sample."""
    materials: dict[str, Material] = Field(default_factory=dict)
    """What surfaces do with light, by names that the sample uses."""
    media: dict[str, Medium] = Field(default_factory=dict)
    """What bodies are made of, by names that the sample uses."""


def changed(tables: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Tables with some of their keys, also those of tables within, given anew."""
    made = dict(tables)
    for key, value in changes.items():
        held = made.get(key)
        made[key] = changed(held, value) if isinstance(held, dict) and isinstance(value, dict) else value
    return made


def read_toml(path: str | os.PathLike[str]) -> dict[str, Any]:
    """The tables of a TOML file.

    Raises
    ------
    RecipeError
        It is not TOML; the text names the place.
    OSError
        It cannot be read.
    """
    data = Path(path).read_bytes()
    try:
        return tomllib.loads(data.decode("utf-8"))
    except UnicodeDecodeError as error:
        raise RecipeError(f"byte {error.start}: not text in UTF-8 (save the recipe as UTF-8)") from None
    except tomllib.TOMLDecodeError as error:
        raise RecipeError(f"not TOML: {str(error)[:1].lower()}{str(error)[1:]} (correct it there)") from None
