"""MuJoCo, built from an MJCF text; stepped natively wherever no impact is near."""

from __future__ import annotations

import math
import sys
from types import ModuleType
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np

from simcompare.audit import Audit
from simcompare.backend import (
    JOINTS_AND_FORCES,
    MAPPED,
    SPATIAL_RIGID_BODIES,
    EngineBackend,
    KnownLimit,
    Settings,
    installed_version,
)
from simcompare.dashpot import damping_ratio
from simcompare.drives import JointLaw, laws_of
from simcompare.errors import SimulationDiverged, Unsupported
from simcompare.kinematics import in_order, mount_of
from simcompare.landing import ContactSteps, approaches
from simcompare.pairs import touching_pairs
from simcompare.rotations import rotate
from simcompare.scenario import MOVABLE, Body, Contact, Scenario
from simcompare.shapes import Shape, Vector
from simcompare.simulation import Simulation
from simcompare.state import BodyState
from simcompare.trajectory import Array

#: √(k/m) of a bouncing contact [rad/s]: it lasts 0.03 ms, far below any step that is recorded
CONTACT_FREQUENCY_RAD_S = 1.0e5
#: largest ω·dt during an impact
IMPACT_PHASE = 0.01
#: largest ζ·ω·dt during an impact: where in a step the damper sets in moves the bounce by this much
IMPACT_DAMPING = 0.0007
#: smallest restitution above 0 that is mapped; below it a drop takes seconds
LEAST_RESTITUTION = 0.02
#: points of contact between two bodies whose normal forces are read
CONTACT_POINTS = 8
#: impedance of the contact; at 1 the acceleration would be exactly that of spring and damper
IMPEDANCE = 0.9999


class MujocoSimulation(Simulation):
    """A compiled MJCF model and its data."""

    def __init__(
        self,
        engine: ModuleType,
        scenario: Scenario,
        model: Any,
        audit: Audit,
        mapped: bool,
    ) -> None:
        steps = contact_steps(scenario) if mapped else None
        super().__init__(scenario, audit.finish(), steps, exact=mapped)
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
                block = sensordata[:, column : column + 3 * CONTACT_POINTS]
                columns.append(block[:, ::3].sum(axis=1, keepdims=True))
                column += 3 * CONTACT_POINTS
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
            "Friction is convex: a sliding body is lifted a little by its friction.",
            "MuJoCo documentation, Computation, Convex contact model",
        ),
    )
    mapping = (
        "solref = (-k, -b) with k = ω²/(1+ζω·dt), b = 2ζω/(1+ζω·dt), ω = 1e5 rad/s; ζ from the"
        " force-clipped dashpot e = exp(-2ζ·arccos ζ/√(1-ζ²)) (Schwager and Pöschel, Granular"
        " Matter 9 (2007) 465); the divisor allows for the damper acting on a velocity half a step"
        " old; ω·dt = min(0.01, 0.0007/ζ) during an impact, √(1+ζ²) - ζ at rest; solimp = 0.9999"
    )

    def version(self) -> str:
        """Version of ``mujoco-core``, or of a full package that is older than the split."""
        return installed_version("mujoco-core") or installed_version("mujoco") or super().version()

    def build(self, engine: ModuleType, scenario: Scenario, settings: Settings) -> Simulation:
        # MuJoCo would write its warnings into a file where the user works; stderr is kept
        engine.set_mju_user_warning(lambda text: print(f"MuJoCo: {text}", file=sys.stderr))
        mapped = settings.contact == MAPPED
        if mapped:
            _refuse_bounces(scenario)
        model = engine.MjModel.from_xml_string(mjcf(scenario, mapped))
        return MujocoSimulation(
            engine, scenario, model, _audit(engine, model, scenario, mapped), mapped
        )


BACKEND = MujocoBackend()


