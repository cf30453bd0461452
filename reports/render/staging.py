"""A scene and who moves it become a replay: instants, surfaces, and what is in the picture."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simcompare.model.drawing import ORIENTATION, POSITION, DrawnBody, DrawnEye
from simcompare.model.rotations import rotate
from simcompare.model.shapes import Plane
from simcompare.model.trajectory import Array, Trajectory
from simcompare.reports.render import replay_rays
from simcompare.reports.render.meshes import Mesh, joined, mesh_of, sheet
from simcompare.reports.render.replay_rays import Indices
from simcompare.reports.render.replays import Actor, Motion, Replay, reach_m

#: pictures in a second, and at most
_RATE_HZ, _MOST = 60.0, 3000
#: a body that turns by more from one picture to the next seems to turn backwards [rad]
_TURN_RAD = 0.6
#: places and turns of all bodies and ranges of rays in a page [byte]; as text a third more
_BUDGET, _PLACE, _TURN, _RAY = 540_000, 12, 8, 2
#: what moves or turns less than this part of the body's size, or by less than this, stands still
_STILL = 1e-5
#: a source that leaves the others by more than so many times their range leaves the picture
_AWAY = 0.6
#: free space about what moves, and from one to the next side by side, in sizes of it
_FREE, _GAP = 0.04, 1.25
#: what moves by no more than so many times its own size may stand side by side
_FLAT = 3.0
#: from one to the next at least this part of the longest way
_LANE = 0.2


@dataclass(frozen=True)
class Source:
    """Who moves the bodies, as it was recorded.

    Attributes:
        label: its name.
        colour: as ``#rrggbb``.
        level: words of its contact level; empty for what is shown beside each of them.
        trajectory: with the motion of bodies among its signals.
    """

    label: str
    colour: str
    level: str
    trajectory: Trajectory


def staged(
    scene: Mapping[str, DrawnBody],
    sources: Sequence[Source],
    caption: str,
    looking: Mapping[str, DrawnEye] | None = None,
) -> Replay | None:
    """The replay; ``None`` where no source tells where a body is."""
    moving = {name: body for name, body in scene.items() if not body.fixed}
    bodies = {name: mesh_of(body.shapes) for name, body in moving.items()}
    telling = [source for source in sources if _told(moving, source.trajectory)]
    if not telling:
        return None
    found = dict(replay_rays.eyes_of(scene, looking or {}))
    zones = sum(len(eye.rays) for eye in found.values())
    time_s = _times(moving, [source.trajectory for source in telling], zones)
    actors = tuple(
        Actor(
            one.label, one.colour, one.level, _motions(moving, bodies, one.trajectory, time_s),
            dict(replay_rays.ranges_of(found, one.trajectory, _nearest(one.trajectory, time_s))),
        )
        for one in telling
    )  # fmt: skip
    tracks = [_tracks(actor, bodies) for actor in actors]
    solid = _solid(scene)
    low, high = replay_rays.widened(*_range(tracks, solid), actors, found)
    ways = np.median([np.max(np.ptp(track, axis=0), axis=0) for track in tracks], axis=0)
    reach = max(map(reach_m, bodies.values()))
    across, is_upright = _lanes(ways, reach)
    width = max(_GAP * float((high - low)[across]), _LANE * float(np.max(ways)))
    free = _FREE * float(np.max(high - low))
    low, high = low - free, high + free
    ground, slanted = _sheets(scene, low, high, across)
    return Replay(
        "replay", "See it move", caption, time_s, bodies, joined([solid, slanted]), ground,
        actors, low, high, across, width,
        # rays fan out: side by side they would be too small to be seen
        is_flat=not found and bool(ways[across] <= _FLAT * reach), is_upright=is_upright,
        eyes=found,
    )  # fmt: skip


def _told(scene: Mapping[str, DrawnBody], trajectory: Trajectory) -> list[str]:
    """Bodies of which a source tells where they are."""
    return [name for name in scene if f"{name}.{POSITION}" in trajectory.signals]


def _times(scene: Mapping[str, DrawnBody], trajectories: Sequence[Trajectory], zones: int) -> Array:
    """Instants of the pictures: enough for what turns, and as many as a page can hold."""
    ends = [trajectory.time_s[[0, -1]] for trajectory in trajectories]
    begin, end = min(first for first, _ in ends), max(last for _, last in ends)
    turned = max(_turned_rad(scene, trajectory) for trajectory in trajectories)
    bodies = sum(len(_told(scene, trajectory)) for trajectory in trajectories)
    wanted = max((end - begin) * _RATE_HZ, turned / _TURN_RAD)
    each = bodies * (_PLACE + _TURN) + len(trajectories) * zones * _RAY
    count = int(min(wanted, _MOST, _BUDGET / each))
    return np.linspace(begin, end, max(count, 2))


def _turned_rad(scene: Mapping[str, DrawnBody], trajectory: Trajectory) -> float:
    """By how much the body that turns most turns in all [rad]."""
    turns = (trajectory.signals.get(f"{name}.{ORIENTATION}") for name in scene)
    return max((float(np.sum(_steps_rad(one))) for one in turns if one is not None), default=0.0)


def _steps_rad(turns: Array) -> Array:
    """Angle from each orientation to the next [rad]."""
    alike = np.abs(np.sum(turns[1:] * turns[:-1], axis=1))
    return np.asarray(2 * np.arccos(np.clip(alike, 0, 1)))


def _motions(
    scene: Mapping[str, DrawnBody],
    bodies: Mapping[str, Mesh],
    trajectory: Trajectory,
    time_s: Array,
) -> dict[str, Motion]:
    """Where the bodies are that a source tells of; at rest where it ended earlier."""
    places, found = _nearest(trajectory, time_s), {}
    for name in _told(scene, trajectory):
        turned = trajectory.signals.get(f"{name}.{ORIENTATION}")
        turns = np.array([scene[name].orientation_wxyz]) if turned is None else turned[places]
        position = trajectory.signals[f"{name}.{POSITION}"][places]
        small_m = _STILL * reach_m(bodies[name])
        found[name] = Motion(_once(position, small_m), _once(turns, _STILL))
    return found


def _nearest(trajectory: Trajectory, time_s: Array) -> Indices:
    """Samples of a source at these instants; the last one where it ended earlier."""
    found = np.searchsorted(trajectory.time_s, time_s)
    return np.asarray(found.clip(0, len(trajectory.time_s) - 1))


def _once(values: Array, small: float) -> Array:
    """A single row where all rows are alike."""
    return values[:1] if np.max(np.abs(values - values[0])) < small else values


def _tracks(actor: Actor, bodies: Mapping[str, Mesh]) -> Array:
    """Where the corners of the boxes about all bodies of a source are, (times, corners, 3) [m]."""
    count = max(
        max(len(motion.position_m), len(motion.orientation_wxyz))
        for motion in actor.motions.values()
    )
    found = []
    for name, motion in actor.motions.items():
        corners = _box(bodies[name])
        turns = np.repeat(motion.orientation_wxyz, len(corners), axis=0)
        each = np.tile(corners, (len(motion.orientation_wxyz), 1))
        turned = rotate(turns, each).reshape(-1, len(corners), 3)
        track = motion.position_m[:, None, :] + turned
        found.append(np.broadcast_to(track, (count, *track.shape[1:])))
    return np.concatenate(found, axis=1)


def _box(mesh: Mesh) -> Array:
    """Corners of the box about a surface."""
    ends = np.array([mesh.corners.min(axis=0), mesh.corners.max(axis=0)])
    return np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i, j, k in np.ndindex(2, 2, 2)])


def _range(tracks: Sequence[Array], solid: Mesh) -> tuple[Array, Array]:
    """Lowest and highest corner; a source that leaves the others is not followed."""
    lows, highs = (
        np.array([end(track, axis=(0, 1)) for track in tracks]) for end in (np.min, np.max)
    )
    low, high = np.median(lows, axis=0), np.median(highs, axis=0)
    away = _AWAY * float(np.max(high - low))
    low, high = np.maximum(lows.min(axis=0), low - away), np.minimum(highs.max(axis=0), high + away)
    if len(solid.corners):
        low = np.minimum(low, solid.corners.min(axis=0))
        high = np.maximum(high, solid.corners.max(axis=0))
    return low, high


def _lanes(ways: Array, reach: float) -> tuple[int, bool]:
    """Along which horizontal axis sources stand side by side, and whether seen from the front.

    What stays in its place, or swings there, stands side by side along its swing; what travels
    goes ahead in lanes.
    """
    least = int(np.argmin(ways[:2]))
    other = 1 - least
    in_place = bool(ways[other] <= _FLAT * reach) and bool(ways[2] >= ways[least])
    return (other, True) if in_place else (least, False)


def _placed(body: DrawnBody, mesh: Mesh) -> Mesh:
    turn = np.tile(body.orientation_wxyz, (len(mesh.corners), 1))
    return replace(mesh, corners=rotate(turn, mesh.corners) + np.array(body.position_m))


def _solid(scene: Mapping[str, DrawnBody]) -> Mesh:
    """What never moves and has an end."""
    return joined(_placed(body, mesh_of(body.shapes)) for body in scene.values() if body.fixed)


def _sheets(
    scene: Mapping[str, DrawnBody], low: Array, high: Array, across: int
) -> tuple[Mesh, Mesh]:
    """Planes as far as the picture goes: those that all lanes share, and the others."""
    shared: list[Mesh] = []
    slanted: list[Mesh] = []
    for place, normal in _planes(scene):
        found = shared if abs(normal[across]) < _STILL else slanted
        found.append(sheet(place, normal, low, high))
    return joined(shared), joined(slanted)


def _planes(scene: Mapping[str, DrawnBody]) -> Iterator[tuple[Array, Array]]:
    """A place on each plane, and its direction."""
    for body in scene.values():
        turn = np.array([body.orientation_wxyz])
        for plane in body.shapes if body.fixed else ():
            if isinstance(plane, Plane):
                place = rotate(turn, np.array([plane.position_m]))[0] + body.position_m
                yield place, rotate(turn, np.array([plane.normal]))[0]
