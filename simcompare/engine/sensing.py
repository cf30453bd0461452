"""What ideal sensors and actuators read, from recorded motion: the same for every source.

Rates and accelerations are taken from positions and angles by central differences, since engines
store velocities half a step away from positions; at both ends they are one-sided. Both are of
second order in the time between samples.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

import numpy as np

from simcompare.engine.kinematics import add_children, carriers, placed_on
from simcompare.engine.range_sensing import ranges
from simcompare.model.rotations import conjugate, multiply, rotate, rotation_vectors_of
from simcompare.model.scenario import MOVABLE, DcMotor, Scenario
from simcompare.model.sensor import Sensor
from simcompare.model.trajectory import Array

#: standard atmosphere, ISO 2533:1975: sea level pressure [Pa], temperature [K], lapse rate [K/m]
SEA_LEVEL_PA, SEA_LEVEL_K, LAPSE_K_M = 101325.0, 288.15, 0.0065
#: exponent g·M/(R·L) with g = 9.80665 m/s², M = 0.0289644 kg/mol, R = 8.314462618 J/(mol·K)
PRESSURE_EXPONENT = 9.80665 * 0.0289644 / (8.314462618 * LAPSE_K_M)


def complete(
    scenario: Scenario,
    time_s: Array,
    signals: dict[str, Array],
    inputs: Mapping[str, Array],
    owner: str | None = None,
    without: Collection[str] = (),
) -> None:
    """Adds what follows from the motion and is not among the signals yet.

    That is: bodies on joints, actuators, and the sensors that only look at motion. What lacks the
    motion that it needs is left out.

    Args:
        scenario: the scene.
        time_s: sample times (n,), evenly spaced.
        signals: what a source recorded; is added to.
        inputs: values of the inputs at these times.
        owner: the body, actuator or sensor of which the signals are asked for; ``None``: all.
        without: sensors that are left out.
    """
    if _has_motion(scenario, signals):
        add_children(scenario, signals, len(time_s), _bodies_for(scenario, owner))
    for name in scenario.actuators:
        if owner in (None, name):
            _add_actuator(scenario, name, time_s, signals, inputs)
    for name, sensor in scenario.sensors.items():
        if owner not in (None, name) or name in without or not _sees(scenario, sensor, signals):
            continue
        for part in sensor.signals:
            if f"{name}.{part}" not in signals:
                signals[f"{name}.{part}"] = _READ[part](scenario, sensor, time_s, signals)


def pressure_at(height_m: Array) -> Array:
    """Pressure of the standard atmosphere [Pa] at heights above sea level (n,) [m]."""
    return np.asarray(
        SEA_LEVEL_PA * (1 - LAPSE_K_M * height_m / SEA_LEVEL_K) ** PRESSURE_EXPONENT, dtype=float
    )


def rate_of(values: Array, time_s: Array) -> Array:
    """Time derivative of samples (n,) or (n, k), of second order, also at both ends."""
    if len(time_s) < 3:
        return np.zeros_like(values)
    return np.asarray(np.gradient(values, time_s, axis=0, edge_order=2), dtype=float)


def acceleration_of(values: Array, time_s: Array) -> Array:
    """Second time derivative of evenly spaced samples (n, k), of second order."""
    found = np.zeros_like(values)
    if len(time_s) < 4:
        return found
    step_s = (time_s[-1] - time_s[0]) / (len(time_s) - 1)
    found[1:-1] = values[2:] - 2 * values[1:-1] + values[:-2]
    if len(time_s) < 5:
        found[[0, -1]] = found[[1, -2]]
    else:  # a parabola through the three next to each end
        found[0] = 3 * found[1] - 3 * found[2] + found[3]
        found[-1] = 3 * found[-2] - 3 * found[-3] + found[-4]
    return np.asarray(found / step_s**2, dtype=float)


def _bodies_for(scenario: Scenario, owner: str | None) -> set[str] | None:
    """Bodies whose motion the signals of an owner need; ``None``: all."""
    if owner is None:
        return None
    sensor = scenario.sensors.get(owner)
    body = owner if sensor is None else sensor.body
    if sensor is not None and sensor.zones:
        return None  # it looks at them
    return set() if body is None else carriers(scenario, body)


def _has_motion(scenario: Scenario, signals: Mapping[str, Array]) -> bool:
    bodies = [f"{name}.{part}" for name in scenario.free_bodies() for part in _MOTION]
    joints = [
        f"{name}.{part}"
        for name, joint in scenario.movable_joints().items()
        for part in MOVABLE[joint.type]
    ]
    return all(name in signals for name in (*bodies, *joints))


_MOTION = ("position_m", "orientation_wxyz", "velocity_m_s", "rate_rad_s")


def _add_actuator(
    scenario: Scenario,
    name: str,
    time_s: Array,
    signals: dict[str, Array],
    inputs: Mapping[str, Array],
) -> None:
    actuator = scenario.actuators[name]
    given = inputs[actuator.input]
    if not isinstance(actuator, DcMotor):
        part = "torque_N_m" if actuator.type == "torque" else "force_N"
        signals.setdefault(f"{name}.{part}", actuator.gear * given)
        return
    angle = signals.get(f"{actuator.joint}.angle_rad")
    signals.setdefault(f"{name}.voltage_V", given)
    if angle is None:
        return
    k, ratio = actuator.torque_constant_N_m_A, actuator.gear_ratio
    # too few samples, as at the start of a controlled run, leave the rate that the source stores
    stored = signals.get(f"{actuator.joint}.rate_rad_s")
    short = len(time_s) < 3 and stored is not None
    rate = stored if short and stored is not None else rate_of(angle, time_s)
    current = (given - k * ratio * rate) / actuator.resistance_Ohm
    current = signals.setdefault(f"{name}.current_A", current)
    signals.setdefault(f"{name}.torque_N_m", actuator.efficiency * ratio * k * current)


def _sees(scenario: Scenario, sensor: Sensor, signals: Mapping[str, Array]) -> bool:
    if not sensor.signals.keys() <= _READ.keys():
        return False
    if sensor.body is None:
        return f"{sensor.joint}.angle_rad" in signals
    bodies = {sensor.body}
    if sensor.zones:  # it looks at all the others
        bodies |= {name for name, body in scenario.bodies.items() if body.shapes}
    parts = ("position_m", "orientation_wxyz")
    moving = [name for name in bodies if not scenario.bodies[name].fixed]
    return all(f"{name}.{part}" in signals for name in moving for part in parts)


def _accelerometer(
    scenario: Scenario, sensor: Sensor, time_s: Array, signals: Mapping[str, Array]
) -> Array:
    """Specific force f = Rᵀ(a - g) at the sensor's place, in its frame (n, 3)."""
    position, orientation = placed_on(scenario, sensor, len(time_s), signals)
    felt = acceleration_of(position, time_s) - np.array(scenario.world.gravity_m_s2)
    return rotate(conjugate(orientation), np.asarray(felt, dtype=float))


