"""EULUMDAT files (.ldt): candle power for lighting design. The window's inward normal is the file's nadir."""

from __future__ import annotations

import numpy as np

from clerestory._core import FileFormatError
from clerestory.luminaire.candle_power import CandlePower

_LINES_BEFORE_ANGLES = 42
"""With one set of lamps: 26 lines, the ten direct ratios, and the six of the set."""


def write(found: CandlePower, name: str, *, width_m: float = 1.0, height_m: float = 1.0, maker: str = "") -> bytes:
    """The file of a window, without symmetry, normalised to 1,000 lm of the light that passes it.

    Parameters
    ----------
    found
        Candle power; its flux is that of the lamps, and the light output ratio is 100 %.
    name
        Of the window.
    width_m, height_m
        Of the luminous area.
    maker
        First line of the file.
    """
    planes = found.c_deg
    gamma = np.concatenate([found.gamma_deg, 180.0 - found.gamma_deg[-2::-1]])
    intensity = np.concatenate([found.per_klm, np.zeros((len(planes), len(gamma) - len(found.gamma_deg)))], axis=1)
    area = [f"{1000.0 * height_m:.0f}", f"{1000.0 * width_m:.0f}"]
    lines = [
        (maker or "Clerestory")[:78],
        "3",
        "0",
        f"{len(planes)}",
        f"{360.0 / len(planes):g}",
        f"{len(gamma)}",
        f"{found.gamma_deg[1] - found.gamma_deg[0]:g}",
        "",
        name[:78],
        "",
        "",
        "",
        *area,
        "0",
        *area,
        "0",
        "0",
        "0",
        "0",
        "100",
        "100",
        "1",
        "0",
        "1",
        "1",
        "daylight",
        f"{found.flux:.6g}",
        "",
        "",
        "0",
        *["0"] * 10,
        *[f"{c:g}" for c in planes],
        *[f"{g:g}" for g in gamma],
        *[f"{value:.6g}" for value in intensity.ravel()],
    ]
    return ("\r\n".join(lines) + "\r\n").encode("latin-1", "replace")


def read(data: bytes) -> CandlePower:
    """Candle power from a file without symmetry, such as `write` makes.

    Raises
    ------
    FileFormatError
        A line is missing or no number, or the file has another symmetry; the text names the line.
    """
    lines = data.decode("latin-1").replace("\r\n", "\n").rstrip("\n").split("\n")

    def number(at: int) -> float:
        try:
            return float(lines[at].replace(",", "."))
        except (IndexError, ValueError):
            raise FileFormatError(f"line {at + 1}: a number is missing (get the file again)") from None

    if number(2) != 0.0 or number(25) != 1.0:
        raise FileFormatError("line 3: only files without symmetry and with one set of lamps are read (export it so)")
    planes, rings = int(number(3)), int(number(5))
    wanted = _LINES_BEFORE_ANGLES + planes + rings + planes * rings
    if not 0 < planes * rings <= len(lines) or len(lines) < wanted:
        raise FileFormatError(f"line {len(lines)}: {wanted} lines belong here (get the file again)")
    flux = number(28)
    start = _LINES_BEFORE_ANGLES
    c = np.array([number(start + k) for k in range(planes)])
    gamma = np.array([number(start + planes + k) for k in range(rings)])
    values = np.array([number(start + planes + rings + k) for k in range(planes * rings)]).reshape(planes, rings)
    area = number(12) * number(13) / 1e6
    return CandlePower(c, gamma, values * flux / 1000.0, flux, float("nan"), area, (), 1.0)
