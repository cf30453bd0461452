"""A scenario as a digital twin: the same scene as a file of another simulator.

URDF for CoppeliaSim, PyBullet, DART and RViz; SDF for Gazebo; MJCF for MuJoCo. No format can say
all that a scenario says: what one cannot is listed in ``Twin.left_out`` and in the file's comment.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from simcompare.errors import UnknownName

if TYPE_CHECKING:
    from simcompare.exporters.parts import Twin
    from simcompare.scenario import Scenario
    from simcompare.scenario_file import ScenarioFile

#: formats and the usual ending of their files
FORMATS = {"urdf": ".urdf", "sdf": ".sdf", "mjcf": ".xml"}
#: formats that only one engine reads, which then gets its own fitted parameters
_ENGINE_OF = {"mjcf": "mujoco"}


def export(
    scenario: str | Scenario,
    *,
    format: str = "urdf",
    set: Mapping[str, str | float] | None = None,
    preset: str | None = None,
    fit: str | None = None,
) -> str:
    """The text of a scenario in another simulator's format.

    Args:
        scenario: name, folder or file, or a scenario that has been built already.
        format: "urdf", "sdf" or "mjcf".
        set: parameters that differ from the file; text may carry a unit ("30cm").
        preset: named set of parameters, applied first.
        fit: fit.json of ``simcompare fit``, whose parameters are used.

    Raises:
        SimcompareError: unknown names, faults of the arguments, or what the format cannot hold.
    """
    return twin(scenario, format=format, set=set, preset=preset, fit=fit).text


def twin(
    scenario: str | Scenario,
    *,
    format: str = "urdf",
    set: Mapping[str, str | float] | None = None,
    preset: str | None = None,
    fit: str | None = None,
) -> Twin:
    """Like :func:`export`, with what is in the text and what had to be left out."""
    if format not in FORMATS:
        raise UnknownName("format", format, FORMATS)
    from simcompare.exporters import mjcf, sdf, urdf

    write = {"urdf": urdf.write, "sdf": sdf.write, "mjcf": mjcf.write}[format]
    return write(_resolved(scenario, set or {}, preset, fit, _ENGINE_OF.get(format, "")))


def _resolved(
    scenario: str | Scenario,
    settings: Mapping[str, str | float],
    preset: str | None,
    fit: str | None,
    engine: str,
) -> Scenario:
    if not isinstance(scenario, str):
        from simcompare.errors import InputError

        if settings or preset is not None:
            raise InputError(
                scenario.name,
                ["its parameters have their numbers already; set them when it is built"],
            )
        return scenario
    from simcompare import catalogue

    file = catalogue.load(scenario)
    known = fitted(file, fit, engine)
    return file.resolve({**known, **file.read_settings(settings)}, preset=preset)


def fitted(file: ScenarioFile, fit: str | None, engine: str) -> dict[str, float]:
    """Parameters of a fit, those of an engine among them; none without a fit."""
    if fit is None:
        return {}
    from simcompare.fitting import fit_file

    found = fit_file.read(fit_file.find(fit) or Path(fit))
    return {**found.base(file), **(found.of_engine(engine, file) or {})}
