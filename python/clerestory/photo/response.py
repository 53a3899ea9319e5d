"""What the levels of a camera say of light: its response, recovered once and kept in a file."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.photo.exposure import text_of
from clerestory.whole import write_whole

if TYPE_CHECKING:
    import os

    from numpy.typing import ArrayLike, NDArray

Method = Literal["debevec", "mitsunaga", "linear", "file"]

LEVELS = 256
LOWEST, HIGHEST = 5, 250
"""Levels of 255 below and above which a picture of a camera says nothing reliable."""
NEUTRAL = slice(64, 193)
"""Levels over which the means of the channels' curves are made equal: a grey of the camera stays grey."""


@dataclass(frozen=True)
class Response:
    """Light on the sensor by level, per channel, relative to that of the highest level of green.

    Parameters
    ----------
    curves
        Light (3, 256) at the levels 0 to 255 of red, green and blue: not negative and not falling.
    method
        How it was found.
    residual
        Root mean square of the relative misfit of the samples that it was found from; None if it was not.
    """

    curves: NDArray[np.float64]
    method: Method
    residual: float | None = None

    def __post_init__(self) -> None:
        curves = np.asarray(self.curves, dtype=np.float64)
        if curves.shape != (3, LEVELS) or not np.isfinite(curves).all():
            raise ClerestoryError(f"a response of the shape {curves.shape} does not fit (give 3 × {LEVELS} numbers)")
        if (curves < 0.0).any() or (np.diff(curves, axis=1) < 0.0).any() or (curves[:, HIGHEST] <= 0.0).any():
            raise ClerestoryError("a response falls, or is negative (recover it from a better series)")
        object.__setattr__(self, "curves", curves)

    @classmethod
    def linear(cls) -> Response:
        """Of a raw decoder: light in proportion to level."""
        return cls(np.tile(np.arange(LEVELS) / (LEVELS - 1.0), (3, 1)), "linear")

    @property
    def is_linear(self) -> bool:
        """Whether light is taken to be proportional to level."""
        return self.method == "linear"

    def table(self, bits: int) -> NDArray[np.float32]:
        """Light (3, 2^bits) at each level of a file of 8 or 16 bits; between the 256 levels it is interpolated."""
        places = np.arange(2**bits) * ((LEVELS - 1.0) / (2**bits - 1.0))
        if self.is_linear:
            return np.tile((places / (LEVELS - 1.0)).astype(np.float32), (3, 1))
        return np.stack([np.interp(places, np.arange(LEVELS), c) for c in self.curves]).astype(np.float32)

    @cached_property
    def logarithms(self) -> NDArray[np.float64]:
        """Natural logarithms (3, 256) of the light; −∞ where there is none."""
        with np.errstate(divide="ignore"):
            return np.log(self.curves)

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Response:
        """Read a response: JSON of Clerestory, or the polynomials of hdrgen (.rsp).

        Raises
        ------
        FileFormatError
            The file holds no response.
        OSError
            It cannot be opened.
        """
        path = Path(path)
        text = text_of(path)
        try:
            curves = _polynomials(text) if path.suffix.lower() == ".rsp" else _json(text)
            return cls(curves, "file")
        except ClerestoryError as error:
            raise FileFormatError(f"{path}: {error}") from None

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the response as JSON, whole or not at all."""
        path = Path(path)
        if path.suffix.lower() != ".json":
            raise ClerestoryError(f"{path}: a response is written as JSON (end the name with .json)")
        value = {
            "format": "clerestory response 1",
            "method": self.method,
            "residual": self.residual,
            **{name: [float(f"{v:.7g}") for v in c] for name, c in zip(_CHANNELS, self.curves, strict=True)},
        }
        write_whole(path, (json.dumps(value, indent=1) + "\n").encode())


_CHANNELS = ("red", "green", "blue")


def normalised(logarithms: ArrayLike) -> NDArray[np.float64]:
    """Curves (3, 256) of light from logarithms (3, 256) of which each has a constant of its own.

    A series cannot tell how sensitive one channel is beside another. The means over `NEUTRAL` are made equal, since
    what the camera shows grey is taken to be neutral, and green is 1 at the highest level.
    """
    g = np.array(logarithms, dtype=np.float64)
    g -= g[:, NEUTRAL].mean(axis=1, keepdims=True)
    # What noise let fall is made level.
    light = np.maximum.accumulate(np.exp(g - g[1, -1]), axis=1)
    return np.asarray(light / light[1, -1])


def _json(text: str) -> NDArray[np.float64]:
    try:
        value = json.loads(text)
        curves = np.array([value[name] for name in _CHANNELS], dtype=np.float64)
    except (ValueError, KeyError, TypeError):
        raise ClerestoryError(
            "not a response: JSON with lists red, green and blue is asked for (write one by --save-response)"
        ) from None
    return curves


def _polynomials(text: str) -> NDArray[np.float64]:
    """Curves from hdrgen's file: for each channel a line with the degree and the coefficients, the highest first.

    They are of x = (level + 1/2)/256. Where a polynomial ceases to be positive and to rise toward the dark, it is
    continued by a line through zero, as that program does.
    """
    rows = [line.split() for line in text.splitlines() if line.strip()]
    try:
        numbers = [[float(word) for word in row] for row in rows]
    except ValueError:
        numbers = []
    if len(numbers) != 3 or any(len(row) < 3 or row[0] != len(row) - 2 for row in numbers):
        raise ClerestoryError("not a response of hdrgen: three lines with a degree and its coefficients are asked for")
    x = (np.arange(LEVELS) + 0.5) / LEVELS
    curves = []
    for row in numbers:
        if not all(math.isfinite(v) for v in row):
            raise ClerestoryError("a coefficient is not finite (write the file again)")
        value, slope = np.polyval(row[1:], x), np.polyval(np.polyder(row[1:]), x)
        good = (value > 0.0) & (slope > 0.0)
        toe = int(LEVELS - np.argmin(good[::-1])) if not good.all() else 0
        if toe > LEVELS // 2:
            raise ClerestoryError("the polynomial of a channel does not rise (recover it from a better series)")
        value[:toe] = value[toe] * x[:toe] / x[toe]
        curves.append(value)
    made = np.array(curves)
    return np.asarray(made / made[1, -1])
