"""Formulas fitted to scans: logarithms compared, robustly, several incident angles together."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.optimize import least_squares

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.directions import SCATTERS, SIDES
from clerestory.measure.delaunay import NoSurfaceError, surface
from clerestory.measure.formula.beam import Beam, seen
from clerestory.measure.formula.dataset import scattered_total
from clerestory.measure.formula.found import Fitted, Residual, parameters_of, values_at
from clerestory.measure.formula.points import FLOOR, RELATIVE, Light
from clerestory.measure.formula.shapes import DIFFUSE, FORMULAS, LEAST_LEVEL, SPECULAR
from clerestory.measure.prepare.step import same_light

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from clerestory.measure.formula.shapes import Formula, Parameter
    from clerestory.measure.scan import Measurement, Scan

    Floats = NDArray[np.float64]

Order = int | Literal["auto"]
_ORDERS = ((0, 0), (1, 0), (2, 0), (1, 1), (2, 1), (2, 2))
"""Degrees of levels and of shapes that are tried, the fewest coefficients first."""
_BETTER = 10.0
"""Difference of the Bayesian information criterion (Schwarz 1978) that speaks strongly for more coefficients."""
_STARTS = (1.0, 0.3, 3.0)
"""Factors on the first guess of a lobe's width."""
_TOP = 10.0
_LOW = 0.01
_AT_LIMIT = 1e-6


@dataclass(frozen=True)
class _Task:
    """All that a residual needs."""

    formula: Formula
    parameters: tuple[Parameter, ...]
    lights: tuple[Light, ...]
    beam: Beam | None


def fit_formula(
    measurement: Measurement,
    model: str,
    *,
    order: Order = "auto",
    beam_deg: float | None = None,
    channels: Sequence[str] | None = None,
    progress: Callable[[float], object] | None = None,
) -> tuple[Fitted, ...]:
    """Fit a formula to every side, transmission or reflection, and channel that was measured.

    Parameters
    ----------
    measurement
        Scans in BSDF or DSF; those of the beam, if there are any, tell the instrument's signature.
    model
        One of `FORMULAS`. Even scattering is always beside it, and the beam's image where the beam is known.
    order
        Degree of the polynomials in 1 − cos θi that parameters follow. `auto` raises that of levels, then of shapes, as
        long as the data ask for it.
    beam_deg
        Full width at half maximum of the beam [°], where no scan of it was measured.
    channels
        All by default.
    progress
        Called with the share that is done, 0 to 1.

    Raises
    ------
    ClerestoryError
        There is no such formula, it is not for what was measured, or there are fewer points than parameters.

    Notes
    -----
    Minimised is Σ w ρ([ln(f + ε) − ln(m + ε)]²/σ²) with ρ = 2(√(1 + z) − 1), σ² = (noise² + (0.05 m)²)/(m + ε)² and
    ε = 10⁻⁴/sr, or twice the noise where that is more. Weights w give every tenth of a decade of u the same say (for
    lobes about the normal every step of cos²θ), as a peak holds few directions and much light. Standard errors are
    those of the "sandwich" (Huber 1967), which take the scatter of the residuals as it is.
    """
    formula = FORMULAS.get(model)
    if formula is None:
        raise ClerestoryError(f"formula {model!r} is not known (give {', '.join(FORMULAS)})")
    if order != "auto" and not 0 <= order <= 3:
        raise ClerestoryError(f"polynomials of degree {order} are not fitted (give 0 to 3, or auto)")
    scans = [scan.as_bsdf() for scan in measurement.of()]
    names = list(dict.fromkeys(name for scan in scans for name in scan.channels))
    for name in channels or ():
        if name not in names:
            raise ClerestoryError(f"no channel {name!r} (there are {', '.join(names)})")
    keys = [(b, s, c) for b in (channels or names) for s in SIDES for c in SCATTERS]
    jobs = [
        (key, [s for s in scans if (s.incident_side, s.scatter) == key[1:] and key[0] in s.channels]) for key in keys
    ]
    jobs = [(key, here) for key, here in jobs if here]
    if not jobs:
        raise ClerestoryError("there is no scan of the sample to fit a formula to")
    unfit = [scatter for (_, _, scatter), _ in jobs if scatter not in formula.scatters]
    if unfit and len(unfit) == len(jobs):
        raise ClerestoryError(f"{model} is a formula for {formula.scatters[0]}, and {unfit[0]} was measured")
    jobs = [job for job in jobs if job[0][2] in formula.scatters]
    found = []
    for number, ((band, side, scatter), here) in enumerate(jobs):
        beam = Beam.measured(measurement, band) if beam_deg is None else Beam.gaussian(beam_deg)
        groups = same_light(here)
        around = formula.about == "normal"
        lights = tuple(Light.of(group, band, beam, around_normal=around) for group in groups)
        task = _Task(formula, parameters_of(formula, beam=beam is not None), lights, beam)
        orders, coefficients, covariance = _best(task, order)
        thetas = tuple(sorted({light.theta_deg for light in lights}))
        fitted = Fitted(
            band,
            side,
            scatter,
            formula,
            orders,
            coefficients,
            covariance,
            beam,
            thetas,
            sum(light.measured for light in lights),
            sum(len(light.values) for light in lights),
            _residual(task, orders, coefficients),
            (),
        )
        totals = [
            (g[0].incident_theta_deg, _total(fitted, light), _seen(g, band))
            for g, light in zip(groups, lights, strict=True)
        ]
        found.append(replace(fitted, totals=tuple(sorted(totals, key=lambda row: row[0]))))
        if progress is not None:
            progress((number + 1) / len(jobs))
    return tuple(found)


