"""Classes of EN 14501: from 0, very little effect, to 4, very good effect."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from pydantic import Field, model_validator

from clerestory._core import ClerestoryError
from clerestory.trace.keys import Keys, RecipeError, wrong
from clerestory.trace.recipe import read_toml

if TYPE_CHECKING:
    from collections.abc import Mapping

EFFECTS = ("very little effect", "little effect", "moderate effect", "good effect", "very good effect")
"""In words, by class."""
QUANTITIES = ("g_tot", "q_i_tot", "tau_e_n-n", "tau_v_n-n", "tau_v_n-dif", "tau_v_dif-h")
"""That classes depend on."""
CRITERIA = (
    "solar gain",
    "secondary heat",
    "direct solar transmission",
    "glare control",
    "night privacy",
    "outward view",
    "daylight utilisation",
    "darkening",
)
"""In the order of a sheet."""
OPENNESS = (0.005, 0.05, 0.10)
"""Usual limits of the rows of tau_v_n-n: what is shown as 0.00 counts as none."""


class ByValue(Keys):
    """Classes by one quantity."""

    criterion: str
    """What is rated."""
    quantity: str
    """By which it is."""
    limits: list[float]
    """Where classes begin, rising."""
    classes: list[int]
    """From below the first limit on; one more than limits."""

    @model_validator(mode="after")
    def _sound(self) -> ByValue:
        if self.quantity not in QUANTITIES:
            raise wrong("quantity", f"{self.quantity!r} is not known (known: {', '.join(QUANTITIES)})")
        if sorted(self.limits) != self.limits or len(self.classes) != len(self.limits) + 1:
            raise wrong("classes", "limits rise, and classes are one more than they are")
        _known(self.classes, "classes")
        return self


class ByOpenness(Keys):
    """Classes by tau_v_n-n and tau_v_n-dif."""

    criterion: str
    """What is rated."""
    columns: list[float]
    """Where columns of tau_v_n-dif begin, rising."""
    openness: list[float] = Field(default=list(OPENNESS), min_length=1)
    """Limits of the rows, rising: below the first one tau_v_n-n counts as none; the others belong to the row below."""
    rows: list[list[int]]
    """Classes, a row for each interval of tau_v_n-n: none, up to 0.05, up to 0.10, above."""

    @model_validator(mode="after")
    def _sound(self) -> ByOpenness:
        if sorted(self.columns) != self.columns or sorted(self.openness) != self.openness:
            raise wrong("columns", "columns and openness rise")
        if len(self.rows) != len(self.openness) + 1:
            raise wrong("rows", f"there is one more than limits of openness, {len(self.openness) + 1}")
        if any(len(row) != len(self.columns) + 1 for row in self.rows):
            raise wrong("rows", "a row has one class more than there are limits of columns")
        for row in self.rows:
            _known(row, "rows")
        return self


def _known(classes: list[int], key: str) -> None:
    beyond = [number for number in classes if not 0 <= number < len(EFFECTS)]
    if beyond:
        raise wrong(key, f"{beyond[0]} is no class (give 0 to {len(EFFECTS) - 1})")


class Edition(Keys):
    """Limits of an edition of the standard."""

    source: str
    """Where they are from."""
    by_value: list[ByValue] = Field(default_factory=list)
    """By one quantity."""
    by_openness: list[ByOpenness] = Field(default_factory=list)
    """By what goes straight on and what is scattered."""


@dataclass(frozen=True)
class Rating:
    """A class."""

    criterion: str
    number: int | None
    """0 to 4; None where a quantity is not known."""
    words: str
    """The effect and the quantities, or what is missing."""


@cache
def _shipped() -> dict[str, Edition]:
    tables = read_toml(Path(__file__).with_name("editions.toml"))
    return {name: Edition.of(table) for name, table in tables.items()}


EDITIONS = tuple(_shipped())
"""Names of the editions that come with Clerestory."""


def edition(name: str | Path) -> Edition:
    """Limits by the name of an edition, or of a TOML file that has one.

    Raises
    ------
    RecipeError
        The name is not known, or a key of the file is wrong.
    """
    if str(name) in _shipped():
        return _shipped()[str(name)]
    path = Path(name)
    if path.suffix != ".toml":
        raise RecipeError(
            f"the limits of {str(name)!r} are not known: those of 2021 are not public (known: {', '.join(EDITIONS)}; "
            "or give a TOML file with those of your copy of the standard, in the form that docs/systems.md shows)"
        )
    tables = read_toml(path)
    if len(tables) != 1:
        raise RecipeError(f"{path}: one table by the edition's name is expected, not {len(tables)}")
    try:
        return Edition.of(next(iter(tables.values())))
    except RecipeError as error:
        raise RecipeError(f"{path}: {error}") from None


def classify(quantities: Mapping[str, float], limits: Edition) -> list[Rating]:
    """The class of every criterion of an edition.

    Parameters
    ----------
    quantities
        Those of `QUANTITIES` that are known.
    limits
        Of the edition.

    Raises
    ------
    ClerestoryError
        A quantity is not known, or not one of −0.01 to 1.
    """
    for name, value in quantities.items():
        if name not in QUANTITIES:
            raise ClerestoryError(f"a quantity {name!r} is not known (known: {', '.join(QUANTITIES)})")
        if not -0.01 <= value <= 1.0 + 1e-6:
            raise ClerestoryError(f"{name} of {value:g} is no share of light (give 0 to 1)")
    found: dict[str, Rating] = {}
    for table in limits.by_value:
        found[table.criterion] = _rated(table.criterion, (table.quantity,), quantities, _by_value(table, quantities))
    for grid in limits.by_openness:
        names = ("tau_v_n-n", "tau_v_n-dif")
        found[grid.criterion] = _rated(grid.criterion, names, quantities, _by_openness(grid, quantities))
    if "darkening" not in found:
        words = "not rated: EN 14500 tests it with lamps on the mounted product, and a data set does not tell"
        found["darkening"] = Rating("darkening", None, words)
    return sorted(
        found.values(), key=lambda r: CRITERIA.index(r.criterion) if r.criterion in CRITERIA else len(CRITERIA)
    )


def _by_value(table: ByValue, quantities: Mapping[str, float]) -> int | None:
    value = quantities.get(table.quantity)
    return None if value is None else table.classes[int(np.searchsorted(table.limits, value, side="right"))]


def _by_openness(grid: ByOpenness, quantities: Mapping[str, float]) -> int | None:
    straight, scattered = (quantities.get(name) for name in ("tau_v_n-n", "tau_v_n-dif"))
    if straight is None or scattered is None:
        return None
    # Rows hold their upper limit: "up to 0.05".
    none, *steps = grid.openness
    row = 0 if straight < none else 1 + int(np.searchsorted(steps, straight, side="left"))
    return grid.rows[row][int(np.searchsorted(grid.columns, scattered, side="right"))]


def _rated(criterion: str, names: tuple[str, ...], quantities: Mapping[str, float], number: int | None) -> Rating:
    if number is None:
        missing = ", ".join(name for name in names if name not in quantities)
        return Rating(criterion, None, f"not rated: {missing} is not known")
    shown = ", ".join(f"{name} {quantities[name]:.3f}" for name in names)
    return Rating(criterion, number, f"{EFFECTS[number]} ({shown})")
