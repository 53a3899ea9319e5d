"""Radiance's matrix files: ASCII, float and double, read and written."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from clerestory import __version__
from clerestory._core import ClerestoryError, FileFormatError
from clerestory.basis import Basis
from clerestory.sky import SkyPatches
from clerestory.whole import write_whole

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from numpy.typing import NDArray

Form = Literal["ascii", "float", "double"]
_TYPES: dict[str, np.dtype[Any]] = {"float": np.dtype("<f4"), "double": np.dtype("<f8")}
_SIZES = ("NROWS", "NCOLS", "NCOMP")
_MOST_HEAD = 1 << 20
BASES = ("klems-full", "klems-half", "klems-quarter", "tregenza")
"""Whose number of patches an error names, if a matrix has it."""


def write(
    path: str | os.PathLike[str],
    values: NDArray[np.floating],
    *,
    form: Form = "float",
    header: Sequence[str] = (),
) -> None:
    """Write a matrix (rows, columns) or (rows, columns, components), whole or not at all.

    Parameters
    ----------
    path, values
        The file, and what goes into it. A matrix without components becomes one of three that are equal, as
        Radiance's programs expect.
    form
        `ascii`, `float` (32 bits) or `double`, least byte first.
    header
        Lines of information.
    """
    values = np.asarray(values)
    if values.ndim == 2:
        values = np.repeat(values[:, :, None], 3, axis=2)
    if values.ndim != 3:
        raise ClerestoryError(f"a matrix has rows, columns and components, not {values.ndim} dimensions")
    rows, columns, components = values.shape
    lines = ["#?RADIANCE", *header, f"SOFTWARE= Clerestory {__version__}"]
    lines += [f"NROWS={rows}", f"NCOLS={columns}", f"NCOMP={components}"]
    if form != "ascii":
        lines.append("BigEndian=0")
    head = "\n".join([*lines, f"FORMAT={form}", "", ""]).encode()
    if form == "ascii":
        body = "\n".join("\t".join(" ".join(f"{v:.9g}" for v in entry) for entry in row) for row in values) + "\n"
        write_whole(path, head + body.encode())
    else:
        write_whole(path, head + np.ascontiguousarray(values, dtype=_TYPES[form]).tobytes())


def read(
    path: str | os.PathLike[str],
    *,
    rows_of: Basis | SkyPatches | None = None,
    columns_of: Basis | SkyPatches | None = None,
) -> NDArray[np.float64]:
    """Read a matrix (rows, columns, components).

    Parameters
    ----------
    path
        The file.
    rows_of, columns_of
        Patches that its rows or columns must be of, group by group; not looked at by default.

    Raises
    ------
    FileFormatError
        The file is no matrix, is cut off, or of other patches; the text names the file, what is wrong and the remedy.
    OSError
        It cannot be opened.
    """
    path = Path(path)
    data = path.read_bytes()

    def wrong(text: str) -> FileFormatError:
        return FileFormatError(f"{path}: {text}")

    end = data.find(b"\n\n", 0, _MOST_HEAD)
    if not data.startswith(b"#?") or end < 0:
        raise wrong("this is no Radiance matrix: its head is missing (write it with a header: rmtxop, or rcollate -h)")
    head: dict[str, str] = {}
    exposure = 1.0
    for line in data[:end].decode("latin-1").splitlines():
        name, sign, value = line.partition("=")
        if sign:
            head[name] = value.strip()
            if name == "EXPOSURE":
                try:
                    exposure *= float(value)
                except ValueError:
                    raise wrong(f"EXPOSURE={value.strip()} is no number (correct the head)") from None
    try:
        rows, columns, components = (int(head.get(name, 3 if name == "NCOMP" else "")) for name in _SIZES)
    except ValueError:
        raise wrong("NROWS or NCOLS is missing or no number (add them to the head)") from None
    if min(rows, columns, components) < 1:
        raise wrong(f"{rows} rows, {columns} columns and {components} components make no matrix (correct the head)")
    form = head.get("FORMAT", "ascii")
    body, count = data[end + 2 :], rows * columns * components
    if form == "ascii":
        try:
            values = np.array(body.split(), dtype=np.float64)
        except ValueError:
            raise wrong("there is something else than numbers in it (write it again)") from None
    elif form in _TYPES:
        kind = _TYPES[form].newbyteorder(">" if head.get("BigEndian") == "1" else "<")
        values = np.frombuffer(body, dtype=kind, count=len(body) // kind.itemsize).astype(np.float64)
    else:
        raise wrong(f"FORMAT={form} is not read (known are ascii, float and double; rmtxop -fd converts)")
    if len(values) < count:
        raise wrong(f"it holds {len(values)} numbers of {count} and is cut off (write it again)")
    if form == "ascii" and len(values) > count:
        raise wrong(f"it holds {len(values)} numbers where {count} are told of (correct NROWS, NCOLS and NCOMP)")
    for number, patches, what in ((rows, rows_of, "rows"), (columns, columns_of, "columns")):
        if patches is not None and number % len(patches):
            raise wrong(_other_patches(number, patches, what))
    return values[:count].reshape(rows, columns, components) / exposure


def _other_patches(number: int, patches: Basis | SkyPatches, what: str) -> str:
    known: list[Basis | SkyPatches] = [Basis.named(name) for name in BASES]
    known += [SkyPatches.named(f"reinhart:{n}") for n in range(1, 7)]
    alike = [other.name for other in known if len(other) == number]
    fits = f"{' and '.join(alike)} {'has' if len(alike) == 1 else 'have'} so many; " if alike else ""
    return (
        f"{number} {what} do not go with the {len(patches)} patches of {patches.name} "
        f"({fits}make it with {patches.name}, or read it with the patches that it has)"
    )
