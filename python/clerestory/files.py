"""Files: BSDF XML of WINDOW, Radiance and genBSDF, and Clerestory's own file."""

from __future__ import annotations

import os
from collections import Counter
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from clerestory import _core
from clerestory.basis import Basis
from clerestory.bsdf import Bsdf
from clerestory.endings import is_bsdf, stem_of
from clerestory.whole import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from clerestory.directions import Scatter, Side

Target = Literal["plain", "radiance", "window", "energyplus"]


def read(
    path: str | os.PathLike[str],
    *,
    side: Side | None = None,
    scatter: Scatter | None = None,
    basis: Basis | str | None = None,
    band: str | None = None,
) -> Bsdf:
    """Read a BSDF file.

    Plain and gzipped XML and Clerestory's own file are told apart by their content. What was faulty in the file but
    could be understood is in `Bsdf.warnings`.

    Parameters
    ----------
    path
        The file.
    side
        Side that the light comes from, for an XML file whose blocks do not tell.
    scatter
        Transmission or reflection, for an XML file whose blocks do not tell.
    basis
        Incident and outgoing angle basis, for an XML file that names it wrongly or not at all.
    band
        Name of the band, for an XML file that does not name it.

    Raises
    ------
    FileFormatError
        The file is damaged, or could mean two things that the hints do not decide; the text names file, line,
        element and remedy.
    OSError
        The file cannot be opened.

    Examples
    --------
    >>> import clerestory
    >>> bsdf = clerestory.read("blind.xml")  # doctest: +SKIP
    """
    path = Path(path)
    data = path.read_bytes()
    with named(path):
        if data.startswith(b"PK\x03\x04"):
            own: Bsdf = import_module("clerestory.npz").load(path)
            return own
        named_basis = Basis.named(basis) if isinstance(basis, str) else basis
        core = _core.Bsdf.from_xml(data, side, scatter, None if named_basis is None else named_basis._core, band)
    return Bsdf(core)


def write(bsdf: Bsdf, path: str | os.PathLike[str], *, target: Target = "plain") -> list[str]:
    """Write a data set: the function behind `Bsdf.write`."""
    path = Path(path)
    name = path.name.lower()
    with named(path):
        if not is_bsdf(path):
            raise _core.ClerestoryError("the name does not tell the format (end it with .xml, .xml.gz or .bsdf.npz)")
        if name.endswith(".npz"):
            if target != "plain":
                raise _core.ClerestoryError(f"{target} reads no .npz (write an .xml for it)")
            import_module("clerestory.npz").save(bsdf, path)
            return []
        data, notes = bsdf._core.to_xml(target, name.endswith(".gz"))
    write_whole(path, data)
    return notes


def default_labels(paths: Sequence[str | os.PathLike[str] | None]) -> list[str]:
    """Names for data sets: those of their files without folder and suffix.

    Files of one name are told apart by their folders or, in the end, by numbers, and so are data sets without a file.
    """
    files = [None if p is None else Path(p) for p in paths]
    stems = [f"data set {k + 1}" if p is None else stem_of(p) for k, p in enumerate(files)]
    for depth in (1, 2):
        again = Counter(stems)
        stems = [
            "/".join([*p.resolve().parent.parts[-depth:], stem_of(p)]) if p and again[s] > 1 else s
            for s, p in zip(stems, files, strict=True)
        ]
    again, seen, unique = Counter(stems), Counter[str](), []
    for stem in stems:
        seen[stem] += 1
        unique.append(f"{stem} ({seen[stem]})" if again[stem] > 1 else stem)
    return unique


@contextmanager
def named(path: Path) -> Iterator[None]:
    """Put a file's name before the text of what fails inside."""
    try:
        yield
    except _core.ClerestoryError as error:
        if str(error).startswith(f"{path}: "):
            raise
        raise type(error)(f"{path}: {error}") from error
