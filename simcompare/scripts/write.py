"""Puts a script together."""

from __future__ import annotations

import importlib.metadata
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from simcompare import catalogue, engines, experiment, units
from simcompare.backend import Backend, EngineBackend, refuse
from simcompare.drop_plan import drop_plans
from simcompare.errors import InputError, Unsupported
from simcompare.fitting import fit_file
from simcompare.scenario import Scenario
from simcompare.scenario_file import ScenarioFile
from simcompare.scripts.contract import RESERVED, Parts, Plan, joint_parts, script_of
from simcompare.scripts.efforts import efforts_of
from simcompare.scripts.expected import Expected, expected_of
from simcompare.scripts.measuring import Measuring
from simcompare.scripts.snippets import SNIPPETS
from simcompare.scripts.text import WIDTH, number
from simcompare.settings import CONTACT_LEVELS, DEFAULT, TUNED, Settings
from simcompare.trajectory import BODY_SIGNALS, Array
from simcompare.tuning import tuned

#: contact levels that a plain loop with one step can have, and what they are
LEVELS = {
    "default": "the engine as it comes",
    "coefficients": "the engine as it comes, with the scenario's restitution and friction",
    "tuned": "the engine's own solver, with its own public parameters",
}


@dataclass(frozen=True)
class Script:
    """A script and what it needs.

    Attributes:
        name: of its file, without the ending.
        text: its source.
        inputs: arrays of the file ``<name>_inputs.npz`` beside it; none where it needs no file.
        bodies: bodies that move.
        joints: joints in it.
    """

    name: str
    text: str
    inputs: Mapping[str, Array] = field(default_factory=dict)
    bodies: Sequence[str] = ()
    joints: Sequence[str] = ()


