"""Choices of a glare evaluation."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Literal

from clerestory import _core

PRESETS = ("evalglare-3.06", "evalglare-2.10", "evalglare-1.x")
ThresholdOf = Literal["absolute", "mean", "task"]
Background = Literal["without-sources", "mean", "illuminance"]
PositionIndex = Literal["guth-iwata", "kim"]
# Shares of the channels with a white of exactly 1/3, 1/3; evalglare's, as seen from runs.
_WEIGHTS = (0.265105814, 0.670105815, 0.064788356)


@dataclass(frozen=True)
class Settings:
    """Choices of a glare evaluation; the defaults are those of `evalglare` 3.06."""

    threshold: float = 2000.0
    """Pixels above it are sources: a luminance [cd/m²], or a factor."""
    threshold_of: ThresholdOf = "absolute"
    """What the threshold is a factor of: `mean` of the picture, or of the `task` area; or `absolute`."""
    task: tuple[float, float, float] | None = None
    """Task area: pixel from the left, pixel from the bottom, full opening angle [rad]."""
    search_radius: float = 0.2
    """Pixels not further apart than half of it [rad] are one source."""
    smoothing: bool = False
    """Pixels that a source surrounds belong to it."""
    peaks: float | None = 50000.0
    """Pixels above this luminance [cd/m²] become sources of their own; None for none."""
    background: Background = "without-sources"
    """(E_v − E_direct)/π, the mean outside of the sources, or E_v/π."""
    position_index: PositionIndex = "guth-iwata"
    """Guth's above the line of sight and Iwata's below, or Kim's."""
    low_light: bool = False
    """Lower the DGP where the illuminance at the eye is below 1000 lx."""
    age: float | None = None
    """Age [years] for the correction that old releases had."""
    vertical_illuminance: float | None = None
    """Measured illuminance at the eye [lx], for the DGP."""
    luminance_weights: tuple[float, float, float] = _WEIGHTS
    """Shares of red, green and blue in the luminance of a picture that names no primaries."""

    @classmethod
    def preset(cls, name: str) -> Settings:
        """The choices of a release of `evalglare`: 3.06, 2.10 or 1.x.

        They are certain for 3.06, which was run. For 2.10 they follow its manual page and change log, and that the
        low-light correction was on by default is what manuals say; releases 1.x took five times the mean luminance as
        threshold and the mean background.
        """
        parts = _core.glare_preset(name)
        parts["luminance_weights"] = tuple(parts["luminance_weights"])
        return cls(**parts)

    def words(self) -> str:
        """The choices in one line, for standing beside a result."""
        unit = {"absolute": "cd/m²", "mean": "× mean luminance", "task": "× task luminance"}[self.threshold_of]
        parts = [
            f"threshold {self.threshold:g} {unit}",
            f"search radius {self.search_radius:g} rad",
            f"peaks above {self.peaks:g} cd/m²" if self.peaks is not None else "no peaks",
            f"background {self.background}",
            f"position index {self.position_index}",
            f"low-light correction {'on' if self.low_light else 'off'}",
        ]
        if self.smoothing:
            parts.append("smoothing")
        if self.age is not None:
            parts.append(f"age {self.age:g}")
        if self.vertical_illuminance is not None:
            parts.append(f"measured E_v {self.vertical_illuminance:g} lx")
        return ", ".join(parts)

    def changed(self) -> dict[str, object]:
        """What differs from the defaults."""
        default = Settings()
        return {
            field.name: getattr(self, field.name)
            for field in fields(self)
            if getattr(self, field.name) != getattr(default, field.name)
        }
