"""The scenario model: frozen values, checked once; what a backend needs is derived from them."""

from __future__ import annotations

import copy
import pickle

import pytest
import yaml
from pydantic import ValidationError

from simcompare.engine.features import Feature, is_planar, needs
from simcompare.errors import InputError
from simcompare.model.scenario import Body, Scenario, Tolerance
from simcompare.model.shapes import Plane, Pose
from simcompare.model.signals import Ramp, Table
from simcompare.scenarios import scenario_file
from simcompare.scenarios.scenario_checks import faults_between_parts

ROBOT = """\
name: two_wheels
title: Differential drive
question: How fast does the robot turn after a step of torque?
parameters:
  torque_N_m: {value: 0.02, min: 0, max: 1, text: "Height of the step."}
  wheel_radius_m: {value: 3e-2, min: 1e-3, max: 1, text: "Radius of both wheels."}
world: {duration_s: 2, step_s: 0.001}
bodies:
  floor:
    fixed: true
    shapes: [{type: plane}]
  chassis:
    mass_kg: 1.2
    inertia_kg_m2: [0.01, 0.02, 0.02]
    position_m: [0, 0, "${wheel_radius_m}"]
    shapes: [{type: box, size_m: [0.2, 0.1, 0.05], position_m: [0, 0, 0.02]}]
  left_wheel: &wheel
    mass_kg: 0.05
    inertia_kg_m2: [2e-5, 2e-5, 4e-5]
    position_m: [0, 0.08, "${wheel_radius_m}"]
    # the cylinder's own z axis is turned to y
    orientation_wxyz: [0.7071067811865476, 0.7071067811865476, 0, 0]
    shapes: [{type: cylinder, radius_m: "${wheel_radius_m}", length_m: 0.02}]
  right_wheel:
    <<: *wheel
    position_m: [0, -0.08, "${wheel_radius_m}"]
joints:
  left: {type: hinge, parent: chassis, child: left_wheel, anchor_m: [0, 0.08, 0], axis: [0, 1, 0]}
  right:
    {type: hinge, parent: chassis, child: right_wheel, anchor_m: [0, -0.08, 0], axis: [0, 1, 0],
     damping: 1e-4}
actuators:
  left_motor: {type: torque, joint: left, input: left_torque}
  right_motor: {type: torque, joint: right, input: right_torque}
inputs:
  left_torque: {signal: step, after: "${torque_N_m}", time_s: 0.5}
  right_torque: {signal: step, after: "${-torque_N_m}", time_s: 0.5}
sensors:
  imu: {type: accelerometer, body: chassis, position_m: [0, 0, 0.03]}
  left_encoder: {type: encoder, joint: left, marks: 20}
contacts:
  - {pair: [left_wheel, floor], friction: 0.8}
  - {pair: [right_wheel, floor], friction: 0.8}
probes:
  yaw_rate_rad_s: {observe: chassis.rate_rad_s, component: 2, label: Yaw rate, unit: rad/s}
"""


def plain(**changes):
    """A smallest scenario as a tree, with changes."""
    return {
        "name": "toy",
        "title": "Toy",
        "question": "Does it move?",
        "world": {"duration_s": 1.0},
        "bodies": {"ball": {"mass_kg": 1.0, "inertia_kg_m2": [1.0, 1.0, 1.0]}},
        **changes,
    }


@pytest.fixture
def robot(write):
    return scenario_file.read(write("two_wheels.yaml", ROBOT)).resolve()


def test_a_robot_loads(robot):
    assert robot.bodies["chassis"].position_m == (0.0, 0.0, 0.03)
    assert robot.bodies["right_wheel"].shapes[0].radius_m == 0.03
    assert robot.inputs["right_torque"].after == -0.02
    assert robot.contact_of("floor", "left_wheel").friction == 0.8
    assert robot.contact_of("floor", "chassis").friction == 0.0
    assert list(robot.moving_bodies()) == ["chassis", "left_wheel", "right_wheel"]


def test_what_a_robot_needs_is_derived_from_its_content(robot):
    assert needs(robot).required == {
        Feature.SPATIAL,
        Feature.FREE_BODY,
        Feature.PLANE,
        Feature.BOX,
        Feature.CYLINDER,
        Feature.FRICTION,
        Feature.HINGE,
        Feature.EFFORT,
    }