def _best(task: _Task, order: Order) -> tuple[dict[str, int], Floats, Floats]:
    angles = len({round(light.theta_deg, 1) for light in task.lights})
    if order != "auto":
        if order >= angles:
            raise ClerestoryError(
                f"polynomials of degree {order} ask for {order + 1} incident angles ({counted(angles, 'angle')} there)"
            )
        tries: Sequence[tuple[int, int]] = [(order, order)]
        if order > 0:
            tries = [(0, 0), *tries]
    else:
        tries = [pair for pair in _ORDERS if pair[0] < angles]
    weights = np.concatenate([light.weights for light in task.lights])
    n = float(weights.sum() ** 2 / (weights**2).sum())  # points of uneven weight tell as much as so many of even weight
    best: tuple[float, dict[str, int], Floats] | None = None
    start = None
    for levels, shapes in tries:
        orders = {p.name: levels if p.level else shapes for p in task.parameters}
        count = sum(orders.values()) + len(orders)
        if count >= n:
            raise ClerestoryError(
                f"{counted(len(weights), 'point')} do not tell {counted(count, 'coefficient')} (measure more)"
            )
        starts = _starts(task) if best is None else [_raised(task, best[1], best[2], orders)]
        cost, start = min((_minimum(task, orders, s) for s in starts), key=lambda pair: pair[0])
        criterion = n * float(np.log(max(cost, 1e-300) / n)) + count * float(np.log(n))
        if best is None or order != "auto" or criterion < best[0] - _BETTER:
            best = criterion, orders, start
    assert best is not None  # there is at least one try
    return best[1], best[2], _covariance(task, best[1], best[2])


