"""A scene as MJCF, the text that MuJoCo compiles; written without MuJoCo itself."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from xml.etree import ElementTree as ET

from simcompare.backends.mujoco.variants import ELLIPTIC, VARIANTS, Choice
from simcompare.kit import TUNED, Pair, Scene, SceneJoint, Shape, sizes_m

#: impedance, alike at every depth; at 1 accelerations would be exactly those of spring and damper
SOLIMP = (0.9999, 0.9999, 0.001)
SOLIMP_NAMES = ("solimp.dmin", "solimp.dmax", "solimp.width")
#: of the friction of joints: time constant [s] and damping ratio, and the impedance
JOINT_FRICTION = {"solreffriction": (0.005, 1.0), "solimpfriction": SOLIMP}
#: time constant of a contact that does not bounce [s]
DEAD_CONTACT_S = 0.005
#: most points of contact that MuJoCo finds between two shapes (two boxes)
SHAPE_POINTS = 8


def mjcf(scene: Scene) -> str:
    """The scene as MJCF, with as much of it as the level gives."""
    world = scene.scenario.world
    root = ET.Element("mujoco", model=scene.scenario.name)
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    # dense: the sparse Cholesky of 4.0.0 could give a wrong Hessian (google-deepmind/mujoco 3767)
    option = ET.SubElement(
        root, "option", gravity=_text(world.gravity_m_s2), timestep=repr(world.engine_step_s),
        jacobian="dense",
    )  # fmt: skip
    for choice in choices_of(scene).values():
        option.set(choice.option, choice.word)
    # by default MuJoCo starts anew when numbers run away, as if nothing had happened
    ET.SubElement(option, "flag", autoreset="disable")
    _add_bodies(ET.SubElement(root, "worldbody"), scene)
    contacts = ET.SubElement(root, "contact")
    for first, second in scene.contacts.apart:
        ET.SubElement(contacts, "exclude", body1=first, body2=second)
    alike: dict[object, dict[str, str]] = {}
    for pair in scene.contacts.touching if scene.contacts.are_given else ():
        kind = (pair.restitution, pair.friction, pair.numbers, pair.friction_spring)
        if kind not in alike:  # many pairs of a scene are
            alike[kind] = _contact(scene, pair)
        for name, (one, other) in pair_names(scene, pair).items():
            ET.SubElement(
                contacts, "pair", {"name": name, "geom1": one, "geom2": other, **alike[kind]}
            )
    _add_actuators(ET.SubElement(root, "actuator"), scene)
    _add_sensors(ET.SubElement(root, "sensor"), scene)
    return ET.tostring(root, encoding="unicode")


def choices_of(scene: Scene) -> dict[str, Choice]:
    """What is chosen in ``<option>`` by what it is called: that of tuned, and the variant's."""
    found = [ELLIPTIC] if scene.gives(TUNED) else []
    found += [VARIANTS[scene.variant].value] if scene.variant else []
    return {choice.option: choice for choice in found}


def _add_bodies(worldbody: ET.Element, scene: Scene) -> None:
    """Bodies inside one another as joints carry them; only those that stand alone are free."""
    bodies = scene.scenario.bodies
    carrying = {joint.joint.child: joint for joint in scene.joints.values()}
    elements: dict[str, ET.Element] = {}
    for name in [*scene.roots, *carrying]:
        body, joint = bodies[name], carrying.get(name)
        parent = worldbody if joint is None else elements[joint.joint.parent]
        place = body if joint is None else joint.mount
        element = elements[name] = ET.SubElement(
            parent, "body", name=name, pos=_text(place.position_m),
            quat=_text(place.orientation_wxyz),
        )  # fmt: skip
        if joint is not None:
            _add_joint(element, scene, joint)
        elif not body.fixed:
            ET.SubElement(element, "freejoint", name=name)
        if not body.fixed:
            ET.SubElement(
                element, "inertial", pos=_text(body.center_of_mass_m), mass=repr(body.mass_kg),
                diaginertia=_text(body.inertia_kg_m2 or ()),
            )  # fmt: skip
        for i, shape in enumerate(scene.shapes[name]):
            ET.SubElement(element, "geom", {"name": geom_name(name, i), **shape_attributes(shape)})


