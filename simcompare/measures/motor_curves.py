"""Curves of a motor over its torque, from a brake whose lever presses on a scale.

The torque at the shaft is force times lever, plus what the inertia takes, J·ω̇: while the brake is
tightened the disk slows down and gives some of its energy to the brake. The window is divided into
even sections; each gives one point, its means over time. A motor with constant data has straight
lines of speed and current over the torque, so its mechanical power is a parabola: fits through all
points give the ends of the curves and their tops.
"""

from __future__ import annotations

import numpy as np

from simcompare.engine.sensing import rate_of
from simcompare.hardware.motors.dc_motor import Housing
from simcompare.measures import Measured, Request
from simcompare.model.trajectory import Array, Trajectory

#: points of the fitted curves at which their tops are looked for
FINE = 4001

SERIES = ("torque", "speed", "current", "electrical_power", "mechanical_power", "efficiency")
ROLES = ("angle", "current", "voltage")
OPTIONS = (
    "lever_m", "inertia_kg_m2", "start_s", "end_s", "count", "thermal_resistance_K_W",
    "heat_capacity_J_K",
)  # fmt: skip
AXES = dict.fromkeys(SERIES[1:], "torque")
UNITS = {
    "torque": "N·m",
    "speed": "rad/s",
    "current": "A",
    "electrical_power": "W",
    "mechanical_power": "W",
    "efficiency": "1",
    "no_load_speed": "rad/s",
    "stall_torque": "N·m",
    "no_load_current": "A",
    "stall_current": "A",
    "maximum_power": "W",
    "maximum_efficiency": "1",
    "most_efficient_torque": "N·m",
    "most_efficient_speed": "rad/s",
    "heat": "J",
    "temperature_rise": "K",
}
#: where the motor is most efficient
_WHERE = ("most_efficient_torque", "most_efficient_speed")


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Points of the curves, their ends, and the heat that the motor makes.

    Args:
        trajectory: the source.
        request: its probe sees the force on the scale [N], its roles the shaft's ``angle`` [rad],
            and ``current`` [A] and ``voltage`` [V] of the motor. Options: the lever, the inertia
            that turns with the shaft, the window in which the brake is tightened, the number of
            points, and the motor's thermal resistance and heat capacity.

    Returns:
        The series over ``torque``. Values: ``no_load_speed``, ``no_load_current``,
        ``stall_torque`` and ``stall_current``, extrapolated; ``maximum_power`` and
        ``maximum_efficiency`` of the fitted curves (``None`` where the top is not between the
        points); ``most_efficient_torque`` and ``most_efficient_speed``, where the latter is;
        ``heat`` and ``temperature_rise`` over the whole record, from V·i - τ·ω.
    """
    options, time_s = request.options, trajectory.time_s
    speed = rate_of(request.observed(trajectory, "angle"), time_s)
    torque = request.observed(trajectory) * options["lever_m"]
    torque = torque + options["inertia_kg_m2"] * rate_of(speed, time_s)
    current = request.observed(trajectory, "current")
    voltage = request.observed(trajectory, "voltage")
    points = _section_means(
        np.array((torque, speed, current, voltage)),
        time_s, (options["start_s"], options["end_s"]), round(options["count"]),
    )  # fmt: skip
    loss = voltage * current - torque * speed
    housing = Housing(options["thermal_resistance_K_W"], options["heat_capacity_J_K"])
    warm = housing.along(loss, time_s)
    return Measured(
        values={
            **_fitted(*points),
            "heat": float(np.trapezoid(loss, time_s)),
            "temperature_rise": float(warm[-1] - warm[0]),
        },
        series=_curves(*points),
    )


def _section_means(rows: Array, time_s: Array, window: tuple[float, float], count: int) -> Array:
    """Means over time (k, count) of rows (k, n) in even sections of a window."""
    step_s = (time_s[-1] - time_s[0]) / (len(time_s) - 1)
    start, end = (round((edge - time_s[0]) / step_s) for edge in window)
    end = min(end, len(time_s) - 1)
    edges = np.linspace(start, end, min(count, end - start) + 1).round().astype(int)
    # an average over time counts the samples at both its ends by half
    areas = np.cumsum((rows[:, 1:] + rows[:, :-1]) / 2, axis=1)
    areas = np.hstack((np.zeros((len(rows), 1)), areas))
    return np.asarray(np.diff(areas[:, edges], axis=1) / np.diff(edges), dtype=float)


def _curves(torque: Array, speed: Array, current: Array, voltage: Array) -> dict[str, Array]:
    electrical, mechanical = voltage * current, torque * speed
    return {
        "torque": torque,
        "speed": speed,
        "current": current,
        "electrical_power": electrical,
        "mechanical_power": mechanical,
        "efficiency": mechanical / electrical,
    }


def _fitted(torque: Array, speed: Array, current: Array, voltage: Array) -> dict[str, float | None]:
    """Ends and tops of the curves, from straight lines of speed, current and voltage."""
    names = ("no_load_speed", "no_load_current", "stall_torque", "stall_current")
    if len(torque) < 2 or np.ptp(torque) == 0:
        return dict.fromkeys((*names, "maximum_power", "maximum_efficiency", *_WHERE))
    (fall, idle_speed), (growth, idle_current), (sag, idle_voltage) = (
        np.polyfit(torque, values, 1) for values in (speed, current, voltage)
    )
    stall = -idle_speed / fall if fall else np.nan
    ends = (idle_speed, idle_current, stall, idle_current + growth * stall)
    fine = np.linspace(torque.min(), torque.max(), FINE)
    power = fine * (idle_speed + fall * fine)
    taken = (idle_voltage + sag * fine) * (idle_current + growth * fine)
    place = _place_of_top(power / taken)
    best = None if place is None else float(np.interp(place, np.arange(len(fine)), fine))
    return {
        **{n: float(v) if np.isfinite(v) else None for n, v in zip(names, ends, strict=True)},
        "maximum_power": _top(power),
        "maximum_efficiency": _top(power / taken),
        "most_efficient_torque": best,
        "most_efficient_speed": None if best is None else float(idle_speed + fall * best),
    }


def _top(values: Array) -> float | None:
    """Largest of many values on a smooth curve; ``None`` where it is the first or the last."""
    best = int(np.argmax(values))
    return float(values[best]) if 0 < best < len(values) - 1 else None


def _place_of_top(values: Array) -> float | None:
    """Where between many values a smooth curve is largest: the top of a parabola through three."""
    best = int(np.argmax(values))
    if not 0 < best < len(values) - 1:
        return None
    before, top, after = values[best - 1 : best + 2]
    bend = before - 2 * top + after
    return best + (0.5 * float((before - after) / bend) if bend else 0.0)
