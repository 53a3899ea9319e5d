"""Spectral data files of glass: IGDB text (.DAT), JSON of the IGSDB (versions 1 and 2), and CSV."""

from __future__ import annotations

import csv
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError, MissingDataError
from clerestory.measure.formats import igdb_dat, product_json
from clerestory.measure.formats.tokens import lines_of
from clerestory.system.glass import Glass, Thermal

if TYPE_CHECKING:
    import os

    from clerestory.directions import Scatter, Side
    from clerestory.measure.sphere import Collected
    from clerestory.system.glass import Angles, Coated

LARGEST = 16 << 20
"""Bytes of a file that are read at most."""
SIDES: dict[str, Coated] = {
    "front": "exterior",
    "back": "interior",
    "both": "both",
    "neither": "neither",
    "na": "neither",
}
COLUMNS: tuple[tuple[Side, Scatter], ...] = (
    ("exterior", "transmission"),
    ("exterior", "reflection"),
    ("interior", "reflection"),
)
"""Of a pane's spectra: T, Rf and Rb."""
PLAIN = ("monolithic", "")
"""Kinds that go by Fresnel's equations if no face is coated."""


def read_glass(path: str | os.PathLike[str], *, angles: Angles | None = None, roos_category: float = 4.0) -> Glass:
    """Read a pane's spectra. The file's front is the exterior.

    Parameters
    ----------
    path
        IGDB text (.dat, .txt and the suffixes of manufacturers), JSON of an IGSDB product, or CSV with a row of heads:
        wavelength_nm or wavelength_um, T, Rf and Rb (or transmittance, reflectance_exterior, reflectance_interior).
    angles
        How values at other angles are found: `fresnel`, `clear-bronze` or `roos`. By default Fresnel's equations for
        monolithic glass without a coating, and the clear and bronze curves for all else.
    roos_category
        q of Roos' model.

    Raises
    ------
    FileFormatError
        The file is none of these, or a number in it is wrong; the text names the place.
    MissingDataError
        The file is of a product that is not a pane, or holds no spectra.
    OSError
        It cannot be read.
    """
    place = Path(path)
    with place.open("rb") as file:
        data = file.read(LARGEST + 1)
    try:
        if len(data) > LARGEST:
            raise FileFormatError(f"more than {LARGEST >> 20} MiB are no spectrum of a pane (check the file)")
        return parse(data, place.stem, angles=angles, roos_category=roos_category)
    except ClerestoryError as error:
        raise type(error)(f"{place}: {error}") from None


def parse(data: bytes, name: str, *, angles: Angles | None = None, roos_category: float = 4.0) -> Glass:
    """The pane of a file's bytes; `name` stands in where the file gives none."""
    start = data[:64].lstrip(b"\xef\xbb\xbf \t\r\n")
    if igdb_dat.recognises(data, name) or re.match(rb"\{\s*(Units|Thickness)", start, re.IGNORECASE):
        found = _of_text(igdb_dat.spectra(data), name)
    elif start.startswith(b"{"):
        found = _of_product(product_json.parsed(data), name)
    else:
        found = _of_csv("\n".join(lines_of(data)), name)
    kind, coated = found["kind"], found["coated"]
    chosen: Angles = angles or ("fresnel" if kind in PLAIN and coated == "neither" else "clear-bronze")
    rows = found.pop("rows")
    columns = {
        "wavelength_nm": rows[:, 0],
        "transmittance": rows[:, 1],
        "reflectance_exterior": rows[:, 2],
        "reflectance_interior": rows[:, 3],
    }
    try:
        return Glass(**found, **columns, angles=chosen, roos_category=roos_category)
    except ClerestoryError as error:
        raise FileFormatError(str(error)) from None


def _of_text(found: igdb_dat.Spectra, name: str) -> dict[str, Any]:
    """Optics' text, as `clerestory.measure.formats.igdb_dat` reads it."""
    emissivities = re.findall(r"[-+.\deE]+", found.key("emissivity, front back").partition("=")[2])
    thickness = _maybe(found.key("thickness"))
    return {
        "name": found.key("product name") or name,
        "rows": found.table,
        "thermal": Thermal(
            thickness_m=None if thickness is None else thickness / 1000.0,
            conductivity=_maybe(found.key("conductivity")),
            emissivity_exterior=_maybe(emissivities[0] if emissivities else None),
            emissivity_interior=_maybe(emissivities[1] if len(emissivities) > 1 else None),
            tir=_maybe(found.key("ir transmittance").partition("=")[2]),
        ),
        "coated": _coated(found.key("coated side")),
        "kind": found.key("type").lower(),
        "manufacturer": found.key("manufacturer") or None,
        "warnings": (),
    }


