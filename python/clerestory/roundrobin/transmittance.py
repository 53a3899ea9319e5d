"""Transmittances of what laboratories gave, side by side: the comparison of each system's files."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from clerestory.roundrobin.pieces import Piece, packed, value_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.annual.cache import Arrays
    from clerestory.roundrobin.pieces import Tell
    from clerestory.roundrobin.study import Source, System

CPU_S, CPU_S_A_PAIR = 1.0, 1.5
"""Measured: of a data set, and of a pair of them [s]."""
_DPI = 130


@dataclass(frozen=True)
class Transmittance:
    """The comparison of a system's files."""

    numbers: dict[str, Any]
    """As `Comparison.to_dict` has them."""
    pictures: dict[str, bytes]
    """PNG files: bars, hemispheres, slices."""

    @property
    def labels(self) -> list[str]:
        """Names of the files, which are those of `labelled`."""
        return [str(s["label"]) for s in self.numbers["sets"]]

    def quantities(self, *groups: str) -> list[dict[str, Any]]:
        """Figures of groups, in the order of the groups."""
        return [q for group in groups for q in self.numbers["quantities"] if q["group"] == group]


def labelled(system: System) -> dict[str, tuple[str, Source]]:
    """Laboratory and source of every file by its label: the laboratory's name, with the resolution if it gave two."""
    made: dict[str, tuple[str, Source]] = {}
    for laboratory in system.laboratories:
        several = len(laboratory.sources) > 1
        for source in laboratory.sources:
            label = f"{laboratory.name} ({source.resolution})" if several else laboratory.name
            made[label] = (laboratory.name, source)
    return made


def piece(system: System, patches: Sequence[int]) -> Piece:
    """The comparison of a system's files, without a pane."""
    sources = labelled(system)

    def compute(tell: Tell) -> Arrays:
        from clerestory.compare import compare
        from clerestory.compare.report import bars
        from clerestory.plot import hemisphere_grid, render, slices

        found = compare(
            {label: source.bsdf for label, (_, source) in sources.items()},
            patches=patches,
            progress=lambda share: tell(0.6 * share),
        )
        settings = found.settings
        common = {"side": settings.side, "scatter": settings.scatter, "band": settings.band}
        figures = {
            "bars": bars(found),
            "hemispheres": hemisphere_grid(found.data, patches, samples=settings.samples, **common),  # type: ignore[arg-type]
            "slices": slices(found.data, patches, **common),  # type: ignore[arg-type]
        }
        return packed(found.to_dict(), **{name: render(figure, ".png", dpi=_DPI) for name, figure in figures.items()})

    key = {
        "files": [[label, source.mark, source.given.flipped] for label, (_, source) in sources.items()],
        "patches": list(patches),
    }
    count = len(sources)
    cpu_s = CPU_S * count + CPU_S_A_PAIR * count * (count - 1) / 2
    return Piece("comparison", key, f"{system.title}: transmittances", cpu_s, 0.6, compute)


def read(arrays: Arrays) -> Transmittance:
    """What a piece holds."""
    pictures = {name: data.tobytes() for name, data in arrays.items() if name != "value"}
    return Transmittance(value_of(arrays), pictures)
