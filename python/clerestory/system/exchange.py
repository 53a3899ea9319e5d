"""A solved window as a data set for other programs: matrices, with all that is known of it besides light."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.metadata import Metadata
from clerestory.system.components import components_of_window
from clerestory.system.heat import as_one, heat
from clerestory.system.product import Heat, ProductData, product_of, with_product

if TYPE_CHECKING:
    from clerestory.bsdf import Bsdf
    from clerestory.system.build import Specified
    from clerestory.system.product import Curve
    from clerestory.system.window import Built


def described(made: Specified, bsdf: Bsdf) -> tuple[Bsdf, list[str]]:
    """A window's data set with the thermal properties of the whole, as of one layer, and what was assumed.

    What the data set knows already goes before. A layer whose thermal properties are not known leaves those of the
    whole as they are, with a note.
    """
    try:
        found, assumed = as_one(made.window)
    except MissingDataError as error:
        return bsdf, [f"thermal properties of the whole window are not known: {error}"]
    known: Metadata = bsdf.metadata
    return bsdf.with_metadata(**{k: v for k, v in found.items() if getattr(known, k) is None}), assumed


def data_set(made: Specified, built: Built, *, curve: Curve | None = None) -> tuple[Bsdf, list[str]]:
    """The same with components, U and solar heat gain, control curve and orientation, for XML files.

    Parameters
    ----------
    made, built
        The window, and what `Specified.solve` made of it.
    curve
        Of its slats.

    Returns
    -------
    The data set, and notes on what was assumed or is not known.
    """
    bsdf, notes = described(made, built.matrices)
    keys = made.specification.system
    # One layer that is a file may say of itself what the specification does not.
    own = made.window.layers[0].bsdf if len(made.window.layers) == 1 else None
    if own is not None:
        held = {key: getattr(own.metadata, key) for key in ("manufacturer", "product_name", "device_type")}
        given = made.specification.product.fields
        bsdf = bsdf.with_metadata(**{key: value for key, value in held.items() if value and key not in given})
    try:
        found = heat(
            made.window,
            built,
            width_m=keys.width_m or 1.0,
            height_m=keys.height_m or 1.0,
            tilt_deg=keys.tilt_deg,
        )
        gains = Heat(found.u, found.g, found.diffuse, found.winter.name, found.summer.name)
    except ClerestoryError as error:
        gains = None
        notes.append(f"U and solar heat gain are left out: {error}")
    about = made.specification.product.orientation
    said = (product_of(own) if own is not None else None) or ProductData()
    data = ProductData(
        components_of_window(made),
        said.parameter,
        said.value,
        gains,
        curve or said.curve,
        said.orientation if about is None else about.made(),
    )
    return with_product(bsdf, data), notes


def manifest(made: Specified, built: Built, *, curve: Curve | None = None) -> dict[str, object]:
    """The components of a window and what they come to, as a table of plain values."""
    from dataclasses import asdict

    from clerestory._core import __version__

    bsdf, notes = data_set(made, built, curve=curve)
    data = product_of(bsdf)
    assert data is not None
    return {
        "format": "clerestory product",
        "version": 1,
        "made_by": f"Clerestory {__version__}",
        "name": made.name,
        **made.specification.product.fields,
        **{key: value for key, value in asdict(data).items() if value is not None},
        "notes": notes,
    }
