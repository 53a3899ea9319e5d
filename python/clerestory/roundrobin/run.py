"""Every analysis of a round robin: what has to be computed, and what was found."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from clerestory.roundrobin import coarseness, moments, transmittance, years
from clerestory.roundrobin.measures import Annual, Measure, annual_of, measures
from clerestory.roundrobin.moments import Moments
from clerestory.roundrobin.pieces import collect
from clerestory.roundrobin.years import Years

if TYPE_CHECKING:
    from collections.abc import Callable

    from clerestory.annual.cache import Arrays, Cache
    from clerestory.roundrobin.moments import Moment
    from clerestory.roundrobin.pieces import Piece
    from clerestory.roundrobin.study import Case, RoundRobin, System
    from clerestory.roundrobin.transmittance import Transmittance
    from clerestory.roundrobin.years import CaseYear


@dataclass
class Found:
    """What was found of a system."""

    system: System
    cases: list[Case]
    moments_of: Moments | None
    """The room of points in time."""
    years_of: Years | None
    """The room of the year."""
    transmittance: Transmittance | None = None
    coarse: dict[Case, str] = field(default_factory=dict)
    """Why the data of a case are too coarse for glare and direct sun; those that are not are not there."""
    moments: dict[Case, dict[tuple[str, int], Moment]] = field(default_factory=dict)
    """By time and seed."""
    renderings: dict[Case, Arrays] = field(default_factory=dict)
    years: dict[Case, dict[int, CaseYear]] = field(default_factory=dict)
    """By seed."""
    _annual: dict[tuple[Case, int], Annual] = field(default_factory=dict)

    def annual(self, case: Case, seed: int) -> Annual:
        """What the year of a case comes to."""
        if (case, seed) not in self._annual:
            self._annual[case, seed] = annual_of(self, case, seed)
        return self._annual[case, seed]

    @cached_property
    def measures(self) -> list[Measure]:
        """All figures, with their variances."""
        return measures(self)

    def moment(self, case: Case, time: str) -> Moment:
        """The mean over seeds."""
        own = [value for (when, _), value in self.moments[case].items() if when == time]
        count = len(own)
        return moments.Moment(
            sum(v.illuminance for v in own) / count, sum(v.dgp for v in own) / count, sum(v.dgi for v in own) / count
        )


class Work:
    """All that a round robin asks for, before anything is computed."""

    def __init__(self, study: RoundRobin, cache: Cache) -> None:
        self.study = study
        self.cache = cache
        recipe = study.recipe
        done = recipe.analyses
        self.moments = Moments(recipe.moments, study.folder, recipe.seeds) if "moments" in done else None
        self.years = Years(recipe.year, study.folder, recipe.seeds, cache) if "year" in done else None
        self._slots: list[tuple[Piece, Callable[[Arrays], None]]] = []
        """Pieces, and where each goes."""
        self.found = [self._of(system) for system in study.systems]

    @property
    def pieces(self) -> list[Piece]:
        """In the order in which they are computed."""
        return [piece for piece, _ in self._slots]

    def run(self, tell: Callable[[float, str], object]) -> list[Found]:
        """What was found of each system; `tell` is called with the share of the work that is done and what is next."""
        for (_, put), arrays in zip(self._slots, collect(self.pieces, self.cache, tell), strict=True):
            put(arrays)
        return self.found

    def _of(self, system: System) -> Found:
        recipe = self.study.recipe
        cases = system.cases(recipe.treatments)
        found = Found(system, cases, self.moments, self.years)
        if "transmittance" in recipe.analyses:

            def compared(arrays: Arrays) -> None:
                found.transmittance = transmittance.read(arrays)

            self._slots.append((transmittance.piece(system, recipe.patches), compared))
        if self.moments is None and self.years is None:
            return found
        for case in cases:
            self._add(found, case, repeated=case.treatment == cases[0].treatment)
        return found

    def _add(self, found: Found, case: Case, *, repeated: bool) -> None:
        system = found.system

        def judged(arrays: Arrays) -> None:
            why = coarseness.read(arrays)
            if why:
                found.coarse[case] = why

        self._slots.append((coarseness.piece(system, case), judged))
        if self.moments is not None:
            for place, piece in self.moments.pieces(system, case).items():

                def at_a_time(arrays: Arrays, place: tuple[str, int] = place) -> None:
                    found.moments.setdefault(case, {})[place] = moments.read(arrays)

                self._slots.append((piece, at_a_time))
            self._slots.append(
                (self.moments.rendering(system, case), lambda arrays: found.renderings.update({case: arrays}))
            )
        if self.years is not None:
            for seed, piece in self.years.pieces(system, case, repeated=repeated).items():

                def of_year(arrays: Arrays, seed: int = seed) -> None:
                    found.years.setdefault(case, {})[seed] = years.read(arrays)

                self._slots.append((piece, of_year))
