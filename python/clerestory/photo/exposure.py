"""How a photograph was taken: exposure time, aperture, speed, lens; from EXIF or from a table."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clerestory._core import ClerestoryError, FileFormatError, MissingDataError

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

# Numbers of tags (CIPA DC-008, Exif 3.0).
MODEL, EXPOSURE_TIME, F_NUMBER, SPEED = 272, 33434, 33437, 34855
FOCAL_LENGTH, WHITE_BALANCE, LENS = 37386, 41987, 42036
USED = (EXPOSURE_TIME, F_NUMBER, SPEED, FOCAL_LENGTH, WHITE_BALANCE, LENS)
"""Those of EXIF's own part of a file."""
COLUMNS = ("file", "time_s", "f_number", "iso")


@dataclass(frozen=True)
class Exposure:
    """Settings of the camera that say how much light made a picture."""

    time: float
    """Exposure time [s]."""
    f_number: float
    """Focal length over the diameter of the aperture."""
    iso: float
    """Speed, ISO 12232."""

    def __post_init__(self) -> None:
        for name, value in (("exposure time", self.time), ("f-number", self.f_number), ("ISO speed", self.iso)):
            if not (math.isfinite(value) and value > 0.0):
                raise ClerestoryError(f"the {name} {value:g} is not possible (give a number above 0)")

    @property
    def value(self) -> float:
        """Time · ISO / f-number², to which the level of a linear sensor is proportional [s]."""
        return self.time * self.iso / self.f_number**2

    @property
    def words(self) -> str:
        """Such as 1/125 s, f/5, ISO 100."""
        return f"{time_words(self.time)}, f/{self.f_number:g}, ISO {self.iso:g}"


@dataclass(frozen=True)
class Camera:
    """What else a camera says of a picture; None where it does not."""

    model: str | None = None
    lens: str | None = None
    focal_length: float | None = None
    """[mm]"""
    automatic_white_balance: bool | None = None


@dataclass(frozen=True)
class Given:
    """Settings that a person gives where the file is silent or wrong."""

    time: float | None = None
    """[s]"""
    f_number: float | None = None
    iso: float | None = None


def time_words(time: float) -> str:
    """A time as photographers write it: 1/125 s, 0.8 s."""
    return f"1/{1.0 / time:.4g} s" if time < 0.4 else f"{time:g} s"


def exposure_of(tags: Mapping[int, Any], given: Given) -> Exposure:
    """The exposure by what is given and the tags of EXIF.

    Raises
    ------
    MissingDataError
        Neither says it.
    """
    found = {
        "exposure time": given.time if given.time is not None else positive(tags.get(EXPOSURE_TIME)),
        "f-number": given.f_number if given.f_number is not None else positive(tags.get(F_NUMBER)),
        "ISO speed": given.iso if given.iso is not None else positive(tags.get(SPEED)),
    }
    missing = [name for name, value in found.items() if value is None]
    if missing:
        raise MissingDataError(
            f"EXIF holds no {' and no '.join(missing)} (give a table by --exposures, with the columns "
            f"{','.join(COLUMNS)}{'' if 'exposure time' in missing else '; or --f-number and --iso'})"
        )
    return Exposure(*(value for value in found.values() if value is not None))


def camera_of(tags: Mapping[int, Any]) -> Camera:
    """Camera and lens by the tags of EXIF."""
    balance = tags.get(WHITE_BALANCE)
    return Camera(
        model=_text(tags.get(MODEL)),
        lens=_text(tags.get(LENS)),
        focal_length=positive(tags.get(FOCAL_LENGTH)),
        automatic_white_balance=None if balance is None else int(balance) == 0,
    )


def positive(value: object) -> float | None:
    """A tag's number, which may be a pair of integers or the first of a list; None where it is 0 or no number.

    Lenses without contacts are written with an f-number of 0 or 0/0.
    """
    if isinstance(value, (tuple, list)) and len(value) == 2 and all(isinstance(v, int) for v in value):
        value = value[0] / value[1] if value[1] else None
    elif isinstance(value, (tuple, list)):
        value = value[0] if value else None
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    return number if math.isfinite(number) and number > 0.0 else None


def _text(value: object) -> str | None:
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    text = str(value).strip("\0 ") if value is not None else ""
    return text or None


def read_table(path: str | os.PathLike[str]) -> dict[str, Given]:
    """Exposures by the names of files, from a table with the columns file, time_s and, if needed, f_number, iso.

    Times may be written as 1/125.

    Raises
    ------
    FileFormatError
        A column is missing or a value is no number; the line is named.
    """
    path = Path(path)
    rows = csv.DictReader(io.StringIO(text_of(path)), skipinitialspace=True)
    heads = [head.strip() for head in rows.fieldnames or []]
    rows.fieldnames = heads
    if "file" not in heads or "time_s" not in heads:
        raise FileFormatError(f"{path}: line 1 has no columns file and time_s (give {','.join(COLUMNS)})")
    unknown = [head for head in heads if head not in COLUMNS]
    if unknown:
        raise FileFormatError(f"{path}: the column {unknown[0]!r} is not known (give {','.join(COLUMNS)})")
    found: dict[str, Given] = {}
    for row in rows:
        name = (row.get("file") or "").strip()
        values = [_fraction(row.get(column), path, rows.line_num, column) for column in COLUMNS[1:]]
        if not name or values[0] is None:
            raise FileFormatError(f"{path}: line {rows.line_num} lacks a file or a time_s (give both)")
        if name in found:
            raise FileFormatError(f"{path}: line {rows.line_num} names {name} again (leave one out)")
        found[name] = Given(*values)
    if not found:
        raise FileFormatError(f"{path}: there is no line under the head (give one a picture)")
    return found


def _fraction(text: str | None, path: Path, line: int, column: str) -> float | None:
    if text is None or not text.strip():
        return None
    try:
        number = float(Fraction(text.strip()))
    except (ValueError, ZeroDivisionError):
        number = 0.0
    if not (math.isfinite(number) and number > 0.0):
        raise FileFormatError(f"{path}: line {line}: {column} {text.strip()!r} does not fit (give a number above 0)")
    return number


def text_of(path: Path) -> str:
    """The text of a file in UTF-8, with or without the mark that spreadsheets put before it."""
    try:
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileFormatError(f"{path}: byte {error.start} is no text in UTF-8 (save the table as UTF-8)") from None
