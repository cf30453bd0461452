"""Physics of bodies that fly and turn freely."""

from __future__ import annotations

import math

import numpy as np

from simcompare.backends.conformance_scenes import (
    STEP_S,
    PhysicsCheck,
    all_near,
    orientations_near,
    physics,
    scene,
    signal,
    turned,
)
from simcompare.model.rotations import conjugate, matrix_of, rotate
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array, Trajectory

#: 30 degrees
_TURN = math.pi / 6
_RATE = 4.0
_SLANTED = (1.0, 2.0, 2.0)


def _flight(name: str, gravity: tuple[float, float, float], **start: object) -> Scenario:
    body = {"mass_kg": 0.3, "inertia_kg_m2": [2e-3] * 3, "position_m": [0.1, 0, 2.0], **start}
    return scene(name, {"body": body}, 0.3, gravity)


def _flies_and_turns(run: Trajectory, scenario: Scenario, axis: tuple[float, float, float]) -> None:
    body, t = scenario.bodies["body"], run.time_s[:, None]
    gravity, velocity = np.array(scenario.world.gravity_m_s2), np.array(body.velocity_m_s)
    # a step uses the velocity of one of its ends, which is g·dt/2 off the mean; twice that
    slack = float(np.linalg.norm(gravity)) * STEP_S
    end_s = float(run.time_s[-1])
    place = np.array(body.position_m) + velocity * t + gravity * t**2 / 2
    all_near("it flies to", signal(run, "body.position_m"), place, slack * end_s, "m")
    # velocities may be stored half a step away from the positions
    fast = velocity + gravity * t
    all_near("its velocity is", signal(run, "body.velocity_m_s"), fast, slack, "m/s")
    # equal moments about all axes: the rate stays, to the rounding of single precision
    rate = np.array(body.rate_rad_s)
    all_near("its rate is", signal(run, "body.rate_rad_s"), rate, 1e-5 * _RATE, "rad/s")
    angles = _TURN + _RATE * run.time_s
    wanted = np.array([turned(angle, axis) for angle in angles])
    # what a quaternion that is integrated as a vector loses: (ω·dt)²/12 in each radian, and half
    # a step where velocities begin half a step late
    slack_rad = _RATE * STEP_S
    got = signal(run, "body.orientation_wxyz")
    orientations_near("it is turned wrongly", got, wanted, slack_rad)


_PLANAR_FLIGHT = _flight(
    "planar_flight",
    (1.5, 0.0, -6.0),
    orientation_wxyz=turned(_TURN).tolist(),
    velocity_m_s=[1.0, 0, 2.0],
    rate_rad_s=[0, _RATE, 0],
)


@physics(_PLANAR_FLIGHT)
def flies_and_turns_in_the_plane(run: Trajectory) -> None:
    """A thrown body follows its parabola and turns at its rate, from a start turned by 30°."""
    _flies_and_turns(run, _PLANAR_FLIGHT, (0.0, 1.0, 0.0))


_SPATIAL_FLIGHT = _flight(
    "spatial_flight",
    (1.5, -2.5, -6.0),
    orientation_wxyz=turned(_TURN, _SLANTED).tolist(),
    velocity_m_s=[1.0, -0.5, 2.0],
    rate_rad_s=(_RATE * np.array(_SLANTED) / 3).tolist(),
)


@physics(_SPATIAL_FLIGHT)
def flies_and_turns_in_space(run: Trajectory) -> None:
    """The same where gravity, throw and axis of the turn have parts along x, y and z."""
    _flies_and_turns(run, _SPATIAL_FLIGHT, _SLANTED)


_MOMENTS = (2e-3, 5e-3, 6e-3)
_TUMBLE = (1.0, 5.0, 1.0)


def _spin(run: Trajectory) -> tuple[Array, Array]:
    """Angular momentum in the world (n, 3) and energy (n,)."""
    turns, rates = signal(run, "body.orientation_wxyz"), signal(run, "body.rate_rad_s")
    inside = rotate(conjugate(turns), rates)
    momentum = rotate(turns, inside * np.array(_MOMENTS))
    return momentum, np.sum(momentum * rates, axis=1) / 2


@physics(
    scene(
        "tumbling",
        {
            "body": {
                "mass_kg": 1.0,
                "inertia_kg_m2": _MOMENTS,
                "orientation_wxyz": turned(_TURN, _SLANTED).tolist(),
                "rate_rad_s": (matrix_of(turned(_TURN, _SLANTED).tolist()) @ _TUMBLE).tolist(),
            }
        },
        0.4,
        (0.0, 0.0, 0.0),
    )
)
def tumbles_with_its_momentum(run: Trajectory) -> None:
    """A body with three different moments tumbles freely: momentum of spin and energy stay."""
    momentum, energy = _spin(run)
    size = math.hypot(*(i * w for i, w in zip(_MOMENTS, _TUMBLE, strict=True)))
    # a method of first order is off by up to ω²·dt for each second; without the gyroscopic term
    # the momentum would be off by more than a third
    slack = float(np.dot(_TUMBLE, _TUMBLE)) * STEP_S * float(run.time_s[-1])
    wanted = np.array(_MOMENTS) * _TUMBLE
    start = matrix_of(turned(_TURN, _SLANTED).tolist()) @ wanted
    all_near("momentum of spin becomes", momentum, start, slack * size, "N·m·s")
    whole = float(wanted @ _TUMBLE) / 2
    all_near("energy becomes", energy, np.array(whole), slack * whole, "J")


CHECKS: tuple[PhysicsCheck, ...] = (
    flies_and_turns_in_the_plane,
    flies_and_turns_in_space,
    tumbles_with_its_momentum,
)
