"""Lines of a DC motor at 6 V: idle speed, largest efficiency, largest power."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.gauging import scenario_values
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.hardware.motors.dc_motor import Motor


def _checks() -> Iterator[Check]:
    values = scenario_values.of("motor_bench")
    # the closed forms are those of a motor without viscous friction
    motor = Motor(
        values["resistance_Ohm"], values["torque_constant_N_m_A"], values["friction_N_m"]
    )  # fmt: skip
    voltage = values["voltage_V"]
    yield Check("idle current (mA)", "72.727273", 1e3 * motor.current_at(voltage, 0.0))
    yield Check("idle speed (rad/s)", "1011.57025", motor.speed_at(voltage, 0.0))
    yield Check("largest efficiency (%)", "53.3367383", 100 * motor.maximum_efficiency(voltage))
    speed = motor.most_efficient_speed(voltage)
    back_V = motor.torque_constant_N_m_A * speed
    yield Check("current there (A)", "0.269679945", (voltage - back_V) / motor.resistance_Ohm)
    yield Check("largest mechanical power (W)", "1.28975207", motor.maximum_power(voltage))


EXAMPLE = Example(
    "DC motor at 6 V: idle, largest efficiency and power",
    "Closed forms such as (1 - √(I0/Is))² (Hughes and Drury, Electric Motors and Drives); computed"
    " with mpmath.",
    _checks,
    kind="exact",
    closed_form=True,
)