def test_needs_shrink_with_the_content():
    ball = {
        "mass_kg": 1.0,
        "inertia_kg_m2": [1.0] * 3,
        "shapes": [{"type": "sphere", "radius_m": 1}],
    }
    drag = {"coefficient": 0.5, "area_m2": 1.0, "air_density_kg_m3": 0.0}
    scenario = Scenario.model_validate(plain(bodies={"ball": {**ball, "drag": drag}}))
    assert needs(scenario).required == {Feature.FREE_BODY, Feature.SPHERE}, "no air, no drag"
    drag["air_density_kg_m3"] = 1.2
    contacts = [{"pair": ["ball", "floor"], "restitution": 0.5}]
    bodies = {
        "ball": {**ball, "drag": drag},
        "floor": {"fixed": True, "shapes": [{"type": "plane"}]},
    }
    scenario = Scenario.model_validate(plain(bodies=bodies, contacts=contacts))
    assert needs(scenario).required == {
        Feature.FREE_BODY,
        Feature.SPHERE,
        Feature.PLANE,
        Feature.DRAG,
        Feature.RESTITUTION,
    }


@pytest.mark.parametrize(
    ("body", "planar"),
    [
        ({}, True),
        ({"velocity_m_s": [1, 0, 1], "rate_rad_s": [0, 5, 0]}, True),
        ({"velocity_m_s": [0, 1, 0]}, False),
        ({"position_m": [0, 0.1, 0]}, False),
        ({"rate_rad_s": [1, 0, 0]}, False),
        ({"orientation_wxyz": [0.6, 0, 0.8, 0]}, True),
        ({"orientation_wxyz": [0.6, 0.8, 0, 0]}, False),
    ],
)
def test_motion_in_the_x_z_plane_is_seen(body, planar):
    whole = {"mass_kg": 1.0, "inertia_kg_m2": [1.0] * 3, **body}
    assert is_planar(Scenario.model_validate(plain(bodies={"ball": whole}))) is planar


def test_a_scenario_is_frozen():
    scenario = Scenario.model_validate(plain())
    with pytest.raises(ValidationError, match="frozen"):
        scenario.title = "other"
    with pytest.raises(ValidationError, match="frozen"):
        scenario.bodies["ball"].mass_kg = 2.0
    with pytest.raises(ValidationError, match="frozen"):
        scenario.world.step_s = 1.0


def test_a_scenario_keeps_nothing_of_the_tree_it_came_from():
    tree = plain(parameters={"a_m": 1.0})
    before = copy.deepcopy(tree)
    scenario = Scenario.model_validate(tree)
    tree["parameters"]["a_m"] = 2.0
    tree["bodies"].clear()
    assert scenario == Scenario.model_validate(before)


def test_a_scenario_travels_to_another_process(robot):
    assert pickle.loads(pickle.dumps(robot)) == robot


def test_all_faults_are_reported_at_once():
    tree = plain(
        name="Toy",
        world={"duration_s": -1, "gravity_m_s2": [0, 0]},
        bodies={"ball": {"mass_kg": float("nan"), "inertia_kg_m2": [1, 1, 1], "colour": "red"}},
    )
    with pytest.raises(ValidationError) as error:
        Scenario.model_validate(tree)
    assert set(scenario_file.faults_of(error.value)) == {
        "name",
        "world.duration_s",
        "world.gravity_m_s2.2",
        "bodies.ball.mass_kg",
        "bodies.ball.colour",
    }


@pytest.mark.parametrize("wxyz", [(1, 1, 0, 0), (0, 0, 0, 0), (0.999, 0, 0, 0)])
def test_an_orientation_that_is_no_rotation_is_refused(wxyz):
    with pytest.raises(ValidationError, match="a rotation has length 1"):
        Pose(orientation_wxyz=wxyz)
    assert Pose(orientation_wxyz=(0.6, 0, 0, -0.8)).orientation_wxyz[3] == -0.8


