"""Checks in the database: what was found of scans and sphere values, with the day on which it was."""

from __future__ import annotations

import json
from dataclasses import asdict
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from clerestory import _core
from clerestory._core import ClerestoryError
from clerestory.finding import Finding
from clerestory.measure.database import blobs, tables
from clerestory.measure.database.records import StoredCheck
from clerestory.measure.database.reports import Reports
from clerestory.measure.source import digest

if TYPE_CHECKING:
    from collections.abc import Iterable

    from clerestory.measure.database.records import Origin


class Checks(Reports):
    """What checks found, as reports that go when something that was checked is removed."""

    def add_check(self, sample: str, findings: Iterable[Finding], origin: Origin) -> int:
        """Store what a check of a sample found; the number that it has, or that the same check has already.

        Parameters
        ----------
        sample
            Its name.
        findings
            What was found; there may be nothing.
        origin
            What was checked, see `origin`.

        Raises
        ------
        ClerestoryError
            There is no such sample, or something that was checked is not in the database.
        """
        if origin.unknown:
            raise ClerestoryError(
                f"{self.location}: {', '.join(origin.unknown)} that was checked is not in the database (import it)"
            )
        owner = self.sample(sample).id
        told = {
            "sample": sample,
            "clerestory": _core.__version__,
            "scans": sorted(origin.scans),
            "sphere_values": sorted(origin.sphere_values),
            "models": sorted(origin.parents),
            "findings": [asdict(finding) for finding in findings],
        }
        data = (json.dumps(told, indent=1, ensure_ascii=False) + "\n").encode()
        with self.transaction():
            mark = digest(data)
            for report in self.reports(sample=sample):
                if report.kind == "check" and report.sha256 == mark:
                    return report.id
            name = self.unused_report_name(f"check of {sample}")
            number = self._rows.insert(
                tables.reports,
                {
                    "name": name,
                    "file_name": f"{name.replace('/', '-')}.json",
                    "kind": "check",
                    "made": datetime.now(UTC),
                    "blob_id": blobs.keep(self._connection, data),
                },
            )
            for link, numbers in (
                (tables.report_samples, [owner]),
                (tables.report_models, origin.parents),
                (tables.report_scans, origin.scans),
                (tables.report_sphere_values, origin.sphere_values),
            ):
                self._link(number, link, numbers)
        return number

    def check(self, number: int) -> StoredCheck:
        """A check by the number of its report.

        Raises
        ------
        ClerestoryError
            There is no report of this number, or it is no check.
        """
        report = self.report(number)
        if report.kind != "check":
            raise ClerestoryError(f"{self.location}: {report.words} is no check (`clerestory measure list reports`)")
        told = json.loads(self.report_bytes(number))
        return StoredCheck(
            number,
            told["sample"],
            report.made,
            told["clerestory"],
            tuple(Finding(**finding) for finding in told["findings"]),
            tuple(told["scans"]),
            tuple(told["sphere_values"]),
            tuple(told["models"]),
        )

    def checks(
        self, *, model: int | None = None, sample: str | None = None, run: int | None = None
    ) -> list[StoredCheck]:
        """Checks of a sample, of prepared scans, or of what a run measured, the oldest first."""
        reports = self.reports(model=model, sample=sample, run=run)
        return [self.check(report.id) for report in reports if report.kind == "check"]
