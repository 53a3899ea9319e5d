"""Measurements for tests: files as laboratories write them, made here, and scans of any kind."""

import numpy as np
from hypothesis import strategies as st

from clerestory.measure import Measurement, Scan

PRISM = np.array([0.15, 0.3])
"""What a sample without symmetry adds to the projection of straight light, seen from the front: to the right and up."""


def unit(theta_deg, phi_deg):
    """Vectors of a frame with its front at +z."""
    theta, phi = np.broadcast_arrays(np.radians(theta_deg), np.radians(phi_deg))
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def peak_of(theta_i, phi_i, *, transmitted, shift=PRISM):
    """Where the light from a direction goes, in the same frame."""
    flat = -unit(theta_i, phi_i)[:2] + shift
    return np.array([*flat, (-1.0 if transmitted else 1.0) * np.sqrt(1.0 - flat @ flat)])


def mountain_points(theta_i, phi_i, *, transmitted, width=0.03, shift=PRISM, step=3):
    """θ, φ and DSF of a diffuse sample with one peak, on rings."""
    peak = peak_of(theta_i, phi_i, transmitted=transmitted, shift=shift)
    rings = []
    for theta in np.arange(0.0, 88.0, step):
        count = max(1, int(360 / step * np.sin(np.radians(theta))))
        rings.append(np.stack([np.full(count, theta), np.arange(count) * 360.0 / count], axis=1))
    angles = np.concatenate(rings)
    if transmitted:
        angles[:, 0] = 180.0 - angles[:, 0]
    outgoing = unit(angles[:, 0], angles[:, 1])
    dsf = 0.05 * np.abs(outgoing[:, 2]) + 1.2 * np.exp((outgoing @ peak - 1.0) / width)
    return np.column_stack([angles, dsf])


def mountain_text(points, theta_i, phi_i, *, up=90, sample="skew", kind="DSF", more=()):
    """A file of pab's."""
    head = [
        f'#sample_name "{sample}"',
        f"#format: theta phi {kind}",
        f"#intheta {theta_i}",
        f"#inphi {phi_i}",
        f"#upphi {up}",
        *more,
    ]
    rows = [" ".join(f"{x:.7g}" for x in row) for row in points]
    return "\n".join([*head, *rows, ""])


words = st.text(
    st.characters(codec="ascii", categories=("L", "N", "P", "S"), exclude_characters='"#:=\\,;'), max_size=12
)


@st.composite
def scans(draw, quantities=("bsdf", "dsf"), errors=False):
    """A scan that any file of points can hold."""
    count = draw(st.integers(1, 12))
    channels = draw(st.sampled_from([("visible",), ("X", "Y", "Z"), ("solar",), ("550 nm", "650.5 nm")]))
    number = st.floats(-1e6, 1e6, allow_subnormal=False)
    polar = st.floats(0.0, 90.0).filter(lambda t: t < 89.9)

    def array(element, *shape):
        size = int(np.prod(shape))
        return np.array(draw(st.lists(element, min_size=size, max_size=size))).reshape(shape)

    conditions = draw(
        st.dictionaries(
            st.sampled_from(["laboratory", "lamp", "date", "spot_mm", "Filter_wheel", "format", "points"]),
            words.map(str.strip).filter(bool),
            max_size=3,
        )
    )
    return Scan(
        draw(st.sampled_from(["exterior", "interior"])),
        draw(st.sampled_from(["transmission", "reflection"])),
        draw(polar),
        draw(st.floats(0.0, 359.0)),
        array(polar, count),
        array(st.floats(0.0, 359.0), count),
        array(number, count, len(channels)),
        quantity=draw(st.sampled_from(quantities)),
        channels=channels,
        standard_errors=array(st.floats(0.0, 1.0), count, len(channels)) if errors and draw(st.booleans()) else None,
        purpose=draw(st.sampled_from(["sample", "sample", "beam", "dark"])),
        conditions=conditions,
    )


def measurements(**kinds):
    """A sample with one to three scans."""
    names = words.map(str.strip).filter(bool)
    return st.builds(
        lambda name, found: Measurement(name, tuple(found)), names, st.lists(scans(**kinds), min_size=1, max_size=3)
    )


def apart_deg(a, b):
    """Difference of azimuths [°]."""
    return np.abs((np.asarray(a) - b + 180.0) % 360.0 - 180.0)
