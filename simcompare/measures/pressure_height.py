"""Height told from pressure by the standard atmosphere, as a robot would tell it."""

from __future__ import annotations

import numpy as np

from simcompare.engine.sensing import LAPSE_K_M, PRESSURE_EXPONENT, SEA_LEVEL_K, SEA_LEVEL_PA
from simcompare.measures import Measured, Pairs, Request, _window, side_by_side
from simcompare.model.trajectory import Array, Trajectory

SERIES = ("height_time", "told_height", "true_height")
ROLES = ("height",)
OPTIONS = ("count",)
AXES = {"told_height": "height_time", "true_height": "height_time"}
UNITS = {
    "height_time": "s",
    "told_height": "m",
    "true_height": "m",
    "climb": "m",
    "height_error": "m",
}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Heights from pressures, and the climb from the first to the last of them.

    Args:
        trajectory: the source.
        request: its probe sees the pressure [Pa], its role ``height`` the height above sea level
            [m]; its option ``count`` is the number of evenly spaced samples.

    Returns:
        ``climb`` and, at these samples, ``height_time``, ``told_height`` and ``true_height``.
    """
    pressure = request.observed(trajectory)
    taken = _window.evenly(len(pressure), request.options["count"])
    height = height_of(pressure)
    return Measured(
        values={"climb": float(height[-1] - height[0])},
        series={
            "height_time": trajectory.time_s[taken],
            "told_height": height[taken],
            "true_height": request.observed(trajectory, "height")[taken],
        },
    )


def against(measured: Measured, truth: Measured) -> Pairs:
    """What is judged: the climb, and ``height_error``.

    That is the largest deviation of the height that the source tells from the height where the
    truth is at the same time; unknown (``None``) where the two have other times.
    """
    error = None
    if _window.same(measured.series["height_time"], truth.series["height_time"]):
        error = _window.largest(measured.series["told_height"] - truth.series["true_height"])
    return {**side_by_side(measured, truth), "height_error": (error, 0.0)}


def height_of(pressure_Pa: Array) -> Array:
    """Height above sea level [m] of pressures (n,) [Pa]: T_0/L·(1 - (p/p_0)^(1/exponent))."""
    part = (pressure_Pa / SEA_LEVEL_PA) ** (1 / PRESSURE_EXPONENT)
    return np.asarray(SEA_LEVEL_K / LAPSE_K_M * (1 - part), dtype=float)
