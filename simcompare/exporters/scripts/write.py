"""Puts a script together."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from simcompare.comparison.repeats import repeats_of, sample_step_s
from simcompare.engine import by_hand, engines
from simcompare.engine.backend import EngineBackend, refuse
from simcompare.engine.by_hand import OPTION
from simcompare.engine.calibration.plan import drop_plans
from simcompare.engine.calibration.tuned import tuned
from simcompare.engine.scripting.contract import Plan, script_of
from simcompare.engine.scripting.efforts import efforts_of
from simcompare.errors import InputError, SimcompareError, Unsupported
from simcompare.exporters import fit_values
from simcompare.exporters.scripts.assemble import assembled
from simcompare.exporters.scripts.expected import expected_of
from simcompare.model.scenario import Scenario
from simcompare.model.settings import CONTACT_LEVELS, DEFAULT, TUNED, Settings
from simcompare.model.trajectory import Array
from simcompare.model.tuning import TuningRow
from simcompare.scenarios import catalogue, robot_values
from simcompare.scenarios.scenario_file import ScenarioFile

#: contact levels that a plain loop with one step can have
LEVELS = ("default", "coefficients", "tuned")


@dataclass(frozen=True)
class Script:
    """A script and what it needs.

    Attributes:
        name: of its file, without the ending.
        text: its source.
        inputs: arrays of the file ``<name>_inputs.npz`` beside it; none where it needs no file.
        bodies: bodies that move.
        joints: joints in it.
        left_out: what of a robot it does not hold, one sentence each.
    """

    name: str
    text: str
    inputs: Mapping[str, Array] = field(default_factory=dict)
    bodies: Sequence[str] = ()
    joints: Sequence[str] = ()
    left_out: Sequence[str] = ()


def script(
    scenario: str,
    *,
    engine: str | None,
    set: Mapping[str, str | float] | None = None,
    robot: str | Path | None = None,
    preset: str | None = None,
    fit: str | None = None,
    own: Mapping[str, str | float] | None = None,
    step: str | float | None = None,
    contact: str | None = None,
    name: str | None = None,
) -> Script:
    """One scenario in one engine as a standalone script.

    Args:
        scenario: name, folder or file.
        engine: name of the engine.
        set: parameters that differ from the file; text may carry a unit ("30cm").
        robot: file of a robot (``simcompare robot --template``), applied before ``set``.
        preset: named set of parameters, applied first.
        fit: fit.json of ``simcompare fit``; the engine gets its own parameters.
        own: contact values of the engine, such as ``{"pymunk.elasticity": 0.9}``, in place of those
            that would be found for it.
        step: the engine's step, "1ms" or in seconds.
        contact: "default", "coefficients" or "tuned"; with a fit "tuned", else "default".
        name: of the script's file, without the ending.

    Raises:
        SimcompareError: faults of the arguments, or an engine that is missing or cannot do it.
    """
    if engine is None:
        raise InputError(
            "--engine", [f"a script is of one engine; give one of {', '.join(_with_scripts())}"]
        )
    chosen = engines.get(engine)
    writer = script_of(chosen)
    assert isinstance(chosen, EngineBackend), "only those have a method script()"
    level = level_of(contact, fit, own)
    taken = robot_values.taken(catalogue.load(scenario), robot)
    file = taken.file
    values = _values(file, engine, {**taken.values, **file.read_settings(set or {})}, fit)
    step_s = None if fit is None else fit_values.read(fit).usual_step_s
    if step is not None:
        step_s = sample_step_s(file, values, preset, step)
    repeats = repeats_of(file, values, preset, step_s, None)
    nominal = repeats[len(repeats) // 2]
    if looking := nominal.range_sensors():
        fault = "a script casts no rays; write it as urdf, sdf or mjcf, or run it in simcompare"
        raise InputError(f"sensor {', '.join(looking)} of {nominal.name}", [fault])
    shifted = _shifted(file, nominal)
    chosen.version()
    settings, tuning = _settings(chosen, level, nominal, fit, own or {})
    expected = expected_of(file, engine, repeats, shifted, settings)
    efforts, inputs = efforts_of(nominal)
    plan = Plan(
        nominal, shifted, settings, efforts, _lacking(chosen, nominal, settings), tuning, bool(own)
    )
    parts = writer.parts(chosen, plan)
    named = name or f"{nominal.name}_{engine.replace(engines.VARIANT, '_')}"
    text, stored = assembled(named, chosen, plan, parts, expected, inputs)
    return Script(
        named, text, stored, tuple(nominal.moving_bodies()), tuple(nominal.joints), taken.left_out
    )


def _settings(
    engine: EngineBackend,
    level: str,
    nominal: Scenario,
    fit: str | None,
    own: Mapping[str, str | float],
) -> tuple[Settings, Sequence[TuningRow]]:
    """How the engine is run; tuned, with the numbers for all restitutions and how they were found.

    Raises:
        InputError: there are none at this step, or the fit is not one for a plain loop.
    """
    if level != TUNED:
        return Settings(level), ()
    asked = Settings(level, drops=drop_plans(nominal))
    typed = by_hand.read(own, [engine.name], nominal).settings(engine.name, nominal)
    if typed is not None:
        asked = typed
    elif fit is not None:
        asked = fit_values.read(fit).settings(engine.name, nominal)
        if asked.contact != TUNED:
            raise InputError(
                f"--fit {fit}",
                ["was made with our helps; a script needs one of simcompare fit without --assist"],
            )
    try:
        refuse(engine, nominal, asked)
        return tuned(engine, engine.load(), nominal, asked)
    except Unsupported as error:
        raise InputError(f"--engine {engine.name}", [str(error)]) from None


def _lacking(engine: EngineBackend, nominal: Scenario, settings: Settings) -> frozenset[str]:
    """Signals that the engine does not give."""
    try:
        opened = engine.open(nominal, settings)
    except Unsupported:  # the run that follows says why
        return frozenset()
    try:
        return frozenset(opened.lacks)
    finally:
        opened.close()


def level_of(
    contact: str | None, fit: str | None, own: Mapping[str, str | float] | None = None
) -> str:
    """The contact level that is asked for.

    Raises:
        InputError: it has no plain loop, or does not exist.
    """
    if own and contact not in (None, TUNED):
        fault = f"{OPTION} gives values for a bounce, and all else is as in {TUNED}; leave it out"
        raise InputError(f"--contact {contact}", [fault])
    level = contact or ("tuned" if fit is not None or own else DEFAULT)
    if level in ("assisted", "mapped"):
        raise InputError(
            f"--contact {level}",
            [
                "is no plain loop: simcompare lands on impacts and computes efforts in each step,"
                f" which a script without simcompare cannot; use {', '.join(LEVELS)}"
            ],
        )
    if level not in LEVELS or level not in CONTACT_LEVELS:
        known = [name for name in LEVELS if name in CONTACT_LEVELS]
        raise InputError(f"--contact {level}", [f"is no level of a script; use {', '.join(known)}"])
    return level


def _values(
    file: ScenarioFile, engine: str, own: Mapping[str, float], fit: str | None
) -> Mapping[str, float]:
    if fit is None:
        return own
    # the drop that was measured, unless another one is asked for
    measured = fit_values.read(fit).drop(file)
    return {**fit_values.fitted(file, fit, engine), **measured, **own}


def _shifted(file: ScenarioFile, nominal: Scenario) -> Scenario | None:
    if nominal.dither is None:
        return None
    name = nominal.dither.parameter
    return file.vary(nominal, name, nominal.parameters[name] + nominal.dither.span)


def _with_scripts() -> Iterator[str]:
    """Engines whose scenes can be written as scripts."""
    for name in engines.names():
        with contextlib.suppress(SimcompareError):
            script_of(engines.get(name))
            yield name
