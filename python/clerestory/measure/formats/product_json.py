"""Products of the international glazing database as JSON, in both of its versions: spectra of glass and of materials.

Version 1 lists `T`, `Rf` and `Rb` by wavelength. Version 2 has a block for each angle of incidence, with the specular
(regular) and the diffuse part of each. Blinds and fabrics carry the spectra of the materials that they are made of.
"""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import sample_of
from clerestory.measure.source import Source, digest
from clerestory.measure.sphere import SphereValues

if TYPE_CHECKING:
    from collections.abc import Iterator

    from clerestory.directions import Scatter, Side
    from clerestory.measure.sphere import Collected

    Json = dict[str, object]
    Quantities = dict[tuple[Side, Scatter, Collected], dict[float, float]]

NAME = "glazing product JSON"

_V1: dict[str, tuple[Side, Scatter]] = {
    "T": ("exterior", "transmission"),
    "Tf": ("exterior", "transmission"),
    "Tb": ("interior", "transmission"),
    "Rf": ("exterior", "reflection"),
    "Rb": ("interior", "reflection"),
}
_COLLECTED: dict[str, Collected] = {"specular": "direct", "diffuse": "diffuse"}
_BANDS = {"sol": "solar", "vis": "visible"}
_CONDITIONS = {
    "manufacturer_name": "manufacturer",
    "manufacturer": "manufacturer",
    "type": "type",
    "subtype": "subtype",
    "coated_side": "coated side",
    "appearance": "appearance",
    "data_file_name": "data file",
    "nfrc_id": "NFRC ID",
}
_PHYSICS = {
    "thickness": "thickness_mm",
    "emissivity_front": "emissivity front",
    "emissivity_back": "emissivity back",
    "predefined_emissivity_front": "emissivity front",
    "predefined_emissivity_back": "emissivity back",
    "conductivity": "conductivity [W/(m K)]",
}
_DEEPEST = 20
_CONVENTION = "front is the exterior, back the interior; wavelengths in micrometres"


