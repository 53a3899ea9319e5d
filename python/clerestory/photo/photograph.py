"""One photograph: what its file says of it, and its pixels.

JPEG and PNG are read by Pillow. TIFF is read by tifffile, because Pillow cuts 16 bits of three channels down to 8.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import FileFormatError, UnsupportedError
from clerestory.files import named
from clerestory.photo.exposure import USED, Camera, Exposure, Given, camera_of, exposure_of

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from numpy.typing import NDArray

    Levels = NDArray[np.uint8] | NDArray[np.uint16]

SUFFIXES = (".jpg", ".jpeg", ".png", ".tif", ".tiff")
RAW = (".cr2", ".cr3", ".nef", ".arw", ".dng", ".raf", ".orf", ".rw2")
ORIENTATION, EXIF = 274, 34665
# What turns rows and columns of a file into an upright picture, by EXIF's number.
_TURNS: dict[int, Callable[[Any], Any]] = {
    1: lambda p: p,
    2: lambda p: p[:, ::-1],
    3: lambda p: p[::-1, ::-1],
    4: lambda p: p[::-1],
    5: lambda p: p.transpose(1, 0, 2),
    6: lambda p: p.transpose(1, 0, 2)[:, ::-1],
    7: lambda p: p.transpose(1, 0, 2)[::-1, ::-1],
    8: lambda p: p.transpose(1, 0, 2)[::-1],
}


@dataclass(frozen=True)
class Photograph:
    """A photograph in a file."""

    path: Path
    exposure: Exposure
    camera: Camera
    shape: tuple[int, int]
    """Height and width of the upright picture [pixels]."""
    bits: int
    """Bits a channel: 8 or 16."""

    @classmethod
    def open(cls, path: str | os.PathLike[str], given: Given | None = None) -> Photograph:
        """Read what a file says of its picture.

        Parameters
        ----------
        path
            JPEG, PNG, or TIFF of 8 or 16 bits.
        given
            Settings that EXIF does not hold, or wrongly.

        Raises
        ------
        FileFormatError
            The file is no picture, or not of three channels of 8 or 16 bits.
        MissingDataError
            Neither the file nor `given` says the exposure.
        OSError
            The file cannot be opened.
        """
        path = Path(path)
        _check_suffix(path)
        with named(path):
            tags, (height, width), bits = _tiff_head(path) if _is_tiff(path) else _pillow_head(path)
            if _orientation(tags) >= 5:
                height, width = width, height
            return cls(path, exposure_of(tags, given or Given()), camera_of(tags), (height, width), bits)

    def levels(self) -> Levels:
        """Levels (height, width, 3) of the upright picture: 0 to 255, or to 65535 with 16 bits."""
        with named(self.path):
            if _is_tiff(self.path):
                tags, _, _ = _tiff_head(self.path)
                pixels = _tiff_pixels(self.path)
            else:
                tags, _, _ = _pillow_head(self.path)
                pixels = _pillow_pixels(self.path)
            made: Levels = np.ascontiguousarray(_TURNS[_orientation(tags)](pixels))
        return made


def _check_suffix(path: Path) -> None:
    suffix = path.suffix.lower()
    if suffix in RAW:
        raise UnsupportedError(
            f"{path}: a raw file is not decoded here (make a linear 16-bit TIFF of it, as `dcraw -4 -T` does)"
        )
    if suffix not in SUFFIXES:
        raise UnsupportedError(f"{path}: not a photograph by its name (give {', '.join(SUFFIXES)})")


def _is_tiff(path: Path) -> bool:
    return path.suffix.lower().startswith(".tif")


def _orientation(tags: dict[int, Any]) -> int:
    value = tags.get(ORIENTATION, 1)
    return int(value) if value in _TURNS else 1


def _pillow_head(path: Path) -> tuple[dict[int, Any], tuple[int, int], int]:
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            exif = image.getexif()
            tags = {**exif, **exif.get_ifd(EXIF)}
            mode, (width, height) = image.mode, image.size
    except UnidentifiedImageError:
        raise FileFormatError("not a picture, or a damaged one (give JPEG, PNG or TIFF)") from None
    with path.open("rb") as file:
        head = file.read(25)
    if head[:4] == b"\x89PNG" and head[24] > 8:  # the depth, of which Pillow keeps 8 bits
        raise UnsupportedError("a PNG of 16 bits would be cut to 8 (save it as a 16-bit TIFF)")
    if mode not in ("RGB", "RGBA"):
        raise FileFormatError(f"the picture is not of red, green and blue but of mode {mode} (save it as sRGB)")
    return tags, (height, width), 8


def _pillow_pixels(path: Path) -> NDArray[np.uint8]:
    from PIL import Image

    try:
        with Image.open(path) as image:
            return np.asarray(image.convert("RGB"))
    except (OSError, SyntaxError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise
        raise FileFormatError(f"the picture is damaged: {error} (copy it from the camera again)") from None


def _tiff_head(path: Path) -> tuple[dict[int, Any], tuple[int, int], int]:
    page: Any
    tifffile, page, file = _first_page(path)
    with file:
        tags: dict[int, Any] = {tag.code: tag.value for tag in page.tags}
        inner = tags.get(EXIF)
        if isinstance(inner, dict):
            names = {code: tifffile.TIFF.EXIF_TAGS[code] for code in USED}
            tags |= {code: inner[name] for code, name in names.items() if name in inner}
        if page.samplesperpixel not in (3, 4) or len(page.shape) != 3 or page.shape[-1] not in (3, 4):
            raise FileFormatError(f"the picture is not of red, green and blue but {page.shape} (save it as RGB)")
        if page.dtype not in (np.dtype(np.uint8), np.dtype(np.uint16)):
            raise FileFormatError(f"the levels are of the type {page.dtype} (save them as integers of 8 or 16 bits)")
        return tags, (int(page.shape[0]), int(page.shape[1])), 8 * int(page.dtype.itemsize)


def _tiff_pixels(path: Path) -> Levels:
    _, page, file = _first_page(path)
    with file:
        try:
            pixels: Levels = page.asarray()[..., :3]
        except Exception as error:
            if "imagecodecs" in str(error):
                raise UnsupportedError(
                    f"the compression {page.compression.name} of TIFF is not read (save it uncompressed or deflated)"
                ) from None
            raise FileFormatError(f"the picture is damaged: {error} (make it again)") from error
    return pixels


def _first_page(path: Path) -> tuple[Any, Any, Any]:
    import tifffile

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            file = tifffile.TiffFile(path)
            return tifffile, file.pages[0], file
    except (tifffile.TiffFileError, IndexError, ValueError) as error:
        raise FileFormatError(f"not a TIFF, or a damaged one: {error} (make it again)") from None
