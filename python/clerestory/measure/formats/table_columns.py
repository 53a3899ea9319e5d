"""Columns of tables by their names."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.measure.formats.sphere_columns import column

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from clerestory.directions import Side
    from clerestory.measure.scan import Scan

WORDS = ("side", "scatter", "quantity", "band")
"""Columns of words."""
ANGLES = ("theta_i", "phi_i", "theta_o", "phi_o")
ROLES = (*ANGLES, *WORDS, "value", "error")

POINTS: dict[str, str] = {
    **dict.fromkeys(("theta_i", "theta_in", "theta_1", "theta1", "thetai", "intheta", "incident_theta"), "theta_i"),
    **dict.fromkeys(("phi_i", "phi_in", "phi_1", "phi1", "phii", "inphi", "incident_phi"), "phi_i"),
    **dict.fromkeys(("theta_o", "theta_out", "theta_s", "theta_2", "theta2", "outgoing_theta", "theta"), "theta_o"),
    **dict.fromkeys(("phi_o", "phi_out", "phi_s", "phi_2", "phi2", "outgoing_phi", "phi"), "phi_o"),
    **dict.fromkeys(("value", "bsdf", "brdf", "btdf", "dsf", "signal"), "value"),
    **dict.fromkeys(("error", "standard_error", "std_error", "sigma"), "error"),
    **dict.fromkeys(("side", "incident_side"), "side"),
    **dict.fromkeys(("band", "channel"), "band"),
    "scatter": "scatter",
    "quantity": "quantity",
}
"""What columns of points hold by their names."""
_VALUE = re.compile(r"^(bsdf|brdf|btdf|dsf|signal|value|error)[ _:](.+)$", re.IGNORECASE)
_COLOURS = ("X", "Y", "Z", "R", "G", "B", "visible", "solar", "nir")
_WAVELENGTH = re.compile(r"^(\d+(?:\.\d+)?) ?nm$", re.IGNORECASE)
_UNIT = re.compile(r"(?:[\s_]+|(?=[\[(]))[\[(]?(degrees|deg|°|radians|rad)[\])]?$", re.IGNORECASE)
_SIDES: dict[str, Side] = {"outside": "exterior", "exterior": "exterior", "inside": "interior", "interior": "interior"}


@dataclass(frozen=True)
class Column:
    """What a column holds."""

    name: str
    """As the file has it."""
    role: str
    """One of `ANGLES`, `WORDS`, "value" or "error"; empty for others."""
    unit: str = ""
    """deg or rad, where the name says so."""
    channel: str = ""
    """Of a value or an error."""
    word: str = ""
    """What its name says of the quantity or the scatter: bsdf, btdf, …"""


def columns_named(words: Sequence[str], said: Mapping[str, str]) -> list[Column]:
    """Columns by the names over them.

    Parameters
    ----------
    said
        Our names by the file's, for those that are called otherwise: `{"Winkel": "theta_o"}`.

    Raises
    ------
    ClerestoryError
        A given name is not in the file, or ours is not known.
    """
    theirs: dict[str, str] = {}
    for name, role in said.items():
        if role not in ROLES:
            if column(role) is not None and name not in words:
                continue  # it is said of a table of a sphere beside this one
            raise ClerestoryError(f"columns: {role!r} is not known ({', '.join(ROLES)})")
        if name not in words:
            raise ClerestoryError(f"columns: the file has no column {name!r} (it has: {', '.join(words)[:200]})")
        theirs[name] = role
    columns = [_given(word, theirs[word], theirs) if word in theirs else _known(word) for word in words]
    taken = set(theirs.values())
    columns = [replace(c, role="") if c.role in taken and c.name not in theirs else c for c in columns]
    for role in (*ANGLES, *WORDS):
        if sum(column.role == role for column in columns) > 1:
            raise FileFormatError(f"two columns are {role} (say which one counts: --column {role}=HEADER)")
    return columns


def role_of(word: str) -> str:
    """What a column holds by its name; empty if that is not known."""
    return _known(word).role


def _given(word: str, role: str, theirs: Mapping[str, str]) -> Column:
    unit = _UNIT.search(word)
    several = sum(r == role for r in theirs.values()) > 1
    known = _known(word)
    channel = known.channel or (word if several and role in ("value", "error") else "")
    return Column(word, role, _short(unit[1]) if unit and role in ANGLES else "", channel, known.word)


def _known(word: str) -> Column:
    named = _VALUE.match(word)
    if named:
        kind = named[1].lower()
        return Column(
            word, "error" if kind == "error" else "value", "", _channel(named[2]), "" if kind == "value" else kind
        )
    for colour in _COLOURS:
        if word.lower() == colour.lower():
            return Column(word, "value", "", colour)
    if _WAVELENGTH.match(word):
        return Column(word, "value", "", _channel(word))
    unit = _UNIT.search(word)
    plain = re.sub(r"[\s_-]+", "_", (word[: unit.start()] if unit else word).strip().lower())
    role = POINTS.get(plain, "")
    return Column(word, role, _short(unit[1]) if unit and role in ANGLES else "", "", plain if role == "value" else "")


def _short(unit: str) -> str:
    return "rad" if unit.lower().startswith("rad") else "deg"


def _channel(word: str) -> str:
    match = _WAVELENGTH.match(word.strip())
    return f"{match[1]} nm" if match else word.strip()


def side_named(word: str, front: Side) -> Side:
    """The side that a word means.

    Raises
    ------
    FileFormatError
        It means none.
    """
    if word.lower() in ("front", "back"):
        return front if word.lower() == "front" else ("interior" if front == "exterior" else "exterior")
    found = _SIDES.get(word.lower())
    if found is None:
        raise FileFormatError(f"side {word[:40]!r} is not known (exterior or interior, front or back)")
    return found


def one_band(scans: Sequence[Scan]) -> list[Scan]:
    """Scans of the same points in several bands as one with a channel a band."""
    together: dict[tuple[object, ...], list[Scan]] = {}
    for scan in scans:
        place = (scan.incident_side, scan.scatter, scan.incident_theta_deg, scan.incident_phi_deg, scan.quantity)
        together.setdefault((*place, len(scan)), []).append(scan)
    made = []
    for group in together.values():
        first, *others = group
        alike = all(
            np.array_equal(first.theta_deg, other.theta_deg)
            and np.array_equal(first.phi_deg, other.phi_deg)
            and (first.standard_errors is None) == (other.standard_errors is None)
            for other in others
        )
        names = [name for scan in group for name in scan.channels]
        if not others or not alike or len(set(names)) < len(names):
            made += group
            continue
        errors = [scan.standard_errors for scan in group if scan.standard_errors is not None]
        made.append(
            replace(
                first,
                channels=tuple(names),
                values=np.concatenate([scan.values for scan in group], axis=1),
                standard_errors=np.concatenate(errors, axis=1) if errors else None,
            )
        )
    return made
