"""Data sets as materials of Mitsuba 3, which renders them with any of its integrators, lights and shapes.

A shape's normal is the data set's +z: it points into the room. Its +y is upwards along the shape, by the world's `up`
or, without one, along the shape's texture coordinate v, as a rectangle has it. Both sides scatter; beams stay beams.

Mitsuba's path tracers ask where light comes from, given where it goes to; for them the reversed paths of the data set
are drawn (`Model.reciprocal`), so that data which are not reciprocal are rendered as they are.

Examples
--------
A scene in a dictionary takes a data set as it is::

    import clerestory, mitsuba as mi
    from clerestory.mitsuba import material

    mi.set_variant("llvm_ad_rgb")
    window = {"type": "rectangle", "bsdf": material(clerestory.read("window.xml"), up=(0, 0, 1))}

References
----------
Jakob, Speierer, Roussel, Vicini 2022, "Dr.Jit: a just-in-time compiler for differentiable rendering", ACM Transactions
on Graphics 41, for wavefronts of rays.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.bsdf import Bsdf
from clerestory.directions import SCATTERS, SIDES, direction, outgoing_side
from clerestory.files import read
from clerestory.model import Model

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side

    Floats = NDArray[np.float64]
    Mask = NDArray[np.bool_]

try:
    import drjit as dr
    import mitsuba as mi
except ModuleNotFoundError as error:
    raise ClerestoryError("rendering with Mitsuba needs it (pip install 'clerestory[mitsuba]')") from error

GRAZING = 1e-6
"""Cosines below this count as along the surface, where nothing is scattered."""


def material(data: Bsdf, *, band: str | None = None, up: Sequence[float] | None = None) -> Any:
    """A material for scenes of Mitsuba's current variant.

    Parameters
    ----------
    data
        Its missing reflections and transmissions are black, and Mitsuba's log says so.
    band
        Name of a band, which all colours have; visible, or the first, by default.
    up
        Direction of the world (3,) that the sample's +y follows; the shape's own v by default.

    Returns
    -------
    A `mitsuba.BSDF`, to stand in a dictionary of a scene.

    Raises
    ------
    ClerestoryError
        No variant is set or it is a polarised one, or the data set has no such band.

    Notes
    -----
    Look-ups are made by Clerestory, outside of Mitsuba's compiled kernels. So loops, calls and branches of Dr.Jit run
    step by step from then on (`drjit.JitFlag`), and nothing is differentiated through the material.
    """
    return _kind(_variant())(mi.Properties(), data, band, up)


def register(name: str = "clerestory") -> None:
    """Make files a type of material in scenes of the current variant, also in scenes of XML.

    Its properties are `filename`, and `band` and `up` as in `material`.

    Parameters
    ----------
    name
        Name of the type.
    """

    def made(properties: Any) -> Any:
        if "filename" not in properties:
            raise ClerestoryError(f"a material of type {name!r} needs filename, that of a BSDF")
        band = properties.get("band", "") or None
        up = [float(x) for x in properties["up"]] if "up" in properties else None
        return _kind(_variant())(properties, read(str(properties["filename"])), band, up)

    _variant()
    mi.register_bsdf(name, made)


def _variant() -> str:
    name = mi.variant()
    if name is None:
        raise ClerestoryError("Mitsuba has no variant yet (call mitsuba.set_variant, with llvm_ad_rgb for instance)")
    if "polarized" in name:
        raise ClerestoryError(f"data sets know no polarisation, which variant {name} needs (take one without)")
    return str(name)


@cache
def _kind(variant: str) -> Any:
    """The class of materials for a variant; Mitsuba has base classes for each."""
    del variant

    class Scattering(mi.BSDF):  # type: ignore[misc]
        """A data set."""

        def __init__(self, properties: Any, data: Bsdf, band: str | None, up: Sequence[float] | None) -> None:
            mi.BSDF.__init__(self, properties)
            self.ways = Ways(data, band)
            self.up = None if up is None else mi.Vector3f(*up)
            both = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
            kinds = [mi.BSDFFlags.GlossyReflection, mi.BSDFFlags.GlossyTransmission]
            if self.ways.beams:
                kinds += [mi.BSDFFlags.DeltaReflection, mi.BSDFFlags.DeltaTransmission]
            self.m_components = [kind | both for kind in kinds]
            self.m_flags = self.m_components[0]
            for component in self.m_components[1:]:
                self.m_flags = self.m_flags | component
            if dr.is_jit_v(mi.Float):
                for flag in (dr.JitFlag.SymbolicLoops, dr.JitFlag.SymbolicCalls, dr.JitFlag.SymbolicConditionals):
                    dr.set_flag(flag, False)

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            del sample1
            axes, wi = self._seen(ctx, si, active)
            drawn = self.ways.sample(wi, _rows(sample2), _mask(active), forward=ctx.mode == mi.TransportMode.Importance)
            names = ("GlossyReflection", "GlossyTransmission", "DeltaReflection", "DeltaTransmission")
            flags = np.array([int(getattr(mi.BSDFFlags, name)) for name in names], dtype=np.uint32)
            found = mi.BSDFSample3f()
            found.wo = _vector(_from(axes, drawn.towards))
            found.pdf = _number(drawn.pdf)
            found.eta = 1.0
            found.sampled_component = _number(drawn.component, np.uint32)
            found.sampled_type = _number(flags[drawn.component], np.uint32)
            return found, mi.UnpolarizedSpectrum(_number(drawn.weight))

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return mi.UnpolarizedSpectrum(_number(self._asked(ctx, si, wo, active)[0]))

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return _number(self._asked(ctx, si, wo, active)[1])

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            value, density = self._asked(ctx, si, wo, active)
            return mi.UnpolarizedSpectrum(_number(value)), _number(density)

        def to_string(self) -> str:
            return f"Clerestory[{self.ways.name}]"

        def _asked(self, ctx: Any, si: Any, wo: Any, active: Any) -> tuple[Floats, Floats]:
            axes, wi = self._seen(ctx, si, active)
            forward = ctx.mode == mi.TransportMode.Importance
            return self.ways.evaluate(wi, _into(axes, _rows(wo)), _mask(active), forward=forward)

        def _seen(self, ctx: Any, si: Any, active: Any) -> tuple[Floats | None, Floats]:
            """The sample's +y in the shape's plane (n, 2), and where rays come from in the sample's frame (n, 3)."""
            if ctx.component != mi.BSDFContext().component or ctx.type_mask != mi.BSDFContext().type_mask:
                raise ClerestoryError("a data set takes all its components together (leave the context as it is)")
            if self.up is None:
                return None, _rows(si.wi)
            upwards = _rows(si.to_local(self.up))[:, :2]
            length = np.linalg.norm(upwards, axis=1, keepdims=True)
            lying = length[:, 0] < GRAZING
            if (lying & _mask(active)).any():
                raise ClerestoryError("up is along the shape's normal (give another direction)")
            # Rays that are not asked for may have no frame.
            axes = np.divide(upwards, length, out=np.tile([0.0, 1.0], (len(upwards), 1)), where=~lying[:, None])
            return axes, _into(axes, _rows(si.wi))

    return Scattering


