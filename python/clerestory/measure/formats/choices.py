"""What a person says of a file where it is silent: its sample, the lit side, the light's azimuth, the scatter."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING, cast

from clerestory._core import ClerestoryError
from clerestory.directions import SCATTERS, SIDES
from clerestory.measure.scan import QUANTITIES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Quantity

CHOICES: dict[str, str] = {
    "sample": "its name",
    "side": "exterior or interior, which the light comes from",
    "scatter": "transmission or reflection",
    "quantity": "bsdf, dsf or signal",
    "incident_theta_deg": "the incident angle",
    "incident_phi_deg": "the azimuth of the source",
    "convention": "a laboratory's, by its name",
    "front": "exterior or interior, which the file calls front",
    "seen_from": "exterior or interior, from where azimuths run counter-clockwise",
    "up_deg": "the file's azimuth of the sample's up",
    "angles": "degrees or radians",
    "columns": "the file's names of columns by ours",
}
"""What can be said, by the names that readers ask for."""

ABOVE_DEG = 90.0
"""Azimuth [°] of light from above, which the plane of incidence is taken to hold where a file gives none."""


def lit_side(choices: Mapping[str, object]) -> Side:
    """The side that the light comes from, or that a file's front is."""
    return cast("Side", one_of(choices, "side", SIDES, SIDES[0]))


def scatter_of(choices: Mapping[str, object]) -> Scatter | None:
    """Whether the scatter is transmission or reflection, if it is said."""
    return cast("Scatter | None", one_of(choices, "scatter", SCATTERS, None))


def quantity_of(choices: Mapping[str, object], default: Quantity) -> Quantity:
    """What the values are."""
    return cast("Quantity", one_of(choices, "quantity", QUANTITIES, default))


def sample_of(choices: Mapping[str, object], name: str, stated: str = "") -> str:
    """Name of the sample: as said, as the file states it, or else the file's own name without its suffix."""
    said = choices.get("sample")
    return str(said) if said else stated.strip() or PurePath(name).stem or "sample"


def angle_of(choices: Mapping[str, object], key: str, default: float | None) -> float | None:
    """An angle [°] that is said.

    Raises
    ------
    ClerestoryError
        It is no number.
    """
    said = choices.get(key)
    if said is None:
        return default
    if not isinstance(said, (int, float)) or not abs(said) <= 360.0:
        raise ClerestoryError(f"{key} {said!r} is not an angle (give degrees)")
    return float(said)


def one_of(choices: Mapping[str, object], key: str, known: tuple[str, ...], default: str | None) -> str | None:
    """One of some words that is said, or what stands for silence."""
    said = choices.get(key)
    if said is None:
        return default
    if said not in known:
        raise ClerestoryError(f"{key} {said!r} is not known ({', '.join(known)})")
    return str(said)


def columns_said(choices: Mapping[str, object]) -> dict[str, str]:
    """What a person said of columns: our names by the file's.

    Raises
    ------
    ClerestoryError
        It is no table of names.
    """
    given = choices.get("columns") or {}
    if not isinstance(given, dict):
        raise ClerestoryError("columns is not a table of names (give {'theta_o': 'Winkel', ...})")
    several = {role: held if isinstance(held, (list, tuple)) else [held] for role, held in given.items()}
    return {str(header): str(role) for role, headers in several.items() for header in headers}
