"""Labelled results of a year, their files and their pictures."""

import csv
import re

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.annual import dataset, en17037
from clerestory.annual.frequencies import DGP_CLASSES
from clerestory.annual.metrics import point_metrics
from clerestory.plot import style
from clerestory.plot.carpet import carpets
from clerestory.plot.class_bars import class_bars
from clerestory.plot.floor_plan import Plan, cell, floor_plan, rectangle, spacing
from clerestory.plot.occurrence import occurrence
from clerestory.sky import Place
from clerestory.weather import Hours, synthetic_year
from clerestory.weather.figure import sun_hours
from samples import ROOT

xarray = pytest.importorskip("xarray")

X, Y = np.meshgrid([0.5, 1.5, 2.5], [0.5, 1.5, 2.5, 3.5])
POINTS = np.stack([X.ravel(), Y.ravel(), np.full(12, 0.76)], axis=-1)
RANDOM = np.random.default_rng(2)


@pytest.fixture(scope="module")
def weather():
    return synthetic_year(Place(37.7, -122.2, -8.0, "Town"), seed=1)


@pytest.fixture(scope="module")
def illuminance(weather):
    return weather.diffuse[:, None] * np.linspace(8, 0.5, 12)


@pytest.fixture(scope="module")
def results(weather, illuminance):
    hours = Hours()
    metrics = point_metrics(illuminance, hours.weights(weather))
    made = dataset.of_points(metrics, POINTS, hours.words, hours_in_sun=np.linspace(0, 500, 12), weather=weather.source)
    daylight = point_metrics(illuminance, Hours.all_daylight().weights(weather))
    return dataset.add_provision(made, en17037.provision(daylight))


@pytest.fixture(scope="module")
def series(weather, illuminance):
    views = illuminance[:, :2]
    return dataset.by_time(
        weather,
        {"eye_illuminance": (("time", "view"), views), "dgp": (("time", "view"), 0.2 + views / 1e5)},
        view=["desk", "door"],
    )


def test_results_have_units_and_the_whole_room(results):
    for name, values in results.data_vars.items():
        assert values.attrs["units"], name
        assert values.attrs["long_name"], name
    assert results.attrs["hours"] == "08:00 to 18:00"
    assert results.attrs["hours_counted"] == 3650
    assert results.attrs["ase_1000_250"] == 0.5
    above = results.daylight_autonomy.sel(threshold=300) >= 0.5
    assert results.attrs["sda_300_50"] == pytest.approx(float(above.mean()))
    assert results.attrs["en17037_provision"] in ("none", "minimum", "medium", "high")
    assert list(results.band.values) == ["fell-short", "supplementary", "autonomous", "exceeded"]
    assert results.z.values == pytest.approx(0.76)


@pytest.mark.parametrize("suffix", [".nc", ".zarr"])
@pytest.mark.parametrize("which", ["results", "series"])
def test_files_are_read_as_they_were_written(which, suffix, request, tmp_path):
    made = request.getfixturevalue(which)
    path = tmp_path / f"out{suffix}"
    if suffix == ".zarr":
        pytest.importorskip("zarr", reason="zarr writes Zarr")
    dataset.save(made, path)
    back = xarray.open_dataset(path, engine="h5netcdf" if suffix == ".nc" else "zarr")
    with back:
        xarray.testing.assert_identical(back.load(), made)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]  # nothing is left behind


def test_tables_are_for_spreadsheets(results, series, tmp_path):
    dataset.save(results, tmp_path / "points.csv")
    rows = list(csv.reader((tmp_path / "points.csv").read_text().splitlines()))
    head = [row[0] for row in rows if row[0].startswith("#")]
    assert "# sda_300_50: " in "\n".join(head)
    table = rows[len(head) :]
    assert table[0][:4] == ["point", "x", "y", "z"]
    assert "daylight_autonomy 500" in table[0]
    assert "useful_daylight_illuminance exceeded" in table[0]
    assert len(table) == 13
    column = table[0].index("daylight_autonomy 500")
    assert [float(row[column]) for row in table[1:]] == pytest.approx(
        results.daylight_autonomy.sel(threshold=500).values, rel=1e-6
    )
    text = dataset.to_csv(series)
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    assert lines[0] == "time,interval,eye_illuminance desk,eye_illuminance door,dgp desk,dgp door"
    assert lines[1].startswith("2001-01-01 00:30:00,1,0,0,0.2,0.2")
    assert len(lines) == 8761


