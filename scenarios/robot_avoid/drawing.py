"""Arenas drawn at random: where the robot starts, where it is to go, and what stands in its way."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

#: half the side of the arena [m]
HALF_M = 1.0
#: the robot seen from above: a disc about its chassis that holds wheels and caster [m]
ROBOT_RADIUS_M = 0.09
#: least way between two obstacles, from surface to surface: the robot and a hand's breadth [m]
PASSAGE_M = 0.26
#: least gap between the robot's disc at the start, or the goal, and an obstacle [m]
FREE_M = 0.12
#: least way from the start to the goal [m]
LEAST_WAY_M = 1.0
BOXES, POSTS = ("box_1", "box_2", "box_3"), ("post_1", "post_2", "post_3")

#: an obstacle from above: name, middle, and radius of the circle around it
_Round = tuple[str, float, float, float]


def draw(rng: np.random.Generator) -> dict[str, float]:
    """Parameters of the scenario for one arena.

    Friction of the tyres and resistance of the motors are drawn too: from 0.5 to 0.7, and with the
    2 % that the scenario knows it to.

    Args:
        rng: what is drawn from; the same state gives the same arena.
    """
    while True:
        found = _try(rng)
        if found is not None:
            return found


def _try(rng: np.random.Generator) -> dict[str, float] | None:
    """One arena, ``None`` where an obstacle finds no place."""
    room = HALF_M - ROBOT_RADIUS_M - FREE_M
    start, goal = rng.uniform(-room, room, (2, 2))
    if math.dist(start, goal) < LEAST_WAY_M:
        return None
    heading = float(rng.uniform(-math.pi, math.pi))
    sizes = {name: float(rng.uniform(0.06, 0.16)) for name in BOXES}
    radii = {name: float(rng.uniform(0.03, 0.08)) for name in POSTS}
    placed: list[_Round] = []
    for name, around in {**{n: s / math.sqrt(2) for n, s in sizes.items()}, **radii}.items():
        for _ in range(100):
            x, y = rng.uniform(-0.9, 0.9, 2).tolist()
            free = around + ROBOT_RADIUS_M + FREE_M
            clear = all(math.dist((x, y), place) > free for place in (start, goal)) and all(
                math.hypot(x - a, y - b) > around + r + PASSAGE_M for _, a, b, r in placed
            )
            if clear:
                placed.append((name, x, y, around))
                break
        else:
            return None
    found = {
        "tyre_friction": float(rng.uniform(0.5, 0.7)),
        "resistance_Ohm": 6.0 * float(rng.normal(1, 0.01)),
        "arena_turn_rad": -heading,
        **{f"{name}_size_m": size for name, size in sizes.items()},
        **{f"{name}_radius_m": radius for name, radius in radii.items()},
    }
    cos, sin = math.cos(heading), math.sin(heading)
    places = [("arena", 0.0, 0.0), ("goal", *goal.tolist()), *((n, x, y) for n, x, y, _ in placed)]
    for name, x, y in places:
        right, up = x - start[0], y - start[1]
        found[f"{name}_x_m"] = float(cos * right + sin * up)
        found[f"{name}_y_m"] = float(cos * up - sin * right)
    for name in BOXES:
        found[f"{name}_turn_rad"] = float(rng.uniform(-math.pi, math.pi))
    return found


class Plan:
    """The arena from above, in the frame of the scenario's places.

    Args:
        parameters: those of the scenario.
    """

    def __init__(self, parameters: Mapping[str, float]) -> None:
        p = parameters
        self.goal = (p["goal_x_m"], p["goal_y_m"])
        turn = p["arena_turn_rad"]
        self._arena = (p["arena_x_m"], p["arena_y_m"], math.cos(turn), math.sin(turn))
        self._boxes = [
            (
                n, p[f"{n}_x_m"], p[f"{n}_y_m"], p[f"{n}_size_m"] / 2,
                math.cos(p[f"{n}_turn_rad"]), math.sin(p[f"{n}_turn_rad"]),
            )
            for n in BOXES
        ]  # fmt: skip
        self._posts = [(n, p[f"{n}_x_m"], p[f"{n}_y_m"], p[f"{n}_radius_m"]) for n in POSTS]

    def gaps(self, x: float, y: float) -> dict[str, float]:
        """Distance of a point from the walls and from each obstacle [m]; negative inside."""
        ax, ay, cos, sin = self._arena
        u, v = cos * (x - ax) + sin * (y - ay), cos * (y - ay) - sin * (x - ax)
        found = {"the walls": HALF_M - max(abs(u), abs(v))}
        for name, bx, by, half, cos, sin in self._boxes:
            u = abs(cos * (x - bx) + sin * (y - by)) - half
            v = abs(cos * (y - by) - sin * (x - bx)) - half
            found[name] = math.hypot(u, v) if u > 0 and v > 0 else max(u, v)
        for name, px, py, radius in self._posts:
            found[name] = math.hypot(x - px, y - py) - radius
        return found

    def faults(self, x: float, y: float) -> list[str]:
        """What is wrong with an arena in which the robot starts at a place; all of it."""
        found = []
        places = (("start", (x, y), ROBOT_RADIUS_M), ("goal", self.goal, 0.0))
        for what, place, need in places:
            for name, gap in self.gaps(*place).items():
                if gap <= need:
                    found.append(
                        f"{what} at ({place[0]:.3g}, {place[1]:.3g}) m: {name}"
                        f" {'are' if name == 'the walls' else 'is'} {gap:.3g} m away; expected more"
                        f" than {need:g} m; move the {what} or what is there"
                    )
        return found
