"""What a person gives to a command: files, folders, or the names of samples in the laboratory's database."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from clerestory.measure.contents import Contents
    from clerestory.measure.scan import Measurement


def contents_given(
    words: Sequence[str | os.PathLike[str]],
    *,
    database: str | os.PathLike[str] | None = None,
    laboratory: str | None = None,
    date: str | None = None,
    **choices: object,
) -> Contents:
    """Scans and sphere values of files, of all files in folders, and of samples in a database.

    Parameters
    ----------
    words
        A word is the name of a sample in `database` if that is given and has it, or else a file or a folder. Without
        `database`, a word that is no file is looked up in the default one.
    database
        SQLite file or `postgresql://…`, as `clerestory.measure.database.location` understands it.
    laboratory, date
        Only scans of a laboratory, and of days that begin so, of the database.
    choices
        What files do not say, for `clerestory.measure.read`.

    Raises
    ------
    ClerestoryError
        A word is neither a file nor a sample, or a file cannot be read; the text names it.
    """
    from clerestory.measure.contents import Contents
    from clerestory.measure.database import Database, location
    from clerestory.measure.files import read

    if not words:
        raise ClerestoryError("nothing to read (give files, folders, or the name of a sample in the database)")
    place = location(database)
    if not from_database(words, database) or (database is None and not place.exists()):
        _refuse_filters(laboratory, date)
        missing = next((str(word) for word in words if not Path(word).exists()), None)
        if missing is not None:
            raise ClerestoryError(
                f"{missing}: no such file or folder (nor is there a database {place} that could have a sample of this"
                " name; name one with --db)"
            )
        return read([Path(word) for word in words], strict=False, **choices)
    with Database.open(place) as opened:
        samples = {str(word) for word in words} & {sample.name for sample in opened.samples()}
        parts, paths = [], []
        for word in words:
            if str(word) in samples and (database is not None or not Path(word).exists()):
                parts.append(opened.contents(str(word), laboratory=laboratory, date=date))
            elif Path(word).exists():
                paths.append(Path(word))
            else:
                raise ClerestoryError(
                    f"{word}: neither a file nor a sample of {place} (`clerestory measure list samples` names them)"
                )
    if choices and not paths:
        raise ClerestoryError(
            f"{place}: {', '.join(choices)} cannot be said of what is in the database (`clerestory measure import"
            " --replace` reads its files again)"
        )
    if not parts:
        _refuse_filters(laboratory, date)
    return Contents.together([*parts, *([read(paths, strict=False, **choices)] if paths else [])])


def from_database(words: Sequence[str | os.PathLike[str]], database: str | os.PathLike[str] | None) -> bool:
    """Whether words are looked up in a database: one is named, or a word is no file."""
    return database is not None or not all(Path(word).exists() for word in words)


def _refuse_filters(laboratory: str | None, date: str | None) -> None:
    if (laboratory, date) != (None, None):
        raise ClerestoryError("--laboratory and --date choose scans of the database, not of files (leave them out)")


def one_sample(contents: Contents, words: Sequence[str | os.PathLike[str]], sample: str | None = None) -> Measurement:
    """The scans of one sample: the one that is named, or the only one.

    Raises
    ------
    ClerestoryError
        There is no scan of that sample, or there are several samples and none is named.
    """
    found = contents.measurements
    names = ", ".join(measurement.sample for measurement in found)
    if not found:
        raise ClerestoryError(f"{', '.join(map(str, words))}: no scans (values of a sphere are not enough here)")
    if sample is None:
        if len(found) > 1:
            raise ClerestoryError(
                f"{', '.join(map(str, words))}: scans of several samples: {names} (name one with --sample)"
            )
        return found[0]
    for measurement in found:
        if measurement.sample == sample:
            return measurement
    raise ClerestoryError(f"no scans of sample {sample!r} (there are: {names})")
