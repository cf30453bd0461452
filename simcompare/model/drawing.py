"""What a scene looks like: the bodies of a scenario with their shapes, and what looks at them."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare.model.scenario import Scenario
from simcompare.model.shapes import Quaternion, Shape, Vector

POSITION, ORIENTATION = "position_m", "orientation_wxyz"


@dataclass(frozen=True)
class DrawnBody:
    """A body as it is drawn.

    Attributes:
        fixed: whether it never moves.
        position_m: where it is at the start, world frame [m].
        orientation_wxyz: how it is turned at the start.
        shapes: in its own frame.
    """

    fixed: bool
    position_m: Vector
    orientation_wxyz: Quaternion
    shapes: tuple[Shape, ...]


@dataclass(frozen=True)
class DrawnEye:
    """A range sensor of many zones, as its rays are drawn.

    Attributes:
        body: that carries it.
        position_m: in the body's frame [m].
        orientation_wxyz: how it is turned there.
        zones: in a row, and rows.
        geometry: how its angle of view is divided; the usual way where ``None``.
        reach_m: what it reads where it sees nothing; the usual one where ``None`` [m].
    """

    body: str
    position_m: Vector
    orientation_wxyz: Quaternion
    zones: int
    geometry: str | None
    reach_m: float | None


def eyes(scenario: Scenario) -> dict[str, DrawnEye]:
    """Every sensor that looks."""
    return {
        name: DrawnEye(
            one.body, one.position_m, one.orientation_wxyz, one.zones, one.geometry, one.reach_m
        )
        for name, one in scenario.range_sensors().items()
        if one.body and one.zones
    }


def drawn(scenario: Scenario) -> dict[str, DrawnBody]:
    """Every body that can be seen, in the order of the file."""
    return {
        name: DrawnBody(body.fixed, body.position_m, body.orientation_wxyz, shapes)
        for name, body in scenario.bodies.items()
        if (shapes := body.visual or body.shapes)
    }
