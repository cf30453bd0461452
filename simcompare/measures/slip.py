"""Slip of a wheel: which part of its turning does not become distance."""

from __future__ import annotations

from simcompare.measures import Measured, Request, _window
from simcompare.model.trajectory import Trajectory

ROLES = ("angle",)
OPTIONS = ("radius_m", "start_s", "end_s")
UNITS = {"slip": "1"}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Slip ratio 1 - Δx/(r·Δφ) over a window: 0 for a wheel that rolls, 1 for one that spins.

    It is the mean of 1 - v/(r·ω), weighted with the rate ω.

    Args:
        trajectory: the source.
        request: its probe sees how far the wheel's centre has come, its role ``angle`` how far the
            wheel has turned; its options are the radius and the window.

    Returns:
        ``slip``, ``None`` where the window is empty or the wheel does not turn in it.
    """
    inside = _window.samples(trajectory.time_s, request.options)
    position = request.observed(trajectory)[inside]
    rolled = request.options["radius_m"] * request.observed(trajectory, "angle")[inside]
    turned = float(rolled[-1] - rolled[0]) if len(rolled) else 0.0
    slip = 1 - float(position[-1] - position[0]) / turned if turned else None
    return Measured(values={"slip": slip})
