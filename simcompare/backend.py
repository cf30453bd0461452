"""WHO simulates: the contract between a scenario and an engine.

A backend is one file ``backends/<engine>_.py`` with a ``BACKEND`` object. It names no scenario, and
it imports its engine only when a scene is opened.
"""

from __future__ import annotations

import dataclasses
import enum
import functools
import importlib
import importlib.metadata
import time
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from simcompare import landing
from simcompare.drives import laws_of
from simcompare.errors import EngineBroken, EngineMissing, Unsupported, to_paste
from simcompare.helps import LANDING
from simcompare.scenario import Body, Scenario
from simcompare.settings import ASSISTED, CONTACT_LEVELS, DEFAULT, Settings

if TYPE_CHECKING:
    from simcompare.simulation import Simulation
    from simcompare.trajectory import Trajectory


class Feature(enum.StrEnum):
    """What a scenario may need of an engine; the value is how it is shown to people."""

    SPATIAL = "motion out of the x-z plane"
    FREE_BODY = "free bodies"
    PLANE = "plane shapes"
    SPHERE = "sphere shapes"
    BOX = "box shapes"
    CYLINDER = "cylinder shapes"
    CAPSULE = "capsule shapes"
    RESTITUTION = "restitution"
    FRICTION = "Coulomb friction between bodies"
    DRAG = "quadratic air drag"
    HINGE = "hinge joints"
    SLIDER = "slider joints"
    FIXED_JOINT = "fixed joints"
    BALL_JOINT = "ball joints"
    EFFORT = "torques and forces on joints"
    JOINT_FRICTION = "Coulomb friction of joints"
    ARMATURE = "armature of joints"
    JOINT_LIMIT = "limits of joints"
    FORCE_SENSOR = "forces through joints"
    CONTACT_FORCE = "contact forces"


#: what an engine of free rigid bodies in space can do
SPATIAL_RIGID_BODIES = frozenset(
    {
        Feature.SPATIAL, Feature.FREE_BODY, Feature.PLANE, Feature.SPHERE, Feature.BOX,
        Feature.CYLINDER, Feature.CAPSULE, Feature.RESTITUTION, Feature.FRICTION, Feature.DRAG,
    }
)  # fmt: skip

#: what an engine of articulated bodies can do besides
JOINTS_AND_FORCES = frozenset(
    {
        Feature.HINGE, Feature.SLIDER, Feature.FIXED_JOINT, Feature.EFFORT, Feature.JOINT_FRICTION,
        Feature.ARMATURE, Feature.FORCE_SENSOR, Feature.CONTACT_FORCE,
    }
)  # fmt: skip


@dataclass(frozen=True)
class KnownLimit:
    """A peculiarity of an engine that a user will meet, with a reference.

    Attributes:
        text: what happens, in one sentence.
        reference: where it is documented or how it was measured.
    """

    text: str
    reference: str


@runtime_checkable
class Backend(Protocol):
    """What every engine offers; other people's backends need nothing more."""

    name: str
    features: frozenset[Feature]
    known_limits: tuple[KnownLimit, ...]
    mapping: str

    def version(self) -> str:
        """Version of the installed engine; raises :class:`EngineMissing` where it is absent."""

    def open(self, scenario: Scenario, settings: Settings) -> Simulation:
        """Builds the scene, reads every value back, and returns it ready to step."""

    def simulate(self, scenario: Scenario, settings: Settings) -> Trajectory:
        """Runs the scenario to its end and returns what happened."""


class EngineBackend(ABC):
    """A backend over a Python package: loading, versions, refusing and ``simulate`` are here.

    Attributes:
        name: the engine's name on the command line.
        module: Python module that is imported.
        distribution: package that ``pip`` installs.
        install: the command that installs it.
        features: what the backend can do.
        known_limits: what a user should know, each with its reference.
        mapping: how ``assisted`` translates the scenario's contact into the engine's parameters.
        libraries: system libraries that its wheel needs and may lack -> the command that cures it.
        helps: which of our helps it can take.
        bounces_by: whether the number for a pair's restitution, which it takes from
            ``Settings.numbers_of``, is one coefficient, or a spring and a damper; empty where it
            takes none, and the scenario's own coefficient stays.
    """

    libraries: tuple[tuple[str, str], ...] = ()
    helps: frozenset[str] = frozenset()
    bounces_by: str = ""
    name: str
    module: str
    distribution: str
    install: str
    features: frozenset[Feature]
    known_limits: tuple[KnownLimit, ...]
    mapping: str

    def version(self) -> str:
        """Version of the installed package, without importing it."""
        found = installed_version(self.distribution)
        if found is None:
            raise EngineMissing(self.name, self.module, self.install)
        return found

    def load(self) -> ModuleType:
        """Imports the engine.

        Raises:
            EngineMissing: it is not installed.
            EngineBroken: it is installed and its import fails; the message quotes why.
        """
        try:
            return importlib.import_module(self.module)
        except ModuleNotFoundError as error:
            if error.name == self.module:
                raise EngineMissing(self.name, self.module, self.install) from None
            raise EngineBroken(f"{self.name} cannot be imported: {error}") from error
        except Exception as error:
            cures = [to_paste(cure) for library, cure in self.libraries if library in str(error)]
            raise EngineBroken(
                f"{self.name} cannot be imported: {type(error).__name__}: {error}"
                + "".join(f"; cure: {cure}" for cure in cures)
            ) from error

    def open(self, scenario: Scenario, settings: Settings) -> Simulation:
        """Refuses what the engine cannot do, builds the scene and reads every value back."""
        refuse(self, scenario, settings)
        if settings.contact == ASSISTED:
            taken = self.helps if settings.helps is None else self.helps & settings.helps
            settings = dataclasses.replace(settings, helps=taken)
        if settings.takes(LANDING):
            landing.refuse(self.name, scenario)
        started = time.perf_counter()
        engine = self.load()
        loaded = time.perf_counter()
        tuning: tuple[Mapping[str, Any], ...] = ()
        if settings.gives_all and not settings.takes(LANDING):
            from simcompare.tuning import tuned

            settings, tuning = tuned(self, engine, scenario, settings)
        calibrated = time.perf_counter()
        simulation = self.build(engine, scenario, settings)
        simulation.tuning = tuning
        simulation.notes += tuple(note for record in tuning for note in record["notes"])
        simulation.read_back_start(self.name)
        simulation.wall_s = {
            "import": loaded - started,
            "tune": calibrated - loaded,
            "build": time.perf_counter() - calibrated,
        }
        return simulation

    @abstractmethod
    def build(self, engine: ModuleType, scenario: Scenario, settings: Settings) -> Simulation:
        """Builds the scene in the imported engine and reads every physical value back."""

    def simulate(self, scenario: Scenario, settings: Settings) -> Trajectory:
        """Runs the scenario to its end through the engine's fastest recording loop."""
        simulation = self.open(scenario, settings)
        try:
            return simulation.run(self.name, self.version())
        finally:
            simulation.close()


