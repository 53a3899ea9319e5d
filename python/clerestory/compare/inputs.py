"""The data sets of a comparison: read, named, and described by where they come from."""

from __future__ import annotations

import hashlib
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from clerestory import words
from clerestory._core import ClerestoryError, MissingDataError
from clerestory.bsdf import Bsdf
from clerestory.compare.quantities import klems
from clerestory.compare.result import DataSet
from clerestory.counts import counted
from clerestory.describe import blocks
from clerestory.files import default_labels, read

if TYPE_CHECKING:
    from clerestory.compare.result import Settings

LEAST, MOST = 2, 20
"""Number of data sets that can be compared."""

Source: TypeAlias = Bsdf | str | os.PathLike[str]
Sources: TypeAlias = Sequence[Source] | Mapping[str, Source]


@dataclass(frozen=True)
class Input:
    """A data set and the file that it was read from."""

    bsdf: Bsdf
    path: Path | None
    sha256: str | None


def load(sets: Sources, labels: Sequence[str] | None = None) -> dict[str, Input]:
    """Data sets by label, read where files are named.

    Parameters
    ----------
    sets
        Data sets or names of files; a mapping gives them their labels.
    labels
        Names of the data sets; those of the files by default.

    Raises
    ------
    ClerestoryError
        There are fewer than two or more than twenty, or the labels do not go with them.
    """
    return {label: _read(source) for label, source in _named(sets, labels).items()}


def _read(source: Source) -> Input:
    if isinstance(source, Bsdf):
        return Input(source, None, None)
    path = Path(source)
    return Input(read(path), path, hashlib.sha256(path.read_bytes()).hexdigest())


def _named(sets: Sources, labels: Sequence[str] | None) -> dict[str, Source]:
    if isinstance(sets, Mapping):
        if labels is not None:
            raise ClerestoryError("labels are there twice (give them in the mapping or by `labels`)")
        labels, sources = list(sets.keys()), list(sets.values())
    else:
        sources = list(sets)
    if not LEAST <= len(sources) <= MOST:
        count = counted(len(sources), "data set") if sources else "no data sets"
        raise ClerestoryError(f"{count} cannot be compared (give {LEAST} to {MOST})")
    if labels is None:
        labels = default_labels([None if isinstance(s, Bsdf) else os.fspath(s) for s in sources])
    if len(labels) != len(sources):
        raise ClerestoryError(
            f"{counted(len(labels), 'label')} for {len(sources)} data sets (give one for each, in order)"
        )
    twice = [label for label, count in Counter(labels).items() if count > 1]
    if twice:
        raise ClerestoryError(f"label {twice[0]!r} is there twice (give each data set a name of its own)")
    empty = [k for k, label in enumerate(labels) if not label.strip()]
    if empty:
        raise ClerestoryError(f"label {empty[0] + 1} is empty (give each data set a name)")
    return dict(zip(labels, sources, strict=True))


def common_band(data: Mapping[str, Bsdf], band: str | None) -> tuple[str, list[str]]:
    """The band to compare, and a note if it is not visible.

    Raises
    ------
    MissingDataError
        The data sets have no band in common, or one lacks the band that was asked for.
    """
    if band is not None:
        for label, bsdf in data.items():
            if band.lower() not in (b.lower() for b in bsdf.bands):
                listed = "; ".join(f"{name}: {', '.join(b.bands)}" for name, b in data.items())
                raise MissingDataError(f"{label} has no band {band!r} (there are: {listed})")
    chosen = words.common_band(data, band)
    if band is not None or chosen == "visible":
        return chosen, []
    return chosen, [f"band {chosen} is compared: not all data sets have visible"]


def described(label: str, source: Input, settings: Settings) -> DataSet:
    """What a data set is and where it comes from.

    Raises
    ------
    MissingDataError
        It holds neither the component nor the one that reciprocity would take.
    """
    bsdf = source.bsdf
    try:
        _, by_reciprocity = bsdf.model(settings.side, settings.scatter, settings.band)
    except MissingDataError as error:
        raise MissingDataError(
            f"{label}: {error} (choose another side, scatter or band, or leave this data set out)"
        ) from error
    own = [b for b in blocks(bsdf) if b.band.lower() == settings.band]
    answering = [b for b in own if b.scatter == settings.scatter]
    same = [b for b in answering if b.side == settings.side] or answering
    centres = klems().incident_centres(settings.side)[[p - 1 for p in settings.patches]]
    metadata = bsdf.metadata
    parts = [metadata.name, metadata.product_name, metadata.manufacturer]
    names = list(dict.fromkeys(p.strip() for p in parts if p and p.strip()))
    if metadata.thickness_m:
        names.append(f"{1000.0 * metadata.thickness_m:.3g} mm")
    return DataSet(
        label=label,
        file=None if source.path is None else source.path.name,
        sha256=source.sha256,
        program=next((" ".join(c.split()) for c in metadata.comments if c.strip()), None),
        sample=", ".join(names) or None,
        bands=bsdf.bands,
        blocks=tuple(f"{b.side} {b.scatter}" for b in own),
        model=same[0].words,
        resolution_deg=tuple(float(r) for r in bsdf.resolution_deg(centres, settings.scatter, settings.band)),
        by_reciprocity=by_reciprocity,
        warnings=tuple(bsdf.warnings),
    )


def files_twice(described: tuple[DataSet, ...]) -> list[str]:
    """Notes on data sets that are one file."""
    notes = []
    for k, one in enumerate(described):
        for other in described[:k]:
            if one.sha256 is not None and one.sha256 == other.sha256:
                notes.append(f"{other.label} and {one.label} are the same file")
    return notes
