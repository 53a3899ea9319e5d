"""`clerestory cache`: what is kept for reruns, and making it smaller."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any

import typer

from clerestory.cli.common import JsonOption, UsageError, print_json, say, table

_UNITS = {"": 1, "k": 10**3, "m": 10**6, "g": 10**9, "t": 10**12}


def cache(
    *,
    folder: Annotated[
        Path | None,
        typer.Option("--cache", metavar="FOLDER", help="Which one; $CLERESTORY_CACHE or the user's by default."),
    ] = None,
    prune_to: Annotated[
        str | None,
        typer.Option("--prune-to", metavar="SIZE", help="Remove what was not used for longest: 0, 500MB, 2GB, …"),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Say what the cache of studies and round robins holds, and make it smaller.

    Whatever is removed is computed again when it is needed. Nothing is removed while a study uses the cache.

    Example: clerestory cache --prune-to 2GB
    """
    import time

    from clerestory.annual.cache import default_folder
    from clerestory.annual.pruning import entries, prune

    place = default_folder() if folder is None else folder
    if folder is not None and not folder.is_dir():
        raise UsageError(f"--cache {folder}: there is no such folder (check it)")
    removed = [] if prune_to is None else prune(place, _bytes(prune_to))
    found, now = entries(place), time.time()
    kinds: dict[str, dict[str, Any]] = {}
    for entry in found:  # that which was used last first
        days = round((now - entry.used) / 86400.0, 2)
        kind = kinds.setdefault(entry.kind, {"entries": 0, "bytes": 0, "used_days_ago": [days, days]})
        kind["entries"] += 1
        kind["bytes"] += entry.size
        kind["used_days_ago"][1] = days
    if as_json:
        told = {"folder": place, "bytes": sum(entry.size for entry in found), "kinds": kinds}
        print_json({**told, "removed": len(removed), "removed_bytes": sum(entry.size for entry in removed)})
        return
    if kinds:
        rows = [
            [name, str(k["entries"]), _mb(k["bytes"]), *(f"{days:.0f} d ago" for days in k["used_days_ago"])]
            for name, k in sorted(kinds.items())
        ]
        say(table(["kind", "entries", "size", "last used", "and longest not"], rows))
    if prune_to is not None:
        freed = _mb(sum(entry.size for entry in removed))
        say(f"removed {len(removed)} of {len(removed) + len(found)} entries, {freed}")
    say(f"{place}: {_mb(sum(entry.size for entry in found))}")


def _mb(size: int) -> str:
    return f"{1e-6 * size:.1f} MB"


def _bytes(text: str) -> int:
    found = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([kmgt]?)b?\s*", text.lower())
    if found is None:
        raise UsageError(f"--prune-to {text}: not a size (give bytes, or such as 500MB or 2GB)")
    return int(float(found[1]) * _UNITS[found[2]])
