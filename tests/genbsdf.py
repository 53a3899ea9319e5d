"""genBSDF's job by pyradiance's `generate_bsdf`, and the scenes on which both programs are compared."""

from __future__ import annotations

import contextlib
import io
import itertools
import math
import os
import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyradiance
import pyradiance.genbsdf
from pyradiance.genbsdf import SamplingBox, generate_bsdf

import clerestory
from clerestory import Model

PACKAGE = Path(pyradiance.__file__).parent
PROGRAMS = PACKAGE / "bin"
#: One path a sample, ended by roulette: what a path tracer does. The default of 700 rays a bounce is far slower to the
#: same error.
ONE_PATH = ("-ab", "30", "-ad", "1", "-lw", "1e-5", "-lr", "-30", "-st", "0")


@dataclass(frozen=True)
class Scene:
    """A sample as a Radiance scene; the exterior is at z < 0, the room begins at z = 0 [m]."""

    name: str
    text: str
    """Radiance description."""
    x: tuple[float, float]
    """Sampled part along x [m]."""
    y: tuple[float, float]
    """Sampled part along y [m]."""
    depth: float
    """From z = -depth to 0 [m]."""

    def write(self, folder: Path) -> Path:
        """As a .rad file."""
        path = folder / f"{self.name}.rad"
        path.write_text(self.text)
        return path


def _polygon(material: str, name: str, points: list[tuple[float, float, float]]) -> str:
    numbers = "\n".join(" ".join(f"{v:.9g}" for v in p) for p in points)
    return f"{material} polygon {name}\n0\n0\n{3 * len(points)}\n{numbers}\n"


def _strip(material: str, name: str, a: tuple[float, float], b: tuple[float, float], half: float) -> str:
    """A strip along x from a to b, both (z, y); its front is on the left of the way, z to the right and y up."""
    return _polygon(material, name, [(-half, b[1], b[0]), (half, b[1], b[0]), (half, a[1], a[0]), (-half, a[1], a[0])])


def _slat(width: float, crown: float, tilt_deg: float, facets: int) -> list[tuple[float, float]]:
    """Points (z, y) from the exterior edge to the interior one, crown up; tilted, the exterior edge down."""
    if crown == 0.0:
        points = [(-width / 2, 0.0), (width / 2, 0.0)]
    else:
        radius = (crown**2 + width**2 / 4) / (2 * crown)
        edge = math.asin(width / 2 / radius)
        angles = [-edge + 2 * edge * k / facets for k in range(facets + 1)]
        points = [(radius * math.sin(a), radius * math.cos(a) - radius + crown / 2) for a in angles]
    s, c = math.sin(math.radians(tilt_deg)), math.cos(math.radians(tilt_deg))
    return [(z * c - y * s, z * s + y * c) for z, y in points]


