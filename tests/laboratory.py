"""Scans and sphere values as a laboratory would have them, for tests of the database."""

import numpy as np

from clerestory.measure import Measurement, Scan, Source, SphereValues
from clerestory.measure.contents import Contents
from clerestory.measure.source import digest


def source(name: str) -> Source:
    """A file that is told from others by its name."""
    return Source(name, digest(name.encode()), "a test's", ("# a header", "#  of two lines, é"), "the sample's frame")


def scan(theta_deg: float = 30.0, *, of: str | None = "a.txt", points: int = 500, seed: int = 1, **fields) -> Scan:
    """A scan of decimals as they stand in files, with two channels and standard errors."""
    numbers = np.random.default_rng([seed, int(theta_deg * 10.0)])
    values = np.round(numbers.lognormal(-2.0, 2.0, (points, 2)) - 0.01, 6)
    conditions = {"laboratory": "HSLU", "date": "2020-06-01T10:30", "instrument": "PG2", "lamp": "halogen"}
    given = {
        "quantity": "dsf",
        "channels": ("visible", "nir"),
        "standard_errors": np.abs(values) / 3.0,  # no decimals
        "conditions": {**conditions, "spot_mm": "12", "manufacturer": "MechoShade"},
        "source": None if of is None else source(of),
    }
    return Scan(
        "exterior",
        fields.pop("scatter", "transmission"),
        theta_deg,
        fields.pop("phi_deg", 90.0),
        np.round(numbers.uniform(0.0, 80.0, points), 3),
        np.round(numbers.uniform(0.0, 360.0, points), 3),
        values,
        **(given | fields),
    )


def sphere(*, of: str = "sphere.csv", sample: str = "twill", theta_deg: float = 8.0) -> SphereValues:
    """A spectrum of reflectance."""
    wavelengths = np.arange(380.0, 781.0, 5.0)
    values = np.round(0.3 + 0.1 * np.sin(wavelengths / 50.0), 4)
    return SphereValues(
        sample, "exterior", "reflection", theta_deg, values, wavelength_nm=wavelengths, source=source(of)
    )


def contents(*scans: Scan, sample: str = "twill", warnings: tuple[str, ...] = (), spheres=()) -> Contents:
    """What a file of one sample holds."""
    measurements = (Measurement(sample, scans, warnings),) if scans else ()
    return Contents(measurements, tuple(spheres))


def same(a: Scan, b: Scan) -> None:
    """Fail if two scans are not the same, bit by bit."""
    for name in ("theta_deg", "phi_deg", "values", "standard_errors"):
        left, right = getattr(a, name), getattr(b, name)
        assert (left is None) == (right is None), name
        if left is not None:
            assert left.shape == right.shape
            assert left.tobytes() == right.tobytes(), name
    for name in ("incident_side", "scatter", "incident_theta_deg", "incident_phi_deg", "quantity", "channels"):
        assert getattr(a, name) == getattr(b, name), name
    assert (a.purpose, dict(a.conditions), a.source) == (b.purpose, dict(b.conditions), b.source)
