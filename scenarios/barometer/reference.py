"""Closed form of the cart that climbs, and of the standard atmosphere around it.

The winch carries the weight along the slope and adds m·A·sin(2πt/T) with A = 2π·s/T², so the cart
moves by s·(t/T - sin(2πt/T)/2π): from rest to rest, by s in the time T. Pressure over height h
above sea level: p = p_0·(1 - L·h/T_0)^(g·M/(R·L)), ISO 2533:1975, with the molar gas constant of
the SI of 2019 (the standard's own, 8.31432, makes the exponent 5.255880 instead of 5.255786).
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from simcompare.model.trajectory import Array

#: at sea level: pressure [Pa] and temperature [K]; fall of temperature with height [K/m]
SEA_LEVEL_PA = 101325.0
SEA_LEVEL_K = 288.15
LAPSE_K_M = 0.0065
#: g·M/R of dry air [K/m]: standard gravity, molar mass [kg/mol], molar gas constant [J/(mol·K)]
WEIGHT_K_M = 9.80665 * 0.0289644 / 8.314462618


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion of the cart and pressure at it.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].

    Returns:
        ``track.position_m`` and ``track.velocity_m_s`` (n,), ``cart.position_m`` (n, 3) and
        ``barometer.pressure_Pa`` (n,).
    """
    way, speed = motion(parameters, time_s)
    slope = parameters["slope_rad"]
    height = parameters["altitude_m"] + way * math.sin(slope)
    return {
        "track.position_m": way,
        "track.velocity_m_s": speed,
        "cart.position_m": np.column_stack((way * math.cos(slope), np.zeros(len(way)), height)),
        "barometer.pressure_Pa": pressure(height),
    }


def motion(parameters: Mapping[str, float], time_s: Array) -> tuple[Array, Array]:
    """Way along the slope [m] and speed [m/s] at the given times (n,)."""
    whole_s, climb = parameters["climb_time_s"], parameters["climb_m"]
    turn = 2 * math.pi * time_s / whole_s
    way = climb * (time_s / whole_s - np.sin(turn) / (2 * math.pi))
    return way, climb / whole_s * (1 - np.cos(turn))


def pressure(height_m: Array) -> Array:
    """Pressure of the standard atmosphere [Pa] at heights above sea level (n,) [m]."""
    warm = np.log1p(-LAPSE_K_M * height_m / SEA_LEVEL_K)
    return np.asarray(SEA_LEVEL_PA * np.exp(WEIGHT_K_M / LAPSE_K_M * warm), dtype=float)