class Drawn:
    """Directions that were drawn for n rays."""

    def __init__(self, count: int) -> None:
        self.towards = np.tile([0.0, 0.0, 1.0], (count, 1))
        """(n, 3)."""
        self.pdf, self.weight = np.zeros(count), np.zeros(count)
        self.component = np.zeros(count, dtype=np.uint32)
        """0 reflected, 1 transmitted, and 2 more for beams."""


class Ways:
    """A band of a data set for light that is followed from lights (forward), and from eyes."""

    def __init__(self, data: Bsdf, band: str | None) -> None:
        name = band or ("visible" if "visible" in data.bands else data.bands[0])
        if name not in data.bands:
            raise ClerestoryError(f"there is no band {name!r} (there are {', '.join(data.bands)})")
        found: dict[tuple[Side, Scatter], Model] = {}
        for side in SIDES:
            for scatter in SCATTERS:
                try:
                    found[side, scatter] = data.model(side, scatter, name)[0]
                except MissingDataError:
                    mi.Log(mi.LogLevel.Warn, f"no {scatter} for light from the {side} is known: it is black")
                    found[side, scatter] = Model.lambertian(0.0)
        self.name = f"{data.metadata.name or 'data set'}, {name}"
        self.forward = Bsdf.from_models(found)
        self.backward = Bsdf.from_models(
            {(outgoing_side(side, scatter), scatter): model.reciprocal() for (side, scatter), model in found.items()}
        )
        theta = np.linspace(0.0, 85.0, 18)
        self.beams = any(
            self.forward.integrate(direction(theta, phi, side=side), scatter, part="direct").any()
            for side in SIDES
            for scatter in SCATTERS
            for phi in (0.0, 90.0, 180.0, 270.0)
        )

    def evaluate(self, wi: Floats, wo: Floats, active: Mask, *, forward: bool) -> tuple[Floats, Floats]:
        """BSDF times cosine of `wo`, and density with which it is drawn, (n,) each."""
        wi, wo, active = _alike(wi, wo, active)
        value, density = np.zeros(len(wi)), np.zeros(len(wi))
        some = active & (np.abs(wi[:, 2]) > GRAZING) & (np.abs(wo[:, 2]) > GRAZING)
        if some.any():
            asked = self.forward if forward else self.backward
            value[some] = np.clip(asked.evaluate(wi[some], wo[some]), 0.0, None) * np.abs(wo[some, 2])
            density[some] = asked.pdf(wi[some], wo[some])
        return value, density

    def sample(self, wi: Floats, u: Floats, active: Mask, *, forward: bool) -> Drawn:
        """Directions for uniform numbers (n, 2)."""
        wi, u, active = _alike(wi, u, active)
        drawn = Drawn(len(wi))
        some = active & (np.abs(wi[:, 2]) > GRAZING)
        if some.any():
            asked = self.forward if forward else self.backward
            samples = asked.sample(wi[some], np.clip(u[some], 0.0, 1.0 - 1e-9))
            peak, towards = samples.peak, samples.outgoing
            through = (wi[some, 2] > 0.0) != (towards[:, 2] > 0.0)
            drawn.towards[some], drawn.weight[some] = towards, samples.weights
            drawn.pdf[some] = np.where(peak, 1.0, asked.pdf(wi[some], towards))
            drawn.component[some] = through + 2 * peak
            drawn.weight[drawn.pdf <= 0.0] = 0.0
        return drawn


