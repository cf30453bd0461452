"""The verb ``show``: what there is to know of a scenario before it is run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from simcompare import measures, units
from simcompare.arguments import checked
from simcompare.engine import engines
from simcompare.engine.features import Feature, needs
from simcompare.errors import InputError, SimcompareError
from simcompare.model.drawing import drawn
from simcompare.model.scenario import Joint, Scenario, Tolerance, World
from simcompare.model.sensor import Sensor
from simcompare.reports.render import matplotlib_replay, numbers
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.scenarios import catalogue
from simcompare.scenarios.scenario_file import Preset
from simcompare.verbs.scene import scene_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

#: of the picture in a notebook, in an inch: it is kept in the notebook's file
_DOTS = 84
_HEADS = ("value", "unit", "from", "to", "what it is")


@dataclass(frozen=True)
class ParameterFacts:
    """A parameter with its bounds, in its unit."""

    value: float
    min: float
    max: float
    text: str
    unit: str


@dataclass(frozen=True, repr=False)
class ScenarioFacts(Shown):
    """What there is to know of a scenario; ``table()`` has a row for each parameter.

    Attributes:
        name: of the scenario.
        title: of the scenario.
        question: that it asks.
        file: the YAML file.
        parameters: name -> parameter.
        presets: name -> named set of parameters.
        world: gravity, duration and step.
        bodies: name -> half a sentence, as for joints, actuators and sensors.
        joints: name -> half a sentence.
        actuators: name -> half a sentence.
        sensors: name -> half a sentence.
        signals: names of all that is recorded.
        needs: features that it uses.
        engines: engine -> the features that it lacks, or why it cannot be asked.
        variants: engine -> its variants.
        truth: where the truth comes from.
        tolerances: measured value -> tolerance.
        units: measured value -> unit, of those with a tolerance.
        is_visible: whether there is a picture of the scene.
    """

    name: str
    title: str
    question: str
    file: str
    parameters: Mapping[str, ParameterFacts]
    presets: Mapping[str, Preset]
    world: World
    bodies: Mapping[str, str]
    joints: Mapping[str, str]
    actuators: Mapping[str, str]
    sensors: Mapping[str, str]
    signals: list[str]
    needs: list[str]
    engines: Mapping[str, list[str]]
    variants: Mapping[str, list[str]]
    truth: str
    tolerances: Mapping[str, Tolerance]
    units: Mapping[str, str]
    is_visible: bool

    def __repr__(self) -> str:
        rows = (f"  {name} = {_number(p.value)} {_unit(p)}" for name, p in self.parameters.items())
        return "\n".join([super().__repr__(), *map(str.rstrip, rows)])

    def plot(self) -> Canvas:
        """The scene at several instants of its truth, the last one full, as a figure.

        As it starts, where there is no truth that tells where all bodies are.

        Raises:
            InputError: nothing of the scene can be seen.
        """
        replay = scene_of(catalogue.load(self.file))
        if replay is None:
            raise InputError(self.file, ["no body has shapes or visual, so there is no picture"])
        return matplotlib_replay.still(replay, "")

    def _scene(self) -> bytes:
        return matplotlib_replay.png(self.plot(), _DOTS)

    def _glance(self) -> Glance:
        able = [name for name, lacking in self.engines.items() if not lacking]
        notes = [f"Presets: {', '.join(self.presets)}"] if self.presets else []
        notes.append(f"Engines that can run it: {', '.join(able) or 'none'}")
        return Glance(
            title=f"{self.title} ({self.name})",
            question=self.question,
            table=self._table(),
            notes=tuple(notes),
            scene=self._scene if self.is_visible else None,
            more=f"More: simcompare.run({self.name!r}, preset=…, set={{…}}),"
            " .plot(), .presets, .signals",
        )

    def _table(self) -> Table:
        rows = tuple(
            (name, _number(p.value), _unit(p), _number(p.min), _number(p.max), p.text)
            for name, p in self.parameters.items()
        )
        columns = [Column(head, text=head in ("unit", _HEADS[-1])) for head in _HEADS]
        return Table("", (Column("parameter", text=True), *columns), (Group("", rows),))


@checked
def show(scenario: str | Path) -> ScenarioFacts:
    """What there is to know of a scenario.

    ::

        simcompare.show("ball")
        simcompare.show("ball").table()
        simcompare.show("ball").plot()
    simcompare.show("ball").presets

    Args:
        scenario: name, folder or file.

    Raises:
        UnknownName: there is none of that name.
        InputError: faults of the file.
    """
    file = catalogue.load(str(scenario))
    scene = file.resolve()
    features = needs(scene)
    return ScenarioFacts(
        name=scene.name,
        title=scene.title,
        question=scene.question,
        file=str(file.path),
        parameters={
            name: ParameterFacts(p.value, p.min, p.max, p.text, units.symbol(units.unit_of(name)))
            for name, p in file.parameters.items()
        },
        presets=file.presets,
        world=scene.world,
        bodies={
            name: "fixed" if body.fixed else f"{body.mass_kg:g} kg at {list(body.position_m)} m"
            for name, body in scene.bodies.items()
        },
        joints={name: _joint_words(joint) for name, joint in scene.joints.items()},
        actuators={
            name: f"{actuator.type} on {actuator.joint}, input {actuator.input}"
            f" ({scene.inputs[actuator.input].signal})"
            for name, actuator in scene.actuators.items()
        },
        sensors={name: _sensor_words(sensor) for name, sensor in scene.sensors.items()},
        signals=list(scene.signals()),
        needs=sorted(features.required | features.optional),
        engines={name: _lacking(name, features.required) for name in engines.names()},
        variants={name: [*engines.quick_variants(name)] for name in engines.names()},
        truth="closed form or reference in reference.py"
        if catalogue.has_reference(file.path)
        else "none: engines are compared with each other only",
        tolerances=scene.tolerances,
        units=_measured_units(scene),
        is_visible=any(not body.fixed for body in drawn(scene).values()),
    )


def _measured_units(scene: Scenario) -> dict[str, str]:
    """Unit of everything with a tolerance."""
    of_all = {
        measure.name_of(name): units.symbol(unit)
        for measure in scene.measures
        for name, unit in measures.units_of(measure, scene).items()
    }
    return {name: of_all[name] for name in scene.tolerances if name in of_all}


def _number(value: float) -> str:
    return numbers.plain(value, 6)


def _unit(parameter: ParameterFacts) -> str:
    """Its unit, nothing for a plain number."""
    return "" if parameter.unit == "1" else parameter.unit


def _sensor_words(sensor: Sensor) -> str:
    place = sensor.body or sensor.joint or "-".join(sensor.pair or ())
    if sensor.errors is None:
        return f"{sensor.type} of {place}"
    said = sensor.errors.sheet or "errors of its own"
    return f"{sensor.type} of {place}, read by a real one: {said}"


def _joint_words(joint: Joint) -> str:
    parts = ("stiffness", "damping", "friction", "armature", "rate")
    axis = "" if joint.type in ("fixed", "ball") else f" about {list(joint.axis)}"
    axis = axis.replace("about", "along") if joint.type == "slider" else axis
    values = {part: value for part in parts if (value := getattr(joint, part))}
    more = "".join(f", {part} {value:g}" for part, value in values.items())
    return f"{joint.type}{axis}, {joint.child} on {joint.parent}{more}"


def _lacking(engine: str, features: frozenset[Feature]) -> list[str]:
    """Features that an engine lacks, or the one reason why it cannot be asked."""
    try:
        return sorted(features - engines.get(engine).features)
    except SimcompareError as error:
        return [str(error)]
