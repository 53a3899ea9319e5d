"""What the scene files of a room hold: shapes, materials, lights, windows, suns and skies, as they are written."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from clerestory import _core
from clerestory.trace.kinds.radiance import Found

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    import numpy as np
    from numpy.typing import NDArray

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "inch": 0.0254, "foot": 0.3048}
"""Metres that a length of 1 in a file can be."""

Vector = tuple[float, float, float]
Rgb = tuple[float, float, float]


@dataclass(frozen=True)
class Polygon:
    """A flat object."""

    name: str
    """Name of the object."""
    surface: str
    """Name of its surface."""
    corners: NDArray[np.float64]
    """Corners (n, 3) [m], counter-clockwise as seen from its front; a hole is joined to the outside by a seam."""


@dataclass(frozen=True)
class Light:
    """A surface that shines from its front."""

    surface: str
    kind: Literal["light", "glow", "spotlight", "illum"]
    radiance: Rgb
    """[W/(m² sr)] in Radiance's three channels."""
    reach: float | None
    """Of a `glow`: distance [m] up to which it counts as a lamp; 0 for never."""
    cone_deg: float | None
    """Of a `spotlight`: full angle [°]."""
    axis: Vector | None
    """Of a `spotlight`: where it points; its length is the distance of the focus [m]."""


@dataclass(frozen=True)
class DataSet:
    """A surface that scatters like a data set."""

    surface: str
    file: str
    """The XML file as it is named."""
    path: Path | None
    """Where it was found; None where it was not, which is among the warnings."""
    thickness: float
    """[m]; geometry within it is seen in place of the data set, where it is not 0."""
    up: Vector
    """Upward direction, of any length."""
    peaks: bool
    """Light that goes straight through is taken out of the table as a beam (`aBSDF`)."""
    added: tuple[Rgb, Rgb, Rgb]
    """Reflectance of the front, of the back, and transmittance that are added as even scattering."""


@dataclass(frozen=True)
class Source:
    """What shines from far away: the sun, or a sky or ground."""

    name: str
    direction: Vector
    """Unit vector toward it."""
    angle_deg: float
    """Full angle [°]."""
    kind: Literal["light", "glow"]
    material: str
    radiance: Rgb
    """[W/(m² sr)], by which that of the sky is multiplied if it has one."""
    sky: int | None
    """Index of the sky that is its pattern."""
    place: str
    """File and line."""


@dataclass(frozen=True)
class Sky:
    """A formula of a sky with its numbers, or a command line that makes one.

    `values` by kind, directions before the turn:

    * `cie`: sky (clear, overcast, uniform, intermediate), zenith, ground [W/(m² sr)], divisor, sun (unit vector);
    * `perez`: factor, ground [W/(m² sr)], coefficients (a to e), sun (unit vector);
    * `gensky`, `gendaylit`: the options of the command line, also those it does not name.
    """

    name: str
    kind: Literal["cie", "perez", "gensky", "gendaylit"]
    values: Mapping[str, Any]
    turn_deg: float
    """It is turned by this about the vertical [°], counter-clockwise as seen from above."""
    place: str
    """File and line."""


@dataclass(frozen=True)
class RoomScene:
    """What the files of a room hold."""

    shapes: _core.Scene
    """All shapes, with those that shine or scatter like a data set."""
    surfaces: tuple[str, ...]
    """Names of the surfaces, one a material in use."""
    materials: tuple[Found, ...]
    """Material of each surface."""
    objects: tuple[str, ...]
    """Names of the objects."""
    elements: NDArray[np.uint32]
    """Object of each shape (n); a polygon has several, its triangles."""
    polygons: tuple[Polygon, ...]
    lights: tuple[Light, ...]
    data_sets: tuple[DataSet, ...]
    sources: tuple[Source, ...]
    skies: tuple[Sky, ...]
    warnings: tuple[str, ...]
    """What was odd but harmless."""

    @classmethod
    def read(
        cls,
        files: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
        *,
        unit: Literal["m", "cm", "mm", "inch", "foot"] = "m",
        search: Iterable[str | os.PathLike[str]] = (),
    ) -> RoomScene:
        """Read Radiance scene files, one after the other as one scene, or an OBJ file with its material libraries.

        Parameters
        ----------
        files
            One or several; materials of an earlier one hold for the later ones.
        unit
            What a length of 1 in the files is.
        search
            Folders in which files are looked for that are not beside the one that names them.

        Raises
        ------
        ClerestoryError
            Something in the files is faulty, or nothing that a room can have; file and line are in the text.
        OSError
            A file, or one that it names, cannot be read.
        """
        paths = [files] if isinstance(files, str | os.PathLike) else list(files)
        parts = _core.read_room_scene(paths, UNITS[unit], list(search))
        scene: _core.Scene = parts["scene"]
        surfaces, objects = tuple(scene.surfaces), tuple(parts["objects"])

        def named(part: dict[str, Any]) -> dict[str, Any]:
            return part | {"surface": surfaces[part["surface"]]}

        return cls(
            shapes=scene,
            surfaces=surfaces,
            materials=tuple(Found(*row) for row in scene.materials()),
            objects=objects,
            elements=parts["elements"],
            polygons=tuple(
                Polygon(objects[p["object"]], surfaces[p["surface"]], p["corners"]) for p in parts["polygons"]
            ),
            lights=tuple(Light(**named(part)) for part in parts["lights"]),
            data_sets=tuple(DataSet(**named(part)) for part in parts["data_sets"]),
            sources=tuple(Source(**part) for part in parts["sources"]),
            skies=tuple(Sky(**part) for part in parts["skies"]),
            warnings=tuple(scene.warnings),
        )

    def bounds(self) -> tuple[Vector, Vector] | None:
        """Least and greatest x, y, z of all shapes [m]; None of an empty scene."""
        bounds = self.shapes.bounds()
        if bounds is None:
            return None
        low, high = ((p[0], p[1], p[2]) for p in bounds)
        return low, high
