"""The data set that a person names: a file that holds one, or one that says how it comes about."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clerestory.system import build
from clerestory.trace.keys import RecipeError
from clerestory.trace.recipe import read_toml
from clerestory.trace.shipped import RECIPES, beside

if TYPE_CHECKING:
    from clerestory.bsdf import Bsdf
    from clerestory.system.build import Traced


@dataclass(frozen=True)
class DataSet:
    """A data set and where it comes from."""

    bsdf: Bsdf
    name: str
    sources: list[Path]
    """Files that were read for it."""
    is_stored: bool
    """Whether its one source is a BSDF file, whose bytes tell all that it holds."""
    window: build.Specified | None = None
    """Its layers, where it is the data set of a specification."""


def data_set(
    given: str,
    folder: Path = Path(),
    *,
    traced: Traced | None = None,
) -> DataSet:
    """The data set that is named.

    Parameters
    ----------
    given
        A BSDF file (.xml, .xml.gz, .npz); a specification of a window, solved as it asks for; a recipe of the virtual
        goniophotometer, traced on Klems' patches with its beams apart; or the name of a specification or recipe that
        comes with Clerestory.
    folder
        That files are relative to.
    traced
        Traces a sample, such as `clerestory.annual.traced.kept` does; anew each time by default.

    Raises
    ------
    ClerestoryError
        The text names the file, what is wrong and the remedy.
    OSError
        A file cannot be read.
    """
    path = beside(given, folder, build.SYSTEMS, RECIPES)
    if path.suffix.lower() != ".toml":
        from clerestory.files import read

        bsdf = read(path)
        return DataSet(bsdf, bsdf.metadata.name or path.name, [path], is_stored=True)
    try:
        tables = read_toml(path)
    except RecipeError as error:
        raise RecipeError(f"{path}: {error}") from None
    if "layers" in tables:
        return _solved(build.load(path, traced=traced))
    if "sample" in tables:
        return _of_sample(path, traced)
    raise RecipeError(
        f"{path}: neither a window nor a sample (give a specification, with [[layers]], or a recipe, with [sample])"
    )


def glazed(given: str, folder: Path, thickness_mm: float | None = None) -> DataSet:
    """The data set of a pane of glass.

    Parameters
    ----------
    given
        A file of its spectra, or the name of a glass that comes with Clerestory.
    folder
        That files are relative to.
    thickness_mm
        Of the glass that comes with Clerestory; for a file, instead of its own [mm].

    Raises
    ------
    ClerestoryError
        There is no such glass, or its file is damaged.
    OSError
        The file cannot be read.
    """
    path = folder / given
    is_file = bool(path.suffix) or path.is_file()
    pane: dict[str, Any] = {"file": str(path)} if is_file else {"glass": given}
    if thickness_mm is not None:
        pane["thickness_mm"] = thickness_mm
    return _solved(build.load({"system": {"resolution": "layers"}, "layers": [{"kind": "glass", **pane}]}))


def _solved(made: build.Specified) -> DataSet:
    return DataSet(made.bsdf(), made.name, made.sources, is_stored=False, window=made)


def _of_sample(path: Path, traced: Traced | None) -> DataSet:
    from clerestory import trace

    sample = trace.load(path)
    return DataSet((traced or trace.measure)(sample), sample.name, [path, *sample.files], is_stored=False)
