"""Puts a script together, in no more lines than it may have."""

from __future__ import annotations

import importlib.metadata
import textwrap
from collections.abc import Mapping, Sequence

from simcompare import notation, units
from simcompare.engine.backend import Backend
from simcompare.engine.scripting.contract import RESERVED, Parts, Plan, joint_parts
from simcompare.engine.scripting.text import WIDTH, filled, in_docstring, number, unused
from simcompare.exporters.scripts.expected import Expected
from simcompare.exporters.scripts.measuring import Measuring
from simcompare.exporters.scripts.snippets import SNIPPETS
from simcompare.model.settings import BY_HAND
from simcompare.model.trajectory import BODY_SIGNALS, Array

#: most lines of a script where one body moves, and elsewhere
MAX_LINES = (60, 120)
#: longest expression that is printed as it is
_MAX_LENGTH = 32
#: what begins and ends the text at the head
_END = '"""'
#: what a contact level is
_LEVELS = {
    "default": "as it comes",
    "coefficients": "as it comes, with restitution and friction set",
    "tuned": "tuned by its own parameters",
    BY_HAND: "with values set by hand",
}


def assembled(
    name: str,
    engine: Backend,
    plan: Plan,
    parts: Parts,
    expected: Sequence[Expected],
    inputs: Mapping[str, Array],
) -> tuple[str, dict[str, Array]]:
    """The text of a script, and the arrays for its file of inputs.

    It prints what is measured, in order, as far as there is room; the first in any case.
    """
    most = MAX_LINES[len(plan.scenario.moving_bodies()) > 1]
    chosen = list(expected[:1])
    text, stored = _text(name, engine, plan, parts, chosen, inputs)
    for one in expected[1:]:
        longer, needed = _text(name, engine, plan, parts, [*chosen, one], inputs)
        if longer.count("\n") <= most:
            chosen.append(one)
            text, stored = longer, needed
    return text, stored


def _text(
    name: str,
    engine: Backend,
    plan: Plan,
    parts: Parts,
    expected: Sequence[Expected],
    inputs: Mapping[str, Array],
) -> tuple[str, dict[str, Array]]:
    measuring = Measuring(plan.scenario, _taken(plan), _recorded(parts, plan))
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
    lines += _given(inputs)
    lines += ["", "", *parts.helpers, "", ""] if parts.helpers else [""]
    lines += [*parts.scene, "", *_loop(plan, parts), ""]
    lines += _names(plan, parts)
    lines += [
        f"t = np.arange(len(rows)) * {number(world.step_s)}",
        "motion = {name: np.array(values) for name, values in zip(signals, zip(*rows))}",
        'np.savez(__file__.replace(".py", "_motion.npz"), t=t, **motion)',
        *functions,
        *(["", ""] if functions else [""]),
        *measuring.lines,
        *table,
    ]
    return "\n".join(_tidied(lines)) + "\n", stored


def _given(inputs: Mapping[str, Array]) -> list[str]:
    """Lines that read the tables of what drives the joints."""
    if len(inputs) < 2:
        return [f'given_{joint} = inputs["{joint}"].tolist()' for joint in inputs]
    names = ", ".join(f"given_{joint}" for joint in inputs)
    quoted = ", ".join(f'"{joint}"' for joint in inputs)
    return [f"{names} = (inputs[name].tolist() for name in ({quoted}))"]


def _tidied(lines: Sequence[str]) -> list[str]:
    """No line too long, at most two blank lines in a row, none at the end."""
    found: list[str] = []
    for line in lines:
        if line == "" and found[-2:] == ["", ""]:
            continue
        start = line[: len(line) - len(line.lstrip())]
        found += filled(line.lstrip(), indent=start)
    while found[-1] == "":
        found.pop()
    return found


def _taken(plan: Plan) -> set[str]:
    """Names that a measured quantity must not have."""
    return {*RESERVED, *plan.scenario.bodies, *plan.scenario.joints}


def _recorded(parts: Parts, plan: Plan) -> frozenset[str]:
    bodies = {f"{n}.{part}" for n in parts.reading.bodies for part in BODY_SIGNALS}
    joints = {signal for pair in joint_parts(plan).values() for signal in pair}
    return frozenset(bodies | joints | set(plan.force_signals))


def _names(plan: Plan, parts: Parts) -> list[str]:
    """Lines that name what each row holds."""
    bodies, joints = parts.reading.bodies, joint_parts(plan)
    names = [f'"{bodies[0]}.{part}"' for part in BODY_SIGNALS] if len(bodies) == 1 else []
    own = ", ".join(f'"{part}"' for part in BODY_SIGNALS)
    lines = [f"parts = ({own})", *_product("=", bodies, "parts")] if not names else []
    kinds = {name: tuple(f'"{s.partition(".")[2]}"' for s in pair) for name, pair in joints.items()}
    if len(joints) < 3:
        names += [f'"{signal}"' for pair in joints.values() for signal in pair]
    else:
        for kind in dict.fromkeys(kinds.values()):
            alike = [name for name in parts.reading.joints if kinds[name] == kind]
            lines += _product("+=", alike, f"({', '.join(kind)})")
    names += [f'"{signal}"' for signal in plan.force_signals]
    if names:
        lines.append(f"signals {'+=' if lines else '='} [{', '.join(names)}]")
    return lines


