"""A family on disk: a folder with a file a state, and a manifest that says what each is."""

from __future__ import annotations

import json
import tempfile
from contextlib import suppress
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from clerestory._core import ClerestoryError, FileFormatError, __version__
from clerestory.files import read as read_bsdf
from clerestory.system.components import sha256
from clerestory.system.family.family import Family, State
from clerestory.system.product import OrientationKeys, ProductData, with_product
from clerestory.trace.keys import Keys, Number
from clerestory.whole import write_whole

if TYPE_CHECKING:
    import os

    from clerestory.bsdf import Bsdf
    from clerestory.files import Target
    from clerestory.system.product import Curve

MANIFEST = "family.json"
FORMAT = "clerestory family"


class StateKeys(Keys):
    """A state in a manifest."""

    name: str
    """Of the state."""
    value: Number
    """Of the parameter."""
    file: str
    """Beside the manifest."""
    sha256: str
    """Of the file."""
    components: list[dict[str, Any]] = Field(default_factory=list)
    """Layers and gaps of the product."""


class SlatKeys(Keys):
    """Slats in a manifest."""

    width: Number
    """Of a slat [mm]."""
    pitch: Number
    """From slat to slat [mm]."""
    crown: Number
    """Height of a slat's middle over its edges [mm]."""


class ManifestKeys(Keys):
    """A manifest of a family."""

    format: Literal["clerestory family"]
    """What it is."""
    version: Literal[1]
    """Of the manifest."""
    made_by: str
    """The program that wrote it."""
    name: str
    """Of the family."""
    parameter: str
    """Its name with its unit."""
    states: Annotated[list[StateKeys], Field(min_length=2)]
    """The most open one first."""
    slats_mm: SlatKeys | None = None
    """Slats that tilt."""
    orientation: OrientationKeys | None = None
    """How the product is to be placed."""
    control_curve: dict[str, Any] | None = None
    """Tilts that keep the sun out, by its profile angle."""


def paths(family: Family, folder: Path, *, xml: bool) -> list[Path]:
    """Files of all states, and last the manifest."""
    suffix = "xml" if xml else "bsdf.npz"
    return [*(folder / f"{state.name}.{suffix}" for state in family.states), folder / MANIFEST]


def write(
    family: Family,
    folder: str | os.PathLike[str],
    *,
    xml: Target | None = None,
    curve: Curve | None = None,
) -> tuple[list[Path], list[str]]:
    """Write the files of all states, all of them or none, and last the manifest.

    Parameters
    ----------
    family
        What to write.
    folder
        Made if it is not there; an older family in it is replaced.
    xml
        The program that XML files are for; Clerestory's own files, which hold every model, by default. In XML beams are
        part of the tables, and each file holds what is known of the product.
    curve
        Control curve of its slats, to be put into the XML files and the manifest.

    Returns
    -------
    The files, the manifest last, and what XML could not take of any state, each told once.
    """
    home = Path(folder)
    is_new = not home.exists()
    home.mkdir(parents=True, exist_ok=True)
    *files, manifest = paths(family, home, xml=xml is not None)
    try:
        # All states at once or none: a family of which some are old is no family.
        with tempfile.TemporaryDirectory(prefix=".family-", dir=home) as place:
            made = [Path(place) / path.name for path in files]
            states, notes = _written(family, made, xml, curve)
            manifest.unlink(missing_ok=True)
            for path, final in zip(made, files, strict=True):
                path.replace(final)
    except BaseException:
        if is_new:
            with suppress(OSError):  # it is not empty if this ends while files get their names
                home.rmdir()
        raise
    content: dict[str, Any] = {
        "format": FORMAT,
        "version": 1,
        "made_by": f"Clerestory {__version__}",
        "name": family.name,
        "parameter": family.parameter,
        "states": states,
    }
    if family.slats_mm is not None:
        content["slats_mm"] = family.slats_mm
    if family.orientation is not None:
        content["orientation"] = OrientationKeys.from_value(family.orientation).model_dump(exclude_none=True)
    if curve is not None:
        content["control_curve"] = asdict(curve)
    write_whole(manifest, (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode())
    return [*files, manifest], list(dict.fromkeys(notes))


def _written(
    family: Family, files: list[Path], xml: Target | None, curve: Curve | None
) -> tuple[list[dict[str, Any]], list[str]]:
    """Entries of the states, whose files are written, and what XML could not take."""
    notes: list[str] = []
    states: list[dict[str, Any]] = []
    for state, path in zip(family.states, files, strict=True):
        try:
            if xml is None:
                state.bsdf.save(path)
            else:
                data = ProductData(state.components, family.parameter, state.value, None, curve, family.orientation)
                notes += with_product(_tables(state.bsdf), data).write(path, target=xml)
        except ClerestoryError as error:
            raise type(error)(f"state {state.name}: {str(error).removeprefix(f'{path}: ')}") from None
        entry = {"name": state.name, "value": state.value, "file": path.name, "sha256": sha256(path)}
        states.append({**entry, "components": list(state.components)})
    return states, notes


def read(path: str | os.PathLike[str]) -> Family:
    """A family by its manifest, or the folder that holds it.

    Raises
    ------
    FileFormatError
        The manifest is damaged, or a file is another than the one that was written; the text names it.
    OSError
        A file cannot be read.
    """
    manifest = Path(path) / MANIFEST if Path(path).is_dir() else Path(path)
    try:
        content = json.loads(manifest.read_bytes())
    except (UnicodeDecodeError, json.JSONDecodeError, RecursionError) as error:
        raise FileFormatError(f"{manifest}: no manifest of a family: {error} (build the family again)") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise FileFormatError(f"{manifest}: no manifest of a family (build the family again)")
    try:
        return _family(ManifestKeys.of(content), manifest.parent)
    except ClerestoryError as error:
        text = str(error)
        raise type(error)(text if text.startswith(f"{manifest.parent}") else f"{manifest}: {text}") from None


def _tables(bsdf: Bsdf) -> Bsdf:
    """As XML holds it: tensor trees as they are, all else as matrices."""
    models = [model for members in bsdf.models.values() for model in members.values()]
    if all(model.kind in ("matrix", "tensor tree") for model in models):
        return bsdf
    return bsdf.to_matrix(next((m.incident_basis for m in models if m.kind == "matrix"), "klems-full"))


def _family(keys: ManifestKeys, folder: Path) -> Family:
    states = []
    for number, entry in enumerate(keys.states, 1):
        place, file = f"state {number} ({entry.name})", folder / entry.file
        if Path(entry.file).name != entry.file:
            raise FileFormatError(f"{place}: its file lies elsewhere (put it beside the manifest)")
        if not file.is_file():
            raise FileFormatError(f"{place}: {file} does not exist (build the family again)")
        if sha256(file) != entry.sha256:
            raise FileFormatError(f"{place}: {file} has changed since (build the family again)")
        states.append(State(entry.name, entry.value, read_bsdf(file), tuple(entry.components), file))
    steps = [b.value - a.value for a, b in pairwise(states)]
    if not (all(step > 0.0 for step in steps) or all(step < 0.0 for step in steps)):
        raise FileFormatError("the values of its states neither rise nor fall all along (build the family again)")
    return Family(
        keys.name,
        keys.parameter,
        tuple(states),
        None if keys.slats_mm is None else keys.slats_mm.model_dump(),
        None if keys.orientation is None else keys.orientation.made(),
    )