def recognises(data: bytes, name: str) -> bool:
    """Whether it is JSON that names one of the database's parts."""
    start = data[:64].lstrip()
    return start.startswith(b"{") and any(
        key in data
        for key in (b'"spectral_data"', b'"optical_properties"', b'"measured_data"', b'"physical_properties"')
    )


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Spectra of a product and of the materials that it is made of.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `sample`, for the product itself.

    Raises
    ------
    FileFormatError
        It is no JSON, or a spectrum holds what is no number or no share of the light.
    """
    product = parsed(data)
    found: list[SphereValues] = []
    for part, member in enumerate(_products(product, 0)):
        title = product_name(str(member.get("name") or member.get("product_name") or ""), member.get("nfrc_id"))
        sample = sample_of(choices if part == 0 else {}, name, title)
        lines = tuple(f"{key}: {value}" for key, value in member.items() if not isinstance(value, (dict, list)))
        found += _spectra(member, sample, Source(name, digest(data), NAME, lines, _CONVENTION))
    if not found:
        raise FileFormatError("no spectrum and no values of bands (take the product's material)")
    return Contents((), tuple(found))


def parsed(data: bytes) -> Json:
    """The product that a file's bytes hold.

    Raises
    ------
    FileFormatError
        It is no JSON in UTF-8, or not of one product.
    """
    try:
        product = json.loads(data.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise FileFormatError(f"byte {error.start} is not UTF-8 (save it so)") from error
    except json.JSONDecodeError as error:
        raise FileFormatError(f"line {error.lineno}: no JSON, {error.msg} (is the file whole?)") from error
    except RecursionError:
        raise FileFormatError("lists within lists without end (is it a product?)") from None
    if not isinstance(product, dict):
        raise FileFormatError("no product, but a list or a number (give the file of one product)")
    return product


def product_name(name: str, nfrc_id: object) -> str:
    """A name that tells panes apart: the database has many of one name, each with a number of its own."""
    return f"{name} (NFRC {nfrc_id})" if name and nfrc_id not in (None, "") else name


def _products(product: Json, depth: int) -> Iterator[Json]:
    """A product and, within it, those that it is made of."""
    if depth > _DEEPEST:
        raise FileFormatError(f"more than {_DEEPEST} products within each other (is it a product?)")
    yield product
    parts = product.get("composition")
    for part in parts if isinstance(parts, list) else []:
        child = part.get("child_product") if isinstance(part, dict) else None
        if isinstance(child, dict):
            yield from _products(child, depth + 1)


def _spectra(product: Json, sample: str, source: Source) -> list[SphereValues]:
    conditions = _texts(product, _CONDITIONS)
    for key in ("measured_data", "physical_properties"):
        conditions |= _texts(_object(product, key), _PHYSICS)
    found = []
    for theta, quantities in by_angle(product, sample):
        found += _values(quantities, sample, theta, conditions, source)
    bands = _object(_object(product, "spectral_data"), "dual_band_values")
    return found + _dual_bands(bands, sample, conditions, source)


def by_angle(product: Json, sample: str) -> Iterator[tuple[float, Quantities]]:
    """Spectra of a product itself: an angle of incidence [°], and shares by side, part and wavelength [nm].

    Parameters
    ----------
    product
        As `parsed` gives it.
    sample
        Its name, for messages.

    Raises
    ------
    FileFormatError
        A spectrum holds what is no number or no share of the light.
    """
    yield 0.0, _version_1(_object(product, "spectral_data").get("spectral_data"), sample)
    for block in angle_blocks(product):
        theta = _number(block.get("incidence_angle") or 0, f"incidence_angle of {sample}")
        if not 0.0 <= theta <= 90.0:
            raise FileFormatError(f"{sample}: incidence_angle {theta:g} is not within 0 to 90° (correct it)")
        yield theta, _version_2(block.get("wavelength_data"), sample)


def angle_blocks(product: Json) -> list[Json]:
    """Blocks of version 2, one for each angle of incidence."""
    optical = _object(_object(_object(product, "physical_properties"), "optical_properties"), "optical_data")
    blocks = optical.get("angle_blocks")
    return [block for block in blocks if isinstance(block, dict)] if isinstance(blocks, list) else []


def _version_1(rows: object, sample: str) -> Quantities:
    quantities: Quantities = {}
    for row in rows if isinstance(rows, list) else []:
        if not isinstance(row, dict):
            raise FileFormatError(f"{sample}: a row of spectral_data is no object (is it a product?)")
        wave = _wavelength(row.get("wavelength"), sample)
        for key, (side, scatter) in _V1.items():
            if row.get(key) is not None:
                # All light: that of glass is regular, that of materials mostly diffuse.
                _put(quantities, (side, scatter, "hemispherical"), wave, row[key], f"{key} of {sample}")
    return quantities


def _version_2(rows: object, sample: str) -> Quantities:
    quantities: Quantities = {}
    for row in rows if isinstance(rows, list) else []:
        if not isinstance(row, dict):
            raise FileFormatError(f"{sample}: a row of wavelength_data is no object (is it a product?)")
        wave = _wavelength(row.get("w"), sample)
        for part, collected in _COLLECTED.items():
            for key, value in _object(row, part).items():
                if value is not None and key in ("tf", "tb", "rf", "rb"):
                    side, scatter = _V1[key.capitalize()]
                    _put(quantities, (side, scatter, collected), wave, value, f"{key} of {sample}")
    return quantities


def _put(quantities: Quantities, key: tuple[Side, Scatter, Collected], wave: float, value: object, what: str) -> None:
    share = _number(value, what)
    if not -0.5 <= share <= 1.5:
        raise FileFormatError(f"{what} at {wave:g} nm is {share:g}, no share of the light (correct it)")
    spectrum = quantities.setdefault(key, {})
    if spectrum.setdefault(wave, share) != share:
        raise FileFormatError(f"{what} is there twice at {wave:g} nm, with different values (keep one)")


def _values(
    quantities: Quantities, sample: str, theta: float, conditions: dict[str, str], source: Source
) -> list[SphereValues]:
    return [
        SphereValues(
            sample,
            side,
            scatter,
            theta,
            np.array([spectrum[wave] for wave in sorted(spectrum)]),
            collected,
            np.array(sorted(spectrum)),
            conditions=conditions,
            source=source,
        )
        for (side, scatter, collected), spectrum in quantities.items()
    ]


def _dual_bands(bands: Json, sample: str, conditions: dict[str, str], source: Source) -> list[SphereValues]:
    """Values of solar and visible light, `Tf_sol_diffuse` and the like."""
    found: dict[tuple[str, str], dict[str, float]] = {}
    for key, value in bands.items():
        words = key.split("_")
        if value is not None and len(words) == 3 and words[0] in _V1 and words[1] in _BANDS and words[2] in _COLLECTED:
            found.setdefault((words[0], words[2]), {})[_BANDS[words[1]]] = _number(value, f"{key} of {sample}")
    return [
        SphereValues(
            sample,
            *_V1[quantity],
            0.0,
            np.array(list(shares.values())),
            _COLLECTED[part],
            bands=tuple(shares),
            conditions=conditions,
            source=source,
        )
        for (quantity, part), shares in found.items()
    ]


def _wavelength(value: object, sample: str) -> float:
    """A wavelength [nm] of one in micrometres; the database's are rounded to float32."""
    wave = _number(value, f"a wavelength of {sample}")
    if not 0.1 <= wave <= 1000.0:
        raise FileFormatError(f"{sample}: wavelength {wave:g} is not within 0.1 to 1000 µm (give micrometres)")
    return round(1000.0 * wave, 3)


def _texts(found: Json, keys: dict[str, str]) -> dict[str, str]:
    return {
        meaning: str(found[key])
        for key, meaning in keys.items()
        if found.get(key) not in (None, "") and not isinstance(found[key], (dict, list))
    }


def _object(parent: Json, key: str) -> Json:
    value = parent.get(key)
    return value if isinstance(value, dict) else {}


def _number(value: object, what: str) -> float:
    try:
        number = math.nan if isinstance(value, bool) else float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not abs(number) <= 1e30:
        raise FileFormatError(f"{what} is {str(value)[:40]!r}, not a number (correct it)")
    return number