def _alike(first: Floats, second: Floats, active: Mask) -> tuple[Floats, Floats, Mask]:
    count = max(len(first), len(second), len(active))
    return (
        np.broadcast_to(first, (count, first.shape[1])),
        np.broadcast_to(second, (count, second.shape[1])),
        np.broadcast_to(active, (count,)),
    )


def _into(axes: Floats | None, vectors: Floats) -> Floats:
    """Vectors (n, 3) of the shape's frame in the sample's, whose +y is given in the shape's plane (n, 2)."""
    if axes is None:
        return vectors
    y, x = axes, np.column_stack([axes[:, 1], -axes[:, 0]])
    plane = np.broadcast_to(vectors[:, :2], (max(len(axes), len(vectors)), 2))
    return np.column_stack(
        [(plane * x).sum(axis=1), (plane * y).sum(axis=1), np.broadcast_to(vectors[:, 2], len(plane))]
    )


def _from(axes: Floats | None, vectors: Floats) -> Floats:
    """The way back."""
    return vectors if axes is None else _into(np.column_stack([-axes[:, 0], axes[:, 1]]), vectors)


def _rows(values: Any) -> Floats:
    """Vectors (n, k) in double precision."""
    array = np.array(values, dtype=np.float64)
    return array[None, :] if array.ndim == 1 else np.ascontiguousarray(array.T)


def _mask(active: Any) -> Mask:
    return np.atleast_1d(np.array(active, dtype=bool))


def _vector(rows: Floats) -> Any:
    if not dr.is_jit_v(mi.Float):
        return mi.Vector3f(*(float(x) for x in rows[0]))
    return mi.Vector3f(np.ascontiguousarray(rows.T, dtype=np.float32))


def _number(values: Any, kind: type = np.float32) -> Any:
    if not dr.is_jit_v(mi.Float):
        return values[0].item()
    array = mi.Float if kind is np.float32 else mi.UInt32
    return array(np.ascontiguousarray(values, dtype=kind))
