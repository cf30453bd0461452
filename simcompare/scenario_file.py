"""Scenario files: YAML with parameters and ``${…}`` expressions; all faults of one at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from simcompare import expressions, units
from simcompare.errors import InputError, UnknownName
from simcompare.scenario import Scenario, dangling_references

#: keys of the file that describe it rather than the scene
HEAD_KEYS = ("parameters", "presets")
SCHEMA_PATH = Path(__file__).with_name("scenario.schema.json")


class Parameter(BaseModel):
    """A number that the user may set; its unit is in its name.

    Attributes:
        value: default [unit of the name].
        min: smallest value that makes sense.
        max: largest value that makes sense.
        text: one sentence on what it is.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    value: float
    min: float
    max: float
    text: str = Field(min_length=1)

    @model_validator(mode="after")
    def _within_bounds(self) -> Parameter:
        if not self.min <= self.value <= self.max:
            raise ValueError(f"value {self.value:g} is not within {self.min:g} … {self.max:g}")
        return self


class Preset(BaseModel):
    """A named set of parameter values with the source of the numbers."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    text: str
    set: Mapping[str, float]


class _Head(BaseModel):
    parameters: Mapping[str, Parameter] = Field(default_factory=dict)
    presets: Mapping[str, Preset] = Field(default_factory=dict)


@dataclass(frozen=True)
class ScenarioFile:
    """A scenario file that has been read and whose head is valid.

    Attributes:
        path: the YAML file.
        parameters: name -> parameter.
        presets: name -> preset.
        tree: the rest of the file, expressions unevaluated.
        lines: dotted place -> line number, for messages.
    """

    path: Path
    parameters: Mapping[str, Parameter]
    presets: Mapping[str, Preset]
    tree: Mapping[str, Any]
    lines: Mapping[str, int] = field(repr=False)

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
    ) -> Scenario:
        """Gives every parameter a number and builds the scenario.

        Args:
            values: parameters that differ from the file, SI.
            preset: name of a preset that is applied before ``values``.
            step_s: time between samples [s]; the file's own where ``None``.

        Raises:
            UnknownName: a preset that does not exist.
            InputError: unknown parameters, values out of bounds, or faults of the file.
        """
        parameters = {name: parameter.value for name, parameter in self.parameters.items()}
        if preset is not None:
            if preset not in self.presets:
                raise UnknownName(f"preset of {self.name}", preset, self.presets)
            parameters.update(self.presets[preset].set)
        parameters.update(values or {})
        self._check_bounds(parameters)
        return self._build(parameters, step_s)

    def read_settings(self, settings: Mapping[str, str | float]) -> dict[str, float]:
        """Turns ``{"drop_height": "30cm"}`` into ``{"drop_height_m": 0.3}``.

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
            raise InputError(f"{self.name}, --set", faults)
        return values

    def _check_bounds(self, values: Mapping[str, float]) -> None:
        faults = []
        for name, value in values.items():
            if name not in self.parameters:
                faults.append(str(UnknownName("parameter", name, self.parameters)))
                continue
            low, high = self.parameters[name].min, self.parameters[name].max
            if not low <= value <= high:
                unit = units.symbol(units.unit_of(name))
                faults.append(f"{name} = {value:g} is outside {low:g} … {high:g} ({unit})")
        if faults:
            raise InputError(f"{self.name}, parameters", faults)

    def _build(self, parameters: Mapping[str, float], step_s: float | None) -> Scenario:
        faults: dict[str, str] = {}
        world = self.tree.get("world")
        if step_s is None and isinstance(world, Mapping):
            step_s = expressions.resolve(
                world.get("step_s", 0.001), parameters, "world.step_s", faults
            )
        names = {**parameters, "step_s": _number_or(step_s, 0.001)}
        tree = expressions.resolve(self.tree, names, "", faults)
        if isinstance(tree.get("world"), dict):
            tree["world"]["step_s"] = step_s
        tree["parameters"] = parameters
        try:
            scenario = Scenario.model_validate(tree)
        except ValidationError as error:
            raise self._error({**faults_of(error), **faults}) from None
        faults.update(dangling_references(scenario))
        if faults:
            raise self._error(faults)
        return scenario

    def _error(self, faults: Mapping[str, str]) -> InputError:
        return InputError(str(self.path), describe(faults, self.lines))


def read(path: Path) -> ScenarioFile:
    """Reads a scenario file and checks all of it, with its default parameter values.

    Raises:
        InputError: the file cannot be read, is not YAML, or holds faults (all of them are named).
    """
    tree, lines = read_yaml(path)
    if not isinstance(tree, dict):
        raise InputError(
            str(path), ["the file is not a mapping; expected keys such as name, bodies"]
        )
    try:
        head = _Head.model_validate({key: tree[key] for key in HEAD_KEYS if key in tree})
    except ValidationError as error:
        raise InputError(str(path), describe(faults_of(error), lines)) from None
    body = {key: value for key, value in tree.items() if key not in HEAD_KEYS}
    file = ScenarioFile(path, head.parameters, head.presets, body, lines)
    file.resolve()
    for preset in file.presets:
        try:
            file.resolve(preset=preset)
        except InputError as error:
            raise InputError(f"{path}, preset {preset}", error.faults) from None
    return file


def read_yaml(path: Path) -> tuple[Any, dict[str, int]]:
    """Content of a YAML file and the line number of every place in it.

    Raises:
        InputError: unreadable, not UTF-8, or not YAML; names line and column.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), [f"cannot be read: {error}"]) from None
    try:
        node = yaml.compose(text, Loader=yaml.SafeLoader)
        content = yaml.safe_load(text)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        raise InputError(str(path), [f"{place}not valid YAML: {error.problem}"]) from None
    except yaml.YAMLError as error:
        raise InputError(str(path), [f"not valid YAML: {error}"]) from None
    lines: dict[str, int] = {}
    _collect_lines(node, "", lines)
    return content, lines


def _collect_lines(node: yaml.Node | None, path: str, lines: dict[str, int]) -> None:
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            place = f"{path}.{key.value}" if path else str(key.value)
            lines[place] = key.start_mark.line + 1
            _collect_lines(value, place, lines)
    elif isinstance(node, yaml.SequenceNode):
        for i, value in enumerate(node.value):
            lines[f"{path}.{i}"] = value.start_mark.line + 1
            _collect_lines(value, f"{path}.{i}", lines)


def faults_of(error: ValidationError) -> dict[str, str]:
    """Faults that pydantic found, as dotted place -> sentence with the value found."""
    faults = {}
    for item in error.errors():
        place = ".".join(str(part) for part in item["loc"])
        message = item["msg"].removeprefix("Value error, ")
        found = item.get("input")
        shown = "" if isinstance(found, dict | list) else f", found {found!r}"
        faults[place] = f"{message}{shown}"
    return faults


def describe(faults: Mapping[str, str], lines: Mapping[str, int]) -> list[str]:
    """Sentences ``line 12, bodies.ball.mass_kg: …`` in the order of the file."""
    rows = []
    for place, sentence in faults.items():
        line = _line_of(place, lines)
        where = f"line {line}, {place}" if line else place
        rows.append((line or 0, f"{where}: {sentence}" if place else sentence))
    return [text for _, text in sorted(rows, key=lambda row: row[0])]


def _line_of(place: str, lines: Mapping[str, int]) -> int | None:
    while place:
        if place in lines:
            return lines[place]
        place = place.rpartition(".")[0]
    return None


def _number_or(value: object, fallback: float) -> float:
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return fallback
