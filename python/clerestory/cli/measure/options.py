"""Options that the commands of measurements share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import UsageError, angle_pair, one_of, scatter_of, side_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from clerestory.measure.database import Database

DatabaseOption = Annotated[
    str | None,
    typer.Option(
        "--db",
        metavar="DATABASE",
        help="SQLite file or postgresql://…; by default CLERESTORY_DB, or laboratory.sqlite in this folder.",
    ),
]
SampleOption = Annotated[str | None, typer.Option("--sample", metavar="NAME", help="Of this sample only.")]
LaboratoryOption = Annotated[str | None, typer.Option("--laboratory", metavar="NAME", help="Of this laboratory only.")]
DateOption = Annotated[
    str | None, typer.Option("--date", metavar="DAY", help="Of days that begin so: 2020, 2020-06, 2020-06-24.")
]
IncidentOption = Annotated[
    str | None,
    typer.Option("--incident", metavar="T[,P]", help="Of light from this angle to the normal, and azimuth [°]."),
]
FileSideOption = Annotated[
    str | None, typer.Option("--side", metavar="SIDE", help="Side that the light comes from, where files do not say.")
]
FileScatterOption = Annotated[
    str | None,
    typer.Option("--scatter", metavar="SCATTER", help="Transmission or reflection, where files do not say."),
]
ConventionOption = Annotated[
    list[str] | None,
    typer.Option(
        "--convention",
        metavar="NAME|KEY=VALUE",
        help="How files count sides and azimuths: hslu, window, pab, pab-up-90, clerestory; or, where they do not say,"
        " front, seen_from (a side), up_deg (an angle).",
    ),
]
ColumnOption = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        metavar="NAME=HEADER",
        help="What a column of a CSV file is whose header does not tell: theta_o=Winkel, wavelength=Wl.",
    ),
]


CONVENTIONS = ("clerestory", "hslu", "window", "pab", "pab-up-90")


def choices_of(
    side: str | None, scatter: str | None, convention: list[str] | None, column: list[str] | None
) -> dict[str, object]:
    """What a person says where files are silent, for `clerestory.measure.read`."""
    choices: dict[str, object] = {}
    if side is not None:
        choices["side"] = side_of(side)
    if scatter is not None:
        choices["scatter"] = scatter_of(scatter)
    named = [word for word in convention or [] if "=" not in word]
    if named:
        if len(named) > 1:
            raise UsageError(
                f"--convention {' '.join(named)}: several names (give one, and KEY=VALUE for what differs)"
            )
        choices["convention"] = one_of(named[0], "--convention", (*CONVENTIONS, "a pair such as up_deg=0"))
    for key, value in _pairs([word for word in convention or [] if "=" in word], "--convention", "up_deg=0"):
        if key not in ("front", "seen_from", "up_deg"):
            raise UsageError(f"--convention {key}={value}: not known (give front, seen_from or up_deg)")
        choices[key] = _angle(key, value) if key == "up_deg" else side_of(value, f"--convention {key}")
    if column:
        columns: dict[str, list[str]] = {}
        for key, value in _pairs(column, "--column", "theta_o=Winkel"):
            columns.setdefault(key, []).append(value)
        choices["columns"] = {key: values[0] if len(values) == 1 else values for key, values in columns.items()}
    return choices


def check_picture(picture: Path | None) -> None:
    """Fail if a picture's name tells no kind of picture."""
    if picture is not None and picture.suffix.lower() not in (".png", ".pdf", ".svg"):
        raise UsageError(f"--picture {picture}: not a kind of picture (give .png, .pdf or .svg)")


def incident_of(text: str | None) -> tuple[float | None, float | None]:
    """Angle to the normal and azimuth [°] that scans are asked for by; the azimuth may be left out."""
    if text is None:
        return None, None
    if "," in text:
        return angle_pair(text, "--incident")
    return angle_pair(f"{text},0", "--incident")[0], None


def thing(word: str, kinds: Sequence[str], command: str) -> tuple[str, int]:
    """What a person means by `model:3`: its kind and its number."""
    kind, _, number = word.partition(":")
    if kind not in kinds or not number.isdigit():
        listed = ", ".join(f"{one}:N" for one in kinds)
        raise UsageError(f"{word}: not something to {command} (give {listed}; `clerestory measure list` has numbers)")
    return kind, int(number)


def open_database(given: str | None, *, upgrade: bool = False) -> Database:
    """The database that a person means."""
    from clerestory.measure.database import Database

    return Database.open(given, upgrade=upgrade)


def _pairs(words: list[str] | None, option: str, example: str) -> list[tuple[str, str]]:
    pairs = []
    for word in words or []:
        key, equals, value = word.partition("=")
        if not (key.strip() and equals and value.strip()):
            raise UsageError(f"{option} {word}: not a pair (such as {example})")
        pairs.append((key.strip(), value.strip()))
    return pairs


def _angle(key: str, value: str) -> float:
    try:
        return float(value)
    except ValueError:
        raise UsageError(f"--convention {key}={value}: not an angle (give degrees)") from None
