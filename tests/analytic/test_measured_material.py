"""RGL's parametrisation against materials that have a closed form."""

import numpy as np
import pytest

from clerestory.measure.formats import rgl
from clerestory.measure.formats.measured_material import MeasuredMaterial, bilinear, warped
from instrument_files import material, tensor_file

NODES = 129


def on_nodes(function, nodes=NODES):
    """Values of a function of the unit square's two coordinates at a grid's nodes (second, first)."""
    u = np.linspace(0.0, 1.0, nodes)
    return function(*np.meshgrid(u, u))


def cosine_out(x, y, theta_i):
    """Cosine of the outgoing angle of a halfway vector's coordinates, with the light at azimuth 0."""
    theta, phi = x**2 * np.pi / 2.0, (2.0 * y - 1.0) * np.pi
    half = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    incident = np.array([np.sin(theta_i), 0.0, np.cos(theta_i)])
    return 2.0 * (half @ incident) * half[..., 2] - incident[2]


def directions(count=500, seed=3):
    rng = np.random.default_rng(seed)
    z, phi = 0.3 + 0.7 * rng.random(count), 2 * np.pi * rng.random(count)
    return np.stack([np.sqrt(1 - z**2) * np.cos(phi), np.sqrt(1 - z**2) * np.sin(phi), z], axis=-1)


def test_an_even_density_warps_nothing():
    at = np.random.default_rng(1).random((200, 2))
    np.testing.assert_allclose(warped(np.ones((7, 5)), at), at, atol=1e-12)


def test_a_warp_is_the_share_of_the_density():
    # p(x, y) = (1 + x)(2 - y): separable, linear in both, so exact on any grid.
    density = on_nodes(lambda x, y: (1.0 + x) * (2.0 - y), 6)
    at = np.random.default_rng(2).random((300, 2))
    x, y = at.T
    expected = np.stack([(x + x**2 / 2) / 1.5, (2 * y - y**2 / 2) / 1.5], axis=-1)
    np.testing.assert_allclose(warped(density, at), expected, atol=1e-12)


def test_a_warp_takes_the_first_coordinate_along_the_second():
    # p(x, y) = 1 + x y: the share in x depends on y.
    density = on_nodes(lambda x, y: 1.0 + x * y, 9)
    at = np.random.default_rng(4).random((300, 2))
    x, y = at.T
    expected = np.stack([(x + x**2 * y / 2) / (1 + y / 2), (y + y**2 / 4) / 1.25], axis=-1)
    np.testing.assert_allclose(warped(density, at), expected, atol=1e-12)


def test_values_lie_where_their_nodes_are():
    # One channel is the first coordinate, which runs fastest, the other the second.
    grids = np.stack([on_nodes(lambda x, y: x, 5), on_nodes(lambda x, y: y, 5)])
    at = np.random.default_rng(5).random((50, 2))
    np.testing.assert_allclose(bilinear(grids, at), at, atol=1e-12)


def test_a_lambertian_material_comes_back_from_its_file():
    thetas = np.array([0.0, 0.5, 1.0], dtype=np.float32)
    values = np.stack([0.5 / np.pi * on_nodes(lambda x, y, t=t: cosine_out(x, y, t)) for t in thetas])
    fields = material(theta_i=thetas) | {"spectra": np.stack([values, 2 * values], axis=1)[None].astype(np.float32)}
    scans = rgl.read(tensor_file(fields), "white.bsdf").measurements[0].scans
    assert [round(s.incident_theta_deg, 2) for s in scans] == [0.0, 28.65, 57.3]
    assert {s.incident_phi_deg for s in scans} == {90.0}
    assert scans[0].channels == ("450 nm", "550 nm")
    for scan in scans:
        inner = scan.theta_deg < 70.0
        np.testing.assert_allclose(scan.values[inner], np.tile([0.5, 1.0], (inner.sum(), 1)) / np.pi, rtol=3e-3)


def test_densities_take_values_along():
    # Values that are the warped first coordinate: the BSDF must be its closed form over the cosine.
    density = on_nodes(lambda x, y: 1.0 + x, 33)
    first = on_nodes(lambda x, y: x)
    made = MeasuredMaterial(np.array([0.6]), np.array([0.0]), density[None, None], first[None, None, None], None, None)
    incident, outgoing = np.array([np.sin(0.6), 0.0, np.cos(0.6)]), directions()
    half = incident + outgoing
    half /= np.linalg.norm(half, axis=1)[:, None]
    x = np.sqrt(np.arccos(half[:, 2]) * 2 / np.pi)
    expected = (x + x**2 / 2) / 1.5 / outgoing[:, 2]
    np.testing.assert_allclose(made.evaluate(incident, outgoing)[:, 0], expected, rtol=1e-9)


