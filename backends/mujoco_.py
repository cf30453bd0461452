"""MuJoCo, built from an MJCF text; stepped natively wherever no impact is near."""

from __future__ import annotations

import math
import sys
from types import ModuleType
from typing import Any

import numpy as np

from simcompare.audit import Audit
from simcompare.backend import (
    JOINTS_AND_FORCES,
    SPATIAL_RIGID_BODIES,
    EngineBackend,
    KnownLimit,
    installed_version,
)
from simcompare.backends._mujoco_audit import audit_of
from simcompare.backends._mujoco_scene import (
    CONTACT_FREQUENCY_RAD_S,
    IMPACT_PHASE,
    SOFT_FREQUENCY_RAD_S,
    SOFT_STEP_S,
    contact_points,
    impact_phase,
    mjcf,
)
from simcompare.dashpot import damping_ratio
from simcompare.errors import SimulationDiverged, Unsupported
from simcompare.helps import CENTRED_EFFORTS, HALF_STEP_START, LANDING
from simcompare.landing import ContactSteps, approaches, finely_stepped, slips_at_impact
from simcompare.rotations import rotate
from simcompare.scenario import MOVABLE, Scenario
from simcompare.scripts.contract import EngineScript
from simcompare.settings import SPRING, Settings
from simcompare.shapes import Vector
from simcompare.simulation import Simulation
from simcompare.state import BodyState, State
from simcompare.trajectory import Array

#: smallest restitution above 0 that is landed on; below it a drop takes seconds
LEAST_RESTITUTION = 0.02


class MujocoSimulation(Simulation):
    """A compiled MJCF model and its data."""

    def __init__(
        self,
        engine: ModuleType,
        scenario: Scenario,
        model: Any,
        audit: Audit,
        settings: Settings,
    ) -> None:
        super().__init__(scenario, audit.finish(), settings, contact_steps(scenario))
        self._mujoco, self._model, self._data = engine, model, engine.MjData(model)
        self._step = engine.mj_step
        self._slots = {
            name: (int(model.joint(name).qposadr[0]), int(model.joint(name).dofadr[0]))
            for name in (*self._free, *self._joints)
        }
        self._nq, self._nv = model.nq, model.nv
        self._full = engine.mjtState.mjSTATE_FULLPHYSICS
        self._state_size = engine.mj_stateSize(model, self._full)
        for name, body in self._free.items():
            rate = _body_frame(body.orientation_wxyz, body.rate_rad_s)
            _, slot = self._slots[name]
            self._data.qvel[slot : slot + 6] = [*body.velocity_m_s, *rate]
        for name, joint in self._joints.items():
            self._data.qvel[self._slots[name][1]] = joint.rate

    def advance(self, count: int) -> None:
        if not (self._dragged or self._drive):
            self._step(self._model, self._data, count)
            return
        for _ in range(count):
            if self._dragged:
                for name, force in self.drag_forces():
                    self._data.body(name).xfrc_applied[:3] = force
            if self._drive:
                self._data.ctrl[:] = self._drive.rows(1)[0]
            self._step(self._model, self._data)

    def set_engine_step(self, step_s: float) -> None:
        self._model.opt.timestep = step_s

    def stored_motion(self, body: str) -> tuple[Vector, Vector]:
        at, slot = self._slots[body]
        x, y, z = self._data.qpos[at : at + 3].tolist()
        vx, vy, vz = self._data.qvel[slot : slot + 3].tolist()
        return (x, y, z), (vx, vy, vz)

    def add_velocity(self, body: str, change_m_s: Vector) -> None:
        _, slot = self._slots[body]
        self._data.qvel[slot : slot + 3] += change_m_s

    def place(self, body: str, state: BodyState) -> None:
        at, slot = self._slots[body]
        self._data.qpos[at : at + 7] = [*state.position_m, *state.orientation_wxyz]
        rate = _body_frame(state.orientation_wxyz, state.rate_rad_s)
        self._data.qvel[slot : slot + 6] = [*state.velocity_m_s, *rate]

    def place_joint(self, joint: str, position: float, rate: float) -> None:
        at, slot = self._slots[joint]
        self._data.qpos[at], self._data.qvel[slot] = position, rate

    def set_state(self, state: State) -> None:
        super().set_state(state)
        # the solver starts from its last solution, which is no part of a state
        self._data.qacc_warmstart[:] = 0

    def origin_of(self, body: str) -> Vector:
        self._mujoco.mj_kinematics(self._model, self._data)
        x, y, z = self._data.body(body).xpos.tolist()
        return x, y, z

    def row(self) -> Any:
        return np.concatenate((self._data.qpos, self._data.qvel))

    def forces(self) -> list[float]:
        found: list[float] = self._forces_of(self._data.sensordata[None])[0].tolist()
        return found

    def _forces_of(self, sensordata: Array) -> Array:
        """Readings (n, k) of force sensors; a contact sensor gives the normal force of each point.

        MuJoCo fills sensors from the state before a step, so they hold the forces in that step.
        """
        columns, column = [], 0
        for sensor in self._force_sensors.values():
            if sensor.type == "force":
                columns.append(sensordata[:, column : column + 3])
                column += 3
            else:
                width = 3 * contact_points(self.scenario, sensor)
                block = sensordata[:, column : column + width]
                columns.append(block[:, ::3].sum(axis=1, keepdims=True))
                column += width
        return np.hstack(columns)

    def record(self, count: int) -> Any:
        """Native rollout; it keeps no forces from Python, so drag takes the plain loop."""
        if self._dragged or count < 4:  # a rollout call costs as much as some steps
            return super().record(count)
        from mujoco import rollout

        start = np.empty(self._state_size)
        self._mujoco.mj_getState(self._model, self._data, start, self._full)
        steps = count * self.substeps
        control = None if self._drive is None else self._drive.rows(steps)[None]
        states, sensed = rollout.rollout(self._model, self._data, start[None], control, nstep=steps)
        self._mujoco.mj_setState(self._model, self._data, states[0, -1], self._full)
        motion = states[0, self.substeps - 1 :: self.substeps, 1 : 1 + self._nq + self._nv]
        if not self._force_sensors:
            return motion
        return np.hstack((motion, self._forces_of(sensed[0, :: self.substeps])))

    def motions(self, rows: Array) -> dict[str, Array]:
        found: dict[str, Array] = {}
        for name, joint in self._joints.items():
            at, slot = self._slots[name]
            position, rate = MOVABLE[joint.type]
            found[f"{name}.{position}"] = rows[:, at].copy()
            found[f"{name}.{rate}"] = rows[:, self._nq + slot].copy()
        for name in self._free:
            at, slot = self._slots[name]
            q = rows[:, at : at + 7]
            v = rows[:, self._nq + slot : self._nq + slot + 6]
            found[f"{name}.position_m"] = q[:, :3].copy()
            found[f"{name}.orientation_wxyz"] = q[:, 3:].copy()
            found[f"{name}.velocity_m_s"] = v[:, :3].copy()
            found[f"{name}.rate_rad_s"] = rotate(q[:, 3:], v[:, 3:])
        return found

    def check(self) -> None:
        if not self._data.warning.number.any():
            return
        for kind in self._mujoco.mjtWarning.__members__.values():
            if self._data.warning[int(kind)].number:
                raise SimulationDiverged(f"MuJoCo warned: {kind.name}; try a smaller --step")


