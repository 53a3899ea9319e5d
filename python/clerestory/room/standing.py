"""What a person may have put in the wrong place: eyes and sensors outside of the room, windows the wrong way round."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from clerestory import _core

OPEN = 0.25
"""A point that sees no window from the room, but this share of all directions in the open, is outside."""
NAMED = 6
"""So many points of one fault are named, with their numbers from 1."""
INTO_THE_OPEN = 0.5
"""A window whose face to the room sees more than this share in the open, and more than its other face, is the wrong
way round."""


def of_windows(core: _core.Room) -> list[str]:
    """What is doubtful about the places of windows."""
    doubts = []
    for (name, _, _), (inside, outside, covered) in zip(core.windows(), core.outlooks(), strict=True):
        if covered is not None:
            doubts.append(
                f"window {name}: it lies in the plane of {covered}, which has no opening there, so that no light "
                "enters (cut the opening)"
            )
        elif inside > INTO_THE_OPEN and inside > outside:
            doubts.append(
                f"window {name}: its face to the room sees the sky or the ground in {100.0 * inside:.0f} % of all "
                f"directions, its other one in {100.0 * outside:.0f} % (if it is the wrong way round, list its corners "
                "counter-clockwise as seen from the room)"
            )
    return doubts


def of_points(core: _core.Room, points: Iterable[Sequence[float]], what: str) -> list[str]:
    """What is doubtful about the places of an eye or of sensors [m]; `what` they are called."""
    if not core.windows():
        return []
    within: dict[str, list[tuple[int, str]]] = {}
    outside: list[tuple[int, str]] = []
    count, shares = 0, []
    for point in points:
        count += 1
        x, y, z = (float(v) for v in point)
        open_share, windows, body = core.around((x, y, z))
        place = f"at ({x:g}, {y:g}, {z:g}) m"
        if body is not None:
            within.setdefault(body, []).append((count, place))
        elif windows == 0.0 and open_share > OPEN:
            outside.append((count, place))
            shares.append(open_share)

    def some(places: list[tuple[int, str]]) -> str:
        if count == 1:
            return f"{what} {places[0][1]} lies"
        return f"{len(places)} of {count} {what} {'lies' if len(places) == 1 else 'lie'}"

    def which(places: list[tuple[int, str]]) -> str:
        if count == 1:
            return ""
        words = ", ".join(f"number {number} {place}" for number, place in places[:NAMED])
        return f", {words}{f' and {len(places) - NAMED} more' if len(places) > NAMED else ''}"

    doubts = [
        f"{some(places)} within {body}{which(places)} (move {'it' if count == 1 else 'them'} out)"
        for body, places in within.items()
    ]
    if outside:
        doubts.append(
            f"{some(outside)} outside of the room{which(outside)}: {100.0 * max(shares):.0f} % of all directions are "
            f"open, and no window is seen from the room (move {'it' if count == 1 else 'them'} inside)"
        )
    return doubts
