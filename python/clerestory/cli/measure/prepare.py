"""`clerestory measure prepare`: from what an instrument saw to BSDF, with a record of every step."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, cast

import typer

from clerestory.cli.common import JsonOption, UsageError, note, one_of, plain, print_json, say, write_whole
from clerestory.cli.measure.inputs import measurement_of, refuse_to_write_over, words_of
from clerestory.cli.measure.keeping import KeepOption, Made, NoteOption, keep
from clerestory.cli.measure.options import (
    CONVENTIONS,
    ColumnOption,
    ConventionOption,
    DatabaseOption,
    DateOption,
    FileScatterOption,
    FileSideOption,
    LaboratoryOption,
    SampleOption,
    choices_of,
)

if TYPE_CHECKING:
    from clerestory.measure import Measurement
    from clerestory.measure.prepare.together import Level

_SYMMETRIES = ("auto", "isotropic", "quadrilateral", "left-right", "up-down", "rotational", "none")


def prepare(
    context: typer.Context,
    inputs: Annotated[
        list[str] | None,
        typer.Argument(metavar="FILE|SAMPLE…", help="Scans of a sample, the beam and the dark.", show_default=False),
    ] = None,
    *,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="OUT", help="A folder; or a file if there is one.", show_default=False),
    ],
    format_: Annotated[
        str, typer.Option("--format", metavar="FORMAT", help="mountain, iea21, astm, zemax, lighttools or csv.")
    ] = "mountain",
    preset: Annotated[
        str | None,
        typer.Option(
            "--preset",
            metavar="NAME",
            help=f"Whose angles the files hold as they stand: {', '.join(CONVENTIONS[1:])}.",
        ),
    ] = None,
    detector_cone: Annotated[
        float | None,
        typer.Option("--detector-cone", metavar="DEG", help="Full angle of the detector, for a beam of one point."),
    ] = None,
    level: Annotated[
        str, typer.Option("--level", metavar="WHOSE", help="Where scans overlap: as measured, coarse or fine.")
    ] = "as measured",
    grazing: Annotated[
        str, typer.Option("--grazing", metavar="DEG", help="Largest outgoing angle that is kept, or auto.")
    ] = "auto",
    shadow: Annotated[
        float, typer.Option("--shadow", metavar="DEG", help="Half angle about the source where the detector shades.")
    ] = 0.0,
    error: Annotated[
        float, typer.Option("--error", metavar="SHARE", help="Standard error of values beside the noise, such as 0.02.")
    ] = 0.0,
    band: Annotated[
        list[str] | None,
        typer.Option(
            "--band",
            metavar="BAND=CHANNEL:W,…",
            help="A band from detectors' channels: weights (solar=VIS:0.55,NIR:0.45), or their wavelengths in nm"
            " (solar=VIS:380-780,NIR:780-2500), or channels named by wavelengths (visible).",
        ),
    ] = None,
    standard: Annotated[
        str, typer.Option("--standard", metavar="NAME", help="Spectra that weigh: en410, iso9050 or nfrc300.")
    ] = "en410",
    symmetry: Annotated[
        str,
        typer.Option("--symmetry", metavar="NAME", help=f"Of the sample: {', '.join(_SYMMETRIES)} (fills nothing)."),
    ] = "auto",
    fill: Annotated[bool, typer.Option("--fill", help="Fill incident directions by reversed paths.")] = False,
    sample: SampleOption = None,
    db: DatabaseOption = None,
    laboratory: LaboratoryOption = None,
    date: DateOption = None,
    note_: NoteOption = None,
    keep_: KeepOption = True,
    side: FileSideOption = None,
    scatter: FileScatterOption = None,
    convention: ConventionOption = None,
    column: ColumnOption = None,
    as_json: JsonOption = False,
) -> None:
    """Turn scans into BSDF: dark, beam, frame, peaks and hemisphere together, limits, noise, bands, symmetry.

    Every step is told and kept in OUT.record.json; the files given are not changed. What was made of scans of the
    database is kept there too, so that a model of it leads back to what the instrument saw.

    Example: clerestory measure prepare twill/ --symmetry rotational -o prepared/
    """
    from clerestory.measure.files import writable_formats, write
    from clerestory.measure.prepare import Settings
    from clerestory.measure.prepare import prepare as prepared_of

    form = one_of(format_, "--format", tuple(writable_formats()))
    levels: tuple[Level, ...] = ("as measured", "coarse", "fine")
    chosen = next(name for name in levels if name == one_of(level, "--level", levels))
    limit: float | Literal["auto"] = "auto" if grazing == "auto" else _number(grazing, "--grazing")
    words = words_of(inputs, sample)
    refuse_to_write_over(output, words)
    choices = choices_of(side, scatter, convention, column)
    if preset is not None and "convention" in choices:
        raise UsageError("--preset and --convention NAME say the same of angles twice (leave one out)")
    measurement = measurement_of(words, db, sample, choices, laboratory=laboratory, date=date)
    settings = Settings(
        convention=None if preset is None else one_of(preset, "--preset", CONVENTIONS),
        detector_cone_deg=detector_cone,
        level=chosen,
        grazing_deg=limit,
        shadow_deg=shadow,
        relative_error=error,
        bands=_bands(band or [], measurement, standard),
        symmetry=one_of(symmetry, "--symmetry", _SYMMETRIES),  # type: ignore[arg-type]
        fill=fill,
    )
    done = prepared_of(measurement, settings)
    written = write(replace(done.measurement, scans=done.measurement.of()), output, form)
    record = output.with_name(f"{output.name}.record.json")
    content = {"sample": measurement.sample, "from": [str(word) for word in words], "steps": done.record()}
    write_whole(record, json.dumps(plain(content), indent=2, ensure_ascii=False) + "\n")
    kept = None
    if keep_:
        said = {**asdict(settings), "laboratory": laboratory, "date": date, **choices}
        result = Made(
            written.paths,
            f"{measurement.sample} prepared",
            {key: value for key, value in said.items() if value not in (None, {}, ())},
            cast("list[dict[str, object]]", plain(done.record())),
            kind="scans",
            scans=measurement.scans,
            note=note_,
        )
        kept = keep(context, result, words, db)
    if as_json:
        print_json({**content, "written": written.paths, "record": record, "notes": written.notes, "kept": kept})
        return
    for step in done.steps:
        say(f"{step.name}: {step.words}")
        for text in step.warnings:
            say(f"  warning: {text}")
    for text in written.notes:
        note(f"note: {text}")
    note(f"wrote {written.paths[0]}" if len(written.paths) == 1 else f"wrote {len(written.paths)} files to {output}")
    note(f"wrote {record}")
    if kept is not None:
        note(kept.words)


def _bands(texts: list[str], measurement: Measurement, standard: str) -> dict[str, dict[str, float]]:
    """Weights of channels by band, as given or by a standard's spectrum."""
    from clerestory.measure.prepare.spectra import weights

    bands: dict[str, dict[str, float]] = {}
    for text in texts:
        name, equals, rest = text.partition("=")
        pairs = [part.rpartition(":") for part in rest.split(",")] if equals else []
        if not name.strip() or any(not (channel and value) for channel, _, value in pairs):
            raise UsageError(f"--band {text}: not a band and its channels (such as solar=VIS:0.55,NIR:0.45)")
        if not pairs:
            channels = list(dict.fromkeys(c for scan in measurement.of() for c in scan.channels))
            bands[name.strip()] = dict(weights(channels, name.strip(), standard=standard).shares)
        elif all("-" in value for _, _, value in pairs):
            ranges = {channel.strip(): _range(value, text) for channel, _, value in pairs}
            found = weights(list(ranges), name.strip(), standard=standard, ranges_nm=ranges)
            bands[name.strip()] = dict(found.shares)
        else:
            bands[name.strip()] = {channel.strip(): _number(value, f"--band {text}") for channel, _, value in pairs}
    return bands


def _range(text: str, option: str) -> tuple[float, float]:
    low, _, high = text.partition("-")
    return _number(low, f"--band {option}"), _number(high, f"--band {option}")


def _number(text: str, option: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise UsageError(f"{option}: {text!r} is not a number (such as 80; see --help)") from None
