"""Energy of a geared motor with brushes: from its terminals to the shaft, and what is lost."""

from __future__ import annotations

import numpy as np

from simcompare.measures import Measured, Request
from simcompare.model.trajectory import Trajectory

ROLES = ("voltage", "torque", "angle")
OPTIONS = ("resistance_Ohm", "efficiency")
UNITS = {
    "electrical_energy": "J",
    "copper_loss": "J",
    "gear_loss": "J",
    "shaft_work": "J",
    "motor_imbalance": "1",
}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """∫V·i dt = ∫R·i² dt + (1/η - 1)·∫τ dφ + ∫τ dφ, each by the trapezoidal rule.

    The torque τ is that which the motor gives at the geared shaft, so before the rotor's own
    friction and inertia, which are part of the load here.

    Args:
        trajectory: the source.
        request: its probe sees the motor's current, its roles voltage, torque and angle of the
            shaft; its options are the winding's resistance and the gear's efficiency.

    Returns:
        The four energies over the whole run, and ``motor_imbalance``: the part of the first that is
        missing in the others, ``None`` where there is none.
    """
    time_s, current = trajectory.time_s, request.observed(trajectory)
    voltage, torque, angle = (request.observed(trajectory, role) for role in ROLES)
    electrical = float(np.trapezoid(voltage * current, time_s))
    copper = request.options["resistance_Ohm"] * float(np.trapezoid(current**2, time_s))
    shaft = float(np.trapezoid(torque, angle))
    gear = (1 / request.options["efficiency"] - 1) * shaft
    imbalance = (electrical - copper - gear - shaft) / electrical if electrical else None
    values = (electrical, copper, gear, shaft, imbalance)
    return Measured(values=dict(zip(UNITS, values, strict=True)))
