"""The chapters of a round robin's report: what is shown of a system, and the words for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory.plot.style import figures as digits
from clerestory.plot.style import render
from clerestory.report import Cell, Figure, Heading, Paragraph, Table
from clerestory.roundrobin import annual_chapter, conclusion, figures
from clerestory.roundrobin.recipe import TREATMENTS

if TYPE_CHECKING:
    from collections.abc import Sequence

    import matplotlib.figure

    from clerestory.report.document import Block
    from clerestory.roundrobin.measures import Measure
    from clerestory.roundrobin.moments import Rendered
    from clerestory.roundrobin.run import Found

DPI = 130
_COARSE = "Hatched or marked: the data are too coarse for glare and direct sun."
_MOMENTS = (("illuminance", "$E_v$ [lx]"), ("dgp", "DGP"), ("dgi", "DGI"))
_MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")
DGP_LIMITS = (0.35, 0.40, 0.45)


def of_system(found: Found) -> list[Block]:
    """All that is shown of a system."""
    blocks: list[Block] = [Heading(found.system.title), *_inventory(found)]
    if found.transmittance is not None:
        blocks += _transmittances(found)
    if found.moments:
        blocks += _moments(found)
    if found.years:
        blocks += annual_chapter.of_system(found)
    judged = [m for m in found.measures if m.is_judged]
    if judged:
        blocks += _variance(judged)
    return blocks


def main_figures(found: Found) -> list[Block]:
    """Those of a system that its first page shows."""
    judged = [m for m in found.measures if m.is_judged]
    if judged:
        return [
            _figure(
                figures.shares(judged),
                found.system.said(
                    "What the variance of each measure comes from, in per cent of it. If laboratories gave different "
                    "treatments, some of it counts for both."
                ),
                "Bars of the share of variance by source",
            )
        ]
    if found.transmittance is not None:
        return [_bars(found)]
    return []


def doubts_of_rooms(found: Found) -> list[str]:
    """What has to be known of the rooms and their weather."""
    made = []
    if found.years_of is not None and found.years_of.is_synthetic:
        made.append(
            "The year is synthetic: no weather file was given, so it has the variety of weather and not the climate of "
            "the place."
        )
    for of in (found.moments_of, found.years_of):
        room = None if of is None else of.base if of is found.moments_of else of.room  # type: ignore[union-attr]
        made += [] if room is None else [f"{room.name}: {text}" for text in room.warnings]
    return list(dict.fromkeys(made))


def _inventory(found: Found) -> list[Block]:
    """As tables 1 and 2 of the report."""
    rows = []
    for lab in found.system.laboratories:
        notes = [g.note or "raw measurement data" for g in lab.raw]
        notes += [s.given.note for s in lab.sources if s.given.note]
        rows.append(
            (
                Cell(lab.name),
                Cell("–" if lab.klems is None else f"✓ {lab.klems.path.name}"),
                Cell("–" if lab.high is None else f"✓ {lab.high.path.name} ({lab.high.model})"),
                Cell("; ".join(notes) or "–"),
                Cell(", ".join(dict.fromkeys(c.treatment for c in found.cases if c.laboratory == lab.name)) or "–"),
            )
        )
    caption = found.system.said(
        "What each laboratory gave, and the treatments that it is used in. A Klems matrix is made "
        "of high-resolution data where a laboratory gave no other."
    )
    heads = ("laboratory", "Klems", "high resolution", "other", "treatments")
    return [Heading("What was given", 3), Table(caption, heads, tuple(rows), 5)]


def _bars(found: Found) -> Figure:
    assert found.transmittance is not None
    return Figure(
        found.system.said("Hemispherical, direct-hemispherical and direct-direct transmittance of each file."),
        "Bars of transmittances by data set",
        found.transmittance.pictures["bars"],
    )


def _transmittances(found: Found) -> list[Block]:
    """As section 3.4 of the report."""
    own = found.transmittance
    assert own is not None
    quantities = own.quantities("hemispherical", "direct-hemispherical", "direct-direct")
    heads = ("data set", *(f"{q['symbol']}, {q['of'].split(' (')[0]}" for q in quantities))
    rows = []
    for k, label in enumerate(own.labels):
        values = [q["values"][k] for q in quantities]
        rows.append((Cell(label), *(Cell("–" if v is None else _bare_percent(v), v) for v in values)))
    for name, field in (("mean", "mean"), ("standard deviation", "standard_deviation")):
        spreads = [None if q["spread"] is None else q["spread"][field] for q in quantities]
        rows.append((Cell(name), *(Cell("–" if s is None else _bare_percent(s), s) for s in spreads)))
    caption = found.system.said(
        "Transmittances [%]. Incident light fills a Klems full patch; direct-direct is what leaves "
        "through the outgoing patch of the same number. Overcast: CIE sky before a vertical façade."
    )
    said = [Paragraph(str(s)) for s in own.numbers["summary"]]
    return [
        Heading("Transmittance", 3),
        *said,
        Table(caption, heads, tuple(rows)),
        _bars(found),
        Figure(
            found.system.said(
                "BSDF [1/sr] on one logarithmic scale, light along the centres of the incident "
                "patches; each data set at its own resolution. The cross is the continued direction."
            ),
            "Falsecolour hemispheres: a row a data set, a column an incident patch",
            own.pictures["hemispheres"],
        ),
        Figure(
            found.system.said("Cuts through the plane of scattering of the hemispheres."),
            "BSDF along the plane of scattering, a line a data set",
            own.pictures["slices"],
        ),
    ]


def _bare_percent(value: float) -> str:
    return conclusion.in_unit(value, "%").removesuffix(" %")


def _moments(found: Found) -> list[Block]:
    """As section 3.5 of the report."""
    room = found.moments_of
    assert room is not None
    said, times = found.system.said, room.recipe.times
    coarse = list(found.coarse)
    place = room.place
    blocks: list[Block] = [
        Heading("Points in time", 3),
        Paragraph(
            f"Room {room.base.name}, view {room.recipe.view}, at {place.latitude:g}° "
            f"{'N' if place.latitude >= 0 else 'S'}, {abs(place.longitude):g}° {'E' if place.longitude >= 0 else 'W'}, "
            f"under a sky of kind {room.base.recipe.sky.kind}, on a clock {_zone(float(place.timezone))}. Values are "
            "means over the seeds and are found without a picture, with the sun's image at its true size; renderings "
            "show where the light comes from."
        ),
    ]
    laboratories = [case.laboratory for case in found.cases]
    for treatment in TREATMENTS:
        cases = [case for case in found.cases if case.treatment == treatment]
        if not cases:
            continue
        pictures: dict[str, Rendered | None] = dict.fromkeys(laboratories)
        words = {}
        for case in cases:
            own = found.moment(case, room.first)
            pictures[case.laboratory] = room.picture(found.renderings[case])
            words[case.laboratory] = f"$E_v$ {digits(own.illuminance)} lx, DGP {own.dgp:.2f}, DGI {own.dgi:.1f}"
        blocks.append(
            _figure(
                figures.renderings(pictures, words),
                said(
                    f"{treatment}, {room.first}, sun {room.sun_altitude_deg(room.first):.1f}° high: rendering, "
                    "its luminance and the glare sources in it, on one scale. The first row is denoised."
                ),
                f"Renderings, luminance and glare sources of {treatment} by laboratory",
            )
        )
    first = [
        (words, {case: getattr(found.moment(case, room.first), key) for case in found.cases}) for key, words in _MOMENTS
    ]
    blocks.append(
        _figure(
            figures.bars(first, coarse, limits={"DGP": DGP_LIMITS, "DGI": (18.0, 24.0, 28.0)}),
            said(
                f"{room.first}: vertical illuminance, DGP and DGI by laboratory and treatment. Dashed: limits of the "
                f"classes. {_COARSE}"
            ),
            "Bars of vertical illuminance, DGP and DGI",
        )
    )
    if len(times) > 1:
        names = _days(times)
        series = {
            words: {case: {t: getattr(found.moment(case, t), key) for t in times} for case in found.cases}
            for key, words in _MOMENTS
        }
        blocks.append(
            _figure(
                figures.by_time(series, names, coarse),
                said(
                    "Vertical illuminance, DGP and DGI at all times. Open marks: the data are too coarse for glare "
                    "and direct sun."
                ),
                "Lines of vertical illuminance, DGP and DGI over the dates",
            )
        )
    rows = []
    for case in found.cases:
        for time in times:
            m, note = found.moment(case, time), found.coarse.get(case, "")
            rows.append(
                (
                    Cell(case.laboratory),
                    Cell(case.treatment),
                    Cell(time),
                    Cell(digits(m.illuminance, 4), m.illuminance),
                    Cell(f"{m.dgp:.3f}", m.dgp, note),
                    Cell(f"{m.dgi:.1f}", m.dgi, note),
                )
            )
    heads = ("laboratory", "treatment", "time", "E_v [lx]", "DGP", "DGI")
    blocks.append(Table(said(f"Values at all times, means over the seeds. {_COARSE}"), heads, tuple(rows), 3))
    return blocks


def _variance(measures: Sequence[Measure]) -> list[Block]:
    """Laboratories beside methods, for every measure."""
    spreads, tests = [], []
    for measure in measures:
        v = measure.variance
        numbers = (
            v.laboratory_spread,
            v.method_spread,
            measure.resolution_effect,
            measure.peaks_effect,
            v.repetition_spread,
        )
        cells = [Cell(conclusion.in_unit(n, measure.unit), n) for n in (v.mean, *numbers)]
        spreads.append((Cell(measure.words), *cells))
        for source in v.sources:
            if source.degrees:
                tests.append(
                    (
                        Cell(measure.words),
                        Cell(figures.SHARES[source.name][0]),
                        Cell(str(source.degrees), source.degrees),
                        Cell(f"{source.sum_of_squares:.3g}", source.sum_of_squares),
                        Cell("–" if source.share is None else f"{100.0 * source.share:.1f}", source.share),
                        Cell("–" if source.f is None else digits(source.f), source.f),
                        Cell(
                            "–" if source.p is None else "< 0.001" if source.p < 0.001 else f"{source.p:.3f}", source.p
                        ),
                    )
                )
    incomplete = any(not m.variance.complete for m in measures)
    how = (
        "Two-way analysis of variance, laboratory × method, seeds as repetitions; each effect beside the other (type "
        "II). F of laboratory and method is against what both do together, that against the seeds. Seeds are the same "
        "for all data sets, so that their part is not in the differences of laboratories and methods."
    )
    if incomplete:
        how += (
            " Not every laboratory has every method equally often: means are of an additive fit over the complete "
            "table, and the shares need not add up to 100 %; the rest cannot be told apart."
        )
    return [
        Heading("Laboratory or method", 3),
        Paragraph(how),
        Table(
            "Standard deviations between the means of laboratories, of methods (treatments), and between seeds; and "
            "mean differences by resolution (high − klems) and by peak extraction (with − without) of the same "
            "laboratory.",
            ("measure", "mean", "laboratories", "methods", "high − klems", "peaks − none", "seeds"),
            tuple(spreads),
        ),
        Table(
            "Analysis of variance: degrees of freedom, sums of squares, share of the total, F and p.",
            ("measure", "source", "degrees", "sum of squares", "share [%]", "F", "p"),
            tuple(tests),
            2,
        ),
    ]


def _figure(made: matplotlib.figure.Figure, caption: str, alt: str) -> Figure:
    return Figure(caption, alt, render(made, ".png", dpi=DPI))


def _days(times: Sequence[str]) -> dict[str, str]:
    """Days in words by time, with the clock where it is not the same for all."""
    parts = {time: time.replace("T", " ").split(" ") for time in times}
    several = len({clock for _, *clock_and in parts.values() for clock in clock_and}) > 1
    made = {}
    for time, (day, *clock) in parts.items():
        *_, month, number = day.split("-")
        made[time] = " ".join([str(int(number)), _MONTHS[int(month) - 1], *(clock if several else ())])
    return made


def _zone(hours: float) -> str:
    return f"of UTC{hours:+g} h".replace("-", "−") if hours else "of UTC"
