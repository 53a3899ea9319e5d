"""A fitted formula: its parameters with their errors, and how well it stands for what was measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory.counts import counted
from clerestory.measure.formula.shapes import DIFFUSE, LEAST_LEVEL, SPECULAR, Geometry

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.formula.beam import Beam
    from clerestory.measure.formula.shapes import Formula, Parameter

    Floats = NDArray[np.float64]

_STEP = 1e-4


@dataclass(frozen=True)
class Number:
    """A parameter at an incident angle."""

    name: str
    value: float
    """0 for a level that nothing asked for."""
    standard_error: float
    """NaN where the data do not tell it: it stands at a limit."""


@dataclass(frozen=True)
class Residual:
    """How far a formula is from the points."""

    rms_log10: float
    """RMS difference of log₁₀ BSDF, as the fit weighed it."""
    rms_log10_low: float
    """The same of points below 1 % of the largest; NaN where there are none."""
    worst_top: float
    """Largest relative difference within a decade of the largest value."""


@dataclass(frozen=True)
class Fitted:
    """A formula fitted to one component."""

    band: str
    side: Side
    scatter: Scatter
    formula: Formula
    orders: Mapping[str, int]
    """Degree of each parameter's polynomial in 1 − cos θi."""
    coefficients: Floats
    """Of all polynomials, one behind the other, of logarithms where these are fitted (k,)."""
    covariance: Floats
    """Of the coefficients (k, k); NaN in rows of those that stand at a limit."""
    beam: Beam | None
    thetas_deg: tuple[float, ...]
    """Incident angles that were measured [°]."""
    points: int
    used: int
    """Points that the fit took."""
    residual: Residual
    totals: tuple[tuple[float, float, float | None], ...]
    """Incident angle [°], direct-hemispherical value of the formula, and of the surface through the points if there is
    one."""

    @property
    def where(self) -> str:
        """The component in words."""
        return f"{self.band}, {self.scatter} from the {self.side}"

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Fitted parameters, even scattering and the beam included."""
        return parameters_of(self.formula, beam=self.beam is not None)

    def values(self, theta_deg: ArrayLike, coefficients: Floats | None = None) -> dict[str, Floats]:
        """Fitted parameters at incident angles [°]; beyond those that were measured they stay what they are there."""
        theta = np.clip(np.asarray(theta_deg, np.float64), min(self.thetas_deg), max(self.thetas_deg))
        return values_at(
            self.parameters, self.orders, self.coefficients if coefficients is None else coefficients, theta
        )

    def numbers(self, theta_deg: float) -> tuple[Number, ...]:
        """Parameters as they are usual at one incident angle [°], with their standard errors."""

        def usual(coefficients: Floats) -> dict[str, float]:
            held = self.values(theta_deg, coefficients)
            named = self.formula.reported(held) or {p.name: held[p.name] for p in self.formula.parameters}
            levels = {p.name: held[p.name] for p in (SPECULAR, DIFFUSE) if p.name in held}
            return {name: float(value) for name, value in {**named, **levels}.items()}

        def shown(value: float) -> float:
            return value if abs(value) > 2.0 * LEAST_LEVEL else 0.0

        here = usual(self.coefficients)
        known = np.isfinite(np.diag(self.covariance))
        slopes = np.zeros((len(here), len(known)))
        for k in np.flatnonzero(known):
            step = np.zeros(len(known))
            step[k] = _STEP
            up, down = usual(self.coefficients + step), usual(self.coefficients - step)
            slopes[:, k] = [(up[name] - down[name]) / (2.0 * _STEP) for name in here]
        covariance = np.where(np.isfinite(self.covariance), self.covariance, 0.0)
        errors = np.sqrt(np.maximum(np.einsum("ik,kl,il->i", slopes, covariance, slopes), 0.0))
        return tuple(
            Number(name, shown(value), float(error) if error > 0.0 else float("nan"))
            for (name, value), error in zip(here.items(), errors, strict=True)
        )

    def evaluate(self, incident: Floats, outgoing: Floats) -> Floats:
        """BSDF of the scattered light [1/sr] for directions (n, 3) that broadcast; the beam is not in it."""
        geometry = Geometry.of(incident, outgoing)
        theta = np.degrees(np.arccos(np.clip(geometry.incident[..., 2], -1.0, 1.0)))
        held = self.values(theta)
        return np.asarray(self.formula.value(geometry, held) + held[DIFFUSE.name] / np.pi)

    def specular(self, theta_deg: ArrayLike) -> Floats:
        """Transmittance or reflectance of the beam; 0 where none was told apart."""
        if self.beam is None:
            return np.zeros_like(np.asarray(theta_deg, np.float64))
        held = self.values(theta_deg)[SPECULAR.name]
        return np.where(held > 2.0 * LEAST_LEVEL, held, 0.0)

    def material(self) -> dict[str, object] | None:
        """A material of a recipe for `clerestory trace`, at the mean of the measured angles; None if there is none."""
        held = {name: float(v) for name, v in self.values(float(np.mean(self.thetas_deg))).items()}
        side = "reflectance" if self.scatter == "reflection" else "transmittance"
        lobe = (
            float(np.mean([total for _, total, _ in self.totals])) - held[DIFFUSE.name] - held.get(SPECULAR.name, 0.0)
        )
        levels = {side: round(max(lobe, 0.0), 6), f"diffuse_{side}": round(held[DIFFUSE.name], 6)}
        if self.beam is not None and held[SPECULAR.name] > 10.0 * LEAST_LEVEL:
            return None  # a recipe's lobes have no beam beside them
        if self.formula.name == "abg":
            return {"kind": "abg", "b": held["rolloff"] ** held["g"], "g": held["g"], **levels}
        if self.formula.name == "gaussian":
            return {"kind": "gaussian", "width": held["width"], **levels}
        if self.formula.name == "lambertian":
            return {"kind": "lambertian", "reflectance": 0.0, side: round(held[DIFFUSE.name], 6)}
        return None

    def lines(self) -> list[str]:
        """How it was fitted and how well, in sentences."""
        beam = "instrument's beam not known, so widths hold it" if self.beam is None else self.beam.words
        low = self.residual.rms_log10_low
        below = "" if np.isnan(low) else f", {low:.3f} below 1 % of the largest value"
        off = [made / seen - 1.0 for _, made, seen in self.totals if seen]
        integral = "" if not off else f"; integrals off by {100.0 * max(off, key=abs):+.1f} % at most"
        return [
            f"{self.where}: {self.formula.name}, {self.formula.words}",
            f"{counted(len(self.thetas_deg), 'incident angle')}, {self.used:,} of {counted(self.points, 'point')};"
            f" RMS difference of log10 {self.residual.rms_log10:.3f}{below}; at most"
            f" {100.0 * self.residual.worst_top:.0f} % off in the top decade{integral}",
            f"signature: {beam}",
        ]


def parameters_of(formula: Formula, *, beam: bool) -> tuple[Parameter, ...]:
    """Those of a formula, even scattering and, where a beam is known, its image."""
    return (*formula.parameters, DIFFUSE, *((SPECULAR,) if beam else ()))


def values_at(
    parameters: tuple[Parameter, ...], orders: Mapping[str, int], coefficients: Floats, theta_deg: Floats
) -> dict[str, Floats]:
    """Parameters at incident angles [°], by name."""
    t = 1.0 - np.cos(np.radians(theta_deg))
    found: dict[str, Floats] = {}
    at = 0
    for parameter in parameters:
        count = orders[parameter.name] + 1
        value = np.polynomial.polynomial.polyval(t, coefficients[at : at + count])
        at += count
        value = np.exp(np.clip(value, -50.0, 50.0)) if parameter.log else value
        found[parameter.name] = np.asarray(np.clip(value, parameter.low, parameter.high), dtype=np.float64)
    return found
