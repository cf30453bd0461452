"""Stepping and reading a space of Chipmunk."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from simcompare.backends.pymunk.joints import GROOVE_HALF_LENGTH_M, is_at_its_end
from simcompare.backends.pymunk.space import BAR_RADIUS_M, SLOP_M, build
from simcompare.kit import (
    TUNED,
    Audit,
    Held,
    PlanarMotion,
    PlanarSimulation,
    PlanarSlider,
    Scene,
    Shape,
    SimulationDiverged,
    Table,
    sizes_m,
    turned_by,
    unreadable,
)


class PymunkSimulation(PlanarSimulation):
    """A space with its bodies; those on joints move like all others, held by constraints."""

    def __init__(self, pymunk: Any, scene: Scene) -> None:
        super().__init__(scene)
        self._pymunk = pymunk
        self.forget()
        self.place_all()

    def forget(self) -> None:
        # a new space: Chipmunk does not give its impulses away, and they would act in the next step
        self.built = build(self._pymunk, self.scene, self.linkages)
        self._space, self._held = self.built.space, self.built.bodies

    def set_engine_step(self, step_s: float) -> None:
        """Nothing is left to do: each step is told how long it is."""

    def take_steps(self, count: int) -> None:
        step, step_s = self._space.step, self.step_now_s
        for _ in range(count):
            step(step_s)

    def get(self, body: str) -> PlanarMotion:
        held = self._held[body]
        return (*held.position, *held.velocity, held.angle, held.angular_velocity)

    def put(self, body: str, motion: PlanarMotion) -> None:
        held = self._held[body]
        x, z, vx, vz, held.angle, held.angular_velocity = motion
        held.position, held.velocity = (x, z), (vx, vz)

    def load(self, body: str, fx: float, fz: float, torque: float) -> None:
        held = self._held[body]
        if fx or fz:
            x, z = held.force
            held.force = (x + fx, z + fz)
        if torque:
            held.torque += torque

    def record(self, count: int) -> Any:
        if not self.is_plain:
            return super().record(count)
        step, step_s = self._space.step, self.step_now_s
        (body,) = (self._held[name] for name in self._bodies)
        rows: list[Sequence[float]] = []
        for _ in range(count):
            step(step_s)
            rows.append((*body.position, *body.velocity, body.angle, body.angular_velocity))
        return rows

    def check(self) -> None:
        super().check()
        for name, joint in self.linkages.items():
            if isinstance(joint, PlanarSlider) and is_at_its_end(
                self.motion_now(joint.parent), self.motion_now(joint.child)
            ):
                raise SimulationDiverged(
                    f"{name} reached the end of its rail, {GROOVE_HALF_LENGTH_M:g} m away, by"
                    f" t = {self.time_s:g} s"
                )

    # --- forces -------------------------------------------------------------------------------

    def contact_force(self, first: str, second: str) -> float:
        one, other = self._held[first], self._held[second]
        if one.body_type == one.STATIC:
            one, other = other, one
        impulses: list[float] = []

        def add(arbiter: Any) -> None:
            if other in arbiter.bodies:
                impulses.append(abs(arbiter.total_impulse.dot(arbiter.normal)))

        one.each_arbiter(add)
        return sum(impulses) / self.step_now_s

    def contact_impulse(self, body: str) -> tuple[float, float]:
        # Chipmunk gives the impulse on the body whose contacts are asked for
        impulses: list[tuple[float, float]] = []
        self._held[body].each_arbiter(lambda arbiter: impulses.append(tuple(arbiter.total_impulse)))
        return sum(x for x, _ in impulses), sum(z for _, z in impulses)

    # --- what it holds ------------------------------------------------------------------------

    def held_of_world(self) -> Table:
        x, z = self._space.gravity
        return {
            "step_s": unreadable("Space.step(dt)", "an argument of each step"),
            "gravity_m_s2": Held("Space.gravity", (x, None, z)),
        }

    def held_of_body(self, body: str) -> Table:
        held, put = self._held[body], self.scene.moments(body)
        note, shapes = self.scene.armature_note(body), self.scene.shapes[body]
        return {
            "mass_kg": Held("Body.mass", held.mass),
            "inertia_kg_m2": Held("Body.moment", (None, held.moment, None), put, note),
            "position_m": Held("Body.position", (held.position[0], None, held.position[1])),
            "size_m": [*map(_sizes, shapes, self.built.shapes[body])],
        }

    def held_of_joint(self, joint: str) -> Table:
        first, *others = self.built.constraints[joint]
        is_hinge = self.scene.joints[joint].joint.type == "hinge"
        anchor = unreadable("constraints", "they are placed where they are solved exactly")
        if is_hinge:
            anchor = Held("PivotJoint.anchor_a", (first.anchor_a[0], None, first.anchor_a[1]))
        linkage = self.linkages[joint]
        axis: Held = unreadable("PivotJoint", "a hinge turns about y")
        if isinstance(linkage, PlanarSlider):
            x, z = (first.groove_b - first.groove_a).normalized()
            is_parent = first.a is self._held[linkage.parent]
            x, z = turned_by((x, z), -linkage.turned if is_parent else 0.0)
            axis = Held("GrooveJoint", (x, None, z), note="in the child's frame")
        parameter, note = "Body.torque" if is_hinge else "Body.force", "given anew in each step"
        brake = f"{type(others[0]).__name__}.max_force" if others else ""
        return {
            "anchor_m": anchor,
            "axis": axis,
            **{part: unreadable(parameter, note) for part in ("stiffness", "damping", "rest")},
            "friction": Held(brake, others[0].max_force if others else None),
            "armature": unreadable("Body.moment", "added to the child's, where it is read back"),
        }

    def held_of_pair(self, first: str, second: str) -> Table:
        note, shapes, built = "pymunk multiplies the two", self.built.shapes, self.built
        return {
            "restitution": [
                Held(f"elasticity of {n}", shapes[n][0].elasticity, built.restitution.get(n), note)
                for n in (first, second)
            ],
            "friction": [
                Held(f"friction of {n}", shapes[n][0].friction, built.friction.get(n), note)
                for n in (first, second)
            ],
        }

    def own_parameters(self, audit: Audit) -> None:
        space, is_tuned = self._space, self.scene.gives(TUNED)
        note = "" if is_tuned else "engine's default: overlap that is left alone"
        typed = dict(self.scene.settings.own)
        slop = (typed.get("collision_slop", SLOP_M) if is_tuned else None, space.collision_slop)
        audit.add("contact", None, "Space.collision_slop", slop, "m", note)
        if "collision_bias" in typed:
            left = (typed["collision_bias"], space.collision_bias)
            audit.add("contact", None, "Space.collision_bias", left, "1")
        audit.add("damping", None, "Space.damping", (1.0, space.damping), "1", "1 means none")
        if self.linkages or self.scene.variant:
            sweeps = (self.built.sweeps, space.iterations)
            audit.add(
                "joints", None, "Space.iterations", sweeps, "1", "sweeps over all constraints"
            )
        for name, shapes in self.built.shapes.items() if is_tuned else ():
            for shape, solid in zip(self.scene.shapes[name], shapes, strict=True):
                if shape.type == "plane":
                    radius, note = (BAR_RADIUS_M, solid.radius), "a bar, see mapping"
                    audit.add(f"{name} plane", None, "Segment.radius", radius, "m", note)
        for name, held in self.built.constraints.items():
            colliding = (0.0, float(sum(c.collide_bodies for c in held)))
            audit.add(name, None, "Constraint.collide_bodies", colliding, "1")
            bias = (0.0 if is_tuned else None, max(c.error_bias for c in held))
            note = "share of an error that is left after a second"
            audit.add(name, None, "Constraint.error_bias", bias, "1", note)
            if hasattr(held[-1], "phase"):
                phase = (self.linkages[name].turned, held[-1].phase)
                audit.add(f"{name}.turn", None, "GearJoint.phase", phase, "rad")


def _sizes(shape: Shape, solid: Any) -> Held:
    if shape.type == "plane":
        return Held("Segment.radius", None)
    if shape.type == "sphere":
        return Held("Circle.radius", solid.radius)
    corners = np.array(solid.get_vertices())
    along, up = (float(np.linalg.norm(corners[i + 1] - corners[i])) for i in (0, 1))
    # the order of the corners may begin with either edge; the third edge is not there
    edges = [along, up] if math.isclose(along, sizes_m(shape)["size_m.x"]) else [up, along]
    return Held("Poly.vertices", (edges[0], None, edges[1]))
