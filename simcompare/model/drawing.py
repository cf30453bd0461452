"""What a scene looks like: the bodies of a scenario with the shapes that are drawn of them."""

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


def drawn(scenario: Scenario) -> dict[str, DrawnBody]:
    """Every body that can be seen, in the order of the file."""
    return {
        name: DrawnBody(body.fixed, body.position_m, body.orientation_wxyz, shapes)
        for name, body in scenario.bodies.items()
        if (shapes := body.visual or body.shapes)
    }
