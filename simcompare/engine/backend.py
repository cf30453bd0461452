"""WHO simulates: the contract between a scenario and an engine.

A backend is one file ``backends/<engine>_.py``, or a folder ``backends/<engine>/``, with a
``BACKEND`` object. It names no scenario, and it loads its engine only when a scene is opened.
"""

from __future__ import annotations

import copy
import dataclasses
import importlib
import time
from abc import ABC
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Protocol, Self, runtime_checkable

from simcompare.engine.calibration.tuned import tuned
from simcompare.engine.features import Feature, needs
from simcompare.engine.helps import LANDING, known, landing, spring_contact
from simcompare.engine.library import Library
from simcompare.engine.own_values import OwnValue, coefficient
from simcompare.engine.read_back import audit_of, quantities
from simcompare.engine.scene import Scene, Traits, make_scene
from simcompare.engine.simulation import Simulation
from simcompare.engine.speeds import fastest_turn_rad_s
from simcompare.engine.variants import Variant
from simcompare.errors import EngineMissing, UnknownVariant, Unsupported
from simcompare.model.audit import Audit
from simcompare.model.scenario import Scenario
from simcompare.model.settings import (
    ASSISTED,
    COEFFICIENT,
    CONTACT_LEVELS,
    DEFAULT,
    SPRING,
    TUNED,
    Settings,
)
from simcompare.model.trajectory import Trajectory
from simcompare.model.tuning import TuningRow


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
    """A backend on the kit: loading, versions, refusing, read-back and ``simulate`` are here.

    Attributes:
        name: the engine's name on the command line.
        simulation: the adapter's class, which takes the loaded engine and a scene.
        library: what it comes as.
        traits: what it is like.
        features: what the backend can do.
        known_limits: what a user should know, each with its reference.
        mapping: how ``tuned`` and ``assisted`` translate the scenario into the engine's parameters.
        helps: which of our helps it can take.
        script_module: module whose ``SCRIPT`` writes scenes as standalone scripts; empty for none.
        typed_as: what the engine calls the numbers that stand for a restitution, such as "solref".
        spring_values: the numbers of a spring that stands for a restitution, as people type them;
            empty where it is a coefficient.
        other_values: what else of a contact somebody may type in; each is in the audit by its name.
        snippet: lines to copy into a loop of one's own, in which ``{0}``, ``{1}`` stand for those
            numbers, ``{step_s}`` for the step and ``{typed[NAME]}`` for what else was set; empty
            where the settings are listed.
        variants: name -> the engine with one of its own choices made otherwise.
        variant: which of them this is; empty for the engine as it comes.
    """

    name: str
    simulation: type[Any]
    library: Library
    traits: Traits = Traits()
    features: frozenset[Feature]
    known_limits: tuple[KnownLimit, ...]
    mapping: str
    helps: frozenset[str] = frozenset()
    script_module: str = ""
    typed_as: str = ""
    spring_values: tuple[OwnValue, ...] = ()
    other_values: tuple[OwnValue, ...] = ()
    snippet: str = ""
    variants: Mapping[str, Variant] = MappingProxyType({})
    variant: str = ""

    @property
    def also_needed(self) -> tuple[str, ...]:
        """What a backend on the kit has beside what every backend has."""
        makes_its_own = type(self).make is not EngineBackend.make
        return ("library",) if makes_its_own else ("simulation", "library")

    def with_variant(self, variant: str) -> Self:
        """The same engine in one of its variants.

        Raises:
            UnknownVariant: there is none of that name; names those that there are.
        """
        if variant not in self.variants:
            raise UnknownVariant(self.name, variant, self.variants)
        made = copy.copy(self)
        made.name, made.variant = f"{self.name}:{variant}", variant
        made.helps = self.helps - self.variants[variant].without
        made.snippet = ""  # it does not say what the variant sets
        return made

    @property
    def bounces_by(self) -> str:
        """What stands for a pair's restitution; see ``Traits``."""
        return self.traits.bounces_by

    @property
    def own_values(self) -> tuple[OwnValue, ...]:
        """What somebody types in to make a body bounce; the numbers for a restitution first."""
        if self.traits.bounces_by != COEFFICIENT or not self.typed_as:
            return (*self.spring_values, *self.other_values)
        return (coefficient(self.typed_as), *self.other_values)

    def as_typed(self, numbers: tuple[float, ...]) -> tuple[float, ...]:
        """Numbers for a restitution, such as those of a fit, as ``own_values`` has them."""
        return numbers

    def version(self) -> str:
        """Version of the installed engine, found without loading it."""
        found = self.library.version()
        if found is None:
            kind = getattr(self.library, "kind", "module")
            raise EngineMissing(self.name, self.library.name, self.library.install, kind)
        return found

    def load(self) -> Any:  # noqa: ANN401
        """Loads the engine.

        Raises:
            EngineMissing: it is not installed.
            EngineBroken: it is installed and cannot be loaded; the message quotes why.
        """
        return self.library.load(self.name)

    def script(self) -> Any:  # noqa: ANN401
        """What writes scenes of this engine as standalone scripts."""
        if not self.script_module:
            return None
        return importlib.import_module(self.script_module).SCRIPT

    def longest_step_s(self, scenario: Scenario) -> float | None:
        """Longest engine step with which the engine is right in this scene; ``None``: any."""
        most_rad = self.traits.most_turn_rad
        turn_rad_s = fastest_turn_rad_s(scenario) if most_rad else 0.0
        return most_rad / turn_rad_s if most_rad and turn_rad_s else None

    def open(self, scenario: Scenario, settings: Settings) -> Simulation:
        """Refuses what the engine cannot do, builds the scene and reads every value back."""
        refuse(self, scenario, settings)
        if settings.contact == ASSISTED:
            taken = self.helps if settings.helps is None else self.helps & settings.helps
            settings = dataclasses.replace(settings, helps=taken)
        if settings.takes(LANDING):
            landing.refuse(self.name, scenario)
            if self.traits.bounces_by == SPRING:
                spring_contact.refuse(self.name, scenario)
        self._refuse_long_step(scenario, settings)
        started = time.perf_counter()
        engine = self.load()
        loaded = time.perf_counter()
        tuning: tuple[TuningRow, ...] = ()
        if settings.gives(TUNED) and not settings.takes(LANDING):
            settings, tuning = tuned(self, engine, scenario, settings)
        calibrated = time.perf_counter()
        simulation = self.build(engine, scenario, settings)
        try:
            simulation.read_back_start(self.name)
        except BaseException:
            simulation.close()
            raise
        simulation.tuning = tuning
        simulation.notes += self._variant_notes(settings)
        simulation.notes += tuple(note for row in tuning for note in row.notes)
        simulation.wall_s = {
            "import": loaded - started,
            "tune": calibrated - loaded,
            "build": time.perf_counter() - calibrated,
        }
        return simulation

    def build(self, engine: Any, scenario: Scenario, settings: Settings) -> Simulation:  # noqa: ANN401
        """Builds the scene in the loaded engine and reads every physical value back.

        Raises:
            Unsupported: the engine, or a help, cannot do this scene.
            ReadBackMismatch: the engine holds another value than was set, or does not say.
        """
        scene = self.scene(scenario, settings)
        self._refuse_bodies(scenario)
        simulation = self.make(engine, scene)
        try:
            simulation.set_up()
            own = Audit(self.name)
            simulation.own_parameters(own)
            answers = simulation.answers(quantities(scene))
            simulation.audit = audit_of(scene, answers, own.rows)
        except BaseException:
            simulation.close()
            raise
        return simulation

    def scene(self, scenario: Scenario, settings: Settings) -> Scene:
        """What is to be built of a scenario; the engine itself is not needed for it.

        Raises:
            Unsupported: a help cannot be had for this scene.
        """
        return make_scene(
            self.name, self.traits, self.features, scenario, settings, self.variant
        )  # fmt: skip

    def make(self, engine: Any, scene: Scene) -> Simulation:  # noqa: ANN401
        """Builds a scene in the loaded engine."""
        made: Simulation = self.simulation(engine, scene)
        return made

    def refuse_no_help(self, settings: Settings) -> None:
        """Refuses "assisted" of a variant that takes no help: it would be "tuned".

        Raises:
            Unsupported: it is such a variant; says why it takes none.
        """
        own = self.variants[self.variant] if self.variant else None
        asked = settings.contact == ASSISTED and settings.helps != frozenset()
        if asked and own is not None and own.without and not self.helps:
            raise Unsupported(
                f"{self.name} takes none of our helps: {own.why}; see the level {TUNED}"
            )

    def _variant_notes(self, settings: Settings) -> tuple[str, ...]:
        """What differs from the engine as it comes."""
        if not self.variant:
            return ()
        own = self.variants[self.variant]
        said = [f"variant {self.variant}: {own.text} [{own.reference}]"]
        if settings.contact == ASSISTED and own.without:
            said.append(f"variant {self.variant} takes no {known(own.without)}: {own.why}")
        return tuple(said)

    def _refuse_bodies(self, scenario: Scenario) -> None:
        most = self.traits.most_shapes
        for name, body in scenario.bodies.items():
            if any(body.center_of_mass_m) and not self.traits.offset_centres:
                raise Unsupported(f"{self.name}: the centre of mass of {name} is not at its origin")
            if most is not None and len(body.shapes) > most:
                raise Unsupported(f"{self.name}: {name} has more than {most} shape")

    def _refuse_long_step(self, scenario: Scenario, settings: Settings) -> None:
        longest_s, step_s = self.longest_step_s(scenario), scenario.world.engine_step_s
        if settings.gives(TUNED) and longest_s is not None and step_s > longest_s * (1 + 1e-9):
            raise Unsupported(
                f"{self.name} is right in this scene with steps of at most {longest_s:.3g} s, not"
                f" {step_s:.3g} s; use a shorter --step"
            )

    def simulate(self, scenario: Scenario, settings: Settings) -> Trajectory:
        """Runs the scenario to its end through the engine's fastest recording loop."""
        simulation = self.open(scenario, settings)
        try:
            return simulation.run(self.name, self.version())
        finally:
            simulation.close()


def refuse(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """Raises :class:`Unsupported` if the backend lacks what the scenario needs.

    Restitution is needed only where the mode is to apply it.
    """
    if isinstance(backend, EngineBackend):
        backend.refuse_no_help(settings)
    wanted = needs(scenario).required
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