def _starts(task: _Task) -> list[Floats]:
    """First guesses from the points: peak, width at half of it, slope of the flank, floor."""
    u = np.concatenate([light.geometry.u for light in task.lights])
    values = np.concatenate([light.values for light in task.lights])
    floor = max(float(np.quantile(values, 0.2)), FLOOR)
    ring = np.floor(10.0 * np.log10(np.maximum(u, 1e-4)))
    at = np.array([np.exp(np.mean(np.log(np.maximum(u[ring == r], 1e-4)))) for r in np.unique(ring)])
    medians = np.array([np.median(values[ring == r]) for r in np.unique(ring)])
    peak = max(float(medians[: max(3, len(medians) // 4)].max()), 2.0 * FLOOR)
    falls = np.flatnonzero((medians < 0.5 * peak) & (at > at[int(np.argmax(medians))]))
    half = float(at[falls[0]]) if len(falls) else float(at[-1])
    flank = (at > 1.5 * half) & (medians > 2.0 * floor)
    slope = 2.5
    if flank.sum() >= 3:
        slope = float(np.clip(-np.polyfit(np.log(at[flank]), np.log(medians[flank]), 1)[0], 0.8, 5.0))
    found = []
    for factor in _STARTS if task.formula.parameters else (1.0,):
        guess = task.formula.start(peak, factor * half, slope)
        guess[DIFFUSE.name] = min(np.pi * floor, 0.9)
        if task.beam is not None:
            guess[SPECULAR.name] = 0.3 * min(peak / float(task.beam.profile[0]), 1.0)
        row = [np.clip(guess[p.name], 1.01 * p.low, 0.99 * p.high) for p in task.parameters]
        found.append(np.array([np.log(v) if p.log else v for v, p in zip(row, task.parameters, strict=True)]))
    return found


def _raised(task: _Task, orders: Mapping[str, int], coefficients: Floats, wanted: Mapping[str, int]) -> Floats:
    """Coefficients of polynomials of a lower degree as those of a higher one."""
    rows, at = [], 0
    for parameter in task.parameters:
        count = orders[parameter.name] + 1
        row = np.zeros(wanted[parameter.name] + 1)
        row[: min(count, len(row))] = coefficients[at : at + min(count, len(row))]
        rows.append(row)
        at += count
    return np.concatenate(rows)


def _limits(task: _Task, orders: Mapping[str, int]) -> tuple[Floats, Floats]:
    low, high = [], []
    for parameter in task.parameters:
        ends = (np.log(parameter.low), np.log(parameter.high)) if parameter.log else (parameter.low, parameter.high)
        more = orders[parameter.name]
        low += [float(ends[0]), *[-30.0] * more]
        high += [float(ends[1]), *[30.0] * more]
    return np.array(low), np.array(high)


def _minimum(task: _Task, orders: Mapping[str, int], start: Floats) -> tuple[float, Floats]:
    low, high = _limits(task, orders)
    inside = np.clip(start, low + 1e-6 * (high - low), high - 1e-6 * (high - low))
    found = least_squares(
        lambda c: _off(task, orders, c),
        inside,
        bounds=(low, high),
        loss="soft_l1",
        x_scale=np.where(np.isin(np.arange(len(low)), _first(orders)), 1.0, 3.0),
        max_nfev=200,
    )
    return float(2.0 * found.cost), np.asarray(found.x)


def _first(orders: Mapping[str, int]) -> list[int]:
    """Places of the constants of the polynomials."""
    return [int(k) for k in np.cumsum([0, *[order + 1 for order in orders.values()]])[:-1]]


def _off(task: _Task, orders: Mapping[str, int], coefficients: Floats) -> Floats:
    """Weighted differences of logarithms, over their errors."""
    rows = []
    for light in task.lights:
        held = values_at(task.parameters, orders, coefficients, np.array(light.theta_deg))
        made = seen(task.formula, held, task.beam, light.geometry, light.apart, light.spread)
        floor = np.maximum(FLOOR, 2.0 * light.errors)
        known = np.maximum(light.values, -0.9 * floor)
        error = np.hypot(light.errors, RELATIVE * np.maximum(known, 0.0)) / (np.maximum(known, 0.0) + floor)
        error = np.maximum(error, RELATIVE * 0.1)
        rows.append(np.sqrt(light.weights) * (np.log(made + floor) - np.log(known + floor)) / error)
    return np.concatenate(rows)


def _covariance(task: _Task, orders: Mapping[str, int], coefficients: Floats) -> Floats:
    """Of the coefficients, from the scatter of the residuals; NaN for those at a limit."""
    low, high = _limits(task, orders)
    wide = high - low
    free = (coefficients - low > _AT_LIMIT * wide) & (high - coefficients > _AT_LIMIT * wide)
    # A level at its lower end is moved by nothing that was measured.
    for first, parameter in zip(_first(orders), task.parameters, strict=True):
        if parameter.level and np.exp(coefficients[first]) < 3.0 * LEAST_LEVEL:
            free[first : first + orders[parameter.name] + 1] = False
    here = _off(task, orders, coefficients)
    columns = []
    for k in np.flatnonzero(free):
        step = np.zeros(len(coefficients))
        step[k] = 1e-5
        columns.append((_off(task, orders, coefficients + step) - _off(task, orders, coefficients - step)) / 2e-5)
    found = np.full((len(coefficients), len(coefficients)), np.nan)
    if not columns:
        return found
    jacobian = np.stack(columns, axis=1)
    robust = 1.0 / np.sqrt(1.0 + here**2)  # derivative of soft L1
    curvature = jacobian.T @ (jacobian * (robust / (1.0 + here**2))[:, None])
    scatter = jacobian.T @ (jacobian * ((robust * here) ** 2)[:, None])
    inverse = np.linalg.pinv(curvature, rcond=1e-12)
    n, k_free = jacobian.shape
    found[np.ix_(free, free)] = inverse @ scatter @ inverse * n / max(n - k_free, 1)
    return found


def _residual(task: _Task, orders: Mapping[str, int], coefficients: Floats) -> Residual:
    off, weights, low, top = [], [], [], []
    for light in task.lights:
        held = values_at(task.parameters, orders, coefficients, np.array(light.theta_deg))
        made = seen(task.formula, held, task.beam, light.geometry, light.apart, light.spread)
        floor = np.maximum(FLOOR, 2.0 * light.errors)
        off.append(np.log10((made + floor) / (np.maximum(light.values, -0.9 * floor) + floor)))
        weights.append(light.weights)
        largest = float(light.values.max())
        low.append(light.values < _LOW * largest)
        bright = light.values > largest / _TOP
        top.append(float(np.abs(made[bright] / light.values[bright] - 1.0).max()))
    every, w, below = np.concatenate(off), np.concatenate(weights), np.concatenate(low)

    def rms(which: NDArray[np.bool_]) -> float:
        return float(np.sqrt(np.average(every[which] ** 2, weights=w[which]))) if which.any() else float("nan")

    return Residual(rms(np.ones(len(every), dtype=bool)), rms(below), max(top))


def _total(fitted: Fitted, light: Light) -> float:
    """Direct-hemispherical value of the formula, the beam's included."""
    return scattered_total(fitted, light.theta_deg, light.phi_deg) + float(fitted.specular(light.theta_deg))


def _seen(group: Sequence[Scan], band: str) -> float | None:
    """Direct-hemispherical value of the surface through the points, where they cover the hemisphere."""
    first = group[0]
    together = replace(
        first,
        theta_deg=np.concatenate([s.theta_deg for s in group]),
        phi_deg=np.concatenate([s.phi_deg for s in group]),
        values=np.concatenate([s.channel(band) for s in group])[:, None],
        channels=(band,),
        standard_errors=None,
    )
    try:
        integral = surface(together).integrate()
    except NoSurfaceError:
        return None
    total, beyond = float(integral.total[0]), float(integral.extrapolated[0])
    return total if abs(beyond) < 0.2 * abs(total) else None
