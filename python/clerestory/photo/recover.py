"""The response of a camera, recovered from a series of its pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.photo import debevec, mitsunaga
from clerestory.photo.debevec import hat
from clerestory.photo.response import LEVELS, Response, normalised
from clerestory.photo.samples import Samples, sample
from clerestory.photo.series import third_of_a_stop

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from clerestory.photo.series import Series

LEAST = 24
"""With fewer spots no response is recovered."""
CLEARLY = 0.8
"""A misfit that is smaller by this factor decides between two readings of the exposure times."""
_METHODS = {"debevec": debevec.logarithms, "mitsunaga": mitsunaga.logarithms}


@dataclass(frozen=True)
class Step:
    """From one picture of a series to the next longer one."""

    shorter: str
    longer: str
    """Names of their files."""
    given: float
    """Ratio of their exposures."""
    found: float
    """Ratio of the light in their pictures."""
    spots: int
    """That it was found from."""

    @property
    def deviation(self) -> float:
        """Found over given, less 1."""
        return self.found / self.given - 1.0


def recover_response(
    series: Series,
    method: Literal["debevec", "mitsunaga"] = "debevec",
    progress: Callable[[float], object] | None = None,
) -> Response:
    """Recover the response of a camera from a series.

    Parameters
    ----------
    series
        What `read_series` gave.
    method
        A smooth curve (Debevec and Malik) or a polynomial (Mitsunaga and Nayar).
    progress
        Called with the share that is done, 0 to 1.

    Raises
    ------
    ClerestoryError
        The series does not hold what is needed for it.
    """
    return fit(sample(series, progress), method)


def fit(spots: Samples, method: Literal["debevec", "mitsunaga"]) -> Response:
    """The response that samples follow.

    Raises
    ------
    ClerestoryError
        They follow none that rises.
    """
    if len(spots.levels) < LEAST:
        raise ClerestoryError(
            f"only {len(spots.levels)} even spots are well exposed in two pictures, too few to recover the response "
            "(take smaller steps of exposure and a scene with even surfaces, or give --response of another series)"
        )
    if method not in _METHODS:
        raise ClerestoryError(f"method {method!r} is not known (give {' or '.join(_METHODS)})")
    g = np.stack([_METHODS[method](spots.levels[:, :, c], spots.exposures) for c in range(3)])
    curves = normalised(g)
    return Response(curves, method, _residual(spots, curves))


def rounded_times(series: Series, spots: Samples) -> tuple[float, float] | None:
    """Misfits with the times as they are written and as thirds of a stop, if the pictures speak for the latter."""
    thirds = [p.exposure.value * third_of_a_stop(p.exposure.time) / p.exposure.time for p in series.photographs]
    found = [fit(Samples(spots.levels, np.array(values)), "debevec").residual for values in (series.values, thirds)]
    written, rounded = (float(v or 0.0) for v in found)
    return (written, rounded) if rounded < CLEARLY * written else None


def steps(series: Series, spots: Samples, response: Response) -> tuple[Step, ...]:
    """How the light of neighbouring pictures is related, beside how their exposures are."""
    found = []
    for j in range(len(series.photographs) - 1):
        w = np.sqrt(hat(spots.levels[:, j]) * hat(spots.levels[:, j + 1]))
        both = w > 0.0
        a, b = (_light(response.curves, spots.levels[:, k])[both] for k in (j, j + 1))
        ratio = float(np.exp(np.average(np.log(b / a), weights=w[both]))) if both.any() else float("nan")
        shorter, longer = series.photographs[j], series.photographs[j + 1]
        given = longer.exposure.value / shorter.exposure.value
        found.append(Step(shorter.path.name, longer.path.name, given, ratio, int(both.any(axis=1).sum())))
    return tuple(found)


def _light(curves: NDArray[np.float64], levels: NDArray[np.float64]) -> NDArray[np.float64]:
    """Light (spots, 3) of levels (spots, 3)."""
    return np.stack([np.interp(levels[:, c], np.arange(LEVELS), curves[c]) for c in range(3)], axis=1)


def _residual(spots: Samples, curves: NDArray[np.float64]) -> float:
    """Root mean square of the relative deviation of a spot's light from its mean over the pictures."""
    w = hat(spots.levels)
    light = np.stack([_light(curves, spots.levels[:, j]) for j in range(spots.levels.shape[1])], axis=1)
    ln = np.log(np.maximum(light, 1e-12)) - np.log(spots.exposures)[:, None]
    totals = np.maximum(w.sum(axis=1, keepdims=True), 1e-12)
    mean = (w * ln).sum(axis=1, keepdims=True) / totals
    return float(np.sqrt((w * (ln - mean) ** 2).sum() / w.sum()))
