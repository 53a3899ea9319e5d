"""What a study found: a summary, labelled arrays, tables and pictures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory.annual import dataset, en17037, lm83
from clerestory.annual.control import schedule
from clerestory.annual.frequencies import DGI_CLASSES, DGP_CLASSES, class_shares
from clerestory.whole import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    import xarray
    from numpy.typing import NDArray

    from clerestory.annual.outcome import Outcome
    from clerestory.annual.study import Study
    from clerestory.plot.floor_plan import Plan
    from clerestory.room import Room


_PLAN = 4
"""Points that a floor plan needs."""


def summary(study: Study, outcomes: Sequence[Outcome]) -> list[dict[str, Any]]:
    """One record a data set: metrics of the room and of each view, over the hours that count."""
    weights = study.hours.weights(study.weather)
    return [_of(study, outcome, weights) for outcome in outcomes]


def _of(study: Study, outcome: Outcome, weights: NDArray[np.float64]) -> dict[str, Any]:
    sensors: dict[str, dict[str, Any]] = {}
    limit = study.recipe.threshold_lx
    for name, metrics in outcome.metrics.items():
        sensors[name] = {
            "daylight_autonomy": float(metrics.autonomy_at(limit).mean()),
            "continuous_daylight_autonomy": float(metrics.continuous_autonomy_at(limit).mean()),
            "mean_illuminance_lx": float(metrics.mean.mean()),
            **_by_lm83(study, outcome, name),
            **_provision(outcome, name),
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
    found: dict[str, Any] = {"data_set": outcome.name, "sensors": sensors, "views": views}
    if outcome.operated is not None:
        control = study.recipe.data_sets[outcome.name].control
        found["control"] = None if control is None else control.kind
        found["states"] = outcome.operated.shares(weights)
    return found


def _by_lm83(study: Study, outcome: Outcome, name: str) -> dict[str, Any]:
    """What LM-83 calls for over its own hours; None if the weather has none."""
    if name not in outcome.lm83:
        return {"sDA300_50": None, "sDA_rating": None, "sDA_blinds": None, "ASE1000_250": None}
    sda = lm83.spatial_autonomy(outcome.lm83[name].autonomy_at(lm83.AUTONOMY))
    return {
        "sDA300_50": sda,
        "sDA_rating": lm83.rating(sda),
        "sDA_blinds": blinds(study, outcome),
        "ASE1000_250": lm83.sunlight_exposure(outcome.direct_hours[study.places[name]]),
    }


def blinds(study: Study, outcome: Outcome) -> str:
    """Which blinds the spatial daylight autonomy has, in words."""
    if outcome.operated is None:
        return "without blinds"
    control = study.recipe.data_sets[outcome.name].control
    names = outcome.operated.names
    between = f"LM-83's, {names[0]} to {names[-1]}"
    return between if control is not None and control.kind == "lm-83" else f"{between}, by three phases"


def _provision(outcome: Outcome, name: str) -> dict[str, Any]:
    """Daylight provision by EN 17037; None if the weather has no daylight."""
    if name not in outcome.daylight:
        return {"en17037_provision": None, "en17037_areas": None}
    levels = en17037.provision(outcome.daylight[name])
    areas = {p.level: {"target": p.target_area, "minimum": p.minimum_area} for p in levels}
    return {"en17037_provision": en17037.provision_level(levels), "en17037_areas": areas}


def write_pictures(study: Study, steps: Sequence[int], folder: Path) -> list[Path]:
    """Write pictures of steps into a folder, of each view and data set; their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    made = []
    for data_set, view, step, picture in study.pictures(steps):
        when = study.weather.words(step).replace(" ", "-").replace(":", "")
        path = folder / f"{_slug(view)}-{_slug(data_set)}-{when}.hdr"
        picture.write(path)
        made.append(path)
    return made


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
    if study.stages:
        variables["state"] = (("data_set", "group", "time"), _state_names(study, outcomes))
        coords["group"] = study.groups
    path = folder / "results.nc"
    made_by_time = dataset.by_time(study.weather, variables, **coords)
    if len(study.points):
        dims = ("data_set", "time", "point")
        dataset.save_filled(made_by_time, path, "illuminance", dims, _illuminances(study, names))
    else:
        dataset.save(made_by_time, path)
    made.append(path)
    for outcome in outcomes:
        for name in outcome.metrics:
            path = folder / f"{_slug(name)}-{_slug(outcome.name)}.csv"
            dataset.save(_of_points(study, outcome, name), path)
            made.append(path)
        if outcome.operated is not None:
            path = folder / f"states-{_slug(outcome.name)}.csv"
            write_whole(path, schedule.text(study.weather, outcome.operated).encode())
            made.append(path)
    for name, figure in _figures(study, outcomes):
        path = folder / f"{name}.png"
        style.save(figure, path)
        made.append(path)
    return made


def _of_points(study: Study, outcome: Outcome, name: str) -> xarray.Dataset:
    """Metrics of some sensors by point, with those of the room."""
    place = study.places[name]
    in_sun = outcome.direct_hours[place]
    table = dataset.of_points(outcome.metrics[name], study.points[place], study.hours.words, hours_in_sun=in_sun)
    if name in outcome.daylight:
        table = dataset.add_provision(table, en17037.provision(outcome.daylight[name]))
    found = _by_lm83(study, outcome, name)
    keys = {"sda_300_50": "sDA300_50", "sda_rating": "sDA_rating", "sda_blinds": "sDA_blinds"}
    return table.assign_attrs({key: "unknown" if found[of] is None else found[of] for key, of in keys.items()})


def _state_names(study: Study, outcomes: Sequence[Outcome]) -> NDArray[np.object_]:
    """Names of the states (data sets, groups, steps); empty where a data set has none."""
    found = np.full((len(outcomes), len(study.groups), len(study.weather)), "", dtype=object)
    for k, outcome in enumerate(outcomes):
        if outcome.operated is not None:
            found[k] = np.array(outcome.operated.names, dtype=object)[outcome.operated.states]
    return found


def _illuminances(study: Study, names: Sequence[str]) -> Iterator[tuple[dataset.Place, NDArray[np.float32]]]:
    """Of all data sets, steps and points, with their places."""
    for block, name, part in study.parts():
        if not block.views:
            yield (names.index(name), part.steps, block.points), part.illuminance


def _figures(study: Study, outcomes: Sequence[Outcome]) -> list[tuple[str, Any]]:
    from clerestory.plot.carpet import carpets
    from clerestory.plot.class_bars import class_bars
    from clerestory.plot.floor_plan import floor_plan
    from clerestory.plot.state_carpet import state_carpets
    from clerestory.weather.figure import sun_hours

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
    sun = sun_hours(study.weather)
    for outcome in outcomes:
        if outcome.operated is not None:
            states = dict(zip(outcome.operated.groups, outcome.operated.states, strict=True))
            figure = state_carpets(
                states, outcome.operated.names, study.weather.times, step, sun=sun, title=outcome.name
            )
            made.append((f"states-{_slug(outcome.name)}", figure))
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
