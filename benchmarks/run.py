"""Runs every benchmark and the comparisons with Radiance, and writes docs/validation.md."""

from __future__ import annotations

import argparse
import os
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests")]

import agreement  # noqa: E402
import conversion  # noqa: E402
import glare  # noqa: E402
import glare_year  # noqa: E402
import goniophotometer  # noqa: E402
import loading  # noqa: E402
import lookups  # noqa: E402
import measure_fit  # noqa: E402
import measure_import  # noqa: E402
import rays  # noqa: E402
import rooms  # noqa: E402
import round_robin  # noqa: E402
import shading  # noqa: E402
import systems  # noqa: E402
import treatments  # noqa: E402
import year_chain  # noqa: E402
import year_growth  # noqa: E402
import year_matrices  # noqa: E402
import years  # noqa: E402
from samples import sample_root  # noqa: E402
from timing import machine  # noqa: E402

CHAPTERS = {
    "BSDF files": {
        "agreement": agreement.report,
        "loading": loading.report,
        "conversion": conversion.report,
        "lookups": lookups.report,
    },
    "Virtual goniophotometer": {
        "goniophotometer": goniophotometer.report,
        "rays": rays.report,
        "shading": shading.report,
        "round-robin": round_robin.report,
    },
    "Measurements": {
        "measure-import": measure_import.report,
        "measure-fit": measure_fit.report,
    },
    "Window systems": {
        "systems": systems.report,
    },
    "Rooms": {
        "rooms": rooms.report,
        "treatments": treatments.report,
    },
    "Glare": {
        "glare": glare.report,
    },
    "Years": {
        "years": years.report,
        "years-matrix": year_matrices.view,
        "years-product": year_matrices.product,
        "years-chain": year_chain.report,
        "years-growth": year_growth.report,
        "glare-year": glare_year.report,
    },
}
JOBS = {name: job for jobs in CHAPTERS.values() for name, job in jobs.items()}


PAGE = ROOT / "docs" / "validation.md"
INTRODUCTION = """# Validation

Written by `make bench`; no figure is typed by hand. Ratios are medians of runs in turn on one machine; a ratio above 1
means that Clerestory is faster. Each section says what it was made on.
"""


def _sections() -> dict[str, str]:
    """What the page holds by now, by job."""
    if not PAGE.exists():
        return {}
    found = re.findall(r"<!-- (\S+) -->\n(.*?)\n<!-- end -->", PAGE.read_text(), flags=re.DOTALL)
    return dict(found)


def _write(sections: dict[str, str]) -> None:
    lines = [INTRODUCTION]
    for chapter, jobs in CHAPTERS.items():
        made = [f"<!-- {name} -->\n{sections[name]}\n<!-- end -->\n" for name in jobs if name in sections]
        lines += [f"## {chapter}", "", *made] if made else []
    PAGE.write_text("\n".join(lines).rstrip() + "\n")


def main() -> None:
    """Runs jobs and writes their sections of the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=JOBS, action="append", help="run this one; the other sections stay")
    names = parser.parse_args().only or list(JOBS)
    data = sample_root()
    if data is None:
        sys.exit("error: the sample data are not there (set CLERESTORY_DATA to their folder)")
    for name in names:
        print(f"{name} ...", file=sys.stderr, flush=True)
        text = JOBS[name](data).strip()
        _write({**_sections(), name: f"{text}\n\nMade on: {machine()}."})


if __name__ == "__main__":
    main()
    # Radiance's library crashes when its data are freed at the end of the process.
    sys.stdout.flush()
    os._exit(0)