def test_what_cannot_be_written_is_said(results, tmp_path):
    with pytest.raises(ClerestoryError, match=r"ends in \.txt"):
        dataset.save(results, tmp_path / "out.txt")
    pytest.importorskip("zarr", reason="zarr writes Zarr")
    (tmp_path / "out.zarr").mkdir()
    with pytest.raises(ClerestoryError, match="is there already"):
        dataset.save(results, tmp_path / "out.zarr")


def test_names_and_shapes_are_checked(weather):
    with pytest.raises(ClerestoryError, match="variable 'glare' is not known"):
        dataset.by_time(weather, {"glare": (("time",), np.zeros(8760))})
    metrics = point_metrics([[1.0, 2.0]], [1])
    with pytest.raises(ClerestoryError, match=r"points \(12, 3\) do not go with 2"):
        dataset.of_points(metrics, POINTS, "all")


def pixels(figure):
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())


def test_floor_plans_have_one_scale(results):
    shares = results.daylight_autonomy.sel(threshold=500).values
    plan = Plan(rectangle(3, 4), (np.array([[0.5, 0.0], [2.5, 0.0]]),))
    figure = floor_plan(
        POINTS, {"A": shares, "B": 0.5 * shares}, label="autonomy", plan=plan, percent=True, numbers=True
    )
    images = [ax.images[0] for ax in figure.axes if ax.images]
    assert len(images) == 2
    assert images[0].norm is images[1].norm
    assert (images[0].norm.vmin, images[0].norm.vmax) == (0, 100)
    # The middle of a point's cell has its value; a corner of the room is coloured, too.
    shown = images[0].get_array()
    extent = images[0].get_extent()
    column = int((0.5 - extent[0]) / (extent[1] - extent[0]) * shown.shape[1])
    row = int((0.5 - extent[2]) / (extent[3] - extent[2]) * shown.shape[0])
    assert shown[row, column] == pytest.approx(100 * shares[0])
    assert figure.axes[0].get_title(loc="left").startswith("A, mean")
    assert pixels(figure).std() > 20
    assert cell(POINTS[:, :2]) == (1.0, 1.0)
    assert cell(POINTS[:-1, :2] * [1.0, 0.5]) == (1.0, 0.5)  # a corner is lacking


def test_floor_plans_of_scattered_points_stop_at_the_outline():
    corners = np.array([[0, 0], [4, 0], [4, 2], [2, 2], [2, 4], [0, 4]], dtype=float)
    at = RANDOM.random((90, 2)) * 4
    at = at[(at[:, 0] < 2) | (at[:, 1] < 2)]
    figure = floor_plan(at, at[:, 0] + 1, label="x", plan=Plan(corners), scale="log")
    assert figure.axes[0].images[0].get_clip_path() is not None
    assert cell(at) is None
    assert 0.05 < spacing(at) < 0.5
    # Every part of the floor has the colour of a point.
    assert figure.axes[0].images[0].get_array().mask.sum() == 0
    pixels(figure)


def test_carpets_put_values_at_their_day_and_hour(weather):
    values = np.zeros(8760)
    step = weather.at("03-01 14:00")
    values[step] = 7.0
    values[0] = np.nan
    figure = carpets(
        {"A": values, "B": 2 * values}, weather.times, 1.0, label="E [lx]", sun=sun_hours(weather), title="two"
    )
    first, second = (ax.collections[0] for ax in figure.axes[:2])
    image = first.get_array()
    assert image.shape == (24, 365)
    assert image[14, 59] == 7
    assert image[0, 0] is np.ma.masked
    assert (first.norm.vmax, second.norm.vmax) == (14, 14)
    pixels(figure)


