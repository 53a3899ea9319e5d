"""The virtual goniophotometer: a sample in, a data set with standard errors out."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import ClerestoryError, __version__
from clerestory.basis import Basis
from clerestory.bsdf import Bsdf
from clerestory.directions import SIDES, direction
from clerestory.trace.sample import Sample, load
from clerestory.trace.state import State

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterable, Mapping

    from numpy.typing import ArrayLike, NDArray

    from clerestory.directions import Scatter, Side

    Source = Sample | str | os.PathLike[str] | Mapping[str, Any]
    Floats = NDArray[np.float64]
    Tell = Callable[[float, float | None], object]

REPLICATIONS = 16
"""Independent repetitions, whose scatter gives the standard errors."""
ERROR = 0.005
"""Relative standard error of the direct-hemispherical values that is aimed at by default."""
MOST = 1 << 16
"""Paths an incident patch that are not exceeded by default, so that a sample takes seconds."""
CELL = 1 << 10
"""Paths an incident cell of a tree, where nothing is asked for."""
TREES = ("tensor3", "tensor4")
MOST_FOR_ERROR = 1 << 24
"""Paths an incident patch that are not exceeded where an error was asked for."""


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

    @classmethod
    def by_band(cls, bands: Iterable[str], tallies: Iterable[list[float]]) -> dict[str, Balance]:
        """From the tallies of the core."""
        return {
            band: cls(*(value / traced if traced else 0.0 for value in rest))
            for band, (traced, *rest) in zip(bands, tallies, strict=True)
        }


@dataclass(frozen=True)
class Value:
    """Direct-hemispherical values of a component, each with its standard error."""

    band: str
    side: Side
    scatter: Scatter
    normal: tuple[float, float]
    """At normal incidence: of the first patch, or of a tree at that direction. NaN where no error is known."""
    hemispherical: tuple[float, float]
    """Under even light from all directions."""


@dataclass(frozen=True)
class Measured:
    """What a measurement gives."""

    bsdf: Bsdf
    """The data set."""
    values: list[Value]
    """Transmittance and reflectance, a component each."""
    balance: dict[str, Balance]
    """Where the flux went, by band."""
    error: float
    """Largest relative standard error of a direct-hemispherical value (values below 0.01 count as 0.01)."""
    paths: int
    """Paths that were traced."""
    seconds: float
    """How long it took."""


@dataclass(frozen=True)
class Settings:
    """How to measure."""

    basis: Basis | str = "klems-full"
    """Patches of incident and outgoing directions; tensor3 or tensor4 for a tree."""
    resolution: int = 6
    """A tree has 2^resolution cells an axis at the finest."""
    sides: tuple[Side, ...] = SIDES
    """Sides that light comes from."""
    samples: int | None = None
    """Paths an incident patch."""
    error: float | None = None
    """Relative standard error to reach instead."""
    seed: int = 1
    threads: int | None = None
    source_cone_deg: float = 0.0
    """Full opening angle of the source [°]."""
    detector_cone_deg: float = 0.0
    """Full opening angle of the detector [°]."""
    reciprocity: bool = False
    """Whether each component is averaged with its reverse."""

    @property
    def is_tree(self) -> bool:
        """Whether a tensor tree is measured."""
        return self.basis in TREES

    @property
    def patches(self) -> Basis:
        """The patches; Klems full beside a tree."""
        if self.is_tree:
            return Basis.named("klems-full")
        return Basis.named(self.basis) if isinstance(self.basis, str) else self.basis

    def core(self) -> dict[str, Any]:
        """As the core takes them."""
        if self.samples is not None and self.error is not None:
            raise ClerestoryError("samples and error cannot both be given (choose one)")
        if self.samples is not None and self.samples < REPLICATIONS:
            raise ClerestoryError(f"{self.samples} samples give no standard errors (give {REPLICATIONS} or more)")
        if self.error is not None and not 0.0 < self.error < 1.0:
            raise ClerestoryError(f"an error of {self.error:g} cannot be aimed at (give a share such as 0.005)")
        error, most = self.error, MOST_FOR_ERROR
        if self.samples is not None:
            most = self.samples
        elif error is None and self.is_tree:
            most = CELL
        elif error is None:
            error, most = ERROR, MOST
        return {
            "sides": list(self.sides),
            "error": error,
            "most": most,
            "replications": REPLICATIONS,
            "seed": self.seed,
            "source_cone": math.radians(self.source_cone_deg),
            "detector_cone": math.radians(self.detector_cone_deg),
            "beams": True,
            "reciprocal": self.reciprocity,
            "threads": self.threads or 0,
        }

    def words(self) -> str:
        """All that the result depends on, for people."""
        what = f"{self.basis}, 2^{self.resolution} cells an axis" if self.is_tree else f"basis {self.patches.name}"
        parts = [what, f"from {' and '.join(self.sides)}", f"seed {self.seed}"]
        if self.samples is not None:
            parts.append(f"{self.samples} paths a patch")
        elif self.is_tree and self.error is None:
            parts.append(f"{CELL} paths a cell")
        else:
            most = MOST if self.error is None else MOST_FOR_ERROR
            parts.append(f"error {self.error or ERROR:g}, {most} paths a patch at most")
        for name, angle in (("source", self.source_cone_deg), ("detector", self.detector_cone_deg)):
            if angle:
                parts.append(f"{name} cone {angle:g}°")
        if self.reciprocity:
            parts.append("averaged with the reverse")
        return ", ".join(parts)


def measure(
    sample: Source,
    *,
    basis: Basis | str = "klems-full",
    resolution: int = 6,
    sides: tuple[Side, ...] = SIDES,
    samples: int | None = None,
    error: float | None = None,
    seed: int = 1,
    threads: int | None = None,
    source_cone_deg: float = 0.0,
    detector_cone_deg: float = 0.0,
    reciprocity: bool = False,
    progress: Tell | None = None,
) -> Bsdf:
    """The BSDF of a sample: a matrix of standard errors beside every matrix of values, beams apart.

    Parameters
    ----------
    sample
        A `Sample`, a recipe's file, the name of a recipe that comes with Clerestory, or tables as recipes have them.
    basis
        Patches of incident and outgoing directions, or their name (see `Basis.named`); tensor4 for a tensor tree, or
        tensor3 for one of a sample that scatters alike from all azimuths.
    resolution
        A tree has 2^resolution cells an axis at the finest: 6 gives 4,096 directions, 7 gives 16,384.
    sides
        Sides that light comes from; transmission and reflection are measured at once.
    samples
        Paths an incident patch.
    error
        Relative standard error that every direct-hemispherical value is to reach, instead of samples; below 0.01 a
        value counts as 0.01. 0.005, as far as 65,536 paths a patch suffice, by default; what is not reached is told in
        `Bsdf.warnings`.
    seed
        Another seed gives an independent result; the same one gives the same bits, whatever the number of threads.
    threads
        All by default.
    source_cone_deg, detector_cone_deg
        Full opening angles of a real instrument's source and detector [°]; with any, beams are part of the tables.
    reciprocity
        Average each component with its reverse, for samples that are reciprocal: this halves the variance.
    progress
        Called about ten times a second with the share that is done, 0 to 1, and the largest error so far, or None.

    Returns
    -------
    Bsdf
        Its metadata record recipe, settings, version and errors.

    Raises
    ------
    RecipeError
        The sample cannot be; the text names file and key.
    ClerestoryError
        A setting makes no sense.
    KeyboardInterrupt
        Ctrl-C was pressed.

    Examples
    --------
    >>> from clerestory import trace
    >>> blind = trace.measure("flat-blind", basis="klems-quarter", samples=64)
    >>> blind.bands
    ('visible',)
    """
    settings = Settings(
        basis=basis,
        resolution=resolution,
        sides=sides,
        samples=samples,
        error=error,
        seed=seed,
        threads=threads,
        source_cone_deg=source_cone_deg,
        detector_cone_deg=detector_cone_deg,
        reciprocity=reciprocity,
    )
    return run(sample, settings, progress=progress).bsdf


def run(
    sample: Source, settings: Settings | None = None, *, state: State | None = None, progress: Tell | None = None
) -> Measured:
    """As `measure`, with values, the balance of light and what it took.

    Parameters
    ----------
    sample, progress
        As in `measure`.
    settings
        How to measure.
    state
        What was finished of the same measurement before an interruption; it is brought up to date, also by Ctrl-C.
    """
    made = load(sample)
    settings = settings or Settings()
    patches = settings.patches
    state = state or State.new(made, settings)
    began = time.perf_counter()
    if settings.is_tree:
        isotropic = settings.basis == "tensor3"
        found = made.core().trees(settings.core(), isotropic, settings.resolution, state.core, progress)
    else:
        found = made.core().matrices(settings.core(), patches._core, patches._core, state.core, progress)
    core, tallies, totals, error, paths = found
    balance = Balance.by_band(made.bands, tallies)
    values = []
    for band, side, scatter, at, hemispherical in totals:
        first = at[0]
        if settings.is_tree:  # its first cell is another direction
            value, spread = Bsdf(core).integrate_with_error(direction(0.0, 0.0, side=side), scatter, band=band)
            first = float(value), float(spread)
        values.append(Value(band, side, scatter, first, hemispherical or (math.nan, math.nan)))
    bsdf = _recorded(Bsdf(core), made, settings, values, error, paths)
    return Measured(bsdf, values, balance, error, paths, time.perf_counter() - began)


def _recorded(bsdf: Bsdf, sample: Sample, settings: Settings, values: list[Value], error: float, paths: int) -> Bsdf:
    """With the sample's data, and with what led to them."""
    low, high = sample.depth_m
    bsdf = bsdf.with_metadata(name=sample.name, device_type=sample.device, thickness_m=high - low)
    if sample.openness is not None:
        bsdf = bsdf.with_metadata(openness=sample.openness)
    lines = [
        f"{v.band}, from {v.side}, {v.scatter}: hemispherical {v.hemispherical[0]:.5f} ± {v.hemispherical[1]:.5f}"
        for v in values
    ]
    comments = [
        f"clerestory {__version__} trace: {settings.words()}; {paths} paths",
        f"relative standard error of direct-hemispherical values: {error:.2g} at most; " + "; ".join(lines),
        f"recipe:\n{sample.source}",
    ]
    element_type, material, geometry, _, other = bsdf._core.metadata_parts()
    return Bsdf(bsdf._core.with_metadata_parts((element_type, material, geometry, comments, other)), bsdf.conversion)


