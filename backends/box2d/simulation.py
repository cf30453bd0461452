"""Stepping and reading a world of Box2D."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from simcompare.backends.box2d.variants import VARIANTS
from simcompare.backends.box2d.world import (
    JOINT_HZ,
    MADE_WITH,
    SET_AFTER,
    build,
    rotation,
    typed,
)
from simcompare.kit import (
    TUNED,
    Audit,
    Held,
    PlanarMotion,
    PlanarSimulation,
    Scene,
    Table,
    Turns,
    fastest_turn_rad_s,
    unreadable,
)

#: substeps of a step: what the documentation takes, and the least where everything is given; and
#: how far a body may turn in one of them [rad], so that its angle falls short by 0.03 %
USUAL_SUBSTEPS, MIN_SUBSTEPS, MAX_TURN_RAD = 4, 8, 0.03
#: what dry friction of a joint is called
BRAKES = {
    "PrismaticJoint": "max_motor_force", "RevoluteJoint": "max_motor_torque",
    "MotorJoint": "max_torque",
}  # fmt: skip


class Box2dSimulation(PlanarSimulation):
    """A world with its bodies; those on joints move like all others, held by constraints."""

    def __init__(self, box2d: Any, scene: Scene) -> None:
        step_s, is_tuned = scene.scenario.world.engine_step_s, scene.gives(TUNED)
        turns = math.ceil(fastest_turn_rad_s(scene.scenario) * step_s / MAX_TURN_RAD)
        self.inner_steps = max(MIN_SUBSTEPS, turns) if is_tuned else USUAL_SUBSTEPS
        if scene.variant:
            self.inner_steps = VARIANTS[scene.variant].value
        # as the engine limits its own springs
        self._hertz = min(JOINT_HZ, 0.25 * self.inner_steps / step_s) if is_tuned else 0.0
        super().__init__(scene)
        self._box2d, self._turns = box2d, Turns()
        self.forget()
        self.place_all()

    def forget(self) -> None:
        # a new world: Box2D does not give its impulses away, and they would act in the next step
        self._world, self._held, self._links = build(
            self._box2d, self.scene, self.linkages, self._hertz
        )

    def release(self) -> None:
        self._world.destroy()

    def set_engine_step(self, step_s: float) -> None:
        """Nothing is left to do: each step is told how long it is."""

    def take_steps(self, count: int) -> None:
        step, step_s, substeps = self._world.step, self.step_now_s, self.inner_steps
        for _ in range(count):
            step(step_s, substeps)
        self._turns.passed(count * step_s)

    def get(self, body: str) -> PlanarMotion:
        held = self._held[body]
        # by their names: to unpack a vector takes ten times as long
        place, speed, turn, rate = (
            held.position, held.linear_velocity, held.rotation, held.angular_velocity,
        )  # fmt: skip
        angle = self._turns.angle(body, math.atan2(turn.s, turn.c), rate)
        return place.x, place.y, speed.x, speed.y, angle, rate

    def put(self, body: str, motion: PlanarMotion) -> None:
        held, (x, z, vx, vz, angle, rate) = self._held[body], motion
        held.set_transform((x, z), rotation(self._box2d, angle))
        held.linear_velocity, held.angular_velocity = (vx, vz), rate
        self._turns.put(body, angle, rate)

    def load(self, body: str, fx: float, fz: float, torque: float) -> None:
        self._held[body].apply_force_to_center((fx, fz))
        self._held[body].apply_torque(torque)

    def constraint_force(self, joint: str) -> Sequence[float]:
        return (*self._links[joint][0].get_constraint_force(),)

    # --- what it holds ------------------------------------------------------------------------

    def held_of_world(self) -> Table:
        x, z = self._world.gravity
        return {
            "step_s": unreadable("World.step(time_step)", "an argument of each step"),
            "gravity_m_s2": Held("World.gravity", (x, None, z)),
        }

    def held_of_body(self, body: str) -> Table:
        held, place = self._held[body], self._held[body].position
        return {
            "mass_kg": Held("MassData.mass", held.mass_data.mass),
            "inertia_kg_m2": Held(
                "MassData.rotational_inertia", (None, held.mass_data.rotational_inertia, None),
                self.scene.moments(body), self.scene.armature_note(body),
            ),
            "position_m": Held("Body.position", (place.x, None, place.y)),
            "size_m": [*map(_size, held.shapes[::-1])],
        }  # fmt: skip

    def held_of_joint(self, joint: str) -> Table:
        links, anchor = self._links[joint], self.linkages[joint].middle
        at, put = links[0].local_anchor_a, (anchor[0], 0.0, anchor[1])
        limit = BRAKES.get(type(links[-1]).__name__, "")
        return {
            "anchor_m": Held("Joint.local_anchor_a", (at.x, None, at.y), put),
            "axis": unreadable("PrismaticJointDef.local_axis_a", "a hinge turns about y"),
            "friction": Held(f"Joint.{limit}", getattr(links[-1], limit, None)),
        }

    def held_of_pair(self, first: str, second: str) -> Table:
        put = self.scene.contacts.surfaces("max", "root", self.scene.engine)
        return {
            kind: [
                Held(
                    f"{kind} of {name}", getattr(self._held[name].shapes[0], kind),
                    put[name].get(kind), f"Box2D takes {rule}",
                )
                for name in (first, second)
            ]
            for kind, rule in (("restitution", "the larger"), ("friction", "the product's root"))
        }  # fmt: skip

    def own_parameters(self, audit: Audit) -> None:
        gives, steps = self.scene.gives(TUNED), {"step(sub_step_count)": self.inner_steps}
        made = typed(self.scene, MADE_WITH) if gives else {}
        for name, put in {**steps, **made, **typed(self.scene, SET_AFTER)}.items():
            values = put if gives or name in steps else None, getattr(self._world, name, None)
            # a scenario's bodies never sleep
            of, wanted = ("sleep", 0.0) if name == "sleeping_enabled" else ("world", None)
            audit.add(of, wanted, f"World.{name}", values, "SI")
        welds = {n: one[0] for n, one in self._links.items() if hasattr(one[0], "linear_hertz")}
        for name, weld in welds.items():
            audit.add(name, None, "WeldJoint.linear_hertz", (self._hertz, weld.linear_hertz), "Hz")


def _size(solid: Any) -> Held:
    if hasattr(solid, "circle"):
        return Held("Circle.radius", solid.circle.radius)
    first, second, third, *_ = solid.polygon.vertices
    return Held("Polygon.vertices", (math.dist(first, second), None, math.dist(second, third)))