def _add_joint(element: ET.Element, scene: Scene, joint: SceneJoint) -> None:
    """Adds a joint to its child, where it can move, and places for what senses its force."""
    for sensor, sensed in scene.scenario.sensed_joints().items():
        if sensed == joint.name:
            ET.SubElement(element, "site", name=sensor)
    own = joint.own
    friction = JOINT_FRICTION if scene.gives(TUNED) and own.friction else {}
    if joint.is_movable:
        ET.SubElement(
            element, "joint", name=joint.name, type=joint.joint.type.replace("slider", "slide"),
            pos=_text(joint.mount.anchor_m), axis=_text(joint.mount.axis),
            stiffness=repr(own.stiffness), springref=repr(own.rest), damping=repr(own.damping),
            frictionloss=repr(own.friction), armature=repr(own.armature),
        ).attrib.update(_texts(friction))  # fmt: skip


def _add_actuators(actuators: ET.Element, scene: Scene) -> None:
    """One for each driven joint; its control is the part of the effort that follows the inputs."""
    for name in scene.scenario.movable_joints():  # in the order in which efforts are given
        joint, damping = scene.joints[name], scene.joints[name].actuator_damping
        if joint.law.is_driven:
            ET.SubElement(
                actuators, "general", name=name, joint=name, gainprm="1", biastype="affine",
                biasprm=_text((0, 0, 0 - damping)),
            )  # fmt: skip


def _add_sensors(sensors: ET.Element, scene: Scene) -> None:
    """The sensors that read the engine's own forces."""
    for name in scene.scenario.sensed_joints():
        ET.SubElement(sensors, "force", name=name, site=name)
    for name, (first, second) in scene.scenario.sensed_pairs().items():
        # as many points of contact as there can be, whose normal forces are added up
        points = SHAPE_POINTS * len(scene.shapes[first]) * len(scene.shapes[second])
        ET.SubElement(
            sensors, "contact", name=name, body1=first, body2=second, data="force", num=str(points)
        )


def _contact(scene: Scene, pair: Pair) -> dict[str, str]:
    """What a ``<pair>`` says of a contact."""
    mu = pair.friction
    return {
        "condim": "3" if mu > 0 else "1",
        "friction": _text((mu, mu, 0.005, 0.0001, 0.0001)),
        **_texts(springs_of(scene, pair)),
    }


def springs_of(scene: Scene, pair: Pair) -> dict[str, tuple[float, ...]]:
    """MuJoCo's own numbers for a pair by their names, as far as the level gives them.

    ``solref`` is (-stiffness, -damping), both per unit of mass, or else the time constant [s] and
    damping ratio; ``solreffriction`` is the same for friction where it has a spring of its own.
    """
    if not scene.gives(TUNED):  # what somebody typed in, in an engine that is else as it comes
        return {"solref": pair.numbers} if len(pair.numbers) == 2 else {}
    # critically damped; MuJoCo takes no shorter time than two steps
    dead = (max(DEAD_CONTACT_S, 2 * scene.scenario.world.engine_step_s), 1.0)
    solimp = tuple(map(scene.settings.typed, SOLIMP_NAMES, SOLIMP))
    found = {"solref": pair.numbers if pair.restitution > 0 else dead, "solimp": solimp}
    if pair.friction > 0 and pair.restitution > 0:
        # friction with the spring that bounces would let go long before the slip has ended
        found["solreffriction"] = pair.friction_spring or dead
    return found


def pair_names(scene: Scene, pair: Pair) -> dict[str, tuple[str, str]]:
    """Name of every ``<pair>`` of two bodies and the two geoms in it."""
    first, second = (
        [geom_name(name, i) for i in range(len(scene.shapes[name]))] for name in pair.bodies
    )
    return {f"{one}-{other}": (one, other) for one in first for other in second}


def shape_attributes(shape: Shape) -> dict[str, str]:
    """Type, place and size of a geom, as MJCF says them."""
    # of all lengths but radii MuJoCo takes the half
    sizes = [size if name == "radius_m" else size / 2 for name, size in sizes_m(shape).items()]
    found = {"type": shape.type, "pos": _text(shape.position_m)}
    if shape.type == "plane":
        return {**found, "size": "0 0 1", "zaxis": _text(shape.normal)}
    return {**found, "size": _text(sizes), "quat": _text(shape.orientation_wxyz)}


def geom_name(body: str, index: int) -> str:
    """Name of the geom that a body's shape becomes."""
    return f"{body}.{index}"


def _text(values: Iterable[float]) -> str:
    return " ".join(map(repr, map(float, values)))


def _texts(values: Mapping[str, Iterable[float]]) -> dict[str, str]:
    return {name: _text(numbers) for name, numbers in values.items()}
