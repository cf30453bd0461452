"""Rays of range sensors: they begin where it is, go where it looks, and stop where they hit.

The sensor flies, turned aslant, before things that have no symmetry, so that a picture that is
mirrored, or upside down, is another one. What it should read is worked out from the motion itself.
"""

from __future__ import annotations

import numpy as np

from simcompare.backends.conformance_scenes import PhysicsCheck, box, floor, physics, scene, signal
from simcompare.backends.conformance_scenes import turned as turn
from simcompare.engine.range_sensing import ranges, zone_rays
from simcompare.model.scenario import Scenario
from simcompare.model.scenes import Part, Parts
from simcompare.model.trajectory import Array, Trajectory

#: flat faces, also in single precision, in which places of a metre are rounded to 1e-7 m
_FLAT_M = 1e-5
#: round shapes: Bullet's iteration stops up to 8 mm beside them (measured)
_ROUND_M = 0.01
#: rays this close to a rim may miss it
_RIM_RAD = 0.02


def _view(name: str, things: Parts, lean_rad: float) -> Scenario:
    carrier = box(
        0.3, (0.2, 0.1, 0.1), position_m=[0, 0, 0.5], velocity_m_s=[2.0, 0.5, 0],
        orientation_wxyz=turn(0.2, (0, 0, 1)).tolist(),
    )  # fmt: skip
    sensor = {
        "type": "time_of_flight", "body": "carrier", "zones": 8, "position_m": [0.08, 0.02, 0.01],
        "orientation_wxyz": turn(lean_rad, (0, 1, 0)).tolist(),
    }  # fmt: skip
    bodies: Parts = {"carrier": carrier, **things}
    return scene(name, bodies, 0.02, gravity_m_s2=(0.0, 0.0, 0.0), sensors={"eye": sensor})


def _fixed(shape: dict[str, object], place: tuple[float, float, float], angle: float = 0.0) -> Part:
    return {
        "fixed": True, "shapes": [shape], "position_m": place,
        "orientation_wxyz": turn(angle, (1, 2, 3)).tolist(),
    }  # fmt: skip


_WALL = _view(
    "wall",
    {
        "floor": floor(),
        "wall": _fixed(
            {"type": "box", "size_m": [0.2, 9.0, 9.0], "position_m": [0.1, 0, 0]}, (1.5, 0, 0), 0.3
        ),
    },
    0.25,
)


@physics(_WALL)
def range_sensor_sees_a_floor_and_a_wall(run: Trajectory) -> None:
    """A range sensor that flies reads how far a floor and a leaning wall are along its axis."""
    seen, wanted = signal(run, "eye.range_m"), _wanted(_WALL, run)
    worst = np.unravel_index(np.argmax(np.abs(seen - wanted)), seen.shape)
    _near("a floor or wall", worst, seen, wanted, _FLAT_M)


_THINGS = _view(
    "things",
    {
        "ball": _fixed({"type": "sphere", "radius_m": 0.2}, (1.0, 0.45, 0.8)),
        "tin": _fixed({"type": "cylinder", "radius_m": 0.2, "length_m": 0.6}, (1.1, 0, 0.3), 0.2),
        "pill": _fixed({"type": "capsule", "radius_m": 0.2, "length_m": 0.5}, (1.6, 0.5, 0.3), 0.4),
    },
    0.0,
)


@physics(_THINGS)
def range_sensor_sees_round_things(run: Trajectory) -> None:
    """A range sensor reads how far balls, cylinders and capsules are, and its reach beside them."""
    seen, wanted = signal(run, "eye.range_m"), _wanted(_THINGS, run)
    # as it would read turned a little each way: where that is much else, there is a rim or nearly
    eye, slope = _THINGS.sensors["eye"], np.zeros(wanted.shape)
    for axis in np.vstack((np.eye(3), -np.eye(3))):
        aside = eye.model_copy(update={"orientation_wxyz": tuple(turn(_RIM_RAD, axis).tolist())})
        other = ranges(_THINGS, aside, run.time_s, run.signals)
        slope = np.maximum(slope, np.abs(other - wanted))
    off = np.where(slope < 0.1, np.abs(seen - wanted), 0.0)
    worst = np.unravel_index(np.argmax(off), seen.shape)
    _near("round things", worst, seen, wanted, _ROUND_M)


def _wanted(scenario: Scenario, run: Trajectory) -> Array:
    return ranges(scenario, scenario.sensors["eye"], run.time_s, run.signals)


def _near(what: str, place: tuple[np.intp, ...], seen: Array, wanted: Array, off_m: float) -> None:
    got, true, zone = float(seen[place]), float(wanted[place]), int(place[1])
    assert abs(got - true) <= off_m, (
        f"a range sensor that looks at {what} reads {got:.6g} m in zone {zone} for {true:.6g} m"
        f" (± {off_m:.2g}), where the ray is {np.linalg.norm(zone_rays(8)[zone, 0]):.4g} times as"
        " long"
    )


CHECKS: tuple[PhysicsCheck, ...] = (
    range_sensor_sees_a_floor_and_a_wall,
    range_sensor_sees_round_things,
)
