"""Pictures of a round robin: renderings side by side, values by laboratory and treatment, and what varies them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from clerestory.picture import tone_map
from clerestory.plot import style
from clerestory.roundrobin.recipe import TREATMENTS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from clerestory.glare import Evaluation
    from clerestory.picture import Picture
    from clerestory.roundrobin.measures import Measure
    from clerestory.roundrobin.moments import Rendered
    from clerestory.roundrobin.study import Case

LIMITS = (10.0, 30_000.0)
"""Ends of the colours of luminance [cd/m²], for all pictures of all reports."""
SHARES = {
    "laboratory": ("laboratory", "#0072b2", ""),
    "method": ("method", "#e69f00", ""),
    "interaction": ("both together", "#999999", "////"),
    "repetition": ("seed", "#222222", ""),
}
"""Words, colour and hatch of each source of variance."""
_RINGED = 0.01
"""Share of the illuminance at the eye from which on a small source is ringed."""
_UNDIVIDED = ("cannot be told apart", "#ffffff", "....")


@style.styled
def renderings(pictures: Mapping[str, Rendered | None], words: Mapping[str, str]) -> Figure:
    """A column a laboratory: the rendering, its luminance, and the glare sources in it; one scale for all.

    As figures 45 to 48 and 55 to 58 of the report of IEA SHC Task 61 (2021, C.2.2).

    Parameters
    ----------
    pictures
        Of one treatment, by laboratory; None where it gave nothing for it.
    words
        What stands under each.
    """
    count = len(pictures)
    white = float(np.median([np.percentile(p.picture.luminance, 99.0) for p in pictures.values() if p is not None]))
    width = max(2.15 * count, 4.3)
    figure = style.new_figure(width + 0.9, 6.9)
    axes = figure.subplots(3, count, squeeze=False)
    norm = style.norm(np.array(LIMITS), "log", LIMITS)
    for column, (name, given) in enumerate(pictures.items()):
        tall = axes[:, column]
        for ax in tall:
            ax.set_xticks([])
            ax.set_yticks([])
            ax.set_aspect("equal")
            for spine in ax.spines.values():
                spine.set_visible(False)
        tall[0].set_title(name, fontweight="bold")
        if given is None:
            for ax in tall:
                ax.text(0.5, 0.5, "not given", ha="center", va="center", color="#777777", transform=ax.transAxes)
            continue
        picture = given.picture
        inside = _disk(picture)
        tall[0].imshow(np.where(inside, tone_map(given.denoised, white=white), 1.0), interpolation="nearest")
        luminance = np.where(inside[..., 0], picture.luminance, np.nan)
        tall[1].imshow(luminance, norm=norm, cmap=style.colours(), interpolation="nearest")
        tall[2].imshow(np.where(inside, _sources(picture, given.glare), 1.0), interpolation="nearest")
        tall[2].set_xlabel(words[name], fontsize=8)
    for ax, text in zip(axes[:, 0], ("rendering", "luminance", "glare sources"), strict=True):
        ax.set_ylabel(text)
    bar = figure.colorbar(style.mappable(norm), ax=axes[1, :].tolist(), extend="both", pad=0.02, shrink=0.9)
    bar.set_label("luminance [cd/m²]")
    return figure


def _disk(picture: Picture) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Pixels (height, width, 1) within the projection."""
    height, width = picture.shape
    assert picture.view is not None
    inside: np.ndarray[tuple[int, ...], np.dtype[np.bool_]] = picture.view.solid_angles(width, height) > 0.0
    return inside.reshape(height, width, 1)


def _sources(picture: Picture, found: Evaluation) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """The picture in grey with its sources in orange, of which small ones that matter are ringed."""
    grey = tone_map(picture) @ np.array([0.2126, 0.7152, 0.0722])
    shown = np.repeat(0.75 * grey[..., None], 3, axis=2)
    labels = found.labels
    if labels is None:
        return shown
    height, width = labels.shape
    down, across = np.mgrid[:height, :width]
    orange = np.array([0.902, 0.624, 0.0])
    shown[labels > 0] = orange
    for number, source in enumerate(found.sources, 1):
        if source.pixels < height * width / 500 and source.illuminance > _RINGED * found.vertical_illuminance:
            row, column = np.argwhere(labels == number).mean(axis=0)
            distance = np.hypot(down - row, across - column)
            ring = (distance > 0.035 * width) & (distance < 0.047 * width)
            shown[ring] = orange
    return shown


@style.styled
def bars(
    values: Sequence[tuple[str, Mapping[Case, float]]],
    coarse: Sequence[Case] = (),
    *,
    limits: Mapping[str, Sequence[float]] | None = None,
) -> Figure:
    """A picture a quantity: groups of bars by laboratory, a bar a treatment; hatched where the data are too coarse.

    Parameters
    ----------
    values
        Words of each quantity, and its values by case.
    coarse
        Cases that are hatched.
    limits
        Dashed lines, by the words of a quantity.
    """
    figure = style.new_figure(min(5.0 * len(values), 10.0), 3.6)
    axes = figure.subplots(1, len(values), squeeze=False)[0]
    for ax, (words, own) in zip(axes, values, strict=True):
        laboratories = list(dict.fromkeys(case.laboratory for case in own))
        treatments = [t for t in TREATMENTS if any(case.treatment == t for case in own)]
        wide = 0.84 / len(treatments)
        for case, value in own.items():
            k = treatments.index(case.treatment)
            x = laboratories.index(case.laboratory) + (k - 0.5 * (len(treatments) - 1)) * wide
            ax.bar(
                x,
                value,
                0.94 * wide,
                color=style.COLOURS[k],
                hatch="////" if case in coarse else "",
                edgecolor="white",
                linewidth=0.0,
                label=case.treatment,
            )
            ax.text(
                x,
                value,
                f" {style.figures(value, 2 if value < 1.0 else 3)}",
                ha="center",
                va="bottom",
                fontsize=6.5,
                rotation=90,
            )
        for limit in (limits or {}).get(words, ()):
            ax.axhline(limit, color=style.INK, linewidth=0.7, linestyle=(0, (4, 3)), zorder=0)
        slanted = max(len(name) for name in laboratories) * len(laboratories) > 34
        ax.set_xticks(
            range(len(laboratories)), laboratories, rotation=20 if slanted else 0, ha="right" if slanted else "center"
        )
        ax.set_title(words, loc="left")
        ax.set_ylim(0.0, 1.22 * max(max(own.values()), 1e-9))
        _plain(ax)
    _legend(figure, axes[0])
    return figure