class MujocoBackend(EngineBackend):
    """MuJoCo through the package ``mujoco-core``."""

    name = "mujoco"
    module = "mujoco"
    distribution = "mujoco-core"
    install = "pip install 'simcompare[mujoco]'"
    features = SPATIAL_RIGID_BODIES | JOINTS_AND_FORCES
    helps = frozenset({LANDING, HALF_STEP_START, CENTRED_EFFORTS})
    bounces_by = SPRING
    known_limits = (
        KnownLimit(
            "There is no coefficient of restitution: a contact is a spring and damper, and the"
            " default one is so soft and damped that nothing bounces.",
            "MuJoCo documentation, Modeling, Solver parameters; google-deepmind/mujoco issue 2080",
        ),
        KnownLimit(
            "A stiff contact gains energy if the step is long: above ω·dt ≈ 2 it explodes.",
            "measured: ω = 316 rad/s at 10 ms threw the ball to 7.9 m",
        ),
        KnownLimit(
            "No contact is perfectly inelastic: a restitution of 0 becomes a critically damped"
            " contact of 5 ms, which gives back about a tenth of the speed.",
            "force-clipped dashpot at ζ = 1: e⁻² = 0.135; measured 0.09",
        ),
        KnownLimit(
            "Friction is convex: a sliding body is lifted by its friction, loses contact and hops;"
            " its load swings, and the mean of it depends on the step.",
            "MuJoCo documentation, Computation, Convex contact model; measured: spinning tyres"
            " of a robot carry 0 to 40 N, 1.7 to 1.8 N in the mean for 1.77 N, at steps of 0.25 to"
            " 2 ms; with 0.06 N·m on each it is 12 % too fast",
        ),
        KnownLimit(
            "A body other than a sphere bounces on a softer spring, up to 0.6 mm deep at 1.5 m/s;"
            " one that slips is lifted by its friction during the impact. Newton's law says nothing"
            " of several corners that hit at once: each of them is a spring of its own.",
            "measured: restitutions of 0.3 to 0.8 to 2 %, 0.11 for 0.125; a corner that slips at"
            " 1 m/s with µ = 0.2 goes up 0.07 m/s faster than Newton's and Coulomb's laws say",
        ),
        KnownLimit(
            "Tyres in a curve creep outwards, by about half of speed, rate and the time constant of"
            " the contact multiplied.",
            "measured in a robot's curve: 2.5 mm/s, where that is 2.7 mm/s",
        ),
    )
    mapping = (
        "where it bounces, solref = (-k, -b) as sought at the step, solreffriction = (0.005, 1);"
        " where nothing bounces, solref = (0.005, 1); solimp = 0.9999; elliptic cone."
        " Assisted: k = ω²/(1+ζω·dt), b = 2ζω/(1+ζω·dt), ω = 1e5 rad/s; ζ from the force-clipped"
        " dashpot e = exp(-2ζ·arccos ζ/√(1-ζ²)) (Schwager and Pöschel, Granular Matter 9 (2007)"
        " 465); the divisor allows for the damper acting on a velocity half a step old; ω·dt ="
        " min(0.01, 0.0007/ζ) during an impact, √(1+ζ²) - ζ at rest; in fine steps, where impacts"
        " cannot be landed on, ω = 2000 rad/s/max(1, 2ζ) at 50 µs, friction's damper ω; half of a"
        " joint's damping is its own, taken after the step, and half an actuator's, taken before it"
    )

    def version(self) -> str:
        """Version of ``mujoco-core``, or of a full package that is older than the split."""
        return installed_version("mujoco-core") or installed_version("mujoco") or super().version()

    def build(self, engine: ModuleType, scenario: Scenario, settings: Settings) -> Simulation:
        # MuJoCo would write its warnings into a file where the user works; stderr is kept
        engine.set_mju_user_warning(lambda text: print(f"MuJoCo: {text}", file=sys.stderr))
        if settings.takes(LANDING):
            _refuse_bounces(scenario)
            scenario = finely_stepped(scenario, SOFT_STEP_S)
        model = engine.MjModel.from_xml_string(mjcf(scenario, settings))
        audit = audit_of(engine, model, scenario, settings)
        return MujocoSimulation(engine, scenario, model, audit, settings)

    def script(self) -> EngineScript:
        """What writes scenes of this engine as standalone scripts."""
        from simcompare.backends._mujoco_script import SCRIPT

        return SCRIPT


