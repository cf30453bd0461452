"""PyBullet in DIRECT mode; every run has its own client and sets all global parameters itself."""

from __future__ import annotations

import math
import sys
import weakref
from types import ModuleType
from typing import Any

import numpy as np

from simcompare.backend import JOINTS_AND_FORCES, SPATIAL_RIGID_BODIES, EngineBackend, KnownLimit
from simcompare.backends._pybullet_audit import audit_of
from simcompare.backends._pybullet_parts import BASE, Scene
from simcompare.backends._pybullet_reaction import Surplus, sensed_wrongly
from simcompare.backends._pybullet_rotors import Rotors
from simcompare.backends._pybullet_scene import build, gap_of, refresh_contacts
from simcompare.backends._pybullet_shapes import takes_other_shapes
from simcompare.backends._recoil import Motion, RecoilingSimulation
from simcompare.drives import Drive
from simcompare.errors import EngineBroken
from simcompare.helps import (
    HELPS,
    LANDING,
    REACTIONS,
    RIMS,
)
from simcompare.kinematics import mount_of
from simcompare.landing import ContactSteps, finely_stepped
from simcompare.pairs import refuse_offsets
from simcompare.scenario import MOVABLE, SENSOR_SIGNALS, Scenario
from simcompare.scripts.contract import EngineScript
from simcompare.settings import COEFFICIENT, Settings
from simcompare.shapes import Vector
from simcompare.simulation import Simulation
from simcompare.state import BodyState, State
from simcompare.trajectory import Array

#: longest step during an impact [s]; the bias g·dt/v of reduced coordinates stays below 1e-4 down
#: to 0.2 m/s
CONTACT_STEP_S = 2.0e-6
#: longest step where bounces are not landed on [s]: what a body is in too deep after an impact, up
#: to v·dt, it stays
BOUNCE_STEP_S = 1.0e-4
#: longest step at rest [s]: without error reduction a body rests up to g·dt² deep
REST_STEP_S = 2.5e-4


