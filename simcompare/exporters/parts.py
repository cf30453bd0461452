"""What all formats share: numbers as text, rotations, and sentences for what they cannot hold."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np

from simcompare.engine import kinematics
from simcompare.engine.drives import laws_of
from simcompare.errors import InputError
from simcompare.model.rotations import matrix_of, rotate
from simcompare.model.scenario import Body, Contact, DcMotor, Scenario
from simcompare.model.shapes import Plane, Quaternion, Vector
from simcompare.model.signals import Signal
from simcompare.model.words import one_line


@dataclass(frozen=True)
class Twin:
    """A scenario as a text in another simulator's format.

    Attributes:
        scenario: the scenario's name.
        format: "urdf", "sdf" or "mjcf".
        text: the file's content.
        bodies: names of the bodies in it.
        joints: names of the scenario's joints in it.
        left_out: what the text does not hold or only nearly, one sentence each.
    """

    scenario: str
    format: str
    text: str
    bodies: tuple[str, ...]
    joints: tuple[str, ...]
    left_out: tuple[str, ...]


# --- numbers ----------------------------------------------------------------------------------


def number(value: float) -> str:
    """The shortest text that is read back as the same number; without the sign of zero."""
    return repr(float(value) + 0.0).removesuffix(".0")


def numbers(values: Iterable[float]) -> str:
    """Several numbers with spaces between them."""
    return " ".join(number(value) for value in values)


def is_nothing(position: Vector, orientation_wxyz: Quaternion) -> bool:
    """Whether a pose moves nothing."""
    return not any((*position, *orientation_wxyz[1:]))


def short(values: Iterable[float]) -> str:
    """Several numbers for people."""
    return " ".join(f"{value:g}" for value in values)


def roll_pitch_yaw(orientation_wxyz: Quaternion) -> Vector:
    """Angles [rad] about the fixed axes x, y, z, one after the other: R = Rz·Ry·Rx.

    Roll is what is left after yaw and pitch have been taken off, so that the three together are
    exact also where pitch is a right angle and yaw and roll are one.
    """
    norm = math.hypot(*orientation_wxyz)
    m = matrix_of([part / norm for part in orientation_wxyz])
    yaw = math.atan2(m[1, 0], m[0, 0])
    pitch = math.atan2(-m[2, 0], math.hypot(m[0, 0], m[1, 0]))
    sine, cosine = math.sin(yaw), math.cos(yaw)
    roll = math.atan2(sine * m[0, 2] - cosine * m[1, 2], cosine * m[1, 1] - sine * m[0, 1])
    return roll, pitch, yaw


def turned_from_z(normal: Vector) -> Quaternion:
    """The shortest rotation that takes the z axis to a direction."""
    x, y, z = normal
    across = math.hypot(x, y)
    half = math.atan2(across, z) / 2
    if across == 0:
        return math.cos(half), math.sin(half), 0.0, 0.0
    return math.cos(half), -y / across * math.sin(half), x / across * math.sin(half), 0.0


def difference(first: Sequence[float], second: Sequence[float]) -> Vector:
    """The first vector less the second."""
    x, y, z = (float(a) - float(b) for a, b in zip(first, second, strict=True))
    return x, y, z


def turned(orientation_wxyz: Quaternion, vector: Vector) -> Vector:
    """A vector of a body's frame in the frame in which the orientation is given."""
    return kinematics.vector_of(rotate(np.array([orientation_wxyz]), np.array([vector]))[0])


def seen_from(base: Body, body: Body) -> tuple[Vector, Quaternion]:
    """Position and orientation of a body in another's frame."""
    return kinematics.seen_from(
        (base.position_m, base.orientation_wxyz), (body.position_m, body.orientation_wxyz)
    )


def inertia_of(body: Body) -> tuple[float, Vector]:
    """Mass and principal moments; 1 kg and 1 kg·m² for a fixed body, where they play no part."""
    return body.mass_kg or 1.0, body.inertia_kg_m2 or (1.0, 1.0, 1.0)


def pose_of_plane(plane: Plane) -> tuple[Vector, Quaternion]:
    """Position of a plane and the rotation from z to its normal."""
    return plane.position_m, turned_from_z(plane.normal)


# --- the file ---------------------------------------------------------------------------------


def finish(root: ET.Element, scenario: Scenario, format: str, left_out: Sequence[str]) -> str:
    """The file's text: what it was made from, what is left out, and the elements, indented."""
    lines = [f"{scenario.title}: the scenario {scenario.name} as {format.upper()}, by simcompare"]
    if scenario.parameters:
        values = (f"{name} = {value!r}" for name, value in scenario.parameters.items())
        lines.append(f"Parameters: {', '.join(values)}")
    if left_out:
        lines += ["Not in this file, or only nearly:", *(f"* {text}" for text in left_out)]
    # XML forbids two hyphens in a comment, and some signs anywhere
    text = "\n  ".join(re.sub("-(?=-)", "- ", one_line(line)) for line in lines)
    root.insert(0, ET.Comment(f"\n  {text}\n"))
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def add(parent: ET.Element, tag: str, text: str | None = None, **attributes: str) -> ET.Element:
    """Adds an element."""
    element = ET.SubElement(parent, tag, attributes)
    element.text = text
    return element


