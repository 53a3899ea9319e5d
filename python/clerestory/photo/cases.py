"""Photographs beside renderings of the same views: what each pair says."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from clerestory._core import ClerestoryError, FileFormatError, MissingDataError
from clerestory.files import named
from clerestory.glare import evaluate
from clerestory.photo.exposure import text_of
from clerestory.photo.regions import Region, mean_luminance
from clerestory.picture.image import Picture

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Sequence

    from clerestory.glare import Settings

INDICES = ("illuminance", "dgp", "dgi")
"""What is compared of every pair, beside the luminances of regions."""
_PICTURES = ("photo", "rendering")
_VALUES = tuple(f"{side}_{name}" for name in INDICES for side in _PICTURES)


@dataclass(frozen=True)
class Case:
    """One view: two pictures, or values that others have found."""

    name: str
    photo: Path | None = None
    rendering: Path | None = None
    measured: float | None = None
    """Illuminance at the lens by a meter [lx]."""
    values: dict[str, tuple[float, float]] = field(default_factory=dict)
    """Photograph's and rendering's values by quantity."""


@dataclass(frozen=True)
class Found:
    """What the two pictures of a case show."""

    case: Case
    values: dict[str, tuple[float, float]]
    """Photograph's and rendering's values: illuminance [lx], dgp, dgi, and luminances [cd/m²] as `luminance NAME`."""
    warnings: tuple[str, ...] = ()

    @property
    def difference_percent(self) -> float | None:
        """Of the photograph's illuminance from the measured one [%]."""
        if self.case.measured is None or "illuminance" not in self.values:
            return None
        return 100.0 * (self.values["illuminance"][0] / self.case.measured - 1.0)


def read_cases(path: str | os.PathLike[str]) -> list[Case]:
    """Cases from a table: the columns case, photo and rendering with the names of pictures, relative to the table.

    Instead of pictures there may be values: photo_illuminance and rendering_illuminance [lx], photo_dgp and
    rendering_dgp, photo_dgi and rendering_dgi. measured_illuminance [lx] may be added to either.

    Raises
    ------
    FileFormatError
        A column or a value is missing or wrong; the line is named.
    """
    path = Path(path)
    rows = csv.DictReader(io.StringIO(text_of(path)), skipinitialspace=True)
    heads = [head.strip() for head in rows.fieldnames or []]
    rows.fieldnames = heads
    known = ("case", *_PICTURES, "measured_illuminance", *_VALUES)
    unknown = [head for head in heads if head not in known]
    if unknown:
        raise FileFormatError(f"{path}: the column {unknown[0]!r} is not known (known are {', '.join(known)})")
    pairs = [name for name in INDICES if {f"{side}_{name}" for side in _PICTURES} <= set(heads)]
    lonely = [head for head in heads if head in _VALUES and head.split("_", 1)[1] not in pairs]
    if lonely:
        raise FileFormatError(f"{path}: the column {lonely[0]} has no partner (give photo_… and rendering_…)")
    if not set(_PICTURES) <= set(heads) and not pairs:
        raise FileFormatError(f"{path}: line 1 has no columns photo and rendering (give case,photo,rendering)")
    cases: list[Case] = []
    for row in rows:
        line = rows.line_num
        files = [(row.get(side) or "").strip() for side in _PICTURES]
        if any(files) and not all(files):
            raise FileFormatError(f"{path}: line {line} names one picture only (give the photo and the rendering)")
        values = {name: _pair(row, name, path, line) for name in pairs}
        if any(files) == bool(values):
            what = "both pictures and values" if values else "neither pictures nor values"
            raise FileFormatError(f"{path}: line {line} has {what} (give one of them)")
        measured = (row.get("measured_illuminance") or "").strip()
        cases.append(
            Case(
                name=(row.get("case") or "").strip() or (Path(files[0]).stem if files[0] else f"line {line}"),
                photo=path.parent / files[0] if files[0] else None,
                rendering=path.parent / files[1] if files[1] else None,
                measured=_number(measured, path, line, "measured_illuminance") if measured else None,
                values=values,
            )
        )
    names = [case.name for case in cases]
    again = next((name for name in names if names.count(name) > 1), None)
    if again is not None:
        raise FileFormatError(f"{path}: there are two cases {again} (name each once)")
    if not cases:
        raise FileFormatError(f"{path}: there is no line under the head (give one a case)")
    return cases


def _pair(row: dict[str, str], name: str, path: Path, line: int) -> tuple[float, float]:
    photo, rendering = (
        _number((row.get(f"{side}_{name}") or "").strip(), path, line, f"{side}_{name}") for side in _PICTURES
    )
    return photo, rendering


def _number(text: str, path: Path, line: int, column: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or (value <= 0.0 and column.endswith("illuminance")):
        wanted = "a number above 0" if column.endswith("illuminance") else "a number"
        raise FileFormatError(f"{path}: line {line}: {column} {text!r} does not fit (give {wanted})")
    return value


def evaluate_cases(
    cases: Sequence[Case],
    regions: Sequence[Region],
    settings: Settings | None = None,
    progress: Callable[[float], object] | None = None,
) -> list[Found]:
    """Evaluate the pictures of cases.

    Parameters
    ----------
    cases
        What `read_cases` gave.
    regions
        Parts of the field of view whose luminance is compared.
    settings
        Of the glare evaluation; those of `evalglare` 3.06 by default.
    progress
        Called with the share that is done, 0 to 1.

    Raises
    ------
    ClerestoryError
        A picture cannot be read or rated; the file is named.
    """
    found = []
    for number, case in enumerate(cases):
        found.append(_evaluated(case, regions, settings))
        if progress is not None:
            progress((number + 1) / len(cases))
    return found


def _evaluated(case: Case, regions: Sequence[Region], settings: Settings | None) -> Found:
    if case.photo is None or case.rendering is None:
        return Found(case, case.values)
    columns, warnings = [], []
    for path in (case.photo, case.rendering):
        picture = read_picture(path)
        with named(path):
            glare = evaluate(picture, settings)
            values = {"illuminance": glare.vertical_illuminance, "dgp": glare.dgp, "dgi": glare.dgi}
            values |= {f"luminance {r.name}": mean_luminance(picture, r) for r in regions}
        warnings += [f"{path.name}: {text}" for text in (*picture.warnings, *glare.warnings)]
        columns.append(values)
    photo, rendering = columns
    return Found(case, {name: (photo[name], rendering[name]) for name in photo}, tuple(warnings))


def read_picture(path: Path) -> Picture:
    """A picture with a view.

    Raises
    ------
    ClerestoryError
        It has none, or a pixel is not a number.
    """
    picture = Picture.read(path)
    if picture.view is None:
        raise MissingDataError(f"{path}: the picture does not say what it shows (add a VIEW= line to its header)")
    if picture.view.projection not in "ah":
        raise ClerestoryError(
            f"{path}: the view is {picture.view.projection_name} (give angular or hemispherical fisheyes of 180°)"
        )
    return picture
