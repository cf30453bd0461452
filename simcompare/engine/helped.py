"""Drives, helps and recording of one open scene: what acts in each step, and what is read of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from simcompare.engine.drives import Drive
from simcompare.engine.features import Feature
from simcompare.engine.helps import (
    CENTRED_EFFORTS,
    HALF_STEP_START,
    LANDING,
    RAYS,
    REACTIONS,
    RECOIL,
    half_step_start,
    spring_contact,
)
from simcompare.engine.helps.landing import ContactSteps, Landing, approaches
from simcompare.engine.helps.reactions import Surplus, sensed_wrongly
from simcompare.engine.helps.recoil import Recoil, note_without, rotors_of
from simcompare.engine.hooks import EngineHooks
from simcompare.engine.scene import Scene
from simcompare.engine.state import compare_start
from simcompare.errors import Unsupported
from simcompare.model.audit import AuditRow
from simcompare.model.sensor import Sensor
from simcompare.model.settings import SPRING
from simcompare.model.trajectory import Array
from simcompare.model.tuning import TuningRow

#: slower bodies than this need not be landed on to within rounding [m/s]
LANDING_SPEED_M_S = 5.0


class HelpedSimulation(EngineHooks):
    """A scene that is driven, helped and recorded.

    Args:
        scene: what is to be built.

    Attributes:
        lead: engine steps by which forces act later than at the positions before a step.
        audit: what was set and read back.
        notes: what the reader should know about this run.
        lacks: signals that are not given -> why.
        tuning: how the numbers for restitution were found.
        wall_s: wall time by stage [s].
    """

    wall_s: Mapping[str, float]

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self.audit: tuple[AuditRow, ...] = ()
        self.tuning: tuple[TuningRow, ...] = ()
        self.lacks: dict[str, str] = {}
        self.notes: tuple[str, ...] = ()
        self.wall_s = {}
        self._force_sensors: dict[str, Sensor] = {}
        for name, sensor in self.scenario.sensors.items():
            if sensor.type in ("force", "contact_force"):
                reason = self._without(sensor) or self.reason_lacking(sensor)
                if reason:
                    self.lacks[f"{name}.{next(iter(sensor.signals))}"] = reason
                else:
                    self._force_sensors[name] = sensor
        self._range_sensors = self._own_ranges()
        self._force_columns = sum(map(_columns, self._force_sensors.values()))
        self._pairs = {frozenset(s.pair): s.pair for s in self._force_sensors.values() if s.pair}
        self._first_forces: Sequence[float] | None = None
        self.substeps = self.scenario.world.substeps
        self._prepare_drive()
        self._prepare_start()
        self._prepare_recoil()
        self._prepare_reactions()
        self._acts = bool(self._drive or self._dragged or self.recoil)

    @property
    def is_plain(self) -> bool:
        """Whether there is nothing but one free body to record, without forces in each step."""
        return not (
            self._dragged
            or self._joints
            or self._force_sensors
            or self.substeps > 1
            or len(self._bodies) != 1
            or len(self._free) != 1
        )

    @property
    def is_dragged_alone(self) -> bool:
        """Whether air drag is all that acts in a step, and every step is recorded."""
        others = self._joints or self._force_sensors or self.substeps > 1
        return bool(self._dragged) and not others

    @property
    def stagger(self) -> float:
        """Where steps store velocities, seen from the positions [steps]."""
        return (0.5 if self.scene.traits.positions_first else -0.5) / self.inner_steps

    @property
    def _forces_at_end(self) -> bool:
        return self.scene.traits.positions_first or self.inner_steps > 1

    # --- helps --------------------------------------------------------------------------------

    def _prepare_drive(self) -> None:
        scene, takes = self.scene, self.settings.takes
        # forces act at the end of a step, at its start, or on the mean of all inner steps
        self.lead = lead = 1.0 if scene.traits.positions_first else (1 - 1 / self.inner_steps) / 2
        centred = takes(CENTRED_EFFORTS)
        given = {name: joint.given for name, joint in scene.joints.items()}
        drive = Drive(self.scenario, self.step_s, lead, centred, given)
        self._drive = drive if drive.names else None
        follows = any(j.law.stiffness or j.law.damping for j in scene.joints.values())
        # what only follows the inputs is the same at either instant, unless a step acts at its end
        late = bool(lead and (drive.names or self._dragged)) or (
            self.inner_steps > 1 and bool(self._dragged)
        )
        if centred and (follows or late):
            self.helps.add(CENTRED_EFFORTS)

    def _prepare_start(self) -> None:
        traits, takes, stagger = self.scene.traits, self.settings.takes, self.stagger
        if takes(LANDING):
            ahead = 1 / self.inner_steps if traits.foresees_contacts else 0.0
            steps = ContactSteps(
                stagger, traits.contact_step_s, rest_step_s=traits.rest_step_s, ahead=ahead
            )
            if traits.bounces_by == SPRING:
                steps = spring_contact.steps_for(self.scenario, stagger)
            self._prepare_landing(steps)
        is_landing = self._landing is not None
        if takes(HALF_STEP_START) and half_step_start.acts(
            self.scenario, traits.positions_first, is_landing=is_landing
        ):
            # the scenario's initial velocities belong to a step of length zero
            self._engine_step_s = 0.0
            self._stagger = stagger if is_landing or not traits.positions_first else 0.0
            self.helps.add(HALF_STEP_START)
            self.velocity_offset_s = stagger * self.step_s

    def _prepare_landing(self, steps: ContactSteps) -> None:
        pairs, notes = approaches(self.scenario)
        self.notes = tuple(notes)
        if pairs or notes:  # where nothing is landed on, it still brings numbers and steps
            self.helps.add(LANDING)
        if not pairs:
            return
        self._refuse_far_places(steps)
        if self._force_sensors:
            raise Unsupported("forces are not recorded while impacts are landed on")
        if self.substeps > 1:
            raise Unsupported("where impacts are landed on, recorded steps are not divided further")
        self._landing = Landing(pairs, self.scenario.world.step_s, steps)
        self._stagger = steps.stagger
        self.notes += (
            f"a recorded step with an impact in it is divided into {self._landing.parts} parts"
            f" of {self._landing.part_s:.3g} s; flights take whole steps",
        )

    def _refuse_far_places(self, steps: ContactSteps) -> None:
        """Refuses places where a step of an impact moves a body by less than its place is rounded.

        The precision that an engine states is ten times the rounding of its numbers.
        """
        far_m = steps.contact_step_s * LANDING_SPEED_M_S / self.scene.traits.precision
        bodies = self.scenario.bodies.values()
        place_m = max(abs(c) for body in bodies for c in body.position_m)
        if place_m > far_m:
            raise Unsupported(
                f"{self.scene.engine}: impacts are landed on within {far_m:.0f} m of the origin,"
                f" and a body is {place_m:.4g} m away, where its numbers are too coarse for such"
                " short steps; move the scene, or use the level tuned"
            )

    def _prepare_recoil(self) -> None:
        if self.scene.traits.has_armature:
            return
        rotors = rotors_of(self.scenario)
        if rotors and self.settings.takes(RECOIL):
            self.helps.add(RECOIL)
            self.recoil = Recoil(self.scenario, rotors)
            self.notes += self.recoil.notes()
        elif rotors:
            self.notes += (note_without(rotors),)

    def _without(self, sensor: Sensor) -> str:
        """Why a force sensor is not read, as far as the core knows; empty where it is."""
        scene, is_joint = self.scene, sensor.type == "force"
        feature = Feature.FORCE_SENSOR if is_joint else Feature.CONTACT_FORCE
        if feature not in scene.features:
            return f"simcompare's backend for {scene.engine} has no {feature}"
        magnitude = is_joint and "magnitude" in scene.traits.wrong_reactions
        if magnitude and not self.settings.takes(REACTIONS):
            return f"{scene.engine} tells the magnitude of a joint's impulse and not its direction"
        return ""

    def _own_ranges(self) -> dict[str, Sensor]:
        """Range sensors that read through the engine's own rays."""
        scene, all_of_them = self.scene, self.scenario.range_sensors()
        if all_of_them and self.settings.takes(RAYS):
            self.helps.add(RAYS)
        elif Feature.RAYS in scene.features:
            return all_of_them
        else:
            reason = f"simcompare's backend for {scene.engine} has no {Feature.RAYS}"
            self.lacks |= {f"{name}.range_m": reason for name in all_of_them}
        return {}

    def _prepare_reactions(self) -> None:
        """Which forces are mended: those that an engine tells wrongly, or as a magnitude only."""
        self._surplus: Surplus | None = None
        self._widest_gap_m = math.inf
        wrong_ones, kinds = self.scene.traits.wrong_reactions, set()
        if self.settings.takes(REACTIONS):
            kinds = {sensor.type for sensor in self._force_sensors.values()}
        if "magnitude" in wrong_ones and "force" in kinds:
            self.helps.add(REACTIONS)
        if "stale" in wrong_ones and "contact_force" in kinds:
            self._widest_gap_m = self.scene.contact_gap_m
            self.helps.add(REACTIONS)
        if "twice" in wrong_ones and self.settings.takes(REACTIONS):
            wrong = sensed_wrongly(self.scene.engine, self.scenario)
            if wrong:
                self._surplus = Surplus(self.scene, wrong)
                self.helps.add(REACTIONS)

    def _stagger_start(self) -> None:
        """Moves the velocities from the start to where steps store them, if that is to be done."""
        if self._engine_step_s or HALF_STEP_START not in self.helps:
            return
        if self.scene.traits.positions_first:
            self.begin_after()
            self._engine_step_s = self.step_s
        else:
            half_step_start.begin_before(self)

    def begin_after(self) -> None:
        """Moves the velocities to half a step after the start, where positions come first."""
        raise NotImplementedError(
            f"{HALF_STEP_START} is for planar engines if positions come first"
        )

    # --- stepping and recording ---------------------------------------------------------------

    def advance(self, count: int) -> None:
        """Takes ``count`` engine steps of the present length, with drag and drive in each."""
        if not self._acts:
            self.take_steps(count)
            return
        if self.efforts_last and self._drive and not (self._dragged or self.recoil):
            efforts = self._drive.steady(count)
            if efforts is not None:
                self.give(efforts)
                self.take_steps(count)
                return
        for _ in range(count):
            self.act()
            self.take_steps(1)

    def act(self) -> None:
        """Gives all that acts from outside in the next engine step."""
        drive, recoil = self._drive, self.recoil
        if drive is not None:
            self.give(drive.efforts(*(self.joint_motions() if drive.follows else ((), ()))))
        if recoil is not None:
            torques = recoil.torques(self.rotor_motions())
            for rotor, (back, *given) in zip(recoil.rotors, torques, strict=True):
                x, y, z = rotor.parent_axis
                self.twist(rotor.parent, (back * x, back * y, back * z))
                self.twist(rotor.child, (given[0], given[1], given[2]))
        for name in self._dragged:
            self.push(name, self.drag_law(name)(*self.stored_motion(name)[1]))

    def forces(self) -> Sequence[float]:
        """Readings of all force sensors in the last engine step, in the order of the scenario."""
        found: list[float] = []
        normals = self.contact_forces() if self._pairs else {}
        for sensor in self._force_sensors.values():
            if sensor.joint is not None:
                found += self.joint_force(sensor.joint)
            else:
                found.append(normals.get(frozenset(sensor.pair or ()), 0.0))
        return found

    def record(self, count: int) -> list[Sequence[float]] | Array:
        """Takes ``count`` whole recorded steps free of impacts and returns their rows.

        Engines override this with their tightest loop. Where the forces of a step act at its start,
        they are read after the first engine step of each recorded one, else after the last.
        """
        if self._surplus is not None:
            return self._record_without_surplus(count, self._surplus)
        if self.is_dragged_alone:
            return self._record_dragged(count)
        rows: list[Sequence[float]] = []
        ends, row, substeps = self._forces_at_end, self.row, self.substeps
        advance = self.advance if self._acts else self.take_steps
        for _ in range(count if not self._force_sensors else 0):
            advance(substeps)
            rows.append(row())
        for _ in range(count if self._force_sensors else 0):
            if ends:
                self.advance(self.substeps - 1)
            self.mark()
            self.advance(1)
            forces = self.forces()
            if not ends:
                self.advance(self.substeps - 1)
            rows.append((*self.row(), *forces))
        return rows

    def _record_dragged(self, count: int) -> list[Sequence[float]]:
        """The same where only drag acts, which follows from the rows that are recorded."""
        laws = [(name, self.drag_law(name)) for name in self._dragged]
        rows, push, velocity_in = [self.row()], self.push, self.velocity_in
        for _ in range(count):
            for name, law in laws:
                push(name, law(*velocity_in(rows[-1], name)))
            self.take_steps(1)
            rows.append(self.row())
        return rows[1:]

    def _record_without_surplus(self, count: int, surplus: Surplus) -> Array:
        """The same where forces through joints have too much in them, which is taken off."""
        before, after, efforts, torques = [self.row()], [], [], []
        for _ in range(count):
            self.advance(1)
            efforts.append([] if self._drive is None else self._drive.given)
            torques.append([] if self.recoil is None else self.recoil.given)
            forces = self.forces()
            self.advance(self.substeps - 1)
            before.append(self.row())
            after.append((*before[-1], *forces))
        rows, motion = np.array(after), self.motions(np.array(before[:-1]))
        pushed = {name: np.array(efforts)[:, i] for i, name in enumerate(self.driven or ())}
        found, column = surplus.forces(motion, pushed, np.array(torques), count), len(before[0])
        for sensor in self._force_sensors.values():
            if sensor.joint in found:
                rows[:, column : column + 3] -= found[sensor.joint]
            column += _columns(sensor)
        return rows

    def read_back_start(self, engine: str) -> None:
        """Compares the initial motion that the engine holds with the scenario's.

        Raises:
            ReadBackMismatch: they differ; every component that does is named.
        """
        held = {name: self.origin_of(name) for name in self._bodies if name not in self._free}
        compare_start(engine, self.scenario, self.state, held, self.scene.traits.precision)


def _columns(sensor: Sensor) -> int:
    """How many numbers a sensor of a force gives."""
    return sum(sensor.signals.values())
