"""pymunk (Chipmunk), two-dimensional: the scenario's x-z plane is its x-y plane."""

from __future__ import annotations

import math
from types import ModuleType
from typing import Any

import numpy as np

from simcompare.audit import Audit
from simcompare.backend import MAPPED, EngineBackend, Feature, KnownLimit, Settings
from simcompare.landing import ContactSteps
from simcompare.pairs import per_body_product, refuse_offsets, touching_pairs
from simcompare.scenario import Body, Scenario
from simcompare.shapes import Shape, Vector
from simcompare.free_motion import has_drag
from simcompare.simulation import Simulation
from simcompare.state import BodyState
from simcompare.trajectory import Array

#: longest step during an impact [s]
CONTACT_STEP_S = 4.0e-6
#: a plane is a bar this long to either side and this thick [m]
BAR_HALF_LENGTH_M, BAR_RADIUS_M = 1000.0, 0.5
#: overlap that mapped mode allows [m]; the default of 0.1 is meant for pixels
SLOP_M = 1e-9


class PymunkSimulation(Simulation):
    """A space with its bodies."""

    def __init__(
        self,
        space: Any,
        bodies: dict[str, Any],
        scenario: Scenario,
        audit: Audit,
        mapped: bool,
    ) -> None:
        # Chipmunk advances positions before velocities, hence the stagger of +1/2
        steps = ContactSteps(
            stagger=0.5,
            contact_step_s=CONTACT_STEP_S,
            # a longer step at rest would multiply the remembered impulse and throw the body up
            rest_step_s=CONTACT_STEP_S,
        )
        super().__init__(scenario, audit.finish(), steps if mapped else None)
        self._space, self._held = space, bodies
        self._moving = [bodies[name] for name in self._bodies]
        self._dragged = any(has_drag(body) for body in self._bodies.values())
        self._step_s = scenario.world.step_s

    def advance(self, count: int) -> None:
        step, step_s = self._space.step, self._step_s
        for _ in range(count):
            if self._dragged:
                for name, (fx, _, fz) in self.drag_forces():
                    body = self._held[name]
                    body.apply_force_at_world_point((fx, fz), body.position)
            step(step_s)

    def set_engine_step(self, step_s: float) -> None:
        self._step_s = step_s

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
        held.angle = _angle(state.orientation_wxyz)
        held.angular_velocity = -state.rate_rad_s[1]

    def row(self) -> tuple[float, ...]:
        values: tuple[float, ...] = ()
        for body in self._moving:
            values += (*body.position, *body.velocity, body.angle, body.angular_velocity)
        return values

    def record(self, count: int) -> Any:
        if self._dragged or len(self._moving) != 1:
            return super().record(count)
        step, step_s, body = self._space.step, self._step_s, self._moving[0]
        rows = []
        for _ in range(count):
            step(step_s)
            rows.append((*body.position, *body.velocity, body.angle, body.angular_velocity))
        return rows

    def motions(self, rows: Array) -> dict[str, Array]:
        found: dict[str, Array] = {}
        zero = np.zeros(len(rows))
        for i, name in enumerate(self._bodies):
            x, z, vx, vz, angle, rate = rows[:, 6 * i : 6 * i + 6].T
            # turning from x to z is negative about y, which points away from the viewer
            half = -angle / 2
            found[f"{name}.position_m"] = np.column_stack((x, zero, z))
            found[f"{name}.orientation_wxyz"] = np.column_stack(
                (np.cos(half), zero, np.sin(half), zero)
            )
            found[f"{name}.velocity_m_s"] = np.column_stack((vx, zero, vz))
            found[f"{name}.rate_rad_s"] = np.column_stack((zero, -rate, zero))
        return found


class PymunkBackend(EngineBackend):
    """Chipmunk through the package ``pymunk``; planar scenarios only."""

    name = "pymunk"
    module = "pymunk"
    distribution = "pymunk"
    install = "pip install 'simcompare[pymunk]'"
    features = frozenset(
        {
            Feature.FREE_BODY, Feature.PLANE, Feature.SPHERE, Feature.BOX,
            Feature.RESTITUTION, Feature.FRICTION, Feature.DRAG,
        }
    )  # fmt: skip
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
            "There is no half space: a plane is a bar 2 km long and 1 m thick.",
            "pymunk documentation, Segment",
        ),
    )
    mapping = (
        "elasticity of the moving body = e, of the fixed one = 1 (pymunk multiplies);"
        " collision_slop = 1e-9 m; impacts in steps of at most 4 µs"
    )

    def build(self, engine: ModuleType, scenario: Scenario, settings: Settings) -> Simulation:
        refuse_offsets(scenario, self.name)
        mapped = settings.contact == MAPPED
        space = engine.Space()
        gx, _, gz = scenario.world.gravity_m_s2
        space.gravity = (gx, gz)
        if mapped:
            space.collision_slop = SLOP_M
        restitution = per_body_product(scenario, "restitution", self.name) if mapped else {}
        friction = per_body_product(scenario, "friction", self.name) if mapped else {}
        bodies, shapes = {}, {}
        for name, body in scenario.bodies.items():
            bodies[name], shapes[name] = _add_body(engine, space, body)
            for shape in shapes[name] if mapped else ():
                shape.elasticity, shape.friction = restitution[name], friction[name]
        audit = Audit(self.name)
        _audit_world(audit, space, scenario, mapped)
        for name, body in scenario.moving_bodies().items():
            _audit_body(audit, name, body, (bodies[name], shapes[name]))
        _audit_contacts(audit, scenario, shapes, (restitution, friction))
        return PymunkSimulation(space, bodies, scenario, audit, mapped)


