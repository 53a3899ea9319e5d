"""`clerestory measure camera`: luminance pictures of a camera-based goniophotometer to scans."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    list_shipped,
    note,
    one_of,
    print_json,
    progress,
    say,
    table,
    warn,
)
from clerestory.counts import counted


def camera(
    rig: Annotated[
        str | None,
        typer.Argument(metavar="[RIG]", help="TOML file: geometry and pictures.", show_default=False),
    ] = None,
    *,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="OUT", help="A folder; or a file if there is one.")
    ] = None,
    format_: Annotated[
        str, typer.Option("--format", metavar="FORMAT", help="iea21, mountain, astm, zemax, lighttools or csv.")
    ] = "iea21",
    list_all: Annotated[bool, typer.Option("--list", help="List the rigs that come with Clerestory.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Make scans of luminance pictures: of screens that a sample lights in several positions, or of the sample itself.

    The exit grid has 5° (1,297 directions) or another step. Where positions meet, they are compared; what none of them
    sees is absent from the result.

    Example: clerestory measure camera rig.toml -o twill-iea21/
    """
    from clerestory.cli.common import about
    from clerestory.measure.camera import RIGS, develop, read_rig
    from clerestory.measure.files import writable_formats, write

    if list_all:
        list_shipped(RIGS, as_json=as_json)
        return
    if rig is None:
        raise UsageError("RIG: none is given (give a TOML file, or --list for an example)")
    if output is None:
        raise UsageError("--output: none is given (give a folder)")
    chosen = one_of(format_, "--format", tuple(writable_formats()))
    path = RIGS.find(rig)
    given = read_rig(path)
    with about(path), progress("pictures") as tell:
        made = develop(given, progress=tell)
    for text in made.measurement.warnings:
        warn(path, text)
    written = write(made.measurement, output, chosen)
    if as_json:
        print_json(
            {
                "sample": made.measurement.sample,
                "directions": made.directions,
                "missing": made.missing,
                "warnings": made.measurement.warnings,
                "seams": made.seams,
                "written": written.paths,
                "notes": written.notes,
            }
        )
        return
    seen = made.directions - made.missing
    say(f"{made.measurement.sample}: {counted(len(made.measurement.scans), 'incident direction')}, "
        f"{seen} of {made.directions} exit directions seen")  # fmt: skip
    rows = [
        [f"{scan.incident_theta_deg:g},{scan.incident_phi_deg:g}", seam.first, seam.second,
         f"{seam.ratio:.3f}", f"{100.0 * seam.mismatch:.1f} %"]
        for scan, joints in zip(made.measurement.scans, made.seams, strict=True)
        for seam in joints
    ]  # fmt: skip
    if rows:
        say(table(["light from", "position", "and", "ratio", "differ by"], rows, left=3))
    for text in written.notes:
        note(f"note: {text}")
    note(f"wrote {counted(len(written.paths), 'file')} to {output}")
