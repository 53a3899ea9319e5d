"""Measured materials of RGL's database, which Mitsuba and pbrt read: tensor files with spectra or RGB."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.directions import direction
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import ABOVE_DEG, lit_side, sample_of
from clerestory.measure.formats.evaluated import hemisphere, incident_angles
from clerestory.measure.formats.measured_material import MeasuredMaterial
from clerestory.measure.formats.specular import seen_from
from clerestory.measure.formats.tensor_file import MAGIC, arrays
from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source, digest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

NAME = "RGL tensor file"

_RGB = ("red", "green", "blue")


def recognises(data: bytes, name: str) -> bool:
    """Whether it begins with the title of a tensor file."""
    return data.startswith(MAGIC)


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans that the file's parametrisation gives, by 5° and finer about the mirrored direction.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `incident_theta_deg` and, for an anisotropic material, `incident_phi_deg`: incident angles [°] instead of
        those of the file; `side` that the light comes from (exterior); `sample`.

    Raises
    ------
    FileFormatError
        A field is missing, does not fit the others or holds no numbers.
    """
    fields = arrays(data)
    material, channels = _material(fields)
    side = lit_side(choices)
    description = bytes(np.asarray(fields.get("description", np.zeros(0)), dtype=np.uint8).tobytes())
    text = description.decode("utf-8", errors="replace").strip("\0 \n")
    shapes = [f"{key}: {values.dtype} {list(values.shape)}" for key, values in fields.items()]
    source = Source(
        name,
        digest(data),
        NAME,
        (*text.splitlines(), *shapes),
        f"reflection; azimuths counter-clockwise from the right as seen from the {side}"
        + ("; light from above, since none of its own is given" if material.isotropic else ""),
    )
    own = np.degrees(material.theta_i[material.theta_i < np.radians(89.5)])
    thetas = incident_angles(choices, "incident_theta_deg", np.round(own, 4), 0.0, 89.5)
    turned = seen_from(side, np.degrees(material.phi_i))
    around = np.array([ABOVE_DEG]) if material.isotropic else np.round(turned, 4)
    scans = []
    for phi in incident_angles(choices, "incident_phi_deg", around, -360.0, 360.0):
        for theta in thetas:
            theta_deg, phi_deg = hemisphere(float(theta), float(phi), side, "reflection")
            # In the file's frame the lit side is up.
            incident = direction(float(theta), float(seen_from(side, phi)), side="interior")
            outgoing = direction(theta_deg, seen_from(side, phi_deg), side="interior")
            scans.append(
                Scan(
                    side,
                    "reflection",
                    float(theta),
                    float(phi),
                    theta_deg,
                    phi_deg,
                    material.evaluate(incident, outgoing),
                    channels=channels,
                    conditions={
                        "description": " ".join(text.split()),
                        "evaluated": "from the adaptive parametrisation",
                    },
                    source=source,
                )
            )
    notes = (f"{name}: a parametrisation evaluated at {len(scans)} incident directions",)
    return Contents((Measurement(sample_of(choices, name), tuple(scans)),), (), notes)


def _material(fields: dict[str, NDArray[np.generic]]) -> tuple[MeasuredMaterial, tuple[str, ...]]:
    """The material of a file's fields and the names of its channels."""
    coloured = "rgb" if "spectra" not in fields and "rgb" in fields else "spectra"
    jacobian = _field(fields, "jacobian", 1).ravel() if "jacobian" in fields else np.zeros(1)
    theta_i, phi_i = _field(fields, "theta_i", 1), _field(fields, "phi_i", 1)
    vndf, spectra = _field(fields, "vndf", 4), _field(fields, coloured, 5)
    for key, angles in (("theta_i", theta_i), ("phi_i", phi_i)):
        limit = np.pi / 2 if key == "theta_i" else 2.0 * np.pi
        if not (np.diff(angles) > 0.0).all() or abs(angles).max() > limit + 1e-3:
            raise FileFormatError(f"field {key}: angles do not rise within the hemisphere [rad] (is the file whole?)")
    incident = (len(phi_i), len(theta_i))
    if vndf.shape[:2] != incident or spectra.shape[:2] != incident:
        raise FileFormatError(
            f"fields vndf and {coloured} do not have {incident} incident directions (is the file whole?)"
        )
    if min(*vndf.shape[2:], *spectra.shape[3:]) < 2:
        raise FileFormatError(f"fields vndf and {coloured} have grids of fewer than 2 nodes (is the file whole?)")
    if coloured == "rgb":
        channels: tuple[str, ...] = _RGB
    else:
        channels = tuple(f"{wave:.10g} nm" for wave in np.round(_field(fields, "wavelengths", 1), 4))
    if spectra.shape[2] != len(channels) or len(set(channels)) < len(channels):
        raise FileFormatError(
            f"field {coloured} has {spectra.shape[2]} channels where {len(channels)} are named (is the file whole?)"
        )
    scaled = bool(jacobian.size) and bool(jacobian[0])
    ndf, sigma = (_field(fields, key, 2) if scaled else None for key in ("ndf", "sigma"))
    if ndf is not None and sigma is not None and min(*ndf.shape, *sigma.shape) < 2:
        raise FileFormatError("fields ndf and sigma have grids of fewer than 2 nodes (is the file whole?)")
    if vndf.min() < 0.0:
        raise FileFormatError("field vndf: a density is negative (is the file whole?)")
    return MeasuredMaterial(theta_i, phi_i, vndf, spectra, ndf, sigma), channels


def _field(fields: dict[str, NDArray[np.generic]], key: str, dimensions: int) -> Floats:
    """A field of finite numbers with so many dimensions; large ones stay as they lie in the file."""
    if key not in fields:
        raise FileFormatError(f"no field {key} (is it a measured material?)")
    values = fields[key]
    if values.ndim != dimensions or not values.size:
        raise FileFormatError(
            f"field {key} has shape {list(values.shape)} instead of {dimensions} dimensions (is it a material?)"
        )
    if not (values.min() >= -1e30 and values.max() <= 1e30):
        raise FileFormatError(f"field {key} holds values that are no numbers (is the file whole?)")
    return values if dimensions > 2 else values.astype(np.float64)  # type: ignore[return-value]
