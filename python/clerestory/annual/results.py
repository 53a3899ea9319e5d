"""What a study found: a summary, labelled arrays, tables and pictures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory.annual import dataset, en17037, lm83
from clerestory.annual.frequencies import DGI_CLASSES, DGP_CLASSES, class_shares

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from clerestory.annual.study import Outcome, Study
    from clerestory.plot.floor_plan import Plan
    from clerestory.room import Room


_PLAN = 4
"""Points that a floor plan needs."""


def summary(study: Study, outcomes: Sequence[Outcome]) -> list[dict[str, Any]]:
    """One record a data set: metrics of the room and of each view, over the hours that count."""
    weights = study.hours.weights(study.weather)
    return [_of(study, outcome, weights) for outcome in outcomes]


def _of(study: Study, outcome: Outcome, weights: NDArray[np.float64]) -> dict[str, Any]:
    sensors = {}
    limit = study.recipe.threshold_lx
    for name, metrics in outcome.metrics.items():
        sensors[name] = {
            "daylight_autonomy": float(metrics.autonomy_at(limit).mean()),
            "continuous_daylight_autonomy": float(metrics.continuous_autonomy_at(limit).mean()),
            "mean_illuminance_lx": float(metrics.mean.mean()),
            "sDA300_50": lm83.spatial_autonomy(metrics.autonomy_at(300.0)),
            "ASE1000_250": lm83.sunlight_exposure(outcome.direct_hours[study.places[name]]),
        }
    views = {}
    for view, values in outcome.eyes.items():
        # Where it is dark there is no glare, and the hour counts.
        dgp, dgi = (np.nan_to_num(values[name])[:, None] for name in ("dgp", "dgi"))
        reached = float(en17037.exceeded(dgp, weights)[0])
        views[view] = {
            "mean_vertical_illuminance_lx": float(np.average(values["illuminance"], weights=weights)),
            "dgp_exceeded_5": reached,
            "en17037_glare": en17037.glare_level(reached),
            "dgp_classes": dict(zip(DGP_CLASSES.names, class_shares(dgp, weights, DGP_CLASSES)[:, 0], strict=True)),
            "dgi_classes": dict(zip(DGI_CLASSES.names, class_shares(dgi, weights, DGI_CLASSES)[:, 0], strict=True)),
        }
    return {"data_set": outcome.name, "sensors": sensors, "views": views}


def write(study: Study, outcomes: Sequence[Outcome], folder: Path) -> list[Path]:
    """Write `results.nc`, tables and pictures into a folder; their paths."""
    from clerestory.plot import style

    folder.mkdir(parents=True, exist_ok=True)
    made: list[Path] = []
    names = [outcome.name for outcome in outcomes]
    variables: dict[str, tuple[tuple[str, ...], Any]] = {}
    coords: dict[str, Any] = {"data_set": names}
    if len(study.points):
        coords |= {axis: ("point", study.points[:, k]) for k, axis in enumerate("xyz")}
    for variable, key in (("eye_illuminance", "illuminance"), ("dgp", "dgp"), ("dgi", "dgi")):
        if study.views:
            series = [[o.eyes[view][key] for view in study.views] for o in outcomes]
            variables[variable] = (("data_set", "view", "time"), np.array(series))
            coords["view"] = study.views
    path = folder / "results.nc"
    made_by_time = dataset.by_time(study.weather, variables, **coords)
    if len(study.points):
        dims = ("data_set", "time", "point")
        dataset.save_filled(made_by_time, path, "illuminance", dims, _illuminances(study, names))
    else:
        dataset.save(made_by_time, path)
    made.append(path)
    for outcome in outcomes:
        for name, metrics in outcome.metrics.items():
            place = study.places[name]
            path = folder / f"{_slug(name)}-{_slug(outcome.name)}.csv"
            in_sun = outcome.direct_hours[place]
            table = dataset.of_points(metrics, study.points[place], study.hours.words, hours_in_sun=in_sun)
            dataset.save(table, path)
            made.append(path)
    for name, figure in _figures(study, outcomes):
        path = folder / f"{name}.png"
        style.save(figure, path)
        made.append(path)
    return made


def _illuminances(study: Study, names: Sequence[str]) -> Iterator[tuple[tuple[int, slice, slice], NDArray[np.float32]]]:
    """Of all data sets, steps and points, with their places."""
    for block, name, part in study.parts():
        if not block.views:
            yield (names.index(name), part.steps, block.points), part.illuminance


def _figures(study: Study, outcomes: Sequence[Outcome]) -> list[tuple[str, Any]]:
    from clerestory.plot.carpet import carpets
    from clerestory.plot.class_bars import class_bars
    from clerestory.plot.floor_plan import floor_plan

    made: list[tuple[str, Any]] = []
    limit = study.recipe.threshold_lx
    plan = plan_of(study.room)
    for name, place in study.places.items():
        if place.stop - place.start < _PLAN:
            continue
        shares = {o.name: o.metrics[name].autonomy_at(limit) for o in outcomes}
        label = f"daylight autonomy, {limit:g} lx"
        made.append(
            (f"autonomy-{_slug(name)}", floor_plan(study.points[place], shares, label=label, percent=True, plan=plan))
        )
    weights = study.hours.weights(study.weather)
    step = float(np.median(study.weather.interval))
    for view in study.views:
        series = {o.name: o.eyes[view]["illuminance"] for o in outcomes}
        made.append((f"eye-illuminance-{_slug(view)}", carpets(series, study.weather.times, step, label="E_v [lx]")))
        for classes, key in ((DGP_CLASSES, "dgp"), (DGI_CLASSES, "dgi")):
            found = {
                o.name: class_shares(np.nan_to_num(o.eyes[view][key])[:, None], weights, classes)[:, 0]
                for o in outcomes
            }
            title = f"{classes.index} at {view}, {study.hours.words}"
            bars = class_bars(found, classes.names, ranges=classes.ranges, title=title)
            made.append((f"{key}-{_slug(view)}", bars))
    return made


def plan_of(room: Room) -> Plan:
    """A room with its windows, seen from above."""
    from clerestory.plot.floor_plan import Plan, rectangle

    box = room.recipe.room
    windows = tuple(_ends(window.corners[:, :2]) for window in room.windows)
    return Plan(None if box is None else rectangle(box.width_m, box.depth_m), windows)


def _ends(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of an upright polygon seen from above (2, 2)."""
    far = corners[np.argmax(np.linalg.norm(corners - corners[0], axis=1))]
    return np.stack([corners[np.argmax(np.linalg.norm(corners - far, axis=1))], far])


def _slug(name: str) -> str:
    return "".join(c if c.isalnum() else "-" for c in name).strip("-") or "unnamed"
