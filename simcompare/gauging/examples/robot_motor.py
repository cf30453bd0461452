"""Closed form of the robot that is driven by two gear motors at 2 V."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from simcompare.gauging import scenario_values
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.scenarios.robot_motor import reference


def _checks() -> Iterator[Check]:
    values = scenario_values.of("robot_motor")
    drive = reference.Drive.of(values)
    radius = values["wheel_radius_m"]
    yield Check("force at standstill (N)", "1.36416635", 2 * drive.stall_N_m / radius)
    yield Check(
        "its fall with speed (N·s/m)", "8.00355976", 2 * drive.damping_N_m_s_rad / radius**2
    )
    # so late that nothing of the start is left, and over a time in which some of it is
    end = float(reference.motion_at(values, np.array([0.0, 5.0])).speed_m_s[-1])
    yield Check("final speed (m/s)", "0.170444951", end)
    time_s = np.array([0.0, 0.1])
    left = 1 - float(reference.motion_at(values, time_s).speed_m_s[-1]) / end
    yield Check("time constant (ms)", "97.7928756", -1e3 * 0.1 / float(np.log(left)))


EXAMPLE = Example(
    "Robot with gear motors at 2 V: final speed and time constant",
    "Equations of motor, gear and robot, linear in the speed; computed with mpmath.",
    _checks,
    kind="exact",
    closed_form=True,
)
