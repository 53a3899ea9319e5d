"""Directions in words, as every read-out says them."""

import pytest

from clerestory.directions import direction, incident_in_words, outgoing_in_words


@pytest.mark.parametrize("side", ["exterior", "interior"])
@pytest.mark.parametrize(
    ("theta", "phi", "incident", "outgoing"),
    [
        (0, 0, "along the normal", "along the normal"),
        (30, 90, "from above, 30°", "upward, 30°"),
        (40, 270, "from below, 40°", "downward, 40°"),
        (50, 0, "from the right, 50°", "to the right, 50°"),
        (50, 359.95, "from the right, 50°", "to the right, 50°"),
        (7.5, 180, "from the left, 7.5°", "to the left, 7.5°"),
        (60, 45, "from the upper right, 60°", "up to the right, 60°"),
        (60, 225, "from the lower left, 60°", "down to the left, 60°"),
        (60, 100, "from above, 60° (azimuth 100°)", "upward, 60° (azimuth 100°)"),
        (60, 200, "from the left, 60° (azimuth 200°)", "to the left, 60° (azimuth 200°)"),
    ],
)
def test_words_are_those_of_someone_in_the_room(side, theta, phi, incident, outgoing):
    d = direction(theta, phi, side=side)
    assert incident_in_words(d) == incident
    assert outgoing_in_words(d) == outgoing
