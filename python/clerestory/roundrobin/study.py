"""A round robin, read and checked: systems, what laboratories gave of them, and how it is used."""

from __future__ import annotations

import errno
import hashlib
import os
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from clerestory import files
from clerestory._core import ClerestoryError, MissingDataError
from clerestory.integrals import own_basis
from clerestory.npz import mark
from clerestory.room import recipe as room_keys
from clerestory.room.systems import system_of
from clerestory.roundrobin.recipe import TREATMENTS, Recipe
from clerestory.system import stack
from clerestory.system.dataset import data_set
from clerestory.trace.keys import RecipeError
from clerestory.trace.reading import reading
from clerestory.trace.recipe import read_toml

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.bsdf import Bsdf
    from clerestory.room.recipe import Treatment
    from clerestory.roundrobin.recipe import Given, Pane
    from clerestory.system.build import Traced

FINE_PATCHES = 300
"""A matrix with more incident patches than this counts as of high resolution; Klems full has 145."""


@dataclass(frozen=True)
class Source:
    """A data set that a laboratory gave."""

    given: Given
    path: Path
    sha256: str
    """Of the file."""
    mark: str
    """Stands for all that the data set depends on, before it is flipped."""
    bsdf: Bsdf
    resolution: Literal["klems", "high"]

    @property
    def model(self) -> str:
        """Kind and resolution of the transmission."""
        model, _ = self.bsdf.model("exterior", "transmission")
        return model.kind


@dataclass(frozen=True)
class Laboratory:
    """What a laboratory gave of a system."""

    name: str
    klems: Source | None
    high: Source | None
    raw: tuple[Given, ...] = ()

    @property
    def sources(self) -> tuple[Source, ...]:
        """Its BSDF files."""
        return tuple(s for s in (self.klems, self.high) if s is not None)

    def source(self, treatment: Treatment) -> Source | None:
        """The file that a treatment takes: of Klems resolution its own, or the fine one, of which a matrix is made."""
        return self.high if treatment.startswith("high") else self.klems or self.high


@dataclass(frozen=True)
class Case:
    """A laboratory's data set in one treatment."""

    laboratory: str
    treatment: Treatment

    def __str__(self) -> str:
        return f"{self.laboratory}, {self.treatment}"


class System:
    """A system and its laboratories."""

    def __init__(self, name: str, title: str, laboratories: Sequence[Laboratory], pane: Bsdf | None) -> None:
        self.name = name
        self.title = title
        self.is_alone = False
        """Whether it is the only one of the round robin."""
        self.laboratories = tuple(laboratories)
        self.pane = pane
        self._of = {lab.name: lab for lab in laboratories}
        self.treated = cache(self._treated)

    def said(self, text: str) -> str:
        """A sentence about it, which names it where there are others."""
        return text if self.is_alone else f"{self.title}. {text}"

    def cases(self, treatments: Sequence[Treatment]) -> list[Case]:
        """All that there are: treatments in their order, laboratories in theirs.

        Layers are put together on Klems' patches, so that behind a pane there is no high resolution.
        """
        return [
            Case(lab.name, treatment)
            for treatment in TREATMENTS
            if treatment in treatments and not (self.pane is not None and treatment.startswith("high"))
            for lab in self.laboratories
            if lab.source(treatment) is not None
        ]

    def key(self, case: Case) -> dict[str, object]:
        """All that the data set of a case depends on."""
        source = self._source(case)
        return {
            "file": source.mark,
            "flipped": source.given.flipped,
            "treatment": case.treatment,
            "pane": None if self.pane is None else mark(self.pane),
        }

    def _source(self, case: Case) -> Source:
        source = self._of[case.laboratory].source(case.treatment)
        if source is None:
            raise MissingDataError(f"{self.name}: {case.laboratory} gave nothing for {case.treatment}")
        return source

    def _treated(self, case: Case) -> Bsdf:
        """The data set of a case, behind the pane if there is one."""
        source = self._source(case)
        bsdf = source.bsdf
        with files.named(source.path):
            if case.treatment.startswith("klems"):
                bsdf = bsdf.to_matrix("klems-full")
            if self.pane is not None:
                bsdf = stack([self.pane, bsdf]).bsdf
            return bsdf.separate_peaks() if case.treatment.endswith("peaks") else bsdf


