"""Scenario files: YAML with parameters and ``${…}`` expressions; all faults of one at once."""

from __future__ import annotations

import functools
import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import BaseModel, Field, ValidationError, model_validator

from simcompare import notation, units
from simcompare.errors import InputError, UnknownName
from simcompare.model import expressions
from simcompare.model.expressions import Template
from simcompare.model.fittable import Fittable
from simcompare.model.frozen import Frozen
from simcompare.model.plain import Plain
from simcompare.model.scenario import Scenario
from simcompare.model.signals import Signal
from simcompare.model.tabled import Tabled
from simcompare.model.uncertain import Uncertain
from simcompare.model.words import Name, steering
from simcompare.model.yaml_file import describe, faults_of, read_yaml
from simcompare.scenarios.scenario_checks import faults_between_parts
from simcompare.scenarios.tabled_faults import tabled_faults
from simcompare.scenarios.uncertain_faults import inherited, uncertain_faults

#: keys of the file that describe it rather than the scene
HEAD_KEYS = ("parameters", "presets", "fit", "uncertainty", "table")
#: names a scenario that this one is a variant of
EXTENDS = "extends"
#: what expressions call the time between samples
STEP = "step_s"
#: how far the length of a measured orientation may be off
_NEAR_1 = 0.01
SCHEMA_PATH = Path(__file__).with_name("scenario.schema.json")


class Parameter(Frozen):
    """A number that the user may set; its unit is in its name.

    Attributes:
        value: default [unit of the name].
        min: smallest value that makes sense.
        max: largest value that makes sense.
        text: one sentence on what it is.
    """

    value: float
    min: float
    max: float
    text: str = Field(min_length=1)

    @model_validator(mode="after")
    def _within_bounds(self) -> Parameter:
        if not self.min <= self.value <= self.max:
            raise ValueError(f"value {self.value:g} is not within {self.min:g} … {self.max:g}")
        return self


class Preset(Frozen):
    """A named set of parameter values with the source of the numbers."""

    text: str
    set: Mapping[str, float]
    taken_from: tuple[str, ...] = Field((), description="published tables that it was taken from")


class _Head(BaseModel):
    parameters: Mapping[str, Parameter] = Field(default_factory=dict)
    presets: Mapping[Name, Preset] = Field(default_factory=dict)
    fit: Fittable | None = None
    uncertainty: Uncertain | None = None
    table: Tabled | None = None


@dataclass(frozen=True)
class ScenarioFile:
    """A scenario file that has been read and whose head is valid.

    Attributes:
        path: the YAML file.
        parameters: name -> parameter.
        presets: name -> preset.
        tree: the rest of the file, expressions unevaluated.
        lines: dotted place -> line number, for messages.
        extends: files that this one is a variant of, the nearest first.
        fit: what of it can be fitted, ``None`` where nothing is named.
        uncertainty: how well its parameters are known, ``None`` where nothing is said.
        table: how a table of results is read for it, ``None`` where nothing is said.
    """

    path: Path
    parameters: Mapping[str, Parameter]
    presets: Mapping[str, Preset]
    tree: Plain
    lines: Mapping[str, int] = field(repr=False)
    extends: tuple[Path, ...] = ()
    fit: Fittable | None = None
    uncertainty: Uncertain | None = None
    table: Tabled | None = None

    @property
    def name(self) -> str:
        """The scenario's name as the file gives it."""
        return str(self.tree.get("name", self.path.stem))

    def resolve(
        self,
        values: Mapping[str, float] | None = None,
        *,
        preset: str | None = None,
        step_s: float | None = None,
        inputs: Mapping[str, Signal] | None = None,
    ) -> Scenario:
        """Gives every parameter a number and builds the scenario.

        Args:
            values: parameters that differ from the file, SI.
            preset: name of a preset that is applied before ``values``.
            step_s: time between samples [s]; the file's own where ``None``.
            inputs: signals that take the place of the scenario's own.

        Raises:
            UnknownName: a preset or an input that does not exist.
            InputError: unknown parameters, values out of bounds, or faults of the file.
        """
        parameters = {name: parameter.value for name, parameter in self.parameters.items()}
        parameters |= {**self.of_preset(preset), **(values or {})}
        faults = list(out_of_bounds(parameters, self.parameters).values())
        faults += self._no_rotation(parameters)
        if faults:
            raise InputError(f"{self.name}, parameters", faults)
        scenario = self._build(parameters, step_s)
        for name in inputs or {}:
            if name not in scenario.inputs:
                raise UnknownName(f"input of {self.name}", name, scenario.inputs)
        return scenario.model_copy(update={"inputs": {**scenario.inputs, **(inputs or {})}})

    @functools.cached_property
    def _template(self) -> Template:
        return Template(self.tree)

    def of_preset(self, preset: str | None) -> Mapping[str, float]:
        """Parameters that a preset sets; none where ``None``."""
        if preset is not None and preset not in self.presets:
            raise UnknownName(f"preset of {self.name}", preset, self.presets)
        return {} if preset is None else self.presets[preset].set

    def _no_rotation(self, values: Mapping[str, float]) -> list[str]:
        """That the parameters of an orientation are no rotation, which no scene would show."""
        names = (self.fit and self.fit.start_orientation) or ()
        length = math.hypot(*(values[name] for name in names)) if names else 1.0
        if abs(length - 1) <= _NEAR_1:
            return []
        return [f"{', '.join(names)} have length {length:.4g}; a rotation has length 1"]

    def vary(self, scenario: Scenario, name: str, value: float) -> Scenario:
        """The same scenario with one parameter changed, also a little beyond its bounds.

        Raises:
            InputError: the scene cannot be built with that value.
        """
        varied = self.moved(scenario, {name: value})
        # as long as the original, so that samples line up
        world = varied.world.model_copy(update={"duration_s": scenario.world.duration_s})
        return varied.model_copy(update={"world": world})

    def moved(self, scenario: Scenario, values: Mapping[str, float]) -> Scenario:
        """A scenario of its own with some parameters changed, also a little beyond their bounds.

        Raises:
            InputError: the scene cannot be built with these values.
        """
        return self._build({**scenario.parameters, **values}, scenario.world.step_s)

    def read_settings(
        self, settings: Mapping[str, str | float], where: str = "--set"
    ) -> dict[str, float]:
        """Turns ``{"drop_height": "30cm"}`` into ``{"drop_height_m": 0.3}``.

        Args:
            settings: parameter, with or without its unit suffix -> value, with or without unit.
            where: the argument or file that is named in an error.

        Raises:
            InputError: every unknown name and every wrong unit, together.
        """
        values, faults = {}, []
        for given, text in settings.items():
            name = units.find_name(given, self.parameters)
            if name is None:
                faults.append(str(UnknownName("parameter", given, self.parameters)))
                continue
            try:
                values[name] = units.to_si(text, units.unit_of(name), name)
            except InputError as error:
                faults.append(str(error))
        if faults:
            raise InputError(f"{self.name}, {where}", faults)
        return values

    def _build(self, parameters: Mapping[str, float], step_s: float | None) -> Scenario:
        scenario, faults = build(self._template, parameters, step_s)
        if scenario is None:
            raise InputError(str(self.path), describe(faults, self.lines))
        return scenario


