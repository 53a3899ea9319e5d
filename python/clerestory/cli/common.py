"""What all commands share: options, reading with warnings, output, errors in one line.

Results go to standard output, everything else to standard error. With `--json` a command prints one JSON value and
nothing else there.
"""

from __future__ import annotations

import errno
import json
import math
import os
import sys
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from clerestory.endings import is_bsdf, stem_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from clerestory.basis import Basis
    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side
    from clerestory.trace.shipped import Shelf

FileArgument = Annotated[
    Path, typer.Argument(metavar="FILE", help="BSDF file: .xml, .xml.gz or .bsdf.npz.", show_default=False)
]
FilesArgument = Annotated[
    list[Path], typer.Argument(metavar="FILE…", help="BSDF files: .xml, .xml.gz or .bsdf.npz.", show_default=False)
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON value and nothing else.")]
BandOption = Annotated[
    str | None,
    typer.Option("--band", metavar="NAME", help="visible, solar, nir, …; visible, or the first, by default."),
]
SideOption = Annotated[str, typer.Option("--side", metavar="SIDE", help="Side that the light comes from.")]
ScatterOption = Annotated[
    str, typer.Option("--scatter", metavar="SCATTER", help="Light that passes (transmission) or returns (reflection).")
]
_OF_FILES = (".nc", ".csv", ".json", ".html", ".pdf", ".png", ".svg", ".xml", ".npz", ".toml")
SIDE_NAMES = ("exterior", "interior")
SCATTER_NAMES = ("transmission", "reflection")
TREES: tuple[Literal["tensor3", "tensor4"], ...] = ("tensor3", "tensor4")
"""What is named in place of a basis for a tensor tree."""


class CommandError(Exception):
    """Something that a command cannot do; its text names what, where and the remedy."""


class UsageError(CommandError):
    """An option or argument that does not make sense; exit code 2."""


def is_expected(error: Exception) -> bool:
    """Whether an exception is a message for the person rather than a fault of the program."""
    if isinstance(error, (CommandError, OSError, MemoryError)):
        return True
    core = sys.modules.get("clerestory._core")
    return core is not None and isinstance(error, core.ClerestoryError)


def in_one_line(error: Exception) -> str:
    """The text of an exception as one line with a remedy."""
    if isinstance(error, MemoryError):
        text = f"not enough memory {error} (use a smaller file or resolution)"
    elif isinstance(error, OSError) and error.strerror:
        text = f"{error.strerror[0].lower()}{error.strerror[1:]} ({_remedy(error.errno)})"
        if error.filename is not None:
            text = f"{error.filename}: {text}"
    else:
        text = str(error)
    return " ".join(text.split())


def _remedy(number: int | None) -> str:
    return {
        errno.ENOENT: "check the path",
        errno.EACCES: "check the permissions",
        errno.EISDIR: "give a file, not a folder",
        errno.ENOTDIR: "check the path",
        errno.ENOSPC: "free some space",
        errno.EDQUOT: "free some space",
        errno.EFBIG: "raise the limit of a file's size",
        errno.EROFS: "choose another folder",
    }.get(number or 0, "check the file")


@contextmanager
def about(path: Path) -> Iterator[None]:
    """Put the name of a file before the messages of what fails inside."""
    try:
        yield
    except Exception as error:
        text = in_one_line(error)
        if isinstance(error, UsageError) or not is_expected(error) or text.startswith(f"{path}:"):
            raise
        raise CommandError(f"{path}: {text}") from error


def warn(path: Path | str, text: str) -> None:
    """Show a warning about a file on standard error."""
    typer.echo(f"warning: {path}: {' '.join(text.split())}", err=True)


def read(
    path: Path,
    *,
    show_warnings: bool = True,
    side: Side | None = None,
    scatter: Scatter | None = None,
    basis: Basis | None = None,
    band: str | None = None,
) -> Bsdf:
    """Read a file and show what was faulty in it on standard error.

    Parameters
    ----------
    path
        The file.
    show_warnings
        False if the command itself says what is in `Bsdf.warnings`.
    side, scatter, basis, band
        What the file does not tell, see `clerestory.read`.
    """
    import clerestory

    with about(path):
        bsdf = clerestory.read(path, side=side, scatter=scatter, basis=basis, band=band)
    if show_warnings:
        for text in bsdf.warnings:
            warn(path, text.removeprefix(f"{path}: "))
    return bsdf


def angle_pair(text: str, option: str) -> tuple[float, float]:
    """Angle to the normal and azimuth [°] from `T,P`, as in `--incident 40,90`."""
    try:
        theta, phi = (float(part) for part in text.split(","))
    except ValueError:
        raise UsageError(
            f"{option} {text}: not two angles (give the angle to the normal and the azimuth, such as 40,90)"
        ) from None
    if not (0.0 <= theta <= 90.0 and math.isfinite(phi)):
        raise UsageError(f"{option} {text}: the angle to the normal goes from 0 to 90° (a side is chosen by --side)")
    return theta, phi % 360.0


def numbers(text: str, option: str, count: int, example: str) -> tuple[float, ...]:
    """Finite numbers from a list with commas, as in `--ring 5,15`."""
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) != count or not all(math.isfinite(v) for v in values):
        raise UsageError(f"{option} {text}: {count} numbers are asked for (such as {example})")
    return values