class RoundRobin:
    """A round robin: made by `load` or `of_files`."""

    def __init__(self, recipe: Recipe, folder: Path, traced: Traced | None = None) -> None:
        self.recipe = recipe
        self._traced = traced
        self.folder = folder
        self.systems = [self._system(name) for name in recipe.systems]
        """In their order."""
        if len(self.systems) == 1:
            self.systems[0].is_alone = True
        for system in self.systems:
            if not system.cases(recipe.treatments):
                raise RecipeError(
                    f"treatments: none of them fits a data set of systems.{system.name} (give klems, too)"
                )

    def _system(self, name: str) -> System:
        given = self.recipe.systems[name]
        key = f"systems.{name}"
        sources: dict[str, dict[str, Source]] = {}
        raw: dict[str, list[Given]] = {}
        for k, one in enumerate(given.data_sets):
            own = sources.setdefault(one.laboratory, {})
            if one.resolution == "raw":
                raw.setdefault(one.laboratory, []).append(one)
                continue
            made = _source(one, self.folder, f"{key}.data_sets[{k + 1}]", self._traced)
            if made.resolution in own:
                raise RecipeError(
                    f"{key}.data_sets[{k + 1}].laboratory: {one.laboratory} has two data sets of resolution "
                    f"{made.resolution}, {own[made.resolution].path.name} and {made.path.name} (give one another name)"
                )
            own[made.resolution] = made
        laboratories = [
            Laboratory(lab, own.get("klems"), own.get("high"), tuple(raw.get(lab, ()))) for lab, own in sources.items()
        ]
        if sum(1 for lab in laboratories if lab.sources) < 2:
            raise RecipeError(
                f"{key}.data_sets: fewer than two laboratories gave a BSDF file, so nothing can be compared (add one)"
            )
        pane = given.pane or self.recipe.pane
        where = f"{key}.pane" if given.pane is not None else "pane"
        layer = None if pane is None else _pane(pane, where, self.folder, self._traced)
        made_system = System(name, given.title or name, laboratories, layer)
        if layer is not None:
            for case in made_system.cases(self.recipe.treatments):
                made_system.treated(case)  # says which layer cannot stand behind a pane
        return made_system

    @property
    def laboratories(self) -> list[str]:
        """Names of all, in their order."""
        return list(dict.fromkeys(lab.name for system in self.systems for lab in system.laboratories))


def _source(given: Given, folder: Path, key: str, traced: Traced | None) -> Source:
    """Read a file, and see that it can be compared."""
    with reading(f"{key}.file"):
        found = data_set(str(given.file), folder, traced=traced)
        path = found.sources[0]
        sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
        own_mark = sha256 if found.is_stored else mark(found.bsdf)
        bsdf = found.bsdf.flipped() if given.flipped else found.bsdf
    try:
        bsdf.model("exterior", "transmission")
    except MissingDataError as error:
        raise RecipeError(f"{key}.file: {path}: {error} (a round robin compares transmission: leave it out)") from None
    basis = own_basis(bsdf, "transmission")
    fine = basis is None or len(basis) > FINE_PATCHES
    if given.resolution == "high" and not fine:
        assert basis is not None
        raise RecipeError(
            f"{key}.resolution: {path} has {len(basis)} incident patches, which is no high resolution (give klems)"
        )
    resolution: Literal["klems", "high"] = (
        given.resolution if given.resolution in ("klems", "high") else "high" if fine else "klems"
    )
    return Source(given, path, sha256, own_mark, bsdf, resolution)


def _pane(pane: Pane, key: str, folder: Path, traced: Traced | None) -> Bsdf:
    return system_of(room_keys.System(**pane.model_dump(exclude_none=True), treatment="high"), key, folder, traced).bsdf


def load(
    source: str | os.PathLike[str],
    *,
    without: Sequence[str] = (),
    weather: str | None = None,
    traced: Traced | None = None,
) -> RoundRobin:
    """A round robin from its TOML file.

    Parameters
    ----------
    source
        The file.
    without
        Analyses that are left out, whatever the file says.
    weather
        Weather file of the year, in place of the file's.
    traced
        Traces samples, see `clerestory.system.dataset.data_set`.

    Raises
    ------
    RecipeError
        The text names file, key, what is wrong and the remedy.
    OSError
        A file cannot be read.
    """
    path = Path(source)
    try:
        recipe = Recipe.of(read_toml(path))
        changes: dict[str, object] = {"analyses": [a for a in recipe.analyses if a not in without]}
        if weather is not None:
            changes["year"] = recipe.year.model_copy(update={"weather": weather})
        return RoundRobin(recipe.model_copy(update=changes), path.parent, traced)
    except RecipeError as error:
        raise RecipeError(f"{path}: {error}") from error


def of_files(given: Sequence[tuple[str, Path]], **settings: object) -> RoundRobin:
    """A round robin of one system, of laboratories' names and files; a name that is there twice gave two files.

    Raises
    ------
    ClerestoryError
        A file cannot be compared.
    OSError
        A file cannot be read.
    """
    for _, path in given:
        if not path.exists():
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    data_sets = [{"laboratory": name, "file": str(path.resolve())} for name, path in given]
    tables = {"systems": {"system": {"title": "System", "data_sets": data_sets}}, **settings}
    try:
        return RoundRobin(Recipe.of(tables), Path())
    except RecipeError as error:
        # There is no study file whose keys would help.
        text = str(error)
        head, _, rest = text.partition(": ")
        raise ClerestoryError(rest if head.startswith("systems.system.data_sets") else text) from error
