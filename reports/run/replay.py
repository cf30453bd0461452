"""The replay of a run: all engines beside the truth, at every contact level."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from simcompare.model.drawing import ORIENTATION, POSITION, DrawnBody
from simcompare.model.rotations import rotate
from simcompare.model.settings import DEFAULT, TUNED
from simcompare.model.shapes import Plane
from simcompare.model.trajectory import TRUTH, Array, Trajectory
from simcompare.reports.render.meshes import Mesh, joined, mesh_of, sheet
from simcompare.reports.render.replays import Actor, Motion, Replay, reach_m
from simcompare.reports.render.styles import TRUTH_STYLE
from simcompare.reports.run import runs
from simcompare.reports.run.source_styles import look
from simcompare.results.run import Run

#: pictures in a second, and at most
_RATE_HZ, _MOST = 60.0, 900
#: places of bodies in a page, all together: 0.6 MB
_BUDGET = 24_000
#: a body that turns less than this is drawn as it stood at first
_STILL = 1e-3
#: a source that leaves the others by more than so many times their range leaves the picture
_AWAY = 0.6
#: free space about what moves, and between those side by side, in sizes of it
_FREE, _GAP = 0.05, 1.3
#: what moves less than this part of its own size across may stand side by side
_FLAT = 0.25
#: between those side by side at least this part of the longest way
_LANE = 0.2


def replay_of(run: Run) -> Replay | None:
    """The replay of the nominal repeats; ``None`` where no source tells where a body is."""
    scene = run.record.scene
    found = list(_sources(run))
    moving = {name: body for name, body in scene.items() if not body.fixed}
    if not moving or not found:
        return None
    time_s = _times(run, len(found) * len(moving))
    bodies = {name: mesh_of(body.shapes) for name, body in moving.items()}
    actors = tuple(
        Actor(label, colour, level, motions)
        for label, colour, level, trajectory in found
        if (motions := _motions(moving, trajectory, time_s))
    )
    if not actors:
        return None
    low, high = _range(actors)
    size, ways = max(map(reach_m, bodies.values())), _ways(actors)
    across = int(np.argmin(ways[:2]))
    width = max(_GAP * _size(actors[0], bodies)[across], _LANE * float(np.max(ways)))
    free = size + _FREE * (float(np.max(high - low)) + size)
    below = np.array((free, free, size))  # no deeper than what moves reaches
    low, high = low - below, high + free
    return Replay(
        "replay", "See it move", _caption(run, actors), time_s, bodies, _still(scene, low, high),
        actors, low, high, across, width,
        is_flat=bool(ways[across] < _FLAT * size), is_upright=bool(ways[1 - across] < ways[2]),
    )  # fmt: skip


def _sources(run: Run) -> Iterator[tuple[str, str, str, Trajectory]]:
    """The truth, then every engine at every level: label, colour, words of the level, motion."""
    true = runs.truth(run)
    if true is not None:
        yield f"truth ({TRUTH})", TRUTH_STYLE.colour, "", true
    for mode in sorted(runs.modes(run), key=lambda mode: mode not in (TUNED, DEFAULT)):
        for name in runs.names(run):
            trajectory = runs.nominal(run, name, mode)
            if trajectory is not None:
                yield name, look(run, name).colour, runs.mode_title(mode), trajectory


def _times(run: Run, bodies: int) -> Array:
    """Instants of the pictures, as many as a page can hold."""
    ends = [stored.trajectory.time_s[[0, -1]] for stored in run.trajectories]
    begin, end = min(first for first, _ in ends), max(last for _, last in ends)
    count = int(min((end - begin) * _RATE_HZ, _MOST, _BUDGET / bodies))
    return np.linspace(begin, end, max(count, 2))


def _motions(
    scene: Mapping[str, DrawnBody], trajectory: Trajectory, time_s: Array
) -> dict[str, Motion]:
    """Where the bodies are that a source tells of; at rest where it ended earlier."""
    places = np.searchsorted(trajectory.time_s, time_s).clip(0, len(trajectory.time_s) - 1)
    found = {}
    for name, body in scene.items():
        position = trajectory.signals.get(f"{name}.{POSITION}")
        if position is None:
            continue
        turned = trajectory.signals.get(f"{name}.{ORIENTATION}")
        turns = np.array([body.orientation_wxyz]) if turned is None else turned[places]
        if np.max(np.abs(turns - turns[0])) < _STILL:
            turns = turns[:1]
        found[name] = Motion(position[places], turns)
    return found


def _range(actors: tuple[Actor, ...]) -> tuple[Array, Array]:
    """Lowest and highest place of a body; a source that leaves the others is not followed."""
    ranges = [
        (motion.position_m.min(axis=0), motion.position_m.max(axis=0))
        for actor in actors
        for motion in actor.motions.values()
    ]
    lows, highs = (np.array(side) for side in zip(*ranges, strict=True))
    low, high = np.median(lows, axis=0), np.median(highs, axis=0)
    away = _AWAY * float(np.max(high - low))
    return np.maximum(lows.min(axis=0), low - away), np.minimum(highs.max(axis=0), high + away)


def _still(scene: Mapping[str, DrawnBody], low: Array, high: Array) -> Mesh:
    """What never moves; a plane as far as the picture goes."""
    parts = []
    for body in scene.values():
        if not body.fixed:
            continue
        solid = mesh_of(body.shapes)
        turn = np.array([body.orientation_wxyz])
        planes = [shape for shape in body.shapes if isinstance(shape, Plane)]
        for plane in planes:
            place = rotate(turn, np.array([plane.position_m]))[0] + body.position_m
            parts.append(sheet(place, rotate(turn, np.array([plane.normal]))[0], low, high))
        corners = rotate(np.tile(turn, (len(solid.corners), 1)), solid.corners)
        parts.append(Mesh(corners + np.array(body.position_m), solid.triangles))
    return joined(parts)


def _ways(actors: tuple[Actor, ...]) -> Array:
    """How far along x, y and z a body goes at most, in the middle one of the sources (3,) [m]."""
    ways = [
        np.max([np.ptp(motion.position_m, axis=0) for motion in actor.motions.values()], axis=0)
        for actor in actors
    ]
    return np.asarray(np.median(ways, axis=0))


def _size(actor: Actor, bodies: Mapping[str, Mesh]) -> Array:
    """Size of all bodies together, as they stand at first (3,) [m]."""
    corners = [
        actor.placed(name, mesh, 0).corners
        for name, mesh in bodies.items()
        if name in actor.motions
    ]
    return np.asarray(np.ptp(np.concatenate(corners), axis=0))


def _caption(run: Run, actors: tuple[Actor, ...]) -> str:
    first = next((actor.level for actor in actors if actor.level), "")
    begins = f"Shown first: {first}. " if len(runs.modes(run)) > 1 else ""
    return (
        f"{begins}Play it, slow it down, or draw the time. Side by side is for the eye: every"
        " engine has the whole scene for itself."
    )