def script(
    scenario: str,
    *,
    engine: str | None,
    set: Mapping[str, str | float] | None = None,
    preset: str | None = None,
    fit: str | None = None,
    step: str | float | None = None,
    contact: str | None = None,
    name: str | None = None,
) -> Script:
    """One scenario in one engine as a standalone script.

    Args:
        scenario: name, folder or file.
        engine: name of the engine.
        set: parameters that differ from the file; text may carry a unit ("30cm").
        preset: named set of parameters, applied first.
        fit: fit.json of ``simcompare fit``; the engine gets its own parameters.
        step: the engine's step, "1ms" or in seconds.
        contact: "default", "coefficients" or "tuned"; with a fit "tuned", else "default".
        name: of the script's file, without the ending.

    Raises:
        SimcompareError: faults of the arguments, or an engine that is missing or cannot do it.
    """
    if engine is None:
        raise InputError(
            "--engine", [f"a script is of one engine; give one of {', '.join(engines.names())}"]
        )
    chosen = engines.get(engine)
    writer = script_of(chosen)
    assert isinstance(chosen, EngineBackend), "only those have a method script()"
    level = level_of(contact, fit)
    file = catalogue.load(scenario)
    values = _values(file, engine, set or {}, fit)
    step_s = None if fit is None else _read(fit).usual_step_s
    if step is not None:
        step_s = experiment.sample_step_s(file, values, preset, step)
    repeats = experiment.repeats_of(file, values, preset, step_s, None)
    nominal = repeats[len(repeats) // 2]
    shifted = _shifted(file, nominal)
    chosen.version()
    settings, tuning = _settings(chosen, level, nominal, fit)
    expected = expected_of(file, engine, repeats, shifted, settings)
    efforts, inputs = efforts_of(nominal)
    plan = Plan(nominal, shifted, settings, efforts, _lacking(chosen, nominal, settings), tuning)
    parts = writer.parts(chosen, plan)
    named = name or f"{nominal.name}_{engine}"
    text, stored = _text(named, chosen, plan, parts, expected, inputs)
    return Script(named, text, stored, tuple(nominal.moving_bodies()), tuple(nominal.joints))


def _read(fit: str) -> fit_file.FitFile:
    return fit_file.read(fit_file.find(fit) or Path(fit))


def _settings(
    engine: EngineBackend, level: str, nominal: Scenario, fit: str | None
) -> tuple[Settings, Sequence[Mapping[str, Any]]]:
    """How the engine is run; tuned, with the numbers for all restitutions, and their records.

    Raises:
        InputError: there are none at this step, or the fit is not one for a plain loop.
    """
    if level != TUNED:
        return Settings(level), ()
    asked = Settings(level, drops=drop_plans(nominal))
    if fit is not None:
        asked = _read(fit).settings(engine.name, nominal)
        if asked.contact != TUNED:
            raise InputError(
                f"--fit {fit}", ["was made with our helps; fit again without --assist for a script"]
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


def level_of(contact: str | None, fit: str | None) -> str:
    """The contact level that is asked for.

    Raises:
        InputError: it has no plain loop, or does not exist.
    """
    level = contact or ("tuned" if fit is not None else DEFAULT)
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
    file: ScenarioFile, engine: str, settings: Mapping[str, str | float], fit: str | None
) -> dict[str, float]:
    own = file.read_settings(settings)
    if fit is None:
        return own
    from simcompare import exporters

    # the drop that was measured, unless another one is asked for
    measured = _read(fit).drop(file)
    return {**exporters.fitted(file, fit, engine), **measured, **own}


def _shifted(file: ScenarioFile, nominal: Scenario) -> Scenario | None:
    if nominal.dither is None:
        return None
    name = nominal.dither.parameter
    return file.vary(nominal, name, nominal.parameters[name] + nominal.dither.span)


def _text(
    name: str,
    engine: Backend,
    plan: Plan,
    parts: Parts,
    expected: Sequence[Expected],
    inputs: Mapping[str, Array],
) -> tuple[str, dict[str, Array]]:
    measuring = Measuring(plan.scenario, _taken(plan), _recorded(plan))
    table = _table(measuring, expected, plan.lacking)
    stored = {**inputs, **measuring.stored}
    functions = [line for lines in measuring.functions.values() for line in ["", "", *lines]]
    lines = [*_head(name, engine, plan, stored)]
    lines += ["import sys", ""] if plan.shifted is not None else []
    lines += [*sorted(["import numpy as np", *parts.imports]), ""]
    if plan.shifted is not None:
        lines.append("phase = float(sys.argv[1]) if len(sys.argv) > 1 else 0.0")
    world = plan.scenario.world
    steps = round(world.duration_s / world.step_s)
    lines.append(f"step_s, steps = {number(world.engine_step_s)}, {steps * world.substeps}")
    if stored:
        lines.append('inputs = np.load(__file__.replace(".py", "_inputs.npz"))')
    lines += [f'given_{joint} = inputs["{joint}"].tolist()' for joint in inputs]
    lines += _spaced(parts.helpers)
    lines += ["", *parts.scene, *parts.now, *parts.forces, "", "", *_loop(plan, parts)]
    lines += [
        "",
        f"t = np.arange(len(rows)) * {number(world.step_s)}",
        "motion = {name: np.array([row[name] for row in rows]) for name in rows[0]}",
        'np.savez(__file__.replace(".py", "_motion.npz"), t=t, **motion)',
        *functions,
        *(["", ""] if functions else [""]),
        *measuring.lines,
        *table,
    ]
    return "\n".join(_tidied(lines)) + "\n", stored


def _spaced(lines: Sequence[str]) -> list[str]:
    return ["", "", *lines, ""] if lines else []


def _tidied(lines: Sequence[str]) -> list[str]:
    """At most two blank lines in a row."""
    found: list[str] = []
    for line in lines:
        if line == "" and found[-2:] == ["", ""]:
            continue
        found.append(line)
    return found


def _taken(plan: Plan) -> set[str]:
    """Names that a measured quantity must not have."""
    return {*RESERVED, *plan.scenario.bodies, *plan.scenario.joints}


def _recorded(plan: Plan) -> frozenset[str]:
    bodies = {f"{n}.{part}" for n in plan.scenario.moving_bodies() for part in BODY_SIGNALS}
    joints = {signal for pair in joint_parts(plan).values() for signal in pair}
    forces = {f"{name}.force_N" for name in plan.sensed_joints}
    normals = {f"{name}.normal_force_N" for name in plan.sensed_pairs}
    return frozenset(bodies | joints | forces | normals)


def _head(name: str, engine: Backend, plan: Plan, stored: Mapping[str, Array]) -> list[str]:
    scenario, level = plan.scenario, plan.settings.contact
    own = importlib.metadata.version("simcompare")
    text = f"Written by simcompare {own} from its scenario {scenario.name}."
    text += f" It reads {name}_inputs.npz." if stored else ""
    text += f" Run: python {name}.py"
    dither = scenario.dither
    if dither is not None:
        unit = units.unit_of(dither.parameter) or ""
        text += (
            f" [PHASE]; PHASE, 0 to 1, adds that part of {dither.span:.4g} {unit} to"
            f" {dither.parameter}."
        )
    title = f"{scenario.title} in {engine.name} {engine.version()}."
    text = f"Contact level {level}: {LEVELS[level]}. {_told(plan)}{text}"
    return [f'"""{title}', "", *textwrap.wrap(text, WIDTH), '"""', ""]


def _told(plan: Plan) -> str:
    """What numbers for a restitution were sought for, and how one drop scatters with them."""
    said = ""
    for record in plan.tuning:
        at = record["at"][0] if record["at"] else None
        if at is not None:
            said += (
                f"Its numbers for a restitution of {record['restitution']:.6g} are for impacts at"
                f" {at['speed_m_s']:.3g} m/s; one drop scatters by {at['scatter']:.2g}, depending"
                " on where in a step it falls. "
            )
    return said


def _loop(plan: Plan, parts: Parts) -> list[str]:
    substeps, forces = plan.scenario.world.substeps, bool(parts.forces)
    advance = [*parts.drive, *parts.before, parts.step]
    whole = f"if k % {substeps} == 0:"
    if forces and not parts.lead:
        see, hear = "rows.append(now())", "rows[-1].update(forces())"
        body = [see, *advance, hear]
        if substeps > 1:
            body = [whole, f"    {see}", *advance, whole, f"    {hear}"]
        note = "# one step more: the forces of a step act at its start"
        return ["rows = []", f"for k in range(steps + 1):  {note}", *_indented(body)]
    seen = "now() | forces()" if forces else "now()"
    body = [*advance, f"rows.append({seen})"]
    if substeps > 1:
        body = [*advance, f"if (k + 1) % {substeps} == 0:", f"    rows.append({seen})"]
    lines = ["rows = [now()]", "for k in range(steps):", *_indented(body)]
    if forces:
        lines.append("rows[0] = rows[1] | rows[0]  # the forces of a step act at its end")
    return lines


def _indented(lines: Sequence[str]) -> list[str]:
    return [f"    {line}" if line else "" for line in lines]


def _table(
    measuring: Measuring, expected: Sequence[Expected], lacking: frozenset[str]
) -> list[str]:
    """Lines that print what was measured, beside what is expected."""
    from simcompare.cli.console import number as told

    done: dict[int, Mapping[str, str]] = {}
    rows = []
    for one in expected:
        key = id(one.measure)
        if key not in done:
            seen = (one.measure.probe, *one.measure.also.values())
            lacks = any(measuring.scenario.probes[name].observe in lacking for name in seen)
            snippet = None if lacks else SNIPPETS.get(one.measure.function)
            done[key] = {} if snippet is None else snippet(measuring, one.measure, one.truth)
        value = done[key].get(one.own, "np.nan")
        score = one.score
        row = (f"{one.name} [{score.unit}]", told(score.truth), told(score.value, score.u))
        whole = f'    ("{row[0]}", {value}, "{row[1]}", "{row[2]}"),'
        rows += [whole]
        if len(whole) > WIDTH:
            rows[-1:] = [f'    ("{row[0]}", {value},', f'     "{row[1]}", "{row[2]}"),']
    if not rows:
        return []
    return [
        "for name, value, exact, run in (",
        *rows,
        "):",
        '    print(f"{name:<30}{value:<14.7g} closed form {exact:<12} simcompare {run}")',
    ]
