"""A scene as an ODE world, stepped from Python."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from typing import Any

from simcompare.backends.ode.variants import STEP, VARIANTS
from simcompare.kit import (
    TUNED,
    Array,
    Audit,
    BodyState,
    Held,
    Pair,
    Scene,
    SceneJoint,
    Shape,
    SpatialSimulation,
    Table,
    Vector,
    dot,
    minus,
    sizes_m,
    times,
)

#: part of a joint's gap, and of the depth of a contact, that a step closes
JOINT_ERP, CONTACT_ERP = 0.8, 0.2
#: how far joints give way in a step, as part of how far the heaviest body would go without them,
#: and contacts, for the lighter of two bodies: boxes touch at more points than can be told apart;
#: what is landed on is touched by a sphere, in steps that are a thousand times shorter
JOINT_SOFTNESS, CONTACT_SOFTNESS, LANDED_SOFTNESS = 1e-7, 1e-5, 1e-9
#: friction of what slips faster acts along its way [m/s]
SLIP_M_S = 1e-6
#: ODE's own numbers by the names of their setters, and their units
UNITS = {"ERP": "1", "CFM": "s/kg", "ContactMaxCorrectingVel": "m/s"}
#: what a run tells where ODE had messages
MESSAGES = "in some steps ODE's solver did not find all forces (LCP internal error)"


class OdeSimulation(SpatialSimulation):
    """A world; before each step, all that may touch is asked where it does.

    Args:
        engine: what makes C's values, ODE's functions, its messages so far, and who listens.
        scene: what is to be built.
    """

    def __init__(self, engine: Any, scene: Scene) -> None:
        super().__init__(scene)
        self._ffi, self._lib, self._heard, _ = ffi, lib, *_ = engine
        self._unpack, self._is_tuned = ffi.unpack, scene.gives(TUNED)
        self._stepper = VARIANTS[scene.variant].value if scene.variant else STEP
        self._world = ffi.gc(lib.dWorldCreate(), lib.dWorldDestroy)
        self._space = ffi.gc(lib.dSimpleSpaceCreate(ffi.NULL), lib.dSpaceDestroy)
        self._group = ffi.gc(lib.dJointGroupCreate(0), lib.dJointGroupDestroy)
        lib.dWorldSetGravity(self._world, *self.scenario.world.gravity_m_s2)
        self.set_engine_step(self.step_s)  # some numbers go into joints when they are made
        self._held = {
            name: ffi.NULL if body.fixed else lib.dBodyCreate(self._world)
            for name, body in self.scenario.bodies.items()
        }
        # where ODE keeps the motion of each body, which stays the same
        self._memory = {name: self._body(name) for name in self._bodies}
        self.place_all()  # joints bind bodies as they are
        self._geoms = {
            name: [self._geom(held, shape) for shape in scene.placed_shapes(name)]
            for name, held in self._held.items()
        }
        self._felt = {name: ffi.new("dJointFeedback *") for name in scene.joints}
        self._made = {name: self._joint(joint) for name, joint in scene.joints.items()}
        self._touches = [
            ({one, other}, self._touch((one, other), geoms, pair))
            for one, other, pair in scene.contacts.may_touch()
            for geoms in product(self._geoms[one], self._geoms[other])
        ]

    # --- building -----------------------------------------------------------------------------

    def _body(self, name: str) -> list[tuple[Any, int]]:
        """Furnishes a body; returns places and sizes of what it keeps of its motion."""
        lib, held = self._lib, self._held[name]
        inertia = [value for line in self.scene.inertia(name).tolist() for value in (*line, 0.0)]
        mass = {"mass": self._bodies[name].mass_kg, "I": inertia}
        lib.dBodySetMass(held, self._ffi.new("dMass *", mass))
        lib.dBodySetFiniteRotationMode(held, self._is_tuned)
        return [(lib.dBodyGetPosition(held), 3), (lib.dBodyGetQuaternion(held), 4),
                (lib.dBodyGetLinearVel(held), 3), (lib.dBodyGetAngularVel(held), 3)]  # fmt: skip

    def _geom(self, held: Any, shape: Shape) -> Any:
        """A geom on its body, or, of a fixed body, where it stays."""
        lib, space, kind = self._lib, self._space, "Offset" if held else ""
        if shape.type == "plane":
            return lib.dCreatePlane(space, *shape.normal, dot(shape.normal, shape.position_m))
        geom = getattr(lib, f"dCreate{shape.type.title()}")(space, *sizes_m(shape).values())
        lib.dGeomSetBody(geom, held)
        getattr(lib, f"dGeomSet{kind}Position")(geom, *shape.position_m)
        getattr(lib, f"dGeomSet{kind}Quaternion")(geom, shape.orientation_wxyz)
        return geom

    def _joint(self, joint: SceneJoint) -> Any:
        """A joint of bodies as they are drawn; the child comes first, so that its motion counts."""
        lib, kind, stated = self._lib, joint.joint.type.title(), joint.joint
        held = getattr(lib, f"dJointCreate{kind}")(self._world, self._ffi.NULL)
        lib.dJointAttach(held, self._held[stated.child], self._held[stated.parent])
        lib.dJointSetFeedback(held, self._felt[joint.name])
        anchor, axis = self.scene.drawn(joint.name)
        # friction is a motor that holds still, as strongly as it can
        motor = (lib.dParamFMax, joint.own.friction)
        for part, values in {"Anchor": anchor, "Axis": axis, "Param": motor, "": ()}.items():
            setter = getattr(lib, f"dJointSet{kind}{part}", None)
            if setter is not None:  # each kind has those that it needs
                setter(held, *values)
        return held

    def _touch(self, names: tuple[str, str], geoms: tuple[Any, Any], pair: Pair | None) -> Any:
        ends, surface = [self._held[name] for name in names], self._surface(names, pair)
        return self._ffi.new("Touch *", [*geoms, *ends, 0, [[surface]] * 16])

    def _surface(self, names: tuple[str, str], pair: Pair | None) -> dict[str, float]:
        """What each point of contact of two bodies is given."""
        if pair is None or not self.scene.contacts.are_given:
            return {"mu": math.inf}  # it must be set
        lib = self._lib
        lightest = min(self._bodies[name].mass_kg or 0.0 for name in names if name in self._bodies)
        softness = LANDED_SOFTNESS if self.scene.lands else CONTACT_SOFTNESS
        soft = softness * self.step_s / lightest
        mode = lib.dContactBounce | lib.dContactApprox1 | self._is_tuned * lib.dContactSoft
        return {
            "mode": mode, "mu": pair.friction, "bounce": pair.numbers[0],
            "soft_erp": CONTACT_ERP, "soft_cfm": soft, "slip1": soft, "slip2": soft,
            "bounce_vel": self.scene.settings.typed("bounce_vel", 0.0),
        }  # fmt: skip

    def _own_numbers(self) -> dict[str, float]:
        """ODE's own numbers at this step, by the names of their setters; none by default."""
        heaviest = max((body.mass_kg or 0.0 for body in self._bodies.values()), default=1.0)
        # what falls back within a step has not left
        slow = math.hypot(*self.scenario.world.gravity_m_s2) * self.step_s or math.inf
        numbers = (JOINT_ERP, JOINT_SOFTNESS * self._step_s / heaviest, slow)
        return dict(zip(UNITS, numbers, strict=True)) if self._is_tuned else {}

    # --- stepping -----------------------------------------------------------------------------

    def take_steps(self, count: int) -> None:
        lib, skip, heard = self._lib, self._ffi.sizeof("dContact"), len(self._heard)
        step = getattr(lib, self._stepper)
        for _ in range(count):
            for _, touch in self._touches:
                place = self._ffi.addressof(touch.points[0], "geom")
                touch.count = lib.dCollide(touch.first, touch.second, 16, place, skip)
                for i in range(touch.count):
                    self._bind(touch, i)
            if self.scene.variant:
                lib.dRandSetSeed(0)  # what quick steps draw is no part of a state
            step(self._world, self._step_s)
            lib.dJointGroupEmpty(self._group)
        if len(self._heard) > heard and MESSAGES not in self.notes:
            self.notes += (MESSAGES,)

    def _bind(self, touch: Any, i: int) -> None:
        """Makes a contact of a point at which two geoms touch."""
        lib, points = self._lib, touch.points
        if self._is_tuned and points[i].surface.mu:
            self._turn_axes(touch, points[i])
        contact = lib.dJointCreateContact(self._world, self._group, points + i)
        lib.dJointAttach(contact, touch.on, touch.against)
        lib.dJointSetFeedback(contact, touch.felt + i)

    def _turn_axes(self, touch: Any, point: Any) -> None:
        """Has friction act along the way of what slips: ODE limits it along each of two axes."""
        lib, normal, surface = self._lib, self._unpack(point.geom.normal, 3), point.surface
        place, slip = self._unpack(point.geom.pos, 3), (0.0, 0.0, 0.0)
        for body in filter(None, (touch.against, touch.on)):
            slip = minus(self._read(lib.dBodyGetPointVel, body, *place), slip)
        slip = minus(slip, times(dot(normal, slip), normal))
        speed, surface.mode = math.hypot(*slip), surface.mode & ~lib.dContactFDir1
        if speed > SLIP_M_S:
            surface.mode |= lib.dContactFDir1
            point.fdir1 = [part / speed for part in slip]

    def set_engine_step(self, step_s: float) -> None:
        self._step_s = step_s
        for name, value in self._own_numbers().items():
            getattr(self._lib, f"dWorldSet{name}")(self._world, value)

    def get(self, body: str) -> BodyState:
        return BodyState(*[tuple(self._unpack(*part)) for part in self._memory[body]])

    def put(self, body: str, state: BodyState) -> None:
        """Writes into ODE's memory: its own setter would norm an orientation anew."""
        values = (state.position_m, state.orientation_wxyz, state.velocity_m_s, state.rate_rad_s)
        for (place, size), value in zip(self._memory[body], values, strict=True):
            place[0:size] = value
        lib, held = self._lib, self._held[body]
        lib.dRfromQ(lib.dBodyGetRotation(held), state.orientation_wxyz)
        lib.dBodySetPosition(held, *state.position_m)  # tells its geoms that it moves

    def release(self) -> None:
        for owner in (self._group, self._space, self._world):
            self._ffi.release(owner)

    # --- forces -------------------------------------------------------------------------------

    def push(self, body: str, force: Vector) -> None:
        self._lib.dBodyAddForce(self._held[body], *force)

    def turn(self, body: str, torque: Vector) -> None:
        self._lib.dBodyAddTorque(self._held[body], *torque)

    def exert(self, joint: str, effort: float) -> None:
        is_hinge = self._joints[joint].type == "hinge"
        kind = "HingeTorque" if is_hinge else "SliderForce"
        getattr(self._lib, f"dJointAdd{kind}")(self._made[joint], effort)

    def reaction(self, joint: str) -> Any:
        return self._unpack(self._felt[joint].f1, 3)

    def contact_force(self, first: str, second: str) -> float:
        return sum(
            dot(self._unpack(touch.felt[i].f1, 3), self._unpack(touch.points[i].geom.normal, 3))
            for pair, touch in self._touches
            if pair == {first, second}
            for i in range(touch.count)
        )

    # --- rays ---------------------------------------------------------------------------------

    def cast_rays(
        self, origin_m: Vector, directions: Array, without_body: str, reach_m: float
    ) -> Sequence[float]:
        lib, point = self._lib, self._ffi.new("dContactGeom *")
        ray = self._ffi.gc(lib.dCreateRay(self._ffi.NULL, reach_m), lib.dGeomDestroy)
        skip, collide = self._ffi.sizeof("dContactGeom"), lib.dCollide
        geoms = [one for name, own in self._geoms.items() if name != without_body for one in own]
        found = []
        for direction in directions.tolist():
            lib.dGeomRaySet(ray, *origin_m, *direction)
            depths = [point.depth for geom in geoms if collide(ray, geom, 1, point, skip)]
            found.append(min(depths, default=math.inf))
        return found

    # --- what it holds ------------------------------------------------------------------------

    def _read(self, getter: Any, *arguments: Any) -> list[float]:
        """The vector that a function writes into its last argument."""
        vector = self._ffi.new("dReal[4]")
        getter(*arguments, vector)
        return [*self._unpack(vector, 3)]

    def held_of_world(self) -> Table:
        return {
            "step_s": Held("stepsize", self._step_s, note=f"given to each {self._stepper}"),
            "gravity_m_s2": Held("gravity", self._read(self._lib.dWorldGetGravity, self._world)),
        }

    def held_of_body(self, body: str) -> Table:
        mass, shapes = self._ffi.new("dMass *"), self.scene.shapes[body]
        self._lib.dBodyGetMass(self._held[body], mass)
        return {
            "mass_kg": Held("mass", mass.mass),
            "inertia_kg_m2": Held("mass.I", [mass.I[i] for i in (0, 5, 10)]),
            "size_m": [self._size(*pair) for pair in zip(self._geoms[body], shapes, strict=True)],
        }

    def _size(self, geom: Any, shape: Shape) -> Held:
        lib, sizes = self._lib, self._ffi.new("dReal[2]")
        match shape.type:
            case "sphere":
                return Held("radius", lib.dGeomSphereGetRadius(geom))
            case "box":
                return Held("lengths", self._read(lib.dGeomBoxGetLengths, geom))
        getattr(lib, f"dGeom{shape.type.title()}GetParams")(geom, sizes, sizes + 1)
        return Held("params", [*sizes])

    def held_of_joint(self, joint: str) -> Table:
        lib, held, kind = self._lib, self._made[joint], self.scene.joints[joint].joint.type.title()
        getters = {"anchor_m": f"dJointGet{kind}Anchor2", "axis": f"dJointGet{kind}Axis"}
        found = {
            part: Held(name.removeprefix("dJointGet"), self._read(getattr(lib, name), held))
            for part, name in getters.items()
            if hasattr(lib, name)
        }
        if joint in self._joints:
            friction = getattr(lib, f"dJointGet{kind}Param")(held, lib.dParamFMax)
            found["friction"] = Held("dParamFMax", friction)
        return found

    def held_of_pair(self, first: str, second: str) -> Table:
        touch = next(touch for pair, touch in self._touches if pair == {first, second})
        parts, surface = {"friction": "mu", "restitution": "bounce"}, touch.points[0].surface
        return {of: Held(f"surface.{part}", getattr(surface, part)) for of, part in parts.items()}

    def own_parameters(self, audit: Audit) -> None:
        if self.scene.variant:
            audit.add_without_getter("step", {self._stepper: (1.0, None)}, is_given=True)
        put = self._own_numbers()
        for name, unit in UNITS.items():
            held = getattr(self._lib, f"dWorldGet{name}")(self._world)
            note = "" if name in put else "engine's default"
            audit.add(name, None, f"dWorldSet{name}", (put.get(name), held), unit, note)
        if not self._is_tuned or not self._touches:
            return
        first, second, pair = next(self.scene.contacts.may_touch())
        given, surface = self._surface((first, second), pair), self._touches[0][1].points[0].surface
        modes = "dContactBounce | dContactApprox1 | dContactSoft"
        softness = "s/kg", "by the step and the lighter of two masses"
        rows = {"mode": ("1", modes), "bounce_vel": ("m/s", ""), "soft_erp": ("1", ""),
                "soft_cfm": softness, "slip1": softness, "slip2": softness}  # fmt: skip
        for name, (unit, note) in rows.items():
            values = given.get(name), getattr(surface, name)
            audit.add("contact", None, f"surface.{name}", values, unit, note)