def free_name(wanted: str, taken: Iterable[str]) -> str:
    """The wanted name, with as many lines below it as make it the only one."""
    used = set(taken)
    while wanted in used:
        wanted += "_"
    return wanted


def check_names(scenario: Scenario, format: str, reserved: Sequence[str]) -> None:
    """Refuses names that cannot stand in a file of that format.

    Raises:
        InputError: names all of them.
    """
    names = [*scenario.bodies, *scenario.joints, *scenario.sensors]
    faults = [
        f"{name!r} cannot be the name of anything in {format.upper()}; give it another"
        for name in names
        if name in reserved or _is_special(name)
    ]
    if faults:
        raise InputError(f"{scenario.name}, --format {format}", faults)


def _is_special(name: str) -> bool:
    """Whether SDF gives a name a meaning of its own."""
    return name.startswith("__") and name.endswith("__")


# --- what formats cannot hold -----------------------------------------------------------------


def motion_at_start(scenario: Scenario) -> Iterator[str]:
    """Velocities and rates at the start."""
    for name, body in scenario.moving_bodies().items():
        if any((*body.velocity_m_s, *body.rate_rad_s)):
            yield (
                f"motion of {name} at the start: velocity {short(body.velocity_m_s)} m/s,"
                f" rate {short(body.rate_rad_s)} rad/s"
            )
    for name, joint in scenario.movable_joints().items():
        if joint.rate:
            unit = "rad/s" if joint.type == "hinge" else "m/s"
            yield f"rate of the joint {name} at the start: {joint.rate:g} {unit}"


def drag(scenario: Scenario) -> Iterator[str]:
    """Air drag."""
    for name, body in scenario.bodies.items():
        if body.drag is not None and body.drag.factor_kg_m > 0:
            yield f"air drag of {name}: {body.drag.factor_kg_m:g} kg/m times speed squared"


def armatures(scenario: Scenario) -> Iterator[str]:
    """Inertia of motors' rotors, as their joints feel it."""
    for name, law in laws_of(scenario).items():
        if law.armature:
            unit = "kg·m²" if scenario.joints[name].type == "hinge" else "kg"
            yield f"rotor inertia at the joint {name}: {law.armature:g} {unit}"


def drives(scenario: Scenario, how: str = "give the joint {joint}") -> Iterator[str]:
    """Actuators, with the effort that their joint must be given instead.

    Args:
        scenario: the scene.
        how: what to do with the effort; ``{joint}`` stands for the joint's name.
    """
    for name, actuator in scenario.actuators.items():
        alone = scenario.model_copy(update={"actuators": {name: actuator}})
        gain = laws_of(alone)[actuator.joint].gains[actuator.input]
        motor = isinstance(actuator, DcMotor)
        yield (
            f"{name}: {how.format(joint=actuator.joint)} {gain:.9g}"
            f" {'N' if actuator.type == 'force' else 'N·m'} for each"
            f" {'volt' if motor else 'unit'} of the input {actuator.input}"
            f" ({_signal_words(scenario.inputs[actuator.input])})"
            + ("; back-EMF and losses are in the joint's damping and friction" if motor else "")
        )


def contact_sentence(contact: Contact) -> str:
    """Contact of one pair in words."""
    first, second = contact.pair
    return (
        f"contact of {first} and {second}: friction {contact.friction:g},"
        f" restitution {contact.restitution:g}"
    )


def sensors(scenario: Scenario, held: Sequence[str] = ()) -> Iterator[str]:
    """Sensors of other types than the format holds, and what keeps them from being ideal."""
    for name, sensor in scenario.sensors.items():
        if sensor.type not in held:
            place = sensor.body or sensor.joint or "-".join(sensor.pair or ())
            yield f"sensor {name}: {sensor.type} of {place}"
    for name in scenario.sensor_errors():
        yield f"errors of {name}: what a real device would add to its readings"


def joint_faults(scenario: Scenario, ball: bool, limits: bool) -> list[str]:
    """Sentences for ball joints and limits where a format or its writer has none."""
    found: list[str] = []
    for name, joint in scenario.joints.items():
        if joint.type == "ball" and not ball:
            found.append(f"the joint {name} is a ball joint, which cannot be written; try sdf")
        if joint.type in ("ball", "fixed") or not limits:
            bounds: tuple[Any, ...] = (joint.lower, joint.upper)
            if bounds != (None, None):
                found.append(f"the limits of the joint {name} cannot be written")
    return found


def refuse(scenario: Scenario, format: str, faults: Sequence[str]) -> None:
    """Raises an :class:`InputError` if there are faults."""
    if faults:
        raise InputError(f"{scenario.name}, --format {format}", faults)


def _signal_words(signal: Signal) -> str:
    """A signal with its numbers, as the scenario has them."""
    values = signal.model_dump(exclude={"signal"})
    return ", ".join([signal.signal, *(f"{key} {value}" for key, value in values.items())])