def _of_product(product: dict[str, object], name: str) -> dict[str, Any]:
    """A product of the IGSDB, as `clerestory.measure.formats.product_json` reads it, of version 1 or 2."""
    kind = str(product.get("type") or "").lower()
    if kind not in ("glazing", "material", "film", ""):
        raise MissingDataError(f"it is of type {kind!r}, not a pane (give a file of a glazing or a material)")
    warnings: list[str] = []
    second = "physical_properties" in product
    held = product.get("physical_properties" if second else "measured_data")
    if not isinstance(held, dict):
        raise FileFormatError("neither measured_data nor physical_properties is there (give a product of the IGSDB)")
    if held.get("is_specular") is False:
        warnings.append("the file says that it scatters; it is taken as clear")
    title = str(product.get("name") or name)
    rows = _along_normal(product, title, "direct" if second else "hemispherical", warnings)
    listed = (block.get("wavelength_data") for block in product_json.angle_blocks(product))
    if any(isinstance(found, list) and any("pv" in row for row in found) for found in listed):
        warnings.append("what it turns into electricity counts as absorbed")
    prefix = "predefined_" if second else ""
    thickness = _maybe(held.get("thickness"))
    return {
        "name": title,
        "rows": rows,
        "thermal": Thermal(
            thickness_m=None if thickness is None else thickness / 1000.0,
            conductivity=_maybe(held.get("conductivity")),
            emissivity_exterior=_maybe(held.get(f"{prefix}emissivity_front")),
            emissivity_interior=_maybe(held.get(f"{prefix}emissivity_back")),
            tir=_maybe(held.get(f"{prefix}tir_front")),
        ),
        "coated": _coated(product.get("coated_side")),
        "kind": str(product.get("subtype") or "").lower().replace("-glass", ""),
        "manufacturer": product.get("manufacturer") or product.get("manufacturer_name"),
        "warnings": tuple(warnings),
    }


def _along_normal(product: dict[str, object], title: str, part: Collected, warnings: list[str]) -> np.ndarray:
    """Wavelength [nm], transmittance, reflectance of front and back (n, 4) along the normal."""
    spectra = next((found for theta, found in product_json.by_angle(product, title) if theta == 0.0 and found), None)
    if spectra is None:
        raise MissingDataError("it holds no spectra along the normal (export it with its spectral data)")
    front, *reflected = (spectra.get((side, scatter, part), {}) for side, scatter in COLUMNS)
    waves = sorted({wave for found in (front, *reflected) for wave in found})
    for letters, found in zip(("T", "Rf", "Rb"), (front, *reflected), strict=True):
        missing = next((wave for wave in waves if wave not in found), None)
        if missing is not None or not waves:
            place = f" at {missing:g} nm" if missing is not None else ""
            raise FileFormatError(f"{letters} of {title}{place} is missing (add it)")
    back = spectra.get(("interior", "transmission", part), {})
    if any(abs(back[wave] - front[wave]) > 0.01 for wave in back.keys() & front.keys()):
        warnings.append("transmittance differs by side; that from the front is taken")
    return np.array([[wave, *(found[wave] for found in (front, *reflected))] for wave in waves])


def _of_csv(text: str, name: str) -> dict[str, Any]:
    """Columns by their heads; lines before the heads are taken as comments."""
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        raise FileFormatError("the file is empty (give wavelength_nm, T, Rf, Rb)")
    mark = max(",;\t", key=lines[0].count)
    table = list(csv.reader(lines, delimiter=mark))
    heads = [re.sub(r"[^a-z_]", "", cell.strip().lower().replace(" ", "_").replace("µ", "u")) for cell in table[0]]
    known = {
        "t": ("t", "transmittance", "tf", "tau"),
        "rf": ("rf", "reflectance_exterior", "reflectance_front", "r_front", "r_exterior"),
        "rb": ("rb", "reflectance_interior", "reflectance_back", "r_back", "r_interior"),
    }
    scales = {"wavelength_nm": 1.0, "wavelength_um": 1000.0, "nm": 1.0, "um": 1000.0, "lambda_nm": 1.0}
    wavelength = next((h for h in heads if h in scales), None)
    if wavelength is None:
        raise FileFormatError(f"line 1: no column of wavelengths among {', '.join(heads)} (head it wavelength_nm)")
    places = [heads.index(wavelength)]
    for what, names in known.items():
        place = next((heads.index(n) for n in names if n in heads), None)
        if place is None:
            raise FileFormatError(f"line 1: no column {what.capitalize()} among {', '.join(heads)} (add it)")
        places.append(place)
    rows = []
    for number, row in enumerate(table[1:], 2):
        if len(row) <= max(places):
            raise FileFormatError(f"line {number}: {len(row)} columns of {len(heads)} (complete the row)")
        rows.append(_numbers([row[p] for p in places], number, 4))
    if not rows:
        raise FileFormatError("there is no row of values below the heads (add them)")
    return {
        "name": name,
        "rows": np.array(rows) * [scales[wavelength], 1.0, 1.0, 1.0],
        "thermal": Thermal(),
        "coated": "neither",
        "kind": "",
        "manufacturer": None,
        "warnings": (),
    }


def _numbers(words: list[str], number: int, count: int) -> list[float]:
    try:
        values = [float(word) for word in words[:count]]
    except ValueError:
        raise FileFormatError(f"line {number}: {' '.join(words)[:60]!r} are not numbers (correct the line)") from None
    if len(values) < count or not np.isfinite(values).all():
        raise FileFormatError(f"line {number}: {count} finite numbers are asked for (wavelength, T, Rf, Rb)")
    return values


def _maybe(value: object) -> float | None:
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None
    return number if np.isfinite(number) else None


def _coated(side: object) -> Coated:
    return SIDES.get(str(side or "neither").strip().lower(), "neither")