@dataclass(frozen=True)
class Seen:
    """Light from one direction, as the patches of a basis see it."""

    band: str
    incident: Floats
    """Direction to the source (3,)."""
    scatter: Scatter
    values: Floats
    """BSDF of the scattered light, the mean over each outgoing patch (n,) [1/sr]."""
    errors: Floats
    """Standard errors of it (n,) [1/sr]."""
    beam: tuple[float, float]
    """Transmittance or reflectance of the beam straight on, with its standard error."""
    total: tuple[float, float]
    """Direct-hemispherical value of all light, with its standard error."""


def scan(
    sample: Source,
    incident: ArrayLike,
    settings: Settings | None = None,
    *,
    state: State | None = None,
    progress: Tell | None = None,
) -> tuple[list[Seen], dict[str, Balance]]:
    """Light from listed directions, as a goniophotometer scans it.

    Parameters
    ----------
    incident
        Directions (n, 3) toward the source; each one tells its side.
    sample, settings, state, progress
        As in `run`; the basis is that of the outgoing directions.

    Returns
    -------
    list of Seen
        By direction, band and scatter.
    dict of Balance
        Where the flux went, by band.
    """
    made = load(sample)
    settings = settings or Settings()
    listed = np.ascontiguousarray(np.atleast_2d(np.asarray(incident, dtype=np.float64)))
    state = state or State.new(made, settings, listed)
    rows, tallies, _ = made.core().scan(settings.core(), listed, settings.patches._core, state.core, progress)
    seen = []
    for band, k, _, scatter, pairs, beam, total in rows:
        values, errors = np.array(pairs).T
        seen.append(Seen(band, listed[k], scatter, values, errors, beam, total))
    return seen, Balance.by_band(made.bands, tallies)
