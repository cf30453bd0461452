"""The robot's package for ROS 2: its node with stand-ins, its lines, and its files."""

from __future__ import annotations

import ast
import importlib
import math
import sys
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import yaml

from simcompare.hardware.robot import robot_file, ros_package
from simcompare.hardware.robot.ros import core
from tests.ros_stand_ins import Controller, Definitions, Ros

PACKAGE = "robot_ros"


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ros")
    files = ros_package.package_files(robot_file.read(), "<robot name='robot'/>")
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
    return folder / PACKAGE


@pytest.fixture
def settings(package):
    text = (package / "config" / "driver.yaml").read_text(encoding="utf-8")
    return yaml.safe_load(text)["driver"]["ros__parameters"]


@pytest.fixture
def started(package, settings, monkeypatch):
    """The package's own node over stand-ins: ``started(load_V=…) -> (node, ros, controller)``."""

    def start(**how):
        monkeypatch.syspath_prepend(str(package))
        for name in [name for name in sys.modules if name.partition(".")[0] == PACKAGE]:
            monkeypatch.delitem(sys.modules, name)
        ros = Ros(Definitions(), settings)
        controller = Controller(settings, core.with_checksum, **how)
        ros.install(monkeypatch, lambda port, baud, timeout: controller)
        module = importlib.import_module(f"{PACKAGE}.driver")
        return module.Driver(), ros, controller

    return start


def twist(ros, speed, rate):
    made = ros.definitions.kind("geometry_msgs/msg/Twist")()
    made.linear.x, made.angular.z = speed, rate
    return made


def run(node, ros, seconds, told=None):
    for _ in range(round(seconds / 0.02)):
        if told is not None:
            node.on_twist(told)
        node.on_timer()
        ros.now_ns += 20_000_000


# --- the node ---------------------------------------------------------------------------------


def test_it_drives_as_it_is_told_and_says_where_it_is(started, settings):
    node, ros, controller = started()
    run(node, ros, 2.0, twist(ros, 0.2, 0.5))
    left, right = controller.rates
    radius, track = settings["radius_m"], settings["track_m"]
    assert radius * (left + right) / 2 == pytest.approx(0.2, rel=0.02)
    assert radius * (right - left) / track == pytest.approx(0.5, rel=0.05)
    last = ros.sent["odom"][-1]
    heading = radius * (controller.turned[1] - controller.turned[0]) / track
    # a mark more or less on either side: 2·pi·r/960 = 0.2 mm of way, over the track 2 mrad
    found = 2 * math.atan2(last.pose.pose.orientation.z, last.pose.pose.orientation.w)
    assert found == pytest.approx(heading, abs=0.02)
    circle = 0.2 / 0.5
    assert last.pose.pose.position.x == pytest.approx(circle * math.sin(heading), abs=0.01)
    assert last.pose.pose.position.y == pytest.approx(circle * (1 - math.cos(heading)), abs=0.01)
    frame = ros.sent["/tf"][-1].transforms[0]
    assert (frame.header.frame_id, frame.child_frame_id) == ("odom", "base_link")
    assert frame.transform.translation.x == last.pose.pose.position.x


def test_a_wheel_that_is_loaded_gets_more_voltage(started, settings):
    node, ros, controller = started(load_V=0.4)
    run(node, ros, 2.0, twist(ros, 0.2, 0.0))
    without_gain = 0.2 / settings["radius_m"] - 0.4 / settings["volts_per_rad_s"]
    assert controller.rates[0] > without_gain + 0.2


def test_backwards_it_counts_backwards(started):
    node, ros, _ = started()
    run(node, ros, 1.0, twist(ros, -0.1, 0.0))
    assert ros.sent["joint_states"][-1].position[0] < 0
    assert ros.sent["odom"][-1].pose.pose.position.x == pytest.approx(-0.1, abs=0.01)


def test_it_stops_when_nobody_tells_it_anything(started, settings):
    node, ros, controller = started()
    run(node, ros, 0.2, twist(ros, 0.1, 0.0))
    assert controller.told[-1][0] > 0
    run(node, ros, settings["timeout_s"] + 0.1)
    assert controller.told[-1] == [0, 0]


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_numbers_that_are_none_stop_it(started, value):
    node, ros, controller = started()
    run(node, ros, 0.1, twist(ros, 0.1, 0.0))
    node.core.drive(value, 0.0, ros.now_ns * 1e-9)
    node.on_timer()
    assert controller.told[-1] == [0, 0]


def test_it_stops_the_motors_at_the_end(started):
    node, ros, controller = started()
    run(node, ros, 0.1, twist(ros, 0.1, 0.0))
    node.destroy_node()
    assert controller.told[-1] == [0, 0]
    assert not controller.is_open


def test_lines_that_are_damaged_are_named_and_left_out(started):
    node, ros, controller = started()
    controller.noise = b"S 1 2 3*00\n\xff\xfe\n"
    run(node, ros, 0.1)
    assert len(ros.warnings) == 2
    assert len(ros.sent["imu/data_raw"]) == 5


def test_what_the_inertial_unit_reads_is_in_si(started):
    node, ros, _ = started()
    run(node, ros, 0.02)
    (message,) = ros.sent["imu/data_raw"]
    assert message.header.frame_id == "imu_link"
    assert message.linear_acceleration.z == pytest.approx(9.80665)
    assert message.angular_velocity.z == pytest.approx(math.radians(1))
    assert message.orientation_covariance[0] == -1  # there is none, says the message's definition


