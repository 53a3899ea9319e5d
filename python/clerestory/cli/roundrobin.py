"""`clerestory roundrobin`: data sets of several laboratories through the same analyses, in one command."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    about,
    check_folder,
    note,
    one_of,
    print_json,
    say,
    table,
    tasks,
    warn,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.roundrobin.run import Work
    from clerestory.roundrobin.study import RoundRobin
    from clerestory.system.build import Traced


def roundrobin(
    sources: Annotated[
        list[str],
        typer.Argument(
            metavar="STUDY.toml | FILE…",
            help="A study, or two or more BSDF files of one system; LAB=FILE names the laboratory.",
            show_default=False,
        ),
    ],
    *,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="FOLDER", help="For report.html, report.pdf, results.json and results.nc."
        ),
    ] = None,
    weather: Annotated[
        Path | None,
        typer.Option("--weather", metavar="FILE", help="Of the year; made up for the room's place by default."),
    ] = None,
    without: Annotated[
        list[str] | None,
        typer.Option(
            "--without", metavar="ANALYSIS", help="Leave out transmittance, moments or year; can be repeated."
        ),
    ] = None,
    cache: Annotated[
        Path | None,
        typer.Option("--cache", metavar="FOLDER", help="Of what is kept for reruns; $CLERESTORY_CACHE by default."),
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Only say what would be computed, and about how long it takes.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Compare laboratories' data sets: transmittances, glare at points in time, a year, and what the spread comes from.

    Each data set is used in four treatments: as a Klems matrix or at its own resolution, with or without its
    through-beam as an explicit peak. Two files of one laboratory (LAB=klems.xml LAB=tree.xml) go together. What is
    computed is kept, so that a rerun takes what has not changed, and goes on after Ctrl-C.

    Example: clerestory roundrobin HSLU=a.xml ISE=b.xml LBNL=c.xml -o results
    """
    from clerestory.annual.cache import Cache
    from clerestory.annual.traced import kept
    from clerestory.roundrobin.run import Work

    check_folder(output)
    if output is None and not (as_json or dry_run):
        raise UsageError("the results have no folder (give -o FOLDER, --json or --dry-run)")
    kept_in = Cache(cache)
    study = _study(sources, weather, without or [], kept(kept_in, note))
    for system in study.systems:
        for laboratory in system.laboratories:
            for source in laboratory.sources:
                for text in source.bsdf.warnings:
                    warn(source.path, text.removeprefix(f"{source.path}: "))
    with about(Path(sources[0])) if sources[0].lower().endswith(".toml") else nullcontext():
        work = Work(study, kept_in)
    if dry_run:
        _tell_plan(work, as_json=as_json)
        return
    _run(study, work, output, " ".join(["clerestory roundrobin", *(Path(s).name for s in sources)]), as_json=as_json)


def _run(study: RoundRobin, work: Work, output: Path | None, command: str, *, as_json: bool) -> None:
    from clerestory.roundrobin.results import results

    try:
        with tasks() as tell:
            found = work.run(tell)
    except KeyboardInterrupt:
        kept = sum(piece.is_kept(work.cache) for piece in work.pieces)
        note(f"note: {kept} of {len(work.pieces)} pieces are kept (the same command goes on)")
        raise
    for text in work.cache.warnings:
        note(f"warning: {text}")
    written: list[Path] = []
    if output is not None:
        from clerestory.roundrobin.files import write
        from clerestory.roundrobin.report import document

        with tasks() as tell:
            made = document(study, found, command=command, progress=lambda share: tell(share, "report"))
            written = write(study, found, made, output)
    if as_json:
        told: dict[str, Any] = results(study, found)
        counted = {"computed": len(work.cache.computed), "kept": len(work.cache.found)}
        print_json({**told, "pieces": counted, "written": [str(path) for path in written]})
        return
    from clerestory.roundrobin.conclusion import sentences, warnings

    for one in found:
        for sentence in sentences(one):
            say(sentence)
        for text in warnings(one):
            note(f"note: {text}")
    for path in written:
        say(f"wrote {path}")


def _study(sources: Sequence[str], weather: Path | None, without: Sequence[str], traced: Traced) -> RoundRobin:
    """From a study file, or from files of one system."""
    from clerestory.cli.compare import laboratories
    from clerestory.roundrobin.recipe import ANALYSES
    from clerestory.roundrobin.study import load, of_files

    left_out = [one_of(word, "--without", ANALYSES) for word in without]
    studies = [word for word in sources if word.lower().endswith(".toml")]
    if studies and len(sources) > 1:
        raise UsageError(f"{studies[0]}: a study stands alone (name its files in it)")
    changes: dict[str, Any] = {"analyses": [name for name in ANALYSES if name not in left_out]} if left_out else {}
    if weather is not None:
        changes["weather"] = str(weather.resolve())
    if studies:
        return load(studies[0], without=left_out, weather=changes.get("weather"), traced=traced)
    year = {"year": {"weather": changes.pop("weather")}} if weather is not None else {}
    return of_files(laboratories(sources), **changes, **year)


def _tell_plan(work: Work, *, as_json: bool) -> None:
    """What would be computed; estimates are of measured constants."""
    import os

    missing = [piece for piece in work.pieces if not piece.is_kept(work.cache)]
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    cpu_s = sum(piece.cpu_s for piece in missing)
    plan = {
        "pieces": len(work.pieces),
        "kept": len(work.pieces) - len(missing),
        "to_compute": [{"what": p.words, "kind": p.kind, "cpu_s": p.cpu_s, "size_mb": p.size_mb} for p in missing],
        "estimated_cpu_s": round(cpu_s, 1),
        "estimated_minutes": round(cpu_s / cores / 60.0, 1),
        "cores": cores,
        "estimated_disk_mb": round(sum(piece.size_mb for piece in missing), 1),
        "cache": str(work.cache.folder),
    }
    if as_json:
        print_json(plan)
        return
    kinds: dict[str, list[float]] = {}
    for piece in missing:
        own = kinds.setdefault(piece.kind, [0, 0.0, 0.0])
        own[0], own[1], own[2] = own[0] + 1, own[1] + piece.cpu_s, own[2] + piece.size_mb
    rows = [[kind, f"{n:.0f}", f"{cpu:.0f} s", f"{size:.1f} MB"] for kind, (n, cpu, size) in kinds.items()]
    if rows:
        say(table(["to compute", "pieces", "processor time", "disk"], rows))
    say(f"{plan['kept']} of {plan['pieces']} pieces are kept in {plan['cache']}")
    say(
        f"estimate, of measured constants: {plan['estimated_minutes']} min on {cores} "
        f"core{'' if cores == 1 else 's'} that nobody else uses, {plan['estimated_disk_mb']} MB"
    )
