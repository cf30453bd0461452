"""The reader of a robot's file; all faults of one at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import ValidationError

from simcompare.errors import InputError
from simcompare.hardware.robot.description import Robot
from simcompare.hardware.robot.possible import faults
from simcompare.model.yaml_file import describe, faults_of, read_yaml

#: the robot that the scenarios are about, and the template of others
OWN = Path(__file__).with_name("robot.yaml")


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
    try:
        return Robot.model_validate(content), {}
    except ValidationError as error:
        return None, faults_of(error, Robot)
