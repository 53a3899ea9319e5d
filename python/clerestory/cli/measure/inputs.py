"""What commands of measurements are given: files, folders, or samples of the database."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from clerestory.cli.common import UsageError, note, refuse_overwriting

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.measure import Contents, Measurement


def words_of(words: Sequence[str] | None, sample: str | None) -> list[str]:
    """What is to be read: as given, or else the sample that is named."""
    if words:
        return list(words)
    if sample is None:
        raise UsageError("nothing to read (give files or folders, or --sample NAME of the database)")
    return [sample]


def refuse_to_write_over(output: Path, words: Sequence[str]) -> None:
    """Fail if files of scans would come where those that are read lie: what was measured stays as it is."""
    paths = [path for path in map(Path, words) if path.exists()]
    refuse_overwriting(output, [*paths, *(path.parent for path in paths if path.is_file())])


def contents_of(
    words: Sequence[str],
    db: str | None,
    choices: dict[str, object],
    *,
    laboratory: str | None = None,
    date: str | None = None,
) -> Contents:
    """What files and samples hold; what was odd is told on standard error."""
    from clerestory.measure.given import contents_given

    contents = contents_given(words, database=db, laboratory=laboratory, date=date, **choices)
    for text in contents.warnings:
        note(f"warning: {text}")
    return contents


def measurement_of(
    words: Sequence[str],
    db: str | None,
    sample: str | None,
    choices: dict[str, object],
    *,
    laboratory: str | None = None,
    date: str | None = None,
) -> Measurement:
    """The scans of one sample; a warning if several laboratories took them."""
    from clerestory.measure.given import one_sample

    found = one_sample(contents_of(words, db, choices, laboratory=laboratory, date=date), words, sample)
    who = list(dict.fromkeys(filter(None, (scan.conditions.get("laboratory") for scan in found.scans))))
    if len(who) > 1:
        note(f"warning: scans of several laboratories together: {', '.join(who)} (choose by --laboratory, or by files)")
    return found