def _product(sign: str, names: Sequence[str], parts: str) -> list[str]:
    listed = ", ".join(f'"{name}"' for name in names)
    return [f'signals {sign} [f"{{name}}.{{part}}" for name in ({listed}) for part in {parts}]']


def _head(name: str, engine: Backend, plan: Plan, stored: Mapping[str, Array]) -> list[str]:
    """At most four lines that say what this is."""
    scenario, level = plan.scenario, BY_HAND if plan.by_hand else plan.settings.contact
    own = importlib.metadata.version("simcompare")
    title = f"{scenario.title} in {engine.name} {engine.version()}"
    longer = f"{title}, {_LEVELS[level]}"
    title = longer if len(longer) < WIDTH - 4 else title
    text = f"Written by simcompare {own}: scenario {scenario.name}, contact level {level}"
    text += f"; reads {name}_inputs.npz." if stored else "."
    dither = scenario.dither
    if dither is not None:
        unit = units.unit_of(dither.parameter) or ""
        text += (
            f" Its argument, 0 to 1, adds that part of {dither.span:.4g} {unit} to"
            f" {dither.parameter}."
        )
    notes = _tuning_notes(plan)
    while len(lines := _wrapped([text, *notes])) > 3 and notes:
        notes.pop()
    return [f"{_END}{in_docstring(title)}.", *([] if len(lines) > 2 else [""]), *lines, ""]


def _wrapped(sentences: Sequence[str]) -> list[str]:
    """The last lines of the text at the head."""
    lines = textwrap.wrap(f"{' '.join(sentences)}{_END}", WIDTH, break_long_words=False)
    lines[-1] = lines[-1].removesuffix(_END)
    return [*map(in_docstring, lines[:-1]), in_docstring(lines[-1]) + _END]


def _tuning_notes(plan: Plan) -> list[str]:
    """What numbers for a restitution were sought for, and how one drop scatters with them."""
    return [
        f"Restitution {row.restitution:.6g} is tuned for impacts at {row.at[0].speed_m_s:.3g} m/s;"
        f" one drop scatters by {row.at[0].scatter:.2g}, with its place in a step."
        for row in plan.tuning
        if row.at
    ]


def _loop(plan: Plan, parts: Parts) -> list[str]:
    """Each round reads a sample, where there is one, and makes a step."""
    substeps, felt = plan.scenario.world.substeps, parts.felt
    see = [*parts.reading.lines, f"rows.append({parts.reading.seen})"]
    hear = []
    if felt:
        told = f"[{', '.join(felt)}]"
        told = f"felt.append({told})" if parts.lead else f"rows[-1] += {told}"
        hear = [*parts.forces, told]
    if substeps > 1:
        see = [f"if k % {substeps} == 0:", *_indented(see)]
        ends = f"if {'(k + 1)' if parts.lead else 'k'} % {substeps} == 0:"
        hear = [ends, *_indented(hear)] if hear else []
    body = [*see, *parts.drive, *parts.before, parts.step, *hear]
    if felt and parts.lead:
        lines = ["rows, felt = [], []", "for k in range(steps + 1):", *_indented(body)]
        lines.append("# the forces of a step act at its end")
        return [*lines, "rows = [seen + force for seen, force in zip(rows, felt[:1] + felt)]"]
    note = "  # the forces of a step act at its start" if felt else ""
    return ["rows = []", f"for k in range(steps + 1):{note}", *_indented(body)]


def _indented(lines: Sequence[str]) -> list[str]:
    return [f"    {line}" if line else "" for line in lines]


def _table(
    measuring: Measuring, expected: Sequence[Expected], lacking: frozenset[str]
) -> list[str]:
    """Lines that print what was measured, beside what is expected."""
    done: dict[int, Mapping[str, str]] = {}
    rows = []
    for one in expected:
        key = id(one.measure)
        if key not in done:
            measuring.wanted = frozenset(e.own for e in expected if e.measure is one.measure)
            seen = (one.measure.probe, *one.measure.also.values())
            lacks = any(measuring.scenario.probes[name].observe in lacking for name in seen)
            snippet = None if lacks else SNIPPETS.get(one.measure.function)
            done[key] = {} if snippet is None else snippet(measuring, one.measure, one.truth)
        value, score = done[key].get(one.own, "np.nan"), one.score
        row = (
            f"{one.name} [{score.unit}]",
            _number(score.truth),
            _number(score.value, score.scatter),
        )
        rows.append((one.name, value, row))
    wide, narrow = (max((len(row[i]) for *_, row in rows), default=0) for i in (0, 1))
    lines = []
    for name, value, (head, truth, run) in rows:
        start, end = f"{head:<{wide}}  ", f"closed form {truth:<{narrow}}  simcompare {run}"
        if '"' in value or " else " in value or len(value) > _MAX_LENGTH:
            variable = unused(name, measuring.taken)
            measuring.taken.add(variable)
            lines.append(f"{variable} = {value}")
            value = variable
        line = f'print(f"{start}{{{value}:<14.7g}}{end}")'
        if len(line) > WIDTH:
            lines += [f'print(f"{start}{{{value}:<14.7g}}"', f'    "{end}")']
        else:
            lines.append(line)
    return [*measuring.prints, *lines]


def _number(value: float | None, u: float | None = None) -> str:
    """A number as the script itself prints its own."""
    return notation.number(value, u).replace("−", "-")
