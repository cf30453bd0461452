"""Last sample of a probe: where something has arrived when the record ends."""

from __future__ import annotations

from simcompare.measures import OF_PROBE, Measured, Request
from simcompare.model.trajectory import Trajectory

UNITS = {"final": OF_PROBE}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """The last sample, ``final``.

    Args:
        trajectory: the source.
        request: its probe sees the quantity.
    """
    last = float(request.observed(trajectory)[-1])
    return Measured(values={"final": last})