class PybulletSimulation(RecoilingSimulation):
    """A physics client with its bodies.

    Rows hold position, orientation, velocity and rate of each free body, then coordinate and rate
    of the joints, one articulated body after the other.
    """

    def __init__(self, scene: Scene, scenario: Scenario) -> None:
        settings = scene.settings
        steps = ContactSteps(-0.5, CONTACT_STEP_S, rest_step_s=REST_STEP_S)
        super().__init__(scenario, audit_of(scene).finish(), settings, steps)
        self._saved: dict[int, int] = {}
        self._scene = scene
        self._bullet, self._client, self._places = scene.engine, scene.client, scene.bodies
        self._moving = [scene.bodies[name][0] for name in self._free]
        self._hinged = {name: scene.joints[name] for name in self._joints}
        linked: dict[int, list[str]] = {}
        for name, (uid, _) in self._hinged.items():
            linked.setdefault(uid, []).append(name)
        self._order = [name for names in linked.values() for name in names]
        self._linked = [(u, [scene.joints[n][1] for n in names]) for u, names in linked.items()]
        driven = self._drive.names if self._drive is not None else ()
        self._driven = [self._order.index(name) for name in driven]
        self._pushed = [
            (uid, [scene.joints[driven[i]][1] for i in places], places)
            for uid in linked
            if (places := [i for i, name in enumerate(driven) if scene.joints[name][0] == uid])
        ]
        self._efforts: list[float] = []
        self._prepare_recoil()
        self._rotors = Rotors(scene, self._order, self._recoil) if self._recoil else None
        wrong = sensed_wrongly(scenario) if settings.takes(REACTIONS) else []
        self._surplus = Surplus(scenario, wrong) if wrong else None
        self.helps |= {REACTIONS} if wrong else set()
        self.helps |= {RIMS} if takes_other_shapes(scene) else set()
        self._readers = [self._reader(name, scene) for name in self._force_sensors]

    def advance(self, count: int) -> None:
        step, client, drive = self._bullet.stepSimulation, self._client, self._drive
        rotors = self._rotors
        looks = rotors is not None or (drive is not None and drive.follows)
        for _ in range(count):
            if self._dragged:
                self._apply_drag()
            states = self._joint_states() if looks else []
            if rotors is not None:
                rotors.push(states)
            if drive is not None:
                self._push(drive, states)
            step(client)

    def rotor_motions(self) -> list[Motion]:
        return [] if self._rotors is None else self._rotors.motions(self._joint_states())

    def _joint_states(self) -> list[Any]:
        """Coordinate, rate and more of all joints, in the order of the rows."""
        read, client = self._bullet.getJointStates, self._client
        if len(self._linked) == 1:
            ((uid, links),) = self._linked
            states: list[Any] = read(uid, links, client)
            return states
        return [state for uid, links in self._linked for state in read(uid, links, client)]

    def _push(self, drive: Drive, states: list[Any]) -> None:
        """Puts efforts on the driven joints; PyBullet forgets them in every step."""
        positions = [states[i][0] for i in self._driven] if drive.follows else []
        rates = [states[i][1] for i in self._driven] if drive.follows else []
        efforts = self._efforts = drive.efforts(positions, rates)
        control, mode = self._bullet.setJointMotorControlArray, self._bullet.TORQUE_CONTROL
        for uid, links, places in self._pushed:
            part = [efforts[i] for i in places]
            control(uid, links, mode, forces=part, physicsClientId=self._client)

    def _apply_drag(self) -> None:
        push, frame, client = (
            self._bullet.applyExternalForce,
            self._bullet.WORLD_FRAME,
            self._client,
        )
        for name, force in self.drag_forces():
            uid, _ = self._places[name]
            push(uid, BASE, force, self.origin_of(name), frame, physicsClientId=client)

    def set_engine_step(self, step_s: float) -> None:
        self._bullet.setTimeStep(step_s, self._client)

    def stored_motion(self, body: str) -> tuple[Vector, Vector]:
        uid, _ = self._places[body]
        velocity: Vector = self._bullet.getBaseVelocity(uid, self._client)[0]
        return self.origin_of(body), velocity

    def add_velocity(self, body: str, change_m_s: Vector) -> None:
        uid, _ = self._places[body]
        linear, angular = self._bullet.getBaseVelocity(uid, self._client)
        moved = [v + dv for v, dv in zip(linear, change_m_s, strict=True)]
        self._bullet.resetBaseVelocity(uid, moved, angular, self._client)

    def place(self, body: str, state: BodyState) -> None:
        (uid, _), client = self._places[body], self._client
        w, x, y, z = state.orientation_wxyz
        self._bullet.resetBasePositionAndOrientation(uid, state.position_m, (x, y, z, w), client)
        self._bullet.resetBaseVelocity(uid, state.velocity_m_s, state.rate_rad_s, client)

    def place_joint(self, joint: str, position: float, rate: float) -> None:
        self._bullet.resetJointState(
            *self._hinged[joint], position, rate, physicsClientId=self._client
        )

    @property
    def state(self) -> State:
        """The present state; PyBullet keeps its own copy, which also has the points of contact."""
        found = super().state
        self._saved[id(found)] = self._bullet.saveState(self._client)
        forget = weakref.finalize(
            found, _forget, self._bullet, self._client, self._saved, id(found)
        )
        forget.atexit = False
        return found

    def set_state(self, state: State) -> None:
        super().set_state(state)
        if id(state) in self._saved:
            self._bullet.restoreState(self._saved[id(state)], physicsClientId=self._client)
        else:
            refresh_contacts(self._scene)

    def _reader(self, name: str, scene: Scene) -> Any:
        """A function that reads one force sensor."""
        sensor, bullet, client = self._force_sensors[name], self._bullet, self._client
        if sensor.type == "contact_force":
            first, second = (scene.bodies[body] for body in sensor.pair or ())
            chosen = {
                "bodyA": first[0], "linkIndexA": first[1],
                "bodyB": second[0], "linkIndexB": second[1], "physicsClientId": client,
            }  # fmt: skip

            # Bullet leaves old forces on points that are too far apart to act
            corrected = scene.settings.takes(REACTIONS)
            gap = gap_of(self.scenario) if corrected else math.inf
            self.helps |= {REACTIONS} if corrected else set()

            def normal_force() -> tuple[float, ...]:
                points = bullet.getContactPoints(**chosen)
                return (float(sum(point[9] for point in points if point[8] <= gap)),)

            return normal_force
        assert sensor.joint is not None
        uid, link = scene.joints[sensor.joint]
        joint = self.scenario.joints[sensor.joint]
        # the friction of a slider acts as the force of a motor, which is no part of the reaction
        axis = mount_of(self.scenario, joint).axis if joint.type == "slider" else (0.0, 0.0, 0.0)
        ax, ay, az = axis

        def force() -> tuple[float, ...]:
            _, _, (fx, fy, fz, _, _, _), motor = bullet.getJointState(uid, link, client)
            return fx + motor * ax, fy + motor * ay, fz + motor * az

        return force

    def forces(self) -> list[float]:
        return [value for read in self._readers for value in read()]

    def origin_of(self, body: str) -> Vector:
        uid, link = self._places[body]
        position: Vector
        if link == BASE:
            position = self._bullet.getBasePositionAndOrientation(uid, self._client)[0]
        else:
            position = self._bullet.getLinkState(uid, link, 0, 1, self._client)[0]
        return position

    def row(self) -> tuple[float, ...]:
        moved = [value for state in self._joint_states() for value in state[:2]]
        return (*self._base_row(), *moved)

    def _base_row(self) -> tuple[float, ...]:
        """Position, orientation, velocity and rate of all free bodies."""
        pose, motion, client = (
            self._bullet.getBasePositionAndOrientation,
            self._bullet.getBaseVelocity,
            self._client,
        )
        values: tuple[float, ...] = ()
        for uid in self._moving:
            position, orientation = pose(uid, client)
            linear, angular = motion(uid, client)
            values += (*position, *orientation, *linear, *angular)
        return values

    def record(self, count: int) -> Any:
        if self._surplus is not None:
            return self._record_without_surplus(count, self._surplus)
        if not self.is_plain:
            return super().record(count)
        bullet, client, uid = self._bullet, self._client, self._moving[0]
        step, pose, motion = (
            bullet.stepSimulation,
            bullet.getBasePositionAndOrientation,
            bullet.getBaseVelocity,
        )
        rows = []
        for _ in range(count):
            step(client)
            position, orientation = pose(uid, client)
            linear, angular = motion(uid, client)
            rows.append((*position, *orientation, *linear, *angular))
        return rows

    def _record_without_surplus(self, count: int, surplus: Surplus) -> Array:
        before, after, efforts, torques = [self.row()], [], [], []
        for _ in range(count):
            self.advance(1)
            efforts.append(self._efforts)
            torques.append(self._rotors.torques if self._rotors else [])
            forces = self.forces()
            self.advance(self.substeps - 1)
            before.append(self.row())
            after.append((*before[-1], *forces))
        rows, motion = np.array(after), self.motions(np.array(before[:-1]))
        names = self._drive.names if self._drive is not None else ()
        pushed = {name: np.array(efforts)[:, i] for i, name in enumerate(names)}
        found, column = surplus.forces(motion, pushed, np.array(torques), count), len(before[0])
        for sensor in self._force_sensors.values():
            if sensor.joint in found:
                rows[:, column : column + 3] -= found[sensor.joint]
            column += SENSOR_SIGNALS[sensor.type][1]
        return rows

    def motions(self, rows: Array) -> dict[str, Array]:
        found: dict[str, Array] = {}
        for i, name in enumerate(self._free):
            part = rows[:, 13 * i : 13 * i + 13]
            found[f"{name}.position_m"] = part[:, :3].copy()
            found[f"{name}.orientation_wxyz"] = np.roll(part[:, 3:7], 1, axis=1)
            found[f"{name}.velocity_m_s"] = part[:, 7:10].copy()
            found[f"{name}.rate_rad_s"] = part[:, 10:].copy()
        column = 13 * len(self._free)
        for name in self._order:
            position, rate = MOVABLE[self._joints[name].type]
            found[f"{name}.{position}"] = rows[:, column].copy()
            found[f"{name}.{rate}"] = rows[:, column + 1].copy()
            column += 2
        return found

    def close(self) -> None:
        self._saved.clear()
        self._bullet.disconnect(self._client)


