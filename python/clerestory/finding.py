"""What a check says: how bad, what, where, and what to do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from clerestory.counts import counted

if TYPE_CHECKING:
    from collections.abc import Iterable

Severity = Literal["error", "warning", "note"]
SEVERITIES: tuple[Severity, Severity, Severity] = ("error", "warning", "note")


@dataclass(frozen=True)
class Finding:
    """One thing that a person should know before using data."""

    severity: Severity
    """error: do not use it so; warning: find out first; note: good to know."""
    check: str
    """Which check it comes from, in one word."""
    where: str
    """Band, side, scatter and incident direction, or hours, in words; empty for all of the data."""
    what: str
    """What is wrong, with its figures."""
    remedy: str
    """What to do."""

    def __str__(self) -> str:
        place = f"{self.where}: " if self.where else ""
        return f"{self.severity}: {place}{self.what}" + (f" ({self.remedy})" if self.remedy else "")


def tally(findings: Iterable[Finding]) -> str:
    """How many of each severity there are: `1 error, 2 notes`, or `nothing found`."""
    severities = [finding.severity for finding in findings]
    counts = [(severities.count(severity), severity) for severity in SEVERITIES]
    return ", ".join(counted(count, severity) for count, severity in counts if count) or "nothing found"
