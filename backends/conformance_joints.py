"""Physics of joints that are driven, that are loaded, and that rub."""

from __future__ import annotations

import math

import numpy as np

from simcompare.backends.conformance_scenes import (
    STEP_S,
    PhysicsCheck,
    all_near,
    box_moments,
    near,
    orientations_near,
    physics,
    scene,
    signal,
    turned,
)
from simcompare.model.rotations import matrix_of, multiply, rotate
from simcompare.model.scenes import G_M_S2, Part, joint, pushed
from simcompare.model.trajectory import Trajectory

#: 30 and -20 degrees
_TURN, _LEAN = math.pi / 6, -math.pi / 9
_SLANTED = (1.0, 2.0, 2.0)
_FRAME = {"fixed": True, "position_m": [0.2, 0, 1.0], "orientation_wxyz": turned(_LEAN).tolist()}
_PUSH_N, _MASS_KG = 3.0, 0.5


@physics(
    scene(
        "pushed_slider",
        {
            "frame": _FRAME,
            "cart": {
                "mass_kg": _MASS_KG,
                "inertia_kg_m2": [1e-3] * 3,
                "position_m": [0.2, 0, 1.0],
                "orientation_wxyz": turned(_LEAN).tolist(),
            },
        },
        0.3,
        joints={"rail": joint("slider", "cart", (1, 0, 0))},
        **pushed("rail", _PUSH_N / 2, "force", gear=2.0),
    )
)
def slider_goes_where_it_is_pushed(run: Trajectory) -> None:
    """A force moves a slider along its leaning axis by (F/m + g along it)·t²/2."""
    # the axis x of a frame that is turned about y points downwards by the sine of the angle
    along = np.array([math.cos(_LEAN), 0.0, -math.sin(_LEAN)])
    change = _PUSH_N / _MASS_KG - G_M_S2 * along[2]
    t, end_s = run.time_s, float(run.time_s[-1])
    # first order in the step, doubled
    slack = change * STEP_S
    way = change * t**2 / 2
    all_near("the slider moves to", signal(run, "rail.position_m"), way, slack * end_s, "m")
    all_near("its velocity is", signal(run, "rail.velocity_m_s"), change * t, slack, "m/s")
    place = np.array([0.2, 0.0, 1.0]) + way[:, None] * along
    all_near("its body is at", signal(run, "cart.position_m"), place, slack * end_s, "m")
    force = signal(run, "motor.force_N")
    all_near("the recorded force is", force, np.array(_PUSH_N), 1e-6 * _PUSH_N, "N")


_ARM_M, _SPIN, _TORQUE_N_M, _LEVER_KG = 0.1, 8.0, 0.3, 0.2
_LEVER_MOMENTS = box_moments(_LEVER_KG, (0.3, 0.02, 0.05))
_LEVER_START = np.array([0.2, 0, 1.0]) + _ARM_M * np.array([math.cos(_TURN), 0.0, -math.sin(_TURN)])


@physics(
    scene(
        "pushed_hinge",
        {
            "frame": _FRAME,
            "lever": {
                "mass_kg": _LEVER_KG,
                "inertia_kg_m2": _LEVER_MOMENTS,
                "position_m": _LEVER_START.tolist(),
                "orientation_wxyz": turned(_TURN).tolist(),
            },
        },
        0.4,
        (0.0, 0.0, 0.0),
        joints={"hinge": joint("hinge", "lever", (0, 1, 0), rate=_SPIN)},
        **pushed("hinge", _TORQUE_N_M),
    )
)
def hinge_turns_as_it_is_pushed(run: Trajectory) -> None:
    """A torque turns a lever, drawn at 30°, by ω·t + τ/(I + m·r²)·t²/2, past whole turns."""
    change = _TORQUE_N_M / (_LEVER_MOMENTS[1] + _LEVER_KG * _ARM_M**2)
    t, end_s = run.time_s, float(run.time_s[-1])
    angle, rate = _SPIN * t + change * t**2 / 2, _SPIN + change * t
    # first order in the step, doubled; a thousandth is for joints that give way
    slack_rate = change * STEP_S + 1e-3 * float(rate[-1])
    slack_rad = slack_rate * end_s
    all_near("the hinge turns to", signal(run, "hinge.angle_rad"), angle, slack_rad, "rad")
    all_near("its rate is", signal(run, "hinge.rate_rad_s"), rate, slack_rate, "rad/s")
    wanted = np.array([turned(_TURN + one) for one in angle])
    got = signal(run, "lever.orientation_wxyz")
    orientations_near("its body is turned otherwise than the hinge", got, wanted, slack_rad)
    place = np.array([0.2, 0, 1.0]) + rotate(wanted, np.tile([_ARM_M, 0, 0], (len(t), 1)))
    centre = signal(run, "lever.position_m")
    all_near("its body is at", centre, place, slack_rad * _ARM_M, "m")


_SKEW = turned(0.5, (2.0, -1.0, 1.0))


