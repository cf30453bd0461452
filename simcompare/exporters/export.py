"""The text of a scenario for another simulator, or for one engine."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from simcompare.arguments import checked
from simcompare.errors import InputError
from simcompare.exporters.scripts.write import script
from simcompare.exporters.twins import FORMATS, SCRIPT, twin
from simcompare.model.scenario import Scenario


@checked
def export(
    scenario: str | Path | Scenario,
    *,
    format: str = "urdf",
    set: Mapping[str, str | float] | None = None,
    preset: str | None = None,
    fit: str | None = None,
    own: Mapping[str, str | float] | None = None,
    engine: str | None = None,
    step: str | float | None = None,
    contact: str | None = None,
) -> str:
    """The text of a scenario in another simulator's format, or as a script of one engine.

    ::

        simcompare.export("robot", format="urdf")
        # a program that needs only that engine and numpy
        simcompare.export("ball", format="script", engine="mujoco", contact="tuned")

    Args:
        scenario: name, folder or file, or a scenario that has been built already.
        format: "urdf", "sdf", "mjcf" or "script".
        set: parameters that differ from the file; text may carry a unit ("30cm").
        preset: named set of parameters, applied first.
        fit: fit.json of ``simcompare fit``, whose parameters are used.
        own: contact values of the engine of a script, such as ``{"pymunk.elasticity": 0.9}``.
        engine: engine of a script.
        step: the engine's step in a script, "1ms" or in seconds.
        contact: contact level of a script: "default", "coefficients" or "tuned"; with a fit
            "tuned", else "default".

    Raises:
        SimcompareError: unknown names, faults of the arguments, or what the format cannot hold;
            also a script that reads long inputs from a file beside it
            (:func:`simcompare.exporters.scripts.write.script` gives both).
    """
    scenario = str(scenario) if isinstance(scenario, Path) else scenario
    if format != SCRIPT:
        options = {"engine": engine, "step": step, "contact": contact, "own": own or None}
        given = [name for name, value in options.items() if value is not None]
        if given and format in FORMATS:
            faults = [f"{name} is for the format script, not for {format}" for name in given]
            raise InputError("export", faults)
        return twin(scenario, format=format, set=set, preset=preset, fit=fit).text
    if not isinstance(scenario, str):
        fault = "a script is written from a scenario's name, folder or file; give that"
        raise InputError(scenario.name, [fault])
    made = script(
        scenario,
        engine=engine,
        set=set,
        preset=preset,
        fit=fit,
        own=own,
        step=step,
        contact=contact,
    )
    if made.inputs:
        raise InputError(
            made.name,
            [
                "the script reads long inputs from a file beside it: simcompare export -o writes"
                " both, and simcompare.exporters.scripts.write.script returns both"
            ],
        )
    return made.text
