"""The base of engines in space whose bodies all have coordinates of their own."""

import math

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

from simcompare.engine.kinematics import add_children
from simcompare.engine.spatial import SpatialSimulation
from simcompare.kit import (
    JOINTS_AND_FORCES,
    SPATIAL_RIGID_BODIES,
    BodyState,
    EngineBackend,
    Held,
    PipPackage,
)
from simcompare.model import vectors
from simcompare.model.rotations import conjugate, cross, multiply, rotate
from simcompare.model.scenario import Scenario
from simcompare.model.settings import TUNED, Settings
from simcompare.model.trajectory import BODY_SIGNALS

STRAIGHT = (1.0, 0.0, 0.0, 0.0)
SKEW = (0.5, 0.5, -0.1, math.sqrt(0.49))
component = st.floats(-3, 3)
vector = st.tuples(component, component, component)
turn = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: math.hypot(*q) > 0.1)


class Pushed(SpatialSimulation):
    """Bodies that only take impulses: nothing holds them together but what is put on them."""

    def __init__(self, scene):
        super().__init__(scene)
        self.states, self.loads = {}, {name: [] for name in self._bodies}
        self.place_all()

    def get(self, body):
        return self.states[body]

    def put(self, body, state):
        self.states[body] = state

    def push(self, body, force):
        self.loads[body].append((force, (0.0, 0.0, 0.0)))

    def turn(self, body, torque):
        self.loads[body].append(((0.0, 0.0, 0.0), torque))

    def reaction(self, joint):
        return (1.0, 2.0, 3.0)

    def set_engine_step(self, step_s):
        pass

    def take_steps(self, count):
        for _ in range(count):
            for name, state in self.states.items():
                moved = np.array(state.position_m) + self.step_now_s * np.array(state.velocity_m_s)
                half = self.step_now_s * np.array(state.rate_rad_s) / 2
                spun = vectors.multiplied((math.cos(np.linalg.norm(half)), *half), STRAIGHT)
                length = np.linalg.norm(half) or 1.0
                spun = (spun[0], *(math.sin(length) / length * part for part in spun[1:]))
                turned = vectors.multiplied(spun, state.orientation_wxyz)
                self.states[name] = BodyState(
                    tuple(moved.tolist()), turned, state.velocity_m_s, state.rate_rad_s
                )

    def held_of_world(self):
        world = self.scenario.world
        return {
            "step_s": Held("h", world.engine_step_s),
            "gravity_m_s2": Held("g", world.gravity_m_s2),
        }

    def held_of_body(self, body):
        held = self.scenario.bodies[body]
        inertia = np.diag(self.scene.inertia(body)).tolist()
        return {"mass_kg": Held("m", held.mass_kg), "inertia_kg_m2": Held("I", inertia)}

    def held_of_joint(self, joint):
        anchor, axis = self.scene.drawn(joint)
        return {"anchor_m": Held("p", anchor), "axis": Held("a", axis)}


class PushedBackend(EngineBackend):
    name = "pushed"
    library = PipPackage("colorsys", "none", ["numpy"])
    features = SPATIAL_RIGID_BODIES | JOINTS_AND_FORCES
    known_limits = ()
    mapping = "none"

    def make(self, engine, scene):
        return Pushed(scene)


def opened(kind, parent=None, **more):
    """A child on a joint, beside a parent that is turned; nothing is at an origin."""
    parent = parent or {"mass_kg": 2.0, "inertia_kg_m2": [0.3, 0.2, 0.1]}
    joint = {"type": kind, "parent": "base", "child": "arm", "axis": [1, 2, -2]}
    joint["anchor_m"] = [0.2, -0.1, 0.3]
    told = {
        "name": "small",
        "title": "Small",
        "question": "What now?",
        "world": {"duration_s": 1, "step_s": 0.01, "gravity_m_s2": [0, 0, 0]},
        "bodies": {
            "base": {**parent, "position_m": [1, 2, 3], "orientation_wxyz": SKEW},
            "arm": {
                "mass_kg": 1.0,
                "inertia_kg_m2": [0.1, 0.2, 0.25],
                "position_m": [1.5, 2, 2.5],
                "orientation_wxyz": [0.6, 0, 0.8, 0],
            },
        },
        "joints": {"joint": {**joint, **more.pop("joint", {})}},
        **more,
    }
    scenario = Scenario.model_validate(told)
    return PushedBackend().open(scenario, Settings(TUNED))