def one_of(text: str, option: str, names: Sequence[str]) -> str:
    """A name out of a few; its first letters are enough."""
    matches = [name for name in names if name.startswith(text.lower())]
    if text and (len(matches) == 1 or text.lower() in names):
        return text.lower() if text.lower() in names else matches[0]
    raise UsageError(f"{option} {text}: not known (give {' or '.join(names)})")


def side_of(text: str, option: str = "--side") -> Side:
    """`exterior` or `interior`, or their first letters."""
    return "exterior" if one_of(text, option, SIDE_NAMES) == "exterior" else "interior"


def scatter_of(text: str, option: str = "--scatter") -> Scatter:
    """`transmission` or `reflection`, or their first letters."""
    return "transmission" if one_of(text, option, SCATTER_NAMES) == "transmission" else "reflection"


def say(text: str = "") -> None:
    """Print a line of the result."""
    typer.echo(text)


def note(text: str) -> None:
    """Print a line about the work, such as `wrote x.xml`, on standard error."""
    typer.echo(text, err=True)


def print_json(value: object) -> None:
    """Print a result for machines: dataclasses as objects, arrays as lists, what is not finite as null."""
    typer.echo(json.dumps(plain(value), indent=2, ensure_ascii=False, allow_nan=False))


def plain(value: object) -> object:
    """A value as JSON knows it."""
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, dict):
        return {str(key): plain(member) for key, member in value.items()}
    if isinstance(value, (list, tuple, set, frozenset)):
        return [plain(member) for member in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, (str, bool, int)):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    to_list = getattr(value, "tolist", None)
    return plain(to_list()) if to_list is not None else str(value)


def table(headers: Sequence[str], rows: Sequence[Sequence[str]], *, left: int = 1) -> str:
    """Columns in plain text; the first `left` are set left, the others right."""
    widths = [max(len(str(row[c])) for row in [headers, *rows]) for c in range(len(headers))]
    lines = []
    for row in [headers, *rows]:
        cells = [
            str(cell).ljust(width) if c < left else str(cell).rjust(width)
            for c, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append(f"  {'  '.join(cells)}".rstrip())
    return "\n".join(lines)


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """Show a bar on standard error if that is a terminal; the value is called with the share that is done, 0 to 1."""
    if not sys.stderr.isatty():
        yield lambda _share: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(label, total=1.0)
        yield lambda share: bar.update(task, completed=share)


@contextmanager
def tasks() -> Iterator[Callable[[float, str], None]]:
    """As `progress`, for work of many parts: called with the share of all and the words for the part at hand."""
    if not sys.stderr.isatty():
        yield lambda _share, _words: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (BarColumn(), TaskProgressColumn(), TimeRemainingColumn(), TextColumn("{task.description}"))
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda share, words: bar.update(task, completed=share, description=words)


def write_whole(path: Path | str, data: bytes | str) -> None:
    """Write a file whole or not at all; text as UTF-8."""
    from clerestory.whole import write_whole as write

    write(path, data.encode("utf-8") if isinstance(data, str) else data)


@contextmanager
def kept(keep: Callable[[Path], str], output: Path, *, resume: bool) -> Iterator[None]:
    """Keep what was finished if Ctrl-C is pressed, and drop it when all is done.

    `keep` writes it to a file and tells how much it is, such as `12 of 82 parts are`; nothing if there is nothing.
    """
    partial = partial_of(output)
    try:
        yield
    except KeyboardInterrupt:
        told = keep(partial)
        if told:
            note(f"note: {told} kept in {partial} (the same command with --resume goes on)")
        raise
    if resume:
        partial.unlink(missing_ok=True)


def partial_of(output: Path, *, must_exist: bool = False) -> Path:
    """Where interrupted work is kept until its output can be written."""
    partial = output.with_name(f"{stem_of(output).removesuffix(output.suffix)}.partial.npz")
    if must_exist and not partial.exists():
        raise UsageError(f"--resume: there is no {partial} (leave --resume out to start)")
    return partial


def check_bsdf_name(output: Path) -> None:
    """Fail if an output's name tells none of the formats of BSDF files."""
    if not is_bsdf(output):
        raise UsageError(f"{output}: the name does not tell the format (end it with .xml, .xml.gz or .bsdf.npz)")


def check_folder(output: Path | None) -> None:
    """Fail if what results are written into is a file, or is named as one."""
    if output is None or output.is_dir():
        return
    if output.exists():
        raise UsageError(f"{output}: is a file (give a folder, or a name that is free)")
    if output.suffix.lower() in _OF_FILES:
        raise UsageError(f"{output}: several files are written, into a folder (leave {output.suffix} out)")


def refuse_overwriting(output: Path, inputs: Sequence[Path]) -> None:
    """Fail if an output is one of the inputs."""
    for path in inputs:
        if output.exists() and path.exists() and output.samefile(path):
            raise UsageError(f"{output}: the output would overwrite an input (choose another name)")


def list_shipped(shelf: Shelf, *, as_json: bool) -> None:
    """Print the recipes of a shelf, and what each is."""
    found = [{"name": name, "what": shelf.about(name), "file": shelf.path_of(name)} for name in shelf.names()]
    if as_json:
        print_json(found)
        return
    say(table([shelf.what, ""], [[str(f["name"]), str(f["what"])] for f in found], left=2))
