"""Whether a robot can be built as its file says: values, places, balance and wires, all at once."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Mapping

from pydantic import BaseModel

from simcompare.hardware.robot.built import Placed, body_of, placed
from simcompare.hardware.robot.description import Bought, Drive, Robot
from simcompare.hardware.robot.solids import Solid
from simcompare.hardware.robot.wiring import wiring_faults

#: parts that touch may overlap by so much [m]: rounding of what was written
TOUCHING_M = 1e-9
#: how far beside the middle the centre of mass may be [m]: what a calliper tells
BESIDE_M = 1e-4
#: the largest length and mass of a part of a table-top robot
MOST_M, MOST_KG = 1.0, 20.0
#: density of osmium [kg/m³]: nothing on a table is denser (CRC Handbook of Chemistry and Physics)
MOST_KG_M3 = 22_590.0
#: what a package of ROS 2 is called (REP 144), here with what is added to the robot's name
_PACKAGE = re.compile(r"[a-z][a-z0-9_]*")
#: frames that the driver gives (REP 105)
_FRAMES = ("base_link", "odom", "map")
#: a lower density was meant in g/cm³ [kg/m³]: the lightest boards of foam have 12 kg/m³ (ASTM
#: C578, type XI), and copper, denser than what else a chassis is made of, has 8.96 g/cm³ (CRC
#: Handbook)
LEAST_KG_M3 = 10.0
#: what else than lengths says where parts are
_PLACING = ("mirrored", "motor")
#: numbers that may be 0, or have either sign
_ANY = ("position_m", "price")


def faults(robot: Robot) -> dict[str, str]:
    """What of a robot cannot be, as place in its file -> sentence."""
    wrong = {**faults_of_parts(robot, measured=True), **wiring_faults(robot)}
    wrong |= dict(_names(robot))
    keys = {place.rstrip(".0123456789").rpartition(".")[2] for place in wrong}
    if any(key.endswith("_m") or key in _PLACING for key in keys):
        return wrong  # where parts are is not known
    parts = placed(robot)
    apart = {**dict(_twice(parts)), **dict(_below(robot, parts)), **dict(_collisions(parts))}
    if apart or any("kg" in key.split("_") for key in keys):
        return {**apart, **wrong}
    return {**dict(_balance(robot)), **wrong}


def faults_of_parts(robot: Robot, *, measured: bool) -> dict[str, str]:
    """What cannot be whatever is wired to what and placed where.

    Args:
        robot: what its file describes.
        measured: whether chassis, wheels, caster and motor are those of its file.
    """
    return {**_values(robot), **_sources(robot), **(_sizes(robot) if measured else {})}


def _values(robot: Robot) -> dict[str, str]:
    """Masses, sizes and constants that nothing has."""
    found: dict[str, str] = {}
    for place, name, value in _numbers(robot, ""):
        if name.startswith("rotor_"):
            if value < 0:
                found[place] = f"expected a number of at least 0, found {value:g}"
        elif name not in _ANY and not value > 0:
            found[place] = f"expected a number greater than 0, found {value:g}"
        elif name.endswith("_m") and abs(value) > MOST_M:
            found[place] = f"expected at most {MOST_M:g} m, found {value:g}; a millimetre is 0.001"
        elif name == "mass_kg" and value > MOST_KG:
            found[place] = f"expected at most {MOST_KG:g} kg, found {value:g}; a gram is 0.001"
        elif name == "density_kg_m3" and value < LEAST_KG_M3:
            found[place] = (
                f"expected at least {LEAST_KG_M3:g} kg/m³, found {value:g}; 1 g/cm³ is 1000 kg/m³"
            )
        elif name == "density_kg_m3" and value > MOST_KG_M3:
            found[place] = f"expected at most {MOST_KG_M3:g} kg/m³, found {value:g}; water has 1000"
    if robot.motor.drive.efficiency > 1:
        found["motor.drive.efficiency"] = (
            f"expected at most 1, found {robot.motor.drive.efficiency:g}: no gear gives more"
            " than it takes"
        )
    return found


def _numbers(part: BaseModel, place: str) -> Iterator[tuple[str, str, float]]:
    """Every number of a part: its place, its name and its value."""
    for name, value in part:
        where = f"{place}.{name}" if place else name
        if isinstance(value, BaseModel):
            yield from _numbers(value, where)
        elif isinstance(value, Mapping):
            for key, inner in value.items():
                if isinstance(inner, BaseModel):
                    yield from _numbers(inner, f"{where}.{key}")
        elif isinstance(value, tuple):
            yield from ((f"{where}.{i}", name, one) for i, one in enumerate(value))
        elif isinstance(value, float | int) and not isinstance(value, bool) and name != "i2c":
            yield where, name, value


def _sources(robot: Robot) -> dict[str, str]:
    """Parts that do not say where their numbers come from."""
    sections: dict[str, Bought | Drive] = {
        "chassis": robot.chassis, "wheels": robot.wheels, "caster": robot.caster,
        "motor": robot.motor, "motor.drive": robot.motor.drive,
        **{f"parts.{name}": part for name, part in robot.parts.items()},
    }  # fmt: skip
    found = {
        f"{place}.source": "is missing; say where mass and size were read, or how they were chosen"
        for place, one in sections.items()
        if not one.source
    }
    for place, one in sections.items():
        if isinstance(one, Bought) and one.price is not None:
            if one.price < 0:
                found[f"{place}.price"] = f"expected at least 0, found {one.price:g}"
            if not (one.price_source and one.currency):
                found[f"{place}.price"] = "needs price_source and currency; or leave the price out"
    return found


def _sizes(robot: Robot) -> dict[str, str]:
    """Sizes that do not go together."""
    chassis, wheels = robot.chassis, robot.wheels
    between = wheels.track_m - wheels.width_m
    found: dict[str, str] = {}
    if wheels.width_m > chassis.width_m:
        found["wheels.width_m"] = (
            f"{wheels.width_m:g} m is wider than the chassis ({chassis.width_m:g} m);"
            " a millimetre is 0.001"
        )
    elif chassis.width_m > between:
        found["chassis.width_m"] = (
            f"{chassis.width_m:g} m does not fit between the wheels, which leave {between:g} m;"
            " lower it, or raise wheels.track_m"
        )
    if not robot.motor.mirrored:
        found["motor.mirrored"] = "expected true: there is a motor on each side"
    if "motor" in robot.parts:
        found["parts.motor"] = "stands beside parts, as motor; give this part another name"
    if chassis.post_m[1] > chassis.width_m:
        found["chassis.post_m"] = (
            f"{chassis.post_m[1]:g} m is wider than the plate ({chassis.width_m:g} m); lower its"
            " second number"
        )
    return found | _sizes_of_caster(robot)


def _sizes_of_caster(robot: Robot) -> dict[str, str]:
    """The same of the caster, its screws and what they are in."""
    chassis, wheels, caster = robot.chassis, robot.wheels, robot.caster
    found: dict[str, str] = {}
    if 2 * caster.radius_m > caster.height_m:
        found["caster.height_m"] = (
            f"{caster.height_m:g} m is less than the ball's diameter {2 * caster.radius_m:g} m;"
            " raise it, or lower caster.radius_m"
        )
    room = wheels.radius_m + chassis.underside_m
    if caster.height_m >= room:
        found["caster.height_m"] = (
            f"{caster.height_m:g} m is too high: the plate is only {room:g} m above the floor;"
            " lower it, or raise wheels.radius_m or chassis.underside_m"
        )
    inside = caster.screws_m + caster.screw_m
    if inside >= chassis.post_m[1] or caster.screw_m >= chassis.post_m[0]:
        found["caster.screws_m"] = (
            f"the screw holes need {inside:g} m across, and the post has {chassis.post_m[1]:g} m;"
            " raise chassis.post_m"
        )
    elif caster.screws_m <= caster.screw_m:
        found["caster.screws_m"] = (
            f"{caster.screws_m:g} m is no more than the diameter of the holes, so they are one;"
            " raise it, or lower caster.screw_m"
        )
    rear = chassis.length_m - chassis.front_m
    if caster.behind_m + chassis.post_m[0] / 2 > rear:
        found["caster.behind_m"] = (
            f"the post reaches {caster.behind_m + chassis.post_m[0] / 2:g} m behind the axle, and"
            f" the plate {rear:g} m; lower it, or raise chassis.length_m"
        )
    return found


def _names(robot: Robot) -> Iterator[tuple[str, str]]:
    """Names that ROS 2 does not take, and frames that are not one thing each."""
    if not _PACKAGE.fullmatch(robot.name):
        yield (
            "name",
            f"a package of ROS 2 cannot be called so; expected a to z, 0 to 9 and _, such as"
            f" my_robot, found {robot.name!r}",
        )
    owners = {**dict.fromkeys(_FRAMES, "the driver"), robot.body: "the body"}
    for name, part in robot.all_parts.items():
        if part.frame is None:
            continue
        place = "motor.frame" if part is robot.motor else f"parts.{name}.frame"
        if part.mirrored:
            yield place, "there are two of it; leave the frame out, or list both as parts"
        elif part.frame in owners:
            yield place, f"{part.frame} is the frame of {owners[part.frame]}; choose another name"
        owners.setdefault(part.frame, name)


def _twice(parts: tuple[Placed, ...]) -> Iterator[tuple[str, str]]:
    """Parts that are called as others are."""
    for one, other in itertools.combinations(parts, 2):
        if one.name == other.name:
            own = next((p.place for p in (other, one) if p.place.startswith("parts.")), other.place)
            yield own, f"another part is called {one.name}, too; choose another name"


def _below(robot: Robot, parts: tuple[Placed, ...]) -> Iterator[tuple[str, str]]:
    """Parts that reach into the floor."""
    for one in parts:
        depth = max(-robot.wheels.radius_m - float(solid.low_m[2]) for solid in one.solids)
        if depth > TOUCHING_M:
            yield one.place, f"{one.name} is {1000 * depth:.3g} mm below the floor; raise it"


def _collisions(parts: tuple[Placed, ...]) -> Iterator[tuple[str, str]]:
    """Parts that are in the same place; of the chassis its cheeks can be where others are."""
    for mine, theirs in itertools.combinations(parts[0].solids, 2):
        depth = _overlap_m(mine, theirs)
        if depth > TOUCHING_M:
            yield (
                "chassis.cheek_m",
                f"a cheek is {1000 * depth:.3g} mm inside of the other one or of the post; make"
                " them smaller, or place motors or caster elsewhere",
            )
    for one, other in itertools.combinations(parts, 2):
        for mine, theirs in itertools.product(one.solids, other.solids):
            depth = _overlap_m(mine, theirs)
            if depth > TOUCHING_M:
                yield (
                    other.place,
                    f"{other.name} and {one.name} overlap by {1000 * depth:.3g} mm;"
                    " move one of them, or make it smaller",
                )
                break


def _overlap_m(one: Solid, other: Solid) -> float:
    """How far the boxes around two solids reach into each other; negative where they do not."""
    if one.is_hole or other.is_hole:
        return -1.0
    return float(
        min(
            (min(one.high_m[i], other.high_m[i]) - max(one.low_m[i], other.low_m[i]))
            for i in range(3)
        )
    )


def _balance(robot: Robot) -> Iterator[tuple[str, str]]:
    """A centre of mass beside the middle, before the axle or behind the caster."""
    body = body_of(robot)
    x, y, _ = body.center_m.tolist()
    if abs(y) > BESIDE_M:
        name, part = max(
            ((n, p) for n, p in robot.parts.items() if not p.mirrored),
            key=lambda item: item[1].mass_kg,
            default=(None, None),
        )
        cure = "mirror its parts"
        if part is not None:
            cure = (
                f"move {name} to y = {part.position_m[1] - y * body.mass_kg / part.mass_kg:.4g} m,"
                " or mirror parts"
            )
        yield "parts", f"the centre of mass is {1000 * y:.3g} mm beside the middle; {cure}"
    if not -robot.caster.behind_m < x < 0:
        yield (
            "parts",
            f"the centre of mass is at x = {x:.4g} m; the robot stands only if it is between the"
            f" caster ({-robot.caster.behind_m:g} m) and the axle (0): move the battery",
        )
