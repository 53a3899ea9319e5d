"""What columns of tables of integrating spheres mean, by their names in the words of laboratories and standards."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from clerestory.directions import Scatter, Side
    from clerestory.measure.sphere import Collected

SCATTERS: dict[str, Scatter] = {
    "t": "transmission",
    "tau": "transmission",
    "τ": "transmission",
    "transmittance": "transmission",
    "transmission": "transmission",
    "r": "reflection",
    "rho": "reflection",
    "ρ": "reflection",
    "reflectance": "reflection",
    "reflection": "reflection",
}
COLLECTED: dict[str, Collected] = {
    "hemispherical": "hemispherical",
    "hem": "hemispherical",
    "h": "hemispherical",
    "total": "hemispherical",
    "tot": "hemispherical",
    "global": "hemispherical",
    "diffuse": "diffuse",
    "dif": "diffuse",
    "diff": "diffuse",
    "direct": "direct",
    "dir": "direct",
    "regular": "direct",
    "reg": "direct",
    "specular": "direct",
    "spec": "direct",
    "normal": "direct",
    "n": "direct",
}
SIDES: dict[str, Side] = {
    "exterior": "exterior",
    "front": "exterior",
    "f": "exterior",
    "outside": "exterior",
    "outdoor": "exterior",
    "interior": "interior",
    "back": "interior",
    "b": "interior",
    "inside": "interior",
    "indoor": "interior",
}
BANDS = {
    "visible": "visible",
    "vis": "visible",
    "v": "visible",
    "solar": "solar",
    "sol": "solar",
    "e": "solar",
    "nir": "nir",
    "uv": "uv",
    "thermal": "thermal",
}

_KEYS = {
    "wavelength": {"wavelength", "lambda", "λ", "wl", "w", "wave"},
    "theta": {"angle", "theta", "θ", "aoi", "incidence", "incidence angle", "angle of incidence", "incident angle"},
    "phi": {"phi", "φ", "azimuth", "incident phi", "incident azimuth"},
    "side": {"side", "incident side"},
    "scatter": {"scatter", "quantity", "property"},
    "collected": {"collected", "component", "part"},
    "band": {"band"},
    "value": {"value", "share"},
    "error": {"standard error", "stderr", "uncertainty", "std", "error"},
    "sample": {"sample", "name", "product", "specimen"},
}
_KEYS["theta"] |= {"incident theta", "theta i", "theta in"}
KEYS = {name.replace(" ", "_"): key for key, names in _KEYS.items() for name in sorted(names)}
"""What columns hold by their names, those of shares of the light left out."""
_UNITS = {"nm": 1.0, "um": 1e3, "µm": 1e3, "μm": 1e3, "micron": 1e3, "microns": 1e3, "%": 0.01, "percent": 0.01}
_NO_UNITS = {"deg", "°", "-", "1", ""}
_BRACKETS = re.compile(r"[\[(]([^\])]*)[\])]")
_COMPACT = re.compile(r"^([tr])([fb])$")


@dataclass(frozen=True)
class Column:
    """What a column holds."""

    key: str
    """One of wavelength, theta, phi, side, scatter, collected, band, value, error or sample."""
    factor: float = 1.0
    """From the column's unit to nanometres, or to shares."""
    scatter: Scatter | None = None
    collected: Collected | None = None
    side: Side | None = None
    band: str | None = None


def column(name: str) -> Column | None:
    """The meaning of a column's name, or none where it is not known.

    `tau_n-dif [%]`, `Rb`, `T hemispherical`, `rho_v`, `wavelength (µm)` and `incidence angle` are such names.
    """
    text = name.strip().strip('"').lower()
    factor, known = 1.0, True
    for unit in _BRACKETS.findall(text):
        known &= unit.strip() in _UNITS or unit.strip() in _NO_UNITS
        factor *= _UNITS.get(unit.strip(), 1.0)
    if not known:
        return None
    if "%" in _BRACKETS.sub(" ", text):
        factor *= 0.01
    words = [word for word in re.split(r"[^\wµμλθφτρ]+|_", _BRACKETS.sub(" ", text).replace("%", " ")) if word]
    units = [word for word in words[1:] if word in _UNITS or word in _NO_UNITS]
    words = [word for k, word in enumerate(words) if k == 0 or word not in units]
    for unit in units:
        factor *= _UNITS.get(unit, 1.0)
    plain = " ".join(words)
    for key, names in _KEYS.items():
        if plain in names:
            return Column(key, factor)
    return _share(words, factor)


def columns_named(words: Sequence[str], said: Mapping[str, str]) -> list[Column | None]:
    """Columns by the names over them; none for what is not known.

    Parameters
    ----------
    said
        Names that are known by the file's, for columns that are called otherwise: `{"Wl. (µm)": "wavelength"}`. The
        file's name still tells the unit, in brackets, or that it is per cent.

    Raises
    ------
    ClerestoryError
        A name that is given for a column of the file is not known.
    """
    columns = []
    for word in words:
        name = said.get(word)
        if name is None:
            columns.append(column(word))
            continue
        units = [] if _BRACKETS.search(name) else _BRACKETS.findall(word)
        units += ["%"] if "%" in _BRACKETS.sub(" ", word) and "%" not in name else []
        known = column(" ".join([name, *(f"({unit})" for unit in units)]))
        if known is None:
            names = ", ".join(dict.fromkeys(KEYS.values()))
            raise ClerestoryError(
                f"columns: {name!r} of {word!r} is not known for values of a sphere ({names}, or T, Rf, tau n-h, …)"
            )
        columns.append(known)
    return columns


def _share(words: list[str], factor: float) -> Column | None:
    """A column of shares of the light, whose name says which."""
    compact = _COMPACT.match(words[0]) if words else None
    if compact:
        words = [compact[1], compact[2], *words[1:]]
    if not words or words[0] not in SCATTERS:
        return None
    scatter, rest = SCATTERS[words[0]], words[1:]
    side = band = None
    collected: Collected | None = None
    # The first of two directions is the incident one: n-h, d-h, direct hemispherical.
    directions = [word for word in rest if word in COLLECTED or word == "d"]
    if len(directions) > 2:
        return None
    if directions:
        last = directions[-1]
        collected = "direct" if last == "d" else COLLECTED[last]
    for word in rest:
        if word in SIDES:
            side = SIDES[word]
        elif word in BANDS:
            band = BANDS[word]
        elif word not in directions:
            return None
    return Column("value", factor, scatter, collected, side, band)
