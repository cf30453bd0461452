"""A scenario as a digital twin: the same scene as a file of another simulator.

URDF for CoppeliaSim, PyBullet, DART and RViz; SDF for Gazebo; MJCF for MuJoCo. No format can say
all that a scenario says: what one cannot is listed in ``Twin.left_out`` and in the file's comment.
A script of one engine, which :mod:`simcompare.scripts` writes, is a format too.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simcompare.errors import InputError, UnknownName

if TYPE_CHECKING:
    from simcompare.exporters.parts import Twin
    from simcompare.model.scenario import Scenario
    from simcompare.scenarios.scenario_file import ScenarioFile

#: formats and the usual ending of their files
FORMATS = {"urdf": ".urdf", "sdf": ".sdf", "mjcf": ".xml"}
#: the format that is no digital twin, but a program of one engine
SCRIPT = "script"
#: formats that only one engine reads, which then gets its own fitted parameters
_ENGINE_OF = {"mjcf": "mujoco"}


def export(
    scenario: str | Scenario,
    *,
    format: str = "urdf",
    set: Mapping[str, str | float] | None = None,
    preset: str | None = None,
    fit: str | None = None,
    engine: str | None = None,
    step: str | float | None = None,
    contact: str | None = None,
) -> str:
    """The text of a scenario in another simulator's format, or as a script of one engine.

    ``export("ball", format="script", engine="mujoco", contact="tuned")`` is a program that needs
    only that engine and numpy, the same as ``simcompare export`` writes.

    Args:
        scenario: name, folder or file, or a scenario that has been built already.
        format: "urdf", "sdf", "mjcf" or "script".
        set: parameters that differ from the file; text may carry a unit ("30cm").
        preset: named set of parameters, applied first.
        fit: fit.json of ``simcompare fit``, whose parameters are used.
        engine: engine of a script.
        step: the engine's step in a script, "1ms" or in seconds.
        contact: contact level of a script: "default", "coefficients" or "tuned"; with a fit
            "tuned", else "default".

    Raises:
        SimcompareError: unknown names, faults of the arguments, or what the format cannot hold;
            also a script that reads long inputs from a file beside it
            (:func:`simcompare.exporters.scripts.write.script` gives both).
    """
    options = {"engine": engine, "step": step, "contact": contact}
    if format == SCRIPT:
        return _script(scenario, {**options, "set": set, "preset": preset, "fit": fit})
    given = [name for name, value in options.items() if value is not None]
    if given and format in FORMATS:
        faults = [f"{name} is for the format script, not for {format}" for name in given]
        raise InputError("export", faults)
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
        raise UnknownName("format", format, [*FORMATS, SCRIPT])
    from simcompare.exporters import mjcf, sdf, urdf

    write = {"urdf": urdf.write, "sdf": sdf.write, "mjcf": mjcf.write}[format]
    return write(_resolved(scenario, set or {}, preset, fit, _ENGINE_OF.get(format, "")))


def _script(scenario: str | Scenario, options: Mapping[str, Any]) -> str:
    from simcompare.exporters.scripts import write

    if not isinstance(scenario, str):
        fault = "a script is written from a scenario's name, folder or file; give that"
        raise InputError(scenario.name, [fault])
    made = write.script(scenario, **options)
    if made.inputs:
        raise InputError(
            made.name,
            [
                "the script reads long inputs from a file beside it: simcompare export -o writes"
                " both, and simcompare.exporters.scripts.write.script returns both"
            ],
        )
    return made.text


def _resolved(
    scenario: str | Scenario,
    settings: Mapping[str, str | float],
    preset: str | None,
    fit: str | None,
    engine: str,
) -> Scenario:
    if not isinstance(scenario, str):
        if settings or preset is not None:
            raise InputError(
                scenario.name,
                ["its parameters have their numbers already; set them when it is built"],
            )
        return scenario
    from simcompare.scenarios import catalogue

    file = catalogue.load(scenario)
    known = fitted(file, fit, engine)
    return file.resolve({**known, **file.read_settings(settings)}, preset=preset)


def fitted(file: ScenarioFile, fit: str | None, engine: str) -> dict[str, float]:
    """Parameters of a fit, those of an engine among them; none without a fit."""
    if fit is None:
        return {}
    from simcompare.results import fit_file

    found = fit_file.read(fit_file.find(fit) or Path(fit))
    return {**found.base(file), **(found.of_engine(engine, file) or {})}