def test_a_tolerance_is_relative_or_absolute_or_the_larger_of_both():
    reason = "because it is so"
    with pytest.raises(ValidationError, match="give relative, absolute, or both"):
        Tolerance(reason=reason)
    both = Tolerance(relative=0.1, absolute=0.2, reason=reason)
    assert both.width(0.0) == 0.2
    assert both.width(-5.0) == 0.5


def test_a_tolerance_needs_a_reason_and_has_a_width():
    with pytest.raises(ValidationError, match="reason"):
        Tolerance(relative=0.1, reason="so")
    assert Tolerance(relative=0.1, reason="because it is so").width(-5.0) == 0.5
    assert Tolerance(absolute=0.1, reason="because it is so").width(-5.0) == 0.1


def test_a_signal_table_is_sorted_and_complete():
    assert Table(signal="table", time_s=(0, 1), value=(5, 6)).value == (5.0, 6.0)
    with pytest.raises(ValidationError, match=r"time_s\[2\] = 0.5 is not later"):
        Table(signal="table", time_s=(0, 1, 0.5), value=(1, 2, 3))
    with pytest.raises(ValidationError, match=r"time_s\[1\]"):
        Table(signal="table", time_s=(0, 0), value=(1, 2))
    with pytest.raises(ValidationError, match="2 times but 3 values"):
        Table(signal="table", time_s=(0, 1), value=(1, 2, 3))
    with pytest.raises(ValidationError, match="end_s = 1 is not later than start_s = 2"):
        Ramp(signal="ramp", end=1, start_s=2, end_s=1)


def test_a_moving_body_needs_mass_and_inertia():
    with pytest.raises(ValidationError, match="needs mass_kg and inertia_kg_m2"):
        Body(mass_kg=1.0)
    assert Body(fixed=True).mass_kg is None


def test_every_dangling_reference_is_named_with_its_place():
    tree = yaml.safe_load(ROBOT.replace("${wheel_radius_m}", "0.03").replace("torque_N_m}", ""))
    del tree["parameters"], tree["inputs"]
    tree["inputs"] = {"left_torque": {"signal": "constant", "value": 1}}
    tree["joints"]["left"]["child"] = "wheel"
    tree["actuators"]["left_motor"]["joint"] = "middle"
    tree["sensors"]["imu"]["body"] = "head"
    tree["contacts"][1]["pair"] = ["right_wheel", "flour"]
    tree["probes"]["yaw_rate_rad_s"]["observe"] = "chasis.rate_rad_s"
    tree["measures"] = [{"function": "bounces", "probe": "yaw"}]
    tree["dither"] = {"parameter": "height_m", "span": 1, "reason": "none"}
    faults = faults_between_parts(Scenario.model_validate(tree))
    assert set(faults) == {
        "joints.left.child",
        "actuators.left_motor.joint",
        "actuators.right_motor.input",
        "sensors.imu.body",
        "contacts.1.pair",
        "probes.yaw_rate_rad_s.observe",
        "measures.0.probe",
        "dither.parameter",
    }
    assert "'flour'" in faults["contacts.1.pair"]
    assert "floor" in faults["contacts.1.pair"], "what there is instead"


def probe(observe, component):
    return {"observe": observe, "component": component, "label": "h", "unit": "m"}


def wheel(**changes):
    return {"type": "hinge", "parent": "floor", "child": "ball", **changes}


