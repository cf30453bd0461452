"""Permanent-magnet DC motor in steady state, and how it warms up.

A motor at constant voltage V that gives the torque τ at its shaft, with the winding's resistance R,
the torque constant k (also the voltage constant), dry friction τ_c and viscous friction b:

    k·i = τ + τ_c + b·ω    and    V = R·i + k·ω

so speed and current are straight lines over the torque. Two losses remain, R·i² in the winding and
(τ_c + b·ω)·ω in the bearings and brushes; they heat the motor, which warms up as one body with the
heat capacity C behind the thermal resistance R_th. Hot copper has more resistance and a hot magnet
less flux, so a motor that is held at its current may run away.

Sources: any text on electric drives, for example Hughes and Drury, Electric Motors and Drives, 5th
ed. 2019, chapter 3; the temperature coefficient of copper is that of IEC 60028.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from simcompare.model.trajectory import Array

#: where the constants of a motor are valid [K]: 20 °C
REFERENCE_K = 293.15
#: relative change of the resistance of copper per kelvin, about 20 °C (IEC 60028)
COPPER_PER_K = 3.93e-3
#: relative change of the flux of a ferrite magnet per kelvin; a typical value of makers
FERRITE_PER_K = -2e-3


@dataclass(frozen=True)
class Motor:
    """Constants of a motor at 20 °C.

    Attributes:
        resistance_Ohm: of the winding, with its brushes.
        torque_constant_N_m_A: k, also V·s/rad.
        friction_N_m: dry friction τ_c of bearings and brushes.
        damping_N_m_s_rad: viscous friction b.
    """

    resistance_Ohm: float
    torque_constant_N_m_A: float
    friction_N_m: float = 0.0
    damping_N_m_s_rad: float = 0.0

    def speed_at(self, voltage_V: float, torque_N_m: float) -> float:
        """Speed ω = (k·V/R - τ - τ_c)/(k²/R + b) at which it gives a torque [rad/s]."""
        return (self.starting_torque(voltage_V) - torque_N_m) / self.slope

    def current_at(self, voltage_V: float, torque_N_m: float) -> float:
        """Current i = (V - k·ω)/R that it takes for a torque [A]."""
        back_V = self.torque_constant_N_m_A * self.speed_at(voltage_V, torque_N_m)
        return (voltage_V - back_V) / self.resistance_Ohm

    def starting_torque(self, voltage_V: float) -> float:
        """Torque k·V/R - τ_c with which it starts from rest, and at which it stalls [N·m]."""
        return self.torque_constant_N_m_A * voltage_V / self.resistance_Ohm - self.friction_N_m

    @property
    def slope(self) -> float:
        """D = k²/R + b, the torque that one rad/s of speed costs [N·m·s/rad]."""
        k = self.torque_constant_N_m_A
        return k * k / self.resistance_Ohm + self.damping_N_m_s_rad

    def stall_current(self, voltage_V: float) -> float:
        """Current V/R of the motor that is held [A]."""
        return voltage_V / self.resistance_Ohm

    def efficiency_at(self, voltage_V: float, torque_N_m: float) -> float:
        """Mechanical over electrical power, τ·ω/(V·i)."""
        mechanical_W = torque_N_m * self.speed_at(voltage_V, torque_N_m)
        return mechanical_W / (voltage_V * self.current_at(voltage_V, torque_N_m))

    def most_efficient_speed(self, voltage_V: float) -> float:
        """Speed at which the efficiency is largest [rad/s].

        With the speed as x = k·ω/V the efficiency is (D·R/k²)·x·(s - x)/(1 - x), and 1 - s the part
        f of :meth:`_idle_share`; it is largest at x = 1 - √f.
        """
        x = 1 - math.sqrt(self._idle_share(voltage_V))
        return voltage_V / self.torque_constant_N_m_A * x

    def maximum_efficiency(self, voltage_V: float) -> float:
        """Largest efficiency (D·R/k²)·(1 - √f)²; without viscous friction (1 - √(I_0/I_s))².

        A motor without any friction comes near to 1 where it gives no torque at all.
        """
        k = self.torque_constant_N_m_A
        scale = self.slope * self.resistance_Ohm / (k * k)
        return scale * (1 - math.sqrt(self._idle_share(voltage_V))) ** 2

    def _idle_share(self, voltage_V: float) -> float:
        """Part f = (b + k·τ_c/V)/D of V that is not back-EMF when it runs idle, at most 1."""
        k = self.torque_constant_N_m_A
        return (self.damping_N_m_s_rad + k * self.friction_N_m / voltage_V) / self.slope

    def maximum_power(self, voltage_V: float) -> float:
        """Largest mechanical power c²/(4·D), at half the starting torque [W]."""
        return self.starting_torque(voltage_V) ** 2 / (4 * self.slope)

    def at_temperature(self, temperature_K: float) -> Motor:
        """The same motor with a copper winding and a ferrite magnet at another temperature."""
        warmer = temperature_K - REFERENCE_K
        return Motor(
            self.resistance_Ohm * (1 + COPPER_PER_K * warmer),
            self.torque_constant_N_m_A * (1 + FERRITE_PER_K * warmer),
            self.friction_N_m,
            self.damping_N_m_s_rad,
        )


@dataclass(frozen=True)
class Housing:
    """A motor's body as one lump of heat.

    Attributes:
        resistance_K_W: thermal resistance R_th to the air [K/W].
        capacity_J_K: heat capacity C [J/K].
        ambient_K: temperature of the air [K].
    """

    resistance_K_W: float
    capacity_J_K: float
    ambient_K: float = REFERENCE_K

    @property
    def time_constant_s(self) -> float:
        """R_th·C [s]."""
        return self.resistance_K_W * self.capacity_J_K

    def after(self, temperature_K: float, loss_W: float, duration_s: float) -> float:
        """Temperature after some time at a constant loss, exact for any duration [K].

        C·dT/dt = P - (T - T_a)/R_th has the solution T_∞ + (T - T_∞)·exp(-t/(R_th·C)) with
        T_∞ = T_a + P·R_th.
        """
        end_K = self.ambient_K + loss_W * self.resistance_K_W
        return end_K + (temperature_K - end_K) * math.exp(-duration_s / self.time_constant_s)

    def along(self, loss_W: Array, time_s: Array) -> Array:
        """Temperatures (n,) of a body that starts at ambient, for losses sampled at times (n,) [K].

        Each step takes the mean of the losses at its two ends and solves it exactly.
        """
        temperatures_K = np.full(len(time_s), self.ambient_K)
        means = (loss_W[1:] + loss_W[:-1]) / 2
        for i, (mean_W, step_s) in enumerate(zip(means, np.diff(time_s), strict=True)):
            temperatures_K[i + 1] = self.after(
                float(temperatures_K[i]), float(mean_W), float(step_s)
            )
        return temperatures_K


def steady_temperature(motor: Motor, housing: Housing, current_A: float) -> float | None:
    """Temperature that a motor held at a constant current ends at [K]; ``None``: it runs away.

    The loss I²·R_20·(1 + α·(T - 20 °C)) grows with the temperature; the air carries it off only
    where I²·R_20·α·R_th is below 1.
    """
    cold_W = current_A**2 * motor.resistance_Ohm
    gain = cold_W * COPPER_PER_K * housing.resistance_K_W
    if gain >= 1:
        return None
    rise = housing.ambient_K - REFERENCE_K + cold_W * housing.resistance_K_W
    return REFERENCE_K + rise / (1 - gain)


def warming(
    motor: Motor, housing: Housing, voltage_V: float, torque_N_m: float, time_s: Array
) -> Array:
    """Temperatures (n,) of a motor at constant voltage and torque whose R and k follow them [K].

    The loss is V·i - τ·ω of the motor as warm as it is. It starts at ambient. Where the torque
    is more than the warm motor can give, it stands still and all its power is heat.

    Args:
        motor: constants at 20 °C.
        housing: its thermal side.
        voltage_V: constant voltage.
        torque_N_m: constant torque at the shaft.
        time_s: increasing times (n,), from the moment of switching on.
    """
    from scipy.integrate import solve_ivp

    def rate(_: float, state: Array) -> list[float]:
        loss_W = loss_at(motor.at_temperature(float(state[0])), voltage_V, torque_N_m)
        leaves_W = (float(state[0]) - housing.ambient_K) / housing.resistance_K_W
        return [(loss_W - leaves_W) / housing.capacity_J_K]

    solution = solve_ivp(
        rate, (0.0, float(time_s[-1])), [housing.ambient_K], "DOP853", t_eval=time_s,
        rtol=1e-12, atol=1e-9,
    )  # fmt: skip
    return np.asarray(solution.y[0], dtype=float)


def loss_at(motor: Motor, voltage_V: float, torque_N_m: float) -> float:
    """Heat V·i - τ·ω that a motor makes at a torque [W]; V²/R where it stalls."""
    if torque_N_m >= motor.starting_torque(voltage_V):
        return voltage_V * motor.stall_current(voltage_V)
    electrical_W = voltage_V * motor.current_at(voltage_V, torque_N_m)
    return electrical_W - torque_N_m * motor.speed_at(voltage_V, torque_N_m)
