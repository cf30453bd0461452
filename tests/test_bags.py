"""Messages in ROS bags: values to the bit, units, frames, clocks and uncertainties."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from simcompare.hardware.logs.bags import layout as bag_layout
from tests.ros_bags import (
    CONTAINERS,
    COUNT,
    ROS1,
    START_NS,
    STEP_NS,
    Bag,
    condition_of,
    faults,
    imu,
    imu_topic,
    joint_state,
    load,
    range_message,
    rules,
    stream,
    times,
    values,
)

pytest.importorskip("rosbags")


@pytest.fixture(params=CONTAINERS)
def container(request):
    return request.param


@pytest.fixture
def bag(tmp_path, container):
    return Bag(tmp_path, container)


def test_an_imu_has_its_values_to_the_bit_with_units_and_frame(bag):
    log = load(bag.write({"/imu": imu_topic(bag)}))
    one = stream(log, "imu")
    i = np.arange(COUNT)
    assert np.array_equal(values(one, "angular_velocity.x"), [math.sin(k) for k in i])
    assert np.array_equal(values(one, "angular_velocity.y"), np.full(COUNT, 1e-300))
    assert np.array_equal(values(one, "linear_acceleration.y"), i / 3)
    assert np.array_equal(values(one, "orientation.x"), [0.1 * k for k in i])
    units = {column.name: column.unit for column in one.columns}
    assert units["angular_velocity.z"] == "rad/s"
    assert units["linear_acceleration.z"] == "m/s^2"
    assert units["orientation.w"] == "1"
    assert {c.frame for c in one.columns if c.name.startswith("linear")} == {"imu_link"}
    assert one.row_word == "message"


def test_the_clock_is_the_header_stamp_to_the_nanosecond(bag):
    log = load(bag.write({"/imu": imu_topic(bag)}))
    one = stream(log, "imu")
    assert one.time == "header.stamp"
    assert one.clock.name == "header.stamp"
    assert one.clock.start == "2023-11-14T22:13:20.123456789Z"
    back = np.rint(values(one, one.time) * 1e9).astype(np.int64)
    assert np.array_equal(np.diff(back), np.full(COUNT - 1, STEP_NS))
    assert "0.002 s" in log.about["imu: receipt after header.stamp"]


def test_streams_of_one_bag_share_the_zero_of_their_clock(bag):
    late = [(ns, imu(bag, ns + 250_000_000, i)) for i, ns in enumerate(times())]
    topics = {"/a": imu_topic(bag), "/b": ("sensor_msgs/msg/Imu", late)}
    log = load(bag.write(topics))
    first = [values(stream(log, name), "header.stamp")[0] for name in "ab"]
    assert first[1] - first[0] == pytest.approx(0.25, abs=1e-9)


def test_the_sequence_number_of_ros_1_counts_the_messages(tmp_path):
    bag = Bag(tmp_path, ROS1)
    one = stream(load(bag.write({"/imu": imu_topic(bag)})), "imu")
    assert one.counter == "header.seq"
    assert np.array_equal(values(one, "header.seq"), 100 + np.arange(COUNT))


def test_a_sequence_number_that_never_moves_counts_nothing(tmp_path):
    bag = Bag(tmp_path, ROS1)
    rows = [(ns, imu(bag, ns, i, header=bag.header(ns, seq=0))) for i, ns in enumerate(times())]
    log = load(bag.write({"/imu": ("sensor_msgs/msg/Imu", rows)}))
    assert stream(log, "imu").counter is None
    assert log.ignored["imu/header.seq"] == "is always the same"


def test_the_diagonal_of_a_covariance_becomes_the_uncertainty(bag):
    one = stream(load(bag.write({"/imu": imu_topic(bag)})), "imu")
    got = [one.column(f"angular_velocity.{letter}").u for letter in "xyz"]
    assert got == [math.sqrt(1e-4), math.sqrt(4e-4), math.sqrt(9e-4)]


def test_a_covariance_of_zeros_means_unknown(bag):
    one = stream(load(bag.write({"/imu": imu_topic(bag)})), "imu")
    assert one.column("linear_acceleration.x").u is None
    assert one.column("orientation.w").u is None


def test_a_covariance_that_changes_gives_one_uncertainty_for_each_sample(bag):
    rows = []
    for i, ns in enumerate(times()):
        covariance = np.diag([(1.0 + i) ** 2, 1.0, 1.0]).ravel()
        rows.append((ns, imu(bag, ns, i, linear_acceleration_covariance=covariance)))
    one = stream(load(bag.write({"/imu": ("sensor_msgs/msg/Imu", rows)})), "imu")
    assert np.array_equal(one.column("linear_acceleration.x").u, 1.0 + np.arange(COUNT))
    assert one.column("linear_acceleration.y").u == 1.0


def test_what_stands_beside_the_diagonal_is_named_as_left_out(bag):
    covariance = np.array([1, 0.5, 0, 0.5, 1, 0, 0, 0, 1.0])
    topic = imu_topic(bag, linear_acceleration_covariance=covariance)
    log = load(bag.write({"/imu": topic}))
    assert "diagonal" in log.ignored["imu/linear_acceleration_covariance"]
    assert "imu/angular_velocity_covariance" not in log.ignored


def test_a_field_whose_covariance_begins_with_minus_one_is_left_out_with_the_reason(bag):
    absent = np.array([-1.0] + [0.0] * 8)
    log = load(bag.write({"/imu": imu_topic(bag, orientation_covariance=absent)}))
    names = [column.name for column in stream(log, "imu").columns]
    assert not [name for name in names if name.startswith("orientation")]
    assert "-1" in log.ignored["imu/orientation.w"]


def test_a_field_that_is_absent_in_some_messages_is_missing_there(bag):
    absent = np.array([-1.0] + [0.0] * 8)
    rows = [
        (ns, imu(bag, ns, i, **({"angular_velocity_covariance": absent} if i == 7 else {})))
        for i, ns in enumerate(times())
    ]
    log = load(bag.write({"/imu": ("sensor_msgs/msg/Imu", rows)}))
    x = values(stream(log, "imu"), "angular_velocity.x")
    assert np.flatnonzero(np.isnan(x)).tolist() == [7]
    noted = [r for r in log.repairs if r.rule == "field_absent" and r.channel.endswith("y.x")]
    assert noted[0].rows == ((8, 8),)


def test_an_orientation_has_half_the_largest_turn_as_uncertainty(bag):
    covariance = np.diag([0.01, 0.04, 0.0225]).ravel()
    log = load(bag.write({"/imu": imu_topic(bag, orientation_covariance=covariance)}))
    assert stream(log, "imu").column("orientation.w").u == pytest.approx(0.1)
    assert "orientation_uncertainty" in rules(log)


def test_joints_are_found_by_name_whatever_their_order(bag):
    rows = []
    for i, ns in enumerate(times()):
        names, angles = ["left", "right"], [1.0 + i, -1.0 - i]
        if i % 3 == 1:
            names, angles = names[::-1], angles[::-1]
        rows.append((ns, joint_state(bag, ns, names, angles, [2 * a for a in angles])))
    one = stream(load(bag.write({"/joints": ("sensor_msgs/msg/JointState", rows)})), "joints")
    assert np.array_equal(values(one, "left.position"), 1.0 + np.arange(COUNT))
    assert np.array_equal(values(one, "right.velocity"), -2.0 - 2 * np.arange(COUNT))
    assert "left.effort" not in [column.name for column in one.columns]
    assert one.column("left.position").unit == ""  # rad or m: the message does not say


def test_a_joint_that_comes_later_is_missing_before(bag):
    rows = []
    for i, ns in enumerate(times(2000)):
        names = ["a"] if i < 1500 else ["a", "b"]
        rows.append((ns, joint_state(bag, ns, names, [float(i)] * len(names))))
    one = stream(load(bag.write({"/j": ("sensor_msgs/msg/JointState", rows)})), "j")
    assert np.array_equal(values(one, "a.position"), np.arange(2000.0))
    late = values(one, "b.position")
    assert np.isnan(late[:1500]).all()
    assert np.array_equal(late[1500:], np.arange(1500.0, 2000.0))


def test_joints_and_values_that_do_not_match_in_number_are_named(bag):
    rows = [(ns, joint_state(bag, ns, ["a", "b"], [1.0])) for ns in times()]
    text = faults(bag.write({"/j": ("sensor_msgs/msg/JointState", rows)}))
    assert "2 names and 1 values of position" in text


def odometry(bag, ns, i):
    pose = bag.make(
        "geometry_msgs/msg/Pose", position=bag.vector(i, 2.0, 0.0, "geometry_msgs/msg/Point"),
        orientation=bag.quaternion(0.0, 0.0, 0.0, 1.0),
    )  # fmt: skip
    twist = bag.make(
        "geometry_msgs/msg/Twist", linear=bag.vector(0.5, 0, 0), angular=bag.vector(0, 0, i)
    )
    spread = np.diag([0.01, 0.04, 0.09, 0.0, 0.0, 0.16]).ravel()
    return bag.make(
        "nav_msgs/msg/Odometry", header=bag.header(ns, "odom"), child_frame_id="base_link",
        pose=bag.make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=spread),
        twist=bag.make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=spread),
    )  # fmt: skip


def test_odometry_has_its_pose_in_one_frame_and_its_twist_in_the_other(bag):
    rows = [(ns, odometry(bag, ns, i)) for i, ns in enumerate(times())]
    one = stream(load(bag.write({"/odom": ("nav_msgs/msg/Odometry", rows)})), "odom")
    position, turn = one.column("pose.pose.position.x"), one.column("twist.twist.angular.z")
    assert (position.frame, position.unit, position.u) == ("odom", "m", 0.1)
    assert (turn.frame, turn.unit, turn.u) == ("base_link", "rad/s", 0.4)
    assert one.column("twist.twist.linear.x").u == 0.1
    assert one.column("twist.twist.angular.x").u is None
    assert np.array_equal(turn.values, np.arange(float(COUNT)))


def test_poses_and_twists_have_units(bag):
    pose = bag.make(
        "geometry_msgs/msg/Pose", position=bag.vector(1, 2, 3, "geometry_msgs/msg/Point"),
        orientation=bag.quaternion(0.0, 0.6, 0.0, 0.8),
    )  # fmt: skip
    twist = bag.make(
        "geometry_msgs/msg/Twist", linear=bag.vector(1, 2, 3), angular=bag.vector(4, 5, 6)
    )
    kinds = {"/p": ("PoseStamped", "pose", pose), "/t": ("TwistStamped", "twist", twist)}
    topics = {
        topic: (
            f"geometry_msgs/msg/{kind}",
            [
                (ns, bag.make(f"geometry_msgs/msg/{kind}", header=bag.header(ns, "map"), **{f: m}))
                for ns in times()
            ],
        )
        for topic, (kind, f, m) in kinds.items()
    }
    log = load(bag.write(topics))
    position = stream(log, "p").column("pose.position.y")
    assert (position.unit, position.frame, position.values[0]) == ("m", "map", 2.0)
    assert stream(log, "p").column("pose.orientation.w").values[0] == 0.8
    assert stream(log, "t").column("twist.angular.z").unit == "rad/s"


def test_infinite_ranges_are_missing_and_recorded_and_the_limits_are_known(bag):
    far = {3: math.inf, 4: math.inf, 9: -math.inf}
    rows = [(ns, range_message(bag, ns, far.get(i, 1.5))) for i, ns in enumerate(times())]
    log = load(bag.write({"/range": ("sensor_msgs/msg/Range", rows)}))
    column = stream(log, "range").column("range")
    assert np.flatnonzero(np.isnan(column.values)).tolist() == [3, 4, 9]
    assert column.limits == (0.25, 4.0)
    assert column.unit == "m"
    noted = next(r for r in log.repairs if r.rule == "out_of_range")
    assert (noted.rows, noted.count, noted.severity) == (((4, 5), (10, 10)), 3, "info")
    assert "0.25 m and 4 m" in log.ignored["range/min_range, max_range"]


def test_several_sensors_in_one_topic_become_one_stream_for_each_frame(bag):
    rows = []
    for i, ns in enumerate(times()):
        message = range_message(bag, ns, 1.0 + i % 2)
        message.header.frame_id = "left" if i % 2 else "front"
        rows.append((ns, message))
    log = load(bag.write({"/range": ("sensor_msgs/msg/Range", rows)}))
    assert sorted(s.name for s in log.streams) == ["range[front]", "range[left]"]
    left = stream(log, "range[left]")
    assert set(values(left, "range")) == {2.0}
    assert left.rows.tolist() == list(range(2, COUNT + 1, 2))


def cloud(bag, ns, z, *, big=False, height=8, width=8):
    order = ">" if big else "<"
    table = np.zeros(
        (height, width), dtype=[("z", f"{order}f4"), ("pad", "u4"), ("i", f"{order}u2")]
    )
    table["z"], table["i"] = z, 7
    field = "sensor_msgs/msg/PointField"
    fields = [
        bag.make(field, name="z", offset=0, datatype=7, count=1),
        bag.make(field, name="intensity", offset=8, datatype=4, count=1),
    ]
    step = table.dtype.itemsize
    return bag.make(
        "sensor_msgs/msg/PointCloud2", header=bag.header(ns, "tof"), height=height, width=width,
        fields=fields, is_bigendian=big, point_step=step, row_step=step * width,
        data=np.frombuffer(table.tobytes(), np.uint8), is_dense=True,
    )  # fmt: skip


@pytest.mark.parametrize("big", [False, True])
def test_a_small_cloud_has_one_column_for_each_point(bag, big):
    grid = np.arange(64.0).reshape(8, 8)
    rows = [(ns, cloud(bag, ns, grid + 100 * i, big=big)) for i, ns in enumerate(times())]
    one = stream(load(bag.write({"/tof": ("sensor_msgs/msg/PointCloud2", rows)})), "tof")
    assert np.array_equal(values(one, "z[2,3]"), 19 + 100.0 * np.arange(COUNT))
    assert one.column("z[7,7]").unit == "m"
    assert one.column("intensity[0,0]").values[0] == 7
    assert len(one.columns) == 1 + 2 * 64  # header.seq is always 0


def test_a_large_cloud_is_left_out_with_the_reason(bag):
    rows = [(ns, cloud(bag, ns, np.zeros((20, 30)), height=20, width=30)) for ns in times(5)]
    topics = {"/tof": ("sensor_msgs/msg/PointCloud2", rows), "/imu": imu_topic(bag)}
    log = load(bag.write(topics))
    assert "20×30 points" in log.ignored["tof"]
    assert [s.name for s in log.streams] == ["imu"]


def test_pressure_temperature_and_field_have_units_and_uncertainty(bag):
    make, header = bag.make, bag.header
    kinds = {
        "/p": ("FluidPressure", {"fluid_pressure": 101325.0, "variance": 25.0}),
        "/t": ("Temperature", {"temperature": 21.5, "variance": 0.0}),
        "/m": (
            "MagneticField",
            {
                "magnetic_field": bag.vector(2e-5, 0, 4e-5),
                "magnetic_field_covariance": np.diag([1e-12] * 3).ravel(),
            },
        ),
    }
    topics = {
        topic: (
            f"sensor_msgs/msg/{kind}",
            [(ns, make(f"sensor_msgs/msg/{kind}", header=header(ns), **more)) for ns in times()],
        )
        for topic, (kind, more) in kinds.items()
    }
    log = load(bag.write(topics))
    pressure = stream(log, "p").column("fluid_pressure")
    assert (pressure.unit, pressure.u, pressure.values[0]) == ("Pa", 5.0, 101325.0)
    temperature = stream(log, "t").column("temperature")
    assert (temperature.unit, temperature.u) == ("degC", None)
    field = stream(log, "m").column("magnetic_field.z")
    assert (field.unit, field.u) == ("T", 1e-6)
    done = condition_of(log, Path("x"))
    assert done.streams["t"].channels["temperature_K"].values[0] == pytest.approx(294.65)


def test_a_number_without_a_header_is_timed_by_its_receipt_and_that_is_recorded(bag):
    rows = [(ns, bag.make("std_msgs/msg/Float64", data=i / 7)) for i, ns in enumerate(times())]
    log = load(bag.write({"/n": ("std_msgs/msg/Float64", rows)}))
    one = stream(log, "n")
    assert one.clock.name == "bag receive time"
    assert one.clock.start == "2023-11-14T22:13:20.123456789Z"
    assert np.array_equal(values(one, "data"), np.arange(COUNT) / 7)
    assert [r.severity for r in log.repairs if r.rule == "no_header_stamp"] == ["info"]


def test_stamps_that_are_all_zero_are_replaced_by_the_receipt_with_a_warning(bag):
    rows = [(ns, imu(bag, 0, i)) for i, ns in enumerate(times())]
    log = load(bag.write({"/imu": ("sensor_msgs/msg/Imu", rows)}))
    assert stream(log, "imu").time == "bag receive time"
    assert [r.severity for r in log.repairs if r.rule == "no_header_stamp"] == ["warning"]


def test_a_stamp_that_never_goes_on_is_replaced_by_the_receipt_with_a_warning(bag):
    # a node that sends its last command again and again
    rows = [(ns, imu(bag, times()[0], i)) for i, ns in enumerate(times())]
    log = load(bag.write({"/imu": ("sensor_msgs/msg/Imu", rows)}))
    assert stream(log, "imu").time == "bag receive time"
    told = [r for r in log.repairs if r.rule == "no_header_stamp"]
    assert [r.severity for r in told] == ["warning"]
    assert "the same in all messages" in told[0].text


def test_a_simulated_clock_keeps_its_own_zero(bag):
    rows = [(5 * 10**9 + i, imu(bag, 5 * 10**9 + i * STEP_NS, i)) for i in range(COUNT)]
    one = stream(load(bag.write({"/imu": ("sensor_msgs/msg/Imu", rows)})), "imu")
    assert one.clock.start == ""
    assert values(one, "header.stamp")[0] == 5.0


def test_text_and_pictures_are_left_out_with_the_reason(bag):
    rows = [(ns, bag.make("std_msgs/msg/String", data="hello")) for ns in times(3)]
    log = load(bag.write({"/chat": ("std_msgs/msg/String", rows), "/imu": imu_topic(bag)}))
    assert log.ignored["chat"] == "holds no numbers"


def test_a_topic_without_messages_and_one_with_a_single_message_are_named(bag):
    one = bag.make("std_msgs/msg/Float64", data=1.0)
    topics = {
        "/imu": imu_topic(bag),
        "/none": ("std_msgs/msg/Float64", []),
        "/one": ("std_msgs/msg/Float64", [(START_NS, one)]),
    }
    log = load(bag.write(topics))
    assert log.ignored["none"] == "holds no messages"
    assert "single message" in log.ignored["one"]


def test_a_bag_becomes_a_recording_in_si_units(bag):
    path = bag.write({"/imu": imu_topic(bag)})
    done = condition_of(load(path), path)
    found = done.streams["imu"]
    assert found.clock.name == "header.stamp"
    channel = found.channels["angular_velocity_z_rad_s"]
    assert (channel.frame, channel.u) == ("imu_link", math.sqrt(9e-4))
    assert np.array_equal(channel.values, -np.arange(float(COUNT)))
    assert found.time_s[1] == pytest.approx(STEP_NS * 1e-9, abs=1e-12)


def test_long_lists_do_not_become_columns(tmp_path):
    bag = Bag(tmp_path, ROS1)
    layout = bag.make("std_msgs/msg/MultiArrayLayout", dim=[], data_offset=0)
    count = bag_layout.MAX_COLUMNS + 1
    rows = [
        (ns, bag.make("std_msgs/msg/Float64MultiArray", layout=layout, data=np.zeros(count)))
        for ns in times(3)
    ]
    log = load(bag.write({"/m": ("std_msgs/msg/Float64MultiArray", rows)}))
    assert f"has {count} elements" in log.ignored["m/data"]


def test_a_short_list_becomes_columns(bag):
    layout = bag.make("std_msgs/msg/MultiArrayLayout", dim=[], data_offset=0)
    rows = [
        (ns, bag.make("std_msgs/msg/Float64MultiArray", layout=layout, data=np.arange(3.0) + i))
        for i, ns in enumerate(times())
    ]
    one = stream(load(bag.write({"/m": ("std_msgs/msg/Float64MultiArray", rows)})), "m")
    assert np.array_equal(values(one, "data.2"), 2.0 + np.arange(COUNT))