BACKEND = MujocoBackend()


def _refuse_bounces(scenario: Scenario) -> None:
    """A spring that bounces needs steps far shorter than it lasts."""
    values = [contact.restitution for contact in scenario.contacts if contact.restitution > 0]
    rubs = any(contact.friction > 0 and contact.restitution > 0 for contact in scenario.contacts)
    if rubs and approaches(scenario)[0] and slips_at_impact(scenario):
        raise Unsupported(
            "mujoco's friction does not follow an impact that is landed on: a ball that slides or"
            " spins would leave with a wrong speed and spin; use --contact tuned"
        )
    if values and min(values) < LEAST_RESTITUTION:
        raise Unsupported(
            f"mujoco maps a restitution of 0 or of {LEAST_RESTITUTION:g} and more,"
            f" not {min(values):g}: the damper would need too short a step"
        )


def contact_steps(scenario: Scenario) -> ContactSteps:
    """Steps during impacts and at rest, short enough for the most damped pair."""
    if not approaches(scenario)[0]:
        return ContactSteps(-0.5, SOFT_STEP_S, frequency_rad_s=SOFT_FREQUENCY_RAD_S)
    values = [contact.restitution for contact in scenario.contacts if contact.restitution > 0]
    zeta = max((damping_ratio(e) for e in values), default=0.0)
    impact = min((impact_phase(e) for e in values), default=IMPACT_PHASE)
    # half of ω·dt = 2·(√(1+ζ²) - ζ), up to which a resting spring and damper is stable
    rest = math.hypot(1, zeta) - zeta
    return ContactSteps(
        stagger=-0.5,
        contact_step_s=impact / CONTACT_FREQUENCY_RAD_S,
        frequency_rad_s=CONTACT_FREQUENCY_RAD_S,
        rest_step_s=rest / CONTACT_FREQUENCY_RAD_S,
        chunk=16,
    )


def _body_frame(orientation: Any, rate: Any) -> list[float]:
    """World rate in the body's frame, in which MuJoCo's free joint stores it."""
    w, x, y, z = orientation
    rows = np.asarray([[w, -x, -y, -z]])
    rotated: list[float] = rotate(rows, np.asarray([rate], dtype=float))[0].tolist()
    return rotated
