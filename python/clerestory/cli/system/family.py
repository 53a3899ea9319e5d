"""`clerestory system family`: a product with a parameter, such as a blind and its tilt, as a set of data sets."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    about,
    check_folder,
    note,
    one_of,
    print_json,
    refuse_overwriting,
    say,
    table,
    warn,
)

if TYPE_CHECKING:
    from clerestory.files import Target
    from clerestory.system.family import Family
    from clerestory.system.product import Curve

_TARGETS = ("plain", "radiance", "window", "energyplus")


def family(
    spec: Annotated[
        Path,
        typer.Argument(
            metavar="SPEC|MANIFEST",
            help="Specification with a table [family] (.toml), or the manifest of a family that was built (.json).",
            show_default=False,
        ),
    ],
    *,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FOLDER", help="Write the states' files and family.json here."),
    ] = None,
    xml: Annotated[
        str | None,
        typer.Option(
            "--for",
            metavar="PROGRAM",
            help="Write XML for plain, radiance, window or energyplus; Clerestory's own files by default.",
        ),
    ] = None,
    safety: Annotated[
        float, typer.Option("--safety", metavar="DEG", help="Added to the tilts of the control curve.")
    ] = 0.0,
    as_json: JsonOption = False,
) -> None:
    """Make a product's data set for every value of a parameter, with a manifest that names them.

    A specification is a recipe, or the specification of a window, with a table [family] that says which of its keys
    changes, and to which values; docs/systems.md has every key. A study takes the manifest for its windows' states.

    Example: clerestory system family blind-family.toml -o blind
    """
    if xml is not None and output is None:
        raise UsageError("--for goes with --output (give a folder)")
    target = None if xml is None else cast("Target", one_of(xml, "--for", _TARGETS))
    check_folder(output)
    made, sources = _family(spec, quiet=as_json)
    written: list[Path] = []
    if output is not None:
        from clerestory.system.family import write
        from clerestory.system.family.manifest import paths

        for path in paths(made, output, xml=target is not None):
            refuse_overwriting(path, sources)
        with about(spec):
            written, notes = write(made, output, xml=target, curve=_curve(made, safety))
        for text in notes:
            warn(spec, text)
    if as_json:
        print_json({**_result(made), "written": written})
        return
    _tell(made)
    if written:
        note(f"wrote {written[-1]} and {len(written) - 1} files beside it")


def _family(spec: Path, *, quiet: bool) -> tuple[Family, list[Path]]:
    from clerestory.system.family import load, read

    if spec.suffix.lower() == ".json" or spec.is_dir():
        with about(spec):
            return read(spec), [spec]
    from clerestory.annual.cache import Cache
    from clerestory.annual.traced import kept

    planned = load(spec)
    with about(spec):
        made = planned.make(kept(Cache(), None if quiet else note))
    for text in planned.notes:
        warn(spec, text)
    return made, planned.sources


def _curve(made: Family, safety: float) -> Curve | None:
    """The control curve of its slats, within the tilts that it has."""
    if made.slats_mm is None or made.parameter != "tilt_deg":
        return None
    from clerestory.annual.control.curve import control_curve
    from clerestory.annual.control.slats import Slats

    limits = min(made.values), max(made.values)
    slats = Slats(made.slats_mm["width"], made.slats_mm["pitch"], made.slats_mm["crown"])
    return control_curve(slats, name=made.name, safety_deg=safety, range_deg=limits).as_product()


def _result(made: Family) -> dict[str, object]:
    return {
        "name": made.name,
        "parameter": made.parameter,
        "slats_mm": made.slats_mm,
        "orientation": made.orientation,
        "states": [
            {"name": s.name, "value": s.value, **_values(made, k), "components": s.components}
            for k, s in enumerate(made.states)
        ],
    }


def _values(made: Family, k: int) -> dict[str, float]:
    """What a state does with light from the exterior, in its first band."""
    from clerestory.directions import direction
    from clerestory.integrals import hemispherical

    bsdf = made.states[k].bsdf
    normal = direction(0.0, 0.0, side="exterior")
    return {
        "transmittance_normal": float(bsdf.integrate(normal, "transmission")),
        "transmittance_diffuse": hemispherical(bsdf, "transmission", side="exterior").value,
        "reflectance_diffuse": hemispherical(bsdf, "reflection", side="exterior").value,
    }


def _tell(made: Family) -> None:
    say(f"{made.name}: {len(made.states)} states by {made.parameter}")
    rows = [
        [state.name, f"{state.value:g}", *(f"{value:.3f}" for value in _values(made, k).values())]
        for k, state in enumerate(made.states)
    ]
    say(table(["state", made.parameter, "T normal", "T diffuse", "R diffuse"], rows))