def test_carpets_of_few_days_name_them(weather):
    some = weather.selected((weather.days == 21) & np.isin(weather.months, [3, 6]))
    figure = carpets({"": some.direct}, some.times, 1.0, label="E", sun=sun_hours(some))
    assert [label.get_text() for label in figure.axes[0].get_xticklabels()] == ["21 Mar", "21 Jun"]


def test_quarters_of_hours_make_finer_rows():
    times = np.datetime64("2001-06-01T00:07:30") + np.arange(96) * np.timedelta64(900, "s")
    figure = carpets({"": np.arange(96.0)}, times, 0.25, label="n")
    assert np.asarray(figure.axes[0].collections[0].get_array()).ravel() == pytest.approx(np.arange(96.0))


def test_bars_are_stacked_and_what_is_missing_is_hatched():
    shares = {"A": [0.7, 0.2, 0.06, 0.04], "B": [0.5, 0.2, 0.2, 0.1], "C": np.full(4, np.nan)}
    figure = class_bars(shares, DGP_CLASSES.names, ranges=DGP_CLASSES.ranges, title="DGP")
    ax = figure.axes[0]
    tops = {}
    for container in ax.containers:
        for k, bar in enumerate(container):
            tops[k] = max(tops.get(k, 0), bar.get_y() + bar.get_height())
    assert tops[0] == pytest.approx(100)
    assert tops[1] == pytest.approx(100)
    assert {text.get_text() for text in ax.texts} >= {"70", "20", "6.0", "4.0"}
    assert ax.containers[-1][0].get_hatch()
    near = class_bars(shares, DGP_CLASSES.names, focus=True).axes[0]
    assert near.get_ylim()[1] == 60  # 1.15 of the half that is not harmless, to the next 5
    pixels(figure)


def test_occurrences_count_hours(weather, illuminance):
    hours = Hours().weights(weather)
    figure = occurrence({"A": illuminance[:, 0], "B": illuminance[:, 5]}, hours, title="08:00 to 18:00")
    left, right = figure.axes
    heights = [patch.get_data().values.sum() for patch in left.patches]
    assert heights == pytest.approx([3650, 3650])
    assert right.lines[0].get_ydata()[0] == 100
    assert (np.diff(right.lines[0].get_ydata()) <= 0).all()
    pixels(figure)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: floor_plan(POINTS, np.ones(3), label="x"),
        lambda: floor_plan(POINTS, {}, label="x"),
        lambda: floor_plan(RANDOM.random((500, 2)), np.ones(500), label="x", numbers=True),
        lambda: carpets({}, np.array(["2001-01-01"], dtype="datetime64[s]"), 1.0, label="x"),
        lambda: carpets({"": [1, 2]}, np.array(["2001-01-01"], dtype="datetime64[s]"), 1.0, label="x"),
        lambda: class_bars({}, DGP_CLASSES.names),
        lambda: class_bars({"A": [1.0]}, DGP_CLASSES.names),
        lambda: class_bars({"A": [1.0]}, ["one"]),
        lambda: occurrence({}, [1]),
    ],
)
def test_pictures_of_nothing_are_refused(wrong):
    with pytest.raises(ClerestoryError, match=r"\(.*\)$"):
        wrong()


def test_pictures_are_the_same_byte_for_byte(weather, illuminance):
    one, two = (style.render(occurrence({"A": illuminance[:, 0]}, Hours().weights(weather)), ".svg") for _ in range(2))
    assert one == two


def test_the_examples_of_the_page_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / "metrics.md").read_text()
    exec("\n".join(re.findall(r"```python\n(.*?)```", text, re.DOTALL)), {})
    assert {path.name for path in tmp_path.iterdir()} == {"room.nc", "plan.png", "dgp.png"}
