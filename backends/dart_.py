"""DART through dartpy: trees of bodies in reduced coordinates, stepped from Python."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import numpy as np

from simcompare.audit import Audit
from simcompare.backend import JOINTS_AND_FORCES, SPATIAL_RIGID_BODIES, EngineBackend, KnownLimit
from simcompare.backends._dart_scene import Scene, audit_scene, build_scene
from simcompare.backends._recoil import Motion, RecoilingSimulation
from simcompare.helps import CENTRED_EFFORTS, HALF_STEP_START, LANDING, RECOIL
from simcompare.landing import ContactSteps
from simcompare.rotations import quaternions_of, rotation_vector_of
from simcompare.scenario import MOVABLE, Scenario
from simcompare.scripts.contract import EngineScript
from simcompare.settings import COEFFICIENT, Settings
from simcompare.shapes import Vector
from simcompare.simulation import Simulation
from simcompare.state import BodyState
from simcompare.trajectory import Array

#: longest step during an impact [s]
CONTACT_STEP_S = 2.0e-6
#: engine steps whose efforts are computed at once where they follow from the inputs alone
_BLOCK = 4096


class DartSimulation(RecoilingSimulation):
    """A world and the skeletons in it that move."""

    def __init__(self, scene: Scene, scenario: Scenario, audit: Audit, settings: Settings) -> None:
        steps = ContactSteps(stagger=-0.5, contact_step_s=CONTACT_STEP_S)
        super().__init__(scenario, audit.finish(), settings, steps)
        self._world, self._scene = scene.world, scene
        trees = [tree for tree in scene.trees if tree.getNumDofs()]
        ends = np.cumsum([0, *(tree.getNumDofs() for tree in trees)]).tolist()
        self._width = ends[-1]
        # a row holds all positions, then all velocities
        self._readers = []
        for tree, first, end in zip(trees, ends, ends[1:], strict=False):
            rates = slice(first + self._width, end + self._width)
            self._readers += [(slice(first, end), tree.getPositions), (rates, tree.getVelocities)]
        self._roots = {name: scene.nodes[name].getParentJoint() for name in self._free}
        self._slots = {}
        movable = {name: scene.joints[name] for name in self._joints}
        for name, joint in {**self._roots, **movable}.items():
            first = ends[trees.index(joint.getSkeleton())]
            self._slots[name] = first + joint.getIndexInSkeleton(0)
        self._prepare_sensors()
        self._prepare_drive()

    def _prepare_drive(self) -> None:
        """Finds out whether efforts depend on the motion, and which armatures recoil."""
        laws = self._drive.laws if self._drive else {}
        # else DART's own springs and dampers act
        ours = self.settings.takes(CENTRED_EFFORTS)
        self._follows = ours and any(law.stiffness or law.damping for law in laws.values())
        self._prepare_recoil()
        nodes, dofs = self._scene.nodes, self._scene.dofs
        self._rotors = [
            (
                dofs[rotor.joint].getVelocity, nodes[rotor.child].getSpatialVelocity,
                nodes[rotor.parent].addExtTorque, nodes[rotor.child].addExtTorque,
                np.array(rotor.parent_axis),
            )
            for rotor in (self._recoil.rotors if self._recoil else ())
        ]  # fmt: skip

    def _prepare_sensors(self) -> None:
        """Finds for every force sensor what reads its wrench, or its place among the pairs."""
        sensors = self._force_sensors.values()
        self._pairs = list(dict.fromkeys(frozenset(s.pair) for s in sensors if s.pair))
        self._known: dict[tuple[Any, Any], int] = {}
        self._watched: list[tuple[Callable[[], Array] | None, int]] = []
        for sensor in sensors:
            if sensor.joint is not None:
                child = self.scenario.joints[sensor.joint].child
                self._watched.append((self._scene.nodes[child].getBodyForce, 0))
            else:
                self._watched.append((None, self._pairs.index(frozenset(sensor.pair or ()))))

    def advance(self, count: int) -> None:
        step, drive = self._world.step, self._driver(count)
        for _ in range(count):
            if self._dragged:
                for name, force in self.drag_forces():
                    self._scene.nodes[name].addExtForce(force)
            if drive:
                drive()
            step()

    def _driver(self, count: int) -> Callable[[], None] | None:
        """What sets the efforts of the next ``count`` engine steps, one step a call."""
        drive = None if self._drive is None else self._effort_driver(count)
        if self._recoil is None:
            return drive
        if drive is None:
            return self._push_back
        push_back = self._push_back

        def both() -> None:
            push_back()
            drive()

        return both

    def _effort_driver(self, count: int) -> Callable[[], None]:
        assert self._drive is not None
        dofs = [self._scene.dofs[name] for name in self._drive.names]
        setters = [dof.setForce for dof in dofs]
        if self._follows:
            return self._follower(setters, dofs)
        rows = self._open_loop(count)

        def drive() -> None:
            for put, effort in zip(setters, next(rows), strict=True):
                put(effort)

        return drive

    def _follower(
        self, setters: list[Callable[[float], None]], dofs: list[Any]
    ) -> Callable[[], None]:
        """Sets efforts that depend on the motion."""
        assert self._drive is not None
        efforts = self._drive.efforts
        positions = [dof.getPosition for dof in dofs]
        rates = [dof.getVelocity for dof in dofs]

        def follow() -> None:
            given = efforts([get() for get in positions], [get() for get in rates])
            for put, effort in zip(setters, given, strict=True):
                put(effort)

        return follow

    def rotor_motions(self) -> list[Motion]:
        return [(rate(), spin().tolist()[:3]) for rate, spin, *_ in self._rotors]

    def _push_back(self) -> None:
        """Gives both bodies of armatures what is missing on them in the next step."""
        assert self._recoil is not None
        torques = self._recoil.torques(self.rotor_motions())
        for (_, _, push, turn, axis), (back, *given) in zip(self._rotors, torques, strict=True):
            push(back * axis, True)
            turn(np.array(given), True)

    def _open_loop(self, count: int) -> Iterator[list[float]]:
        assert self._drive is not None
        for first in range(0, count, _BLOCK):
            yield from self._drive.rows(min(_BLOCK, count - first)).tolist()

    def set_engine_step(self, step_s: float) -> None:
        self._world.setTimeStep(step_s)

    def stored_motion(self, body: str) -> tuple[Vector, Vector]:
        root = self._roots[body]
        _, _, _, x, y, z = root.getPositions().tolist()
        _, _, _, vx, vy, vz = root.getVelocities().tolist()
        return (x, y, z), (vx, vy, vz)

    def origin_of(self, body: str) -> Vector:
        x, y, z = self._scene.nodes[body].getWorldTransform().translation().tolist()
        return x, y, z

    def add_velocity(self, body: str, change_m_s: Vector) -> None:
        root = self._roots[body]
        root.setVelocities(root.getVelocities() + np.array((0, 0, 0, *change_m_s)))

    def place(self, body: str, state: BodyState) -> None:
        root = self._roots[body]
        turn = rotation_vector_of(state.orientation_wxyz)
        root.setPositions([*turn, *state.position_m])
        root.setVelocities([*state.rate_rad_s, *state.velocity_m_s])

    def place_joint(self, joint: str, position: float, rate: float) -> None:
        dof = self._scene.dofs[joint]
        dof.setPosition(position)
        dof.setVelocity(rate)

    def row(self) -> Any:
        row = np.empty(2 * self._width)
        for place, read in self._readers:
            row[place] = read()
        return row

    def forces(self) -> list[float]:
        normal = self._normal_forces() if self._pairs else []
        found: list[float] = []
        for read, pair in self._watched:
            # torque and force by the parent on the child, in the child's frame
            found += (normal[pair],) if read is None else read().tolist()[3:]
        return found

    def _normal_forces(self) -> list[float]:
        """Normal force between each watched pair in the last step; nothing where none touched."""
        known, found = self._known, [0.0] * (len(self._pairs) + 1)
        for contact in self._world.getLastCollisionResult().getContacts():
            objects = (contact.collisionObject1, contact.collisionObject2)
            place = known.get(objects)
            if place is None:
                place = known[objects] = self._place_of(objects)
            found[place] += contact.force.dot(contact.normal)
        return found

    def _place_of(self, objects: tuple[Any, Any]) -> int:
        """Which watched pair two collision objects belong to; the place after the last: none."""
        pair = frozenset(self._scene.owners[one.getShapeFrame()] for one in objects)
        return self._pairs.index(pair) if pair in self._pairs else len(self._pairs)

    def record(self, count: int) -> Any:
        if self._dragged:
            return super().record(count)
        if self.is_plain:
            return self._record_plain(count)
        step, drive = self._world.step, self._driver(count * self.substeps)
        forces = self.forces if self._force_sensors else None
        others = range(self.substeps - 1)
        width = 2 * self._width
        rows = np.empty((count, width + self._force_columns))
        for row in rows:
            if drive:
                drive()
            step()
            if forces:
                row[width:] = forces()
            for _ in others:
                if drive:
                    drive()
                step()
            for place, read in self._readers:
                row[place] = read()
        return rows

    def _record_plain(self, count: int) -> Array:
        """The same for one free body alone, as tight as it can be."""
        step = self._world.step
        (_, positions), (_, velocities) = self._readers
        rows = np.empty((count, 12))
        for row in rows:
            step()
            row[:6] = positions()
            row[6:] = velocities()
        return rows

    def motions(self, rows: Array) -> dict[str, Array]:
        found: dict[str, Array] = {}
        for name, joint in self._joints.items():
            position, rate = MOVABLE[joint.type]
            found[f"{name}.{position}"] = rows[:, self._slots[name]].copy()
            found[f"{name}.{rate}"] = rows[:, self._width + self._slots[name]].copy()
        for name in self._free:
            slot = self._slots[name]
            q, v = (rows[:, first : first + 6] for first in (slot, self._width + slot))
            found[f"{name}.position_m"] = q[:, 3:].copy()
            found[f"{name}.orientation_wxyz"] = quaternions_of(q[:, :3])
            # a free joint's velocities are in the world's frame, turning first (measured with 6.20)
            found[f"{name}.velocity_m_s"] = v[:, 3:].copy()
            found[f"{name}.rate_rad_s"] = v[:, :3].copy()
        return found


class DartBackend(EngineBackend):
    """DART through the package ``dartpy``."""

    name = "dart"
    module = "dartpy"
    distribution = "dartpy"
    install = "pip install 'simcompare[dart]'"
    libraries = (("libGL.so.1", "sudo apt-get install libgl1"),)
    features = SPATIAL_RIGID_BODIES | JOINTS_AND_FORCES
    helps = frozenset({LANDING, HALF_STEP_START, CENTRED_EFFORTS, RECOIL})
    bounces_by = COEFFICIENT
    known_limits = (
        KnownLimit(
            "Restitution is 0 by default, on the body and on the floor; both must be set.",
            "DART DynamicsAspect::getRestitutionCoeff; measured",
        ),
        KnownLimit(
            "A bounce that would leave the floor slower than about 0.1 m/s does not happen.",
            "measured; DART ContactConstraint.cpp, DART_BOUNCING_VELOCITY_THRESHOLD",
        ),
        KnownLimit(
            "The bounce speed is taken after gravity has acted: e·(1 + g·dt/v), so small hops at"
            " a long step never die out.",
            "measured: 0.8059 at 4 ms, 0.8015 at 1 ms, 0.8004 at 0.25 ms for 0.8 and 4.4 m/s",
        ),
        KnownLimit(
            "The default collision detector (FCL) approximates cylinders; ODE's does not.",
            "measured: a wheeled robot was 14 % short with FCL, 0.1 % off with ODE",
        ),
        KnownLimit(
            "By default what has rested on something for half a second falls asleep: it is frozen,"
            " contact forces read 0, and a restored state does not know how long it has rested.",
            "DART World::updateRestStates, DeactivationOptions; measured: 0 N from 0.5 s on",
        ),
        KnownLimit(
            "The default solver (Dantzig) limits friction by the normal force as it would be"
            " without friction; the one for Coulomb's cone (NSGS) lets contacts along lines slip.",
            "measured: spinning wheels pushed 4.2 % too much with Dantzig, 0.003 % off with NSGS;"
            " a robot on cylinders left its line by 0.4 m in 1 s with NSGS, by 8 µm with Dantzig; a"
            " spinning box stopped after 2.003 instead of 2.008 rad with NSGS, 1.57 with Dantzig",
        ),
        KnownLimit(
            "Friction of 0.001 and less is none.",
            "DART ContactConstraint.cpp, DART_FRICTION_COEFF_THRESHOLD; measured with 0.0009",
        ),
        KnownLimit(
            "Bodies of one skeleton pass through one another unless it is told otherwise; it is"
            " told so where a scenario says what happens between two that no joint connects.",
            "DART Skeleton::enableSelfCollisionCheck",
        ),
        KnownLimit(
            "There is no armature: it is part of the child's moment of inertia about the joint's"
            " axis, and assisted gives both bodies the torques that are missing where the parent"
            " turns, a step late. An armature that outweighs its parent is refused.",
            "DART Joint; measured: trees of three tumbling bodies come as close as MuJoCo's, 0.3 mm"
            " in 0.3 s at 1 ms, and errors halve with the step",
        ),
        KnownLimit(
            "Impulses know nothing of a damper of DART's own, which is used by default: Coulomb"
            " friction beside it is 1 + damping·dt/inertia times too strong.",
            "measured: a motor idled at 969 instead of 973 rad/s, for 5 % more friction, at 1 ms",
        ),
    )
    mapping = (
        "restitution of the moving body = e, of the fixed one = 1 (DART multiplies); friction of a"
        " body = the largest of its pairs (DART takes the smaller of two); ODE collision detector;"
        " NSGS solver (tolerance 1e-6) where only single spheres rub, or free boxes on planes;"
        " nothing falls asleep; springs, dampers and Coulomb friction of joints are DART's own."
        " Assisted: impacts in steps of at most 2 µs, so that the bias g·dt/v is below 1e-4 down to"
        " 0.2 m/s; springs and dampers are forces on joints in every step"
    )

    def build(self, engine: ModuleType, scenario: Scenario, settings: Settings) -> Simulation:
        scene = build_scene(engine, scenario, settings)
        return DartSimulation(scene, scenario, audit_scene(scene, scenario, settings), settings)

    def script(self) -> EngineScript:
        """What writes scenes of this engine as standalone scripts."""
        from simcompare.backends._dart_script import SCRIPT

        return SCRIPT


BACKEND = DartBackend()
