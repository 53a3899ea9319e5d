"""Where the light goes: up must be up and left must be left."""

import numpy as np
import pytest

from clerestory import Basis, Bsdf, MissingDataError, Model, direction
from clerestory.words import band_name, percent, where_light_goes

KLEMS = Basis.named("klems-full")
AREAS = KLEMS.projected_solid_angles


def redirecting(turn):
    """A film that sends each incident direction of travel (x, y) on as turn(x, y), 80 % of it."""
    centres = KLEMS.outgoing_centres("interior")
    values = np.zeros((145, 145))
    for i, travel in enumerate(centres):
        target = np.array([*turn(travel[0], travel[1]), travel[2]])
        values[KLEMS.index_of_outgoing(target), i] += 0.8 / AREAS[KLEMS.index_of_outgoing(target)]
    return Bsdf.from_models({("exterior", "transmission"): Model.matrix(values, KLEMS)})


def exterior(bsdf, elevation, scatter="transmission"):
    (flow,) = where_light_goes(bsdf, sides=["exterior"], scatters=[scatter], elevations_deg=[elevation])
    return flow


@pytest.mark.parametrize("elevation", [30.0, 50.0, 70.0])
def test_a_redirecting_film_sends_the_sun_to_the_ceiling(elevation):
    flow = exterior(redirecting(lambda x, y: (x, -y)), elevation)
    assert flow.upward > 0.99
    assert flow.downward < 0.01
    assert flow.straight < 0.01
    assert flow.words.startswith(f"Light from the exterior, {elevation:g}° above the horizon: ")
    assert "mainly upward into the room" in flow.words
    assert flow.total == pytest.approx(0.8, rel=0.1)


@pytest.mark.parametrize("elevation", [30.0, 50.0, 70.0])
def test_what_lets_the_sun_through_sends_it_down(elevation):
    flow = exterior(redirecting(lambda x, y: (x, y)), elevation)
    assert flow.downward > 0.99
    assert "mainly downward into the room (100 % of it)" in flow.words
    assert flow.straight > 0.7  # the cone of 10° holds most of a patch that is 10° by 15 to 22.5°


def test_light_from_below_goes_up():
    flow = exterior(redirecting(lambda x, y: (x, y)), -50.0)
    assert flow.upward > 0.99
    assert "50° below the horizon" in flow.words


def test_sideways_is_as_seen_from_the_room():
    """Sun straight ahead at 50°: light turned by −90° about the normal travels to the left."""
    flow = exterior(redirecting(lambda x, y: (y, -x)), 50.0)
    assert flow.right < 0.01
    assert "to the left (100 % of it)" in flow.words
    flow = exterior(redirecting(lambda x, y: (-y, x)), 50.0)
    assert flow.right > 0.99


def test_louvre_blocks_the_high_sun():
    centres = KLEMS.outgoing_centres("interior")
    passes = np.where(centres[:, 1] < -0.6, 0.0, 0.5)
    bsdf = Bsdf.from_models({("exterior", "transmission"): Model.matrix(np.diag(passes / AREAS), KLEMS)})
    assert exterior(bsdf, 50.0).words == "Light from the exterior, 50° above the horizon: nothing passes."
    assert "mainly downward" in exterior(bsdf, 30.0).words
    assert "Light from the exterior, level: 50 % passes, mainly level into the room" in exterior(bsdf, 0.0).words


def test_a_diffuser_goes_everywhere():
    bsdf = Bsdf.from_models(
        {("exterior", "transmission"): Model.lambertian(0.4), ("exterior", "reflection"): Model.lambertian(0.5)}
    )
    flow = exterior(bsdf, 50.0)
    assert flow.upward == pytest.approx(flow.downward, abs=0.02)
    assert flow.right == pytest.approx(flow.left, abs=0.01)
    assert "40 % passes, upward and downward alike into the room" in flow.words
    assert "50 % is reflected, upward and downward alike to the outside" in exterior(bsdf, 50.0, "reflection").words


def test_a_mirror_reflects_the_high_sun_down():
    bsdf = Bsdf.from_models({("exterior", "reflection"): Model.specular(0.9)})
    flow = exterior(bsdf, 50.0, "reflection")
    assert flow.downward == pytest.approx(1.0)
    assert flow.straight == pytest.approx(1.0)
    assert "90 % is reflected, mainly downward to the outside (100 % of it)" in flow.words
    assert "of the mirrored direction" in flow.words


def test_only_sides_with_data_speak():
    bsdf = Bsdf.from_models({("interior", "transmission"): Model.specular(0.5)})
    flows = where_light_goes(bsdf, elevations_deg=[30.0])
    assert [(f.side, f.scatter, f.by_reciprocity) for f in flows] == [
        ("exterior", "transmission", True),
        ("interior", "transmission", False),
    ]
    assert "by reciprocity" in flows[0].words
    assert "from the interior, 30° above the horizon: 50 % passes, mainly downward to the outside" in flows[1].words
    flows = where_light_goes(Bsdf.from_models({("exterior", "transmission"): Model.specular(0.5)}))
    assert {f.side for f in flows} == {"exterior"}


def test_an_isotropic_tree_answers_for_the_other_side():
    """A broad lobe about the straight direction: rank 3 has no table of its reverse, and still answers at once."""
    middles = (np.arange(16) + 0.5) / 16
    radius, a, b = np.meshgrid(middles[:8], middles, middles, indexing="ij")
    lobe = 0.3 * np.exp(-20.0 * ((a - (1.0 - radius)) ** 2 + (b - 0.5) ** 2))
    bsdf = Bsdf.from_models({("interior", "transmission"): Model.tree_from_grid(lobe)})
    flow = exterior(bsdf, 50.0)
    assert flow.by_reciprocity
    assert flow.downward > 0.8
    assert flow.left == pytest.approx(flow.right, abs=0.05)
    assert flow.total > 0.01


def test_bands_and_per_cent():
    bsdf = Bsdf.from_models({"solar": {("exterior", "transmission"): Model.lambertian(0.4)}})
    assert band_name(bsdf) == "solar"
    assert band_name(bsdf, "Solar") == "solar"
    with pytest.raises(MissingDataError, match="the data set has: solar"):
        band_name(bsdf, "visible")
    assert [percent(v) for v in (0, 0.5, 0.0123, 0.0004)] == ["0 %", "50 %", "1.2 %", "0.04 %"]
    assert direction(50, 90)[1] > 0