def test_the_jacobian_multiplies_by_normals_over_their_area():
    incident, outgoing = np.array([0.0, np.sin(0.3), np.cos(0.3)]), directions()
    even = np.ones((1, 1, 4, 4))
    half_values = np.full((1, 1, 1, 4, 4), 0.5)
    ndf, sigma = np.full((4, 4), 2.0), np.full((4, 4), 0.25)
    plain = MeasuredMaterial(np.array([0.3]), np.array([0.0]), even, half_values, None, None)
    scaled = MeasuredMaterial(np.array([0.3]), np.array([0.0]), even, half_values, ndf, sigma)
    np.testing.assert_allclose(scaled.evaluate(incident, outgoing), 2.0 * plain.evaluate(incident, outgoing))
    np.testing.assert_allclose(plain.evaluate(incident, outgoing)[:, 0], 0.5 / outgoing[:, 2])


def test_values_between_incident_angles_are_linear():
    values = np.stack([np.full((1, 4, 4), v) for v in (1.0, 3.0)])[None]
    made = MeasuredMaterial(np.array([0.2, 0.6]), np.array([0.0]), np.ones((1, 2, 4, 4)), values, None, None)
    up = np.array([[0.0, 0.0, 1.0]])
    for theta, expected in ((0.1, 1.0), (0.2, 1.0), (0.3, 1.5), (0.6, 3.0), (1.2, 3.0)):
        incident = np.array([np.sin(theta), 0.0, np.cos(theta)])
        assert made.evaluate(incident, up)[0, 0] == pytest.approx(expected)


@pytest.mark.parametrize("folds", [2, 4])
def test_parts_of_the_circle_stand_for_all_of_it(folds):
    """A file of half or a quarter of incident azimuths gives the same as one of all, where the material is so."""

    def bsdf(half):  # even under both mirrorings
        return 1.0 + 0.5 * half[..., 0] ** 2 - 0.3 * half[..., 1] ** 2

    x, y = np.meshgrid(np.linspace(0, 1, NODES), np.linspace(0, 1, NODES))
    theta, phi = x**2 * np.pi / 2.0, (2.0 * y - 1.0) * np.pi
    values = bsdf(np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1))
    azimuths = np.linspace(-np.pi, -np.pi + 2.0 * np.pi / folds, 3)
    made = MeasuredMaterial(
        np.array([0.5]), azimuths, np.ones((3, 1, 4, 4)), np.broadcast_to(values, (3, 1, 1, NODES, NODES)), None, None
    )
    outgoing = directions()
    for azimuth in np.radians([10.0, 100.0, 190.0, 280.0, 359.0]):
        incident = np.array([np.sin(0.5) * np.cos(azimuth), np.sin(0.5) * np.sin(azimuth), np.cos(0.5)])
        half = incident + outgoing
        half /= np.linalg.norm(half, axis=1)[:, None]
        found = made.evaluate(incident, outgoing)[:, 0] * outgoing[:, 2]
        np.testing.assert_allclose(found, bsdf(half), rtol=2e-3)


def test_an_anisotropic_file_says_where_its_light_comes_from():
    scans = rgl.read(tensor_file(material(phi_i=(-3.0, -1.5, 0.0))), "a.bsdf").measurements[0].scans
    # Seen from outside; azimuth 0 there is our 180°.
    turned = sorted({round(s.incident_phi_deg, 2) for s in scans})
    np.testing.assert_allclose(turned, sorted([180.0, 180 + np.degrees(1.5), (180 + np.degrees(3.0)) % 360]), atol=0.01)
    chosen = rgl.read(
        tensor_file(material()), "a.bsdf", incident_theta_deg=20.0, incident_phi_deg=[0.0, 90.0], side="interior"
    )
    assert [(s.incident_theta_deg, s.incident_phi_deg, s.incident_side) for s in chosen.measurements[0].scans] == [
        (20.0, 0.0, "interior"),
        (20.0, 90.0, "interior"),
    ]
