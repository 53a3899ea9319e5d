"""What a round robin was made of: versions, settings, files and their checksums."""

from __future__ import annotations

import platform
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from clerestory._core import __version__

if TYPE_CHECKING:
    from clerestory.roundrobin.study import RoundRobin

_LIBRARIES = ("numpy", "scipy", "matplotlib", "pvlib")


def provenance(study: RoundRobin) -> dict[str, Any]:
    """Versions, settings and files."""
    recipe = study.recipe
    settings: dict[str, str] = {
        "analyses": ", ".join(recipe.analyses) or "inventory alone",
        "treatments": ", ".join(recipe.treatments),
        "incident patches of Klems full": ", ".join(map(str, recipe.patches)),
        "seeds": ", ".join(map(str, recipe.seeds)),
    }
    if "moments" in recipe.analyses:
        own = recipe.moments
        settings["points in time"] = (
            f"room {own.room}, view {own.view}, {', '.join(own.times)}; renderings of {own.size_px} × {own.size_px} "
            f"pixels, {own.samples} paths each; glare by evalglare 3.06's defaults"
        )
    if "year" in recipe.analyses:
        year = recipe.year
        months = "all months" if len(year.months) == 12 else f"months {', '.join(map(str, year.months))}"
        settings["year"] = (
            f"room {year.room}, view {year.view}, sensors {year.sensors}, weather {year.weather or 'synthetic'}, "
            f"{months}; five phases, sky in reinhart:4 patches, {year.paths} paths a sensor"
        )
    files = [
        {"system": s.name, "laboratory": lab.name, "file": source.path.name, "sha256": source.sha256}
        for s in study.systems
        for lab in s.laboratories
        for source in lab.sources
    ]
    versions = {"clerestory": __version__, "python": platform.python_version()}
    return {
        "versions": versions | {name: version(name) for name in _LIBRARIES},
        "settings": settings,
        "files": files,
        "recipe": recipe.model_dump(mode="json"),
    }
