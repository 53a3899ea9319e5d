"""What a comparison holds: every number of its report."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, is_dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from clerestory.bsdf import Bsdf
    from clerestory.check import Finding
    from clerestory.directions import Scatter, Side


@dataclass(frozen=True)
class Settings:
    """How a comparison was made."""

    band: str
    side: Side
    """Side of incidence."""
    scatter: Scatter
    patches: tuple[int, ...]
    """Incident patches of Klems' full basis, counted from 1."""
    cones_deg: tuple[float, ...]
    """Half angles [°] of the cones of direct-direct values."""
    samples: int
    """Incident directions a patch over which data other than a matrix on Klems full are averaged."""
    ground_reflectance: float
    incident: str
    """Incident directions of the mean distances."""


@dataclass(frozen=True)
class DataSet:
    """One data set and where it comes from."""

    label: str
    file: str | None
    """Name of the file, without its folder."""
    sha256: str | None
    """Of the file as it is, compressed or not."""
    program: str | None
    """First comment of the file: often the command that made it."""
    sample: str | None
    """Name, manufacturer and thickness as far as the file says."""
    bands: tuple[str, ...]
    blocks: tuple[str, ...]
    """Components of the compared band, such as `exterior transmission`."""
    model: str
    """Kind and resolution of the compared component."""
    resolution_deg: tuple[float, ...]
    """Full angle [°] below which detail is not resolved at each patch; 0 without a grid."""
    by_reciprocity: bool
    """The component was answered by the other side's transmission."""
    warnings: tuple[str, ...]
    """What was faulty in the file."""


@dataclass(frozen=True)
class Spread:
    """How far values of several data sets lie apart."""

    count: int
    minimum: float
    maximum: float
    mean: float
    median: float
    standard_deviation: float | None
    """Of the sample (n − 1); None for fewer than two."""
    range_percent: float | None
    """(maximum − minimum) over the mean [%]; None where the mean is 0."""


@dataclass(frozen=True)
class Outlier:
    """A value that stands apart from the others."""

    label: str
    value: float
    score: float | None
    """Modified z-score; None for fewer than four data sets, where it is only the furthest from the median."""


@dataclass(frozen=True)
class Quantity:
    """One figure of all data sets."""

    key: str
    """Unique name, such as `T_d-h, Klems 41`."""
    group: str
    """hemispherical, direct-hemispherical, direct-direct, cone, cut-off or reflection."""
    symbol: str
    """T_h-h, T_d-h, T_d-d, R_d-h …"""
    of: str
    """What tells it from others of its symbol: `30° (Klems 41)`, `CIE overcast sky`."""
    patch: int | None
    unit: str
    """`%` (values are fractions, shown in per cent) or `°`."""
    words: str
    """Method, resolution and treatment."""
    values: tuple[float | None, ...]
    """One a data set; None where it has none."""
    standard_errors: tuple[float | None, ...]
    resolved: tuple[bool, ...]
    """Whether the data set resolves the cone that the figure is about."""
    spread: Spread | None
    outliers: tuple[Outlier, ...]


@dataclass(frozen=True)
class Distances:
    """Distances between all pairs of data sets."""

    of: str
    """The incident direction: `30° (Klems 41)`, or the mean over many."""
    patch: int | None
    relative_l1: tuple[tuple[float, ...], ...]
    """∫ |f₁ − f₂| cosθ dω over the mean of both totals, 0 to 2."""
    transport_deg: tuple[tuple[float | None, ...], ...]
    """Mean angle [°] by which light would have to be turned; None where a data set is dark."""


@dataclass(frozen=True)
class Turn:
    """A data set that agrees better with the others after a turn or flip."""

    label: str
    words: str
    """What to do with it: `turned by 90°`."""
    reference: str
    """Label of the data set that it was held against."""
    before_deg: float
    """Mean transport distance [°] to that data set as it is."""
    after_deg: float
    """And after the turn."""


@dataclass(frozen=True)
class StandIn:
    """A simple model in place of measured data, and how wrong it is against each data set."""

    name: str
    words: str
    """How it was made."""
    values: tuple[float | None, ...]
    """Its value of each quantity of the comparison, in their order."""
    errors: tuple[tuple[float | None, ...], ...]
    """Its value less that of each data set: by quantity, then by data set."""
    relative_l1: tuple[float, ...]
    """Mean distance to each data set."""
    transport_deg: tuple[float | None, ...]


@dataclass(frozen=True)
class Comparison:
    """Data sets of one system side by side."""

    version: str
    """Of Clerestory."""
    settings: Settings
    sets: tuple[DataSet, ...]
    quantities: tuple[Quantity, ...]
    distances: tuple[Distances, ...]
    """At each patch, then the mean over the hemisphere of incident directions."""
    turns: tuple[Turn, ...]
    stand_ins: tuple[StandIn, ...]
    findings: tuple[tuple[Finding, ...], ...]
    """Of the checks, by data set."""
    notes: tuple[str, ...]
    """What has to be known before the numbers are used."""
    summary: tuple[str, ...]
    """The result in words."""
    data: Mapping[str, Bsdf] = field(repr=False, compare=False)
    """The data sets themselves, by label; they are no part of `to_dict`."""

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the data sets."""
        return tuple(s.label for s in self.sets)

    def quantity(self, key: str) -> Quantity:
        """The figure of a name, such as `T_d-h, Klems 41`."""
        for quantity in self.quantities:
            if quantity.key == key:
                return quantity
        raise KeyError(key)

    def of_group(self, group: str) -> list[Quantity]:
        """The figures of a group."""
        return [q for q in self.quantities if q.group == group]

    def to_dict(self) -> dict[str, object]:
        """Every number of the report, as JSON knows it; what is not finite is None."""
        made = plain(self)
        assert isinstance(made, dict)
        return made


def plain(value: object) -> object:
    """A value as JSON knows it."""
    if is_dataclass(value) and not isinstance(value, type):
        return {f.name: plain(getattr(value, f.name)) for f in fields(value) if f.name != "data"}
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value
