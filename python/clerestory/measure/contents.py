"""What a measurement's file holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from clerestory.measure.scan import Measurement
    from clerestory.measure.sphere import SphereValues


@dataclass(frozen=True)
class Contents:
    """Scans by sample, and values of integrating spheres."""

    measurements: tuple[Measurement, ...] = ()
    sphere_values: tuple[SphereValues, ...] = ()
    warnings: tuple[str, ...] = ()
    """What was odd but understood, each with its file's name."""

    @classmethod
    def together(cls, parts: Iterable[Contents]) -> Contents:
        """One for many files: scans of the same sample become one measurement, in the order of the files."""
        from clerestory.measure.scan import Measurement

        kept = list(parts)
        samples: dict[str, list[Measurement]] = {}
        for part in kept:
            for measurement in part.measurements:
                samples.setdefault(measurement.sample, []).append(measurement)
        return cls(
            tuple(
                Measurement(
                    name,
                    tuple(scan for member in members for scan in member.scans),
                    tuple(dict.fromkeys(text for member in members for text in member.warnings)),
                )
                for name, members in samples.items()
            ),
            tuple(values for part in kept for values in part.sphere_values),
            tuple(dict.fromkeys(text for part in kept for text in part.warnings)),
        )
