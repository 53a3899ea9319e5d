"""What a picture is of: one component of a data set, lit from one direction, and the words for it."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING, get_args

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.basis import Basis
from clerestory.bsdf import Bsdf, Peak, Region
from clerestory.directions import Scatter, Side, incident_in_words, outgoing_in_words, outgoing_side
from clerestory.integrals import continued, patch_directions
from clerestory.plot.style import Quantity, figures
from clerestory.words import band_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import ArrayLike, NDArray

PATCHES = (1, 41, 88, 130)
"""Incident patches of the report of IEA SHC Task 61 (2021, C.2.2), section 3.4: 0°, 30°, 50° and 70° from above."""


@dataclass(frozen=True)
class Light:
    """An incident direction: where the light comes from."""

    direction: NDArray[np.float64]
    """Unit vector (3,) toward the source."""
    patch: int | None
    """Number of the Klems patch (full basis, from 1) that it was named by."""

    @property
    def side(self) -> Side:
        """The side that the light comes from."""
        return "exterior" if self.direction[2] < 0.0 else "interior"

    @property
    def words(self) -> str:
        """From above, 30° (Klems 41)."""
        words = incident_in_words(self.direction)
        return words if self.patch is None else f"{words} (Klems {self.patch})"

    @property
    def theta_deg(self) -> float:
        """Angle to the normal [°]."""
        return float(np.degrees(np.arctan2(np.hypot(*self.direction[:2]), abs(self.direction[2]))))


def light(incident: int | ArrayLike, side: Side | None = None) -> Light:
    """An incident direction from a Klems patch or a vector.

    Parameters
    ----------
    incident
        Number of a patch of Klems' full basis from 1 to 145, or a direction (3,) toward the source.
    side
        Where a patch's light comes from, exterior by default; a direction says it by itself.
    """
    if side is not None and side not in get_args(Side):
        raise ClerestoryError(f"side {side!r} is not known (give exterior or interior)")
    if isinstance(incident, int | np.integer):
        centres = Basis.named("klems-full").incident_centres(side or "exterior")
        if not 1 <= incident <= len(centres):
            raise ClerestoryError(f"Klems patch {incident} does not exist (give 1 to {len(centres)})")
        return Light(centres[incident - 1], int(incident))
    d = np.asarray(incident, dtype=np.float64)
    if d.shape != (3,) or not np.all(np.isfinite(d)) or not np.any(d):
        raise ClerestoryError(
            f"{incident!r} is not an incident direction (give a Klems patch number or x, y, z toward the source)"
        )
    made = Light(d / np.linalg.norm(d), None)
    if side is not None and made.side != side:
        raise ClerestoryError(
            f"light {made.words} comes from the {made.side}, not the {side} (leave the side out, or turn it round)"
        )
    return made


@dataclass(frozen=True)
class View:
    """One component of a data set, lit from one direction."""

    bsdf: Bsdf
    light: Light
    scatter: Scatter
    band: str
    label: str
    by_reciprocity: bool

    @classmethod
    def of(
        cls,
        bsdf: Bsdf,
        incident: int | ArrayLike,
        *,
        side: Side | None = None,
        scatter: Scatter = "transmission",
        band: str | None = None,
        label: str = "",
    ) -> View:
        """A view, if the data set holds what it shows.

        Raises
        ------
        MissingDataError
            It does not.
        """
        return cls.lit(bsdf, light(incident, side), scatter=scatter, band=band, label=label)

    @classmethod
    def lit(cls, bsdf: Bsdf, source: Light, *, scatter: Scatter, band: str | None = None, label: str = "") -> View:
        """As `of`, from an incident direction that is known already."""
        _, by_reciprocity = bsdf.model(source.side, scatter, band)
        return cls(bsdf, source, scatter, band_name(bsdf, band), label, by_reciprocity)

    @property
    def outgoing_side(self) -> Side:
        """The side that the light leaves to."""
        return outgoing_side(self.light.side, self.scatter)

    @property
    def through(self) -> NDArray[np.float64]:
        """Outgoing direction (3,) of light that goes straight through, or is mirrored."""
        return continued(self.light.direction, self.scatter)

    @property
    def through_words(self) -> str:
        """Straight through: downward, 30°."""
        name = "straight through" if self.scatter == "transmission" else "mirrored"
        return f"{name}: {outgoing_in_words(self.through)}"

    def evaluate(self, outgoing: NDArray[np.float64], quantity: Quantity = "bsdf") -> NDArray[np.float64]:
        """Scattered light [1/sr] in directions (..., 3); NaN where a direction is NaN."""
        if quantity not in get_args(Quantity):
            raise ClerestoryError(f"quantity {quantity!r} is not known (give bsdf or dsf)")
        known = np.all(np.isfinite(outgoing), axis=-1)
        values = np.full(outgoing.shape[:-1], np.nan)
        values[known] = self.bsdf.evaluate(self.light.direction, outgoing[known], self.band)
        return values * np.abs(outgoing[..., 2]) if quantity == "dsf" else values

    def peaks(self) -> list[Peak]:
        """Beams among the scattered light."""
        return self.bsdf.peaks(self.light.direction, self.scatter, self.band)

    def total(self, region: Region | None = None, *, samples: int = 16) -> float:
        """Direct-hemispherical value, or the part that goes into a region.

        Where the light is named by a Klems patch it is the mean over that patch, as in a comparison's tables; a matrix
        on Klems' full basis has it as its own, other data have it by `samples` directions. A direction has the value of
        just this direction.
        """
        incident = self.light.direction
        if self.light.patch is not None:
            side = self.light.side
            incident = patch_directions(
                self.bsdf, self.light.patch, self.scatter, side=side, band=self.band, samples=samples
            )
        return float(np.mean(self.bsdf.integrate(incident, self.scatter, region, self.band)))

    @property
    def total_of(self) -> str:
        """What the totals are of: patch mean, or this direction."""
        return "this direction" if self.light.patch is None else "patch mean"

    @property
    def symbol(self) -> str:
        """T or R with the subscript d-h, in mathematical type."""
        return f"${self.scatter[0].upper()}_{{\\mathrm{{d\u2010h}}}}$"

    @property
    def component(self) -> str:
        """Visible transmission from the exterior to the interior."""
        return component_words(self.band, self.light.side, self.scatter, by_reciprocity=self.by_reciprocity)

    @property
    def title(self) -> str:
        """Three lines: whose data, which component lit from where, and how much of the light leaves."""
        head = textwrap.wrap(self.label, 60)
        total = f"{self.symbol} = {figures(self.total())} ({self.total_of})"
        return "\n".join([*head, self.component, f"incident {self.light.words};  {total}"])


def component_words(band: str, side: Side, scatter: Scatter, *, by_reciprocity: bool = False) -> str:
    """A component in words."""
    words = f"{band} {scatter}, light from the {side}"
    return words + " (by reciprocity)" if by_reciprocity else words


def labelled(sets: Bsdf | Mapping[str, Bsdf]) -> dict[str, Bsdf]:
    """Data sets by label; a single one needs none."""
    if isinstance(sets, Bsdf):
        return {"": sets}
    if not sets:
        raise ClerestoryError("no data set was given (give at least one)")
    return dict(sets)


def lights(incident: int | ArrayLike | Iterable[int | ArrayLike], side: Side | None) -> list[Light]:
    """One or more incident directions."""
    if isinstance(incident, int | np.integer):
        return [light(int(incident), side)]
    items = list(incident)  # type: ignore[arg-type]
    if len(items) == 3 and all(isinstance(i, float | np.floating) for i in items):
        return [light(np.asarray(items), side)]
    if not items:
        raise ClerestoryError("no incident direction was given (give a patch number or a direction)")
    return [light(i, side) for i in items]


def region_words(region: Region, side: Side) -> str:
    """A region with the direction that it is about."""
    axis = region.spec[0]
    if not isinstance(axis, tuple):
        return region.words
    x, y = axis
    z = float(np.sqrt(max(0.0, 1.0 - x * x - y * y)))
    return f"{region.words} of {outgoing_in_words([x, y, z if side == 'interior' else -z])}"
