"""How well renderings agree with photographs over many cases."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.compare.statistics import outliers
from clerestory.photo.session import LIMIT_PERCENT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.compare.result import Outlier
    from clerestory.photo.cases import Found

LEAST_FOR_OUTLIERS = 8
"""With fewer cases none is called an outlier."""
_FLOORS = {"dgp": 0.01, "dgi": 0.5}
"""Least median deviation that is believed; of the logarithm of ratios, for all else, `_RELATIVE`."""
_RELATIVE = 0.05


@dataclass(frozen=True)
class Agreement:
    """Values of renderings beside those of photographs."""

    quantity: str
    """illuminance [lx], dgp, dgi, or luminance NAME [cd/m²]."""
    cases: tuple[str, ...]
    photo: tuple[float, ...]
    rendering: tuple[float, ...]
    correlation: float | None
    """Square of Pearson's correlation coefficient: R² of a regression line, whatever its slope. None where one side
    does not vary, or with fewer than three cases."""
    determination: float | None
    """1 − Σ (rendering − photo)²/Σ (photo − mean photo)²: R² about the line of equality, which may be negative."""
    slope: float | None
    """Of the regression of renderings on photographs."""
    intercept: float | None
    bias: float
    """Mean of rendering − photo."""
    rmse: float
    """Root mean square of rendering − photo."""
    mean: float
    """Of the photographs."""
    outliers: tuple[Outlier, ...]
    """Cases whose difference stands apart from the others; for luminance and illuminance that of logarithms."""

    @property
    def count(self) -> int:
        """Number of cases."""
        return len(self.cases)


@dataclass(frozen=True)
class Check:
    """Photographs beside a meter."""

    count: int
    bias: float
    """Mean of photograph − meter [lx]."""
    rmse: float
    """[lx]"""
    rejected: tuple[tuple[str, float], ...]
    """Cases beyond the limit, with their difference [%]; they are left out of all else."""
    limit_percent: float


@dataclass(frozen=True)
class PhotoComparison:
    """Many cases together."""

    found: tuple[Found, ...]
    """All cases, those that were rejected too."""
    agreements: tuple[Agreement, ...]
    check: Check | None
    """None where no illuminance was measured."""
    warnings: tuple[str, ...]


def compare_cases(found: Sequence[Found], *, limit_percent: float = LIMIT_PERCENT) -> PhotoComparison:
    """Agreement of all quantities over the cases whose photographs hold what a meter has measured.

    Parameters
    ----------
    found
        What `evaluate_cases` gave.
    limit_percent
        Photographs whose illuminance is further from the measured one are left out.

    Raises
    ------
    ClerestoryError
        No case is left.
    """
    rejected = tuple(
        (f.case.name, f.difference_percent)
        for f in found
        if f.difference_percent is not None and abs(f.difference_percent) > limit_percent
    )
    kept = [f for f in found if f.case.name not in {name for name, _ in rejected}]
    if not kept:
        raise ClerestoryError(
            f"all {len(found)} photographs are more than {limit_percent:g} % off the measured illuminance (calibrate "
            "them anew)"
        )
    quantities = list(dict.fromkeys(name for f in kept for name in f.values))
    pairs = [(f, f.difference_percent) for f in found]
    measured = [(f.values["illuminance"][0], f.case.measured) for f, d in pairs if d is not None and f.case.measured]
    check = None
    if measured:
        a, b = np.array(measured).T
        check = Check(len(measured), float((a - b).mean()), _rms(a - b), rejected, limit_percent)
    return PhotoComparison(
        found=tuple(found),
        agreements=tuple(agreement(name, kept) for name in quantities),
        check=check,
        warnings=tuple(f"{f.case.name}: {text}" for f in found for text in f.warnings),
    )


def agreement(quantity: str, found: Sequence[Found]) -> Agreement:
    """Agreement of one quantity over the cases that hold it."""
    having = [f for f in found if quantity in f.values]
    names = tuple(f.case.name for f in having)
    x, y = np.array([f.values[quantity] for f in having], dtype=np.float64).T
    varies = len(x) >= 3 and np.ptp(x) > 0.0
    correlation = slope = intercept = None
    if varies and np.ptp(y) > 0.0:
        correlation = float(np.corrcoef(x, y)[0, 1] ** 2)
    if varies:
        slope, intercept = (float(v) for v in np.polyfit(x, y, 1))
    difference = y - x
    apart: tuple[Outlier, ...] = ()
    if len(x) >= LEAST_FOR_OUTLIERS:
        judged, floor = difference, _FLOORS.get(quantity, _RELATIVE)
        if quantity not in _FLOORS:
            judged = np.log(np.maximum(y, 1e-12) / np.maximum(x, 1e-12))
        apart = outliers(names, tuple(judged.tolist()), floor)
    return Agreement(
        quantity=quantity,
        cases=names,
        photo=tuple(x.tolist()),
        rendering=tuple(y.tolist()),
        correlation=correlation,
        determination=float(1.0 - (difference**2).sum() / ((x - x.mean()) ** 2).sum()) if varies else None,
        slope=slope,
        intercept=intercept,
        bias=float(difference.mean()),
        rmse=_rms(difference),
        mean=float(x.mean()),
        outliers=apart,
    )


def _rms(values: np.typing.NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2)))