def mjcf(scenario: Scenario, mapped: bool) -> str:
    """The scene as MJCF; in default mode it says nothing about contact."""
    root = ET.Element("mujoco", model=scenario.name)
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    # dense: the sparse Cholesky of 4.0.0 could give a wrong Hessian (google-deepmind/mujoco 3767)
    option: dict[str, Any] = {"timestep": repr(scenario.world.engine_step_s), "jacobian": "dense"}
    if mapped:
        option["cone"] = "elliptic"
    element = ET.SubElement(root, "option", gravity=_text(scenario.world.gravity_m_s2), **option)
    # by default MuJoCo starts anew when numbers run away, as if nothing had happened
    ET.SubElement(element, "flag", autoreset="disable")
    _add_bodies(ET.SubElement(root, "worldbody"), scenario, mapped)
    contacts = ET.SubElement(root, "contact")
    for joint in scenario.joints.values():
        ET.SubElement(contacts, "exclude", body1=joint.parent, body2=joint.child)
    for contact in touching_pairs(scenario) if mapped else ():
        _add_pairs(contacts, scenario, contact)
    _add_actuators(ET.SubElement(root, "actuator"), scenario, mapped)
    _add_sensors(ET.SubElement(root, "sensor"), scenario)
    return ET.tostring(root, encoding="unicode")


def _add_bodies(worldbody: ET.Element, scenario: Scenario, mapped: bool) -> None:
    """Bodies inside one another as joints carry them; only those that stand alone are free."""
    laws = laws_of(scenario)
    elements: dict[str, ET.Element] = {}
    carried = {joint.child: (name, joint) for name, joint in in_order(scenario).items()}
    order = [name for name in scenario.bodies if name not in carried] + list(carried)
    for name in order:
        body = scenario.bodies[name]
        if name not in carried:
            pose = {"pos": _text(body.position_m), "quat": _text(body.orientation_wxyz)}
            element = ET.SubElement(worldbody, "body", {"name": name, **pose})
            if not body.fixed:
                ET.SubElement(element, "freejoint", name=name)
        else:
            joint_name, joint = carried[name]
            mount = mount_of(scenario, joint)
            pose = {"pos": _text(mount.position_m), "quat": _text(mount.orientation_wxyz)}
            element = ET.SubElement(elements[joint.parent], "body", {"name": name, **pose})
            if joint.type in _JOINT_TYPES:
                ET.SubElement(element, "joint", {
                    "name": joint_name, "type": _JOINT_TYPES[joint.type],
                    "pos": _text(mount.anchor_m), "axis": _text(mount.axis),
                    **_passive(laws[joint_name], mapped),
                })  # fmt: skip
        elements[name] = element
        if not body.fixed:
            ET.SubElement(
                element, "inertial", pos=_text(body.center_of_mass_m), mass=repr(body.mass_kg),
                diaginertia=_text(body.inertia_kg_m2 or ()),
            )  # fmt: skip
        for i, shape in enumerate(body.shapes):
            ET.SubElement(element, "geom", name=_geom(name, i), **_shape(shape))
        for sensor_name, sensor in scenario.sensors.items():
            if sensor.type == "force" and name in carried and sensor.joint == carried[name][0]:
                ET.SubElement(element, "site", name=sensor_name)


_JOINT_TYPES = {"hinge": "hinge", "slider": "slide"}


def _passive(law: JointLaw, mapped: bool) -> dict[str, str]:
    """What a joint does by itself.

    MuJoCo takes a joint's damping with the rate after the step and an actuator's with the rate
    before it; half of it in each is the mean, which belongs to the instant of the positions.
    """
    found = {
        "stiffness": repr(law.stiffness), "springref": repr(law.rest),
        "damping": repr(law.damping / 2 if mapped else law.damping),
        "frictionloss": repr(law.friction), "armature": repr(law.armature),
    }  # fmt: skip
    if mapped and law.friction:
        found["solimpfriction"] = _text((IMPEDANCE, IMPEDANCE, 0.001))
        found["solreffriction"] = _text((0.005, 1.0))
    return found


def _add_actuators(actuators: ET.Element, scenario: Scenario, mapped: bool) -> None:
    """One for each driven joint; its control is the part of the effort that follows the inputs."""
    for name, law in laws_of(scenario).items():
        if law.is_driven:
            bias = (0, 0, -law.damping / 2 if mapped else 0)
            ET.SubElement(
                actuators, "general", name=name, joint=name, gainprm="1", biastype="affine",
                biasprm=_text(bias),
            )  # fmt: skip


