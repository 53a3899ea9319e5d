"""What a goniophotometer saw: scattered points of light from one direction, and all such scans of a sample.

Angles are those of the sample's frame (`clerestory.directions`): θ from the normal of the side in question, φ
counter-clockwise from +x as seen from the room, the same for both sides. Readers translate each laboratory's convention
once and say which one they took it to be.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.directions import SCATTERS, SIDES, direction, outgoing_side

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.source import Source

    Floats = NDArray[np.float64]

Quantity = Literal["bsdf", "dsf", "signal"]
"""BSDF [1/sr]; DSF, BSDF times the cosine of the outgoing angle [1/sr]; or a detector's signal, in any unit."""
QUANTITIES: tuple[Quantity, ...] = ("bsdf", "dsf", "signal")
Purpose = Literal["sample", "beam", "dark"]
"""Light that a sample scatters; the beam with no sample in its way; or what a detector gives in the dark."""
PURPOSES: tuple[Purpose, ...] = ("sample", "beam", "dark")


@dataclass(frozen=True)
class Scan:
    """Points that an instrument saw of light from one direction, on one side of a sample.

    Raises
    ------
    ClerestoryError
        Numbers of angles, values and channels differ, or an angle lies outside of its range.
    """

    incident_side: Side
    """Side that the light comes from."""
    scatter: Scatter
    """Whether the points lie on the other side (transmission) or on the same (reflection)."""
    incident_theta_deg: float
    """Angle of the direction to the source from the normal of `incident_side` [°], 0 to 90."""
    incident_phi_deg: float
    """Azimuth of the direction to the source [°]."""
    theta_deg: Floats
    """Angles from the normal of the side that the light leaves to [°], 0 to 90 (points,)."""
    phi_deg: Floats
    """Azimuths along the light [°] (points,)."""
    values: Floats
    """What was found (points, channels), negative values included."""
    quantity: Quantity = "bsdf"
    channels: tuple[str, ...] = ("visible",)
    """A band (visible, solar, nir), X, Y or Z of colour, a wavelength ("550 nm") or a detector's name, a column."""
    standard_errors: Floats | None = None
    """One a value, in its unit, where the instrument gave them."""
    purpose: Purpose = "sample"
    conditions: Mapping[str, str] = field(default_factory=dict)
    """What is known of how it was measured, by the keys of `CONDITIONS` and the file's own words for the rest."""
    source: Source | None = None
    """The file that it was read from."""

    def __post_init__(self) -> None:
        if self.incident_side not in SIDES or self.scatter not in SCATTERS:
            raise ClerestoryError(
                f"side {self.incident_side!r} with scatter {self.scatter!r} is not known "
                "(exterior or interior, transmission or reflection)"
            )
        if self.quantity not in QUANTITIES or self.purpose not in PURPOSES:
            raise ClerestoryError(f"quantity {self.quantity!r} of purpose {self.purpose!r} is not known")
        for name in ("theta_deg", "phi_deg", "values"):
            object.__setattr__(self, name, np.ascontiguousarray(getattr(self, name), dtype=np.float64))
        object.__setattr__(self, "conditions", MappingProxyType(dict(self.conditions)))
        count = len(self.theta_deg)
        if self.theta_deg.shape != (count,) or self.phi_deg.shape != (count,):
            raise ClerestoryError(
                f"{self.theta_deg.shape} polar angles do not go with {self.phi_deg.shape} azimuths (one each a point)"
            )
        if self.values.shape != (count, len(self.channels)):
            raise ClerestoryError(
                f"values of shape {self.values.shape} do not go with {count} points of {len(self.channels)} channels"
            )
        if self.standard_errors is not None:
            errors = np.ascontiguousarray(self.standard_errors, dtype=np.float64)
            if errors.shape != self.values.shape:
                raise ClerestoryError(f"standard errors of shape {errors.shape} do not go with {self.values.shape}")
            object.__setattr__(self, "standard_errors", errors)
        for array in (self.theta_deg, self.phi_deg, self.values, self.standard_errors):
            if array is not None:
                array.flags.writeable = False
        direction(self.incident_theta_deg, self.incident_phi_deg, side=self.incident_side)  # angles in range
        beyond = self.theta_deg[~((self.theta_deg >= 0.0) & (self.theta_deg <= 90.0))]
        if beyond.size:
            raise ClerestoryError(f"theta_deg {beyond[0]:g} is not an angle to the normal (0 to 90°, and a side)")
        if not np.isfinite(self.phi_deg).all():
            raise ClerestoryError("an azimuth is not a number")

    def __len__(self) -> int:
        return len(self.theta_deg)

    @property
    def side(self) -> Side:
        """Side that the light leaves to."""
        return outgoing_side(self.incident_side, self.scatter)

    @property
    def incident(self) -> Floats:
        """Unit vector toward the source (3,)."""
        return direction(self.incident_theta_deg, self.incident_phi_deg, side=self.incident_side)

    @property
    def outgoing(self) -> Floats:
        """Unit vectors along the light (points, 3)."""
        return direction(self.theta_deg, self.phi_deg, side=self.side)

    def channel(self, name: str) -> Floats:
        """Values of one channel (points,).

        Raises
        ------
        ClerestoryError
            There is no such channel.
        """
        if name not in self.channels:
            raise ClerestoryError(f"no channel {name!r} (there are {', '.join(self.channels)})")
        return self.values[:, self.channels.index(name)]

    def as_bsdf(self) -> Scan:
        """The same points as BSDF [1/sr]; points of DSF at 90°, whose BSDF is unknown, are left out.

        Raises
        ------
        ClerestoryError
            The values are a detector's signal, which only a reference beam turns into a BSDF.
        """
        if self.quantity == "bsdf":
            return self
        if self.quantity == "signal":
            raise ClerestoryError("a detector's signal is not a BSDF (prepare it with a scan of the beam)")
        cosine = np.cos(np.radians(self.theta_deg))
        kept = cosine > 1e-6
        per = cosine[kept, None]
        return replace(
            self,
            theta_deg=self.theta_deg[kept],
            phi_deg=self.phi_deg[kept],
            values=self.values[kept] / per,
            quantity="bsdf",
            standard_errors=None if self.standard_errors is None else self.standard_errors[kept] / per,
        )


