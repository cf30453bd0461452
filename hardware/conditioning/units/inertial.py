"""Accelerometers and gyroscopes: with or without gravity, which way is up, which way turns.

A specific force at rest points up and is as large as gravity. Turned with the device, it moves
over the sensor's axes as df/dt = -ω × f: that ties the gyroscope's axes, signs and unit to those
of the accelerometer without any reference.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simcompare.hardware.conditioning.units import turning
from simcompare.hardware.conditioning.units.meaning import (
    Claim,
    claims,
    mapping_line,
    take,
    title,
    triads,
)
from simcompare.hardware.conditioning.units.rest import rest
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.mapping_lines import channels_line
from simcompare.hardware.raw import IMPORT
from simcompare.model.trajectory import Array

#: an acceleration below this at rest has no gravity in it [m/s²]; offsets of good and bad sensors
#: reach 0.05 g together, gravity is twenty times as much
NO_GRAVITY = 0.5
#: an acceleration above this at rest has gravity in it [m/s²]
GRAVITY = 8.3
#: how far the specific force may point away from the axis that is called up [deg]
TILT_DEG = 30.0
#: fastest turn that a common gyroscope can show (2000 °/s) [rad/s]
MAX_RATE = 35.0
#: another reading of a gyroscope is believed where it explains so much of gravity's turns, and
#: leaves so many times less unexplained than the reading that is there
FITS, TIMES_LESS = 0.8, 4.0
_AXES = "xyz"
Triad = tuple[Claim, Claim, Claim]


def check(work: Work) -> None:
    """Holds accelerometers against gravity, and gyroscopes against accelerometers."""
    if len(work.time_s) < 2:
        return
    vectors = triads(claims(work))
    forces = [triad for triad in vectors if triad[0].si == "m/s**2"]
    for triad in forces:
        _gravity(work, triad)
    forces = [t for t in forces if not any(c.kind == "gravity_removed" for c in t)]
    turns = [triad for triad in vectors if triad[0].si == "rad/s"]
    # two accelerometers or gyroscopes in one stream: nobody says which belong together
    if len(forces) == len(turns) == 1:
        _turning(work, forces[0], turns[0])
    else:
        for triad in turns:
            _fastest(work, triad)


def _gravity(work: Work, triad: Triad) -> None:
    at_rest = rest(work, triad)
    if at_rest is None:
        return
    kinds = {claim.kind for claim in triad} - {""}
    mapped = {claim.wish.kind for claim in triad if claim.wish} - {""}
    columns = f"columns {title(triad)}"
    if at_rest.size < NO_GRAVITY and kinds != {"gravity_removed"}:
        _other_kind(
            work, triad, "gravity_removed", bool(mapped),
            f"{columns}: at rest the acceleration is {at_rest.size:.3g} m/s²: gravity was removed"
            " from it, so it is no specific force",
        )  # fmt: skip
    elif at_rest.steady and at_rest.size > GRAVITY and "gravity_removed" in kinds:
        _other_kind(
            work, triad, "specific_force", bool(mapped),
            f"{columns}: at rest the acceleration is {at_rest.size:.3g} m/s²: gravity is still in"
            " it, so it is a specific force",
        )  # fmt: skip
    elif at_rest.steady and at_rest.size > GRAVITY:
        for claim in triad:
            claim.column.kind = claim.column.kind or "specific_force"
        if work.mapping.up is not None:
            _up(work, triad, at_rest.vector, work.mapping.up)


def _other_kind(work: Work, triad: Triad, kind: str, mapped: bool, text: str) -> None:
    if mapped:
        work.fault(f"{text}; the mapping file says otherwise: write kind: {kind} there")
        return
    for claim in triad:
        claim.column.kind = kind
    work.warn(
        "gravity", f"{text}; taken as {kind}. Write kind: {kind} in the mapping file to confirm",
        channel=triad[0].column.name,
    )  # fmt: skip


def _up(work: Work, triad: Triad, vector: Array, up: str) -> None:
    """At rest the specific force points along the axis that the mapping calls up."""
    expected = _unit_vector(up)
    shown = vector / np.linalg.norm(vector)
    if _angle_deg(shown, expected) <= TILT_DEG:
        return
    text = (
        f"columns {title(triad)}: the mapping file says that {up} is up, but at rest the specific"
        f" force points along ({', '.join(f'{v:+.2f}' for v in shown)})"
    )
    fitting = [
        turn for turn in turning.rotations() if _angle_deg(turn @ shown, expected) <= TILT_DEG
    ]  # fmt: skip
    if not fitting:
        work.fault(
            f"{text}, near none of the axes; mount it straight, or leave up out of the mapping file"
        )
        return
    turn = max(fitting, key=np.trace)
    others = len(fitting) - 1
    work.fault(
        f"{text}. Turned so that it fits: {_turned_lines(triad, turn)}. {others} other rotations"
        " about the upright fit as well, gravity cannot tell them apart: write the right one in the"
        " mapping file"
    )


def _unit_vector(axis: str) -> Array:
    vector = np.zeros(3)
    vector[_AXES.index(axis[1])] = 1.0 if axis[0] == "+" else -1.0
    return vector


def _angle_deg(a: Array, b: Array) -> float:
    return float(np.degrees(np.arccos(np.clip(a @ b, -1.0, 1.0))))


def _turned_lines(triad: Triad, turn: Array) -> str:
    """Lines of a mapping file that name the columns of a triad anew."""
    lines = []
    for row, claim in zip(turn, triad, strict=True):
        source = int(np.argmax(np.abs(row)))
        taken = triad[source]
        sign = 1 if row[source] > 0 else -1
        line = mapping_line(taken, taken.unit, sign=sign)
        lines.append(line.replace(taken.name, claim.name, 1) if taken is not claim else line)
    return channels_line(*lines)


def _turning(work: Work, force: Triad, turn: Triad) -> None:
    """Warns of axes, refuses a unit, with which the gyroscope does not fit the accelerometer."""
    fit = turning.compare(work, force, turn)
    if fit is None:
        _fastest(work, turn)
        return
    if fit.best < FITS or 1 - fit.as_it_is < max(0.1, TIMES_LESS * (1 - fit.best)):
        return
    text = (
        f"gyroscope {title(turn)} explains {max(fit.as_it_is, 0):.0%} of how gravity turns over"
        f" the accelerometer {title(force)}; it would explain {fit.best:.0%}"
    )
    if not np.array_equal(fit.axes, np.eye(3)):
        names = ", ".join(_axis_text(row) for row in fit.axes)
        hand = "; one of the two sensors is left-handed" if np.linalg.det(fit.axes) < 0 else ""
        work.warn(
            "gyroscope_axes",
            f"{text} with its axes read as ({names}){hand}; name and turn them in the mapping"
            f" file: {_turned_lines(turn, fit.axes)}",
            channel=turn[0].column.name,
            before={"explained": fit.as_it_is},
            after={"explained": fit.best},
        )
    if fit.unit:
        _gyroscope_unit(work, turn, fit, f"{text} if its numbers were {fit.unit}")


def _axis_text(row: Array) -> str:
    at = int(np.argmax(np.abs(row)))
    return f"{'+' if row[at] > 0 else '-'}{_AXES[at]}"


def _gyroscope_unit(work: Work, turn: Triad, fit: turning.Turning, text: str) -> None:
    if not work.assume_units:
        lines = channels_line(*(mapping_line(claim, fit.unit) for claim in turn))
        work.fault(
            f"{text}, not {turn[0].unit}: write in the mapping file {lines};"
            f" or {IMPORT} --assume-units"
        )
        return
    for claim in turn:
        full = f"{text}; {claim.column.name!r} was taken so"
        before, after = {"explained": fit.as_it_is}, {"explained": fit.best}
        take(work, claim, fit.unit, full, before, after)


def _fastest(work: Work, turn: Sequence[Claim]) -> None:
    """Faster than gyroscopes can: likely degrees."""
    if not any("gyr" in f"{c.column.name} {c.name}".lower() for c in turn):
        return
    rates = [np.abs(claim.values(slice(None))) for claim in turn]
    fastest = max(float(np.nanmax(rate, initial=0.0)) for rate in rates)
    if fastest > MAX_RATE:
        work.warn(
            "gyroscope_range",
            f"gyroscope {title(turn)} shows up to {fastest:.4g} rad/s; common ones end at"
            f" {MAX_RATE:g} rad/s (2000 °/s): are the numbers in deg/s?",
            channel=turn[0].column.name,
            before={"max_rad_s": fastest},
        )
