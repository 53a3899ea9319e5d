"""Two-way analysis of variance of incomplete designs: how much of a spread is the laboratories', how much the method's.

Values y of laboratory i, method j and repetition k follow y = μ + αᵢ + βⱼ + (αβ)ᵢⱼ + ε. Sums of squares of laboratory
and method are differences of residual sums of least-squares fits, each effect beside the other (Yates 1934, "The
analysis of multiple classifications with unequal numbers in the different classes", JASA 29; Searle's R(α | μ, β), type
II). In a complete design with as many repetitions everywhere they are the textbook's and add up to the total. In an
incomplete one they need not: the rest is what laboratory and method cannot be told apart in.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

Name = Literal["laboratory", "method", "interaction", "repetition"]
_TINY = 1e-12


@dataclass(frozen=True)
class Source:
    """A source of variance."""

    name: Name
    degrees: int
    """Of freedom."""
    sum_of_squares: float
    share: float | None
    """Of the total sum of squares; None if all values are equal."""
    f: float | None
    """Mean square over that of `against`; None without degrees of freedom on either side."""
    p: float | None
    """Probability of so large an F, or a larger one, if the source had no effect."""
    against: Name | None
    """The source whose mean square is the error."""


@dataclass(frozen=True)
class Variance:
    """The analysis of one quantity."""

    count: int
    """Values."""
    mean: float
    total: float
    """Sum of squares about the mean."""
    sources: tuple[Source, ...]
    """Laboratory, method, interaction, repetition."""
    laboratory_means: dict[str, float] | None
    """Of each laboratory, as if it had all methods; None if laboratories and methods cannot be told apart."""
    method_means: dict[str, float] | None
    """Of each method, as if all laboratories had it."""
    complete: bool
    """Every laboratory has every method, equally often."""

    @property
    def connected(self) -> bool:
        """Whether laboratories and methods can be told apart: any two are joined by common methods."""
        return self.laboratory_means is not None

    def source(self, name: Name) -> Source:
        """One of the sources."""
        return next(s for s in self.sources if s.name == name)

    @property
    def laboratory_spread(self) -> float | None:
        """Standard deviation of the laboratories' means; None for fewer than two."""
        return _spread(self.laboratory_means)

    @property
    def method_spread(self) -> float | None:
        """Standard deviation of the methods' means; None for fewer than two."""
        return _spread(self.method_means)

    @property
    def repetition_spread(self) -> float | None:
        """Standard deviation between repetitions of a laboratory's method; None without any."""
        own = self.source("repetition")
        return float(np.sqrt(own.sum_of_squares / own.degrees)) if own.degrees else None


def analyse(values: Sequence[float], laboratories: Sequence[str], methods: Sequence[str]) -> Variance:
    """Analyse values that each belong to a laboratory and a method.

    Parameters
    ----------
    values
        (n,); those of the same laboratory and method are repetitions.
    laboratories, methods
        Of each value (n,).

    Raises
    ------
    ClerestoryError
        There is no value, one is not finite, or the lengths differ.

    Notes
    -----
    Laboratories and methods both stand for others that could have been: their F is against the interaction where there
    is one, and against repetitions otherwise. The interaction's is against repetitions.
    """
    from scipy.stats import f as distribution

    y = np.asarray(values, dtype=np.float64)
    if not len(y) or not len(y) == len(laboratories) == len(methods):
        raise ClerestoryError(
            f"{len(y)} values of {len(laboratories)} laboratories and {len(methods)} methods (give one of each a value)"
        )
    if not np.isfinite(y).all():
        raise ClerestoryError("a value is not finite (leave it out)")
    a, b = _dummies(laboratories), _dummies(methods)
    one = np.ones((len(y), 1))
    cells = _dummies([f"{i}\0{j}" for i, j in zip(laboratories, methods, strict=True)])
    total, _ = _residual(one, y)
    of_a, rank_a = _residual(a, y)
    of_b, rank_b = _residual(b, y)
    both = np.hstack([a, b])
    of_both, rank_both = _residual(both, y)
    of_cells, rank_cells = _residual(cells, y)
    squares: dict[Name, tuple[float, int]] = {
        "laboratory": (of_b - of_both, rank_both - rank_b),
        "method": (of_a - of_both, rank_both - rank_a),
        "interaction": (of_both - of_cells, rank_cells - rank_both),
        "repetition": (of_cells, len(y) - rank_cells),
    }
    # What is left of equal values by rounding is nothing.
    floor = _TINY * float(y @ y)
    squares = {name: (s if d and s > floor else 0.0, d) for name, (s, d) in squares.items()}
    if total <= floor:
        total, y = 0.0, np.full(len(y), y.mean())
    sources = []
    for name, (square, degrees) in squares.items():
        against = _against(name, squares)
        f = p = None
        if degrees and against is not None and squares[against][0] > 0.0:
            error, its_degrees = squares[against]
            f = (square / degrees) / (error / its_degrees)
            p = float(distribution.sf(f, degrees, its_degrees))
        share = square / total if total > 0.0 else None
        sources.append(Source(name, degrees, square, share, f, p, against if f is not None else None))
    connected = rank_both == a.shape[1] + b.shape[1] - 1
    means = _means(both, y, list(dict.fromkeys(laboratories)), list(dict.fromkeys(methods))) if connected else None
    counts = (a.T @ b).ravel()
    return Variance(
        count=len(y),
        mean=float(y.mean()),
        total=total,
        sources=tuple(sources),
        laboratory_means=None if means is None else means[0],
        method_means=None if means is None else means[1],
        complete=bool((counts == counts[0]).all()),
    )


def _dummies(names: Sequence[str]) -> Floats:
    """A column for each name (n, names): 1 where it is the value's."""
    known = list(dict.fromkeys(names))
    return np.array([[float(name == other) for other in known] for name in names])


def _residual(design: Floats, y: Floats) -> tuple[float, int]:
    """Sum of squares that a least-squares fit leaves, and the design's rank."""
    solution, _, rank, _ = np.linalg.lstsq(design, y, rcond=None)
    rest = y - design @ solution
    return float(rest @ rest), int(rank)


def _against(name: Name, squares: dict[Name, tuple[float, int]]) -> Name | None:
    candidates: dict[Name, tuple[Name, ...]] = {
        "laboratory": ("interaction", "repetition"),
        "method": ("interaction", "repetition"),
        "interaction": ("repetition",),
        "repetition": (),
    }
    return next((other for other in candidates[name] if squares[other][1]), None)


def _means(
    both: Floats, y: Floats, laboratories: list[str], methods: list[str]
) -> tuple[dict[str, float], dict[str, float]]:
    """Of each laboratory and method, by the additive fit over the complete table."""
    effects = np.linalg.lstsq(both, y, rcond=None)[0]
    table = effects[: len(laboratories), None] + effects[None, len(laboratories) :]
    return (
        dict(zip(laboratories, table.mean(axis=1).tolist(), strict=True)),
        dict(zip(methods, table.mean(axis=0).tolist(), strict=True)),
    )


def _spread(means: dict[str, float] | None) -> float | None:
    return None if means is None or len(means) < 2 else float(np.std(list(means.values()), ddof=1))