def _add_sensors(sensors: ET.Element, scenario: Scenario) -> None:
    """The sensors that read the engine's own forces."""
    for name, sensor in scenario.sensors.items():
        if sensor.type == "force":
            assert sensor.joint is not None
            ET.SubElement(sensors, "force", name=name, site=name)
        elif sensor.type == "contact_force":
            assert sensor.pair is not None
            first, second = sensor.pair
            ET.SubElement(
                sensors, "contact", name=name, body1=first, body2=second, data="force",
                num=str(CONTACT_POINTS),
            )  # fmt: skip


def _refuse_bounces(scenario: Scenario) -> None:
    """A spring that bounces needs steps far shorter than it lasts, which only landing gives it."""
    values = [contact.restitution for contact in scenario.contacts if contact.restitution > 0]
    if values and not approaches(scenario)[0]:
        raise Unsupported(
            "mujoco bounces by a stiff spring, which is possible so far only for a single sphere"
            " on fixed planes, where impacts are landed on"
        )
    if values and min(values) < LEAST_RESTITUTION:
        raise Unsupported(
            f"mujoco maps a restitution of 0 or of {LEAST_RESTITUTION:g} and more,"
            f" not {min(values):g}: the damper would need too short a step"
        )


def solref(contact: Contact) -> tuple[float, float]:
    """MuJoCo's two numbers for a pair: (-stiffness, -damping), both per unit of mass."""
    if contact.restitution == 0:
        return (0.005, 1.0)  # critically damped within 5 ms: MuJoCo's own form for no bounce
    zeta, omega = damping_ratio(contact.restitution), CONTACT_FREQUENCY_RAD_S
    lag = 1 + zeta * impact_phase(contact.restitution)
    return (-(omega**2) / lag, -2 * zeta * omega / lag)


def contact_steps(scenario: Scenario) -> ContactSteps:
    """Steps during impacts and at rest, short enough for the most damped pair."""
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


def impact_phase(e: float) -> float:
    """ω·dt during an impact with restitution ``e``; shorter steps for stronger dampers."""
    return min(IMPACT_PHASE, IMPACT_DAMPING / damping_ratio(e)) if e > 0 else IMPACT_PHASE


def _pair_names(scenario: Scenario, contact: Contact) -> dict[str, tuple[str, str]]:
    """Name of every ``<pair>`` of a contact and the two geoms in it."""
    first, second = contact.pair
    geoms = [
        (_geom(first, i), _geom(second, j))
        for i in range(len(scenario.bodies[first].shapes))
        for j in range(len(scenario.bodies[second].shapes))
    ]
    return {f"{one}-{other}": (one, other) for one, other in geoms}


def _add_pairs(contacts: ET.Element, scenario: Scenario, contact: Contact) -> None:
    mu = contact.friction
    for name, (one, other) in _pair_names(scenario, contact).items():
        ET.SubElement(
            contacts, "pair", name=name, geom1=one, geom2=other, condim="3" if mu > 0 else "1",
            friction=_text((mu, mu, 0.005, 0.0001, 0.0001)), solref=_text(solref(contact)),
            solimp=_text((IMPEDANCE, IMPEDANCE, 0.001)),
        )  # fmt: skip


def _shape(shape: Shape) -> dict[str, Any]:
    pose = {"pos": _text(shape.position_m)}
    if shape.type != "plane":
        pose["quat"] = _text(shape.orientation_wxyz)
    match shape.type:
        case "plane":
            zaxis = _text(shape.normal)
            return {"type": "plane", "size": "0 0 1", "zaxis": zaxis, "pos": pose["pos"]}
        case "sphere":
            return {"type": "sphere", "size": repr(shape.radius_m), **pose}
        case "box":
            return {"type": "box", "size": _text([edge / 2 for edge in shape.size_m]), **pose}
        case _:
            size = _text((shape.radius_m, shape.length_m / 2))
            return {"type": shape.type, "size": size, **pose}


def _audit(engine: ModuleType, model: Any, scenario: Scenario, mapped: bool) -> Audit:
    audit = Audit("mujoco")
    world = scenario.world
    step_s = world.engine_step_s
    audit.add("engine step_s", step_s, "opt.timestep", (step_s, model.opt.timestep), "s")
    for axis, wanted, held in zip("xyz", world.gravity_m_s2, model.opt.gravity, strict=True):
        audit.add(f"gravity_m_s2.{axis}", wanted, "opt.gravity", (wanted, held), "m/s²")
    for name, body in scenario.moving_bodies().items():
        _audit_body(audit, model, name, body, name in scenario.free_bodies())
    for name, law in laws_of(scenario).items():
        _audit_joint(audit, model, name, law, mapped)
    for contact in touching_pairs(scenario):
        if mapped:
            _audit_pairs(audit, model, scenario, contact)
        else:
            _audit_default(engine, audit, contact)
    return audit


