"""What a replay shows: bodies that move in three dimensions, of several sources at once."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from simcompare.model.rotations import rotate
from simcompare.model.trajectory import Array
from simcompare.reports.render.meshes import Mesh


@dataclass(frozen=True)
class Motion:
    """Where one body is.

    Attributes:
        position_m: its place at each time (n, 3), world frame [m]; (1, 3) where it stays.
        orientation_wxyz: how it is turned at each time (n, 4); (1, 4) where it does not turn.
    """

    position_m: Array
    orientation_wxyz: Array


@dataclass(frozen=True)
class Eye:
    """A range sensor of many zones whose rays are drawn.

    Attributes:
        body: that carries it and moves; empty where it stays.
        origin_m: where its rays begin (3,), in the frame of that body or of the world [m].
        rays: how they go (z, 3), in the same frame, until 1 m along the sensor's axis.
        reach_m: range from which on nothing is seen [m].
    """

    body: str
    origin_m: Array
    rays: Array
    reach_m: float


@dataclass(frozen=True)
class Actor:
    """One source that moves the bodies.

    Attributes:
        label: its name.
        colour: as ``#rrggbb``.
        level: words of its contact level; empty for what is shown beside each of them.
        motions: body -> where it is.
        ranges: eye -> how far its rays go at each time (n, z), along its axis; NaN where they meet
            nothing [m].
    """

    label: str
    colour: str
    level: str
    motions: Mapping[str, Motion]
    ranges: Mapping[str, Array] = field(default_factory=dict)

    def ray_ends(self, name: str, eye: Eye) -> Array:
        """Where the rays of an eye end (n, z, 3), world frame; NaN where they meet nothing [m]."""
        ends = eye.origin_m + self.ranges[name][:, :, None] * eye.rays
        if not eye.body:
            return np.asarray(ends)
        count, zones, _ = ends.shape
        motion = self.motions[eye.body]
        turns = np.broadcast_to(motion.orientation_wxyz, (count, 4))
        turned = rotate(np.repeat(turns, zones, axis=0), ends.reshape(-1, 3))
        return np.asarray(turned.reshape(ends.shape) + motion.position_m[:, None, :])

    def placed(self, name: str, mesh: Mesh, index: int) -> Mesh:
        """The surface of a body where it is at an instant."""
        motion = self.motions[name]
        turn = motion.orientation_wxyz[min(index, len(motion.orientation_wxyz) - 1)]
        corners = rotate(np.tile(turn, (len(mesh.corners), 1)), mesh.corners)
        place = motion.position_m[min(index, len(motion.position_m) - 1)]
        return replace(mesh, corners=corners + place)


@dataclass(frozen=True)
class Replay:
    """A scene that can be played.

    Attributes:
        name: short name, for files and anchors.
        title: what it is.
        caption: what to see in it, one or two sentences.
        time_s: instants (n,), evenly spaced [s].
        bodies: body that moves -> its surface in its own frame.
        still: surface of what never moves, world frame; each lane has its own.
        ground: surface of floors and walls, which all lanes share.
        actors: who moves them; the first level of them is shown first.
        low_m: lowest corner of what is shown (3,) [m].
        high_m: highest corner (3,) [m].
        across: horizontal axis, 0 or 1, along which sources may stand side by side.
        width_m: from one to the next there [m].
        is_flat: whether little moves across, so that they do at first.
        is_upright: whether it stays in its place, so that it is seen from the front.
        eyes: range sensors whose rays are drawn.
    """

    name: str
    title: str
    caption: str
    time_s: Array
    bodies: Mapping[str, Mesh]
    still: Mesh
    ground: Mesh
    actors: tuple[Actor, ...]
    low_m: Array
    high_m: Array
    across: int
    width_m: float
    is_flat: bool
    is_upright: bool
    eyes: Mapping[str, Eye] = field(default_factory=dict)

    @property
    def levels(self) -> list[str]:
        """Contact levels in words, the first one shown first."""
        return list(dict.fromkeys(actor.level for actor in self.actors if actor.level))

    def shown(self, level: str) -> list[Actor]:
        """Who is seen at a level."""
        return [actor for actor in self.actors if actor.level in ("", level)]


def reach_m(mesh: Mesh) -> float:
    """Distance of the farthest corner from the origin of its frame [m]."""
    if not len(mesh.corners):
        return 0.0
    return math.sqrt(float(np.max(np.sum(mesh.corners**2, axis=1))))