def _gyroscope(
    scenario: Scenario, sensor: Sensor, time_s: Array, signals: Mapping[str, Array]
) -> Array:
    """Rate in the sensor's frame (n, 3), from how the orientation changes between samples."""
    _, orientation = placed_on(scenario, sensor, len(time_s), signals)
    if len(time_s) < 3:
        stored = signals.get(f"{sensor.body}.rate_rad_s", np.zeros((len(time_s), 3)))
        return rotate(conjugate(orientation), stored)
    turns = multiply(conjugate(orientation[:-1]), orientation[1:])
    between = rotation_vectors_of(turns) / np.diff(time_s)[:, None]
    ends = 1.5 * between[[0, -1]] - 0.5 * between[[1, -2]]
    return np.vstack((ends[:1], (between[:-1] + between[1:]) / 2, ends[1:]))


def _barometer(
    scenario: Scenario, sensor: Sensor, time_s: Array, signals: Mapping[str, Array]
) -> Array:
    position, _ = placed_on(scenario, sensor, len(time_s), signals)
    return pressure_at(position[:, 2])


def _encoder(
    scenario: Scenario, sensor: Sensor, time_s: Array, signals: Mapping[str, Array]
) -> Array:
    """Whole marks that have passed (n,); a mark that is reached to within rounding has passed."""
    assert sensor.marks is not None
    turns = signals[f"{sensor.joint}.angle_rad"] / (2 * math.pi)
    return np.asarray(np.floor(turns * sensor.marks + 1e-9), dtype=float)


#: what follows from motion alone
_READ = {
    "specific_force_m_s2": _accelerometer,
    "rate_rad_s": _gyroscope,
    "pressure_Pa": _barometer,
    "marks": _encoder,
    "range_m": ranges,
}
