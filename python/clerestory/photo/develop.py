"""From a series of photographs to a map of luminance: everything in its order."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.files import named
from clerestory.photo.circle import Circle, find_circle
from clerestory.photo.colour import luminance_shares, primaries_of, to_radiance
from clerestory.photo.exposure import Given, read_table
from clerestory.photo.illuminance import Overflow, coverage, fill, illuminance, overflow
from clerestory.photo.lens import Lens
from clerestory.photo.merge import merge
from clerestory.photo.recover import Step, fit, steps
from clerestory.photo.resample import resample
from clerestory.photo.response import Response
from clerestory.photo.samples import sample
from clerestory.photo.series import read_series
from clerestory.photo.spot import Reading, Spot, common_factor, read_spot
from clerestory.photo.vignetting import Vignetting, read_points
from clerestory.picture.image import Picture
from clerestory.picture.view import View

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from numpy.typing import NDArray

    from clerestory.photo.merge import Merged
    from clerestory.photo.series import Series
    from clerestory.photo.session import CameraKeys, LensKeys, OutputKeys, Session, VignettingKeys

UNEVEN_STEP = 0.10
"""A step of exposure that the pictures contradict by more than this share is doubtful."""
MANY_GHOSTS = 0.01
"""Share of contradicting pixels above which something moved."""
APART = 0.15
"""Spots whose factors differ by more than this share from the common one contradict each other."""
SEEN = 0.995
"""A picture with less than this share of the hemisphere, by cosine, misses light."""


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
    view = _view(session.output)
    exposures = None if session.exposures is None else read_table(base / session.exposures)
    given = Given(f_number=session.f_number, iso=session.iso)
    series = read_series(files_of(session.pictures, base), exposures, given=given, times=session.times)
    assumptions, warnings = [], list(series.warnings)

    vignetting = None if session.vignetting is None else _vignetting(session.vignetting, base)
    lens, circle = _lens(session.lens, base, series)
    assumptions += _lens_words(session.lens, circle)

    spots_of_light = sample(series, lambda share: tell(0.2 * share))
    response = _response(session.camera, base, series)
    if response is None:
        response = fit(spots_of_light, session.camera.method)
    elif session.camera.encoding == "auto" and session.camera.response is None:
        assumptions.append("16-bit pictures are linear, as raw decoders write them (camera.encoding says otherwise)")
    found_steps = steps(series, spots_of_light, response)
    warnings += _uneven(found_steps)

    merged = merge(series, response, lambda share: tell(0.2 + 0.5 * share))
    light = merged.pixels
    primaries = primaries_of(session.camera.primaries)
    if session.camera.primaries == "srgb":
        assumptions.append("the pictures are of sRGB")
    thetas = None if lens is None else lens.thetas(series.shape)
    if vignetting is not None and thetas is not None:
        # Beyond a right angle nothing is used, and a polynomial knows nothing.
        passed = vignetting.at(np.nan_to_num(np.minimum(thetas, 0.5 * np.pi))).astype(np.float32)
        light = np.divide(light, passed[..., None], dtype=np.float32)
    elif lens is not None:
        warnings.append("vignetting is not corrected, so that luminances toward the rim are low (give --vignetting)")
    within = np.ones(series.shape, dtype=bool) if thetas is None else np.asarray(thetas <= 0.5 * np.pi)
    warnings += _doubts(merged, within)

    luminance = (light @ luminance_shares(primaries).astype(np.float32)).astype(np.float32)
    spots = tuple(
        read_spot(
            Spot(s.luminance, tuple(s.pixels or ()), tuple(s.direction_deg or ())),
            luminance,
            merged.saturated | merged.dark | merged.between,
            lens,
        )
        for s in session.calibration.spots
    )
    factor, how = 1.0, "none"
    if spots:
        factor, how = common_factor(spots), "spots"
        warnings += [
            f"the spot at {r.spot.words} asks for a factor of {r.factor:.3g}, all spots together for {factor:.3g} "
            "(check the reading and the place)"
            for r in spots
            if abs(r.factor / factor - 1.0) > APART
        ]
    elif session.calibration.factor is not None:
        factor, how = session.calibration.factor, "factor"

    measured, difference, acceptable, value, burnt = session.check.illuminance, None, None, None, None
    if lens is None:
        made, shown = to_radiance(factor * light, primaries), None
    else:
        size = session.output.size_px
        layers = np.concatenate([light, merged.saturated[..., None].astype(np.float32)], axis=2)
        laid = resample(layers, lens, view, size, lambda share: tell(0.7 + 0.3 * share))
        seen, brim = laid[..., :3], laid[..., 3]
        del layers, laid
        shares = luminance_shares(primaries)
        part = coverage(lens, view, size, series.shape)
        if part < SEEN:
            warnings.append(
                f"the pictures hold {100.0 * part:.0f} % of the hemisphere before the lens, by cosine, so that the "
                "illuminance and the glare miss the rest"
            )
        value = illuminance(seen @ shares, view)
        if session.calibration.by_illuminance and measured is not None:
            if not value > 0.0:
                raise ClerestoryError("the picture is black before the lens, and cannot be made to shine (check it)")
            factor, how = measured / value, "illuminance"
        seen = seen * np.float32(factor)
        value *= factor
        burnt = overflow(seen @ shares, brim, view)
        if measured is not None and how != "illuminance":
            difference = 100.0 * (value / measured - 1.0)
            acceptable = abs(difference) <= session.check.limit_percent
            if not acceptable:
                warnings.append(
                    f"the illuminance of the picture, {value:.0f} lx, is {difference:+.0f} % off the measured "
                    f"{measured:.0f} lx, beyond {session.check.limit_percent:g} %: do not use it before the cause is "
                    "found"
                )
        if session.check.fill_overflow and measured is not None:
            seen, text = fill(seen, brim, shares, view, measured)
            assumptions.append(text)
            value = illuminance(seen @ shares, view)
        made, shown = to_radiance(seen, primaries), view
    if how == "none":
        warnings.append(
            "nothing calibrates the picture, so that its luminances are those of a camera of nominal speed, and may be "
            "off by half (give --spot, --factor or --illuminance with --calibrate-by-illuminance)"
        )
    if merged.saturated.any():
        warnings.append(_overflow_words(merged, burnt, factor))
    return Developed(
        picture=Picture(made, shown, header=_header(series, response, lens, vignetting, factor, how)),
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
        illuminance=value,
        measured=measured,
        difference_percent=difference,
        acceptable=acceptable,
        assumptions=tuple(assumptions),
        warnings=tuple(warnings),
    )


def files_of(patterns: list[str], base: Path) -> list[Path]:
    """The files that names and patterns stand for, each once.

    Raises
    ------
    ClerestoryError
        A pattern stands for none.
    """
    found: list[Path] = []
    for pattern in patterns:
        path = base / pattern
        # A name with brackets is a name, if there is such a file.
        plain = path.exists() or not any(mark in pattern for mark in "*?[")
        root = Path(path.anchor)
        matches = [path] if plain else sorted(root.glob(str(path.relative_to(root))))
        if not matches:
            raise ClerestoryError(f"{path}: stands for no file (check the pattern; it is relative to the session)")
        found += matches
    return list(dict.fromkeys(found))


def _view(output: OutputKeys) -> View:
    # Of 60° first, which every projection can have, so that it is the projection that is complained of.
    view = View("-vta -vh 60 -vv 60").updated(output.view)
    if view.projection not in "ah":
        raise ClerestoryError(
            f"output.view: a {view.projection_name} view is not made (give -vta for angular or -vth for hemispherical)"
        )
    if not {*view.size_deg} <= {60.0, 180.0}:
        raise ClerestoryError("output.view: the view is of 180° by 180°, as glare needs it (leave out -vh and -vv)")
    return view.updated("-vh 180 -vv 180")


def _vignetting(keys: VignettingKeys, base: Path) -> Vignetting:
    if keys.coefficients is not None:
        return Vignetting(coefficients=tuple(keys.coefficients))
    path = base / str(keys.points)
    points = read_points(path)
    with named(path):
        return Vignetting.fit(points, keys.degree) if keys.fit == "polynomial" else Vignetting.through(points)


def _lens(keys: LensKeys, base: Path, series: Series) -> tuple[Lens | None, Circle | None]:
    if keys.projection == "none":
        return None, None
    height, width = series.shape
    circle = None
    if keys.radius_px is None:
        longest = series.photographs[-1]
        with named(longest.path):
            circle = find_circle(longest.levels())
        centre, radius = circle.centre, circle.radius
    else:
        x, y = keys.centre_px or (0.5 * width, 0.5 * height)
        centre, radius = (x, y), keys.radius_px
    if not (0.0 <= centre[0] <= width and 0.0 <= centre[1] <= height):
        raise ClerestoryError(
            f"lens.centre_px: {centre[0]:g}, {centre[1]:g} is outside of the pictures of {width} × {height}"
            " (count from the upper left)"
        )
    edge = 0.5 * keys.field_deg
    if keys.table is not None:
        path = base / keys.table
        points = read_points(path, ("theta_deg", "radius"))
        with named(path):
            return Lens.of_table(points, centre, radius, edge), circle
    if keys.projection == "table":
        raise ClerestoryError("lens.table: is missing (name the file of the radii)")
    return Lens(keys.projection, centre, radius, edge), circle


def _lens_words(keys: LensKeys, circle: Circle | None) -> list[str]:
    if circle is None:
        return []
    words = [f"the circle of the lens is the one found, and {keys.field_deg:g}° wide"]
    if "projection" not in keys.model_fields_set:
        words.append("the lens is equisolid, as most fisheyes (lens.projection says otherwise)")
    return words


def _response(keys: CameraKeys, base: Path, series: Series) -> Response | None:
    """The response that is given; None where it is to be recovered."""
    if keys.response is not None:
        return Response.read(base / keys.response)
    if keys.encoding == "linear" or (keys.encoding == "auto" and series.bits == 16):
        return Response.linear()
    return None


def _uneven(found: tuple[Step, ...]) -> list[str]:
    return [
        f"from {s.shorter} to {s.longer} the light grew {s.found:.3g}-fold, and not {s.given:.3g}-fold as their "
        "exposures say (did the daylight change? leave the odd picture out, or correct its exposure)"
        for s in found
        if s.spots and abs(s.deviation) > UNEVEN_STEP
    ]


def _doubts(merged: Merged, within: NDArray[np.bool_]) -> list[str]:
    found = []
    ghosts = float(merged.ghosts[within].mean())
    if ghosts > MANY_GHOSTS:
        found.append(
            f"exposures contradict each other at {100.0 * ghosts:.1f} % of the pixels: something moved, or the camera "
            "did (repeat the series)"
        )
    dark = float(merged.dark[within].mean())
    if dark > 0.0:
        found.append(
            f"{100.0 * dark:.2g} % of the pixels are too dark in all exposures, and uncertain (add a longer exposure)"
        )
    between = int(merged.between[within].sum())
    if between:
        found.append(f"{between} pixels are too dark in one exposure and too bright in the next (take smaller steps)")
    return found


def _overflow_words(merged: Merged, burnt: Overflow | None, factor: float) -> str:
    rows, columns = np.nonzero(merged.saturated)
    place = f"about column {columns.mean():.0f} and row {rows.mean():.0f}"
    if burnt is not None and burnt.solid_angle > 0.0:
        place += f", {burnt.words}"
    return (
        f"{rows.size} pixels are too bright in all exposures ({place}): at the axis nothing above "
        f"{factor * merged.most:.3g} cd/m² could be measured, so that they, the illuminance and the glare are lower "
        "limits (add a shorter exposure or a grey filter)"
    )


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
