"""Backends that lie: a real one, of which a lie changes the scene before or the signals after."""

import dataclasses
import itertools
import math

import numpy as np

from simcompare.engine.range_sensing import zone_rays
from simcompare.model.rotations import conjugate, matrix_of, multiply, quaternions_of, rotate
from simcompare.model.scenario import Contact, Drag


@dataclasses.dataclass(frozen=True)
class Lie:
    """What a wrong adapter does, and the physics check that must notice it.

    Args:
        caught_by: name of the check.
        scene: scenario -> the scenario that is simulated in its place.
        told: (signals, scenario) -> signals that are told in place of the true ones.
        spatial: whether it shows only where motion leaves the plane.
    """

    caught_by: str
    scene: object = lambda scenario: scenario
    told: object = lambda signals, scenario: {}
    spatial: bool = False


class Liar:
    """A backend that tells some lies, and is honest without any."""

    def __init__(self, backend, *lies):
        self._backend, self._lies = backend, lies
        self.name, self.features, self.helps = backend.name, backend.features, backend.helps
        self.known_limits, self.mapping = backend.known_limits, backend.mapping

    def version(self):
        return self._backend.version()

    def open(self, scenario, settings):
        return self._backend.open(scenario, settings)

    def simulate(self, scenario, settings):
        simulated = scenario
        for lie in self._lies:
            simulated = lie.scene(simulated)
        run = self._backend.simulate(simulated, settings)
        for lie in self._lies:
            told = {**run.signals, **lie.told(run.signals, scenario)}
            run = dataclasses.replace(run, signals=told)
        return run


# --- how scenes are changed -----------------------------------------------------------------------


def every(part, **changes):
    """Changes in every body, joint and so on; a change is a function of the part."""

    def change(one):
        return one.model_copy(update={name: make(one) for name, make in changes.items()})

    def scene(scenario):
        parts = getattr(scenario, part)
        if isinstance(parts, tuple):
            return scenario.model_copy(update={part: tuple(map(change, parts))})
        return scenario.model_copy(update={part: {n: change(one) for n, one in parts.items()}})

    return scene


def every_moving_body(**changes):
    def scene(scenario):
        changed = every("bodies", **changes)(
            scenario.model_copy(update={"bodies": scenario.moving_bodies()})
        )
        return scenario.model_copy(update={"bodies": {**scenario.bodies, **changed.bodies}})

    return scene


def gravity_flipped(axis):
    def scene(scenario):
        gravity = list(scenario.world.gravity_m_s2)
        gravity[axis] = -gravity[axis]
        world = scenario.world.model_copy(update={"gravity_m_s2": tuple(gravity)})
        return scenario.model_copy(update={"world": world})

    return scene


def friction_combined(rule):
    """Every body has the largest friction of its pairs; two have what a rule makes of theirs."""

    def scene(scenario):
        own = {}
        for contact in scenario.contacts:
            for body in contact.pair:
                own[body] = max(own.get(body, 0.0), contact.friction)
        return every("contacts", friction=lambda c: rule(*(own[body] for body in c.pair)))(scenario)

    return scene


def everything_touches(scenario):
    named = [set(contact.pair) for contact in scenario.contacts]
    pairs = [p for p in itertools.combinations(scenario.bodies, 2) if set(p) not in named]
    more = tuple(Contact(pair=pair) for pair in pairs)
    return scenario.model_copy(update={"contacts": scenario.contacts + more})


def axes_in_the_worlds_frame(scenario):
    def axis(joint):
        parent = matrix_of(scenario.bodies[joint.parent].orientation_wxyz)
        return tuple((parent.T @ joint.axis).tolist())

    return every("joints", axis=axis)(scenario)


def sliders_reversed(scenario):
    sliding = {name for name, joint in scenario.joints.items() if joint.type == "slider"}
    sign = every("actuators", gear=lambda a: -a.gear if a.joint in sliding else a.gear)
    return sign(scenario)


def mean_moment(body):
    return (sum(body.inertia_kg_m2) / 3,) * 3


def halved(body):
    spheres = {"sphere": lambda s: s.model_copy(update={"radius_m": s.radius_m / 2})}
    return tuple(spheres.get(shape.type, lambda s: s)(shape) for shape in body.shapes)


def halved_in_sight(body):
    """Fixed round shapes with half their radius."""
    if not body.fixed:
        return body.shapes
    return tuple(
        s.model_copy(update={"radius_m": s.radius_m / 2}) if hasattr(s, "radius_m") else s
        for s in body.shapes
    )