def carried(simulation, coordinate, rate, base):
    """Motion of the child at a coordinate and rate of its joint, by the core's kinematics."""
    part, speed = {"hinge": ("angle_rad", "rate_rad_s"), "slider": ("position_m", "velocity_m_s")}[
        simulation.scenario.joints["joint"].type
    ]
    signals = {f"base.{name}": np.array([getattr(base, name)]) for name in BODY_SIGNALS}
    signals |= {f"joint.{part}": np.array([coordinate]), f"joint.{speed}": np.array([rate])}
    add_children(simulation.scenario, signals, 1)
    return BodyState(*(tuple(signals[f"arm.{name}"][0].tolist()) for name in BODY_SIGNALS))


@pytest.mark.parametrize("kind", ["hinge", "slider"])
@given(coordinate=st.floats(-20, 20), rate=st.floats(-5, 5), spin=vector, velocity=vector, q=turn)
def test_a_joint_is_read_from_two_bodies_as_they_are_placed(
    kind, coordinate, rate, spin, velocity, q
):
    simulation = opened(kind)
    length = math.hypot(*q)
    base = BodyState((0.3, 0.1, -2.0), tuple(part / length for part in q), velocity, spin)
    state = simulation.state
    bodies = {"base": base, "arm": carried(simulation, coordinate, rate, base)}
    joints = {"joint": (coordinate, rate)}
    told = type(state)(0.0, bodies, state.velocity_step_s, joints)
    simulation.set_state(told)
    held = simulation.state
    assert held.joints["joint"] == pytest.approx((coordinate, rate), abs=1e-12)
    assert held.bodies == bodies


def test_joints_start_at_zero_as_drawn_and_hold_what_was_set():
    simulation = opened("hinge", joint={"rate": 2.0})
    assert simulation.state.joints["joint"] == pytest.approx((0.0, 2.0), abs=1e-12)
    rows = {row.quantity: row for row in simulation.audit}
    assert rows["joint.anchor_m.y"].read_value == pytest.approx(-0.1)
    assert rows["joint.axis.x"].note == "in the child's frame"


@pytest.mark.parametrize("kind", ["hinge", "slider"])
def test_an_effort_acts_alike_on_both_bodies_and_along_one_line(kind):
    simulation = opened(kind)
    simulation.exert("joint", 3.0)
    forces, torques = np.zeros(3), np.zeros(3)
    for name, loads in simulation.loads.items():
        place = np.array(simulation.get(name).position_m)
        for force, torque in loads:
            forces += force
            torques += np.array(torque) + np.cross(place, force)
    np.testing.assert_allclose(forces, 0, atol=1e-12)
    np.testing.assert_allclose(torques, 0, atol=1e-12)
    _, axis = simulation.scene.drawn("joint")
    (force, torque), *_ = simulation.loads["arm"]
    given_to_the_child = force if kind == "slider" else torque
    np.testing.assert_allclose(given_to_the_child, 3 * np.array(axis), atol=1e-12)


def test_an_effort_on_what_hangs_on_a_fixed_body_acts_on_the_child_alone():
    simulation = opened("hinge", parent={"fixed": True})
    simulation.exert("joint", 3.0)
    assert list(simulation.loads) == ["arm"]
    assert len(simulation.loads["arm"]) == 1


def test_the_force_on_a_child_is_in_its_frame_and_holds_the_effort_of_a_slider():
    more = {
        "inputs": {"push": {"signal": "constant", "value": 3.0}},
        "actuators": {"motor": {"type": "force", "joint": "joint", "input": "push"}},
        "sensors": {"gauge": {"type": "force", "joint": "joint"}},
    }
    simulation = opened("slider", **more)
    simulation.step()
    _, axis = simulation.scene.drawn("joint")
    in_world = np.array((1.0, 2.0, 3.0)) + 3 * np.array(axis)
    orientation = simulation.scenario.bodies["arm"].orientation_wxyz
    wanted = vectors.turned_back(orientation, in_world)
    assert simulation.forces() == pytest.approx(wanted)


@given(a=vector, b=vector, p=turn, q=turn)
def test_plain_vectors_are_those_of_whole_recordings(a, b, p, q):
    p, q = ([part / math.hypot(*one) for part in one] for one in (p, q))
    one, other = np.array([a]), np.array([b])
    for found, wanted in (
        (vectors.cross(a, b), cross(one, other)),
        (vectors.plus(a, b), one + other),
        (vectors.minus(a, b), one - other),
        (vectors.times(2.0, a), 2 * one),
        (vectors.turned(p, a), rotate(np.array([p]), one)),
        (vectors.turned_back(p, a), rotate(conjugate(np.array([p])), one)),
        (vectors.multiplied(p, q), multiply(np.array([p]), np.array([q]))),
    ):
        np.testing.assert_allclose(found, wanted[0], atol=1e-12)
    assert vectors.dot(a, b) == pytest.approx(float(np.dot(a, b)), abs=1e-12)
