"""Can the angle of a joint be measured by two accelerometers? A study over data sheets.

For each chip many pairs of devices are drawn. All pairs read the same motion, as they are bought
and after a six-position calibration of each device. What is held against the truth is the angle at
rest (the mean while nothing moves) and in motion (each sample). Beside the Monte Carlo stands the
first order, which tells what the error is made of.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.estimation import joint_angle_first_order as first_order
from simcompare.estimation.estimate import Given
from simcompare.estimation.joint_angle import (
    AS_READ,
    AT_AXIS,
    CORRECTED,
    angles,
    corrected_force,
    trusted,
)
from simcompare.estimation.joint_angle_pairs import SIDES, Motion, Pairs, drawn_pairs
from simcompare.hardware.sensors import data_sheet
from simcompare.measures.heading import wrapped
from simcompare.measures.joint_angle_estimate import EDGE
from simcompare.model.trajectory import Array

BOUGHT, CALIBRATED = "as bought", "calibrated"
#: samples in motion at which both sensors read g to within the gate, and so are often trusted
TRUSTED = "as read, where both read g"
PAIRS = 100


@dataclass(frozen=True)
class Accuracy:
    """How well angles are told, over all pairs of devices.

    Attributes:
        u_rad: standard uncertainty: root of the mean squared error.
        half_width_rad: 95 % of the errors are smaller than this.
    """

    u_rad: float
    half_width_rad: float


@dataclass(frozen=True)
class Feasibility:
    """One chip in one state.

    Attributes:
        sheet: name of its data sheet.
        chip: name of the chip.
        state: "as bought" or "calibrated".
        pairs: number of pairs of devices.
        rest: at rest, the mean of the time of rest.
        first_order_rad: standard uncertainty at rest to first order.
        shares_rad: term -> its part of that; their squares add up.
        motion: way of telling the angle -> of one sample in motion.
        notes: what the reader must know.
    """

    sheet: str
    chip: str
    state: str
    pairs: int
    rest: Accuracy
    first_order_rad: float
    shares_rad: Mapping[str, float]
    motion: Mapping[str, Accuracy]
    notes: tuple[str, ...] = ()


def of_given(
    given: Given, sheets: Sequence[str], *, pairs: int = PAIRS, seed: int = 0
) -> tuple[Feasibility, ...]:
    """The same from what an estimator is given of ideal sensors, with the truth.

    Raises:
        UnknownName: no such sheet.
        InputError: a sheet without an accelerometer, or an axis that stands upright.
    """
    return study(_motion(given), sheets, pairs=pairs, seed=seed)


def study(
    motion: Motion, sheets: Sequence[str], *, pairs: int = PAIRS, seed: int = 0
) -> tuple[Feasibility, ...]:
    """How well each chip tells the angle, as bought and calibrated.

    Args:
        motion: what happens, without any error.
        sheets: names of data sheets that have an accelerometer.
        pairs: pairs of devices that are drawn of each.
        seed: of all draws.

    Raises:
        UnknownName: no such sheet.
        InputError: a sheet without an accelerometer, or an axis that stands upright.
    """
    motion.check()
    return tuple(one for name in sheets for one in _of_sheet(motion, name, pairs, seed))


def _motion(given: Given) -> Motion:
    """The ideal signals at the times of the first one."""
    time_s, options = given.signal("first").time_s, given.options
    at = {role: signal.at(time_s) for role, signal in given.signals.items()}
    angle = given.truth_at("angle", time_s)
    if angle is None:
        raise InputError("estimate", ["the true angle is missing: the study is judged by it"])
    return Motion(
        time_s, angle,
        {role: values for role, values in at.items() if not role.endswith("_rate")},
        {side: at[f"{side}_rate"] for side in SIDES if f"{side}_rate" in at},
        {side: options[f"{side}_lever_m"] for side in SIDES},
        options["still_until_s"], options["moving_from_s"], options["gravity_m_s2"],
        options["gate"],
    )  # fmt: skip


def with_accelerometer() -> tuple[str, ...]:
    """Names of the sheets of chips that have an accelerometer with three axes."""
    loaded = {name: data_sheet.load(name) for name in data_sheet.names()}
    return tuple(name for name, one in loaded.items() if "accelerometer" in one.parts)


def _of_sheet(motion: Motion, name: str, pairs: int, seed: int) -> Iterator[Feasibility]:
    sheet = data_sheet.load(name)
    part = sheet.part_for("m/s**2")
    if part is None:
        known = ", ".join(with_accelerometer())
        raise InputError(name, [f"{sheet.title} has no accelerometer; sheets that do: {known}"])
    drawn = drawn_pairs(motion, sheet, part, pairs, seed)
    at_rest = first_order.Rest.of(motion)
    for state, shares in (
        (BOUGHT, first_order.as_bought(at_rest, drawn)),
        (CALIBRATED, first_order.calibrated(at_rest, drawn)),
    ):
        read = drawn.forces if state == BOUGHT else drawn.corrected
        ways = dict(_ways(motion, drawn, read))
        truth = np.interp(drawn.time_s, motion.time_s, motion.angle_rad)
        errors = {way: wrapped(told - truth) for way, told in ways.items()}
        still = motion.still(drawn.time_s)
        yield Feasibility(
            name, sheet.title, state, pairs, _accuracy(errors[AS_READ][:, still].mean(axis=1)),
            float(np.sqrt(sum(share**2 for share in shares.values()))), shares,
            dict(_moving(motion, drawn, read, errors)), drawn.notes,
        )  # fmt: skip


def _ways(motion: Motion, drawn: Pairs, read: Mapping[str, Array]) -> Iterator[tuple[str, Array]]:
    """Every way of telling the angle (d, n)."""
    yield AS_READ, angles(read["first"], read["second"])
    if drawn.rates:
        corrected = [
            np.stack([
                corrected_force(force, rate, drawn.time_s, motion.levers_m[side])
                for force, rate in zip(read[side], drawn.rates[side], strict=True)
            ])
            for side in SIDES
        ]  # fmt: skip
        yield CORRECTED, angles(*corrected)
    if "first_axis" in read:
        yield AT_AXIS, angles(read["first_axis"], read["second_axis"])


def _moving(
    motion: Motion, drawn: Pairs, read: Mapping[str, Array], errors: Mapping[str, Array]
) -> Iterator[tuple[str, Accuracy]]:
    moving = motion.moving(drawn.time_s)
    moving[-EDGE:] = False
    for way, error in errors.items():
        yield way, _accuracy(error[:, moving])
    near = trusted([read[side] for side in SIDES], motion.gravity_m_s2, motion.gate) & moving
    if near.any():
        yield TRUSTED, _accuracy(errors[AS_READ][near])


def _accuracy(errors: Array) -> Accuracy:
    sizes = np.abs(errors)
    return Accuracy(float(np.sqrt(np.mean(sizes**2))), float(np.quantile(sizes, 0.95)))
