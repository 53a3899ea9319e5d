"""Radiance's interpolant of scattering (SIR), which pabopto2bsdf makes of pab's files.

Layout: formats.md of the project's references, checked with the program; the model is that of Ward, Kurt and Bonneel
(2014). Vectors stand in Radiance's frame, +z out of its front and +y up. A file that pabopto2bsdf made has pab's front
there, which is the exterior unless a person says otherwise; Radiance's own programs take it to be the interior.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.directions import SIDES, angles, outgoing_side
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import one_of, sample_of
from clerestory.measure.formats.frame import opposite
from clerestory.measure.formats.header import HEAD, conditions_of, text_of
from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source, digest

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from clerestory.directions import Scatter, Side

    Floats = NDArray[np.float64]

NAME = "Radiance SIR interpolant"

_FORMAT = b"FORMAT=BSDF_RBFmesh"
_MAGIC = b"\x5a\x3c"
_LOBE = np.dtype([("mantissa", ">i4"), ("exponent", "i1"), ("chroma", ">u2"), ("radius", ">u2"), ("at", ">u2", 2)])
_NEAR = 38.0 / np.pi**2
"""Squared distance in cells over (grid · radius)² beyond which a lobe is left out, as Radiance does."""
_DISCERNED_DEG = 0.01
"""Measured directions are told apart by this angle [°]."""


@dataclass(frozen=True)
class Lobes:
    """Gaussian lobes of the light from one direction: DSF = Σ peak · exp((v·c - 1) / radius²)."""

    peaks: Floats
    """DSF at the centres [1/sr] (n,)."""
    centres: Floats
    """Unit vectors along the light (n, 3), in the sample's frame."""
    radii: Floats
    """[rad] (n,)."""
    cells: NDArray[np.int64]
    """Cells of the file's grid that the centres lie in (n, 2)."""
    chroma: Floats
    """u' and v' of CIE 1976 (n, 2)."""
    volume: float
    """What the file gives as their integral."""


@dataclass(frozen=True)
class SirInterpolant:
    """Measured directions and their lobes; the plans of transport between directions stay in the file."""

    side: Side
    """Side that the light comes from."""
    scatter: Scatter
    front: Side
    """What the file's +z is taken to be."""
    incident: Floats
    """Measured directions to the source (n, 3)."""
    lobes: tuple[Lobes, ...]
    """One set a direction."""
    grid: int
    """Cells along each side of the grid on the hemisphere, which are of equal solid angle."""
    least: float
    """BSDF that nothing is below [1/sr]."""
    colour: bool
    """Whether chromaticities count (CIE XYZ)."""

    def dsf(self, incident: ArrayLike, outgoing: ArrayLike) -> Floats:
        """BSDF·cos θ of the lobes [1/sr] along directions (..., 3), for light from one of the measured directions (3,).

        Raises
        ------
        ClerestoryError
            Light from there was not measured; only its neighbours are in the file.
        """
        lobes = self.lobes[self._measured(incident)]
        v = np.asarray(outgoing, dtype=np.float64)
        total = np.zeros(v.shape[:-1])
        for peak, centre, radius in zip(lobes.peaks, lobes.centres, lobes.radii, strict=True):
            total += peak * np.exp((v @ centre - 1.0) / radius**2)
        return total

    def bsdf(self, incident: ArrayLike, outgoing: ArrayLike) -> Floats:
        """BSDF [1/sr], as Radiance has it of the same file.

        The cosine that it divides by never falls below 0.02, and the result not below `least`.
        """
        cosine = np.abs(np.asarray(outgoing, dtype=np.float64)[..., 2])
        return np.asarray(np.maximum(self.dsf(incident, outgoing) / (0.98 * cosine + 0.02), self.least))

    def _measured(self, incident: ArrayLike) -> int:
        wanted = np.asarray(incident, dtype=np.float64)
        cosines = self.incident @ wanted / np.linalg.norm(wanted)
        k = int(np.argmax(cosines))
        if not cosines[k] >= np.cos(np.radians(_DISCERNED_DEG)):
            raise ClerestoryError(
                "the interpolant has no lobes for light from there (ask for one of its measured directions, `incident`)"
            )
        return k

    def sampled(self, k: int) -> tuple[Floats, Floats]:
        """Centres of all cells (cells, 3) and the lobes' DSF there (cells, channels), for direction number k.

        A lobe is left out so far away that it has less than a thousandth of a per cent of its peak.
        """
        lobes, n = self.lobes[k], self.grid
        over = 1.0 if outgoing_side(self.side, self.scatter) == self.front else -1.0
        rows, columns = np.divmod(np.arange(n * n), n)
        centres = _turned(_cell_centre(rows, columns, n, over), self.front)
        grid = centres.reshape(n, n, 3)
        tints = _tints(lobes.chroma) if self.colour else np.ones((len(lobes.peaks), 1))
        total = np.zeros((n, n, tints.shape[1]))
        reach = np.sqrt(_NEAR) * n * lobes.radii
        for peak, centre, radius, (gx, gy), away, tint in zip(
            lobes.peaks, lobes.centres, lobes.radii, lobes.cells, reach, tints, strict=True
        ):
            r = int(min(away, n)) + 1
            near = (slice(max(gx - r, 0), gx + r + 1), slice(max(gy - r, 0), gy + r + 1))
            total[near] += peak * np.exp((grid[near] @ centre - 1.0) / radius**2)[..., None] * tint
        return centres, total.reshape(n * n, -1)