@dataclass(frozen=True)
class Measurement:
    """All scans of one sample that belong together."""

    sample: str
    """Name of the sample."""
    scans: tuple[Scan, ...]
    warnings: tuple[str, ...] = ()
    """What was odd in the files, in words."""

    def __len__(self) -> int:
        return len(self.scans)

    def of(
        self, side: Side | None = None, scatter: Scatter | None = None, *, purpose: Purpose = "sample"
    ) -> tuple[Scan, ...]:
        """The scans of light from a side, transmitted or reflected."""
        return tuple(
            scan
            for scan in self.scans
            if scan.purpose == purpose and side in (None, scan.incident_side) and scatter in (None, scan.scatter)
        )


CONDITIONS: dict[str, str] = {
    "laboratory": "who measured",
    "operator": "person who measured",
    "instrument": "make and model",
    "date": "day, or day and time (ISO 8601)",
    "manufacturer": "of the sample",
    "description": "of the sample, in words",
    "thickness_mm": "of the sample",
    "lamp": "source of light and its spectrum",
    "detector": "kind and filter",
    "filter": "in the beam",
    "spot_mm": "diameter of the lit spot",
    "period_mm": "of the sample's structure",
    "sample_mm": "shorter side of the sample",
    "position": "on the sample, where several were measured",
    "attenuation": "factor by which light was weakened for this scan, by a filter or a lower gain",
    "sphere_mm": "diameter of an integrating sphere",
    "port_mm": "diameter of the port that the sample lies on",
    "source_cone_deg": "full angle of the beam",
    "detector_cone_deg": "full angle that the detector takes in",
    "wavelength_nm": "of the light",
    "hemispherical": "direct-hemispherical value that the file states for this scan",
    "symmetry": "that the file states, or that was found and used",
    "made": "how points that were not measured came about: an image under a symmetry, or reversed paths",
    "noise_dsf": "standard deviation of the noise of BSDF·cos θ [1/sr], one a channel",
}
"""Keys of `Scan.conditions` that mean the same whatever file they came from."""


def incident_directions(scans: Sequence[Scan]) -> Floats:
    """Unit vectors toward the source (scans, 3)."""
    return np.array([scan.incident for scan in scans]).reshape(-1, 3)
