"""What a data set says of its sample besides scattering."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from clerestory import _core


@dataclass(frozen=True)
class Metadata:
    """Descriptive data of a sample; None where the file does not say.

    Emissivities and thermal-infrared transmittance are hemispherical values of the whole layer.
    """

    name: str | None = None
    """Name of the sample."""
    product_name: str | None = None
    """Name under which it is sold."""
    manufacturer: str | None = None
    """Who makes it."""
    device_type: str | None = None
    """Kind of device, such as `Venetian blind horizontal`."""
    thickness_m: float | None = None
    """Thickness [m]."""
    width_m: float | None = None
    """Width [m]."""
    height_m: float | None = None
    """Height [m]."""
    emissivity_exterior: float | None = None
    """Long-wave emissivity of the exterior face."""
    emissivity_interior: float | None = None
    """Long-wave emissivity of the interior face."""
    tir: float | None = None
    """Thermal-infrared transmittance."""
    openness: float | None = None
    """Open fraction of the area, for air."""
    thermal_conductivity: float | None = None
    """Thermal conductivity [W/(m K)]."""
    element_type: str | None = None
    """`System`, `Layer` or `Material`."""
    comments: tuple[str, ...] = ()
    """Comments of the file: often the command that made it."""
    geometry: str | None = None
    """Text of an embedded geometry, usually MGF."""
    geometry_format: str | None = None
    """Format of the embedded geometry as the file names it."""

    @classmethod
    def of(cls, core: _core.Bsdf) -> Metadata:
        """The metadata of a data set of the core."""
        element_type, _, geometry, comments, _ = core.metadata_parts()
        text = form = None
        if geometry is not None:
            _, attributes, own, children = geometry
            text = "\n".join(t for t in (own, *(child[2] for child in children if child[0] == "MGFblock")) if t) or None
            form = dict(attributes).get("format")
        fields = dict(core.metadata_fields())
        return cls(
            **fields,  # type: ignore[arg-type]  # each field's type is the core's
            element_type=element_type,
            comments=tuple(comments),
            geometry=text,
            geometry_format=form,
        )