@physics(
    scene(
        "skew_hinge",
        {
            "frame": {"fixed": True, "orientation_wxyz": _SKEW.tolist()},
            "rotor": {
                "mass_kg": 0.2,
                "inertia_kg_m2": [1e-3] * 3,
                "orientation_wxyz": turned(_TURN, _SLANTED).tolist(),
            },
        },
        0.3,
        joints={"hinge": joint("hinge", "rotor", _SLANTED)},
        **pushed("hinge", 0.05),
    )
)
def hinge_has_its_axis_in_the_parents_frame(run: Trajectory) -> None:
    """A rotor turns about the axis as its turned parent has it, from its own start on."""
    t, change = run.time_s, 0.05 / 1e-3
    angle = change * t**2 / 2
    slack = change * STEP_S * float(t[-1])  # first order in the step, doubled
    all_near("the hinge turns to", signal(run, "hinge.angle_rad"), angle, slack, "rad")
    axis = matrix_of(_SKEW.tolist()) @ _SLANTED
    turns = np.array([turned(one, tuple(axis)) for one in angle])
    wanted = multiply(turns, np.tile(turned(_TURN, _SLANTED), (len(t), 1)))
    got = signal(run, "rotor.orientation_wxyz")
    orientations_near("its body turns about another axis", got, wanted, slack)
    rates = (change * t)[:, None] * axis / np.linalg.norm(axis)
    got, slack = signal(run, "rotor.rate_rad_s"), 2 * change * STEP_S
    all_near("the body's rate is", got, rates, slack, "rad/s")


_LOAD_KG = 0.7


@physics(
    scene(
        "weld",
        {
            "frame": _FRAME,
            "load": {
                "mass_kg": _LOAD_KG,
                "inertia_kg_m2": [1e-3, 2e-3, 2.5e-3],
                "position_m": [0.3, 0, 0.9],
                "orientation_wxyz": turned(_TURN).tolist(),
            },
        },
        0.1,
        (2.0, 0.0, -G_M_S2),
        joints={"weld": {"type": "fixed", "parent": "frame", "child": "load"}},
        sensors={"gauge": {"type": "force", "joint": "weld"}},
    )
)
def weld_bears_the_weight(run: Trajectory) -> None:
    """A force sensor in a weld reads the force that holds the load up, in the load's frame."""
    wanted = matrix_of(turned(_TURN).tolist()).T @ (-_LOAD_KG * np.array([2.0, 0.0, -G_M_S2]))
    # at rest nothing is lost in a step: a thousandth is for solvers that stop before
    slack = 1e-3 * _LOAD_KG * G_M_S2
    all_near("the weld bears", signal(run, "gauge.force_N")[5:], wanted, slack, "N")
    held = signal(run, "load.position_m")
    all_near("the load hangs at", held, np.array([0.3, 0.0, 0.9]), 1e-5, "m")


_ROTOR_KG_M2 = 1e-3
_ROTOR = {"mass_kg": 0.1, "inertia_kg_m2": [6e-4, _ROTOR_KG_M2, 6e-4]}
_HOLDS_N_M = 0.05
_RUNS_N_M = 0.09


def _bearing(child: str, x_m: float = 0.0, rate: float = 0.0) -> Part:
    more = {"anchor_m": [x_m, 0, 0], "friction": _HOLDS_N_M, "rate": rate}
    return joint("hinge", child, (0, 1, 0), **more)


@physics(
    scene(
        "motor_and_friction",
        {
            "frame": {"fixed": True},
            "held": _ROTOR,
            "driven": {**_ROTOR, "position_m": [1.0, 0, 0]},
            "coasting": {**_ROTOR, "position_m": [2.0, 0, 0]},
        },
        0.3,
        (0.0, 0.0, 0.0),
        joints={
            "holds": _bearing("held"),
            "runs": _bearing("driven", 1.0),
            "stops": _bearing("coasting", 2.0, rate=10.0),
        },
        inputs={
            "weak": {"signal": "constant", "value": 0.8 * _HOLDS_N_M},
            "strong": {"signal": "constant", "value": _RUNS_N_M},
        },
        actuators={
            "weak_motor": {"type": "torque", "joint": "holds", "input": "weak"},
            "strong_motor": {"type": "torque", "joint": "runs", "input": "strong"},
        },
    )
)
def motor_works_against_friction(run: Trajectory) -> None:
    """Friction of a joint holds a weak motor, brakes a strong one, and stops what coasts."""
    t, end_s = run.time_s, float(run.time_s[-1])
    # a soft friction creeps while it holds: by less than a thousandth of what the torque does alone
    free = 0.8 * _HOLDS_N_M / _ROTOR_KG_M2 * end_s**2 / 2
    held = signal(run, "holds.angle_rad")
    all_near("the weak motor turns to", held, np.zeros(1), 1e-3 * free, "rad")
    change = (_RUNS_N_M - _HOLDS_N_M) / _ROTOR_KG_M2
    # two steps late or early, and 1 % for what is soft
    slack = 2 * (_RUNS_N_M + _HOLDS_N_M) / _ROTOR_KG_M2 * STEP_S + 0.01 * change * end_s
    driven = signal(run, "runs.rate_rad_s")
    all_near("the strong motor's rate is", driven, change * t, slack, "rad/s")
    brake = _HOLDS_N_M / _ROTOR_KG_M2
    way = 10.0**2 / (2 * brake)
    rate = np.maximum(10.0 - brake * t, 0.0)
    slack = 2 * brake * STEP_S + 0.01 * 10
    all_near("the coasting rotor's rate is", signal(run, "stops.rate_rad_s"), rate, slack, "rad/s")
    coasted = float(signal(run, "stops.angle_rad")[-1])
    near("the coasting rotor stops after", coasted, way, 0.02 * way, "rad")


CHECKS: tuple[PhysicsCheck, ...] = (
    slider_goes_where_it_is_pushed,
    hinge_turns_as_it_is_pushed,
    hinge_has_its_axis_in_the_parents_frame,
    weld_bears_the_weight,
    motor_works_against_friction,
)
