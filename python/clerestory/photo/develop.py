"""From a series of photographs to a map of luminance: everything in its order."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.photo import doubts
from clerestory.photo.colour import luminance_shares, primaries_of, to_radiance
from clerestory.photo.equipment import files_of, lens_assumptions, lens_of, response_of, view_of, vignetting_of
from clerestory.photo.exposure import Given, read_table
from clerestory.photo.illuminance import coverage, fill, illuminance, overflow
from clerestory.photo.merge import merge
from clerestory.photo.recover import fit, rounded_times, steps
from clerestory.photo.resample import resample
from clerestory.photo.samples import sample
from clerestory.photo.series import read_series
from clerestory.photo.spot import Spot, common_factor, read_spot
from clerestory.picture.image import Picture
from clerestory.trace.reading import reading

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from numpy.typing import NDArray

    from clerestory.photo.circle import Circle
    from clerestory.photo.illuminance import Overflow
    from clerestory.photo.lens import Lens
    from clerestory.photo.merge import Merged
    from clerestory.photo.recover import Step
    from clerestory.photo.response import Response
    from clerestory.photo.series import Series
    from clerestory.photo.session import CheckKeys, Session
    from clerestory.photo.spot import Reading
    from clerestory.photo.vignetting import Vignetting
    from clerestory.picture.view import View


@dataclass(frozen=True)
class Developed:
    """A map of luminance, and what is to be known of it."""

    picture: Picture
    series: Series
    response: Response
    steps: tuple[Step, ...]
    """Exposures beside the light in the pictures."""
    lens: Lens | None
    circle: Circle | None
    """Where the lens's circle was found, if it was not given."""
    vignetting: Vignetting | None
    factor: float
    """By which the luminances of a camera of nominal speed were multiplied."""
    calibration: str
    """spots, illuminance, factor, or none."""
    spots: tuple[Reading, ...]
    most: float
    """Luminance [cd/m²] of white that the series could just measure, on the axis of the lens."""
    least: float
    """Luminance [cd/m²] of grey that it could just measure, on the axis."""
    saturated_pixels: int
    """Of the photographs, too bright in all exposures."""
    dark_share: float
    """Of the pixels within the lens's view, too dark in all exposures."""
    ghost_share: float
    """Of the pixels within the lens's view where exposures contradict each other."""
    overflow: Overflow | None
    """What is too bright in all exposures."""
    illuminance: float | None
    """On the plane of the lens [lx], by the finished picture."""
    measured: float | None
    """The same by a meter [lx]."""
    difference_percent: float | None
    """Of the picture from the meter, before overflow is filled [%]."""
    acceptable: bool | None
    """Whether that is within the limit."""
    assumptions: tuple[str, ...]
    warnings: tuple[str, ...]


def develop(
    session: Session, folder: str | os.PathLike[str] = ".", progress: Callable[[float], object] | None = None
) -> Developed:
    """Make a map of luminance of a session.

    Parameters
    ----------
    session
        The pictures and what is known of them.
    folder
        Where the names of files begin.
    progress
        Called with the share that is done, 0 to 1.

    Raises
    ------
    ClerestoryError
        Something does not fit; the text names the file and the remedy.
    """
    base = Path(folder)
    tell = progress or (lambda _share: None)
    view = view_of(session.output)
    with reading("exposures"):
        exposures = None if session.exposures is None else read_table(base / session.exposures)
    given = Given(f_number=session.f_number, iso=session.iso)
    with reading("pictures"):
        series = read_series(files_of(session.pictures, base), exposures, given=given, times=session.times)
    vignetting = None if session.vignetting is None else vignetting_of(session.vignetting, base)
    lens, circle = lens_of(session.lens, base, series)
    assumptions, warnings = lens_assumptions(session.lens, circle), list(series.warnings)

    even = sample(series, lambda share: tell(0.2 * share))
    response = response_of(session.camera, base, series)
    if response is None:
        response = fit(even, session.camera.method)
        warnings += doubts.of_times(rounded_times(series, even))
    elif session.camera.encoding == "auto" and session.camera.response is None:
        assumptions.append("16-bit pictures are linear, as raw decoders write them (camera.encoding says otherwise)")
    found_steps = steps(series, even, response)
    warnings += doubts.of_steps(found_steps)
    if session.camera.primaries == "srgb":
        assumptions.append("the pictures are of sRGB")

    merged = merge(series, response, lambda share: tell(0.2 + 0.5 * share))
    light, within = _corrected(merged, lens, vignetting)
    if lens is not None:
        warnings += doubts.of_vignetting(vignetting, min(lens.edge_deg, 90.0))
    warnings += doubts.of_merged(merged, within)

    primaries = primaries_of(session.camera.primaries)
    shares = luminance_shares(primaries).astype(np.float32)
    spots = _readings(session, light @ shares, merged, lens)
    factor, how = 1.0 if session.calibration.factor is None else session.calibration.factor, "factor"
    if spots:
        factor, how = common_factor(spots), "spots"
        warnings += doubts.of_spots(spots, factor)
    elif session.calibration.factor is None:
        how = "none"

    laid = None
    if lens is not None:
        size = session.output.size_px
        layers = np.concatenate([light, merged.saturated[..., None].astype(np.float32)], axis=2)
        shown = resample(layers, lens, view, size, lambda share: tell(0.7 + 0.3 * share))
        warnings += doubts.of_coverage(coverage(lens, view, size, series.shape))
        laid = _measured(session.check, shown, shares, view, None if session.calibration.by_illuminance else factor)
        if session.calibration.by_illuminance:
            factor, how = laid.factor, "illuminance"
        warnings += laid.warnings
        assumptions += laid.assumptions
    if how == "none":
        warnings.append(doubts.UNCALIBRATED)
    burnt = None if laid is None else laid.overflow
    warnings += doubts.of_overflow(merged, burnt, factor)
    return Developed(
        picture=Picture(
            to_radiance(factor * light if laid is None else laid.seen, primaries),
            None if laid is None else view,
            header=_header(series, response, lens, vignetting, factor, how),
        ),
        series=series,
        response=response,
        steps=found_steps,
        lens=lens,
        circle=circle,
        vignetting=vignetting,
        factor=factor,
        calibration=how,
        spots=spots,
        most=factor * merged.most,
        least=factor * merged.least,
        saturated_pixels=int(merged.saturated.sum()),
        dark_share=float(merged.dark[within].mean()),
        ghost_share=float(merged.ghosts[within].mean()),
        overflow=burnt,
        illuminance=None if laid is None else laid.illuminance,
        measured=session.check.illuminance,
        difference_percent=None if laid is None else laid.difference,
        acceptable=None
        if laid is None or laid.difference is None
        else abs(laid.difference) <= session.check.limit_percent,
        assumptions=tuple(assumptions),
        warnings=tuple(warnings),
    )


