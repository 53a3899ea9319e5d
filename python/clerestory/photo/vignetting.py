"""How a lens darkens toward the rim, and its correction."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.photo.exposure import text_of

if TYPE_CHECKING:
    import os

    from numpy.typing import ArrayLike, NDArray

LEAST = 0.02
"""A lens that passes less than this share of its middle's light is no lens but a wrong curve."""


@dataclass(frozen=True)
class Vignetting:
    """Light that a lens passes at an angle from its axis, relative to that on the axis."""

    coefficients: tuple[float, ...] = ()
    """a, b, c of V(θ) = 1 + a θ² + b θ⁴ + c θ⁶, θ in radians."""
    table: tuple[tuple[float, float], ...] = ()
    """Pairs of θ [°] and V, interpolated, instead of a polynomial."""
    residual: float | None = None
    """Root mean square of V's misfit, if it was fitted to points."""
    reach_deg: float | None = None
    """Largest angle of the points that it comes from [°]; beyond it V is extrapolated."""

    def __post_init__(self) -> None:
        if bool(self.coefficients) == bool(self.table):
            raise ClerestoryError("vignetting is a polynomial or a table (give one of them)")
        with np.errstate(invalid="ignore"):
            values = self.at(np.radians(np.linspace(0.0, 90.0, 181)))
        if not (np.isfinite(values).all() and values.min() > LEAST and values.max() < 2.0):
            raise ClerestoryError(
                f"a vignetting from {values.min():.3g} to {values.max():.3g} over 0 to 90° is no lens's (give V "
                "relative to the axis, near 1 there, and θ in degrees; a polynomial is of radians)"
            )

    @classmethod
    def fit(cls, points: ArrayLike, degree: int = 6) -> Vignetting:
        """The polynomial through measured points, by least squares.

        Parameters
        ----------
        points
            Pairs (n, 2) of θ [°] and light relative to any fixed value.
        degree
            Highest power of θ: 2, 4 or 6.
        """
        theta, value = _checked(points)
        if degree not in (2, 4, 6):
            raise ClerestoryError(f"a degree of {degree} is not possible (give 2, 4 or 6)")
        if np.unique(theta).size < degree // 2 + 1:
            raise ClerestoryError(
                f"{np.unique(theta).size} angles do not determine a degree of {degree} (measure more, or lower it)"
            )
        radians = np.radians(theta)
        powers = radians[:, None] ** np.arange(0, degree + 1, 2)
        solved = np.linalg.lstsq(powers, value, rcond=None)[0]
        if solved[0] <= 0.0:
            raise ClerestoryError("the points say that no light comes along the axis (correct them)")
        misfit = powers @ solved / solved[0] - value / solved[0]
        return cls(
            coefficients=tuple(float(v) for v in solved[1:] / solved[0]),
            residual=float(np.sqrt(np.mean(misfit**2))),
            reach_deg=float(theta.max()),
        )

    @classmethod
    def through(cls, points: ArrayLike) -> Vignetting:
        """The table itself, straight between its points, relative to the one nearest to the axis."""
        theta, value = _checked(points)
        order = np.argsort(theta)
        pairs = zip(theta[order].tolist(), (value[order] / value[order][0]).tolist(), strict=True)
        return cls(table=tuple(pairs), reach_deg=float(theta.max()))

    def at(self, theta: ArrayLike) -> NDArray[np.float64]:
        """V at angles from the axis [rad]; beyond a table's last angle its last value."""
        t = np.asarray(theta, dtype=np.float64)
        if self.table:
            angles, values = zip(*self.table, strict=True)
            return np.asarray(np.interp(t, np.radians(angles), values))
        square = t**2
        made = np.zeros_like(square)
        for coefficient in reversed(self.coefficients):
            made = (made + coefficient) * square
        return 1.0 + made

    @property
    def words(self) -> str:
        """Such as V(θ) = 1 − 0.1 θ² + 0.02 θ⁴."""
        if self.table:
            return f"table of {len(self.table)} angles"
        terms = "".join(
            f" {'−' if c < 0 else '+'} {abs(c):.4g} θ{power}"
            for c, power in zip(self.coefficients, "²⁴⁶", strict=False)
        )
        return f"V(θ) = 1{terms}"


def _checked(points: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    p = np.asarray(points, dtype=np.float64)
    if p.ndim != 2 or p.shape[1] != 2 or len(p) < 2:
        raise ClerestoryError("points of vignetting are pairs of an angle and a value (give two or more)")
    if not np.isfinite(p).all() or (p[:, 0] < 0.0).any() or (p[:, 0] > 120.0).any() or (p[:, 1] <= 0.0).any():
        raise ClerestoryError("an angle is not from 0 to 120° or a value not above 0 (correct the points)")
    return p[:, 0], p[:, 1]


def read_points(path: str | os.PathLike[str], columns: tuple[str, str] = ("theta_deg", "value")) -> NDArray[np.float64]:
    """Pairs (n, 2) from a table of two columns; a head of words is passed over.

    Raises
    ------
    FileFormatError
        A line does not hold two numbers.
    """
    path = Path(path)
    rows: list[tuple[float, float]] = []
    reader = csv.reader(io.StringIO(text_of(path)))
    head = False
    for row in reader:
        cells = [cell.strip() for cell in row if cell.strip()]
        if not cells or cells[0].startswith("#"):
            continue
        try:
            first, second = (float(cell) for cell in cells)
        except ValueError:
            if not rows and not head:
                head = True
                continue
            raise FileFormatError(
                f"{path}: line {reader.line_num} is not two numbers (give {','.join(columns)})"
            ) from None
        rows.append((first, second))
    if len(rows) < 2:
        raise FileFormatError(f"{path}: holds fewer than two points (give {','.join(columns)}, a line each)")
    return np.array(rows)
