"""Incremental encoder: what speed can be told from n marks a turn, and how far odometry strays.

Two ways to a speed. Counting the marks in a gate of time T resolves 2π/(n·T), whatever the speed.
Timing the period between two marks with a clock of tick δ resolves the part ω·n·δ/(2π) of the
speed: better at low speed, worse at high. They are equally good at 2π/(n·√(T·δ)).

A count is the difference of two whole numbers. Where the gate starts at any phase of the marks, its
error is the difference of two that are evenly spread: triangular, with the standard deviation
1/√6 of a mark (JCGM 100:2008, 4.3.9, gives that of a triangle).
"""

from __future__ import annotations

import math

import numpy as np

from simcompare.model.trajectory import Array


def gate_resolution(marks: int, gate_s: float) -> float:
    """Speed that is one mark in the gate, 2π/(n·T) [rad/s]."""
    return 2 * math.pi / (marks * gate_s)


def gate_uncertainty(marks: int, gate_s: float) -> float:
    """Standard uncertainty of a speed from counting at a random phase, resolution/√6 [rad/s]."""
    return gate_resolution(marks, gate_s) / math.sqrt(6)


def period_resolution(marks: int, tick_s: float, rate_rad_s: Array | float) -> Array | float:
    """Speed that is one tick of the clock in one period, ω²·n·δ/(2π) [rad/s]."""
    return rate_rad_s**2 * marks * tick_s / (2 * math.pi)


def equal_speed(marks: int, gate_s: float, tick_s: float) -> float:
    """Speed at which counting and timing resolve the same, 2π/(n·√(T·δ)) [rad/s]."""
    return 2 * math.pi / (marks * math.sqrt(gate_s * tick_s))


def counted_speeds(counts: Array, marks: int, gate_s: float) -> Array:
    """Mean speeds (g,) [rad/s] from the counts at the gates' ends (g + 1,)."""
    return np.asarray(2 * math.pi * np.diff(counts) / (marks * gate_s), dtype=float)


def timed_speed(passed_s: tuple[float, float], marks: int, tick_s: float) -> float | None:
    """Speed [rad/s] from the times at which two neighbouring marks passed, on a clock with ticks.

    ``None`` where both passed within the same tick: too fast for this clock.
    """
    first, second = (math.floor(time_s / tick_s + 1e-9) for time_s in passed_s)
    if first == second:
        return None
    return 2 * math.pi / (marks * (second - first) * tick_s)


def passing_times(angle_rad: Array, time_s: Array, marks: int, numbers: Array) -> Array:
    """Times at which the marks of these numbers passed (m,), between samples on a straight line.

    Args:
        angle_rad: growing angles (n,).
        time_s: their times (n,).
        marks: marks in one turn.
        numbers: whole numbers of marks (m,), counted from angle 0.
    """
    wanted = numbers * 2 * math.pi / marks
    return np.asarray(np.interp(wanted, angle_rad, time_s), dtype=float)


def whole_turn_speed(passed_s: Array, marks: int) -> Array:
    """Speeds averaged over one turn each (m - n,) from the times of m marks [rad/s].

    Marks are never quite even; the error repeats every turn, so a whole turn is free of it.
    """
    return np.asarray(2 * math.pi / (passed_s[marks:] - passed_s[:-marks]), dtype=float)


def distance_error(scale_error: float, distance_m: float) -> float:
    """Error along the way where wheels are taken for too large by a part: it grows linearly [m]."""
    return scale_error * distance_m


def lateral_error(speed_m_s: float, heading_bias_rad_s: float, time_s: float) -> float:
    """Error across the way under a constant error of the turning rate: ½·v·ω_b·t² [m].

    For small headings ω_b·t; it grows with the square of time.
    """
    return 0.5 * speed_m_s * heading_bias_rad_s * time_s**2
