"""Checks of a data set: what a person should know before using a file from a stranger.

Each check is a function that looks at the tables of one band and yields findings. Thresholds are constants beside them,
after IEA SHC Task 61 report C.2.2 (2021) and what files of the wild were seen to hold.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory._core import ClerestoryError
from clerestory.check.conventions import copies, halves, placeholders, symmetry, transposed, units
from clerestory.check.physics import empty, energy, negative, outliers, reciprocity, thermal
from clerestory.check.purpose import PURPOSES, Purpose
from clerestory.check.purpose import purpose as serves
from clerestory.check.tables import tables
from clerestory.finding import SEVERITIES, Finding, Severity
from clerestory.words import band_name

if TYPE_CHECKING:
    from clerestory.bsdf import Bsdf

__all__ = ["PURPOSES", "SEVERITIES", "Finding", "Purpose", "Severity", "check"]

_CHECKS = (energy, units, transposed, reciprocity, negative, empty, outliers, halves, copies, placeholders)


def check(bsdf: Bsdf, *, purpose: Purpose | None = None, band: str | None = None) -> list[Finding]:
    """Look for what is wrong or suspicious.

    Parameters
    ----------
    purpose
        Say also whether the resolution serves `illuminance`, `glare` or `ase` (hours of direct sun).
    band
        Check this band only; all by default.

    Returns
    -------
    Findings, errors first.

    Notes
    -----
    Tensor trees and other models than matrices are checked on their mean over Klems full patches.
    """
    findings = [Finding("warning", "file", "", text, "") for text in bsdf.warnings]
    findings += thermal(bsdf.metadata)
    sample = " ".join(filter(None, (bsdf.metadata.name, bsdf.metadata.product_name, bsdf.metadata.device_type)))
    for name in bsdf.bands if band is None else (band_name(bsdf, band),):
        if name.startswith("cie-"):
            continue  # weights of a colour, which are not transmittances
        found = tables(bsdf, name)
        if found:
            findings += [finding for one in _CHECKS for finding in one(found)]
            if name == band_name(bsdf, band):
                findings += symmetry(found, sample)
    if purpose is not None:
        if purpose not in PURPOSES:
            raise ClerestoryError(f"purpose {purpose!r} is not known (give {', '.join(PURPOSES)})")
        findings += serves(bsdf, band_name(bsdf, band), purpose)
    return sorted(findings, key=lambda finding: SEVERITIES.index(finding.severity))