def blind(
    name: str,
    material: str,
    *,
    crown: float = 0.0,
    tilt_deg: float = 0.0,
    facets: int = 24,
    width: float = 0.08,
    pitch: float = 0.072,
    slats: int = 61,
) -> Scene:
    """A venetian blind, so wide and high that its edges are not seen; its material is called `slat`."""
    points = _slat(width, crown, tilt_deg, facets)
    front, half = max(z for z, _ in points), slats * pitch / 2
    depth = front - min(z for z, _ in points)
    text = [material]
    for k in range(slats):
        y0 = (k - slats // 2 + 0.5) * pitch
        for n, ((za, ya), (zb, yb)) in enumerate(itertools.pairwise(points)):
            text.append(_strip("slat", f"s{k}.{n}", (za - front, ya + y0), (zb - front, yb + y0), half))
    return Scene(name, "".join(text), (-pitch / 2, pitch / 2), (0.0, pitch), max(depth, 1e-6))


def prisms(name: str = "prisms", *, pitch: float = 0.001, base: float = 0.001, prisms: int = 401) -> Scene:
    """A film of right-angled prisms, their ridges to the exterior, of acrylic."""
    text = ["void dielectric slat\n0\n0\n5 1 1 1 1.49 0\n"]
    half = prisms * pitch / 2
    ridge, valley = -base - pitch / 2, -base
    low = -(prisms // 2) * pitch
    # Round the body with its outside on the left.
    way = [(0.0, low)]
    for k in range(prisms):
        way += [(valley, low + k * pitch), (ridge, low + (k + 0.5) * pitch)]
    way += [(valley, low + prisms * pitch), (0.0, low + prisms * pitch)]
    for k, (a, b) in enumerate(itertools.pairwise([*way, way[0]])):
        text.append(_strip("slat", f"s{k}", a, b, half))
    text.append(_polygon("slat", "right", [(half, y, z) for z, y in way]))
    text.append(_polygon("slat", "left", [(-half, y, z) for z, y in reversed(way)]))
    return Scene(name, "".join(text), (-pitch / 2, pitch / 2), (0.0, pitch), base + pitch / 2)


def perforated(name: str = "perforated", *, pitch: float = 0.004, hole: float = 0.002, holes: int = 41) -> Scene:
    """A thin sheet with square holes."""
    text = ["void plastic slat\n0\n0\n5 .5 .5 .5 0 0\n"]
    half = holes * pitch / 2
    edge = (pitch - hole) / 2
    for k in range(holes):
        y = (k - holes // 2) * pitch
        for a, b in ((y, y + edge), (y + pitch - edge, y + pitch)):
            text.append(_polygon("slat", f"h{k}.{a:.6f}", [(-half, a, 0), (half, a, 0), (half, b, 0), (-half, b, 0)]))
        for n in range(holes):
            x = (n - holes // 2) * pitch
            a, b = y + edge, y + pitch - edge
            for c, d in ((x, x + edge), (x + pitch - edge, x + pitch)):
                text.append(_polygon("slat", f"v{k}.{n}.{c:.6f}", [(c, a, 0), (d, a, 0), (d, b, 0), (c, b, 0)]))
    return Scene(name, "".join(text), (0.0, pitch), (0.0, pitch), 1e-6)


def wires(name: str = "wires", *, pitch: float = 0.0015, diameter: float = 0.0003, count: int = 81) -> Scene:
    """A mesh of round wires, those along x before those along y."""
    text = ["void metal slat\n0\n0\n5 .6 .6 .6 .8 .03\n"]
    half, radius = count * pitch / 2, diameter / 2
    for k in range(count):
        at = (k - count // 2 + 0.5) * pitch
        text.append(f"slat cylinder x{k}\n0\n0\n7 {-half} {at} {-radius} {half} {at} {-radius} {radius}\n")
        z = -3 * radius
        text.append(f"slat cylinder y{k}\n0\n0\n7 {at} {-half} {z} {at} {half} {z} {radius}\n")
    return Scene(name, "".join(text), (0.0, pitch), (0.0, pitch), 2 * diameter)


def _plastic(reflectance: float, specular: float = 0.0, roughness: float = 0.0) -> str:
    return f"void plastic slat\n0\n0\n5 {reflectance} {reflectance} {reflectance} {specular} {roughness}\n"


def scenes() -> list[Scene]:
    """One of each kind that laboratories model."""
    # Rough metal is nearly smooth: with one path a sample the peer leaves out the weights of wide lobes.
    return [
        blind("flat_00", _plastic(0.5)),
        blind("flat_45", _plastic(0.7), tilt_deg=45.0),
        blind("curved_00", _plastic(0.5), crown=0.010),
        blind("curved_30", _plastic(0.7), crown=0.010, tilt_deg=30.0),
        blind("glossy_30", _plastic(0.5, 0.1, 0.15), crown=0.010, tilt_deg=30.0),
        blind("metal_20", "void metal slat\n0\n0\n5 .8 .8 .8 .9 .03\n", tilt_deg=20.0),
        blind("mirror_15", "void metal slat\n0\n0\n5 .8 .8 .8 1 0\n", tilt_deg=15.0),
        prisms(),
        perforated(),
        wires(),
    ]


@dataclass
class Clock:
    """Time of the peer's run [s]."""

    whole: float = 0.0
    """All of it."""
    rays: float = 0.0
    """Inside of rfluxmtx."""


@contextlib.contextmanager
def _timed(clock: Clock) -> Iterator[None]:
    """Times what happens, and rfluxmtx in it."""
    original = pyradiance.genbsdf.rfluxmtx

    def rfluxmtx(*args: Any, **kwargs: Any) -> Any:
        start = time.perf_counter()
        try:
            return original(*args, **kwargs)
        finally:
            clock.rays += time.perf_counter() - start

    start = time.perf_counter()
    pyradiance.genbsdf.rfluxmtx = rfluxmtx
    try:
        yield
    finally:
        pyradiance.genbsdf.rfluxmtx = original
        clock.whole += time.perf_counter() - start


def generate(
    scene: Scene,
    folder: Path,
    *,
    samples: int,
    processes: int = 1,
    levels: int = 0,
    params: tuple[str, ...] = ONE_PATH,
    clock: Clock | None = None,
) -> clerestory.Bsdf:
    """The peer's result: Klems full, or a tensor tree of 2^levels cells an axis. No reciprocity averaging.

    The clock is given the time of `generate_bsdf` alone, without wrapping and reading.
    """
    # The package looks for its own programs on the path.
    os.environ["RAYPATH"] = f".:{PACKAGE / 'lib'}"
    box = SamplingBox(*scene.x, *scene.y, -scene.depth, 0.0)
    target: dict[str, Any] = {"tensortree": 4, "ttlog2": levels, "pctcull": 0} if levels else {"basis": "kf"}
    with contextlib.redirect_stdout(io.StringIO()), _timed(clock or Clock()):
        result = generate_bsdf(
            scene.text.encode(), params=list(params), recip=False, nsamp=samples, nproc=processes, dim=box, **target
        )
    command = [str(PROGRAMS / "wrapBSDF"), "-a", "t4" if levels else "kf", "-s", "Visible"]
    for flag, data in (
        ("-tf", result.front.transmittance),
        ("-rf", result.front.reflectance),
        ("-tb", result.back.transmittance),
        ("-rb", result.back.reflectance),
    ):
        path = folder / f"{scene.name}{flag}.mtx"
        path.write_bytes(data)
        command += [flag, str(path)]
    output = folder / f"{scene.name}.genbsdf.xml"
    environment = {**os.environ, "PATH": f"{PROGRAMS}{os.pathsep}{os.environ['PATH']}"}
    output.write_bytes(subprocess.run(command, env=environment, check=True, capture_output=True).stdout)
    bsdf = clerestory.read(output)
    if levels:
        return bsdf
    # The program hands on shares of flux; a BSDF is that over the projected solid angle.
    models = {
        key: Model.matrix(
            model.values / model.outgoing_basis.projected_solid_angles[:, None],
            model.incident_basis,
            model.outgoing_basis,
        )
        for key, model in bsdf.models["visible"].items()
    }
    return clerestory.Bsdf.from_models(models)


def recipe(scene: Scene, folder: Path) -> dict[str, Any]:
    """The scene as a recipe of ours: the same file, the same sampled box."""
    path = scene.write(folder)
    region = [1000.0 * limit for limit in (*scene.x, *scene.y)]
    return {"sample": {"kind": "scene", "file": str(path), "unit": "m", "region_mm": region}}
