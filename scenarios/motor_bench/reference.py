"""Closed form of a motor that runs up and is braked evenly.

At the voltage V the motor gives k·i = k·(V - k·ω)/R, so its speed follows J·ω̇ = c - D·ω - τ_b with
c = k·V/R - τ_c and D = k²/R + b. Where the torque of the brake is a straight line, τ_b = a + s·t,
the solution is a straight line too, w(t) = (c - a)/D + J·s/D² - s·t/D, and what is left of the
start, (ω(0) - w(0))·exp(-D·t/J). The arm stands still, for the scale carries τ_b/lever and
half of its weight.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from simcompare.errors import InputError
from simcompare.model.trajectory import Array


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion of the bench and what is read on it at the given times.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from switching on (n,) [s].

    Returns:
        Angles and rates of both joints, voltage, current and torque of the motor, force on the
        scale, marks of the encoder, each (n,).

    Raises:
        InputError: the motor cannot overcome its own friction.
    """
    angle, rate = motion(parameters, time_s)
    lever = parameters["lever_m"]
    k, voltage = parameters["torque_constant_N_m_A"], parameters["voltage_V"]
    current = (voltage - k * rate) / parameters["resistance_Ohm"]
    return {
        "shaft.angle_rad": angle,
        "shaft.rate_rad_s": rate,
        "band.angle_rad": -angle,
        "band.rate_rad_s": -rate,
        "motor.voltage_V": np.full(len(time_s), voltage),
        "motor.current_A": current,
        "motor.torque_N_m": k * current,
        # a mark that is reached to within rounding has passed
        "encoder.marks": np.floor(angle * parameters["marks"] / (2 * math.pi) + 1e-9),
        "scale.normal_force_N": tare(parameters) + brake_torque(parameters, time_s) / lever,
    }


def constants(parameters: Mapping[str, float]) -> tuple[float, float]:
    """Torque c at standstill [N·m] and its fall with speed D [N·m·s/rad]."""
    k, resistance = parameters["torque_constant_N_m_A"], parameters["resistance_Ohm"]
    standstill = k * parameters["voltage_V"] / resistance - parameters["friction_N_m"]
    if standstill <= 0:
        fault = (
            f"the motor does not start: {parameters['voltage_V']:g} V at {resistance:g} Ω give it"
            f" {k * parameters['voltage_V'] / resistance:.3g} N·m, and its friction_N_m is"
            f" {parameters['friction_N_m']:g}; use more voltage_V or less of the others"
        )
        raise InputError("parameters of motor_bench", [fault])
    return standstill, k * k / resistance + parameters["damping_N_m_s_rad"]


def tare(parameters: Mapping[str, float]) -> float:
    """Force on the scale without the brake [N]: half of a rod's weight rests on its far end."""
    return parameters["arm_mass_kg"] * parameters["gravity_m_s2"] / 2


def brake_torque(parameters: Mapping[str, float], time_s: Array) -> Array:
    """Torque of the brake [N·m] at the given times (n,)."""
    part = np.clip((time_s - parameters["run_up_s"]) / parameters["ramp_s"], 0.0, 1.0)
    return np.asarray(parameters["brake_part"] * constants(parameters)[0] * part, dtype=float)


def motion(parameters: Mapping[str, float], time_s: Array) -> tuple[Array, Array]:
    """Angle [rad] and rate [rad/s] of the shaft at the given times (n,)."""
    standstill, fall = constants(parameters)
    run_up, ramp = parameters["run_up_s"], parameters["ramp_s"]
    end = parameters["brake_part"] * standstill
    pieces = ((0.0, run_up, 0.0, 0.0), (run_up, run_up + ramp, 0.0, end / ramp),
              (run_up + ramp, math.inf, end, 0.0))  # fmt: skip
    angle, rate = np.zeros(len(time_s)), np.zeros(len(time_s))
    angle_before, rate_before = 0.0, 0.0
    for start, stop, brake, slope in pieces:
        coefficients = (standstill - brake, fall, slope, parameters["inertia_kg_m2"])
        inside = (time_s >= start) & (time_s < stop)
        turned, speed = _under_straight_load(time_s[inside] - start, rate_before, coefficients)
        angle[inside], rate[inside] = angle_before + turned, speed
        if math.isfinite(stop):
            turned, speed = _under_straight_load(
                np.array([stop - start]), rate_before, coefficients
            )
            angle_before, rate_before = angle_before + float(turned[0]), float(speed[0])
    return angle, rate


def _under_straight_load(
    t: Array, rate: float, coefficients: tuple[float, float, float, float]
) -> tuple[Array, Array]:
    """Angle turned and rate after the times t from a rate, under J·ω̇ = drive - D·ω - slope·t."""
    drive, fall, slope, inertia = coefficients
    lasting = inertia / fall
    straight = drive / fall + lasting * slope / fall
    left = rate - straight
    faded = np.expm1(-t / lasting)
    turned = straight * t - slope / fall * t**2 / 2 - left * lasting * faded
    return turned, straight - slope / fall * t + left * (1 + faded)