@style.styled
def by_time(
    values: Mapping[str, Mapping[Case, Mapping[str, float]]], names: Mapping[str, str], coarse: Sequence[Case] = ()
) -> Figure:
    """A row a quantity, a column a treatment, a line a laboratory; one scale a row, dots open where too coarse.

    As figures 49 to 52 and 59 to 62 of the report of IEA SHC Task 61 (2021, C.2.2).

    Parameters
    ----------
    values
        By words of the quantity, case and time.
    names
        Of the times, by time.
    coarse
        Cases whose data are too coarse.
    """
    cases = next(iter(values.values()))
    treatments = [t for t in TREATMENTS if any(case.treatment == t for case in cases)]
    laboratories = list(dict.fromkeys(case.laboratory for case in cases))
    order = sorted(names)
    figure = style.new_figure(max(2.2 * len(treatments), 5.0) + 0.6, 1.9 * len(values) + 0.6)
    axes = figure.subplots(len(values), len(treatments), squeeze=False, sharey="row", sharex=True)
    for row, (words, own) in zip(axes, values.items(), strict=True):
        for ax, treatment in zip(row, treatments, strict=True):
            for case, series in own.items():
                if case.treatment != treatment:
                    continue
                k = laboratories.index(case.laboratory)
                face = "white" if case in coarse else style.COLOURS[k % len(style.COLOURS)]
                ax.plot(
                    [series[time] for time in order],
                    **style.line(k),
                    marker="osD^v<>"[k % 7],
                    markersize=3.5,
                    markerfacecolor=face,
                    label=case.laboratory,
                )
            ax.set_xticks(range(len(order)), [names[time] for time in order], rotation=90, fontsize=7)
            _plain(ax)
        row[0].set_ylabel(words)
        row[0].set_ylim(0.0, 1.05 * max(v for series in own.values() for v in series.values()))
    for ax, treatment in zip(axes[0], treatments, strict=True):
        ax.set_title(treatment, loc="left")
    _legend(figure, *axes[0])
    return figure


@style.styled
def shares(measures: Sequence[Measure]) -> Figure:
    """A bar a measure: what share of its variance comes from laboratories, methods, both together, and seeds.

    Shares of an incomplete design can add up to more than all of it: such a bar is shortened, its numbers are not.
    """
    figure = style.new_figure(8.4, 0.9 + 0.3 * len(measures))
    ax = figure.add_subplot()
    for row, measure in enumerate(reversed(measures)):
        foot = 0.0
        found = {name: 100.0 * (measure.variance.source(name).share or 0.0) for name in SHARES}  # type: ignore[arg-type]
        shortened = min(1.0, 100.0 / max(sum(found.values()), 1e-9))
        for name, (words, colour, hatch) in SHARES.items():
            share, width = found[name], shortened * found[name]
            ax.barh(row, width, 0.72, foot, color=colour, hatch=hatch, edgecolor="white", linewidth=0.4, label=words)
            if share >= 8.0:
                ink = "black" if name == "method" or name == "interaction" else "white"
                ax.text(
                    foot + 0.5 * width,
                    row,
                    f"{share:.0f}",
                    ha="center",
                    va="center",
                    fontsize=7.5,
                    color=ink,
                    bbox={"facecolor": colour, "edgecolor": "none", "pad": 0.6},
                )
            foot += width
        if foot < 99.5:
            words, colour, hatch = _UNDIVIDED
            rest = 100.0 - foot
            ax.barh(row, rest, 0.72, foot, color=colour, hatch=hatch, edgecolor="#888888", linewidth=0.4, label=words)
    ax.set_yticks(range(len(measures)), [_symbols(measure.words) for measure in reversed(measures)])
    ax.set_xlim(0.0, 100.0)
    ax.set_xlabel("share of the variance [%]")
    ax.tick_params(axis="y", length=0)
    for edge in ("top", "right", "left"):
        ax.spines[edge].set_visible(False)
    _legend(figure, ax)
    return figure


def _symbols(words: str) -> str:
    """With the subscripts of T_d-h and E_v lowered."""
    return re.sub(r"\b([TE])_([dh]-[dh]|v)\b", r"$\1_{\\mathrm{\2}}$", words)


def _plain(ax: Axes) -> None:
    ax.grid(axis="y")
    ax.set_axisbelow(True)
    for edge in ("top", "right"):
        ax.spines[edge].set_visible(False)


def _legend(figure: Figure, *axes: Axes) -> None:
    """One entry a label, in the order of the treatments or as they come."""
    found: dict[str, Artist] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    across, _ = style.columns(found, 0.95 * float(figure.get_figwidth()))
    figure.legend(list(found.values()), list(found), loc="outside lower center", ncols=across)
