"""Physics of drag, and of what a joint has of its own: springs, dampers, armature, friction."""

from __future__ import annotations

import math

import numpy as np

from simcompare.backends.conformance_scenes import (
    STEP_S,
    PhysicsCheck,
    all_near,
    near,
    orientations_near,
    physics,
    scene,
    signal,
    turned,
)
from simcompare.model.rotations import matrix_of, rotate
from simcompare.model.scenario import Scenario
from simcompare.model.scenes import G_M_S2, Part, joint, pushed
from simcompare.model.trajectory import Array, Trajectory

_TERMINAL_M_S = 2.0
_DOWN = np.array([0.6, 0.0, -0.8])
#: mass [kg], and speed at the start as a multiple of the terminal one
_FALLS = {"slow": (0.2, 0.0), "fast": (0.5, 2.0)}


def _falling(number: int, mass_kg: float, ratio: float) -> Part:
    # m·g = ½·ρ·C_d·A·v² at the terminal speed
    area_m2 = 2 * mass_kg * G_M_S2 / (1.2 * 0.5 * _TERMINAL_M_S**2)
    return {
        "mass_kg": mass_kg,
        "inertia_kg_m2": [1e-3] * 3,
        "position_m": [float(number), 0, 0],
        "velocity_m_s": (ratio * _TERMINAL_M_S * _DOWN).tolist(),
        "drag": {"coefficient": 0.5, "area_m2": area_m2, "air_density_kg_m3": 1.2},
    }


@physics(
    scene(
        "falls_in_air",
        {name: _falling(n, *fall) for n, (name, fall) in enumerate(_FALLS.items())},
        0.3,
        (0.6 * G_M_S2, 0.0, -0.8 * G_M_S2),
    )
)
def air_slows_what_falls(run: Trajectory) -> None:
    """Drag lets a body that falls aslant come to its terminal speed, from below and from above."""
    x = G_M_S2 / _TERMINAL_M_S * run.time_s
    for number, (name, (_, ratio)) in enumerate(_FALLS.items()):
        fast = (np.sinh(x) + ratio * np.cosh(x)) / (np.cosh(x) + ratio * np.sinh(x))
        way = _TERMINAL_M_S**2 / G_M_S2 * np.log(np.cosh(x) + ratio * np.sinh(x))
        # a step uses the speed of one of its ends: the greatest acceleration, for one step
        slack = max(1.0, ratio**2 - 1) * G_M_S2 * STEP_S
        speed = signal(run, f"{name}.velocity_m_s")
        wanted = _TERMINAL_M_S * fast[:, None] * _DOWN
        all_near(f"in air, what falls {name} has a speed of", speed, wanted, slack, "m/s")
        place = np.array([number, 0, 0]) + way[:, None] * _DOWN
        got, far = signal(run, f"{name}.position_m"), slack * float(run.time_s[-1])
        all_near(f"in air, what falls {name} is at", got, place, far, "m")


_OMEGA, _DECAY = 20.0, 4.0
_J_KG_M2, _MASS_KG = 1e-3, 0.5


def _swing(rest: float, time_s: Array) -> Array:
    """Coordinate of a spring that is let go at 0 and is relaxed at ``rest``."""
    omega = math.sqrt(_OMEGA**2 - _DECAY**2)
    wave = np.cos(omega * time_s) + _DECAY / omega * np.sin(omega * time_s)
    return np.asarray(rest * (1 - np.exp(-_DECAY * time_s) * wave))


def _sprung(kind: str, axis: tuple[float, float, float], inertia: float, rest: float) -> Part:
    stiffness, damping = inertia * _OMEGA**2, 2 * inertia * _DECAY
    return joint(kind, "body", axis, stiffness=stiffness, damping=damping, rest=rest)


def _alone(name: str, joint: Part, **parts: object) -> Scenario:
    """A scene of one body that hangs on a fixed frame, without gravity."""
    body = {"mass_kg": _MASS_KG, "inertia_kg_m2": [6e-4, _J_KG_M2, 6e-4]}
    bodies = {"frame": {"fixed": True}, "body": body}
    return scene(name, bodies, 0.4, (0.0, 0.0, 0.0), joints={"joint": joint}, **parts)


def _swings(run: Trajectory, what: str, rest: float, unit: str) -> None:
    wanted = _swing(rest, run.time_s)
    # a step late or early in the swing, doubled: it also covers what a method of first order adds
    # to the decay or takes from it, ω²·dt/2 in 4/s
    slack = 2 * _OMEGA * STEP_S * rest
    all_near(f"a spring moves its {what} to", signal(run, f"joint.{unit}"), wanted, slack, "")


@physics(_alone("sprung_hinge", _sprung("hinge", (0, 1, 0), _J_KG_M2, 0.5)))
def spring_swings_a_hinge(run: Trajectory) -> None:
    """Spring and damper let a hinge swing about its rest with its period, and die away."""
    _swings(run, "hinge", 0.5, "angle_rad")


