"""Real sample files, which lie beside the repository and add to the tests where they are.

They are looked for in the folder that the environment variable CLERESTORY_DATA names, or else in
`../shared/data` seen from the repository's root. Tests that need them skip where they are absent, with the
reason `ABSENT`.
"""

import gzip
import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
ABSENT = "sample data absent (set CLERESTORY_DATA to its folder)"


def sample_root() -> Path | None:
    """The folder of the sample data, or None where it is absent."""
    folder = Path(os.environ.get("CLERESTORY_DATA") or ROOT.parent / "shared" / "data")
    return folder if folder.is_dir() else None


def find_samples(kind: str) -> list[Path]:
    """BSDF files (.xml, .xml.gz in any case) of `klems`, `tensortree`, `klems/mini`; none where absent."""
    root = sample_root()
    if root is None:
        return []
    return sorted(p for p in (root / kind).iterdir() if p.name.lower().endswith((".xml", ".xml.gz")))


def sample_files(*kinds: str) -> list:
    """For `pytest.mark.parametrize("path", …)`: a parameter a file, or one that skips if they are absent."""
    if sample_root() is None:
        return [pytest.param(None, marks=pytest.mark.skip(reason=ABSENT), id="absent")]
    return [pytest.param(path, id=path.name) for kind in kinds for path in find_samples(kind)]


def unpacked(path: Path, folder: Path) -> Path:
    """The file itself, or a copy without gzip in `folder`, for programs that cannot read gzip."""
    if path.suffix != ".gz":
        return path
    target = folder / path.stem
    target.write_bytes(gzip.decompress(path.read_bytes()))
    return target
