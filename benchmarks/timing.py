"""Timing of two programs side by side, and of what a run was made with."""

from __future__ import annotations

import os
import platform
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

REPETITIONS = 7


@dataclass(frozen=True)
class Pair:
    """Times of the same job by both [s]."""

    ours: list[float]
    theirs: list[float]

    @property
    def ratio(self) -> float:
        """Their median time over ours."""
        return statistics.median(self.theirs) / statistics.median(self.ours)

    @property
    def spread(self) -> tuple[float, float]:
        """Smallest and largest ratio of runs that followed each other."""
        ratios = [theirs / ours for ours, theirs in zip(self.ours, self.theirs, strict=True)]
        return min(ratios), max(ratios)


def seconds(job: Callable[[], object]) -> float:
    """Time that a job takes [s]."""
    start = time.perf_counter()
    job()
    return time.perf_counter() - start


def alternate(ours: Callable[[int], object], theirs: Callable[[int], object], repetitions: int = REPETITIONS) -> Pair:
    """Runs both in turn, after one run of each that does not count. They are given the number of the run."""
    ours(repetitions)
    theirs(repetitions)
    times: tuple[list[float], list[float]] = ([], [])
    for k in range(repetitions):
        times[0].append(seconds(lambda k=k: ours(k)))
        times[1].append(seconds(lambda k=k: theirs(k)))
    return Pair(*times)


def machine() -> str:
    """Processor, number of processors and versions."""
    cpu = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line.split(":", 1)[1].strip() for line in info.read_text().splitlines() if "model name" in line]
        cpu = names[0] if names else cpu
    return (
        f"{cpu}, {os.cpu_count()} processors, {platform.system()}, Python {platform.python_version()}, "
        f"clerestory {version('clerestory')}, pyradiance {version('pyradiance')}"
    )


def table(head: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def row(name: str, pair: Pair, unit: float = 1e3, digits: int = 2) -> list[str]:
    """Name, both medians (in 1/unit seconds), ratio and its spread."""
    low, high = pair.spread
    return [
        name,
        f"{statistics.median(pair.ours) * unit:.{digits}f}",
        f"{statistics.median(pair.theirs) * unit:.{digits}f}",
        f"**{pair.ratio:.1f}**",
        f"{low:.1f} to {high:.1f}",
    ]