def recognises(data: bytes, name: str) -> bool:
    """Whether the header names the format."""
    return _FORMAT in data[:HEAD].split(b"\n\n", 1)[0]


def read(data: bytes, name: str, **choices: object) -> Contents:
    """The lobes, sampled on the file's grid: a scan for each measured direction.

    Choices are `front` (the side that the file's +z points to), `side` (the lit one) and `sample`.
    """
    interpolant = interpolant_of(data, **choices)
    header, stated = _header(data)
    reserved = ("format", "io_sides", "gridres", "bsdfmin", "bsdfspec", "colorimetry", "name")
    conditions = conditions_of(stated.items(), reserved)
    source = Source(
        name,
        digest(data),
        NAME,
        header,
        f"front, +z, is the {interpolant.front}, +y is up, incident vectors are the source's; "
        f"lobes of a model are sampled in the middle of the cells of a {interpolant.grid} by {interpolant.grid} grid",
    )
    scans = []
    for k, incident in enumerate(interpolant.incident):
        theta_i, phi_i = angles(incident)
        outgoing, values = interpolant.sampled(k)
        theta, phi = angles(outgoing)
        scans.append(
            Scan(
                interpolant.side,
                interpolant.scatter,
                float(theta_i),
                float(phi_i),
                theta,
                phi,
                values,
                quantity="dsf",
                channels=("X", "Y", "Z") if interpolant.colour else ("visible",),
                conditions=conditions,
                source=source,
            )
        )
    return Contents((Measurement(sample_of(choices, name, stated.get("NAME", "")), tuple(scans)),))


def interpolant_of(data: bytes, **choices: object) -> SirInterpolant:
    """The interpolant itself.

    Raises
    ------
    FileFormatError
        The file is cut short, or a number in it is impossible.
    """
    _, stated = _header(data)
    ends = stated.get("IO_SIDES", "").split()
    if len(ends) != 2 or not all(end in ("1", "-1", "+1") for end in ends):
        raise FileFormatError(f"header: IO_SIDES={' '.join(ends)} is not two of 1 and -1 (make the file again)")
    into, out = (int(end) for end in ends)
    grid = _stated_number(stated, "GRIDRES")
    if not (grid.is_integer() and 1 <= grid <= 1024):
        raise FileFormatError(f"header: GRIDRES={grid:g} is not a count of cells up to 1024 (make the file again)")
    lit = cast("Side | None", one_of(choices, "side", SIDES, None))
    default: Side = "exterior" if lit is None else lit if into > 0 else opposite(lit)
    front = cast("Side", one_of(choices, "front", SIDES, default))
    incident, lobes = _directions(data, int(grid), float(out), front)
    return SirInterpolant(
        front if into > 0 else opposite(front),
        "reflection" if into == out else "transmission",
        front,
        incident,
        lobes,
        int(grid),
        _stated_number(stated, "BSDFMIN") if "BSDFMIN" in stated else 0.0,
        stated.get("COLORIMETRY", "CIE-Y").upper() == "CIE-XYZ",
    )


def _header(data: bytes) -> tuple[tuple[str, ...], dict[str, str]]:
    lines = tuple(text_of(data[:HEAD].split(b"\n\n", 1)[0]).splitlines())
    pairs = (line.strip().partition("=") for line in lines)
    return lines, {key: value.strip() for key, mark, value in pairs if mark and key.isidentifier()}


def _stated_number(stated: dict[str, str], key: str) -> float:
    try:
        number = float(stated[key])
    except (KeyError, ValueError):
        number = np.nan
    if not np.isfinite(number):
        raise FileFormatError(f"header: {key}={stated.get(key, '')} is not a number (make the file again)")
    return number


