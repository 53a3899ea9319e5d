"""Files of measurements: read by what is in them, written whole or not at all."""

from __future__ import annotations

import os
from contextlib import ExitStack
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, cast

from clerestory._core import ClerestoryError, FileFormatError, gunzip
from clerestory.files import named
from clerestory.measure.contents import Contents
from clerestory.measure.formats import FORMATS, UnknownFormatError, all_formats, sphere_csv, table
from clerestory.measure.formats.choices import CHOICES
from clerestory.measure.formats.header import HEAD
from clerestory.measure.formats.unknown import reason
from clerestory.measure.source import digest
from clerestory.whole import whole_file

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from clerestory.measure.formats import Format
    from clerestory.measure.scan import Measurement, Scan
    from clerestory.measure.source import Source

_WIDE = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}
"""Byte order marks of text in two bytes a letter."""
_MARK = b"\xef\xbb\xbf"
_GZIP = b"\x1f\x8b"
_NOTHING = b"\0 \t\r\n"


def read(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]], *, strict: bool = False, **choices: object
) -> Contents:
    """Read measurements of instruments and laboratories.

    Formats are told by content, and gzip is unpacked. Scans of samples of one name become one measurement.

    Parameters
    ----------
    paths
        Files and folders; of a folder, all files in it and below it. What is no measurement there is named in the
        warnings.
    strict
        Raise an error instead, where a file of a folder is no measurement.
    choices
        What a person says where files are silent: `side` (exterior or interior, which the light comes from), `scatter`
        (transmission or reflection), `sample` (its name), `convention` (a laboratory's, one of
        `clerestory.measure.prepare.CONVENTIONS`), or `front`, `seen_from` and `up_deg` (how sides and azimuths are
        counted), `columns` (names of a CSV file's columns); docs/measurements.md says which format asks for which.

    Raises
    ------
    FileFormatError
        A file is damaged, or no measurement; the text names file, line and remedy.
    ClerestoryError
        There is no such file, or a choice is not known.
    OSError
        A file cannot be opened.

    Examples
    --------
    >>> from clerestory import measure
    >>> contents = measure.read("twill/", side="exterior")  # doctest: +SKIP
    """
    listed = [paths] if isinstance(paths, (str, os.PathLike)) else list(paths)
    if not listed:
        raise ClerestoryError("no file to read (give files or folders)")
    for choice in choices:
        if choice not in CHOICES:
            raise ClerestoryError(f"choice {choice!r} is not known (there are: {', '.join(CHOICES)})")
    parts: list[Contents] = []
    for given in listed:
        path = Path(given)
        if not path.is_dir():
            if not path.exists():
                raise ClerestoryError(f"{path}: no such file or folder")
            parts.append(_read(path, choices))
            continue
        found = 0
        for inner in _files_below(path):
            try:
                parts.append(_read(inner, choices))
                found += 1
            except UnknownFormatError as error:
                if strict:
                    raise
                why = str(error).removeprefix(f"{inner}: ").partition(" (")[0]
                parts.append(Contents(warnings=(f"{inner.relative_to(path)}: {why}; left out",)))
        if not found:
            raise ClerestoryError(f"{path}: no measurement in the folder (`docs/measurements.md` lists the formats)")
    return Contents.together(parts)


def _files_below(folder: Path) -> list[Path]:
    """Regular files of a folder and those below it, in the order of their names; hidden ones are no measurements."""
    found = []
    for parent, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        found += [Path(parent, name) for name in sorted(names) if not name.startswith(".")]
    return [path for path in found if path.is_file()]


def read_bytes(packed: bytes, name: str, **choices: object) -> Contents:
    """Read a measurement from the bytes of a file.

    Parameters
    ----------
    packed
        The bytes, as they lie on a disk.
    name
        The file's name, for messages and for samples without one.
    choices
        As of `read`.
    """
    with named(Path(name)):
        if not packed[:HEAD].strip(_NOTHING) and not packed.strip(_NOTHING):
            raise UnknownFormatError("the file is empty, or nothing but blanks and zeros (get it again)")
        data = _text(gunzip(packed) if packed.startswith(_GZIP) else packed)
        # What the suffix before tells, it tells of the packed file, too.
        inner = name[:-3] if data is not packed and name.lower().endswith(".gz") else name
        chosen = next((f for f in all_formats() if f.recognises(data, inner)), None)
        if chosen in (None, table):  # names of columns that a person gives tell which kind of table it is
            fitting: list[Format] = [form for form in (table, sphere_csv) if form.readable(data, choices)]
            chosen = chosen if chosen in fitting else next(iter(fitting), chosen)
        if chosen is None:
            raise UnknownFormatError(reason(data, choices))
        contents = _counted_as(chosen, data, inner, choices)
    return contents if data is packed else _sourced(contents, name, digest(packed))


