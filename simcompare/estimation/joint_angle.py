"""Angle of a joint from two accelerometers, one on each side of it.

Both read the same vector, each in its own frame, so the angle between the frames is the angle
between the readings (see ``measures/joint_angle_estimate.py``). Away from the joint's axis a sensor
in motion feels lever-arm terms, too; with a rate about the axis on each side they are taken off.
About an axis that stands upright nothing is told: gravity has no component across it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError
from simcompare.estimation.estimate import Estimate, Given, Number, Signal, State, Way
from simcompare.estimation.estimators import Option, Role
from simcompare.measures.joint_angle_estimate import angle_between, without_lever_arm
from simcompare.model.trajectory import Array

TITLE = "Chips compared"
SIGNALS = {
    "first": Role("specific force on the first side, y along the joint", "m/s**2", 3),
    "second": Role("specific force on the second side", "m/s**2", 3),
    "first_rate": Role("rate of the first side", "rad/s", 3, needed=False),
    "second_rate": Role("rate of the second side", "rad/s", 3, needed=False),
    "first_axis": Role("specific force at the joint's axis, first side", "m/s**2", 3, needed=False),
    "second_axis": Role("the same of the second side", "m/s**2", 3, needed=False),
}
TRUTHS = {"angle": Role("angle of the joint", "rad", needed=False)}
OPTIONS = {
    "gravity_m_s2": Option("acceleration of free fall", 9.80665, 0.1),
    "first_lever_m": Option("place of the first sensor on its z axis, from the joint", 0.0, -10.0),
    "second_lever_m": Option("the same of the second sensor", 0.0, -10.0),
    "still_until_s": Option("end of the rest", 0.0),
    "moving_from_s": Option("begin of the free motion", 0.0),
    "gate": Option("how far from g, as a part, a reading that is trusted may be", 0.05, 1e-6),
}
#: ways of telling the angle
AS_READ, CORRECTED, AT_AXIS = "as read", "lever arms taken off", "at the axis"
_LABELS = {"angle_rad": "Angle of the joint"}
#: module that asks how well chips tell it
STUDY = "joint_angle_study"
#: part of g that gravity must have across the axis, for u = √2·s/(g·cos β) to be of use
_ACROSS = 0.2


def estimate(given: Given) -> Estimate:
    """The angle in every way that the signals allow; the first is the best of them."""
    first, second = given.signal("first"), given.signal("second")
    _refuse_upright(first, second, given.options)
    ways = [_way(given, AS_READ, first, second)]
    if "first_rate" in given.signals and "second_rate" in given.signals:
        corrected = (_corrected(given, side) for side in ("first", "second"))
        ways.insert(0, _way(given, CORRECTED, *corrected))
    if "first_axis" in given.signals and "second_axis" in given.signals:
        ways.append(_way(given, AT_AXIS, given.signal("first_axis"), given.signal("second_axis")))
    numbers = {"valid_fraction": Number(float(np.mean(_trusted(given))), "1")}
    return Estimate(tuple(ways), _LABELS, numbers=numbers)


def angles(first: Array, second: Array) -> Array:
    """Angle (…,) [rad] about +y from specific forces (…, 3) on both sides."""
    a, b = ((force[..., 0], force[..., 2]) for force in (first, second))
    return angle_between(a, b)


def corrected_force(force: Array, rate: Array, time_s: Array, lever_m: float) -> Array:
    """Specific forces (n, 3) less what rates (n, 3) make of a place away from the axis."""
    plane = without_lever_arm((force[:, 0], force[:, 2]), rate[:, 1], time_s, lever_m)
    return np.column_stack((plane[0], force[:, 1], plane[1]))


def _way(given: Given, name: str, first: Signal, second: Signal) -> Way:
    time_s, other = first.time_s, second.at(first.time_s)
    values = angles(first.values, other)
    truth = given.truth_at("angle", time_s)
    return Way(name, time_s, {"angle_rad": State(values, _u(first, second, other), truth, True)})


def _u(first: Signal, second: Signal, other: Array) -> Array | None:
    """Standard uncertainty by noise alone (n,): √(s₁² + s₂²) over what is felt across the axis."""
    if first.u is None or second.u is None:
        return None
    noise = [float(np.max(np.asarray(one.u))) for one in (first, second)]
    across = [np.hypot(force[:, 0], force[:, 2]) for force in (first.values, other)]
    return np.asarray(np.hypot(noise[0] / across[0], noise[1] / across[1]), dtype=float)


def _corrected(given: Given, side: str) -> Signal:
    force = given.signal(side)
    rate = given.signal(f"{side}_rate").at(force.time_s)
    lever_m = given.options[f"{side}_lever_m"]
    values = corrected_force(force.values, rate, force.time_s, lever_m)
    return Signal(force.time_s, values, force.u)


def _trusted(given: Given) -> Array:
    """Samples in motion at which both sensors read g to within the gate (n,)."""
    g, options = given.options["gravity_m_s2"], given.options
    first = given.signal("first")
    moving = first.time_s > options["moving_from_s"]
    if not moving.any():
        last_s, from_s = float(first.time_s[-1]), options["moving_from_s"]
        fault = f"moving_from_s = {from_s:g} leaves no sample in motion; the last is at {last_s:g}"
        raise InputError("estimate", [f"{fault} s; expected less"])
    forces = (first.values, given.signal("second").at(first.time_s))
    return trusted(forces, g, options["gate"])[moving].astype(float)


def trusted(forces: Sequence[Array], gravity_m_s2: float, gate: float) -> NDArray[np.bool_]:
    """Where forces (…, 3) are all g to within this part of it (…,)."""
    off = [np.abs(np.linalg.norm(force, axis=-1) - gravity_m_s2) for force in forces]
    return np.asarray(np.max(off, axis=0) < gate * gravity_m_s2)


def _refuse_upright(first: Signal, second: Signal, options: Mapping[str, float]) -> None:
    g = options["gravity_m_s2"]
    for name, signal in (("first", first), ("second", second)):
        still = signal.time_s <= options["still_until_s"] * (1 + 1e-9)
        force = signal.values[still] if still.any() else signal.values[:1]
        refuse_upright(f"estimate, {name}", force, g)


def refuse_upright(where: str, force: Array, gravity_m_s2: float) -> None:
    """Ends where the axis stands upright, by the forces (n, 3) at rest.

    Raises:
        InputError: an angle about such an axis cannot be told.
    """
    mean = np.nanmean(force, axis=0)
    across = float(np.hypot(mean[0], mean[2]))
    if across < _ACROSS * gravity_m_s2:
        raise InputError(
            where,
            [
                f"gravity has only {across:.2g} m/s² across the joint's axis, which stands upright"
                " or nearly so: two accelerometers cannot tell an angle about it; lay the axis"
                " down, or measure that angle with an encoder"
            ],
        )