def friction_pyramid(scenario):
    """Friction along each axis by itself, so that there is more of it aslant."""

    def stronger(contact):
        velocity = np.array(scenario.bodies[contact.pair[0]].velocity_m_s)
        size = np.linalg.norm(velocity)
        return contact.friction * (np.abs(velocity).sum() / size if size else 1.0)

    return every("contacts", friction=stronger)(scenario)


def damped(scenario):
    """Slowed by 4 % of 1 m/s in a second, as by an engine's damping that nobody switched off."""
    if scenario.joints:  # drag is for bodies that fly
        return scenario
    return every_moving_body(
        drag=lambda b: Drag(coefficient=1.0, area_m2=1.0, air_density_kg_m3=0.08 * b.mass_kg)
    )(scenario)


# --- how signals are changed ----------------------------------------------------------------------


def each(part, make):
    """Changes every signal of a name; ``make(values, orientation of its body, or None)``."""

    def told(signals, scenario):
        joints = {f"{n}.force_N": scenario.joints[s.joint].child
                  for n, s in scenario.sensors.items() if s.type == "force"}  # fmt: skip
        found = {}
        for name, values in signals.items():
            owner, what = name.rsplit(".", 1)
            is_effort = what == "force_N" and name not in joints
            if what == part and not is_effort:
                turn = signals.get(f"{joints.get(name, owner)}.orientation_wxyz")
                found[name] = make(values, turn)
        return found

    return told


def to_body_frame(values, turn):
    return rotate(conjugate(turn), values)


def to_world_frame(values, turn):
    return rotate(turn, values)


def pictures(make):
    """Changes what range sensors read; ``make`` is given it as (n, rows, columns)."""

    def told(signals, scenario):
        return {
            name: make(values.reshape(-1, 8, 8)).reshape(len(values), -1)
            for name, values in signals.items()
            if name.endswith(".range_m")
        }

    return told


RAY_LENGTHS = np.linalg.norm(zone_rays(8)[:, 0], axis=1).reshape(8, 8)


def wrapped(values, turn):
    return (values + math.pi) % (2 * math.pi) - math.pi


def hinges_flipped(signals, scenario):
    parts = ("angle_rad", "rate_rad_s")
    hinges = [name for name, joint in scenario.joints.items() if joint.type == "hinge"]
    return {f"{name}.{part}": -signals[f"{name}.{part}"] for name in hinges for part in parts}


def no_gyroscopic_term(signals, scenario):
    """Bodies that only fly keep their rate, as where ω × I·ω is left out."""
    if scenario.joints or scenario.contacts:
        return {}
    found = {}
    for name in scenario.free_bodies():
        turns, rates = signals[f"{name}.orientation_wxyz"], signals[f"{name}.rate_rad_s"]
        steps = np.arange(len(turns))[:, None] * scenario.world.step_s
        found[f"{name}.rate_rad_s"] = np.tile(rates[0], (len(rates), 1))
        start = np.tile(turns[0], (len(turns), 1))
        found[f"{name}.orientation_wxyz"] = multiply(quaternions_of(steps * rates[0]), start)
    return found


def contacts_swapped(signals, scenario):
    names = [
        f"{n}.normal_force_N" for n, s in scenario.sensors.items() if s.type == "contact_force"
    ]
    return {name: signals[other] for name, other in zip(names, reversed(names), strict=True)}


#: the five with which a backend once passed the whole contract
FIVE = {
    "no friction": Lie("friction_brakes", every("contacts", friction=lambda c: 0.0)),
    "no restitution": Lie(
        "bounces_by_its_restitution", every("contacts", restitution=lambda c: 0.0)
    ),
    "joint forces times -3": Lie(
        "weld_bears_the_weight", told=each("force_N", lambda v, turn: -3 * v)
    ),
    "contact forces of 42 N": Lie(
        "stack_stands", told=each("normal_force_N", lambda v, turn: np.full(len(v), 42.0))
    ),
    "sliders pushed backwards": Lie("slider_goes_where_it_is_pushed", sliders_reversed),
}

