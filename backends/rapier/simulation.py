"""A world of Rapier: building, stepping and reading it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from operator import attrgetter
from typing import Any, Literal

import numpy as np

from simcompare.kit import (
    TUNED,
    Array,
    Audit,
    BodyState,
    Held,
    Numbers,
    Rule,
    Scene,
    SceneJoint,
    SimulationDiverged,
    SpatialSimulation,
    Table,
    Vector,
    matrix_of,
    mobility,
    multiplied,
    times,
    x_turned_to,
)

#: numbers of Rapier's that are set from ``tuned`` on, with their units
NUMBERS = {
    "num_internal_pgs_iterations": (50, "1"),
    "num_internal_stabilization_iterations": (0, "1"),
    "contact_clustering": (False, "1"),
    "contact_recycling": (False, "1"),
    "normalized_prediction_distance": (1.0, "m"),
    "normalized_max_linear_velocity": (1e30, "m/s"),
}
#: and of its bodies; what can_sleep=False sets is the threshold
OF_BODIES = {"allow_fast_rotation": (True, "1"), "activation.linear_threshold": (-1.0, "m/s")}
#: what the values of two bodies stand for
KINDS: tuple[Literal["restitution", "friction"], ...] = ("restitution", "friction")
#: rules by which they can be combined, as Rapier calls them; its own is the mean
RULES: Mapping[Rule, str] = {"product": "MULTIPLY", "min": "MIN", "max": "MAX"}
#: damping of a motor that stops a joint at once, up to its largest force: Coulomb's friction
AT_ONCE = 1e20
#: kind of joint -> what it locks, and its free axis
AXES = {
    "hinge": ("LOCKED_REVOLUTE_AXES", "ANG_X"), "slider": ("LOCKED_PRISMATIC_AXES", "LIN_X"),
    "fixed": ("LOCKED_FIXED_AXES", "ANG_X"),
}  # fmt: skip
#: shape of a scenario -> Rapier's
SHAPES: Mapping[str, Callable[[Any, Any], Any]] = {
    "plane": lambda make, shape: make.halfspace(shape.normal),
    "sphere": lambda make, shape: make.ball(shape.radius_m),
    "box": lambda make, shape: make.cuboid(*(edge / 2 for edge in shape.size_m)),
    "capsule": lambda make, shape: make.capsule_z(shape.length_m / 2, shape.radius_m),
    "cylinder": lambda make, shape: make.cylinder(shape.length_m / 2, shape.radius_m),
}
#: and the sizes that one of Rapier's holds
SIZES: Mapping[str, Callable[[Any], list[float]]] = {
    "plane": lambda _: [],
    "sphere": lambda held: [held.as_ball().radius],
    "box": lambda held: [2 * half for half in held.as_cuboid().half_extents],
    "capsule": lambda held: [held.as_capsule().radius, 2 * held.as_capsule().half_height],
    "cylinder": lambda held: [held.as_cylinder().radius, 2 * held.as_cylinder().half_height],
}


class RapierSimulation(SpatialSimulation):
    """A world; handles of its parts stay valid when it is restored."""

    def __init__(self, rapier: Any, scene: Scene) -> None:
        self._rapier, self._is_tuned = rapier, scene.gives(TUNED)
        # Rapier divides a step into four, but springs and motors are forces on a whole one
        self.inner_steps = 1 if self._is_tuned and scene.joints else 4
        super().__init__(scene)
        world = self._world = rapier.PhysicsWorld(self.scenario.world.gravity_m_s2)
        parameters = world.integration_parameters
        parameters.dt = self.step_s
        if self._is_tuned:
            parameters.num_solver_iterations = self.inner_steps
            for name, (value, _) in NUMBERS.items():
                setattr(parameters, name, value)
            # contacts are critically damped, at one turn in a step
            parameters.contact_softness = parameters.static_contact_softness = (
                rapier.SpringCoefficients(1 / self.step_s, 1.0)
            )
        self._rules = {
            kind: scene.contacts.by_first_rule(kind, [*RULES], scene.engine)
            for kind in (KINDS if scene.contacts.are_given else ())
        }
        self._handles = {name: world.add_body(self._body(name)) for name in self.scenario.bodies}
        self._solids = {
            name: [world.add_collider(solid, handle) for solid in self._colliders(name)]
            for name, handle in self._handles.items()
        }
        self._unmixing: dict[str, tuple[Array, Array]] = {}
        self._made = {name: self._join(joint) for name, joint in scene.joints.items()}
        for handle in self._handles.values():  # else it happens in the first step
            world.rigid_bodies[handle].recompute_mass_properties_from_colliders(world.colliders)
        self.take_back(self.snapshot())
        self.place_all()

    # --- building -----------------------------------------------------------------------------

    def _body(self, name: str) -> Any:
        body, rapier = self.scenario.bodies[name], self._rapier
        made = (rapier.RigidBody.fixed if body.fixed else rapier.RigidBody.dynamic)(
            position=_pose(body.position_m, body.orientation_wxyz),
            can_sleep=not self._is_tuned,
            allow_fast_rotation=self._is_tuned,
        )
        if body.fixed:
            return made
        moments = self.scene.moments(name)
        mass = rapier.MassProperties((0, 0, 0), body.mass_kg, moments)
        # where all moments are equal there is no gyroscopic torque, only its rounding
        turns = len(set(moments)) > 1 or not self._is_tuned
        return made.additional_mass_properties(mass).gyroscopic_forces(turns)

    def _colliders(self, name: str) -> Iterator[Any]:
        surface = self._surface(name) if self._rules else {}
        for shape in self.scene.shapes[name]:
            made = SHAPES[shape.type](self._rapier.SharedShape, shape)
            turn = (1.0, 0.0, 0.0, 0.0) if shape.type == "plane" else shape.orientation_wxyz
            if shape.type == "cylinder":  # Rapier's lies along y
                turn = multiplied(turn, (0.5**0.5, 0.5**0.5, 0, 0))
            yield self._rapier.Collider.new(
                made, position=_pose(shape.position_m, turn), density=0.0, **surface
            )

    def _surface(self, name: str) -> dict[str, Any]:
        rapier, rules = self._rapier, self._rapier.CoefficientCombineRule
        bits = self.scene.contacts.bits(self.scene.engine)[name]
        return {
            "collision_groups": rapier.InteractionGroups(*map(rapier.Group.from_bits, bits)),
            **{kind: values[name] for kind, (_, values) in self._rules.items()},
            **{
                f"{kind}_combine_rule": getattr(rules, RULES[rule])
                for kind, (rule, _) in self._rules.items()
            },
        }

    def _join(self, joint: SceneJoint) -> Any:
        """Adds a joint, whose frames have their x axes along its own."""
        rapier, mount, turn = self._rapier, joint.mount, x_turned_to(joint.mount.axis)
        locked, free = AXES[joint.joint.type]
        made = rapier.GenericJoint.builder(
            getattr(rapier.JointAxesMask, locked),
            contacts_enabled=False,
            local_frame1=_pose(joint.joint.anchor_m, multiplied(mount.orientation_wxyz, turn)),
            local_frame2=_pose(mount.anchor_m, turn),
        )
        if joint.own.friction:
            axis, force = getattr(rapier.JointAxis, free), rapier.MotorModel.FORCE_BASED
            made = (
                made.motor_velocity(axis, 0.0, AT_ONCE)
                .motor_max_force(axis, joint.own.friction)
                .motor_model(axis, force)
            )
        ends = (self._handles[name] for name in (joint.joint.parent, joint.joint.child))
        return self._world.impulse_joints.insert(*ends, made.build())

    # --- stepping -----------------------------------------------------------------------------

    def set_engine_step(self, step_s: float) -> None:
        self._world.integration_parameters.dt = step_s

    def take_steps(self, count: int) -> None:
        for _ in range(count):
            self._world.step()
        for held in self._held.values() if self._acts else ():  # else they are pushed for ever
            held.reset_forces()
            held.reset_torques()

    def get(self, body: str) -> BodyState:
        held = self._held[body]
        p, q, v, w = held.translation, held.rotation, held.linvel, held.angvel
        return BodyState((p.x, p.y, p.z), (q.w, q.i, q.j, q.k), (v.x, v.y, v.z), (w.x, w.y, w.z))

    def put(self, body: str, state: BodyState) -> None:
        held = self._held[body]
        held.position = _pose(state.position_m, state.orientation_wxyz)
        held.linvel, held.angvel = state.velocity_m_s, state.rate_rad_s

    def push(self, body: str, force: Vector) -> None:
        self._held[body].add_force(force)

    def turn(self, body: str, torque: Vector) -> None:
        self._held[body].add_torque(torque)

    def snapshot(self) -> object:
        return self._world.snapshot()

    def take_back(self, snapshot: object) -> None:
        self._world = self._rapier.PhysicsWorld.restore(snapshot)
        self._held = {
            name: self._world.rigid_bodies[handle] for name, handle in self._handles.items()
        }

    def check(self) -> None:
        super().check()
        if not all(held.is_enabled for held in self._held.values()):
            # Rapier takes bodies out whose numbers are none any more
            raise SimulationDiverged(
                f"numbers overflowed by t = {self.time_s:g} s; try a smaller --step"
            )

    # --- forces -------------------------------------------------------------------------------

    def contact_force(self, first: str, second: str) -> float:
        find, solids = self._world.narrow_phase.contact_pair, self._solids
        pairs = (find(one, other) for one in solids[first] for other in solids[second])
        # only points that are solved: the others keep the impulses that they had when they were
        impulses = (
            points[contact.contact_id].impulse
            for pair in pairs if pair
            for points, data in [(one.points, one.data) for one in pair.manifolds]
            for contact in data.solver_contacts
        )  # fmt: skip
        return float(sum(impulses)) / self.step_now_s

    def mark(self) -> None:
        super().mark()
        for name in self._sensed:
            joint = self.scene.joints[name]
            axes, matrix = mobility(
                self.scene, joint, self.get(joint.joint.parent), self.get(joint.joint.child)
            )
            # Rapier takes from each locked axis what those before it do along it: its impulses are
            # those of forces times this factor
            free = int(joint.joint.type == "slider")
            lower = np.linalg.cholesky(matrix)[free - 3 :, free - 3 :]
            self._unmixing[name] = axes, np.eye(3)
            self._unmixing[name][1][free:, free:] = (lower / lower.diagonal()).T

    def reaction(self, joint: str) -> Vector:
        axes, unmix = self._unmixing[joint]
        held = self._world.impulse_joints.get(self._made[joint])
        rubs = held.data.motor(self._rapier.JointAxis.LIN_X)
        impulses = np.add(held.impulses[:3], (rubs.impulse if rubs else 0.0, 0.0, 0.0))
        # they are those of the last part of the step
        on_parent = (np.linalg.solve(unmix, impulses) @ axes).tolist()
        return times(-self.inner_steps / self.step_now_s, on_parent)

    # --- rays ---------------------------------------------------------------------------------

    def cast_rays(
        self, origin_m: Vector, directions: Array, without_body: str, reach_m: float
    ) -> Sequence[float]:
        world, make = self._world, self._rapier.Ray
        world.update_query_pipeline()  # bodies may have been put elsewhere
        own = self._handles.get(without_body)
        others = self._rapier.QueryFilter(exclude_rigid_body=own) if own is not None else None
        cast = world.query_pipeline.cast_ray
        hits = [cast(make(origin_m, one), reach_m, False, others) for one in directions.tolist()]
        return [math.inf if hit is None else hit[1] for hit in hits]

    # --- what it holds ------------------------------------------------------------------------

    def held_of_world(self) -> Table:
        return {
            "step_s": Held("dt", self._world.integration_parameters.dt),
            "gravity_m_s2": Held("gravity", [*self._world.gravity]),
        }

    def held_of_body(self, body: str) -> Table:
        held, solids = self._held[body], [self._world.colliders[at] for at in self._solids[body]]
        # a shape off the middle lets Rapier sort the moments, along axes that are turned for it
        turn, own = held.mass_properties.principal_inertia_local_frame, held.mass_properties
        axes = matrix_of((turn.w, turn.i, turn.j, turn.k))
        return {
            "mass_kg": Held("mass", held.mass),
            "inertia_kg_m2": Held(
                "principal_inertia", (axes**2 @ [*own.principal_inertia]).tolist(),
                self.scene.moments(body), self.scene.armature_note(body),
            ),
            "size_m": [
                Held("shape", SIZES[shape.type](solid.shape))
                for shape, solid in zip(self.scene.shapes[body], solids, strict=True)
            ],
        }  # fmt: skip

    def held_of_joint(self, joint: str) -> Table:
        stated = self.scene.joints[joint].joint
        data = self._world.impulse_joints.get(self._made[joint]).data
        place = self._held[stated.parent].position.transform_point(data.local_frame1.translation)
        turn = self._held[stated.child].rotation * data.local_frame2.rotation
        motor = data.motor(getattr(self._rapier.JointAxis, AXES[stated.type][1]))
        return {
            "anchor_m": Held("local_frame1", [*place]),
            "axis": Held("local_frame2", [*turn.transform_vector((1.0, 0.0, 0.0))]),
            "friction": Held("motor.max_force", motor and motor.max_force),
        }

    def held_of_pair(self, first: str, second: str) -> Table:
        solids = {n: self._world.colliders[self._solids[n][0]] for n in (first, second)}
        return {
            kind: [
                Held(
                    f"{kind} of {name}", getattr(solid, kind),
                    self._rules[kind][1][name] if self._rules else None,
                    f"on both: {getattr(solid, f'{kind}_combine_rule')}",
                )
                for name, solid in solids.items()
            ]
            for kind in KINDS
        }  # fmt: skip

    def own_parameters(self, audit: Audit) -> None:
        softness = {"natural_frequency": (1 / self.step_s, "Hz"), "damping_ratio": (1.0, "1")}
        values: dict[str, tuple[float, str]] = {
            "num_solver_iterations": (self.inner_steps, "1"), **NUMBERS,
            **{f"contact_softness.{part}": put for part, put in softness.items()},
            **{f"static_contact_softness.{part}": put for part, put in softness.items()},
        }  # fmt: skip
        tables = [("solver", self._world.integration_parameters, values)]
        for name in self.scenario.moving_bodies():
            turns = len(set(self.scene.moments(name))) > 1, "1"
            own = {**OF_BODIES, "gyroscopic_forces_enabled": turns}
            tables.append((name, self._held[name], own))
        for of, held, table in tables:
            for name, (value, unit) in table.items():
                audit.add(
                    of, None, name, (value if self._is_tuned else None, attrgetter(name)(held)),
                    unit, "" if self._is_tuned else "engine's default",
                )  # fmt: skip


def _pose(position: Numbers, orientation_wxyz: Numbers) -> tuple[Numbers, Numbers]:
    """A place as Rapier takes it, with its quaternions xyzw."""
    return position, (*orientation_wxyz[1:], orientation_wxyz[0])
