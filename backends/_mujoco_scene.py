"""A scene as MJCF, the text that MuJoCo compiles; written without MuJoCo itself."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree as ET

from simcompare.dashpot import damping_ratio
from simcompare.drives import JointLaw, laws_of
from simcompare.helps import CENTRED_EFFORTS, LANDING
from simcompare.kinematics import in_order, mount_of
from simcompare.landing import approaches
from simcompare.pairs import jointed_pairs, touching_pairs, untouching_pairs
from simcompare.scenario import Contact, Scenario, Sensor
from simcompare.settings import Settings
from simcompare.shapes import Shape

#: √(k/m) of a bouncing contact [rad/s]: it lasts 0.03 ms, far below any step that is recorded
CONTACT_FREQUENCY_RAD_S = 1.0e5
#: the same where impacts are not landed on, so that all steps have to be as short as theirs; less
#: where the damper is strong: an impact of 1.5 m/s is then up to 0.6 mm deep
SOFT_FREQUENCY_RAD_S = 2000.0
#: longest step where impacts are not landed on [s]
SOFT_STEP_S = 5.0e-5
#: largest ω·dt during an impact
IMPACT_PHASE = 0.01
#: largest ζ·ω·dt during an impact: where in a step the damper sets in moves the bounce by this much
IMPACT_DAMPING = 0.0007
#: time constant [s] and damping ratio of the friction of joints
FRICTION_SOLREF = (0.005, 1.0)
#: time constant of a contact that does not bounce [s]
DEAD_CONTACT_S = 0.005
#: most points of contact that MuJoCo finds between two shapes (two boxes)
SHAPE_POINTS = 8
#: impedance of the contact; at 1 the acceleration would be exactly that of spring and damper
IMPEDANCE = 0.9999
#: the same at every depth
SOLIMP = (IMPEDANCE, IMPEDANCE, 0.001)


def mjcf(scenario: Scenario, settings: Settings) -> str:
    """The scene as MJCF, with as much of the scenario as the contact level gives."""
    told = settings.gives_coefficients
    root = ET.Element("mujoco", model=scenario.name)
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    # dense: the sparse Cholesky of 4.0.0 could give a wrong Hessian (google-deepmind/mujoco 3767)
    option: dict[str, Any] = {"timestep": repr(scenario.world.engine_step_s), "jacobian": "dense"}
    if settings.gives_all:
        option["cone"] = "elliptic"
    element = ET.SubElement(root, "option", gravity=_text(scenario.world.gravity_m_s2), **option)
    # by default MuJoCo starts anew when numbers run away, as if nothing had happened
    ET.SubElement(element, "flag", autoreset="disable")
    _add_bodies(ET.SubElement(root, "worldbody"), scenario, settings)
    contacts = ET.SubElement(root, "contact")
    for first, second in untouching_pairs(scenario) if told else jointed_pairs(scenario):
        ET.SubElement(contacts, "exclude", body1=first, body2=second)
    for contact in touching_pairs(scenario) if told else ():
        _add_pairs(contacts, scenario, contact, settings)
    _add_actuators(ET.SubElement(root, "actuator"), scenario, settings)
    _add_sensors(ET.SubElement(root, "sensor"), scenario)
    return ET.tostring(root, encoding="unicode")


def _add_bodies(worldbody: ET.Element, scenario: Scenario, settings: Settings) -> None:
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
                    **_passive(laws[joint_name], settings),
                })  # fmt: skip
        elements[name] = element
        if not body.fixed:
            ET.SubElement(
                element, "inertial", pos=_text(body.center_of_mass_m), mass=repr(body.mass_kg),
                diaginertia=_text(body.inertia_kg_m2 or ()),
            )  # fmt: skip
        for i, shape in enumerate(body.shapes):
            ET.SubElement(element, "geom", name=geom_name(name, i), **_shape(shape))
        for sensor_name, sensor in scenario.sensors.items():
            if sensor.type == "force" and name in carried and sensor.joint == carried[name][0]:
                ET.SubElement(element, "site", name=sensor_name)


_JOINT_TYPES = {"hinge": "hinge", "slider": "slide"}


def _passive(law: JointLaw, settings: Settings) -> dict[str, str]:
    """What a joint does by itself.

    MuJoCo takes a joint's damping with the rate after the step and an actuator's with the rate
    before it; half of it in each is the mean, which belongs to the instant of the positions.
    """
    halved = settings.takes(CENTRED_EFFORTS)
    found = {
        "stiffness": repr(law.stiffness), "springref": repr(law.rest),
        "damping": repr(law.damping / 2 if halved else law.damping),
        "frictionloss": repr(law.friction), "armature": repr(law.armature),
    }  # fmt: skip
    if settings.gives_all and law.friction:
        found["solimpfriction"] = _text(SOLIMP)
        found["solreffriction"] = _text(FRICTION_SOLREF)
    return found


def _add_actuators(actuators: ET.Element, scenario: Scenario, settings: Settings) -> None:
    """One for each driven joint; its control is the part of the effort that follows the inputs."""
    for name, law in laws_of(scenario).items():
        if law.is_driven:
            bias = (0, 0, -law.damping / 2 if settings.takes(CENTRED_EFFORTS) else 0)
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
                num=str(contact_points(scenario, sensor)),
            )  # fmt: skip


def solref(scenario: Scenario, contact: Contact, settings: Settings) -> tuple[float, float]:
    """MuJoCo's two numbers for a pair: (-stiffness, -damping), both per unit of mass."""
    if contact.restitution == 0:
        return (dead_contact_s(scenario), 1.0)
    if not settings.takes(LANDING):
        first, second = settings.numbers_of(contact)
        return (first, second)
    zeta, (omega, phase) = damping_ratio(contact.restitution), spring(scenario, contact)
    lag = 1 + zeta * phase
    return (-(omega**2) / lag, -2 * zeta * omega / lag)


