"""Joints of ROS: a JointState is in rad or m, as a joint turns or slides, and does not say which.

The mapping says it in one line, ``joints: revolute`` or ``joints: {lift: prismatic}``; a bag that
holds a description of the robot says it itself.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from simcompare.errors import InputError, UnknownName
from simcompare.hardware.logs import profiles
from simcompare.hardware.mapping import PRISMATIC, REVOLUTE, Mapping
from simcompare.hardware.raw import RawColumn, RawLog
from simcompare.model.recording import INFO, Repair

#: quantity of a joint -> its unit for each kind of joint
UNITS = {
    "position": {REVOLUTE: "rad", PRISMATIC: "m"},
    "velocity": {REVOLUTE: "rad/s", PRISMATIC: "m/s"},
    "effort": {REVOLUTE: "N*m", PRISMATIC: "N"},
}
#: kinds of a robot description
_KINDS = {"revolute": REVOLUTE, "continuous": REVOLUTE, "prismatic": PRISMATIC}
_JOINT = re.compile(r"<joint\b([^>]*)>")
_ATTRIBUTE = re.compile(r"\b(name|type)\s*=\s*[\"']([^\"']*)[\"']")
#: names of columns in tables that were made of a JointState
_COLUMN = re.compile(
    r"field\.(?P<quantity>position|velocity|effort)(?P<joint>\d+)"
    r"|/.*joint_states?/(?P<joint_2>.+)[/.](?P<quantity_2>position|velocity|effort)"
)


def described(text: str) -> dict[str, str]:
    """Kinds of the joints in a robot description (URDF)."""
    pairs = [dict(_ATTRIBUTE.findall(found)) for found in _JOINT.findall(text)]
    return {one["name"]: _KINDS[one["type"]] for one in pairs
            if one.get("type") in _KINDS and "name" in one}  # fmt: skip


def mark(columns: Iterable[RawColumn]) -> None:
    """Marks the columns of a table that are those of joints, by their names."""
    for column in columns:
        found = None if column.unit else _COLUMN.fullmatch(column.name)
        if found:
            column.joint = found["joint"] or found["joint_2"] or ""
            column.quantity = found["quantity"] or found["quantity_2"] or ""


def settle(raw: RawLog, mapping: Mapping, file: str) -> None:
    """Gives the columns of joints their units, where the mapping or the log says which joint it is.

    Raises:
        InputError: the mapping names joints that the log does not have.
    """
    columns = [c for stream in raw.streams for c in stream.columns if c.joint]
    told = mapping.joints or {}
    names = list(dict.fromkeys(column.joint for column in columns))
    if isinstance(told, str):
        unknown = [] if names else ["joints: the log holds no states of joints"]
        told = dict.fromkeys(names, told)
    else:
        unknown = [f"joints: {UnknownName('joint', n, names)}" for n in told if n not in names]
    if unknown:
        raise InputError(file, unknown)
    known = _of_known_robot(names, raw) if not isinstance(mapping.joints, str) else {}
    for column in columns:
        kind = told.get(column.joint) or raw.joints.get(column.joint) or known.get(column.joint)
        if kind and not column.unit:
            column.unit = UNITS[column.quantity][kind]
    described_here = [name for name in names if name in raw.joints and name not in told]
    if described_here:
        text = "units of joints are those of the robot description in the bag"
        raw.repairs.append(Repair("joint_units", INFO, f"{text}: {', '.join(described_here)}"))


def _of_known_robot(names: Iterable[str], raw: RawLog) -> dict[str, str]:
    """Kinds of the joints, where their names together are those of a robot that is known."""
    robot = profiles.robot([*names])
    if robot is None:
        return {}
    kinds = {REVOLUTE: robot.revolute, PRISMATIC: robot.prismatic}
    known = {name: kind for name in names for kind, pattern in kinds.items()
             if pattern and re.fullmatch(pattern, name)}  # fmt: skip
    text = f"joints are called as those of {robot.name}; its description says how they move"
    raw.repairs.append(Repair("joint_units", INFO, f"{text}: {', '.join(known)}"[:300]))
    return known
