"""A simulated motion as its sensors would have measured it, beside what was true of it.

Each sensor that follows a data sheet is drawn anew for each draw, by its own stream of numbers. An
encoder that follows none counts whole marks, whose first one lies anywhere.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from simcompare.errors import InputError
from simcompare.estimation.estimate import Given, Signal
from simcompare.estimation.observing import ORIENTATION, Observed, observed
from simcompare.hardware.sensors.device import Device
from simcompare.hardware.sensors.device_checks import mean_rate
from simcompare.hardware.sensors.drawn import drawn
from simcompare.hardware.sensors.error_model import measured
from simcompare.hardware.sensors.low_pass import noise_bandwidth
from simcompare.measures.heading import yaw_of
from simcompare.model.estimate_plan import EstimatePlan
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array, Trajectory
from simcompare.statistics.streams import stream

#: signals whose samples belong to another time than positions, in some engines
_VELOCITIES = ("velocity_m_s", "rate_rad_s")
#: of a device; what has more components is a range sensor of many zones
_MOST_AXES = 3


def given_of(
    scenario: Scenario,
    plan: EstimatePlan,
    trajectory: Trajectory,
    devices: Mapping[str, Device],
    seed: int,
) -> Given:
    """What an estimator is given of one simulation.

    Args:
        scenario: the scene.
        plan: roles, options and data sheets.
        trajectory: the motion.
        devices: signal -> the device that reads it.
        seed: of their noise, and of where an encoder's first mark lies.

    Raises:
        InputError: the source lacks a signal.
    """
    if np.count_nonzero(trajectory.time_s >= plan.start_s - 1e-9) < 3:
        fault = f"start_s = {plan.start_s:g} leaves nothing of {trajectory.time_s[-1]:g} s"
        raise InputError("estimate", [f"{fault}; expected an earlier start"])
    signals = {
        role: _from(
            plan.start_s, _measured(scenario, devices, observed(name, scenario), trajectory, seed)
        )
        for role, name in plan.signals.items()
    }
    truth = {
        role: _from(plan.start_s, _true(scenario, observed(name, scenario), trajectory))
        for role, name in plan.truth.items()
    }
    return Given(signals, truth, plan.options, seed)


def _from(start_s: float, signal: Signal) -> Signal:
    """The same from a time on; a device ran before, so that its low-pass knows the past."""
    kept = signal.time_s >= start_s - 1e-9
    return replace(signal, time_s=signal.time_s[kept], values=signal.values[kept])


def devices_of(scenario: Scenario, plan: EstimatePlan, seed: int) -> dict[str, Device]:
    """Signal of a sensor, such as ``imu.rate_rad_s`` -> the device that reads it in one draw.

    Raises:
        UnknownName: no such data sheet or range.
        InputError: a sheet has nothing that measures so.
    """
    signals = scenario.signals()
    used = {observed(name, scenario).signal for name in plan.signals.values()}
    found = {}
    for owner, errors in {**scenario.sensor_errors(), **plan.sensors}.items():
        # of many zones, one is read
        own = {
            name: 1 if signals[name] > _MOST_AXES else signals[name]
            for name in used
            if name.partition(".")[0] == owner
        }
        if own:
            found.update({one.signal: one.device for one in drawn(errors, own, seed)})
    return found


def noise_of(device: Device, component: int, rate_Hz: float, size: float = 0.0) -> float:
    """Standard uncertainty of one reading at that rate by noise and rounding, along one axis.

    Args:
        device: what reads.
        component: its axis.
        rate_Hz: readings in a second.
        size: rms of the readings, of noise that grows with them.
    """
    width = noise_bandwidth(device.bandwidth_Hz, device.poles, rate_Hz)
    white = device.noise_density[component] * math.sqrt(width)
    grown = device.noise_per_reading[component] * size
    return float(math.hypot(white, grown, device.resolution / math.sqrt(12)))


def _measured(
    scenario: Scenario,
    devices: Mapping[str, Device],
    what: Observed,
    trajectory: Trajectory,
    seed: int,
) -> Signal:
    sensor = scenario.sensors.get(what.owner)
    device = devices.get(what.signal)
    if device is not None:
        ideal = _values(trajectory, what.signal)
        if ideal.ndim > 1 and ideal.shape[1] > _MOST_AXES:
            ideal, what = ideal[:, what.component], replace(what, component=0)
        noise = stream(seed, what.owner, what.part, "noise")
        held = sensor is not None and sensor.type == "encoder"
        reading = measured(device, trajectory.time_s, ideal, noise, held=held)
        values = _component(reading.measured, what)
        sizes = np.sqrt(np.mean(np.square(reading.measured.reshape(len(values), -1)), axis=0))
        axes = range(device.axes) if what.component is None else [what.component]
        rate_Hz = device.rate_Hz or mean_rate(trajectory.time_s)
        u = np.array([noise_of(device, axis, rate_Hz, float(sizes[axis])) for axis in axes])
        return Signal(reading.time_s, values, u if what.component is None else float(u[0]))
    if sensor is not None and sensor.type == "encoder":
        return Signal(trajectory.time_s, _counts(scenario, what.owner, trajectory, seed))
    return Signal(trajectory.time_s, _component(_values(trajectory, what.signal), what))


def _counts(scenario: Scenario, name: str, trajectory: Trajectory, seed: int) -> Array:
    """Whole marks that have passed, the first of which lies anywhere."""
    sensor = scenario.sensors[name]
    assert sensor.marks is not None
    turns = _values(trajectory, f"{sensor.joint}.angle_rad") / (2 * math.pi)
    phase = float(stream(seed, name, "phase").uniform())
    return np.asarray(np.floor(turns * sensor.marks + phase), dtype=float)


def _true(scenario: Scenario, what: Observed, trajectory: Trajectory) -> Signal:
    values = _values(trajectory, what.signal)
    sensed = what.owner in scenario.sensors
    late_s = trajectory.velocity_offset_s if what.part in _VELOCITIES and not sensed else 0.0
    time_s = trajectory.time_s + late_s
    if what.part == ORIENTATION:
        return Signal(time_s, yaw_of(values) + what.offset)
    return Signal(time_s, _component(values, what))


def _component(values: Array, what: Observed) -> Array:
    one = values if what.component is None or values.ndim == 1 else values[:, what.component]
    return np.asarray(one + what.offset)


def _values(trajectory: Trajectory, signal: str) -> Array:
    if signal not in trajectory.signals:
        known: Mapping[str, str] = trajectory.lacks
        reason = known.get(signal, "it is not among its signals")
        raise InputError(trajectory.source, [f"{signal} is missing: {reason}"])
    return trajectory.signals[signal]
