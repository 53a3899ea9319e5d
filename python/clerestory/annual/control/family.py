"""Families of systems in a study: a data set that names one gets its states."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from clerestory._core import FileFormatError, __version__
from clerestory.annual.traced import kept
from clerestory.system import family as families
from clerestory.system.family.manifest import MANIFEST
from clerestory.trace.keys import Keys, Positive, RecipeError
from clerestory.trace.reading import reading
from clerestory.trace.recipe import read_toml
from clerestory.trace.shipped import RECIPES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from clerestory.annual.cache import Cache
    from clerestory.system.family import Family

    Tell = Callable[[str], object]

_SLATS = {"width_mm": "width", "pitch_mm": "pitch", "crown_mm": "crown"}


class FamilyKeys(Keys):
    """How a data set names a family."""

    family: str
    """Its manifest (.json), the folder of it, or its specification (.toml), relative to the study."""
    step: Positive | None = None
    """States also at the multiples of this, in the parameter's unit, mixed of their neighbours."""


def expanded(tables: Mapping[str, Any], folder: Path, cache: Cache, tell: Tell | None) -> dict[str, Any]:
    """The tables of a study, with the states of families in place of their names.

    States come after those that the data set lists itself, such as `up`. They have the data set's `treatment`, `band`
    and `flipped`; those of a family by tilt have `tilt_deg`, and `cut-off` has the family's slats where it names none.

    Parameters
    ----------
    tables
        Of the study.
    folder
        Of the study.
    cache
        For families that are specified, or refined, but not built yet; they are built once.
    tell
        Called with words before a sample is traced, which takes time.

    Raises
    ------
    RecipeError
        A family cannot be read or built; the text names the data set.
    """
    made = dict(tables)
    data_sets = made.get("data_sets")
    if isinstance(data_sets, dict):
        made["data_sets"] = {
            name: _with_states(given, f"data_sets.{name}", folder, cache, tell)
            if isinstance(given, dict) and "family" in given
            else given
            for name, given in data_sets.items()
        }
    return made


def _with_states(given: dict[str, Any], key: str, folder: Path, cache: Cache, tell: Tell | None) -> dict[str, Any]:
    own = {name: given[name] for name in FamilyKeys.model_fields if name in given}
    common = {name: given[name] for name in ("treatment", "band", "flipped") if name in given}
    rest = {name: value for name, value in given.items() if name not in own and name not in common}
    try:
        keys = FamilyKeys.of(own)
    except RecipeError as error:
        raise RecipeError(f"{key}.{error}") from None
    with reading(f"{key}.family"):
        found = _found(folder / keys.family, keys.step, cache, tell)
    states = dict(rest.get("states", {}))
    for state in found.states:
        assert state.file is not None
        if state.name in states:
            raise RecipeError(f"{key}.states.{state.name}: the family has a state of this name (give it another)")
        tilt = {"tilt_deg": state.value} if found.parameter == "tilt_deg" else {}
        states[state.name] = {"file": str(state.file.resolve()), **tilt, **common}
    made = {**rest, "states": states}
    control = rest.get("control")
    if isinstance(control, dict) and control.get("kind") == "cut-off" and found.slats_mm is not None:
        slats = {name: found.slats_mm[of] for name, of in _SLATS.items()}
        made["control"] = {**({} if set(control) & set(_SLATS) else slats), **control}
    return made


def _found(path: Path, step: float | None, cache: Cache, tell: Tell | None) -> Family:
    """A family with its step, from files."""
    if path.is_dir():
        path = path / MANIFEST
    is_built = path.suffix.lower() == ".json"
    if is_built and step is None:
        return families.read(path)
    marks = [path.read_bytes()] if is_built else list(_contents(path))

    def make(home: Path) -> None:
        made = families.read(path) if is_built else families.load(path).make(kept(cache, tell))
        families.write(made if step is None else made.refined(step), home)

    home = cache.folder_of("family", (__version__, step, *marks), make)
    try:
        return families.read(home)
    except (FileFormatError, FileNotFoundError) as error:
        cache.warnings.append(f"{error}; it is made again")
        make(home)
        return families.read(home)


def _contents(path: Path, seen: frozenset[Path] = frozenset()) -> Iterator[bytes]:
    """Content of a specification, and of all files and shipped recipes that it names, to know it again."""
    yield path.read_bytes()
    if path.suffix.lower() != ".toml" or path.resolve() in seen:
        return
    for text in _texts(read_toml(path)):
        shipped = RECIPES.path_of(text)
        beside = path.parent / text
        if shipped is not None:
            yield from _contents(shipped, seen | {path.resolve()})
        elif len(text) < 255 and "\n" not in text and beside.is_file():
            yield from _contents(beside, seen | {path.resolve()})


def _texts(held: object) -> Iterator[str]:
    if isinstance(held, str):
        yield held
    elif isinstance(held, dict):
        for member in held.values():
            yield from _texts(member)
    elif isinstance(held, list):
        for member in held:
            yield from _texts(member)