BACKEND = PymunkBackend()


def _add_body(engine: ModuleType, space: Any, body: Body) -> tuple[Any, list[Any]]:
    if body.fixed:
        held = engine.Body(body_type=engine.Body.STATIC)
    else:
        assert body.inertia_kg_m2 is not None
        held = engine.Body(body.mass_kg, body.inertia_kg_m2[1])
    held.position = (body.position_m[0], body.position_m[2])
    held.angle = _angle(body.orientation_wxyz)
    if not body.fixed:
        held.velocity = (body.velocity_m_s[0], body.velocity_m_s[2])
        held.angular_velocity = -body.rate_rad_s[1]
    shapes = [_shape(engine, held, shape) for shape in body.shapes]
    space.add(held, *shapes)
    return held, shapes


def _shape(engine: ModuleType, held: Any, shape: Shape) -> Any:
    x, z = shape.position_m[0], shape.position_m[2]
    match shape.type:
        case "plane":
            nx, nz = shape.normal[0], shape.normal[2]
            length = math.hypot(nx, nz)
            nx, nz = nx / length, nz / length
            cx, cz = x - nx * BAR_RADIUS_M, z - nz * BAR_RADIUS_M
            ends = [
                (cx + side * BAR_HALF_LENGTH_M * nz, cz - side * BAR_HALF_LENGTH_M * nx)
                for side in (-1, 1)
            ]
            return engine.Segment(held, *ends, BAR_RADIUS_M)
        case "sphere":
            return engine.Circle(held, shape.radius_m, (x, z))
        case _:
            assert shape.type == "box"
            a, b = shape.size_m[0] / 2, shape.size_m[2] / 2
            turned = engine.Transform.identity().translated(x, z)
            turned = turned.rotated(_angle(shape.orientation_wxyz))
            return engine.Poly(held, [(-a, -b), (a, -b), (a, b), (-a, b)], turned)


def _audit_world(audit: Audit, space: Any, scenario: Scenario, mapped: bool) -> None:
    gx, _, gz = scenario.world.gravity_m_s2
    audit.add("gravity_m_s2.x", gx, "Space.gravity.x", (gx, space.gravity[0]), "m/s²")
    audit.add("gravity_m_s2.z", gz, "Space.gravity.y", (gz, space.gravity[1]), "m/s²")
    step_s = scenario.world.step_s
    audit.add("step_s", step_s, "Space.step(dt)", (step_s, None), "s", "an argument of each step")
    slop = (SLOP_M if mapped else None, space.collision_slop)
    note = "" if mapped else "engine's default: overlap that is left alone"
    audit.add("contact", None, "Space.collision_slop", slop, "m", note)
    audit.add("damping", None, "Space.damping", (1.0, space.damping), "1", "1 means none")


def _audit_body(audit: Audit, name: str, body: Body, held: tuple[Any, list[Any]]) -> None:
    moving, shapes = held
    audit.add(f"{name}.mass_kg", body.mass_kg, "Body.mass", (body.mass_kg, moving.mass), "kg")
    assert body.inertia_kg_m2 is not None
    moment = body.inertia_kg_m2[1]
    quantity = f"{name}.inertia_kg_m2.2"
    audit.add(quantity, moment, "Body.moment", (moment, moving.moment), "kg·m²")
    x, z = body.position_m[0], body.position_m[2]
    audit.add(f"{name}.position_m.x", x, "Body.position.x", (x, moving.position[0]), "m")
    audit.add(f"{name}.position_m.z", z, "Body.position.y", (z, moving.position[1]), "m")
    for shape, solid in zip(body.shapes, shapes, strict=True):
        if shape.type == "sphere":
            audit.add_sizes(name, shape, "Circle.radius", [solid.radius])
        elif shape.type == "box":
            corners = np.array(solid.get_vertices())
            along, up = (float(np.linalg.norm(corners[i + 1] - corners[i])) for i in (0, 1))
            # the order of the corners may begin with either edge; the third edge is not there
            edges = [along, up] if math.isclose(along, shape.size_m[0]) else [up, along]
            audit.add_sizes(name, shape, "Poly.vertices", [edges[0], shape.size_m[1], edges[1]])


def _audit_contacts(
    audit: Audit,
    scenario: Scenario,
    shapes: dict[str, list[Any]],
    per_body: tuple[dict[str, float], dict[str, float]],
) -> None:
    restitution, friction = per_body
    note = "pymunk multiplies the two" if restitution else "engine's default"
    for contact in touching_pairs(scenario):
        pair = "-".join(contact.pair)
        for name in contact.pair:
            held = shapes[name][0]
            values = (restitution.get(name), held.elasticity)
            parameter = f"elasticity of {name}"
            audit.add(f"{pair} restitution", contact.restitution, parameter, values, "1", note)
            values = (friction.get(name), held.friction)
            parameter = f"friction of {name}"
            audit.add(f"{pair} friction", contact.friction, parameter, values, "1", note)


def _angle(orientation_wxyz: Any) -> float:
    """Angle in pymunk's plane of a turn about y; from x towards z is positive there."""
    return -2 * math.atan2(orientation_wxyz[2], orientation_wxyz[0])
