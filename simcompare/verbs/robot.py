"""The verb ``robot``: all that follows from the file of a robot, written into a folder."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from simcompare.arguments import checked
from simcompare.errors import InputError, UnknownName
from simcompare.exporters.products import with_products
from simcompare.exporters.twins import FORMATS, twin
from simcompare.hardware.robot import bill, built, cad, robot_file
from simcompare.hardware.robot.cad import CadMissing
from simcompare.hardware.robot.description import Robot
from simcompare.hardware.robot.ros_package import CONTROLLER, package_files
from simcompare.model.scenario import Scenario
from simcompare.reports.render import output
from simcompare.scenarios import catalogue, robot_values


@dataclass(frozen=True)
class RobotParts:
    """A robot, and what follows from its file.

    Attributes:
        name: of the robot. title: in words.
        mass_kg: of all of it.
        parameters: what follows, by the names of scenarios' parameters, SI.
        products_kg_m2: products of inertia I_xy, I_xz, I_yz of all but the wheels.
        unconfirmed: parts whose mass or size was read in no source.
        files: what was written.
        left_out: what was not written or is not in it, and why.
    """

    name: str
    title: str
    mass_kg: float
    parameters: Mapping[str, float]
    products_kg_m2: tuple[float, float, float]
    unconfirmed: tuple[str, ...]
    files: tuple[Path, ...]
    left_out: tuple[str, ...]


@checked
def robot(robot: str | Path | None = None, *, out: str | Path | None = None) -> RobotParts:
    """Reads the file of a robot and writes all that follows from it.

    ::

        simcompare.robot().parameters            # of our own robot
        simcompare.robot("my.yaml", out="my_robot").files

    Args:
        robot: file of a robot, as ``simcompare robot --template`` begins one; ours where left out.
        out: folder for the descriptions (URDF, SDF, MJCF), drawings (STEP, STL), tables (bill of
            materials, wiring, pins) and the package for ROS 2; nothing is written where ``None``.

    Raises:
        InputError: the file is no robot's, or describes what cannot be built; names all faults.
        OutputError: a file of others is in the way, or it cannot be written.
    """
    made = robot_file.read(robot)
    left_out: list[str] = []
    files: list[Path] = []
    if out is not None:
        contents = list(_contents(made, robot, left_out))
        for path, content in contents:  # nothing is written where one of them cannot be
            output.free(Path(out) / path, _mark(path, content))
        for path, content in contents:
            files.append(output.write(Path(out) / path, content, _mark(path, content)))
    values = built.parameters(made)
    return RobotParts(
        made.name, made.title, sum(one.mass_kg for one in built.placed(made)), values,
        built.products_kg_m2(made),
        tuple(name for name, _, part, _ in bill.parts(made) if not part.confirmed),
        tuple(files), (*left_out, *robot_values.about_tilt(made)),
    )  # fmt: skip


def template() -> str:
    """Our own robot's file, with remarks."""
    return robot_file.OWN.read_text(encoding="utf-8")


def _contents(
    made: Robot, robot: str | Path | None, left_out: list[str]
) -> Iterator[tuple[str, bytes]]:
    """Path -> content of every file, the drawings last; what is missing is told."""
    scenario = _scenario(made, robot or robot_file.OWN)
    products = {made.body: built.products_kg_m2(made)}
    for format, ending in FORMATS.items():
        text = with_products(twin(scenario, format=format), products).text
        yield f"{made.name}{ending}", text.encode()
        if format == "urdf":
            package = package_files(made, text)
            for path, part in package.items():
                yield path, part.encode()
            if not any(path.endswith(CONTROLLER) for path in package):
                left_out.append("the controller's program: it is for the parts and pins of ours")
    yield "bill_of_materials.csv", bill.bill(made).encode()
    yield "wiring.csv", bill.wiring(made).encode()
    yield "pins.csv", bill.pins(made).encode()
    chassis = built.chassis_solids(made)
    try:
        yield "chassis.step", cad.step({"chassis": chassis}, made.title)
        yield "chassis.stl", cad.stl(chassis)
        yield (
            f"{made.name}.step",
            cad.step({one.name: one.solids for one in built.placed(made)}, made.title),
        )
    except CadMissing as missing:
        left_out.append(str(missing))


def _scenario(made: Robot, path: str | Path) -> Scenario:
    """The scenario of a robot, with its numbers.

    Raises:
        InputError: there is no such scenario, or it has no such body, or that is not the robot's.
    """
    try:
        taken = robot_values.taken(catalogue.load(made.scenario), path)
    except UnknownName as error:
        raise InputError(str(path), [f"scenario: {error}"]) from None
    scenario = taken.file.resolve(taken.values)
    mass_kg = built.body_of(made).mass_kg
    fitting = [
        name
        for name, body in scenario.bodies.items()
        if not body.fixed and math.isclose(body.mass_kg or 0.0, mass_kg, rel_tol=1e-9)
    ]
    if made.body not in fitting:
        what = f"body of the robot in the scenario {scenario.name}"
        raise InputError(str(path), [f"body: {UnknownName(what, made.body, fitting)}"])
    return scenario


def _mark(path: str, content: bytes) -> bytes:
    """What each of our files of this kind holds, and those of others do not."""
    if path.endswith(".csv"):
        return content.partition(b"\n")[0]
    return cad.MADE_BY if content else b""
