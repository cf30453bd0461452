"""pymunk (Chipmunk), two-dimensional: the scenario's x-z plane is its x-y plane."""

from __future__ import annotations

import math
from collections.abc import Sequence
from types import ModuleType
from typing import Any

import numpy as np

from simcompare.backend import JOINTS_AND_FORCES, EngineBackend, Feature, KnownLimit
from simcompare.backends._pymunk_forces import ForceReader
from simcompare.backends._pymunk_joints import GROOVE_HALF_LENGTH_M, Slider
from simcompare.backends._pymunk_scene import Scene, angle_of, audit_of, bends_of, build
from simcompare.backends._recoil import Motion, RecoilingSimulation
from simcompare.drives import Drive
from simcompare.errors import SimulationDiverged
from simcompare.free_motion import has_drag
from simcompare.helps import CENTRED_EFFORTS, HALF_STEP_START, LANDING, REACTIONS, RECOIL
from simcompare.landing import ContactSteps
from simcompare.pairs import refuse_offsets
from simcompare.scenario import MOVABLE, SENSOR_SIGNALS, Scenario, Sensor
from simcompare.scripts.contract import EngineScript
from simcompare.settings import COEFFICIENT, Settings
from simcompare.shapes import Vector
from simcompare.simulation import Simulation
from simcompare.state import BodyState, State
from simcompare.trajectory import Array

#: longest step during an impact [s]
CONTACT_STEP_S = 4.0e-6


