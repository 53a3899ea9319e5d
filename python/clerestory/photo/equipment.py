"""What a session names: its files, view, lens, vignetting and response."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from clerestory._core import ClerestoryError
from clerestory.files import named
from clerestory.photo.circle import Circle, find_circle
from clerestory.photo.lens import Lens
from clerestory.photo.photograph import SUFFIXES
from clerestory.photo.response import Response
from clerestory.photo.vignetting import Vignetting, read_points
from clerestory.picture.view import View
from clerestory.trace.reading import reading

if TYPE_CHECKING:
    from clerestory.photo.series import Series
    from clerestory.photo.session import CameraKeys, LensKeys, OutputKeys, VignettingKeys


def files_of(patterns: list[str], base: Path) -> list[Path]:
    """The files that names, folders and patterns stand for, each once.

    Raises
    ------
    ClerestoryError
        A pattern or a folder stands for none.
    """
    found: list[Path] = []
    for pattern in patterns:
        path = base / pattern
        if path.is_dir():
            matches = sorted(p for p in path.iterdir() if p.suffix.lower() in SUFFIXES)
            if not matches:
                raise ClerestoryError(f"{path}: the folder holds no photographs (give {', '.join(SUFFIXES)})")
            found += matches
            continue
        # A name with brackets is a name, if there is such a file.
        plain = path.exists() or not any(mark in pattern for mark in "*?[")
        root = Path(path.anchor)
        matches = [path] if plain else sorted(root.glob(str(path.relative_to(root))))
        if not matches:
            raise ClerestoryError(f"{path}: stands for no file (check the pattern; it is relative to the session)")
        found += matches
    return list(dict.fromkeys(found))


def view_of(output: OutputKeys) -> View:
    """The view that is made: a fisheye of 180°.

    Raises
    ------
    ClerestoryError
        Another is asked for.
    """
    # Of 60° first, which every projection can have, so that it is the projection that is complained of.
    view = View("-vta -vh 60 -vv 60").updated(output.view)
    if view.projection not in "ah":
        raise ClerestoryError(
            f"output.view: a {view.projection_name} view is not made (give -vta for angular or -vth for hemispherical)"
        )
    if {"-vh", "-vv"} & {*output.view.split()} and view.size_deg != (180.0, 180.0):
        raise ClerestoryError("output.view: the view is of 180° by 180°, as glare needs it (leave out -vh and -vv)")
    return view.updated("-vh 180 -vv 180")


def vignetting_of(keys: VignettingKeys, base: Path) -> Vignetting:
    """The vignetting that is given, or fitted to points of a file."""
    if keys.coefficients is not None:
        return Vignetting(coefficients=tuple(keys.coefficients))
    path = base / str(keys.points)
    with reading("vignetting.points"), named(path):
        points = read_points(path)
        return Vignetting.fit(points, keys.degree) if keys.fit == "polynomial" else Vignetting.through(points)


def lens_of(keys: LensKeys, base: Path, series: Series) -> tuple[Lens | None, Circle | None]:
    """The lens, if there is one, and its circle, if that had to be found.

    Raises
    ------
    ClerestoryError
        No circle is found, or what is given does not fit the pictures.
    """
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
        with reading("lens.table"), named(path):
            points = read_points(path, ("theta_deg", "radius"))
            return Lens.of_table(points, centre, radius, edge), circle
    if keys.projection == "table":
        raise ClerestoryError("lens.table: is missing (name the file of the radii)")
    return Lens(keys.projection, centre, radius, edge), circle


def lens_assumptions(keys: LensKeys, circle: Circle | None) -> list[str]:
    """What nobody has said of the lens."""
    if circle is None:
        return []
    words = [f"the circle of the lens is the one found, and {keys.field_deg:g}° wide"]
    if "projection" not in keys.model_fields_set:
        words.append("the lens is equisolid, as most fisheyes (lens.projection says otherwise)")
    return words


def response_of(keys: CameraKeys, base: Path, series: Series) -> Response | None:
    """The response that is given; None where it is to be recovered."""
    if keys.response is not None:
        with reading("camera.response"):
            return Response.read(base / keys.response)
    if keys.encoding == "linear" or (keys.encoding == "auto" and series.bits == 16):
        return Response.linear()
    return None
