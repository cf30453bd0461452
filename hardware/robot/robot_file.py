"""The reader of a robot's file; all faults of one at once."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from simcompare.errors import InputError
from simcompare.hardware.robot.description import Robot
from simcompare.hardware.robot.possible import faults, faults_of_parts
from simcompare.model.yaml_file import describe, faults_of, read_yaml

#: the robot that the scenarios are about, and the template of others
OWN = Path(__file__).with_name("robot.yaml")
#: sections whose sizes must go together
_MEASURED = ("chassis", "wheels", "caster", "motor")


def read(path: str | Path | None = None) -> Robot:
    """Reads a robot's file; ours where none is named.

    Raises:
        InputError: it is no such file, or it describes what cannot be built; names all faults.
    """
    path = OWN if path is None else Path(path)
    content, lines, found = read_yaml(path)
    if not isinstance(content, dict):
        raise InputError(
            str(path),
            ["is no file of a robot; begin one with: simcompare robot --template > my.yaml"],
        )
    robot, wrong = _robot(content)
    found = {**wrong, **found}
    if robot is not None:
        found |= faults(robot)
    if robot is None or found:
        raise InputError(str(path), describe(found, lines))
    return robot


def _robot(content: dict[str, Any]) -> tuple[Robot | None, dict[str, str]]:
    """The robot; ``None`` where it cannot be read, with what is wrong, also in what can be read."""
    try:
        return Robot.model_validate(content), {}
    except ValidationError as error:
        wrong, unread = faults_of(error, Robot), error.errors()
    lacking = {item["loc"][0] for item in unread if item["type"] != "extra_forbidden"}
    try:
        filled = Robot.model_validate(_filled(content, [item["loc"] for item in unread]))
        rest = faults_of_parts(filled, measured=lacking.isdisjoint(_MEASURED))
    except (ValidationError, KeyError):
        rest = {}
    return None, {**rest, **wrong}


def _filled(content: dict[str, Any], unread: Iterable[tuple[int | str, ...]]) -> dict[str, Any]:
    """The same with values of our own robot, which are right, in places that cannot be read."""
    own, _, _ = read_yaml(OWN)
    filled = copy.deepcopy(content)
    for place in unread:
        keys = [str(key) for key in itertools.takewhile(_is_key, place)]
        here, ours = filled, own
        for key in keys[:-1]:  # of a part that ours has not, another one stands in
            here, ours = here[key], ours[key] if key in ours else own["parts"]["imu"]
        here.pop(keys[-1], None)
        if keys[-1] in ours:
            here[keys[-1]] = ours[keys[-1]]
    return filled


def _is_key(part: int | str) -> bool:
    return isinstance(part, str) and part != "[key]"
