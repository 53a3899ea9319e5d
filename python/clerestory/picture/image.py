"""Pictures of radiances."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.files import named
from clerestory.picture.view import View
from clerestory.whole import write_whole

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

SUFFIXES = {".hdr": "rgbe", ".pic": "rgbe", ".xyze": "xyze", ".exr": "exr"}
"""What a name's end says of the format: Radiance's RGBE and XYZE, OpenEXR."""


class Picture:
    """Radiances of three channels [W/(m² sr)], row by row from the top, and what the picture shows.

    Parameters
    ----------
    pixels
        Red, green and blue (height, width, 3).
    view
        What the picture shows, if that is known.
    header
        Lines that a Radiance file keeps.
    primaries
        Chromaticities x and y of red, green, blue and white; Radiance's own by default.
    """

    def __init__(
        self,
        pixels: ArrayLike,
        view: View | None = None,
        *,
        header: Sequence[str] = (),
        primaries: Sequence[float] | None = None,
    ) -> None:
        self._core = _core.Picture(
            np.ascontiguousarray(pixels, dtype=np.float32),
            None if view is None else view._core,
            list(header),
            None if primaries is None else list(primaries),
        )
        self._view = view

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Picture:
        """Read a Radiance picture (RGBE or XYZE) or an OpenEXR file; they are told apart by their content.

        Exposures of the header are divided out. What was faulty but could be understood is in `warnings`.

        Raises
        ------
        FileFormatError
            The file is damaged; the text names file, place and remedy.
        OSError
            The file cannot be opened.
        """
        path = Path(path)
        data = path.read_bytes()
        with named(path):
            return cls._of(_core.Picture.from_bytes(data))

    @classmethod
    def _of(cls, core: _core.Picture) -> Picture:
        picture = cls.__new__(cls)
        picture._core = core
        picture._view = None
        return picture

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the picture, whole or not at all: .hdr or .pic (RGBE), .xyze (XYZE) or .exr (OpenEXR, 32 bits)."""
        path = Path(path)
        format_name = SUFFIXES.get(path.suffix.lower())
        if format_name is None:
            raise _core.ClerestoryError(
                f"{path}: the name does not tell the format (end it with {', '.join(SUFFIXES)})"
            )
        with named(path):
            data = self._core.to_bytes(format_name)
        write_whole(path, data)

    @cached_property
    def pixels(self) -> NDArray[np.float32]:
        """Red, green and blue (height, width, 3) [W/(m² sr)]."""
        return self._core.pixels()

    @cached_property
    def luminance(self) -> NDArray[np.float32]:
        """Luminance (height, width) [cd/m²], by the picture's primaries."""
        return self._core.luminance()

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width [pixels]."""
        return self._core.shape

    @property
    def view(self) -> View | None:
        """What the picture shows; None if it does not say.

        Raises
        ------
        ClerestoryError
            What it says makes no sense.
        """
        if self._view is None and self._core.view_options is not None:
            self._view = View(self._core.view_options)
        return self._view

    def with_view(self, view: View) -> Picture:
        """The same pixels with another view."""
        return Picture(self.pixels, view, header=self.header, primaries=self.primaries)

    @property
    def header(self) -> list[str]:
        """All lines of the file's header."""
        return self._core.header

    @property
    def exposure(self) -> float:
        """Product of the exposures in the header, by which the file's values were divided."""
        return self._core.exposure

    @property
    def primaries(self) -> list[float] | None:
        """Chromaticities x and y of red, green, blue and white, if the header gives them."""
        return self._core.primaries

    @property
    def pixel_aspect(self) -> float:
        """Height of a pixel over its width."""
        return self._core.pixel_aspect

    @property
    def warnings(self) -> list[str]:
        """What was faulty in the file but could be understood."""
        return self._core.warnings

    def luminance_at(self, column: int, row: int) -> float:
        """Luminance [cd/m²] of a pixel, counted from 0 from the left and from the top."""
        height, width = self.shape
        if not (0 <= column < width and 0 <= row < height):
            raise _core.ClerestoryError(
                f"the pixel {column}, {row} is outside of the picture of {width} × {height} (count from 0)"
            )
        return float(self.luminance[row, column])

    def mean_in_rectangle(self, columns: tuple[int, int], rows: tuple[int, int]) -> float:
        """Mean luminance [cd/m²] of the pixels from the first up to, not including, the second column and row."""
        part = self.luminance[slice(*rows), slice(*columns)]
        if min(*columns, *rows) < 0 or part.size == 0:
            raise _core.ClerestoryError(f"columns {columns} and rows {rows} hold no pixels (count from 0)")
        return float(part.mean(dtype=np.float64))

    def mean_in_cone(self, direction: ArrayLike, half_angle_deg: float) -> float:
        """Mean luminance [cd/m²], by solid angle, of the pixels with centres within a cone about a direction (3,)."""
        view = self.view
        if view is None:
            raise _core.MissingDataError("the picture does not say what it shows (give it a view by with_view)")
        height, width = self.shape
        axis = np.asarray(direction, dtype=np.float64)
        cosines = view.pixel_directions(width, height) @ (axis / np.linalg.norm(axis))
        inside = np.nan_to_num(cosines, nan=-2.0) >= np.cos(np.radians(half_angle_deg))
        weights = view.solid_angles(width, height)[inside]
        if weights.sum() <= 0.0:
            raise _core.ClerestoryError("no pixel of the picture lies in the cone (widen it, or turn it)")
        return float(np.average(self.luminance[inside], weights=weights))

    def __repr__(self) -> str:
        height, width = self.shape
        view = self._core.view_options
        return f"<Picture {width} × {height}{'' if view is None else f', {view}'}>"