@pytest.mark.parametrize(
    ("place", "changes"),
    [
        ("joints.j.axis", {"joints": {"j": wheel(axis=[0, 0, 0])}}),
        ("joints.j", {"joints": {"j": wheel(lower=1.0, upper=-1.0)}}),
        ("joints.j", {"joints": {"j": wheel(parent="ball")}}),
        ("contacts.0", {"contacts": [{"pair": ["ball", "ball"]}]}),
        (
            "contacts.1",
            {
                "contacts": [
                    {"pair": ["ball", "floor"], "restitution": 0.1},
                    {"pair": ["floor", "ball"], "restitution": 0.9},
                ]
            },
        ),
        ("sensors.s", {"sensors": {"s": {"type": "accelerometer"}}}),
        ("sensors.s", {"sensors": {"s": {"type": "encoder", "body": "ball"}}}),
        (
            "measures.0.function",
            {
                "probes": {"h": probe("ball.position_m", 2)},
                "measures": [{"function": "bounce", "probe": "h"}],
            },
        ),
        ("probes.h.observe", {"probes": {"h": probe("ball.hight_m", None)}}),
        ("probes.h", {"probes": {"h": probe("ball.position_m", 3)}}),
        (
            "tolerances.restitutoin",
            {"tolerances": {"restitutoin": {"relative": 0.1, "reason": "because it is so"}}},
        ),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_no_engine_could_run_or_no_score_could_meet_is_refused_on_reading(
    place, changes, write
):
    """Else it is found after all engines have run, or a mistyped tolerance is never judged."""
    tree = plain(**changes)
    tree["bodies"]["floor"] = {"fixed": True, "shapes": [{"type": "plane"}]}
    with pytest.raises(InputError, match=place.replace(".", r"\.")):
        scenario_file.read(write("toy.yaml", yaml.safe_dump(tree)))


def test_a_plane_needs_a_normal():
    with pytest.raises(ValidationError):
        Plane(type="plane", normal=(0, 0, 0))


def test_moments_of_inertia_obey_the_triangle_inequality():
    """No distribution of mass has I_z > I_x + I_y; engines reject it or go wrong in silence."""
    with pytest.raises(ValidationError):
        Body(mass_kg=1.0, inertia_kg_m2=(1.0, 1.0, 5.0))


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"fixed": True, "mass_kg": 1.0}, "a fixed body has no mass"),
        ({"fixed": True, "velocity_m_s": [1, 0, 0]}, "neither velocity nor drag"),
        (
            {"mass_kg": 1, "inertia_kg_m2": [1, 1, 1], "shapes": [{"type": "plane"}]},
            "a plane is half of all space",
        ),
        (
            {"mass_kg": 1, "inertia_kg_m2": [1, 1, 1], "center_of_mass_m": [0, 0, 0.1],
             "drag": {"coefficient": 0.5, "area_m2": 1, "air_density_kg_m3": 1}},
            "centre of mass is at their origin",
        ),
    ],
)  # fmt: skip
def test_what_no_engine_would_apply_is_refused_on_a_body(body, words):
    with pytest.raises(ValidationError, match=words):
        Body.model_validate(body)


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        ({"inputs": {"u": {"signal": "constant", "value": 1}}}, "inputs.u", "no actuator follows"),
        ({"contacts": [{"pair": ["frame", "disk"]}]}, "contacts.0", "never touch: hinge joins"),
        ({"sensors": {"f": {"type": "contact_force", "pair": ["disk", "floor"]}}}, "sensors.f",
         "disk cannot touch anything without a shape"),
        ({"probes": {"p": {"observe": "hinge.angle_rad", "label": "x", "unit": "deg"}}},
         "probes.p", "angle_rad is in rad, not in deg"),
    ],
)  # fmt: skip
def test_what_would_have_no_effect_is_told(change, place, words):
    from simcompare.scenarios.scenario_checks import faults_between_parts

    disk = {"mass_kg": 1, "inertia_kg_m2": [1, 1, 1]}
    bodies = {"frame": {"fixed": True}, "disk": disk, "floor": {"fixed": True,
              "shapes": [{"type": "plane"}]}}  # fmt: skip
    joints = {"hinge": {"type": "hinge", "parent": "frame", "child": "disk", "axis": [0, 1, 0]}}
    scenario = Scenario.model_validate({**plain(), "joints": joints, **change, "bodies": bodies})
    assert words in faults_between_parts(scenario)[place]


@pytest.mark.parametrize(
    "sensor",
    [
        {"type": "force", "joint": "j", "position_m": [0, 0, 1]},
        {"type": "encoder", "joint": "j", "marks": 4, "orientation_wxyz": [0, 1, 0, 0]},
    ],
)
def test_a_sensor_of_a_joint_has_no_pose_of_its_own(sensor):
    from simcompare.model.sensor import Sensor

    with pytest.raises(ValidationError, match="no pose of its own"):
        Sensor.model_validate(sensor)
