"""Physics of shapes: what rests on a plane does so at its own height, and a plane lies anywhere.

All bodies begin a little above their plane. One that begins in it, since its shape is too large or
the plane too high, could stay there in an engine that does not push bodies out of each other.
"""

from __future__ import annotations

import math

import numpy as np

from simcompare.backends.conformance_scenes import (
    STEP_S,
    PhysicsCheck,
    all_near,
    box,
    floor,
    orientations_near,
    physics,
    scene,
    signal,
    turned,
)
from simcompare.model.rotations import matrix_of
from simcompare.model.scenario import Scenario
from simcompare.model.scenes import G_M_S2, Part, Parts
from simcompare.model.trajectory import Array, Trajectory

_X, _Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
_QUARTER = math.pi / 2
#: how high above their plane bodies begin, and when they have settled on it
_DROP_M, _SETTLED_S = 0.002, 0.1
#: what one step goes deep may stay, where an engine does not push bodies out of each other, and
#: springs give way by 0.02 mm (measured); a body that does not come down is off by all of its drop
_SINKS_M = math.sqrt(2 * G_M_S2 * _DROP_M) * STEP_S + 1e-4
#: an engine that finds one point of a contact in a step lets one corner land before the others:
#: 8 mrad (measured); a shape that is turned wrongly falls over, or hits with an edge
_LEANS = 0.01

_SIZE_M = (0.1, 0.14, 0.06)
_ROUND_M, _LONG_M = 0.03, 0.1


def _at_rest(name: str, bodies: Parts) -> Scenario:
    """Bodies in a row that come down on the floor, drawn at the height at which they rest."""
    row = {}
    for number, (one, body) in enumerate(bodies.items()):
        x, y, z = body["position_m"]
        row[one] = {**body, "position_m": [x + number, y, z + _DROP_M]}
    contacts = [{"pair": [one, "floor"], "friction": 0.6} for one in bodies]
    return scene(name, {"floor": floor(), **row}, 0.25, contacts=contacts)


def _rests(run: Trajectory, scenario: Scenario) -> None:
    """All moving bodies come down as they were drawn, and stay there."""
    for name, body in scenario.moving_bodies().items():
        place = np.array(body.position_m) - [0, 0, _DROP_M]
        got = signal(run, f"{name}.position_m")[run.time_s > _SETTLED_S]
        all_near(f"at rest, the one {name} is at", got, place, _SINKS_M, "m")
        turn, got = np.array([body.orientation_wxyz]), signal(run, f"{name}.orientation_wxyz")
        orientations_near(f"at rest, the one {name} leans", got, turn, _LEANS)


def _side(height_m: float, angle_rad: float, axis: tuple[float, float, float]) -> Part:
    turn = turned(angle_rad, axis).tolist()
    return box(0.4, _SIZE_M, position_m=[0, 0, height_m], orientation_wxyz=turn)


_SIDES = _at_rest(
    "sides",
    {"flat": _side(_SIZE_M[2] / 2, 0.0, _Y), "upright": _side(_SIZE_M[0] / 2, _QUARTER, _Y)},
)


@physics(_SIDES)
def boxes_rest_on_their_sides(run: Trajectory) -> None:
    """A box rests at half of its edge along z, and of that along x where it is turned about y."""
    _rests(run, _SIDES)


_EDGEWISE = _at_rest("edgewise", {"edgewise": _side(_SIZE_M[1] / 2, _QUARTER, _X)})


@physics(_EDGEWISE)
def boxes_rest_edgewise(run: Trajectory) -> None:
    """A box that is turned about x rests at half of its edge along y."""
    _rests(run, _EDGEWISE)


def _rod(kind: str, height_m: float, **turns: Array) -> Part:
    """A rod along z, of which the body is turned, or the shape within it."""
    shape = {"type": kind, "radius_m": _ROUND_M, "length_m": _LONG_M}
    if "shape" in turns:
        shape["orientation_wxyz"] = turns["shape"].tolist()
    across, along = 0.4 * (3 * _ROUND_M**2 + _LONG_M**2) / 12, 0.4 * _ROUND_M**2 / 2
    return {
        "mass_kg": 0.4,
        # of a cylinder; about x where the shape is turned so that it lies along x
        "inertia_kg_m2": [along, across, across] if "shape" in turns else [across, across, along],
        "position_m": [0, 0, height_m],
        "orientation_wxyz": turns.get("body", turned(0.0)).tolist(),
        "shapes": [shape],
    }


_CYLINDERS = _at_rest(
    "cylinders",
    {
        "standing": _rod("cylinder", _LONG_M / 2),
        "lying": _rod("cylinder", _ROUND_M, body=turned(_QUARTER, _X)),
        "laid": _rod("cylinder", _ROUND_M, shape=turned(_QUARTER, _Y)),
    },
)


@physics(_CYLINDERS)
def cylinders_stand_and_lie(run: Trajectory) -> None:
    """A cylinder stands at half its length, and lies at its radius, turned itself or its shape."""
    _rests(run, _CYLINDERS)


