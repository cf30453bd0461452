"""Rays in a scenario whose bodies move: what they meet at each of its samples, by our own casting.

Bodies are rigid, so that rays are brought into the frame of each body, in which its shapes stay.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.engine.kinematics import placed_shapes
from simcompare.engine.rays import Hits, Solids
from simcompare.model.rotations import conjugate, rotate
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array


class RayScene:
    """All bodies of a scenario that have shapes, but one.

    Args:
        scenario: the scene.
        without_body: the body whose shapes rays pass through; empty for none.

    Attributes:
        bodies: those that rays can meet, in the order in which ``Hits.index`` counts them.
    """

    def __init__(self, scenario: Scenario, without_body: str = "") -> None:
        self.bodies = [n for n, b in scenario.bodies.items() if b.shapes and n != without_body]
        self._moving = {
            i: Solids(placed_shapes(scenario.bodies[name], scenario.bodies[name].shapes))
            for i, name in enumerate(self.bodies)
            if not scenario.bodies[name].fixed
        }
        still = {
            i: placed_shapes(scenario.bodies[name], scenario.bodies[name].shapes)
            for i, name in enumerate(self.bodies)
            if scenario.bodies[name].fixed
        }
        self._still = Solids([shape for shapes in still.values() for shape in shapes])
        self._owners = np.array([i for i, shapes in still.items() for _ in shapes] + [-1])

    def distances(self, origins: Array, directions: Array, signals: Mapping[str, Array]) -> Array:
        """How far rays go until they meet a body.

        Args:
            origins: where rays begin at each sample (n, 3) [m]; outside of all these bodies.
            directions: unit vectors (n, k, 3), k rays at each sample.
            signals: position and orientation of each moving body, in n samples.

        Returns:
            Distances (n, k) [m]; ``inf`` where nothing is met.
        """
        starts, along = _flat(origins, directions)
        found = self._still.ranges(starts, along)
        for i, solids in self._moving.items():
            seen = self._seen_from(i, signals, starts, along)
            found = np.minimum(found, solids.ranges(*seen))
        return found.reshape(directions.shape[:2])

    def cast(self, origins: Array, directions: Array, signals: Mapping[str, Array]) -> Hits:
        """The same with normals, and with the number of the body that is met.

        Returns:
            Distances (n, k), normals (n, k, 3) in the world's frame, and indices (n, k) in
            ``bodies``.
        """
        starts, along = _flat(origins, directions)
        met = self._still.cast(starts, along)
        distance, normal, index = met.distance_m, met.normal, self._owners[met.index]
        for i, solids in self._moving.items():
            own = solids.cast(*self._seen_from(i, signals, starts, along))
            nearer = own.distance_m < distance
            distance = np.where(nearer, own.distance_m, distance)
            turns = np.repeat(signals[f"{self.bodies[i]}.orientation_wxyz"], directions.shape[1], 0)
            normal = np.where(nearer[:, None], rotate(turns, own.normal), normal)
            index = np.where(nearer, i, index)
        shape = directions.shape[:2]
        return Hits(distance.reshape(shape), normal.reshape(*shape, 3), index.reshape(shape))

    def _seen_from(
        self, number: int, signals: Mapping[str, Array], starts: Array, along: Array
    ) -> tuple[Array, Array]:
        """Rays (1 or n·k, 3) and (n·k, 3) in the frame of a moving body."""
        place, turn = (
            signals[f"{self.bodies[number]}.{part}"] for part in ("position_m", "orientation_wxyz")
        )
        each = len(along) // len(place)
        back = np.repeat(conjugate(turn), each, axis=0)
        if len(starts) == 1:
            return rotate(back[:1], starts - place), rotate(back, along)
        return rotate(back, starts - np.repeat(place, each, axis=0)), rotate(back, along)


def _flat(origins: Array, directions: Array) -> tuple[Array, Array]:
    """Rays of all samples one after the other (n·k, 3); of one sample all begin at one place."""
    if len(origins) == 1:
        return origins, directions.reshape(-1, 3)
    return np.repeat(origins, directions.shape[1], axis=0), directions.reshape(-1, 3)