#: others that an adapter would really commit
FURTHER = {
    "velocity in the body's frame": Lie(
        "flies_and_turns_in_the_plane", told=each("velocity_m_s", lambda v, turn: (
            v if turn is None else to_body_frame(v, turn)))
    ),
    "rate in the body's frame": Lie(
        "tumbles_with_its_momentum", spatial=True,
        told=each("rate_rad_s", lambda v, turn: v if turn is None else to_body_frame(v, turn)),
    ),
    "quaternion as xyzw": Lie(
        "flies_and_turns_in_the_plane",
        told=each("orientation_wxyz", lambda v, turn: np.roll(v, -1, axis=1)),
    ),
    "orientation inverted": Lie(
        "flies_and_turns_in_the_plane", told=each("orientation_wxyz", lambda v, turn: conjugate(v))
    ),
    "gravity flipped along x": Lie("flies_and_turns_in_the_plane", gravity_flipped(0)),
    "gravity flipped along y": Lie("flies_and_turns_in_space", gravity_flipped(1), spatial=True),
    "gravity flipped along z": Lie("flies_and_turns_in_the_plane", gravity_flipped(2)),
    "inertia of a sphere": Lie(
        "hinge_turns_as_it_is_pushed", every_moving_body(inertia_kg_m2=mean_moment)
    ),
    "inertia of a sphere, in space": Lie(
        "tumbles_with_its_momentum", every_moving_body(inertia_kg_m2=mean_moment), spatial=True
    ),
    "no gyroscopic term": Lie(
        "tumbles_with_its_momentum", told=no_gyroscopic_term, spatial=True
    ),
    "frictions averaged": Lie("friction_brakes", friction_combined(lambda a, b: (a + b) / 2)),
    "frictions multiplied": Lie("friction_brakes", friction_combined(lambda a, b: a * b)),
    "root of frictions' product": Lie(
        "friction_brakes", friction_combined(lambda a, b: math.sqrt(a * b))
    ),
    "larger friction of two": Lie("friction_brakes", friction_combined(max)),
    "friction as a pyramid": Lie(
        "friction_brakes_in_all_directions", friction_pyramid, spatial=True
    ),
    "restitution squared": Lie(
        "bounces_by_its_restitution", every("contacts", restitution=lambda c: c.restitution**2)
    ),
    "momentum of balls without restitution": Lie(
        "balls_share_their_momentum", every("contacts", restitution=lambda c: 0.0)
    ),
    "angle of hinges flipped": Lie("hinge_turns_as_it_is_pushed", told=hinges_flipped),
    "angle of hinges wrapped": Lie("hinge_turns_as_it_is_pushed", told=each("angle_rad", wrapped)),
    "contact forces doubled": Lie(
        "stack_stands", told=each("normal_force_N", lambda v, turn: 2 * v)
    ),
    "contact forces of the wrong pair": Lie("stack_stands", told=contacts_swapped),
    "joint forces in the world's frame": Lie(
        "weld_bears_the_weight", told=each("force_N", to_world_frame)
    ),
    "joint forces on the parent": Lie(
        "weld_bears_the_weight", told=each("force_N", lambda v, turn: -v)
    ),
    "start velocity dropped": Lie(
        "flies_and_turns_in_the_plane", every_moving_body(velocity_m_s=lambda b: (0.0, 0.0, 0.0))
    ),
    "start rate of hinges dropped": Lie(
        "hinge_turns_as_it_is_pushed", every("joints", rate=lambda j: 0.0)
    ),
    "gear left out": Lie("slider_goes_where_it_is_pushed", every("actuators", gear=lambda a: 1.0)),
    "axes in the world's frame": Lie("slider_goes_where_it_is_pushed", axes_in_the_worlds_frame),
    "axes in the world's frame, in space": Lie(
        "hinge_has_its_axis_in_the_parents_frame", axes_in_the_worlds_frame, spatial=True
    ),
    "no friction of joints": Lie(
        "motor_works_against_friction", every("joints", friction=lambda j: 0.0)
    ),
    "friction of joints doubled": Lie(
        "motor_works_against_friction", every("joints", friction=lambda j: 2 * j.friction)
    ),
    "diameter for radius": Lie(
        "stays_down_without_restitution", every_moving_body(shapes=halved)
    ),
    "ranges along the rays": Lie(
        "range_sensor_sees_a_floor_and_a_wall", told=pictures(lambda v: v * RAY_LENGTHS),
        spatial=True,
    ),
    "picture mirrored": Lie(
        "range_sensor_sees_a_floor_and_a_wall", told=pictures(lambda v: v[:, :, ::-1]),
        spatial=True,
    ),
    "picture upside down": Lie(
        "range_sensor_sees_a_floor_and_a_wall", told=pictures(lambda v: v[:, ::-1]), spatial=True
    ),
    "range sensor in the middle of its body": Lie(
        "range_sensor_sees_a_floor_and_a_wall", spatial=True,
        scene=every("sensors", position_m=lambda s: (0.0, 0.0, 0.0)),
    ),
    "round things half as large": Lie(
        "range_sensor_sees_round_things", every("bodies", shapes=halved_in_sight), spatial=True
    ),
    "damping left on": Lie("strangers_pass_through", damped),
    "unnamed pairs touch": Lie("strangers_pass_through", everything_touches),
}  # fmt: skip