@functools.cache
def installed_version(distribution: str) -> str | None:
    """Version of an installed package, ``None`` where it is not installed."""
    try:
        return importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return None


def needs(scenario: Scenario) -> frozenset[Feature]:
    """Features that a scenario needs, derived from its content."""
    found = {Feature.FREE_BODY} if scenario.moving_bodies() else set()
    for body in scenario.bodies.values():
        found.update(Feature[shape.type.upper()] for shape in body.shapes)
        if body.drag is not None and body.drag.factor_kg_m > 0:
            found.add(Feature.DRAG)
    for contact in scenario.contacts:
        if contact.restitution > 0:
            found.add(Feature.RESTITUTION)
        if contact.friction > 0:
            found.add(Feature.FRICTION)
    joints = {"hinge": Feature.HINGE, "slider": Feature.SLIDER, "ball": Feature.BALL_JOINT}
    found.update(joints.get(joint.type, Feature.FIXED_JOINT) for joint in scenario.joints.values())
    for law in laws_of(scenario).values():
        traits = (
            (law.is_driven, Feature.EFFORT),
            (law.friction, Feature.JOINT_FRICTION),
            (law.armature, Feature.ARMATURE),
        )
        found.update(feature for present, feature in traits if present)
    if any(j.lower is not None or j.upper is not None for j in scenario.joints.values()):
        found.add(Feature.JOINT_LIMIT)
    # the other sensors follow from the motion, whoever recorded it
    kinds = {"force": Feature.FORCE_SENSOR, "contact_force": Feature.CONTACT_FORCE}
    found.update(kinds[s.type] for s in scenario.sensors.values() if s.type in kinds)
    if not is_planar(scenario):
        found.add(Feature.SPATIAL)
    return frozenset(found)


def is_planar(scenario: Scenario) -> bool:
    """Whether all motion stays in the x-z plane, so that a two-dimensional engine can run it."""
    joints = scenario.joints.values()
    return (
        scenario.world.gravity_m_s2[1] == 0
        and all(_body_is_planar(body) for body in scenario.bodies.values())
        # a hinge must turn about y, a slider must not move along it
        and all(j.axis[0] == j.axis[2] == 0 for j in joints if j.type == "hinge")
        and all(j.axis[1] == 0 for j in joints if j.type == "slider")
        and all(j.type != "ball" for j in joints)
    )


def _body_is_planar(body: Body) -> bool:
    _, turned_x, _, turned_z = body.orientation_wxyz
    rate_x, _, rate_z = body.rate_rad_s
    sideways = (body.position_m[1], body.velocity_m_s[1], body.center_of_mass_m[1])
    return not any((turned_x, turned_z, rate_x, rate_z, *sideways)) and all(
        shape.position_m[1] == 0 and (shape.type != "plane" or shape.normal[1] == 0)
        for shape in body.shapes
    )


def refuse(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """Raises :class:`Unsupported` if the backend lacks what the scenario needs.

    Restitution is needed only where the mode is to apply it.
    """
    wanted = needs(scenario)
    if settings.contact == DEFAULT:
        wanted -= {Feature.RESTITUTION, Feature.FRICTION}
    elif settings.contact not in CONTACT_LEVELS:
        raise Unsupported(
            f"{backend.name} knows no contact level {settings.contact!r};"
            f" known: {', '.join(CONTACT_LEVELS)}"
        )
    lacking = sorted(wanted - backend.features)
    if lacking:
        raise Unsupported(f"simcompare's backend for {backend.name} has no {', no '.join(lacking)}")
