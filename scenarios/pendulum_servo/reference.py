"""Motion of a pendulum that is held by a position servo with a proportional gain.

The voltage at the motor is U = p·(goal - angle), its current (U - k·θ̇)/R, its torque at the hinge k
times that. With θ from hanging, z what the sensor reads there and K = k·p/R,

    J·θ̈ = K·(goal - z) - m·g·l·sin θ - K·θ - (k²/R + b)·θ̇ - c·sgn θ̇

which is the equation of a pendulum under a torque with a spring; see that scenario's reference for
how it is integrated. The winding's inductance is left out, and nothing limits the voltage.
"""

from __future__ import annotations

from collections.abc import Mapping

from simcompare.model.signals import Signal
from simcompare.model.trajectory import Array
from simcompare.scenarios.pendulum_torque.reference import Pendulum, motion


def pendulum_of(parameters: Mapping[str, float]) -> Pendulum:
    """The equation of motion of the pendulum with its servo; its input is the goal."""
    mass, length = parameters["mass_kg"], parameters["length_m"]
    constant = parameters["torque_constant_N_m_A"]
    stiffness = constant * parameters["gain_V_rad"] / parameters["resistance_Ohm"]
    return Pendulum(
        inertia=mass * length**2 + parameters["inertia_kg_m2"] + parameters["rotor_inertia_kg_m2"],
        weight=mass * length * parameters["gravity_m_s2"],
        damping=constant**2 / parameters["resistance_Ohm"] + parameters["damping_N_m_s_rad"],
        friction=parameters["friction_N_m"],
        gain=stiffness,
        stiffness=stiffness,
        constant=-stiffness * parameters["zero_rad"],
    )


def reference(
    parameters: Mapping[str, float], time_s: Array, inputs: Mapping[str, Signal]
) -> dict[str, Array]:
    """Motion of the pendulum at the given times.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,), increasing [s].
        inputs: ``goal``, in the angle that the sensor reads.

    Returns:
        Coordinate (from the start angle) and rate of the hinge (n,).
    """
    hangs = parameters["start_angle_rad"] - parameters["zero_rad"]
    start = (hangs, parameters["start_rate_rad_s"])
    angle, rate = motion(pendulum_of(parameters), start, time_s, inputs["goal"])
    return {"hinge.angle_rad": angle - hangs, "hinge.rate_rad_s": rate}