def _counted_as(form: Format, data: bytes, name: str, choices: dict[str, object]) -> Contents:
    """What a format reads, with sides and azimuths as a laboratory's convention has them, if one is named."""
    said = dict(choices)
    given = said.pop("convention", None)
    if given is None:
        return form.read(data, name, **said)
    from clerestory.measure.prepare.convention import CONVENTIONS, from_travel

    if given not in CONVENTIONS:
        raise ClerestoryError(f"convention {given!r} is not known (give {', '.join(CONVENTIONS)})")
    convention = CONVENTIONS[str(given)]
    front = "interior" if convention.flipped else "exterior"
    frame = {"front": front, "seen_from": convention.seen_from, "up_deg": convention.up_deg}
    if not getattr(form, "FRAMED", False):
        contents = form.read(data, name, **said)
        if not contents.measurements:
            return contents
        text = f"{name}: {form.NAME} counts azimuths in a way of its own; the convention {given} has no effect"
        return replace(contents, warnings=(*contents.warnings, text))
    contents = form.read(data, name, **frame | said)

    def named(scan: Scan) -> Scan:
        turned = from_travel(scan) if convention.incident == "travel" else scan
        if turned.source is None:
            return turned
        words = turned.source.convention
        if convention.incident == "travel":
            words = words.replace("incident ones are the source's", "incident ones are those of the light's way")
        return replace(turned, source=replace(turned.source, convention=f"{given} (as a person said): {words}"))

    return replace(
        contents,
        measurements=tuple(replace(m, scans=tuple(map(named, m.scans))) for m in contents.measurements),
    )


def _read(path: Path, choices: Mapping[str, object]) -> Contents:
    data = path.read_bytes()
    try:
        return read_bytes(data, path.name, **choices)
    except ClerestoryError as error:
        # Its whole path, where the bytes have a name only.
        raise type(error)(f"{path}{str(error).removeprefix(path.name)}") from error


def _text(data: bytes) -> bytes:
    """Without a byte order mark; text of two bytes a letter as UTF-8."""
    wide = _WIDE.get(data[:2])
    if wide is not None:
        try:
            return data[2:].decode(wide).encode()
        except UnicodeDecodeError as error:
            raise FileFormatError(f"byte {error.start + 2} is not text of {wide} (save it as UTF-8)") from error
    return data[len(_MARK) :] if data.startswith(_MARK) else data


def _sourced(contents: Contents, name: str, sha256: str) -> Contents:
    """With the name and the mark of the file's bytes as they lie on the disk."""

    def marked(source: Source | None) -> Source | None:
        return None if source is None else replace(source, name=name, sha256=sha256)

    return Contents(
        tuple(
            replace(m, scans=tuple(replace(scan, source=marked(scan.source)) for scan in m.scans))
            for m in contents.measurements
        ),
        tuple(replace(values, source=marked(values.source)) for values in contents.sphere_values),
        contents.warnings,
    )


@dataclass(frozen=True)
class Written:
    """Files of a measurement."""

    paths: tuple[Path, ...]
    notes: tuple[str, ...]
    """What the format could not hold."""


def writable_formats() -> dict[str, str]:
    """Names of formats that can be written, for `write`, with what they are called in words."""
    modules = {name: import_module(f"clerestory.measure.formats.{name}") for name in FORMATS}
    return {name: module.NAME for name, module in modules.items() if hasattr(module, "write")}


def write(measurement: Measurement, path: str | os.PathLike[str], format_name: str, **choices: object) -> Written:
    """Write the scans of a sample.

    Parameters
    ----------
    measurement
        The scans.
    path
        A folder, which is made if it is not there; or a name with a suffix, of the one file that the format makes.
    format_name
        One of `writable_formats()`.
    choices
        What the format lets a person choose.

    Raises
    ------
    ClerestoryError
        There is no such format, it cannot hold the measurement, or one name is given for several files.
    OSError
        The folder cannot be written to. All files are written, or none is.
    """
    known = writable_formats()
    if format_name not in known:
        raise ClerestoryError(f"format {format_name!r} cannot be written (there are: {', '.join(known)})")
    if not measurement.scans:
        raise ClerestoryError(f"the measurement of {measurement.sample!r} has no scans to write")
    module = import_module(f"clerestory.measure.formats.{format_name}")
    files = cast("dict[str, bytes | Iterable[bytes]]", module.write(measurement, **choices))
    target = Path(path)
    if target.is_dir() or not target.suffix:
        target.mkdir(parents=True, exist_ok=True)
        paths = [target / name for name in files]
    elif len(files) == 1:
        paths = [target]
    else:
        raise ClerestoryError(
            f"{target}: {known[format_name]} makes {len(files)} files of this measurement (give a folder)"
        )
    with ExitStack() as stack:
        for place, content in zip(paths, files.values(), strict=True):
            with stack.enter_context(whole_file(place)).open("wb") as file:
                for chunk in (content,) if isinstance(content, bytes) else content:
                    file.write(chunk)
    notes = module.notes(measurement) if hasattr(module, "notes") else []
    return Written(tuple(paths), tuple(notes))
