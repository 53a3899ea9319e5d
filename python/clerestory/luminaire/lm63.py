"""IES LM-63 files (.ies, edition of 2002): candle power for lighting design, type C, absolute photometry."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.luminaire.candle_power import CandlePower, flux_of

if TYPE_CHECKING:
    from collections.abc import Sequence

_NAME = "IESNA:LM-63-2002"


def write(found: CandlePower, name: str, *, width_m: float = 1.0, height_m: float = 1.0, maker: str = "") -> bytes:
    """The file of a window: its inward normal is the nadir, and horizontal 0 its upward axis, EULUMDAT's C 90.

    Parameters
    ----------
    found, name, maker
        As for EULUMDAT.
    width_m, height_m
        Of the luminous area.
    """
    # The last plane repeats the first; horizontal angles are counted from C 90.
    turned = (found.c_deg - 90.0) % 360.0
    order = np.argsort(turned)
    horizontal = np.append(turned[order], 360.0)
    values = np.concatenate([found.intensity[order], found.intensity[order][:1]])
    head = [
        _NAME,
        "[TEST] calculated",
        "[TESTLAB] Clerestory",
        "[ISSUEDATE] not given",
        f"[MANUFAC] {maker or 'not given'}",
        f"[LUMINAIRE] {name}",
        f"[OTHER] window of {found.area_m2:g} m2, {found.flux:.6g} lm pass it of {found.illuminance:.6g} lx outside",
        "TILT=NONE",
        f"1 -1 1 {len(found.gamma_deg)} {len(horizontal)} 1 2 {width_m:g} {height_m:g} 0",
        "1 1 0",
        _wrapped(found.gamma_deg),
        _wrapped(horizontal),
        *(_wrapped(row) for row in values),
    ]
    return ("\r\n".join(head).replace("\n", "\r\n").replace("\r\r\n", "\r\n") + "\r\n").encode("latin-1", "replace")


def _wrapped(values: Sequence[float] | np.ndarray) -> str:
    return textwrap.fill(" ".join(f"{value:.6g}" for value in values), 130)


def read(data: bytes) -> CandlePower:
    """Candle power from a file of type C with planes around the whole circle, such as `write` makes.

    Raises
    ------
    FileFormatError
        Something is missing, or the file is of another type.
    """
    text = data.decode("latin-1")
    if not text.startswith("IES") or "TILT=NONE" not in text:
        raise FileFormatError("line 1: no LM-63 file without a table of tilts (export it so)")
    try:
        numbers = [float(word) for word in text.split("TILT=NONE", 1)[1].split()]
    except ValueError as error:
        raise FileFormatError(f"after TILT=NONE: {error} (get the file again)") from None
    if len(numbers) < 13 or numbers[5] != 1.0:
        raise FileFormatError("after TILT=NONE: only photometry of type C is read (export it so)")
    rings, planes = int(numbers[3]), int(numbers[4])
    if rings < 1 or planes < 2 or len(numbers) != 13 + rings + planes + rings * planes:
        raise FileFormatError(f"after TILT=NONE: {len(numbers)} numbers do not make {planes} planes of {rings} angles")
    rest = np.array(numbers[13:])
    gamma, horizontal = rest[:rings], rest[rings : rings + planes]
    if horizontal[-1] != 360.0:
        raise FileFormatError("the planes do not go around the whole circle (export it without symmetry)")
    values = rest[rings + planes :].reshape(planes, rings)[:-1] * numbers[2] * numbers[10]
    c = (horizontal[:-1] + 90.0) % 360.0
    order = np.argsort(c)
    flux = flux_of(c[order], gamma, values[order])
    return CandlePower(c[order], gamma, values[order], flux, float("nan"), numbers[7] * numbers[8], (), 1.0)