def out_of_bounds(
    values: Mapping[str, float], parameters: Mapping[str, Parameter]
) -> dict[str, str]:
    """Values that no parameter has or that are outside its bounds, as name -> sentence."""
    faults = {}
    for name, value in values.items():
        if name not in parameters:
            faults[name] = str(UnknownName("parameter", name, parameters))
            continue
        low, high = parameters[name].min, parameters[name].max
        if not low <= value <= high:
            faults[name] = _outside(name, value, low, high)
    return faults


def _outside(name: str, value: float, low: float, high: float) -> str:
    """That a value is out of its bounds, and the smaller unit in which it would be within."""
    unit = units.unit_of(name)
    meant = notation.meant(value, unit, low, high)
    found = f"{name} = {value:g}{'' if unit == '1' else f' {units.symbol(unit)}'}"
    hint = f"; did you mean {name.removesuffix(units.suffix_of(name))}={meant}?" if meant else ""
    return f"{found} is outside {notation.span(low, high, unit)}{hint}"


def build(
    template: Template, parameters: Mapping[str, float], step_s: float | None
) -> tuple[Scenario | None, dict[str, str]]:
    """The scenario of a tree with its expressions evaluated, or ``None`` and every fault.

    Args:
        template: the file without its head.
        parameters: values that expressions may use, SI.
        step_s: time between samples [s]; the file's own where ``None``.
    """
    faults: dict[str, str] = {}
    world = template.tree.get("world")
    if step_s is None and isinstance(world, Mapping):
        step_s = expressions.resolve(world.get("step_s", 0.001), parameters, "world.step_s", faults)
    names = {**parameters, STEP: _number_or(step_s, 0.001)}
    resolved = {**template.filled(names, faults), "parameters": dict(parameters)}
    if isinstance(resolved.get("world"), dict):
        resolved["world"] = {**resolved["world"], "step_s": step_s}
    try:
        scenario = Scenario.model_validate(resolved)
    except ValidationError as error:
        return None, {**faults_of(error), **faults}
    faults.update(faults_between_parts(scenario))
    return (None if faults else scenario), faults


