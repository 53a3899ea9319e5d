"""Samples from Python, without a recipe file: a function for each of the usual kinds.

A material is a table as recipes have it, such as ``{"kind": "metal", "colour": 0.8, "roughness": 0.1}``, or a number:
the reflectance of a Lambertian surface. A medium is a table, such as ``{"index": 1.49, "absorption_per_m": 2.0}``, or
a number: its refractive index. `load` makes a sample of every kind from tables.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from clerestory.trace.sample import Sample, load

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    Stuff = float | Mapping[str, Any]


def venetian_blind(
    *,
    width_mm: float,
    pitch_mm: float,
    tilt_deg: float = 0.0,
    crown_mm: float = 0.0,
    thickness_mm: float = 0.0,
    bead_mm: float = 0.0,
    upper: Stuff = 0.5,
    lower: Stuff | None = None,
    bands: Iterable[str] = ("visible",),
) -> Sample:
    """A venetian blind: slats along x, one above the other.

    Parameters
    ----------
    width_mm
        From edge to edge of a slat [mm].
    pitch_mm
        Distance from slat to slat [mm].
    tilt_deg
        Slat angle [°]: 0 level, positive with the outer edge below the inner one, ±90 closed.
    crown_mm
        Height of a slat's middle over its edges [mm]; negative for a hollow slat.
    thickness_mm
        Thickness of the slats [mm]; 0 for surfaces without thickness.
    bead_mm
        Diameter of beads along both edges [mm]; 0 for none.
    upper, lower
        Materials of the upper and the lower side (see the head of this module); lower is as upper by default.
    bands
        Names of the bands.

    Raises
    ------
    RecipeError
        Slats that cannot be, or that touch each other; the text names what and where.

    Examples
    --------
    >>> from clerestory import trace
    >>> blind = trace.venetian_blind(width_mm=80, pitch_mm=72, tilt_deg=30, upper=0.6)
    >>> blind.bands
    ['visible']
    """
    slat = {"width_mm": width_mm, "crown_mm": crown_mm, "thickness_mm": thickness_mm, "bead_mm": bead_mm}
    materials = {"upper": _material(upper)}
    if lower is not None:
        materials["lower"] = _material(lower)
    sample = {
        "kind": "venetian-blind",
        "pitch_mm": pitch_mm,
        "tilt_deg": tilt_deg,
        "slat": {**slat, **{name: name for name in materials}},
    }
    return _sample(sample, bands, materials)


def prismatic_film(
    *,
    pitch_um: float,
    lower_facet_deg: float,
    upper_facet_deg: float,
    base_um: float,
    medium: Stuff = 1.49,
    grooves: str = "interior",
    bands: Iterable[str] = ("visible",),
    wavelengths_nm: Iterable[float] | None = None,
) -> Sample:
    """A film of prisms along x.

    Parameters
    ----------
    pitch_um
        Distance from prism to prism [µm].
    lower_facet_deg, upper_facet_deg
        Angles of the facets below and above each ridge to the plane of the film [°], above 0 and below 90.
    base_um
        Thickness of the film under the grooves [µm].
    medium
        What it is made of (see the head of this module).
    grooves
        The side that the prisms are on: interior or exterior.
    bands, wavelengths_nm
        Names of the bands and their wavelengths [nm], which refractive indices by a formula need.

    Raises
    ------
    RecipeError
        Values that make no sense; the text names what and where.
    """
    sample = {
        "kind": "prismatic-film",
        "pitch_um": pitch_um,
        "lower_facet_deg": lower_facet_deg,
        "upper_facet_deg": upper_facet_deg,
        "base_um": base_um,
        "grooves": grooves,
        "medium": "body",
    }
    return _sample(sample, bands, {}, {"body": _medium(medium)}, wavelengths_nm)


def woven_fabric(
    *,
    weave: str,
    ends_per_cm: float,
    picks_per_cm: float,
    warp_thickness_mm: float,
    weft_thickness_mm: float,
    openness: float | None = None,
    warp_width_mm: float | None = None,
    weft_width_mm: float | None = None,
    yarn: Stuff = 0.3,
    bands: Iterable[str] = ("visible",),
) -> Sample:
    """A woven fabric, its warp upright.

    Parameters
    ----------
    weave
        plain, twill-2/1, twill-2/2, twill-3/1, basket-2/2, satin-5 or satin-8.
    ends_per_cm, picks_per_cm
        Yarns of warp and weft a centimetre.
    warp_thickness_mm, weft_thickness_mm
        Thickness of the yarns, across the fabric [mm].
    openness
        Open share of the area, seen along the normal; the widths that are left out are found so that it is met.
    warp_width_mm, weft_width_mm
        Widths of the yarns, in the fabric's plane [mm].
    yarn
        What the yarns' surface does with light (see the head of this module).
    bands
        Names of the bands.

    Raises
    ------
    RecipeError
        Yarns that touch, or an openness that no width gives.
    """
    warp = {"per_cm": ends_per_cm, "thickness_mm": warp_thickness_mm, "width_mm": warp_width_mm, "material": "yarn"}
    weft = {"per_cm": picks_per_cm, "thickness_mm": weft_thickness_mm, "width_mm": weft_width_mm, "material": "yarn"}
    sample = {"kind": "woven-fabric", "weave": weave, "openness": openness, "warp": _given(warp), "weft": _given(weft)}
    return _sample(_given(sample), bands, {"yarn": _material(yarn)})


def perforated_screen(
    *,
    pitch_mm: float,
    hole_mm: float | None = None,
    openness: float | None = None,
    thickness_mm: float = 0.0,
    pattern: str = "square",
    hole: str = "round",
    exterior: Stuff = 0.5,
    interior: Stuff | None = None,
    bands: Iterable[str] = ("visible",),
) -> Sample:
    """An opaque sheet with holes.

    Parameters
    ----------
    pitch_mm
        Distance of neighbouring holes [mm].
    hole_mm, openness
        Either the diameter or side of a hole [mm], or the open share of the area.
    thickness_mm
        Thickness of the sheet [mm].
    pattern
        square or triangular.
    hole
        round or square.
    exterior, interior
        Materials of the faces (see the head of this module); interior is as exterior by default.
    bands
        Names of the bands.

    Raises
    ------
    RecipeError
        Holes that touch each other.
    """
    materials = {"exterior": _material(exterior)}
    if interior is not None:
        materials["interior"] = _material(interior)
    sample = {
        "kind": "perforated-screen",
        "pitch_mm": pitch_mm,
        "hole_mm": hole_mm,
        "openness": openness,
        "thickness_mm": thickness_mm,
        "pattern": pattern,
        "hole": hole,
        **{name: name for name in materials},
    }
    return _sample(_given(sample), bands, materials)


def _sample(
    sample: dict[str, Any],
    bands: Iterable[str],
    materials: dict[str, Any],
    media: dict[str, Any] | None = None,
    wavelengths_nm: Iterable[float] | None = None,
) -> Sample:
    named: dict[str, Any] = {"names": list(bands)}
    if wavelengths_nm is not None:
        named["wavelengths_nm"] = list(wavelengths_nm)
    return load({"bands": named, "sample": sample, "materials": materials, "media": media or {}})


def _given(table: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value is not None}


def _material(stuff: Stuff) -> dict[str, Any]:
    return {"kind": "lambertian", "reflectance": stuff} if isinstance(stuff, (int, float)) else dict(stuff)


def _medium(stuff: Stuff) -> dict[str, Any]:
    return {"index": stuff} if isinstance(stuff, (int, float)) else dict(stuff)