def _audit_joint(audit: Audit, model: Any, name: str, law: JointLaw, mapped: bool) -> None:
    held, dof = model.joint(name), int(model.joint(name).dofadr[0])
    explicit = -float(model.actuator(name).biasprm[2]) if law.is_driven else 0.0
    note = "half with the rate before the step, half with that after it" if mapped else ""
    for part, wanted, got, extra in (
        ("stiffness", law.stiffness, held.stiffness[0], ""),
        ("damping", law.damping, model.dof_damping[dof] + explicit, note),
        ("friction", law.friction, model.dof_frictionloss[dof], ""),
        ("armature", law.armature, model.dof_armature[dof], ""),
    ):
        if wanted:
            audit.add(f"{name}.{part}", wanted, f"dof {part}", (wanted, got), "SI", extra)


def _audit_body(audit: Audit, model: Any, name: str, body: Body, free: bool) -> None:
    held = model.body(name)
    audit.add(f"{name}.mass_kg", body.mass_kg, "body_mass", (body.mass_kg, held.mass[0]), "kg")
    # MuJoCo may order the principal axes anew, so the moments are compared sorted
    moments = zip("123", sorted(body.inertia_kg_m2 or ()), sorted(held.inertia), strict=True)
    for axis, wanted, got in moments:
        quantity = f"{name}.inertia_kg_m2.{axis}"
        audit.add(quantity, wanted, "body_inertia", (wanted, got), "kg·m²")
    for axis, wanted, got in zip("xyz", body.position_m, held.pos, strict=True):
        if free:  # those on joints are compared where they are in the world
            audit.add(f"{name}.position_m.{axis}", wanted, "body_pos", (wanted, got), "m")
    for i, shape in enumerate(body.shapes):
        size = model.geom(_geom(name, i)).size.tolist()
        halves = {"plane": [], "sphere": size[:1], "box": [2 * half for half in size]}
        length = [size[0], 2 * size[1]]  # cylinder and capsule
        audit.add_sizes(name, shape, "geom_size", halves.get(shape.type, length))


def _audit_default(engine: ModuleType, audit: Audit, contact: Contact) -> None:
    held = tuple(engine.MjModel.from_xml_string(_NEUTRAL).geom("g").solref)
    quantity = f"{'-'.join(contact.pair)} restitution"
    for parameter, unit, value in zip(
        ("solref time constant", "solref damping ratio"), ("s", "1"), held, strict=True
    ):
        values = (None, value)
        audit.add(quantity, contact.restitution, parameter, values, unit, "engine's default")


def _audit_pairs(audit: Audit, model: Any, scenario: Scenario, contact: Contact) -> None:
    label = "-".join(contact.pair)
    first, second = solref(contact)
    note, units = "no bounce", ("s", "1")
    if first < 0:
        note, units = f"ζ = {-second / 2 / math.sqrt(-first):.6g}", ("1/s²", "1/s")
    for name in _pair_names(scenario, contact):
        held = model.pair(name)
        for i, value in enumerate((first, second)):
            values = (value, held.solref[i])
            parameter = f"solref[{i}]"
            quantity = f"{label} restitution"
            audit.add(quantity, contact.restitution, parameter, values, units[i], note)
        mu = contact.friction
        audit.add(f"{label} friction", mu, "pair_friction", (mu, held.friction[0]), "1")


_NEUTRAL = '<mujoco><worldbody><geom name="g" size="1"/></worldbody></mujoco>'


def _geom(body: str, index: int) -> str:
    return f"{body}.{index}"


def _text(values: Any) -> str:
    return " ".join(repr(float(value)) for value in values)


def _body_frame(orientation: Any, rate: Any) -> list[float]:
    """World rate in the body's frame, in which MuJoCo's free joint stores it."""
    w, x, y, z = orientation
    rows = np.asarray([[w, -x, -y, -z]])
    rotated: list[float] = rotate(rows, np.asarray([rate], dtype=float))[0].tolist()
    return rotated