class PymunkSimulation(RecoilingSimulation):
    """A space with its bodies; those on joints move like all others, held by constraints."""

    #: Chipmunk advances positions before velocities
    LEAD = 1

    def __init__(self, engine: ModuleType, scenario: Scenario, settings: Settings) -> None:
        # hence the stagger of +1/2
        steps = ContactSteps(
            stagger=0.5,
            contact_step_s=CONTACT_STEP_S,
            # a longer step at rest would multiply the remembered impulse and throw the body up
            rest_step_s=CONTACT_STEP_S,
        )
        self._engine = engine
        scene = build(engine, scenario, settings)
        super().__init__(scenario, audit_of(scene).finish(), settings, steps)
        self._prepare_recoil()
        self._use(scene)
        self._step_s = self._whole_step_s
        self._reader = ForceReader(scenario, self._force_sensors)
        self._first_forces: Sequence[float] | None = None
        bouncing = any(contact.restitution > 0 for contact in scenario.contacts)
        if settings.takes(HALF_STEP_START) and self._landing is None and not bouncing:
            # velocities at the start are not staggered yet: they belong to a step of length zero
            self._engine_step_s = 0.0
            self.helps.add(HALF_STEP_START)
            self.velocity_offset_s = steps.stagger * self._whole_step_s

    def _use(self, scene: Scene) -> None:
        self._scene, self._space, self._held = scene, scene.space, scene.bodies
        self._moving = [scene.bodies[name] for name in self._bodies]
        names = self._drive.names if self._drive is not None else ()
        self._driven = [scene.joints[name] for name in names]
        self._share_loads()
        self._rotors = [
            (scene.joints[r.joint].sign, scene.bodies[r.parent], scene.bodies[r.child])
            for r in (self._recoil.rotors if self._recoil else ())
        ]

    def _share_loads(self) -> None:
        """Gives all driven joints of a body the same load, which is passed on once in each step."""
        loads = {body: [0.0, 0.0, 0.0] for body in self._held.values()}
        pushed, turned = set(), set()
        for joint in self._driven:
            joint.parent_load, joint.child_load = loads[joint.parent], loads[joint.child]
            turned.add(joint.parent)
            if joint.joint.type == "slider":
                pushed |= {joint.parent, joint.child}
            else:
                turned.add(joint.child)
        self._pushed = [(body, loads[body]) for body in self._moving if body in pushed]
        self._turned = [(body, loads[body]) for body in self._moving if body in turned]

    def use_step(self, step_s: float, resting: frozenset[str]) -> None:
        if self._landing is not None:  # else the step never changes
            super().use_step(step_s, resting)

    def set_engine_step(self, step_s: float) -> None:
        self._step_s = step_s

    def advance(self, count: int) -> None:
        step, step_s, drive = self._space.step, self._step_s, self._drive
        for _ in range(count):
            if drive is not None:
                self._push(drive)
            if self._rotors:
                self._push_back()
            if self._dragged:
                for name, (fx, _, fz) in self.drag_forces():
                    body = self._held[name]
                    body.apply_force_at_world_point((fx, fz), body.position)
            step(step_s)

    def _push(self, drive: Drive) -> None:
        """Gives all joints their efforts of the next engine step."""
        step_s = self._step_s
        motions = [joint.motion(step_s) for joint in self._driven]
        efforts = drive.efforts(*zip(*motions, strict=True))
        for joint, effort in zip(self._driven, efforts, strict=True):
            joint.push(effort)
        for body, load in self._pushed:
            body.force = (load[0], load[1])
            load[0] = load[1] = 0.0
        for body, load in self._turned:
            body.torque, load[2] = load[2], 0.0

    def rotor_motions(self) -> list[Motion]:
        return [
            (
                sign * (child.angular_velocity - parent.angular_velocity),
                (0.0, -child.angular_velocity, 0.0),
            )
            for sign, parent, child in self._rotors
        ]

    def _push_back(self) -> None:
        """Gives both bodies of armatures what is missing on them in the next step."""
        assert self._recoil is not None
        torques = self._recoil.torques(self.rotor_motions())
        for (sign, parent, child), (back, _, along, _) in zip(self._rotors, torques, strict=True):
            parent.torque += sign * back
            child.torque -= along

    def _begin(self) -> None:
        """Moves the velocities from the start to half a step after it, where they are stored.

        The engine itself tells by how much: bodies are put where they were a step before the start,
        so that the step that ends there gives all accelerations at the start.

        Bodies on joints go along chords, which leaves gaps that the engine closes in the next step.
        What the joints' motion alone bends them by is put into the start as such a gap, else forces
        and velocities would have to find it in the first two steps.
        """
        step_s, index = self._step_s, self._count * self.substeps
        start = [_motion(body) for body in self._moving]
        bends = bends_of(self.scenario, self.state, step_s)
        for body, (x, z, *_), (bend_x, bend_z) in zip(self._moving, start, bends, strict=True):
            body.position = (x - bend_x, z - bend_z)
        reached = [tuple(body.position) for body in self._moving]
        earlier = [
            (vx - bend_x / step_s, vz - bend_z / step_s, rate)
            for (_, _, vx, vz, _, rate), (bend_x, bend_z) in zip(start, bends, strict=True)
        ]
        for last in [False] * (self._recoil.tries if self._recoil else 0) + [True]:
            for body, (x, z), (ux, uz, rate), (*_, angle, _) in zip(
                self._moving, reached, earlier, start, strict=True
            ):
                body.position = (x - step_s * ux, z - step_s * uz)
                body.angle = angle - step_s * rate
                body.velocity, body.angular_velocity = (ux, uz), rate
            self._step_to(index, last)
            for body, place, (*_, angle, _) in zip(self._moving, reached, start, strict=True):
                body.position, body.angle = place, angle
        later = [_motion(body) for body in self._moving]
        for part in (-0.5, 0.5):
            for body, (_, _, vx, vz, _, rate), (ux, uz, was), (_, _, wx, wz, _, spin) in zip(
                self._moving, start, earlier, later, strict=True
            ):
                body.velocity = (vx + part * (wx - ux), vz + part * (wz - uz))
                body.angular_velocity = rate + part * (spin - was)
            if part < 0 and self._drive is not None:
                rates = [joint.motion(step_s)[1] for joint in self._driven]
                self._drive.go_to(index, rates)
        self._engine_step_s = step_s

    def _step_to(self, index: int, last: bool) -> None:
        """Takes the step that ends at the start, the last time to stay."""
        if self._drive is not None:
            self._drive.go_to(index - 1, None)
        if last:
            self._reader.mark(self._scene)
        self.advance(1)
        if self._recoil is not None:
            self._recoil.look(self.rotor_motions())
            self._recoil.begin(self._recoil.felt)
        if last and self._force_sensors:
            self._first_forces = self.forces()

    def record(self, count: int) -> Any:
        if self._engine_step_s == 0.0 and self._landing is None:
            self._begin()
        if self.is_plain:
            return self._record_one(count)
        advance, row, substeps = self.advance, self.row, self.substeps
        rows: list[Sequence[float]] = []
        for _ in range(count):
            if not self._force_sensors:
                advance(substeps)
                rows.append(row())
                continue
            advance(substeps - 1)
            self._reader.mark(self._scene)
            advance(1)
            rows.append((*row(), *self.forces()))
        return rows

    def _record_one(self, count: int) -> list[Sequence[float]]:
        step, step_s, body = self._space.step, self._step_s, self._moving[0]
        rows: list[Sequence[float]] = []
        for _ in range(count):
            step(step_s)
            rows.append((*body.position, *body.velocity, body.angle, body.angular_velocity))
        return rows

    def row(self) -> tuple[float, ...]:
        values: tuple[float, ...] = ()
        for body in self._moving:
            values += (*body.position, *body.velocity, body.angle, body.angular_velocity)
        return values

    def motions(self, rows: Array) -> dict[str, Array]:
        found: dict[str, Array] = {}
        zero = np.zeros(len(rows))
        columns: dict[str, Sequence[Array | float]] = {}
        for i, name in enumerate(self._bodies):
            x, z, vx, vz, angle, rate = columns[name] = list(rows[:, 6 * i : 6 * i + 6].T)
            # turning from x to z is negative about y, which points away from the viewer
            half = -angle / 2
            found[f"{name}.position_m"] = np.column_stack((x, zero, z))
            found[f"{name}.orientation_wxyz"] = np.column_stack(
                (np.cos(half), zero, np.sin(half), zero)
            )
            found[f"{name}.velocity_m_s"] = np.column_stack((vx, zero, vz))
            found[f"{name}.rate_rad_s"] = np.column_stack((zero, -rate, zero))
        for name, joint in self._joints.items():
            parent = columns.get(joint.parent) or _motion(self._held[joint.parent])
            moved = self._scene.joints[name].recorded(parent, columns[joint.child])
            for part, values in zip(MOVABLE[joint.type], moved, strict=True):
                found[f"{name}.{part}"] = values
        return found

    def stored_motion(self, body: str) -> tuple[Vector, Vector]:
        held = self._held[body]
        (x, z), (vx, vz) = held.position, held.velocity
        return (x, 0.0, z), (vx, 0.0, vz)

    def add_velocity(self, body: str, change_m_s: Vector) -> None:
        held = self._held[body]
        vx, vz = held.velocity
        held.velocity = (vx + change_m_s[0], vz + change_m_s[2])

    def place(self, body: str, state: BodyState) -> None:
        held = self._held[body]
        held.position = (state.position_m[0], state.position_m[2])
        held.velocity = (state.velocity_m_s[0], state.velocity_m_s[2])
        held.angle = angle_of(state.orientation_wxyz)
        held.angular_velocity = -state.rate_rad_s[1]

    def place_joint(self, joint: str, position: float, rate: float) -> None:
        """Nothing is left to do: its bodies were placed, all with coordinates of their own."""

    def set_state(self, state: State) -> None:
        # a new space: impulses that this one remembers from elsewhere would act in the next step
        self._use(build(self._engine, self.scenario, self.settings))
        super().set_state(state)
        for name, joint in self._scene.joints.items():
            self.place(joint.joint.child, state.bodies[joint.joint.child])
            coordinate, _ = state.joints.get(name, (0.0, 0.0))
            # an orientation does not tell how many turns the joint has made
            missing = (joint.angle_of_child(coordinate) - joint.child.angle) / (2 * math.pi)
            joint.child.angle += 2 * math.pi * round(missing)

    def check(self) -> None:
        super().check()
        for name, joint in self._scene.joints.items():
            if isinstance(joint, Slider) and joint.is_at_its_end():
                raise SimulationDiverged(
                    f"{name} reached the end of its rail, {GROOVE_HALF_LENGTH_M:g} m away, by"
                    f" t = {self.time_s:g} s"
                )

    # --- forces -------------------------------------------------------------------------------

    def drag_forces(self) -> list[tuple[str, Vector]]:
        """Drag at the end of the next step, where the forces of a step act."""
        if not self.settings.takes(CENTRED_EFFORTS):
            return super().drag_forces()
        forces, ahead_s = [], self._engine_step_s / 2
        for name, body in self._bodies.items():
            if body.drag is None or not has_drag(body):
                continue
            _, velocity = self.stored_motion(name)
            change = self._free_acceleration(name, velocity)
            vx, vy, vz = (v + a * ahead_s for v, a in zip(velocity, change, strict=True))
            scale = -body.drag.factor_kg_m * math.hypot(vx, vy, vz)
            forces.append((name, (scale * vx, scale * vy, scale * vz)))
        return forces

    def signals(
        self, rows: Array, time_s: Array, inputs: Any, *, lagging: bool = True
    ) -> dict[str, Array]:
        found = super().signals(rows, time_s, inputs, lagging=lagging)
        if lagging and self._first_forces is not None:
            values = iter(self._first_forces)
            for name, sensor in self._force_sensors.items():
                part, size = SENSOR_SIGNALS[sensor.type]
                first = [next(values) for _ in range(size)]
                found[f"{name}.{part}"][0] = first if size > 1 else first[0]
        return found

    def reason_lacking(self, sensor: Sensor) -> str:
        if sensor.type == "force" and not self.settings.takes(REACTIONS):
            return "pymunk tells the magnitude of a joint's impulse and not its direction"
        self.helps |= {REACTIONS} if sensor.type == "force" else set()
        return ""

    def forces(self) -> list[float]:
        return self._reader.read(self._scene, self._step_s)