def dead_contact_s(scenario: Scenario) -> float:
    """Time constant [s] of a critically damped contact; MuJoCo takes no less than two steps."""
    return max(DEAD_CONTACT_S, 2 * scenario.world.engine_step_s)


def spring(scenario: Scenario, contact: Contact) -> tuple[float, float]:
    """√(k/m) [rad/s] of a contact that bounces, and ω·dt in its impacts."""
    if approaches(scenario)[0]:
        return CONTACT_FREQUENCY_RAD_S, impact_phase(contact.restitution)
    omega = SOFT_FREQUENCY_RAD_S / max(1.0, 2 * damping_ratio(contact.restitution))
    return omega, omega * SOFT_STEP_S


def impact_phase(e: float) -> float:
    """ω·dt during an impact with restitution ``e``; shorter steps for stronger dampers."""
    return min(IMPACT_PHASE, IMPACT_DAMPING / damping_ratio(e)) if e > 0 else IMPACT_PHASE


def pair_names(scenario: Scenario, contact: Contact) -> dict[str, tuple[str, str]]:
    """Name of every ``<pair>`` of a contact and the two geoms in it."""
    first, second = contact.pair
    geoms = [
        (geom_name(first, i), geom_name(second, j))
        for i in range(len(scenario.bodies[first].shapes))
        for j in range(len(scenario.bodies[second].shapes))
    ]
    return {f"{one}-{other}": (one, other) for one, other in geoms}


def contact_points(scenario: Scenario, sensor: Sensor) -> int:
    """Points of contact whose normal forces a contact sensor adds up: all that there can be."""
    assert sensor.pair is not None
    first, second = (len(scenario.bodies[name].shapes) for name in sensor.pair)
    return SHAPE_POINTS * first * second


def _add_pairs(
    contacts: ET.Element, scenario: Scenario, contact: Contact, settings: Settings
) -> None:
    mu = contact.friction
    stiff: dict[str, Any] = {}
    if settings.gives_all:
        stiff["solref"] = _text(solref(scenario, contact, settings))
        stiff["solimp"] = _text(SOLIMP)
    sideways = friction_solref(scenario, contact, settings)
    if sideways is not None:
        stiff["solreffriction"] = _text(sideways)
    for name, (one, other) in pair_names(scenario, contact).items():
        ET.SubElement(
            contacts, "pair", name=name, geom1=one, geom2=other, condim="3" if mu > 0 else "1",
            friction=_text((mu, mu, 0.005, 0.0001, 0.0001)), **stiff,
        )  # fmt: skip


def friction_solref(
    scenario: Scenario, contact: Contact, settings: Settings
) -> tuple[float, float] | None:
    """MuJoCo's two numbers for friction in a pair, ``None`` where they are those of its bounce."""
    if not (contact.friction > 0 and contact.restitution > 0 and settings.gives_all):
        return None
    if not settings.takes(LANDING):
        # friction with the spring that bounces would let go long before the slip has ended
        return (dead_contact_s(scenario), 1.0)
    if approaches(scenario)[0]:
        return None
    # slipping ends within an impact, and lifts the body less than the spring's own damper
    return (-1.0, -spring(scenario, contact)[0])


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


def geom_name(body: str, index: int) -> str:
    """Name of the geom that a body's shape becomes."""
    return f"{body}.{index}"


def _text(values: Any) -> str:
    return " ".join(repr(float(value)) for value in values)