def test_missing_parameters_are_all_named(started, settings):
    del settings["marks"], settings["start_V"]
    with pytest.raises(ValueError, match="are missing: marks, start_V"):
        started()


def test_stand_ins_refuse_what_ros_does():
    definitions = Definitions()
    imu = definitions.kind("sensor_msgs/msg/Imu")()
    with pytest.raises(AssertionError, match="has no acceleration"):
        imu.acceleration = 1.0
    with pytest.raises(AssertionError, match="does not take 1"):
        imu.linear_acceleration.x = 1


# --- its lines --------------------------------------------------------------------------------


def test_a_line_is_read_only_whole():
    line = core.with_checksum("S 1500000 10 20 0 0 16384 0 0 131")
    found = core.reading_of(line)
    assert found is not None
    assert (found.time_s, found.marks) == (1.5, (10, 20))
    for i in range(len(line) - 1):
        assert core.reading_of(line[:i]) is None
        changed = line[:i] + chr(ord(line[i]) ^ 1) + line[i + 1 :]
        # small hexadecimal digits are the same number
        assert core.reading_of(changed) is None
    assert core.reading_of(core.with_checksum("S 1 2 3")) is None
    assert core.reading_of(core.with_checksum("M 1 2 3 4 5 6 7 8 9")) is None


def test_a_controller_that_begins_anew_moves_nothing():
    robot = core.Robot(0.0325, 0.12, 960, 0.27, 0.44, 4.8)
    one = core.Core(robot)
    still = ((0.0, 0.0, 9.8), (0.0, 0.0, 0.0))
    assert not one.update(core.Reading(1.0, (100, 100), *still))
    assert one.update(core.Reading(1.1, (110, 110), *still))
    pose = one.pose
    assert not one.update(core.Reading(1.2, (0, 0), *still))
    assert not one.update(core.Reading(0.1, (1, 1), *still))
    assert one.pose == pose
    assert one.update(core.Reading(0.2, (2, 2), *still))


def test_odometry_of_arcs_is_that_of_a_circle():
    """A whole circle in 1000 steps: what halfway headings leave is (turn)²/24 of the way each."""
    robot = core.Robot(0.0325, 0.12, 1e6, 0.27, 0.44, 4.8)
    one = core.Core(robot)
    still = ((0.0, 0.0, 9.8), (0.0, 0.0, 0.0))
    ways = [2 * math.pi * (0.3 + side * 0.06) for side in (-1, 1)]
    for share in np.linspace(0, 1, 1001):
        marks = [round(share * way / (2 * math.pi * 0.0325) * 1e6) for way in ways]
        one.update(core.Reading(share + 1, (marks[0], marks[1]), *still))
    assert (one.pose.x_m, one.pose.y_m) == pytest.approx((0, 0), abs=1e-5)
    assert one.pose.heading_rad == pytest.approx(0, abs=1e-4)


# --- its files --------------------------------------------------------------------------------


def test_the_package_names_itself_alike_everywhere(package):
    described = ET.parse(package / "package.xml").getroot()
    assert described.findtext("name") == PACKAGE
    assert (package / "resource" / PACKAGE).is_file()
    setup = (package / "setup.py").read_text(encoding="utf-8")
    assert f'NAME = "{PACKAGE}"' in setup
    assert f"$base/lib/{PACKAGE}" in (package / "setup.cfg").read_text(encoding="utf-8")
    for path in package.rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        assert "simcompare." not in ast.unparse(tree), path
    assert "Not verified on hardware" in (package / "README.md").read_text(encoding="utf-8")


def test_a_title_is_text_everywhere():
    """Whatever stands in it, it is no code of the package, and breaks none of its files."""
    title = 'Bob "x", **{1: 2} <b> & \' -->'
    ours = robot_file.read().model_copy(update={"title": title})
    files = ros_package.package_files(ours, "<robot name='robot'/>")
    described = ET.fromstring(files[f"{PACKAGE}/package.xml"])
    assert (described.findtext("description") or "").startswith(f"{title}: ")
    setup = ast.parse(files[f"{PACKAGE}/setup.py"])
    told = [
        k.value for k in ast.walk(setup) if isinstance(k, ast.keyword) and k.arg == "description"
    ]
    assert [ast.literal_eval(value) for value in told] == [title]


def test_what_the_node_imports_the_package_asks_for(package):
    described = ET.parse(package / "package.xml").getroot()
    asked = {element.text for element in described.findall("exec_depend")}
    driver = ast.parse((package / PACKAGE / "driver.py").read_text(encoding="utf-8"))
    named = {node.module for node in ast.walk(driver) if isinstance(node, ast.ImportFrom)}
    named |= {
        a.name for node in ast.walk(driver) if isinstance(node, ast.Import) for a in node.names
    }
    tops = {name.partition(".")[0] for name in named} - set(sys.stdlib_module_names)
    tops = (tops - {PACKAGE, "serial"}) | {"python3-serial"}
    assert tops <= asked
    launched = (package / "launch" / "robot.launch.py").read_text(encoding="utf-8")
    assert {"tf2_ros", "robot_state_publisher"} <= {one for one in asked if one in launched}