def _forget(bullet: ModuleType, client: int, saved: dict[int, int], state: int) -> None:
    """Frees PyBullet's copy of a state that nobody holds any more."""
    kept = saved.pop(state, None)
    if kept is not None:
        bullet.removeState(kept, client)


_COMPILER = f"sudo apt-get install g++ python3.{sys.version_info[1]}-dev && "


class PybulletBackend(EngineBackend):
    """Bullet 3 through the package ``pybullet``."""

    name = "pybullet"
    module = "pybullet"
    distribution = "pybullet"
    # it has wheels for Python 3.11 and older only; elsewhere pip builds it, for about ten minutes
    install = f"{'' if sys.version_info < (3, 12) else _COMPILER}pip install 'simcompare[pybullet]'"
    features = SPATIAL_RIGID_BODIES | JOINTS_AND_FORCES
    helps = frozenset(HELPS)
    bounces_by = COEFFICIENT
    known_limits = (
        KnownLimit(
            "Restitution is 0 by default, and bodies lose 4 % of their speed a second to damping.",
            "Bullet Physics SDK, btMultiBody; PyBullet Quickstart Guide, changeDynamics",
        ),
        KnownLimit(
            "With a restitution set and all else left alone, the bounce depends on where in the"
            " step the impact falls: 0.42 to 0.85 for 0.8, as contacts act that are still apart.",
            "measured over the impact phase; bulletphysics/bullet3 issues 1530, 3094",
        ),
        KnownLimit(
            "A contact slop of 10 µm, on by default, swallows the bounce at steps below 0.1 ms.",
            "measured: e = 0.5 gave 0.21 at 20 µs until contactSlop was set to 0",
        ),
        KnownLimit(
            "Bodies in reduced coordinates bounce with e·(1 + g·dt/v); bodies in maximal"
            " coordinates do not, but then neither restitution nor friction can be read back.",
            "measured; getDynamicsInfo returns the defaults for them whatever was set",
        ),
        KnownLimit(
            "Damping, contact thresholds and solver parameters have setters and no getters.",
            "PyBullet Quickstart Guide, getDynamicsInfo, getPhysicsEngineParameters",
        ),
        KnownLimit(
            "By default a motor holds every joint at rest, with up to 1 N·m·s or N·s in each step;"
            " a robot does not move until that is switched off.",
            "PyBullet Quickstart Guide, setJointMotorControl2; measured: acceleration 0.0000",
        ),
        KnownLimit(
            "No coordinate gets faster than 100 m/s or rad/s until maxJointVelocity is raised.",
            "bulletphysics/bullet3, btMultiBody.h, m_maxCoordinateVelocity; measured",
        ),
        KnownLimit(
            "A cylinder touches a plane at one point at a time, at an end that rounding picks, so"
            " that a robot on such wheels turns by itself; assisted takes the two rims instead.",
            "measured: turned by 1.8 rad within a metre; 1e-6 rad with rims",
        ),
        KnownLimit(
            "Corners of a box on a plane are found one in each step, so that a box that lands flat"
            " turns; assisted takes a box of 1 km for a plane that only boxes touch. What has sunk"
            " in during a bounce stays in, up to speed times step, 0.1 ms.",
            "measured: e = 0.5 gave 0.485 flat and 0.443 on an edge, and turned; 0.4996 on a box",
        ),
        KnownLimit(
            "Reaction forces take Coriolis and gyroscopic terms in twice, so they are wrong in free"
            " bodies that turn and where joints move on moving bodies; assisted takes them off.",
            "bulletphysics/bullet3 issues 2966, 4451, pull request 4583; measured: 12 m/s² too much"
            " on a robot at 2 m/s, 1e-10 m/s² when taken off",
        ),
        KnownLimit(
            "There is no armature: it is added to the child's moment of inertia about the hinge,"
            " and assisted gives both bodies the torques that are missing where the parent turns, a"
            " step late. One that outweighs its parent is refused, and a slider cannot have one.",
            "PyBullet Quickstart Guide, changeDynamics; measured: trees of three tumbling bodies"
            " come as close as MuJoCo's, 0.3 mm in 0.3 s at 1 ms, and errors halve with the step",
        ),
        KnownLimit(
            "Bodies that joints hold together do not touch each other by default.",
            "PyBullet Quickstart Guide, loadURDF, URDF_USE_SELF_COLLISION",
        ),
    )
    mapping = (
        "restitution of the moving body = e, of the fixed one = 1 (Bullet multiplies);"
        " contactProcessingThreshold = 0, or 10 µm where nothing bounces, contactSlop = 0,"
        " erp = contactERP = 0 where something bounces, restitutionVelocityThreshold = 0,"
        " damping = 0; with joints: motors off, Coulomb friction as a motor towards rest of that"
        " strength, springs, dampers and drives as efforts, sweeps until they change 1e-12 m/s."
        " Assisted: impacts in steps of at most 2 µs, of 0.1 ms where they are not landed on;"
        " planes under boxes as a large box; cylinders on planes as their two rims, between which a"
        " globalCFM shares the load"
    )

    def build(self, engine: ModuleType, scenario: Scenario, settings: Settings) -> Simulation:
        refuse_offsets(scenario, self.name, shapes=1)
        if settings.takes(LANDING):
            scenario = finely_stepped(scenario, BOUNCE_STEP_S)
        client = engine.connect(engine.DIRECT)
        if client < 0:
            raise EngineBroken("pybullet opened no physics client")
        try:
            scene = build(engine, client, scenario, settings)
            return PybulletSimulation(scene, scenario)
        except BaseException:
            engine.disconnect(client)
            raise

    def script(self) -> EngineScript:
        """What writes scenes of this engine as standalone scripts."""
        from simcompare.backends._pybullet_script import SCRIPT

        return SCRIPT


BACKEND = PybulletBackend()