def _corrected(
    merged: Merged, lens: Lens | None, vignetting: Vignetting | None
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Light (height, width, 3) with vignetting divided out, and which pixels the lens shows before it."""
    if lens is None:
        return merged.pixels, np.ones(merged.dark.shape, dtype=bool)
    thetas = lens.thetas(merged.dark.shape)
    ends = 90.0 if lens.projection == "perspective" else min(lens.edge_deg, 90.0)
    within = np.asarray(thetas <= np.radians(ends))
    if vignetting is None:
        return merged.pixels, within
    # Beyond a right angle nothing is used, and a polynomial knows nothing.
    passed = vignetting.at(np.nan_to_num(np.minimum(thetas, 0.5 * np.pi))).astype(np.float32)
    return np.divide(merged.pixels, passed[..., None], dtype=np.float32), within


def _readings(
    session: Session, luminance: NDArray[np.float32], merged: Merged, lens: Lens | None
) -> tuple[Reading, ...]:
    doubtful = merged.saturated | merged.dark | merged.between
    return tuple(
        read_spot(
            Spot(s.luminance, tuple(s.pixels or ()), tuple(s.direction_deg or ())),
            luminance,
            doubtful,
            lens,
        )
        for s in session.calibration.spots
    )


@dataclass(frozen=True)
class _LaidOut:
    """The picture in its view, calibrated."""

    seen: NDArray[np.float32]
    """Red, green and blue (height, width, 3) [cd/m²]."""
    factor: float
    illuminance: float
    """[lx]"""
    difference: float | None
    """From the measured illuminance, before overflow is filled [%]."""
    overflow: Overflow
    assumptions: list[str]
    warnings: list[str]


def _measured(
    check: CheckKeys, shown: NDArray[np.float32], shares: NDArray[np.float32], view: View, factor: float | None
) -> _LaidOut:
    """Calibrate what a view shows by a factor, or by the measured illuminance without one, and check it."""
    seen, brim = shown[..., :3], shown[..., 3]
    value, measured, difference = illuminance(seen @ shares, view), check.illuminance, None
    if factor is None:
        if measured is None or not value > 0.0:
            raise ClerestoryError("the pictures are black before the lens, and show no illuminance (check them)")
        factor, calibrated = measured / value, True
    else:
        calibrated = False
    seen, value = seen * np.float32(factor), factor * value
    assumptions: list[str] = []
    warnings: list[str] = []
    if measured is not None and not calibrated:
        difference = 100.0 * (value / measured - 1.0)
        warnings = doubts.of_difference(value, measured, difference, check.limit_percent)
    burnt = overflow(seen @ shares, brim, view)
    if check.fill_overflow and measured is not None:
        seen, text = fill(seen, brim, shares, view, measured)
        assumptions.append(text)
        value = illuminance(seen @ shares, view)
    return _LaidOut(seen, factor, value, difference, burnt, assumptions, warnings)


def _header(
    series: Series, response: Response, lens: Lens | None, vignetting: Vignetting | None, factor: float, how: str
) -> list[str]:
    """Lines that tell where the picture comes from."""
    first, last = series.photographs[0], series.photographs[-1]
    lines = [
        f"PHOTOGRAPHS= {len(series.photographs)} from {first.path.name} ({first.exposure.words}) "
        f"to {last.path.name} ({last.exposure.words})",
        f"RESPONSE= {response.method}",
        f"CALIBRATION= {how}, factor {factor:.6g}",
    ]
    if lens is not None:
        lines.append(f"LENS= {lens.words}")
    if vignetting is not None:
        lines.append(f"VIGNETTING= {vignetting.words}")
    return lines
