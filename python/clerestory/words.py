"""Where the light goes, in words: sides and up-vectors are the field's most expensive mistake."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import MissingDataError
from clerestory.directions import SCATTERS, SIDES, direction, outgoing_side
from clerestory.integrals import continued

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from clerestory.basis import Basis
    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side

ELEVATIONS_DEG = (0.0, 30.0, 50.0, 70.0)
STRAIGHT_DEG = 10.0
"""Half angle [°] of the cone about the continued direction that counts as straight."""
LEVEL_DEG = 5.0
"""Light within this angle [°] of the horizontal counts as level, neither upward nor downward."""

_SAMPLES = 4096
_MAINLY = 0.6
_NOTHING = 5e-4


@dataclass(frozen=True)
class Flow:
    """Where light from one direction goes."""

    band: str
    side: Side
    """Side of incidence."""
    scatter: Scatter
    elevation_deg: float
    """Height of the source above the horizon [°], straight before the façade."""
    total: float
    """Direct-hemispherical transmittance or reflectance."""
    upward: float
    """Share of the leaving light that goes up by more than `LEVEL_DEG`."""
    downward: float
    """Share that goes down by more than `LEVEL_DEG`."""
    right: float
    """Share that goes to the right by more than `LEVEL_DEG`, as seen from the room."""
    left: float
    """Share that goes to the left by more than `LEVEL_DEG`."""
    straight: float
    """Share within `STRAIGHT_DEG` of straight through, or of the mirrored direction."""
    by_reciprocity: bool
    """The data were answered by those of the other side."""
    words: str
    """All this as a sentence."""


def where_light_goes(
    bsdf: Bsdf,
    band: str | None = None,
    *,
    sides: Iterable[Side] = SIDES,
    scatters: Iterable[Scatter] = SCATTERS,
    elevations_deg: Sequence[float] = ELEVATIONS_DEG,
) -> list[Flow]:
    """Say where light from sources straight before the façade goes, from each side that has data.

    Parameters
    ----------
    band
        Name of a band; visible, or the first, by default.
    sides, scatters
        What to describe; what the data set does not hold is left out.
    elevations_deg
        Heights of the source above the horizon [°].

    Notes
    -----
    Shares are those of 4,096 low-discrepancy samples of the model, good to about one per cent.
    """
    name = band_name(bsdf, band)
    flows = []
    for side in sides:
        for scatter in scatters:
            try:
                _, by_reciprocity = bsdf.model(side, scatter, name)
            except MissingDataError:
                continue
            if by_reciprocity and (side, scatter) == ("interior", "transmission"):
                continue  # it would only say again what the exterior's data say
            flows += [_flow(bsdf, name, side, scatter, float(e), reciprocal=by_reciprocity) for e in elevations_deg]
    return flows


def band_name(bsdf: Bsdf, band: str | None = None) -> str:
    """Name of the band that `None` stands for, or of a band in any case of letters."""
    if band is None:
        return "visible" if "visible" in bsdf.bands else bsdf.bands[0]
    for name in bsdf.bands:
        if name.lower() == band.lower():
            return name
    raise MissingDataError(f"no band {band!r} (the data set has: {', '.join(bsdf.bands)})")


def common_band(sets: Mapping[str, Bsdf], band: str | None = None) -> str:
    """The one band that data sets are shown in: `band`, or visible, or the first that all of them hold.

    Raises
    ------
    MissingDataError
        None of them holds `band`, or they have none in common.
    """
    held = {label: [name.lower() for name in bsdf.bands] for label, bsdf in sets.items()}
    listed = "; ".join(f"{label}: {', '.join(names)}" if label else ", ".join(names) for label, names in held.items())
    if band is not None:
        if not any(band.lower() in names for names in held.values()):
            raise MissingDataError(f"no band {band!r} (there are: {listed})")
        return band.lower()
    common = [b for b in ("visible", *next(iter(held.values()))) if all(b in names for names in held.values())]
    if not common:
        raise MissingDataError(f"the data sets have no band in common (there are: {listed}; choose one)")
    return common[0]


def _flow(
    bsdf: Bsdf,
    band: str,
    side: Side,
    scatter: Scatter,
    elevation_deg: float,
    *,
    reciprocal: bool,
) -> Flow:
    incident = direction(abs(elevation_deg), 90.0 if elevation_deg >= 0.0 else 270.0, side=side)
    samples = bsdf.sample(np.broadcast_to(incident, (_SAMPLES, 3)), _numbers(), band, scatter=scatter)
    weights = samples.weights
    total = float(bsdf.integrate(incident, scatter, band=band))
    power = float(weights.sum())

    def share(chosen: NDArray[np.bool_]) -> float:
        return float(weights[chosen].sum()) / power if power > 0.0 else 0.0

    d = samples.outgoing
    level = np.sin(np.radians(LEVEL_DEG))
    flow = {
        "upward": share(d[:, 1] > level),
        "downward": share(d[:, 1] < -level),
        "right": share(d[:, 0] > level),
        "left": share(d[:, 0] < -level),
        "straight": share(d @ continued(incident, scatter) > np.cos(np.radians(STRAIGHT_DEG))),
    }
    words = _sentence(side, scatter, elevation_deg, total, flow, reciprocal=reciprocal)
    return Flow(band, side, scatter, elevation_deg, total, by_reciprocity=reciprocal, words=words, **flow)


def _sentence(
    side: Side, scatter: Scatter, elevation_deg: float, total: float, flow: dict[str, float], *, reciprocal: bool
) -> str:
    if elevation_deg == 0.0:
        source = "level"
    else:
        source = f"{abs(elevation_deg):g}° {'above' if elevation_deg > 0.0 else 'below'} the horizon"
    start = f"Light from the {side}, {source}"
    verb = "passes" if scatter == "transmission" else "is reflected"
    if total < _NOTHING:
        return f"{start}: nothing {verb}."
    target = "into the room" if outgoing_side(side, scatter) == "interior" else "to the outside"
    straight = "straight through" if scatter == "transmission" else "the mirrored direction"
    return (
        f"{start}: {percent(total)} {verb}, {_heading(flow, target)}; "
        f"{percent(flow['straight'])} of it within {STRAIGHT_DEG:g}° of {straight}"
        f"{' (by reciprocity, from the data of the other side)' if reciprocal else ''}."
    )


def _heading(flow: dict[str, float], target: str) -> str:
    up, down = flow["upward"], flow["downward"]
    level = 1.0 - up - down
    name, most = max((("upward", up), ("downward", down), ("level", level)), key=lambda pair: pair[1])
    if most >= _MAINLY:
        text = f"mainly {name} {target} ({percent(most)} of it)"
    elif abs(up - down) < 0.1:
        text = f"upward and downward alike {target}"
    else:
        first, second = ("upward", "downward") if up > down else ("downward", "upward")
        text = f"{first} ({percent(flow[first])}) and {second} ({percent(flow[second])}) {target}"
    sideways, share = max((("right", flow["right"]), ("left", flow["left"])), key=lambda pair: pair[1])
    if share >= _MAINLY:
        text += f", to the {sideways} ({percent(share)} of it)"
    return text


def percent(fraction: float) -> str:
    """A share in per cent with two digits or so."""
    value = 100.0 * fraction
    if value == 0.0:
        return "0 %"
    return f"{value:.0f} %" if abs(value) >= 10.0 else f"{value:.1f} %" if abs(value) >= 0.1 else f"{value:.2g} %"


def patch_name(basis: Basis, index: int) -> str:
    """A patch by basis and number, as people count: "Klems 41" for index 40 of Klems full."""
    short = basis.name.removeprefix("LBNL/")
    return f"{'Klems' if short == 'Klems Full' else short} {index + 1}"


def _numbers() -> NDArray[np.float64]:
    """The R2 sequence (Roberts 2018): pairs that fill the unit square evenly."""
    golden = 1.32471795724474602596
    k = np.arange(_SAMPLES)[:, None]
    return np.asarray((0.5 + k * np.array([1.0 / golden, 1.0 / golden**2])) % 1.0)
