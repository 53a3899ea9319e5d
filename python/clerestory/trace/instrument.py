"""The virtual goniophotometer: a sample in, a data set with standard errors out."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import __version__
from clerestory.basis import Basis
from clerestory.bsdf import Bsdf
from clerestory.directions import SIDES
from clerestory.trace.sample import Sample, load

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any

    from clerestory.directions import Scatter, Side

REPLICATIONS = 16
"""Independent repetitions, whose scatter gives the standard errors."""


@dataclass(frozen=True)
class Balance:
    """Where the traced flux of a band went, as shares of it; they sum to 1."""

    transmitted: float
    """Left on the other side."""
    reflected: float
    """Left on the side that it came from."""
    absorbed: float
    """Stayed in surfaces and media."""
    roulette: float
    """Taken off less added by random choices; its mean is 0."""
    cut_off: float
    """Still on its way after the greatest number of events."""
    lost: float
    """Could not be followed: the geometry has holes, or bodies overlap."""

    @property
    def sum(self) -> float:
        """Of all six; 1 but for rounding."""
        return self.transmitted + self.reflected + self.absorbed + self.roulette + self.cut_off + self.lost


@dataclass(frozen=True)
class Value:
    """Direct-hemispherical values of a component, each with its standard error."""

    band: str
    side: Side
    scatter: Scatter
    normal: tuple[float, float]
    """At normal incidence."""
    hemispherical: tuple[float, float]
    """Under even light from all directions."""


@dataclass(frozen=True)
class Measured:
    """What a measurement gives."""

    bsdf: Bsdf
    """The data set."""
    balance: dict[str, Balance]
    """Where the flux went, by band."""
    paths: int
    """Paths that were traced."""
    seconds: float
    """How long it took."""

    def values(self) -> list[Value]:
        """Transmittance and reflectance, a component each."""
        patches = Basis.named("klems-full")
        found = []
        incident = {side: patches.incident_centres(side) for side in SIDES}
        weights = patches.projected_solid_angles / np.pi
        for band, members in self.bsdf.models.items():
            for side, scatter in members:
                values, errors = self.bsdf.integrate_with_error(incident[side], scatter, band=band)
                whole = float(weights @ values), float(np.sqrt(weights**2 @ errors**2))
                found.append(Value(band, side, scatter, (float(values[0]), float(errors[0])), whole))
        return found


def measure(
    sample: Sample | str | os.PathLike[str] | Mapping[str, Any],
    *,
    basis: Basis | str = "klems-full",
    sides: tuple[Side, ...] = SIDES,
    samples: int = 1024,
    seed: int = 1,
    threads: int | None = None,
    progress: Callable[[float], object] | None = None,
) -> Bsdf:
    """The BSDF of a sample."""
    return run(sample, basis=basis, sides=sides, samples=samples, seed=seed, threads=threads, progress=progress).bsdf


def run(
    sample: Sample | str | os.PathLike[str] | Mapping[str, Any],
    *,
    basis: Basis | str = "klems-full",
    sides: tuple[Side, ...] = SIDES,
    samples: int = 1024,
    seed: int = 1,
    threads: int | None = None,
    progress: Callable[[float], object] | None = None,
) -> Measured:
    """As `measure`, with the balance of light and what it took."""
    made = load(sample)
    patches = Basis.named(basis) if isinstance(basis, str) else basis
    began = time.perf_counter()
    paths = max(1, -(-samples // REPLICATIONS))
    core, balance = made.core().measure(
        patches._core, patches._core, list(sides), REPLICATIONS, paths, seed, threads or 0, progress
    )
    shares = np.array(balance)
    low, high = made.depth_m
    told = (
        f"clerestory {__version__} trace: {paths * REPLICATIONS} paths from each of {len(patches)} patches of"
        f" {patches.name}, from {' and '.join(sides)}; seed {seed}"
    )
    bsdf = Bsdf(core).with_metadata(name=made.name, device_type=made.device, thickness_m=high - low)
    return Measured(
        _with_comments(bsdf, [told, f"recipe:\n{made.source}"]),
        {band: Balance(*(float(x) for x in row[1:] / row[0])) for band, row in zip(made.bands, shares, strict=True)},
        paths * REPLICATIONS * len(patches) * len(sides),
        time.perf_counter() - began,
    )


def _with_comments(bsdf: Bsdf, comments: list[str]) -> Bsdf:
    element_type, material, geometry, _, other = bsdf._core.metadata_parts()
    return Bsdf(bsdf._core.with_metadata_parts((element_type, material, geometry, comments, other)), bsdf.conversion)
