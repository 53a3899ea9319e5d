"""The numbers of a round robin as JSON knows them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from clerestory.roundrobin import conclusion
from clerestory.roundrobin.provenance import provenance

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.roundrobin.measures import Measure
    from clerestory.roundrobin.run import Found
    from clerestory.roundrobin.study import RoundRobin


def results(study: RoundRobin, found: Sequence[Found]) -> dict[str, Any]:
    """Every number of the report."""
    return {
        "name": study.recipe.name,
        "conclusion": [sentence for one in found for sentence in conclusion.sentences(one)],
        "warnings": [text for one in found for text in conclusion.warnings(one)],
        "systems": {one.system.name: _system(one) for one in found},
        "provenance": provenance(study),
    }


def _system(found: Found) -> dict[str, Any]:
    made: dict[str, Any] = {
        "title": found.system.title,
        "inventory": [
            {
                "laboratory": lab.name,
                "klems": None if lab.klems is None else lab.klems.path.name,
                "high": None if lab.high is None else lab.high.path.name,
                "raw": [given.note for given in lab.raw],
                "treatments": [case.treatment for case in found.cases if case.laboratory == lab.name],
            }
            for lab in found.system.laboratories
        ],
    }
    if found.transmittance is not None:
        made["transmittance"] = found.transmittance.numbers
    if found.moments:
        made["moments"] = [
            {
                "laboratory": case.laboratory,
                "treatment": case.treatment,
                "time": time,
                "seed": seed,
                "vertical_illuminance_lx": moment.illuminance,
                "dgp": moment.dgp,
                "dgi": moment.dgi,
                "too_coarse": found.coarse.get(case),
            }
            for case, values in found.moments.items()
            for (time, seed), moment in values.items()
        ]
    if found.years:
        made["year"] = [
            {
                "laboratory": case.laboratory,
                "treatment": case.treatment,
                "seed": seed,
                **(own := found.annual(case, seed)).values,
                "dgp_classes": own.dgp_classes,
                "dgi_classes": own.dgi_classes,
                "too_coarse": found.coarse.get(case),
            }
            for case, years in found.years.items()
            for seed in years
        ]
    made["measures"] = [_measure(measure) for measure in found.measures]
    return made


def _measure(measure: Measure) -> dict[str, Any]:
    v = measure.variance
    return {
        "measure": measure.words,
        "key": measure.key,
        "unit": measure.unit,
        "mean": v.mean,
        "laboratory_means": v.laboratory_means,
        "method_means": v.method_means,
        "laboratory_spread": v.laboratory_spread,
        "method_spread": v.method_spread,
        "seed_spread": v.repetition_spread,
        "high_minus_klems": measure.resolution_effect,
        "peaks_minus_none": measure.peaks_effect,
        "total_sum_of_squares": v.total,
        "complete": v.complete,
        "sources": v.sources,
    }
