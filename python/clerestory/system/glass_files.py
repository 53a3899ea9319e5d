"""Spectral data files of glass: IGDB text (.DAT), JSON of the IGSDB (versions 1 and 2), and CSV."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError, MissingDataError
from clerestory.system.glass import Glass, Thermal

if TYPE_CHECKING:
    import os

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
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        # Older files of the database name products in Latin letters.
        text = data.decode("latin-1")
    start = text.lstrip()[:1]
    if start == "{" and not re.search(r"^\{\s*(Units|Thickness)", text.lstrip(), re.IGNORECASE):
        found = _of_json(text, name)
    elif start == "{":
        found = _of_text(text, name)
    else:
        found = _of_csv(text, name)
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


def _of_text(text: str, name: str) -> dict[str, Any]:
    """IGDB text: heads in braces, then wavelength [µm], T, R of the front, R of the back."""
    heads: dict[str, str] = {}
    rows: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), 1):
        stripped = line.strip()
        if stripped.startswith("{"):
            inside, _, after = stripped[1:].partition("}")
            key, colon, value = inside.partition(":")
            heads[key.strip().lower()] = (value if colon else after).strip()
        elif stripped:
            rows.append(_numbers(stripped.split(), number, 4))
    if not rows:
        raise FileFormatError("there are no rows of wavelength, T, Rf and Rb (check the file)")
    emissivities = re.findall(r"[-+.\deE]+", heads.get("emissivity, front back", "").partition("=")[2])
    tir = heads.get("ir transmittance", "").partition("=")[2]
    scale = 1000.0
    units = heads.get("units, wavelength units", "SI Microns").lower()
    if "nano" in units:
        scale = 1.0
    elif "micron" not in units:
        raise FileFormatError(f"wavelengths in {units!r} are not known (give SI Microns or SI Nanometers)")
    thickness = _maybe(heads.get("thickness"))
    return {
        "name": heads.get("product name") or name,
        "rows": np.array(rows) * [scale, 1.0, 1.0, 1.0],
        "thermal": Thermal(
            thickness_m=None if thickness is None else thickness / 1000.0,
            conductivity=_maybe(heads.get("conductivity")),
            emissivity_exterior=_maybe(emissivities[0] if emissivities else None),
            emissivity_interior=_maybe(emissivities[1] if len(emissivities) > 1 else None),
            tir=_maybe(tir),
        ),
        "coated": _coated(heads.get("coated side")),
        "kind": heads.get("type", "").lower(),
        "manufacturer": heads.get("manufacturer") or None,
        "warnings": (),
    }


def _of_json(text: str, name: str) -> dict[str, Any]:
    """A product of the IGSDB, version 1 (`measured_data`) or 2 (`physical_properties`)."""
    try:
        product = json.loads(text)
    except json.JSONDecodeError as error:
        raise FileFormatError(f"line {error.lineno}: not JSON, {error.msg.lower()} (correct it there)") from None
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
    rows = _second(held, warnings) if second else _first(product)
    order = np.argsort(rows[:, 0], kind="stable")
    prefix = "predefined_" if second else ""
    thickness = _maybe(held.get("thickness"))
    return {
        "name": product.get("name") or name,
        "rows": rows[order] * [1000.0, 1.0, 1.0, 1.0],
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


def _first(product: dict[str, Any]) -> np.ndarray:
    held = (product.get("spectral_data") or {}).get("spectral_data")
    if not held:
        raise MissingDataError("it holds no spectra (spectral_data is empty)")
    return np.array([_row(row, ("wavelength", "T", "Rf", "Rb"), k) for k, row in enumerate(held, 1)])


def _second(held: dict[str, Any], warnings: list[str]) -> np.ndarray:
    blocks = ((held.get("optical_properties") or {}).get("optical_data") or {}).get("angle_blocks") or []
    block = next((b for b in blocks if not _maybe(b.get("incidence_angle"))), None)
    if block is None or not block.get("wavelength_data"):
        raise MissingDataError("it holds no spectra along the normal (optical_data.angle_blocks)")
    rows, back = [], []
    for k, item in enumerate(block["wavelength_data"], 1):
        values = {"w": item.get("w"), **(item.get("specular") or {})}
        rows.append(_row(values, ("w", "tf", "rf", "rb"), k))
        back.append(_maybe(values.get("tb")))
    if any(abs(b - row[1]) > 0.01 for b, row in zip(back, rows, strict=True) if b is not None):
        warnings.append("transmittance differs by side; that from the front is taken")
    if any("pv" in item for item in block["wavelength_data"]):
        warnings.append("what it turns into electricity counts as absorbed")
    return np.array(rows)


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


def _row(held: dict[str, Any], keys: tuple[str, ...], number: int) -> list[float]:
    values = [_maybe(held.get(key)) for key in keys]
    for key, value in zip(keys, values, strict=True):
        if value is None:
            raise FileFormatError(f"row {number} of the spectrum: {key} is missing or no number (add it)")
    return [value for value in values if value is not None]


def _maybe(value: object) -> float | None:
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None
    return number if np.isfinite(number) else None


def _coated(side: object) -> Coated:
    return SIDES.get(str(side or "neither").strip().lower(), "neither")