def read(path: Path) -> ScenarioFile:
    """Reads a scenario file and checks all of it, with its default parameter values.

    Raises:
        InputError: the file cannot be read, is not YAML, or holds faults (all of them are named).
    """
    tree, lines, faults, extended = _read_with_bases(path, ())
    raw = {key: tree[key] for key in HEAD_KEYS if key in tree}
    scene = {key: value for key, value in tree.items() if key not in HEAD_KEYS}
    head = _Head()
    try:
        head = _Head.model_validate(raw)
        values = {name: parameter.value for name, parameter in head.parameters.items()}
    except ValidationError as error:
        faults.update(faults_of(error))
        values = _values_despite_faults(raw)
    bodies = scene.get("bodies")
    faults.update(_head_faults(head, bodies if isinstance(bodies, dict) else {}))
    scenario, wrong = build(Template(scene), values, None)
    faults.update(wrong)
    if head.table is not None:
        faults.update(tabled_faults(head.table, values, scenario))
    if faults:
        raise InputError(str(path), describe(faults, lines))
    return ScenarioFile(
        path, head.parameters, head.presets, scene, lines, extended, head.fit, head.uncertainty,
        head.table,
    )  # fmt: skip


def _read_with_bases(
    path: Path, above: tuple[Path, ...]
) -> tuple[Plain, dict[str, int], dict[str, str], tuple[Path, ...]]:
    """A file merged onto the one that it extends: tree, own lines, own faults, files extended."""
    tree, lines, faults = read_yaml(path)
    if not isinstance(tree, dict):
        raise InputError(
            str(path), ["the file is not a mapping; expected keys such as name, bodies"]
        )
    faults.update(steering(tree))
    if EXTENDS not in tree:
        return tree, lines, faults, ()
    told = tree.pop(EXTENDS)
    base = _file_at(path.parent / str(told))
    if base is None:
        fault = f"line {lines[EXTENDS]}, extends: there is no file {told!s:.200}"
        cure = "expected a path from this file, such as ../robot/robot.yaml"
        raise InputError(str(path), [f"{fault}; {cure}"])
    if base in (*above, path.resolve()):
        raise InputError(str(path), [f"line {lines[EXTENDS]}, extends: {base.name} extends itself"])
    merged, _, below, bases = _read_with_bases(base, (*above, path.resolve()))
    if below:
        raise InputError(str(base), describe(below, {}))
    faults.update(_taken_from_nothing(merged, tree, ""))
    return _merged(inherited(merged, tree), tree), lines, faults, (base, *bases)


def _file_at(path: Path) -> Path | None:
    """A file, ``None`` where there is none, also for what can be no name of one."""
    try:
        return path.resolve() if path.is_file() else None
    except (OSError, ValueError):
        return None


def _taken_from_nothing(base: Any, change: Any, place: str) -> dict[str, str]:  # noqa: ANN401
    """Places where a variant takes away what the base does not have."""
    faults: dict[str, str] = {}
    for key, value in change.items() if isinstance(change, dict) else ():
        where = f"{place}.{key}" if place else str(key)
        below = base.get(key) if isinstance(base, dict) else None
        if value is None and not (isinstance(base, dict) and key in base):
            faults[where] = (
                "null takes away what the extended scenario has, and it has no such part"
            )
        elif isinstance(value, dict):
            faults.update(_taken_from_nothing(below, value, where))
    return faults


def _merged(base: Any, change: Any) -> Any:  # noqa: ANN401
    """A variant of a tree: mappings are merged, all else is replaced, and null takes away."""
    if not (isinstance(base, dict) and isinstance(change, dict)):
        return change
    merged = {**base, **{k: _merged(base.get(k), v) for k, v in change.items()}}
    return {k: v for k, v in merged.items() if v is not None or k not in change}


def _head_faults(head: _Head, bodies: Collection[str]) -> dict[str, str]:
    """Parameters that no expression could name, and presets that set what cannot be."""
    faults = {}
    taken = {*expressions.FUNCTIONS, *expressions.CONSTANTS, STEP}
    for name in head.parameters:
        if not name.isidentifier() or name in taken:
            faults[f"parameters.{name}"] = f"{name!r} cannot be the name of a parameter"
    wrong = {} if head.fit is None else head.fit.faults(head.parameters, bodies)
    faults.update({f"fit.{place}": sentence for place, sentence in wrong.items()})
    values = {name: parameter.value for name, parameter in head.parameters.items()}
    faults.update(uncertain_faults(head.uncertainty or Uncertain(), values))
    for name, preset in head.presets.items():
        for parameter, sentence in out_of_bounds(preset.set, head.parameters).items():
            faults[f"presets.{name}.set.{parameter}"] = sentence
    return faults


def _values_despite_faults(raw: Plain) -> dict[str, float]:
    """Parameter values as far as they can be read, so that the scene can be checked as well."""
    values = {}
    parameters = raw.get("parameters")
    for name, entry in parameters.items() if isinstance(parameters, dict) else ():
        value = entry.get("value") if isinstance(entry, dict) else None
        values[str(name)] = _number_or(value, 1.0)
    return values


def _number_or(value: object, fallback: float) -> float:
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return fallback
