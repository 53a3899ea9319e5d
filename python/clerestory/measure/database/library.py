"""A library of models to publish: BSDF XML with all that is known of each, and a catalogue of them."""

from __future__ import annotations

import json
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from clerestory._core import ClerestoryError, __version__
from clerestory.counts import counted
from clerestory.report.document import Cell, Document, Paragraph, Table
from clerestory.report.html import html
from clerestory.whole import write_whole

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from clerestory.bsdf import Bsdf
    from clerestory.measure.database.database import Database
    from clerestory.measure.database.records import Provenance, Sample

_BASIS = "klems-full"


@dataclass(frozen=True)
class Published:
    """A model in the library."""

    name: str
    sample: str
    manufacturer: str | None
    description: str | None
    symmetry: str | None
    bands: tuple[str, ...]
    files: tuple[str, ...]
    """Names of its XML files: the model as it is, and on Klems patches."""
    sha256: str
    """Of the model in the database."""
    made: str
    command: str
    settings: dict[str, object]
    version: str
    laboratories: tuple[str, ...]
    dates: tuple[str, ...]
    measured: tuple[str, ...]
    """Files that it was made of."""
    points: int
    missing: tuple[str, ...]
    """What a reader would want to know and the database does not."""


def publish(
    database: Database, folder: str | os.PathLike[str], *, samples: Sequence[str] | None = None
) -> tuple[list[Published], list[Path]]:
    """Write models as XML, as they are and on Klems patches, with `catalogue.json` and `catalogue.html`.

    Parameters
    ----------
    folder
        Is made if it is not there; files of these names in it are replaced.
    samples
        Names of samples; all by default.

    Returns
    -------
    The models, and the files written.

    Raises
    ------
    ClerestoryError
        There are no models, or one is no BSDF that can be written; the text names it.
    """
    chosen = [m for m in database.models() if m.kind == "model" and (samples is None or m.sample in samples)]
    if not chosen:
        raise ClerestoryError(f"{database.location}: no models to publish (`clerestory measure fit` makes them)")
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    published, written = [], []
    taken: set[str] = set()
    for model in chosen:
        origin, sample = database.provenance(model.id), database.sample(model.sample)
        stem = _stem(f"{model.sample} {model.name}", taken)
        bsdf = _described(_bsdf(database, origin), sample, origin)
        files = _write(bsdf, target, stem)
        published.append(_published(bsdf, sample, origin, files))
        written += [target / name for name in files]
    text = json.dumps({"models": [vars(one) for one in published]}, indent=1, ensure_ascii=False, default=str)
    write_whole(target / "catalogue.json", text.encode())
    write_whole(target / "catalogue.html", html(_document(published)).encode())
    return published, [*written, target / "catalogue.json", target / "catalogue.html"]


def _bsdf(database: Database, origin: Provenance) -> Bsdf:
    from clerestory.files import read

    name = origin.model.file_name
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / Path(name).name
        path.write_bytes(database.model_bytes(origin.model.id))
        try:
            return read(path)
        except ClerestoryError as error:
            text = str(error).removeprefix(f"{path}: ")
            raise ClerestoryError(f"model {origin.model.name!r}: {name} is no BSDF: {text}") from error


def _described(bsdf: Bsdf, sample: Sample, origin: Provenance) -> Bsdf:
    """With what the database knows of the sample, where the model does not say."""
    known = bsdf.metadata
    fields: dict[str, str | float | None] = {
        "name": sample.name,
        "product_name": f"{sample.name} ({origin.model.name})",
        "manufacturer": sample.manufacturer,
        "thickness_m": None if sample.thickness_mm is None else sample.thickness_mm / 1000.0,
        "width_m": None if sample.width_mm is None else sample.width_mm / 1000.0,
        "height_m": None if sample.height_mm is None else sample.height_mm / 1000.0,
    }
    given = {key: value for key, value in fields.items() if value is not None and getattr(known, key) is None}
    return bsdf.with_metadata(**given)


def _write(bsdf: Bsdf, folder: Path, stem: str) -> list[str]:
    """Names of the files: the model as XML has it, and its Klems variant where that is another one."""
    kinds = {model.kind for members in bsdf.models.values() for model in members.values()}
    fine = bsdf if kinds <= {"matrix", "tensor tree"} else bsdf.to_tree("tensor4")
    names = [f"{stem}.xml"]
    fine.write(folder / names[0])
    if kinds != {"matrix"}:
        names.append(f"{stem}_{_BASIS}.xml")
        bsdf.to_matrix(_BASIS).write(folder / names[1])
    return names


def _published(bsdf: Bsdf, sample: Sample, origin: Provenance, files: list[str]) -> Published:
    model = origin.model
    laboratories = tuple(dict.fromkeys(run.laboratory for run in origin.runs if run.laboratory))
    asked = {
        "manufacturer": sample.manufacturer,
        "description": sample.description,
        "thickness": sample.thickness_mm,
        "structure period": sample.structure_period_mm,
        "symmetry": sample.symmetry,
        "laboratory": laboratories,
    }
    return Published(
        name=model.name,
        sample=sample.name,
        manufacturer=sample.manufacturer,
        description=sample.description,
        symmetry=sample.symmetry,
        bands=bsdf.bands,
        files=tuple(files),
        sha256=model.sha256,
        made=f"{model.made:%Y-%m-%d %H:%M} UTC",
        command=model.command,
        settings=model.settings,
        version=model.version,
        laboratories=laboratories,
        dates=tuple(dict.fromkeys(run.date for run in origin.runs if run.date)),
        measured=tuple(file.name for file in origin.files),
        points=sum(scan.points for scan in origin.scans),
        missing=tuple(name for name, value in asked.items() if not value),
    )


def _document(published: Sequence[Published]) -> Document:
    heads = ("Model", "Sample", "Manufacturer", "Bands", "Files", "Measured by", "Made with", "Not known", "Points")
    words = [
        (
            one.name,
            one.sample,
            one.manufacturer or "–",
            ", ".join(one.bands),
            ", ".join(one.files),
            ", ".join([*one.laboratories, *one.dates]) or "–",
            f"{one.command} (clerestory {one.version})",
            ", ".join(one.missing) or "nothing",
        )
        for one in published
    ]
    rows = tuple(
        (*(Cell(text) for text in line), Cell(str(one.points), one.points))
        for line, one in zip(words, published, strict=True)
    )
    count = counted(len(published), "model")
    return Document(
        "Library of BSDF models",
        f"{count} of {counted(len({one.sample for one in published}), 'sample')}",
        __version__,
        (
            Paragraph("What each model was made of, and with what; catalogue.json has all of it for machines."),
            Table("Models", heads, rows, left=len(heads) - 1),
        ),
    )


def _stem(text: str, taken: set[str]) -> str:
    """A name of a file that no other model has."""
    stem = re.sub(r"[^\w.-]+", "_", text).strip("._") or "model"
    unique, k = stem, 2
    while unique.lower() in taken:
        unique, k = f"{stem}_{k}", k + 1
    taken.add(unique.lower())
    return unique
