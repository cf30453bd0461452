"""Recoil of armatures in PyBullet, as torques on the links that they connect."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from simcompare.backends._pybullet_parts import Scene
from simcompare.backends._recoil import Motion, Recoil
from simcompare.shapes import Quaternion, Vector


class Rotors:
    """Armatures on bodies that can turn.

    Args:
        scene: what was built.
        order: joints, in the order in which their states will be given.
        recoil: what gives the torques.

    Attributes:
        torques: what was given in the last step [N·m], four numbers for each rotor: about the axis
            on the parent, and on the child in its own frame.
    """

    def __init__(self, scene: Scene, order: Sequence[str], recoil: Recoil) -> None:
        self.recoil, self._engine, self._client = recoil, scene.engine, scene.client
        self.torques = [(0.0, 0.0, 0.0, 0.0) for _ in recoil.rotors]
        self._slots = [order.index(rotor.joint) for rotor in recoil.rotors]
        self._parents = [(scene.bodies[r.parent], r.parent_axis) for r in recoil.rotors]
        self._children = [scene.bodies[rotor.child] for rotor in recoil.rotors]

    def motions(self, states: Sequence[Sequence[Any]]) -> list[Motion]:
        """How the rotors move, by the states of the joints."""
        read, client = self._engine.getLinkState, self._client
        found: list[Motion] = []
        for slot, (uid, link) in zip(self._slots, self._children, strict=True):
            link_state = read(uid, link, 1, 1, client)
            found.append((states[slot][1], _to_body(link_state[1], link_state[7])))
        return found

    def push(self, states: Sequence[Sequence[Any]]) -> None:
        """Gives both bodies of armatures what is missing on them in the next step."""
        self.torques = self.recoil.torques(self.motions(states))
        push, frame, client = (
            self._engine.applyExternalTorque,
            self._engine.LINK_FRAME,
            self._client,
        )
        for (back, *given), ((uid, link), (x, y, z)), (other, child) in zip(
            self.torques, self._parents, self._children, strict=True
        ):
            push(uid, link, (back * x, back * y, back * z), frame, client)
            push(other, child, given, frame, client)


def _to_body(orientation_xyzw: Quaternion, vector: Vector) -> Vector:
    """A vector of the world in a body's frame: v - 2·w·(u × v) + 2·u × (u × v)."""
    (ux, uy, uz, w), (x, y, z) = orientation_xyzw, vector
    a, b, c = 2 * (uy * z - uz * y), 2 * (uz * x - ux * z), 2 * (ux * y - uy * x)
    return (
        x - w * a + uy * c - uz * b,
        y - w * b + uz * a - ux * c,
        z - w * c + ux * b - uy * a,
    )
