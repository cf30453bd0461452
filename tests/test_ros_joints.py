"""Joints in ROS logs: their units by what they are, and one line where nothing says that."""

from __future__ import annotations

import re

import numpy as np
import pytest
import yaml

from simcompare.errors import InputError
from simcompare.hardware import importing, joints
from simcompare.hardware import mapping as mappings
from simcompare.hardware.logs import profiles
from tests.ros_bags import CONTAINERS, Bag, joint_state, times

pytest.importorskip("rosbags")
STATE = "sensor_msgs/msg/JointState"
URDF = """<robot name="arm"><joint type="continuous" name="turn"><axis xyz="0 0 1"/></joint>
<joint name='lift' type='prismatic'/><joint name="plate" type="fixed"/>
<transmission><joint name="turn"/></transmission></robot>"""


@pytest.fixture(params=CONTAINERS)
def bag(request, tmp_path):
    return Bag(tmp_path, request.param)


def states(bag):
    return [
        (ns, joint_state(bag, ns, ["turn", "lift"], [0.1 * i, 0.2], [1.0, 0.1], [2.0, 3.0]))
        for i, ns in enumerate(times())
    ]


def read(path, **keys):
    return importing.read(path, mappings.Mapping.model_validate(keys))


def units_of(recording):
    (stream,) = recording.streams.values()
    return {name: channel.unit for name, channel in stream.channels.items()}


BOTH = {
    "turn_position_rad": "rad", "turn_velocity_rad_s": "rad/s", "turn_effort_N_m": "N*m",
    "lift_position_m": "m", "lift_velocity_m_s": "m/s", "lift_effort_N": "N",
}  # fmt: skip


def test_the_robot_description_in_a_bag_says_which_joints_turn(bag):
    text = bag.make("std_msgs/msg/String", data=URDF)
    topics = {
        "/robot_description": ("std_msgs/msg/String", [(times()[0], text)]),
        "/joint_states": (STATE, states(bag)),
    }
    recording = read(bag.write(topics))
    assert units_of(recording) == BOTH
    texts = [repair.text for repair in recording.provenance.repairs]
    assert "units of joints are those of the robot description in the bag: turn, lift" in texts


def test_the_mapping_says_it_in_one_line_and_before_the_description(bag):
    path = bag.write({"/joint_states": (STATE, states(bag))})
    assert units_of(read(path, joints={"turn": "revolute", "lift": "prismatic"})) == BOTH
    assert set(units_of(read(path, joints="revolute")).values()) == {"rad", "rad/s", "N*m"}


def test_a_channel_of_the_mapping_goes_before_the_kind_of_its_joint(bag):
    path = bag.write({"/joint_states": (STATE, states(bag))})
    channel = {"column": "turn.position", "unit": "deg"}
    units = units_of(read(path, joints="revolute", channels={"shoulder": channel}))
    assert units["shoulder_rad"] == "rad"
    assert units["turn_velocity_rad_s"] == "rad/s"


def test_without_both_the_line_to_write_is_given_and_works(bag):
    path = bag.write({"/joint_states": (STATE, states(bag))})
    with pytest.raises(InputError) as caught:
        read(path)
    (fault,) = caught.value.faults
    assert "a joint turns (rad) or slides (m), and the log does not say which" in fault
    line = re.search(r"joints: \{.*\}$", fault)
    assert line
    assert "turn_position_rad" in units_of(read(path, **yaml.safe_load(line[0])))


def test_a_template_asks_for_the_kind_of_each_joint(bag):
    path = bag.write({"/joint_states": (STATE, states(bag))})
    text = importing.template(path)
    tree = yaml.safe_load(text)
    assert tree["joints"] == {"turn": "?", "lift": "?"}
    tree["joints"] = {"turn": "revolute", "lift": "prismatic"}
    assert units_of(read(path, **tree)) == BOTH


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({"trun": "revolute"}, "joints: no joint is called 'trun'; did you mean turn"),
        ({"turn": "turning"}, "for each; found turning"),
        ("?", "expected revolute or prismatic for all joints, or name: revolute for each; found ?"),
        (["revolute"], "expected revolute or prismatic"),
    ],
)
def test_a_wrong_kind_or_joint_is_told(tmp_path, told, words):
    bag = Bag(tmp_path, CONTAINERS[0])
    path = bag.write({"/joint_states": (STATE, states(bag))})
    with pytest.raises(InputError) as caught:
        importing.read(path, mappings.of_tree({"joints": told}, "map.yaml"))
    assert words in str(caught.value)


def test_joints_of_a_log_without_any_are_told(tmp_path):
    (tmp_path / "a.csv").write_text("t (s),a (m)\n0,1\n1,2\n2,3\n", encoding="utf-8")
    with pytest.raises(InputError, match="joints: the log holds no states of joints"):
        read(tmp_path / "a.csv", joints="revolute")


ECHO = "%time,field.header.stamp,field.name0,field.position0,field.velocity0,field.effort0"
WHEEL = "/joint_states/wheel"
PLOT = f"__time (s),{WHEEL}/position,{WHEEL}/velocity,{WHEEL}/effort"


@pytest.mark.parametrize(("head", "joint"), [(ECHO, "0"), (PLOT, "wheel")])
def test_a_table_that_was_made_of_a_joint_state_asks_and_takes_the_same_line(tmp_path, head, joint):
    path = tmp_path / "joints.csv"
    stamps = [1_500_000_000_000_000_000 + 10_000_000 * i for i in range(50)]
    start = [f"{ns},{ns},wheel" if head == ECHO else f"{0.01 * i}" for i, ns in enumerate(stamps)]
    swing = [f"{np.sin(0.1 * i):.6f},{10 * np.cos(0.1 * i):.6f},0.5" for i in range(50)]
    rows = [f"{one},{more}" for one, more in zip(start, swing, strict=True)]
    path.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    with pytest.raises(InputError, match=rf'cure: joints: {{"?{joint}"?: revolute}}'):
        read(path)
    assert set(units_of(read(path, joints={joint: "revolute"})).values()) >= {"rad", "rad/s", "N*m"}


@pytest.mark.parametrize(
    ("text", "kinds"),
    [
        (URDF, {"turn": "revolute", "lift": "prismatic"}),
        ("<joint name='a' type='floating'/>", {}),
        ("<joint", {}),
        ("", {}),
        ("<joint type='revolute'/>", {}),
    ],
)
def test_kinds_are_read_out_of_a_description(text, kinds):
    assert joints.described(text) == kinds


@pytest.mark.parametrize(
    ("column", "unit"),
    [
        ("field.wrench.force.x", "N"), ("field.wrench.torque.z", "N*m"), ("field.voltage", "V"),
        ("field.temperature", "degC"), ("field.current", "A"), ("field.percentage", "1"),
        ("field.twist.linear.x", "m/s"), ("field.latitude", "deg"), ("field.altitude", "m"),
        ("field.capacity", "A*h"), ("field.data", ""), ("field.joint.position", ""),
    ],
)  # fmt: skip
def test_fields_of_common_messages_have_their_units_in_tables_of_ros(column, unit):
    found = profiles.find("imu.csv", [], [(column, "")])
    assert found is not None
    assert found.names == ((column, unit),)
