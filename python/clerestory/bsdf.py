"""Data sets: how a sample scatters light, from both sides and in one or more bands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory import _core
from clerestory.basis import Basis
from clerestory.convert import Operations
from clerestory.counts import counted
from clerestory.metadata import Metadata
from clerestory.model import Model

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Mapping

    from numpy.typing import ArrayLike, NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.files import Target

Part = Literal["all", "scattered", "direct"]


@dataclass(frozen=True)
class Region:
    """A set of outgoing directions to integrate over; made by `cone`, `ring` or `patches`."""

    spec: tuple[tuple[float, float], float, float] | tuple[_core.Basis, list[int]]
    words: str

    @classmethod
    def cone(cls, axis: ArrayLike, half_angle_deg: float) -> Region:
        """Within `half_angle_deg` [°] of an outgoing direction (3,)."""
        return cls.ring(axis, 0.0, half_angle_deg)

    @classmethod
    def ring(cls, axis: ArrayLike, inner_deg: float, outer_deg: float) -> Region:
        """Between two angles [°] from an outgoing direction (3,). Rings that join sum to the cone that they fill."""
        d = np.asarray(axis, dtype=np.float64)
        if d.shape != (3,) or not np.isfinite(d).all() or not d.any():
            raise _core.ClerestoryError(f"{axis!r} is not an outgoing direction (give x, y, z along the light)")
        x, y, _ = d / np.linalg.norm(d)
        words = f"within {outer_deg:g}°" if inner_deg == 0.0 else f"{inner_deg:g}° to {outer_deg:g}°"
        if not 0.0 <= inner_deg < outer_deg <= 180.0:
            raise _core.ClerestoryError(f"a region {words} of a direction is empty (give angles from 0 to 180°)")
        return cls(((float(x), float(y)), float(np.radians(inner_deg)), float(np.radians(outer_deg))), words)

    @classmethod
    def patches(cls, basis: Basis, indices: Iterable[int]) -> Region:
        """Patches of a basis, counted from 0."""
        chosen = [int(i) for i in indices]
        beyond = [i for i in chosen if not 0 <= i < len(basis)]
        if beyond:
            raise _core.ClerestoryError(f"{basis.name} has no patch of index {beyond[0]} (give 0 to {len(basis) - 1})")
        return cls((basis._core, chosen), f"{counted(len(chosen), 'patch', 'patches')} of {basis.name}")


@dataclass(frozen=True)
class Samples:
    """Sampled outgoing directions."""

    outgoing: NDArray[np.float64]
    """Directions (..., 3) that the light leaves to."""
    weights: NDArray[np.float64]
    """BSDF times cosine over density; the mean is the direct-hemispherical value. (...) or (..., bands)."""
    peak: NDArray[np.bool_]
    """Whether the sample is a peak rather than scattered light (...)."""


@dataclass(frozen=True)
class Peak:
    """A beam among scattered light."""

    outgoing: NDArray[np.float64]
    """Direction (3,)."""
    value: float
    """Transmittance or reflectance."""
    extent_deg: float
    """Full angular width [°]; 0 for an ideal beam."""


class Bsdf(Operations):
    """How a sample scatters light: bands, both sides, transmission and reflection.

    Directions are unit vectors pointing away from the sample, in the frame of `clerestory.directions`. The side of
    the incident direction chooses the side; the sides of both choose transmission or reflection. A missing
    transmission side is answered by reciprocity.
    """

    @classmethod
    def from_models(
        cls, models: Mapping[tuple[Side, Scatter], Model] | Mapping[str, Mapping[tuple[Side, Scatter], Model]]
    ) -> Bsdf:
        """A data set from models by side and scatter, or from such by band.

        Examples
        --------
        >>> from clerestory import Bsdf, Model
        >>> Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.5)}).bands
        ('visible',)
        """
        by_band: dict[str, dict[tuple[Side, Scatter], Model]] = {}
        for key, value in models.items():
            if isinstance(key, str) and not isinstance(value, Model):
                by_band[key] = dict(value)
            elif isinstance(value, Model) and not isinstance(key, str):
                by_band.setdefault("visible", {})[key] = value
            else:
                raise _core.ClerestoryError(
                    f"models by side and scatter, or from such by band, are asked for, not {key!r}"
                )
        return cls(
            _core.Bsdf(
                [
                    (band, None, None, [(side, scatter, m._core) for (side, scatter), m in members.items()])
                    for band, members in by_band.items()
                ]
            )
        )

    @property
    def bands(self) -> tuple[str, ...]:
        """Names of the bands."""
        return tuple(name for name, *_ in self._core.bands())

    @property
    def models(self) -> dict[str, dict[tuple[Side, Scatter], Model]]:
        """The models that the data set holds, by band, side of incidence and scatter."""
        return {
            name: {(side, scatter): Model(core) for side, scatter, core in members}
            for name, _, _, members in self._core.bands()
        }

    @property
    def warnings(self) -> list[str]:
        """What was faulty or surprising in the file that it came from."""
        return self._core.warnings

    def __repr__(self) -> str:
        from clerestory.describe import as_text

        return as_text(self)

    def _repr_html_(self) -> str:
        from clerestory.describe import as_html

        return as_html(self)

    def write(self, path: str | os.PathLike[str], *, target: Target = "plain") -> list[str]:
        """Write a file, whole or not at all.

        Parameters
        ----------
        path
            `.xml`, `.xml.gz` or, for Clerestory's own file that holds every kind of model, `.bsdf.npz`.
        target
            Program that the XML file is for. `plain` keeps all; `radiance` keeps visible light and its colour;
            `window` and `energyplus` ask for solar and visible data on a Klems basis and for thermal data.

        Returns
        -------
        list of str
            What the target could not take or what was filled in for it.

        Raises
        ------
        UnsupportedError
            XML cannot hold such models: convert them first.
        MissingDataError
            The target needs something that the data set does not hold; the text names it.
        OSError
            The file cannot be written.
        """
        from clerestory.files import write

        return write(self, path, target=target)

    @property
    def metadata(self) -> Metadata:
        """What is known of the sample besides scattering."""
        return Metadata.of(self._core)

    def with_metadata(self, **fields: str | float) -> Bsdf:
        """The same models with some of the sample's data given.

        Parameters
        ----------
        fields
            Any of name, product_name, manufacturer, device_type, thickness_m, width_m, height_m [m],
            emissivity_exterior, emissivity_interior, tir, openness (0 to 1), thermal_conductivity [W/(m K)].

        Raises
        ------
        ClerestoryError
            A name that is not known, or a value that makes no sense.

        Examples
        --------
        >>> from clerestory import Bsdf, Model
        >>> glass = Bsdf.from_models({("exterior", "transmission"): Model.specular(0.9)})
        >>> glass.with_metadata(name="clear", thickness_m=0.004).metadata.thickness_m
        0.004
        """
        return Bsdf(self._core.with_metadata_fields(list(fields.items())))

    def model(self, side: Side, scatter: Scatter, band: str | None = None) -> tuple[Model, bool]:
        """The model of a component, and whether it was answered by reciprocity.

        Raises
        ------
        MissingDataError
            The data set holds neither it nor, for transmission, the other side's.
        """
        core, by_reciprocity = self._core.component(band, side, scatter)
        return Model(core), by_reciprocity

    def evaluate(self, incident: ArrayLike, outgoing: ArrayLike, band: str | None = None) -> NDArray[np.float64]:
        """BSDF of the scattered light [1/sr]; peaks are not in it.

        Parameters
        ----------
        incident, outgoing
            Directions (..., 3) that broadcast with each other.
        band
            Name of a band; visible, or the first, by default.
        """
        i, o, shape = _pairs(incident, outgoing)
        return self._core.evaluate(i, o, [band])[:, 0].reshape(shape)

    def pdf(
        self,
        incident: ArrayLike,
        outgoing: ArrayLike,
        band: str | Iterable[str] | None = None,
        *,
        scatter: Scatter | None = None,
    ) -> NDArray[np.float64]:
        """Density with which `sample`, asked for the same band or bands, gives a scattered direction [1/sr]."""
        i, o, shape = _pairs(incident, outgoing)
        names: list[str | None] = [band] if band is None or isinstance(band, str) else [*band]
        return self._core.pdf(i, o, names, scatter).reshape(shape)

    def sample(
        self,
        incident: ArrayLike,
        u: ArrayLike,
        band: str | Iterable[str] | None = None,
        *,
        scatter: Scatter | None = None,
    ) -> Samples:
        """Outgoing directions for uniform numbers.

        Parameters
        ----------
        incident
            Directions (..., 3) toward sources.
        u
            Numbers (..., 2) in [0, 1); the leading axes broadcast with those of `incident`.
        band
            One band, or several: then the weights have a last axis of bands.
        scatter
            Only transmitted or only reflected light; both by default.
        """
        towards, numbers = np.asarray(incident, dtype=np.float64), np.asarray(u, dtype=np.float64)
        shape = np.broadcast_shapes(towards.shape[:-1], numbers.shape[:-1])
        i, _, _ = _rows(np.broadcast_to(towards, (*shape, 3)), 3)
        numbers = np.broadcast_to(numbers, (*shape, 2)).reshape(-1, 2)
        several = band is not None and not isinstance(band, str)
        names: list[str | None] = list(band) if several else [band]  # type: ignore[arg-type, list-item]
        outgoing, weights, peak = self._core.sample(i, np.ascontiguousarray(numbers), names, scatter)
        weights = weights.reshape(*shape, len(names)) if several else weights[:, 0].reshape(shape)
        return Samples(outgoing.reshape(*shape, 3), weights, peak.reshape(shape))

    def peaks(self, incident: ArrayLike, scatter: Scatter, band: str | None = None) -> list[Peak]:
        """Peaks for light from one direction (3,)."""
        i, _, _ = _rows(incident, 3)
        return [
            Peak(np.array(direction), value, float(np.degrees(extent)))
            for _, direction, value, extent in self._core.peaks(i, band, scatter)
        ]

    def integrate(
        self,
        incident: ArrayLike,
        scatter: Scatter,
        region: Region | None = None,
        band: str | None = None,
        *,
        part: Part = "all",
    ) -> NDArray[np.float64]:
        """Flux into a region of outgoing directions per unit of incident flux.

        Parameters
        ----------
        incident
            Directions (..., 3) toward sources.
        scatter
            Transmission or reflection.
        region
            A cone, a ring or patches; the whole hemisphere by default, which gives the direct-hemispherical value.
        part
            All light, scattered light only, or peaks only.
        """
        return self.integrate_with_error(incident, scatter, region, band, part=part)[0]

    def integrate_with_error(
        self,
        incident: ArrayLike,
        scatter: Scatter,
        region: Region | None = None,
        band: str | None = None,
        *,
        part: Part = "all",
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """As `integrate`, with the standard error (NaN where the model has none)."""
        i, _, shape = _rows(incident, 3)
        spec = None if region is None else region.spec
        value, error = self._core.integrate(i, band, scatter, spec, part)
        return value.reshape(shape), error.reshape(shape)

    def resolution_deg(self, incident: ArrayLike, scatter: Scatter, band: str | None = None) -> NDArray[np.float64]:
        """Full angle [°] below which detail is not resolved; 0 for a model without a grid."""
        i, _, shape = _rows(incident, 3)
        return np.degrees(self._core.resolution(i, band, scatter)).reshape(shape)

    def with_models(self, models: Mapping[str, Mapping[tuple[Side, Scatter], Model]]) -> Bsdf:
        """The same data set, its metadata too, with some of the components that it has replaced.

        Parameters
        ----------
        models
            New models by band, side of incidence and scatter, as in `models`.

        Raises
        ------
        MissingDataError
            The data set has no such component.
        """
        held = self.models
        for band, members in models.items():
            for side, scatter in members:
                if (side, scatter) not in held.get(band, {}):
                    raise _core.MissingDataError(
                        f"band {band!r} has no {scatter} from the {side} that could be replaced (see .models)"
                    )
        parts = [
            (band, side, scatter, model._core)
            for band, members in models.items()
            for (side, scatter), model in members.items()
        ]
        return Bsdf(self._core.with_components(parts))

    def flipped(self) -> Bsdf:
        """The sample turned about its vertical axis: the interior face becomes the exterior one."""
        return Bsdf(self._core.flipped())

    def rotated(self, angle_deg: float) -> Bsdf:
        """The sample turned in its plane, counter-clockwise as seen from the room [°]."""
        if not np.isfinite(angle_deg):
            raise _core.ClerestoryError(f"{angle_deg} is not an angle to turn by (give degrees)")
        return Bsdf(self._core.turned(float(np.radians(angle_deg)), mirror=False))

    def mirrored(self) -> Bsdf:
        """The sample's mirror image, left to right."""
        return Bsdf(self._core.turned(0.0, mirror=True))

    @classmethod
    def merged(cls, sets: Iterable[Bsdf]) -> Bsdf:
        """Bands of several data sets of one sample as one."""
        return cls(_core.Bsdf.merged([s._core for s in sets]))


def _rows(array: ArrayLike, width: int) -> tuple[NDArray[np.float64], int, tuple[int, ...]]:
    a = np.asarray(array, dtype=np.float64)
    return np.ascontiguousarray(a.reshape(-1, a.shape[-1] if a.ndim else 1)), width, a.shape[:-1]


def _pairs(
    incident: ArrayLike, outgoing: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], tuple[int, ...]]:
    i, o = np.broadcast_arrays(np.asarray(incident, dtype=np.float64), np.asarray(outgoing, dtype=np.float64))
    return (
        np.ascontiguousarray(i.reshape(-1, i.shape[-1])),
        np.ascontiguousarray(o.reshape(-1, o.shape[-1])),
        i.shape[:-1],
    )
