"""What makes a developed picture doubtful, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.photo.illuminance import Overflow
    from clerestory.photo.merge import Merged
    from clerestory.photo.recover import Step
    from clerestory.photo.spot import Reading
    from clerestory.photo.vignetting import Vignetting

UNEVEN_STEP = 0.10
"""A step of exposure that the pictures contradict by more than this share is doubtful."""
MANY_GHOSTS = 0.01
"""Share of contradicting pixels above which something moved."""
MANY_DARK = 0.001
"""Share of pixels too dark in all exposures above which a longer one is asked for; fewer are of the lens's border."""
APART = 0.15
"""Spots whose factors differ by more than this share from the common one contradict each other."""
SEEN = 0.995
"""A picture with less than this share of the hemisphere, by cosine, misses light."""
SHORT_DEG = 10.0
"""Points of vignetting that end further from the edge of the lens than this leave much to extrapolation [°]."""
UNCALIBRATED = (
    "nothing calibrates the picture, so that its luminances are those of a camera of nominal speed, and may be off by "
    "half (give --spot, --factor or --illuminance with --calibrate-by-illuminance)"
)


def of_times(rounded: tuple[float, float] | None) -> list[str]:
    """Exposure times that EXIF seems to round; see `rounded_times`."""
    if rounded is None:
        return []
    return [
        f"the exposure times fit as thirds of a stop (misfit {100.0 * rounded[1]:.1f} %) better than as they are "
        f"written ({100.0 * rounded[0]:.1f} %), so EXIF seems to round them (give --times thirds)"
    ]


def of_vignetting(vignetting: Vignetting | None, edge_deg: float) -> list[str]:
    """Vignetting that is not known, or not as far as the lens sees."""
    if vignetting is None:
        return ["vignetting is not corrected, so that luminances toward the rim are low (give --vignetting)"]
    reach = vignetting.reach_deg
    if reach is None or reach >= edge_deg - SHORT_DEG:
        return []
    return [
        f"the points of the vignetting end at {reach:g}°, and it is extrapolated to {edge_deg:g}° (measure further)"
    ]


def of_spots(spots: Sequence[Reading], factor: float) -> list[str]:
    """Spots that contradict the others."""
    return [
        f"the spot at {r.spot.words} asks for a factor of {r.factor:.3g}, all spots together for {factor:.3g} (check "
        "the reading and the place)"
        for r in spots
        if abs(r.factor / factor - 1.0) > APART
    ]


def of_coverage(share: float) -> list[str]:
    """A lens that does not see the whole hemisphere."""
    if share >= SEEN:
        return []
    return [
        f"the pictures hold {100.0 * share:.0f} % of the hemisphere before the lens, by cosine, so that the "
        "illuminance and the glare miss the rest"
    ]


def of_difference(value: float, measured: float, difference: float, limit: float) -> list[str]:
    """An illuminance [lx] that is further off the measured one than a limit [%]."""
    if abs(difference) <= limit:
        return []
    return [
        f"the illuminance of the picture, {value:.0f} lx, is {difference:+.0f} % off the measured {measured:.0f} lx, "
        f"beyond {limit:g} %: do not use it before the cause is found"
    ]


def of_steps(found: Sequence[Step]) -> list[str]:
    """Exposures that the pictures contradict."""
    return [
        f"from {s.shorter} to {s.longer} the light grew {s.found:.3g}-fold, and not {s.given:.3g}-fold as their "
        "exposures say (did the daylight change? leave the odd picture out, or correct its exposure)"
        for s in found
        if s.spots and abs(s.deviation) > UNEVEN_STEP
    ]


def of_merged(merged: Merged, within: NDArray[np.bool_]) -> list[str]:
    """Pixels that contradict each other or are badly exposed, of those within the lens's view."""
    found = []
    ghosts = float(merged.ghosts[within].mean())
    if ghosts > MANY_GHOSTS:
        found.append(
            f"exposures contradict each other at {100.0 * ghosts:.1f} % of the pixels: something moved, the camera "
            "did, or the response is not the camera's (repeat the series, or recover the response)"
        )
    dark = float(merged.dark[within].mean())
    if dark > MANY_DARK:
        found.append(
            f"{100.0 * dark:.2g} % of the pixels are too dark in all exposures, and uncertain (add a longer exposure)"
        )
    between = int(merged.between[within].sum())
    if between:
        found.append(f"{between} pixels are too dark in one exposure and too bright in the next (take smaller steps)")
    return found


def of_overflow(merged: Merged, burnt: Overflow | None, factor: float) -> list[str]:
    """Pixels that are too bright in all exposures."""
    if not merged.saturated.any():
        return []
    rows, columns = np.nonzero(merged.saturated)
    place = f"about column {columns.mean():.0f} and row {rows.mean():.0f}"
    if burnt is not None and burnt.solid_angle > 0.0:
        place += f", {burnt.words}"
    return [
        f"{rows.size} pixels are too bright in all exposures ({place}): at the axis nothing above "
        f"{factor * merged.most:.3g} cd/m² could be measured, so that they, the illuminance and the glare are lower "
        "limits (add a shorter exposure or a grey filter)"
    ]