def _directions(data: bytes, grid: int, over: float, front: Side) -> tuple[Floats, tuple[Lobes, ...]]:
    at = data.find(b"\n\n") + 2
    if at < 2:
        raise FileFormatError("no empty line ends the header (the file was not transferred as binary)")
    if data[at : at + 2] != _MAGIC:
        raise FileFormatError("the numbers do not begin with 5a3c (the file was not transferred as binary)")
    at += 2
    short = FileFormatError(f"the file ends at byte {len(data)}, before its last direction (get it again)")
    incident: list[list[float]] = []
    lobes: list[Lobes] = []
    while True:
        if at + 4 > len(data):
            raise short
        (ordinal,) = struct.unpack_from(">i", data, at)
        at += 4
        if ordinal == -1:
            break
        if ordinal != len(incident) or at + 24 > len(data):
            raise (
                short
                if at + 24 > len(data)
                else FileFormatError(
                    f"byte {at - 4}: direction {ordinal} stands where {len(incident)} should (get the file again)"
                )
            )
        four = [_float5(*struct.unpack_from(">ib", data, at + 5 * k)) for k in range(4)]
        (count,) = struct.unpack_from(">i", data, at + 20)
        at += 24
        if count < 0 or count * _LOBE.itemsize > len(data) - at:
            raise FileFormatError(f"byte {at - 4}: {count} lobes do not fit into the file (get it again)")
        table = np.frombuffer(data, _LOBE, count, at)
        at += count * _LOBE.itemsize
        if abs(float(np.linalg.norm(four[:3])) - 1.0) > 1e-3 or (table["at"] >= grid).any():
            raise FileFormatError(f"byte {at}: a direction or a lobe before it lies nowhere (get the file again)")
        incident.append(four[:3])
        lobes.append(_lobes(table, four[3], grid, over, front))
    if not incident:
        raise FileFormatError("the file has no directions (make it again)")
    if len(data) - at < 8 or data[-8:] != b"\xff" * 8:
        raise FileFormatError(f"the file ends at byte {len(data)}, before the end of its plans (get it again)")
    vectors = np.array(incident)
    return _turned(vectors / np.linalg.norm(vectors, axis=1, keepdims=True), front), tuple(lobes)


def _lobes(table: NDArray[np.void], volume: float, grid: int, over: float, front: Side) -> Lobes:
    peaks = np.array([_float5(int(m), int(e)) for m, e in zip(table["mantissa"], table["exponent"], strict=True)])
    at = table["at"].astype(np.int64)
    chroma = table["chroma"].astype(np.int64)
    return Lobes(
        peaks,
        _turned(_cell_centre(at[:, 0], at[:, 1], grid, over), front),
        (table["radius"].astype(np.float64) + 0.5) * np.pi / 65536.0,
        at,
        np.stack([chroma & 0xFF, chroma >> 8], axis=1) / 410.0,
        volume,
    )


def _float5(mantissa: int, exponent: int) -> float:
    """A number of 32 bits of mantissa and 8 of exponent."""
    if mantissa == 0:
        return 0.0
    return float((mantissa + (0.5 if mantissa > 0 else -0.5)) / 0x7FFFFFFF * 2.0**exponent)


def _cell_centre(gx: NDArray[np.intp], gy: NDArray[np.intp], grid: int, over: float) -> Floats:
    """Middles of cells (n, 3): the concentric map from square to disk, then equal areas of disk and hemisphere."""
    a, b = (2.0 * (np.asarray(g) + 0.5) / grid - 1.0 for g in (gx, gy))
    by_a = np.abs(a) > np.abs(b)
    radius = np.where(by_a, a, b)
    ratio = np.where(by_a, b, a) / np.where(radius == 0.0, 1.0, radius)
    phi = np.where(by_a, np.pi / 4.0 * ratio, np.pi / 2.0 - np.pi / 4.0 * ratio)
    u, v = radius * np.cos(phi), radius * np.sin(phi)
    r2 = u**2 + v**2
    return np.stack([u * np.sqrt(2.0 - r2), v * np.sqrt(2.0 - r2), over * (1.0 - r2)], axis=-1)


def _turned(vectors: Floats, front: Side) -> Floats:
    """Vectors of the file in the sample's frame: about the vertical, where its front is the exterior."""
    return vectors if front == "interior" else vectors * [-1.0, 1.0, -1.0]


def _tints(chroma: Floats) -> Floats:
    """X, Y and Z of u' and v' at Y = 1 (n, 3)."""
    u, v = chroma[:, 0], np.maximum(chroma[:, 1], 1e-6)
    return np.stack([9.0 * u / (4.0 * v), np.ones_like(u), (12.0 - 3.0 * u - 20.0 * v) / (4.0 * v)], axis=1)