_CAPSULES = _at_rest(
    "capsules",
    {
        "standing": _rod("capsule", _LONG_M / 2 + _ROUND_M),
        "lying": _rod("capsule", _ROUND_M, body=turned(_QUARTER, _X)),
        "laid": _rod("capsule", _ROUND_M, shape=turned(_QUARTER, _Y)),
    },
)


@physics(_CAPSULES)
def capsules_stand_and_lie(run: Trajectory) -> None:
    """A capsule stands at half its length and a radius more, and lies at its radius."""
    _rests(run, _CAPSULES)


#: where a shape is in its body, which is turned the other way so that the shape lies flat
_TURN, _OFFSET = math.pi / 6, (0.02, 0.0, 0.03)
_ASIDE = matrix_of(turned(-_TURN).tolist()) @ _OFFSET
_SHIFTED = _at_rest(
    "shifted",
    {
        "shifted": {
            "mass_kg": 0.4,
            "inertia_kg_m2": [1e-3] * 3,
            "position_m": [0, 0, float(_SIZE_M[2] / 2 - _ASIDE[2])],
            "orientation_wxyz": turned(-_TURN).tolist(),
            "shapes": [
                {
                    "type": "box",
                    "size_m": _SIZE_M,
                    "position_m": _OFFSET,
                    "orientation_wxyz": turned(_TURN).tolist(),
                }
            ],
        }
    },
)


@physics(_SHIFTED)
def shapes_are_where_their_body_has_them(run: Trajectory) -> None:
    """A box that is shifted and turned in its body rests as it lies there."""
    _rests(run, _SHIFTED)


_FLAT_M = (0.12, 0.12, 0.03)
_GROUND_M, _ON_PLANE_M = (0.3, 0.0, -0.2), (0.1, 0.0, 0.15)


def _slope(
    name: str, turn: Array, normal: tuple[float, float, float]
) -> tuple[Scenario, Array, Array]:
    """A block that comes down on a plane, in a body that is moved and turned.

    The plane's normal is given three times as long as a direction is.

    Returns:
        Scene, where the block would begin on the plane, and its acceleration along it.
    """
    long = [3 * part for part in normal]
    plane = {"type": "plane", "position_m": _ON_PLANE_M, "normal": long}
    ground = {"position_m": _GROUND_M, "orientation_wxyz": turn.tolist()}
    frame = matrix_of(turn.tolist())
    up = frame @ normal
    # the block is turned by the least turn that brings z to the normal
    lean = turned(math.acos(up[2]), tuple(np.cross([0, 0, 1], up)))
    place: Array = _GROUND_M + frame @ _ON_PLANE_M + up * _FLAT_M[2] / 2
    above = (place + up * _DROP_M).tolist()
    block = box(0.5, _FLAT_M, position_m=above, orientation_wxyz=lean.tolist())
    bodies = {"ground": {"fixed": True, "shapes": [plane], **ground}, "block": block}
    down = np.array([0, 0, -G_M_S2])
    contacts = [{"pair": ["block", "ground"]}]
    return scene(name, bodies, 0.25, contacts=contacts), place, down - (down @ up) * up


def _slides(run: Trajectory, scenario: Scenario, start: Array, change: Array) -> None:
    down = run.time_s > _SETTLED_S
    place = start + change * run.time_s[down, None] ** 2 / 2
    # first order in the step, doubled, and what a contact gives way
    end_s = float(run.time_s[-1])
    slack = float(np.linalg.norm(change)) * STEP_S * end_s + _SINKS_M
    got = signal(run, "block.position_m")[down]
    all_near("a block that slides down a plane is at", got, place, slack, "m")
    turn = np.array([scenario.bodies["block"].orientation_wxyz])
    got = signal(run, "block.orientation_wxyz")
    orientations_near("a block that slides down a plane leans", got, turn, _LEANS)


_SLOPE, *_DOWNHILL = _slope("slope", turned(-0.2), (0.6, 0.0, 0.8))


@physics(_SLOPE)
def block_slides_down_a_plane(run: Trajectory) -> None:
    """Without friction a block slides by g·sin α along a plane that is moved and tilted."""
    _slides(run, _SLOPE, *_DOWNHILL)


_HILLSIDE, *_ASLANT = _slope("hillside", turned(0.3, (1.0, 2.0, 2.0)), (0.0, -0.6, 0.8))


@physics(_HILLSIDE)
def block_slides_down_a_hillside(run: Trajectory) -> None:
    """The same on a plane that is tilted in its body about x, and with it about all axes."""
    _slides(run, _HILLSIDE, *_ASLANT)


CHECKS: tuple[PhysicsCheck, ...] = (
    boxes_rest_on_their_sides,
    boxes_rest_edgewise,
    cylinders_stand_and_lie,
    capsules_stand_and_lie,
    shapes_are_where_their_body_has_them,
    block_slides_down_a_plane,
    block_slides_down_a_hillside,
)
