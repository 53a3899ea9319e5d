"""A shading device or a window rated: its figures, g with glazing, and classes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from clerestory._core import MissingDataError
from clerestory.directions import SCATTERS, SIDES
from clerestory.integrals import cut_off
from clerestory.rating.classes import classify
from clerestory.rating.optics import optics
from clerestory.thermal.en_iso_52022 import POSITIONS, REFERENCE_GLAZINGS, g_total

if TYPE_CHECKING:
    from clerestory.bsdf import Bsdf
    from clerestory.integrals import CutOff
    from clerestory.rating.classes import Edition, Rating
    from clerestory.rating.optics import Optics
    from clerestory.thermal.en_iso_52022 import Position, Total


@dataclass(frozen=True)
class Rated:
    """What was found of a product."""

    name: str
    optics: tuple[Optics, ...]
    """Of all components in the bands visible and solar."""
    cut_off: CutOff
    """Of light from above."""
    g: dict[Position, dict[str, Total]]
    """With reference glazings by position and letter; empty for a window, which has its own."""
    quantities: dict[str, float]
    """That the classes were found by."""
    ratings: tuple[Rating, ...]
    doubts: tuple[str, ...]

    @property
    def cut_off_words(self) -> str:
        """From which angle on, and how that was found."""
        angle = self.cut_off.angle_deg
        found = "not cut off at any angle" if angle is None else f"cut off from {angle:.3g}° on"
        return f"Light from above is {found}: {self.cut_off.words}"

    def of(self, band: str, scatter: str, side: str = "exterior") -> Optics | None:
        """Figures of a component, if the data have it."""
        wanted = (band, scatter, side)
        return next((o for o in self.optics if (o.band, o.scatter, o.side) == wanted), None)


def rate_device(
    bsdf: Bsdf, limits: Edition, *, name: str = "", position: Position = "interior", glazing: str = "C"
) -> Rated:
    """A blind, a screen or a film, with the reference glazings of EN 14501 by the simplified method (EN ISO 52022-1).

    Parameters
    ----------
    bsdf
        Of the device alone.
    limits
        Of an edition of EN 14501.
    name
        Of the product; the data set's own by default.
    position, glazing
        With which g_tot is rated; the standard's reference is C.

    Raises
    ------
    MissingDataError
        There is no band visible.
    """
    found, doubts = _optics(bsdf)
    quantities = _visible(found)
    solar = {o.scatter: o for o in found if o.band == "solar" and o.side == "exterior"}
    totals: dict[Position, dict[str, Total]] = {}
    if len(solar) == len(SCATTERS):
        through, back = solar["transmission"], solar["reflection"]
        quantities["tau_e_n-n"] = through.normal_normal
        totals = {
            where: {
                letter: g_total(where, pane.u, pane.g, through.normal_hemispherical, back.normal_hemispherical)
                for letter, pane in REFERENCE_GLAZINGS.items()
            }
            for where in POSITIONS
        }
        quantities["g_tot"] = totals[position][glazing].g
        doubts += totals[position][glazing].doubts
    else:
        doubts += ("g_tot needs solar transmittance and reflectance from the exterior, which the data lack",)
    return _rated(bsdf, name, found, totals, quantities, limits, doubts)


def rate_window(bsdf: Bsdf, limits: Edition, *, g: float, secondary: float, name: str = "") -> Rated:
    """A whole window, with its own g and the secondary part of it (EN ISO 52022-3, or ISO 15099).

    Parameters
    ----------
    bsdf
        Of all layers together.
    limits
        Of an edition of EN 14501.
    g, secondary
        For light along the normal.
    name
        Of the window.
    """
    found, doubts = _optics(bsdf)
    quantities = _visible(found) | {"g_tot": g, "q_i_tot": secondary}
    solar = next((o for o in found if (o.band, o.scatter, o.side) == ("solar", "transmission", "exterior")), None)
    if solar is not None:
        quantities["tau_e_n-n"] = solar.normal_normal
    return _rated(bsdf, name, found, {}, quantities, limits, doubts)


def _optics(bsdf: Bsdf) -> tuple[tuple[Optics, ...], tuple[str, ...]]:
    """Of all components that the data have, and what they lack."""
    if "visible" not in bsdf.bands:
        raise MissingDataError(f"the data have no band visible (they have {', '.join(bsdf.bands)})")
    found, missing = [], []
    for band in ("visible", "solar"):
        if band not in bsdf.bands:
            missing.append(f"the data have no band {band}")
            continue
        for side in SIDES:
            for scatter in SCATTERS:
                try:
                    found.append(optics(bsdf, scatter, side, band))
                except MissingDataError:
                    missing.append(f"the data have no {scatter} from the {side} in {band}")
    return tuple(found), tuple(missing)


def _visible(found: tuple[Optics, ...]) -> dict[str, float]:
    through = next(o for o in found if (o.band, o.scatter, o.side) == ("visible", "transmission", "exterior"))
    return {
        "tau_v_n-n": through.normal_normal,
        "tau_v_n-dif": through.normal_diffuse,
        "tau_v_dif-h": through.diffuse_hemispherical,
    }


def _rated(
    bsdf: Bsdf,
    name: str,
    found: tuple[Optics, ...],
    totals: dict[Position, dict[str, Total]],
    quantities: dict[str, float],
    limits: Edition,
    doubts: tuple[str, ...],
) -> Rated:
    return Rated(
        name or bsdf.metadata.name or "unnamed",
        found,
        cut_off(bsdf, band="visible"),
        totals,
        quantities,
        tuple(classify(quantities, limits)),
        doubts,
    )
