"""What a scenario takes of the file of a robot: numbers, and how the robot looks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from simcompare.errors import InputError
from simcompare.hardware.robot import built, robot_file
from simcompare.hardware.robot.description import Robot
from simcompare.scenarios.scenario_file import ScenarioFile, out_of_bounds

#: products of inertia that turn the principal axes by less are not worth a word [rad]
_TILT_RAD = math.radians(0.1)
#: parameters of scenarios whose robot is built as one of a file
_CENTER = ("center_height_m", "center_behind_m")


@dataclass(frozen=True)
class Taken:
    """A scenario with a robot.

    Attributes:
        file: the scenario; where it is built as a file's robot is, that looks as its parts do.
        values: of those parameters that it has, SI.
        left_out: what of the robot it does not take, a sentence without a full stop each.
    """

    file: ScenarioFile
    values: Mapping[str, float] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()


def taken(file: ScenarioFile, robot: str | Path | None) -> Taken:
    """What a scenario takes of a robot.

    Args:
        file: the scenario.
        robot: file of the robot; nothing is taken without one.

    Raises:
        InputError: no such file or no robot, a scenario without any of these parameters, or values
            that it does not take.
    """
    if robot is None:
        return Taken(file)
    made = robot_file.read(robot)
    known = built.parameters(made)
    values = {name: value for name, value in known.items() if name in file.parameters}
    if not values:
        raise InputError(
            f"--robot {robot}",
            [
                f"the scenario {file.name} has no parameter of a robot; it needs some of:"
                f" {', '.join(known)}"
            ],
        )
    faults = out_of_bounds(values, file.parameters)
    if faults:
        raise InputError(f"--robot {robot}, scenario {file.name}", list(faults.values()))
    if all(name in values for name in _CENTER):
        return Taken(_drawn(file, made), values, about_tilt(made))
    some = f"{file.name} takes only {', '.join(values)} from the robot's file; all else is its own"
    return Taken(file, values, (some,))


def _drawn(file: ScenarioFile, robot: Robot) -> ScenarioFile:
    """The scenario with the robot's parts as the shapes that are drawn of its body."""
    bodies = file.tree["bodies"]
    if robot.body not in bodies:
        return file
    visual = [shape.model_dump(mode="json") for shape in built.drawn(robot)]
    seen = {**bodies, robot.body: {**bodies[robot.body], "visual": visual}}
    return replace(file, tree={**file.tree, "bodies": seen})


def about_tilt(made: Robot) -> tuple[str, ...]:
    """That scenarios know no product of inertia, where that is worth a word."""
    tilt = built.tilt_rad(made)
    if abs(tilt) <= _TILT_RAD:
        return ()
    return (
        "scenarios leave out the robot's product of inertia I_xz ="
        f" {built.products_kg_m2(made)[1]:.3g} kg·m², which turns its principal axes by"
        f" {math.degrees(tilt):.2g}° (the models of simcompare robot have it); on a floor only the"
        " loads of the wheels in a curve are a little off",
    )
