"""Direct-hemispherical values measured with a sphere, and those of a data set or of scans, side by side."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.directions import direction
from clerestory.measure.calibrate.known import Known, known_values
from clerestory.measure.delaunay import surface
from clerestory.measure.direct import PORT_MARGIN, SCATTERING
from clerestory.words import percent

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Measurement
    from clerestory.measure.sphere import SphereValues

NEAR_DEG = 1.0
"""A scan is of the light that a sphere measured within this angle [°]."""
SMALL_SPHERE_MM = 250.0
"""A sphere of a spectrophotometer is no larger [mm], and its ports are about a tenth of that."""
LOST = 0.03
"""Relative shortfall of a small sphere's values of a scatterer that points to light lost sideways."""


@dataclass(frozen=True)
class Row:
    """One measured value and the model's."""

    side: Side
    scatter: Scatter
    band: str
    theta_deg: float
    phi_deg: float
    measured: float
    standard_error: float | None
    modelled: float

    @property
    def difference(self) -> float:
        """Modelled less measured."""
        return self.modelled - self.measured

    @property
    def ratio(self) -> float:
        """Measured over modelled: the factor that would make them equal; infinite for a dark model."""
        if self.modelled > 0.0:
            return self.measured / self.modelled
        return 1.0 if self.measured == 0.0 else float("inf")

    @property
    def where(self) -> str:
        """Component and direction in words."""
        return f"{self.band}, {self.scatter} from the {self.side}, {self.theta_deg:g}° at azimuth {self.phi_deg:g}°"


@dataclass(frozen=True)
class Agreement:
    """Measured and modelled values, and what is odd about them."""

    rows: tuple[Row, ...]
    warnings: tuple[str, ...] = ()

    @property
    def rms(self) -> float:
        """RMS difference over the RMS of the measured values."""
        if not self.rows:
            return float("nan")
        level = float(np.sqrt(np.mean([row.measured**2 for row in self.rows])))
        return float(np.sqrt(np.mean([row.difference**2 for row in self.rows]))) / max(level, 1e-300)

    def of(self, side: Side, scatter: Scatter, band: str) -> tuple[Row, ...]:
        """The rows of one component."""
        return tuple(r for r in self.rows if (r.side, r.scatter, r.band) == (side, scatter, band))


def of_model(bsdf: Bsdf, values: Iterable[SphereValues], *, standard: str = "en410") -> Agreement:
    """A data set beside a sphere's values.

    Raises
    ------
    ClerestoryError
        No value is of a band and component that the data set has.
    """
    known, left = known_values(values, bsdf.bands, standard=standard)
    rows, scattering = [], {}
    for one in known:
        if one.hemispherical is None:
            continue
        incident = direction(one.theta_deg, one.phi_deg, side=one.side)
        try:
            modelled = float(bsdf.integrate(incident, one.scatter, band=one.band))
            direct = float(bsdf.integrate(incident, one.scatter, band=one.band, part="direct"))
        except MissingDataError:
            left.append(f"the data set has no {one.scatter} from the {one.side} in {one.band}")
            continue
        rows.append(_row(one, one.hemispherical, modelled))
        scattering[rows[-1].where] = 1.0 - direct / modelled if modelled > 0.0 else 0.0
    return _agreement(known, rows, left, scattering)


def of_scans(measurement: Measurement, values: Iterable[SphereValues], *, standard: str = "en410") -> Agreement:
    """Integrals of scans beside a sphere's values, where both are of the same light.

    Raises
    ------
    ClerestoryError
        No value is of light and channels that were scanned.
    """
    samples = [scan for scan in measurement.of() if scan.quantity != "signal"]
    channels = list(dict.fromkeys(name for scan in samples for name in scan.channels))
    known, left = known_values(values, channels, standard=standard)
    rows = []
    for one in known:
        if one.hemispherical is None:
            continue
        toward = direction(one.theta_deg, one.phi_deg, side=one.side)
        for scan in samples:
            if (scan.incident_side, scan.scatter) != (one.side, one.scatter) or one.band not in scan.channels:
                continue
            if float(np.linalg.norm(scan.incident - toward)) < np.radians(NEAR_DEG):
                total = surface(scan).integrate().total[scan.channels.index(one.band)]
                rows.append(_row(one, one.hemispherical, float(total)))
                break
    return _agreement(known, rows, left, {row.where: 1.0 for row in rows})


def _row(one: Known, measured: float, modelled: float) -> Row:
    return Row(one.side, one.scatter, one.band, one.theta_deg, one.phi_deg, measured, one.standard_error, modelled)


def _agreement(
    known: Sequence[Known], rows: Sequence[Row], left: Sequence[str], scattering: Mapping[str, float]
) -> Agreement:
    if not rows:
        raise ClerestoryError(
            "no value of the sphere belongs to the data"
            + (f": {'; '.join(dict.fromkeys(left))}" if left else " (sides, bands or directions differ)")
        )
    by_place = {one.where: one for one in known}
    lost = [_lateral(by_place[row.where], row, scattering[row.where]) for row in rows]
    warnings = list(dict.fromkeys([*left, *(text for text in lost if text)]))
    return Agreement(tuple(rows), tuple(warnings))


def _lateral(one: Known, row: Row, scattered: float) -> str:
    """Why light is likely to have been lost sideways in the sample, or nothing.

    A thick scatterer sends light out of the sample beside the sphere's port. The difference of a sphere's total and
    diffuse values is sound even so, the values themselves are not (report C.2.2, section 2.3).
    """
    if scattered < SCATTERING:
        return ""
    port, spot, thick = (_millimetres(one, key) for key in ("port_mm", "spot_mm", "thickness_mm"))
    if port is not None and spot is not None and thick is not None:
        margin = 0.5 * (port - spot)
        if margin < PORT_MARGIN * thick:
            return (
                f"light is likely lost sideways: the port of {port:g} mm is {margin:g} mm wider than the spot on each"
                f" side, for a scattering sample of {thick:g} mm ({PORT_MARGIN:g} thicknesses are needed)"
            )
        return ""
    sphere = _millimetres(one, "sphere_mm")
    if sphere is not None and sphere <= SMALL_SPHERE_MM and row.difference > LOST * row.measured:
        return (
            f"light may be lost sideways: a sphere of {sphere:g} mm gives {percent(row.measured)} where the data have "
            f"{percent(row.modelled)} for a scattering sample (compare with a larger sphere and port)"
        )
    return ""


def _millimetres(one: Known, key: str) -> float | None:
    text = one.conditions.get(key)
    if text is None:
        return None
    try:
        return float(text)
    except ValueError:
        raise ClerestoryError(f"{one.where}: {key} is {text!r}, which is not a length in millimetres") from None