@physics(_alone("sprung_slider", _sprung("slider", (1, 0, 0), _MASS_KG, 0.05)))
def spring_swings_a_slider(run: Trajectory) -> None:
    """Spring and damper let a slider swing about its rest with its period, and die away."""
    _swings(run, "slider", 0.05, "position_m")


_ARMATURE_KG_M2, _TORQUE_N_M = 1.5e-3, 0.05


@physics(
    _alone(
        "motor_with_rotor",
        joint("hinge", "body", (0, 1, 0), armature=_ARMATURE_KG_M2),
        **pushed("joint", _TORQUE_N_M),
    )
)
def armature_resists_a_motor(run: Trajectory) -> None:
    """A torque turns a hinge by τ/(J + armature)."""
    change = _TORQUE_N_M / (_J_KG_M2 + _ARMATURE_KG_M2)
    # first order in the step, doubled
    slack = change * STEP_S
    rate = signal(run, "joint.rate_rad_s")
    all_near("a motor with armature runs at", rate, change * run.time_s, slack, "rad/s")


_RUBS_N, _SPEED_M_S = 3.0, 1.0
_CART = {"mass_kg": _MASS_KG, "inertia_kg_m2": [1e-3] * 3}


def _rail(child: str, x: float, rate: float = 0.0) -> Part:
    more = {"anchor_m": [x, 0, 0], "friction": _RUBS_N, "rate": rate}
    return joint("slider", child, (1, 0, 0), **more)


@physics(
    scene(
        "rubbing_sliders",
        {"frame": {"fixed": True}, "coasting": _CART, "held": {**_CART, "position_m": [2, 0, 0]}},
        0.3,
        joints={"stops": _rail("coasting", 0.0, _SPEED_M_S), "holds": _rail("held", 2.0)},
        **pushed("holds", 0.8 * _RUBS_N, "force"),
    )
)
def friction_stops_a_slider(run: Trajectory) -> None:
    """Friction of a slider brakes it by F/m until it stands, and holds it against a weak push."""
    t, brake = run.time_s, _RUBS_N / _MASS_KG
    # two steps late or early, and 1 % for what is soft
    slack = 2 * brake * STEP_S + 0.01 * _SPEED_M_S
    speed = np.maximum(_SPEED_M_S - brake * t, 0.0)
    all_near("a slider that rubs has", signal(run, "stops.velocity_m_s"), speed, slack, "m/s")
    way = _SPEED_M_S**2 / (2 * brake)
    slid = float(signal(run, "stops.position_m")[-1])
    near("a slider that rubs stops after", slid, way, 0.02 * way, "m")
    # a soft friction creeps: by less than a thousandth of what the push does alone
    free = 0.8 * brake * float(t[-1]) ** 2 / 2
    held = signal(run, "holds.position_m")
    all_near("a slider that is held moves to", held, np.zeros(1), 1e-3 * free, "m")


_LEAN, _RATE = -0.4, 6.0
_FRAME_AT, _ANCHOR = np.array([0.2, 0.0, 1.0]), np.array([0.15, 0.0, 0.08])
_PIVOT = _FRAME_AT + matrix_of(turned(_LEAN).tolist()) @ _ANCHOR
_ARM = np.array([0.05, 0.0, -0.06])


@physics(
    scene(
        "hinge_aside",
        {
            "frame": {
                "fixed": True,
                "position_m": _FRAME_AT.tolist(),
                "orientation_wxyz": turned(_LEAN).tolist(),
            },
            "lever": {
                "mass_kg": 0.2,
                "inertia_kg_m2": [1e-3] * 3,
                "position_m": (_PIVOT + _ARM).tolist(),
            },
        },
        0.3,
        (0.0, 0.0, 0.0),
        joints={"hinge": joint("hinge", "lever", (0, 1, 0), anchor_m=_ANCHOR.tolist(), rate=_RATE)},
    )
)
def hinge_turns_about_its_anchor(run: Trajectory) -> None:
    """A lever circles about the anchor of its hinge, which its turned parent has aside of both."""
    turns = np.array([turned(_RATE * one) for one in run.time_s])
    # a step late or early, doubled
    slack_rad = 2 * _RATE * STEP_S
    got = signal(run, "lever.orientation_wxyz")
    orientations_near("a lever is turned wrongly", got, turns, slack_rad)
    place = _PIVOT + rotate(turns, np.tile(_ARM, (len(turns), 1)))
    far, centre = slack_rad * float(np.linalg.norm(_ARM)), signal(run, "lever.position_m")
    all_near("a lever that circles is at", centre, place, far, "m")


CHECKS: tuple[PhysicsCheck, ...] = (
    air_slows_what_falls,
    spring_swings_a_hinge,
    spring_swings_a_slider,
    armature_resists_a_motor,
    friction_stops_a_slider,
    hinge_turns_about_its_anchor,
)
