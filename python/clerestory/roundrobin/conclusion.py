"""The result of a round robin in words, made of its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.compare.summary import listed, percent
from clerestory.counts import counted
from clerestory.plot.style import figures

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.roundrobin.measures import Kind, Measure
    from clerestory.roundrobin.run import Found

_KINDS: tuple[tuple[Kind, str], ...] = (("illuminance", "Illuminance"), ("glare", "Glare"))


def in_unit(value: float | None, unit: str) -> str:
    """A value as it is shown."""
    if value is None:
        return "–"
    if unit == "%":
        return percent(value).replace("-", "−")
    text = figures(value).replace("-", "−")
    return f"{text} {unit}" if unit else text


def sentences(found: Found) -> list[str]:
    """What a busy reader has to know of a system."""
    said = found.system.said
    made = []
    if found.transmittance is not None:
        made.append(said(str(found.transmittance.numbers["summary"][0])))
    judged = [m for m in found.measures if m.is_judged and m.kind != "transmittance" and m.variance.total > 0.0]
    for kind, words in _KINDS:
        own = [m for m in judged if m.kind == kind]
        if own:
            made.append(said(f"{words}: {_weighed(own)}"))
    return made


def _weighed(measures: Sequence[Measure]) -> str:
    """Which of laboratory and method matters more in measures of one kind."""
    more = [m for m in measures if _ratio(m) > 1.0]
    count = counted(len(measures), "measure")
    widest = max(measures, key=lambda m: abs(np.log(max(_ratio(m), 1e-9))))
    if len(more) == len(measures):
        head = f"in all {count} the method moves the result more than the laboratory does"
    elif not more:
        head = f"in all {count} the laboratory moves the result more than the method does"
    else:
        head = f"in {len(more)} of {count} the method moves the result more than the laboratory does"
    shares = [[100.0 * (m.variance.source(name).share or 0.0) for m in measures] for name in ("method", "laboratory")]
    v = widest.variance
    return (
        f"{head} (median share of the variance: method {np.median(shares[0]):.0f} %, laboratory "
        f"{np.median(shares[1]):.0f} %). Most clearly in {widest.words}: standard deviation "
        f"{in_unit(v.method_spread, widest.unit)} between methods, {in_unit(v.laboratory_spread, widest.unit)} between "
        f"laboratories."
    )


def _ratio(measure: Measure) -> float:
    """Spread of the methods over that of the laboratories."""
    method, laboratory = measure.variance.method_spread or 0.0, measure.variance.laboratory_spread or 0.0
    if laboratory == 0.0:
        return float("inf") if method > 0.0 else 1.0
    return method / laboratory


def warnings(found: Found) -> list[str]:
    """What has to be known before the numbers of a system are used."""
    said = found.system.said
    made = []
    if found.transmittance is not None:
        made += [said(f"{note[0].upper()}{note[1:]}.") for note in found.transmittance.numbers["notes"]]
    for why in dict.fromkeys(found.coarse.values()):
        cases = listed([str(case).replace(", ", " as ") for case, text in found.coarse.items() if text == why])
        made.append(said(f"Glare and direct sun of {cases}: {why}. These values are marked."))
    unconnected = [m.words for m in found.measures if m.kind != "transmittance" and not m.variance.connected]
    if unconnected:
        made.append(
            said(
                f"No method joins all laboratories, so that laboratory and method cannot be told apart in "
                f"{counted(len(unconnected), 'measure')}."
            )
        )
    if found.system.pane is not None:
        made.append(
            said(
                "Behind the pane layers are put together on Klems' patches, so that there is no high resolution. "
                "Transmittances are those of the data sets alone."
            )
        )
    return made