def _motion(body: Any) -> tuple[float, ...]:
    return (*body.position, *body.velocity, body.angle, body.angular_velocity)


class PymunkBackend(EngineBackend):
    """Chipmunk through the package ``pymunk``; planar scenarios only."""

    name = "pymunk"
    module = "pymunk"
    distribution = "pymunk"
    install = "pip install 'simcompare[pymunk]'"
    features = JOINTS_AND_FORCES | {
        Feature.FREE_BODY, Feature.PLANE, Feature.SPHERE, Feature.BOX,
        Feature.RESTITUTION, Feature.FRICTION, Feature.DRAG,
    }  # fmt: skip
    helps = frozenset({LANDING, HALF_STEP_START, CENTRED_EFFORTS, RECOIL, REACTIONS})
    bounces_by = COEFFICIENT
    known_limits = (
        KnownLimit(
            "Two-dimensional: it runs scenarios whose motion stays in the x-z plane.",
            "pymunk documentation, Overview",
        ),
        KnownLimit(
            "Elasticity is 0 by default, and overlaps up to 0.1 m are left alone: a small ball"
            " dropped with the defaults sinks into the floor.",
            "pymunk documentation, Space.collision_slop; measured",
        ),
        KnownLimit(
            "Impulses remembered between steps are scaled by the ratio of the steps; a step that"
            " changes while bodies touch adds or removes momentum.",
            "Chipmunk cpSpaceStep.c; measured",
        ),
        KnownLimit(
            "There is no half space: a plane is a bar 2 km long and 1 m thick. A slider reaches"
            " 1 km to either side.",
            "pymunk documentation, Segment, GrooveJoint",
        ),
        KnownLimit(
            "Joints are constraints that are solved one after the other, 10 times by default: that"
            " leaves gaps where a heavy body hangs on a light one, and where gaps are closed at"
            " once such bodies run away.",
            "Chipmunk cpSpaceStep.c; measured: a double pendulum of 10 g and 1 kg, error_bias = 0",
        ),
        KnownLimit(
            "Joints give way, and by default are drawn together by less than a hundredth in a step"
            " of 1 ms.",
            "pymunk documentation, Constraint.error_bias; measured: a pendulum of 0.3 m at 8 rad/s"
            " is 0.7 mm too long",
        ),
        KnownLimit(
            "A groove joint whose parts lie askew to its bodies' centres lets its point leave the"
            " groove, the more the faster it slides.",
            "Chipmunk cpGrooveJoint.c, grooveConstrain; measured: 16 mm at 1 m/s",
        ),
        KnownLimit(
            "Joints have no armature: it is added to the child's moment of inertia, and assisted"
            " gives both bodies the torques that are missing where the parent turns, a step late."
            " One that outweighs its parent is refused, and a slider cannot have one.",
            "pymunk documentation, Constraint; measured: errors halve with the step",
        ),
        KnownLimit(
            "A joint tells only the magnitude of its impulse: the force through it is taken from"
            " the change of momentum of all that it carries.",
            "pymunk documentation, Constraint.impulse",
        ),
    )
    mapping = (
        "elasticity of the moving body = e, of the fixed one = 1 (pymunk multiplies);"
        " collision_slop = 1e-9 m, by which planes are raised; joints: error_bias = 0, so that a"
        " gap is closed in the next step, in as many iterations as leave 1e-6 of an error (by the"
        " spectral radius of Gauss and Seidel's matrix, bodies as drawn); a slider's groove passes"
        " through the centre of mass of one body, beside that of the other. Assisted: impacts in"
        " steps of at most 4 µs; efforts"
        " and drag are those at the end of a step, where they act; the first velocities are set"
        " half a step after the start, where the engine holds them"
    )

    def build(self, engine: ModuleType, scenario: Scenario, settings: Settings) -> Simulation:
        refuse_offsets(scenario, self.name)
        return PymunkSimulation(engine, scenario, settings)

    def script(self) -> EngineScript:
        """What writes scenes of this engine as standalone scripts."""
        from simcompare.backends._pymunk_script import SCRIPT

        return SCRIPT


BACKEND = PymunkBackend()
