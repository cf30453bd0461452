"""A scenario as a digital twin: the same scene as a file of another simulator.

URDF for CoppeliaSim, PyBullet, DART and RViz; SDF for Gazebo; MJCF for MuJoCo. No format can say
all that a scenario says: what one cannot is listed in ``Twin.left_out`` and in the file's comment.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from simcompare.errors import InputError, UnknownName
from simcompare.exporters import mjcf, sdf, urdf
from simcompare.exporters.fit_values import fitted
from simcompare.exporters.parts import Twin
from simcompare.model.scenario import Scenario
from simcompare.scenarios import catalogue, robot_values

#: formats and the usual ending of their files
FORMATS = {"urdf": ".urdf", "sdf": ".sdf", "mjcf": ".xml"}
#: the format that is no digital twin, but a program of one engine
SCRIPT = "script"
_WRITERS = {"urdf": urdf.write, "sdf": sdf.write, "mjcf": mjcf.write}
#: formats that only one engine reads, which then gets its own fitted parameters
_ENGINE_OF = {"mjcf": "mujoco"}


def twin(
    scenario: str | Scenario,
    *,
    format: str = "urdf",
    set: Mapping[str, str | float] | None = None,
    robot: str | Path | None = None,
    preset: str | None = None,
    fit: str | None = None,
) -> Twin:
    """A scenario in another simulator's format, and what had to be left out.

    Args:
        scenario: name, folder or file, or a scenario that has been built already.
        format: "urdf", "sdf" or "mjcf".
        set: parameters that differ from the file; text may carry a unit ("30cm").
        robot: file of a robot (``simcompare robot --template``), applied before ``set``.
        preset: named set of parameters, applied first.
        fit: fit.json of ``simcompare fit``, whose parameters are used.

    Raises:
        SimcompareError: unknown names, faults of the arguments, or what the format cannot hold.
    """
    if format not in FORMATS:
        raise UnknownName("format", format, [*FORMATS, SCRIPT])
    write = _WRITERS[format]
    if isinstance(scenario, str):
        taken = robot_values.taken(catalogue.load(scenario), robot)
        file = taken.file
        known = {**fitted(file, fit, _ENGINE_OF.get(format, "")), **taken.values}
        made = write(file.resolve({**known, **file.read_settings(set or {})}, preset=preset))
        return replace(made, left_out=(*made.left_out, *taken.left_out))
    if set or robot is not None or preset is not None:
        fault = "its parameters have their numbers already; set them when it is built"
        raise InputError(scenario.name, [fault])
    return write(scenario)
