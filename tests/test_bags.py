"""ROS bags: all containers, message types, clocks and defects, against rosbags' own decoder."""

from __future__ import annotations

import math
import os
import shutil
import sqlite3
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware.conditioning.condition import condition
from simcompare.hardware.logs import bag_layout, importers
from simcompare.hardware.logs.mapping import NOTHING
from simcompare.recording import Provenance

pytest.importorskip("rosbags")
lz4_frame = pytest.importorskip("lz4.frame")

START_NS = 1_700_000_000_123_456_789
STEP_NS = 10_000_001
COUNT = 50

#: whole second in which the first message of the example was received
START_OF_EXAMPLE_NS = 1_396_293_887 * 10**9

ROS1, SQLITE, MCAP = "ros1", "sqlite3", "mcap"
CONTAINERS = (ROS1, SQLITE, MCAP)


@pytest.fixture(params=CONTAINERS)
def container(request):
    return request.param


class Bag:
    """Writes a bag with rosbags: topics with lists of (time of receipt, message)."""

    def __init__(self, folder, container, **options):
        from rosbags.rosbag1 import Writer as Writer1
        from rosbags.rosbag2 import StoragePlugin
        from rosbags.rosbag2 import Writer as Writer2
        from rosbags.typesys import Stores, get_typestore

        self.is1 = container == ROS1
        self.types = get_typestore(Stores.ROS1_NOETIC if self.is1 else Stores.ROS2_HUMBLE)
        if self.is1:
            self.path = folder / "log.bag"
            self.writer = Writer1(self.path)
        else:
            self.path = folder / "log"
            plugin = StoragePlugin.MCAP if container == MCAP else StoragePlugin.SQLITE3
            self.writer = Writer2(self.path, version=9, storage_plugin=plugin)
        for name, value in options.items():
            getattr(self.writer, name)(*value)

    def make(self, kind, **fields):
        return self.types.types[kind](**fields)

    def header(self, ns, frame="imu_link", seq=0):
        stamp = self.make("builtin_interfaces/msg/Time", sec=ns // 10**9, nanosec=ns % 10**9)
        more = {"seq": seq} if self.is1 else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **more)

    def vector(self, x, y, z, kind="geometry_msgs/msg/Vector3"):
        return self.make(kind, x=float(x), y=float(y), z=float(z))

    def quaternion(self, x, y, z, w):
        return self.make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)

    def write(self, topics):
        """Topics: name -> (kind, [(ns, message)]); interleaved in time as a recorder would."""
        with self.writer as writer:
            connections = {
                name: writer.add_connection(name, kind, typestore=self.types)
                for name, (kind, _) in topics.items()
            }
            rows = [(ns, n, m) for n, (_, rows) in topics.items() for ns, m in rows]
            for ns, name, message in sorted(rows, key=lambda row: row[0]):
                kind = topics[name][0]
                pack = self.types.serialize_ros1 if self.is1 else self.types.serialize_cdr
                writer.write(connections[name], ns, pack(message, kind))
        return self.path


@pytest.fixture
def bag(tmp_path, container):
    return Bag(tmp_path, container)


def times(count=COUNT):
    return [START_NS + i * STEP_NS for i in range(count)]


def imu(bag, ns, i, **more):
    unknown = np.zeros(9)
    fields = {
        "header": bag.header(ns, seq=100 + i),
        "orientation": bag.quaternion(0.1 * i, 0.2, -0.3, 0.5),
        "orientation_covariance": unknown,
        "angular_velocity": bag.vector(math.sin(i), 1e-300, -i),
        "angular_velocity_covariance": np.diag([1e-4, 4e-4, 9e-4]).ravel(),
        "linear_acceleration": bag.vector(0.1, i / 3, 9.80665),
        "linear_acceleration_covariance": unknown,
    }
    return bag.make("sensor_msgs/msg/Imu", **{**fields, **more})


def imu_topic(bag, count=COUNT, delay=2_000_000, **more):
    rows = [(ns + delay, imu(bag, ns, i, **more)) for i, ns in enumerate(times(count))]
    return "sensor_msgs/msg/Imu", rows


def load(path):
    return importers.read(path, importers.recognise(path), NOTHING)


def stream(log, name):
    return next(one for one in log.streams if one.name == name)


def values(one, name):
    return one.column(name).values


def rules(log):
    return [repair.rule for repair in log.repairs]


def faults(path, read=load):
    with pytest.raises(InputError) as error:
        read(path)
    assert path.name in str(error.value)
    return " | ".join(error.value.faults)


def condition_of(log, path, mode="repair"):
    return condition(log, NOTHING, Provenance(path.name, "", 0, "bag", "", mode))


def test_each_container_is_recognised_as_a_folder_and_as_a_bare_file(bag, container):
    path = bag.write({"/imu": imu_topic(bag)})
    assert importers.recognise(path) == "bag"
    if container != ROS1:
        bare = next(p for p in path.iterdir() if p.suffix in (".db3", ".mcap"))
        assert importers.recognise(bare) == "bag"
        assert len(stream(load(bare), "imu")) == COUNT


def test_an_sqlite_file_of_something_else_is_no_bag(tmp_path):
    path = tmp_path / "other.db3"
    with sqlite3.connect(path) as base:
        base.execute("CREATE TABLE notes (text)")
    base.close()
    with pytest.raises(InputError):
        importers.recognise(path)


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


def joint_state(bag, ns, names, position, velocity=(), effort=()):
    return bag.make(
        "sensor_msgs/msg/JointState", header=bag.header(ns, ""), name=list(names),
        position=np.array(position, float), velocity=np.array(velocity, float),
        effort=np.array(effort, float),
    )  # fmt: skip


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


def range_message(bag, ns, distance):
    return bag.make(
        "sensor_msgs/msg/Range", header=bag.header(ns, "front"), radiation_type=1,
        field_of_view=0.5, min_range=0.25, max_range=4.0, range=distance,
    )  # fmt: skip


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


@pytest.mark.parametrize("kind", ["BZ2", "LZ4"])
def test_compressed_chunks_of_ros_1_are_read(tmp_path, kind):
    from rosbags.rosbag1 import Writer

    bag = Bag(tmp_path, ROS1, set_compression=(Writer.CompressionFormat[kind],))
    assert len(stream(load(bag.write({"/imu": imu_topic(bag)})), "imu")) == COUNT


@pytest.mark.parametrize(
    ("container", "mode"),
    [(SQLITE, "FILE"), (SQLITE, "MESSAGE"), (MCAP, "FILE"), (MCAP, "MESSAGE"), (MCAP, "STORAGE")],
)
def test_compressed_bags_of_ros_2_are_read(tmp_path, container, mode):
    from rosbags.rosbag2 import CompressionFormat, CompressionMode

    compression = (CompressionMode[mode], CompressionFormat.ZSTD)
    bag = Bag(tmp_path, container, set_compression=compression)
    one = stream(load(bag.write({"/imu": imu_topic(bag)})), "imu")
    assert np.array_equal(values(one, "linear_acceleration.y"), np.arange(COUNT) / 3)


def test_a_bag_without_definitions_uses_those_of_ros_and_says_so(tmp_path):
    bag = Bag(tmp_path, SQLITE)
    path = bag.write({"/range": ("sensor_msgs/msg/Range", [
        (ns, range_message(bag, ns, 1.5)) for ns in times()
    ])})  # fmt: skip
    with sqlite3.connect(next(path.glob("*.db3"))) as base:
        base.execute("DROP TABLE message_definitions")
    base.close()
    log = load(path)
    assert stream(log, "range").column("range").values[0] == 1.5
    assert "humble" in next(r.text for r in log.repairs if r.rule == "shipped_definition")


def test_an_unknown_type_without_definition_is_left_out_with_its_name(tmp_path):
    bag = Bag(tmp_path, SQLITE)
    path = bag.write({"/imu": imu_topic(bag)})
    with sqlite3.connect(next(path.glob("*.db3"))) as base:
        base.execute("DROP TABLE message_definitions")
        base.execute("UPDATE topics SET type = 'my_robot/msg/Secret'")
    base.close()
    assert "no definition of my_robot/msg/Secret" in faults(path)


# --- what is cut off or damaged


def cut(path, keep):
    data = path.read_bytes()
    path.write_bytes(data[: keep if keep > 0 else len(data) + keep])


def long_bag(tmp_path, container):
    """A bag of several chunks, and its file."""
    from rosbags.rosbag1 import Writer

    options = {"set_compression": (Writer.CompressionFormat.LZ4,)} if container == ROS1 else {}
    bag = Bag(tmp_path, container, **options)
    path = bag.write({"/imu": imu_topic(bag, 12000)})
    if container == ROS1:
        return path, path
    return path, next(p for p in path.iterdir() if p.suffix in (".db3", ".mcap"))


@pytest.mark.parametrize("container", [ROS1, MCAP])
def test_a_truncated_bag_gives_what_is_whole_and_says_what_is_missing(tmp_path, container):
    path, file = long_bag(tmp_path, container)
    whole = stream(load(path), "imu")
    cut(file, int(file.stat().st_size * 0.7))
    found = stream(load(path), "imu")
    assert 1000 < len(found) < len(whole)
    assert "byte " in found.truncated
    same = values(whole, "linear_acceleration.y")[: len(found)]
    assert np.array_equal(values(found, "linear_acceleration.y"), same)


def test_a_truncated_sqlite_bag_is_refused_because_it_would_read_as_zeros(tmp_path):
    _, file = long_bag(tmp_path, SQLITE)
    size = file.stat().st_size
    cut(file, size - 4096)
    assert f"byte {size - 4096}" in faults(file)


def test_a_bag_cut_anywhere_gives_a_prefix_or_a_typed_error(tmp_path, container):
    path, file = long_bag(tmp_path, container)
    whole = values(stream(load(path), "imu"), "linear_acceleration.y")
    data = file.read_bytes()
    for keep in np.linspace(1, len(data) - 1, 40).astype(int):
        file.write_bytes(data[:keep])
        try:
            found = stream(load(path), "imu")
        except InputError:
            continue
        assert np.array_equal(values(found, "linear_acceleration.y"), whole[: len(found)])
        assert len(found) == len(whole) or found.truncated


def test_flipped_bytes_give_a_typed_error_or_a_record_and_never_a_traceback(tmp_path, container):
    bag = Bag(tmp_path, container)
    path = bag.write({"/imu": imu_topic(bag), "/j": ("sensor_msgs/msg/JointState", [
        (ns, joint_state(bag, ns, ["a", "b"], [1.0, 2.0])) for ns in times()
    ])})  # fmt: skip
    file = path if container == ROS1 else next(p for p in path.iterdir() if p.suffix != ".yaml")
    data = file.read_bytes()
    random = np.random.default_rng(4)
    for _ in range(150):
        bad = bytearray(data)
        for at in random.integers(0, len(data), random.integers(1, 6)):
            bad[at] = random.integers(0, 256)
        file.write_bytes(bad)
        try:
            log = importers.read(path, "bag", NOTHING)
        except InputError:
            continue
        assert all(len(c.values) == len(s) for s in log.streams for c in s.columns)


def test_a_bag_that_was_never_closed_is_read_and_marked(tmp_path):
    bag = Bag(tmp_path, ROS1)
    path = bag.write({"/imu": imu_topic(bag)})
    data = bytearray(path.read_bytes())
    at = data.index(b"index_pos=") + len(b"index_pos=")
    index = struct.unpack_from("<Q", data, at)[0]
    struct.pack_into("<Q", data, at, 0)
    path.write_bytes(data[:index])
    one = stream(load(path), "imu")
    assert len(one) == COUNT
    assert "never closed" in one.truncated


def test_a_damaged_chunk_is_passed_over_and_named_with_its_byte(tmp_path):
    path, file = long_bag(tmp_path, ROS1)
    whole = len(stream(load(path), "imu"))
    data = bytearray(file.read_bytes())
    at = data.index(b"\x04\x22\x4d\x18", len(data) // 3)  # a chunk of LZ4 begins
    data[at + 20 : at + 400] = b"\xff" * 380
    file.write_bytes(data)
    log = load(path)
    one = stream(log, "imu")
    assert 0 < len(one) < whole
    damaged = next(r for r in log.repairs if r.rule == "damaged_record")
    assert damaged.severity == "warning"
    assert "byte " in damaged.text


def record(kind, body):
    return struct.pack("<BQ", kind, len(body)) + body


def text(words):
    return struct.pack("<I", len(words)) + words.encode()


def small_mcap(chunks, compression="", spoil=None):
    """An MCAP file of Float64 messages: one chunk with a check sum for each list of numbers."""
    definition = text("float64 data\n")
    parts = [b"\x89MCAP0\r\n", record(1, text("ros2") + text("test"))]
    parts.append(
        record(
            3, struct.pack("<H", 1) + text("std_msgs/msg/Float64") + text("ros2msg") + definition
        )
    )
    parts.append(
        record(4, struct.pack("<HH", 1, 1) + text("/n") + text("cdr") + struct.pack("<I", 0))
    )
    for k, numbers in enumerate(chunks):
        inner = b"".join(
            record(5, struct.pack("<HIQQ", 1, i, START_NS + n * 10**7, 0) + b"\0\1\0\0"
                   + struct.pack("<d", n))
            for i, n in enumerate(numbers)
        )  # fmt: skip
        packed = inner
        if compression == "lz4":
            packed = lz4_frame.compress(inner)
        checksum = zlib.crc32(inner)
        if spoil == k:
            middle = len(packed) // 2
            packed = packed[:middle] + bytes([packed[middle] ^ 1]) + packed[middle + 1 :]
        body = struct.pack("<QQQI", 0, 0, len(inner), checksum) + text(compression)
        parts.append(record(6, body + struct.pack("<Q", len(packed)) + packed))
    parts.append(record(15, struct.pack("<I", 0)))
    return b"".join(parts)


@pytest.mark.parametrize("compression", ["", "lz4"])
def test_a_chunk_that_does_not_fit_its_check_sum_is_left_out_and_named(tmp_path, compression):
    path = tmp_path / "n.mcap"
    chunks = [range(0, 5), range(5, 10), range(10, 15)]
    path.write_bytes(small_mcap(chunks, compression))
    assert np.array_equal(values(stream(load(path), "n"), "data"), np.arange(15.0))
    path.write_bytes(small_mcap(chunks, compression, spoil=1))
    log = load(path)
    assert values(stream(log, "n"), "data").tolist() == [*range(5), *range(10, 15)]
    damaged = next(r for r in log.repairs if r.rule == "damaged_record")
    assert damaged.severity == "warning"
    assert "chunk at byte" in damaged.text


def test_a_chunk_that_says_it_unpacks_to_a_terabyte_is_not_unpacked(tmp_path):
    path = tmp_path / "n.mcap"
    data = small_mcap([range(5), range(5, 9)], "lz4")
    size = struct.pack("<Q", len(small_mcap([range(5)])) - len(small_mcap([[]])))
    path.write_bytes(data.replace(size, struct.pack("<Q", 1 << 40), 1))
    log = load(path)
    assert "not plausible" in next(r.text for r in log.repairs if r.rule == "damaged_record")


def test_fewer_messages_than_the_metadata_count_are_told(tmp_path):
    bag = Bag(tmp_path, SQLITE)
    path = bag.write({"/imu": imu_topic(bag)})
    with sqlite3.connect(next(path.glob("*.db3"))) as base:
        base.execute("DELETE FROM messages WHERE id > 30")
    base.close()
    assert "counts 50 messages; 30 are there" in stream(load(path), "imu").truncated


def test_a_folder_without_metadata_is_read_and_marked(tmp_path):
    bag = Bag(tmp_path, MCAP)
    path = bag.write({"/imu": imu_topic(bag)})
    (path / "metadata.yaml").unlink()
    one = stream(load(path), "imu")
    assert len(one) == COUNT
    assert "metadata.yaml" in one.truncated


def test_metadata_that_lead_out_of_the_folder_are_not_followed(tmp_path):
    bag = Bag(tmp_path, MCAP)
    path = bag.write({"/imu": imu_topic(bag)})
    shutil.move(path / "log.mcap", tmp_path / "outside.mcap")
    text = (path / "metadata.yaml").read_text()
    (path / "metadata.yaml").write_text(text.replace("log.mcap", "../outside.mcap"))
    assert "outside.mcap is missing" in faults(path, lambda p: importers.read(p, "bag", NOTHING))


@pytest.mark.parametrize(
    ("start", "said"),
    [
        (b"#ROSBAG V1.2\n" + b"\0" * 50, "V1.2"),
        (b"#ROSBAG V2.0\n", "no whole bag header"),
        (b"\x89MCAP0\r\n", "not closed"),
    ],
)
def test_a_file_that_is_only_a_beginning_is_refused(tmp_path, start, said):
    path = tmp_path / "short.bag"
    path.write_bytes(start)
    assert said in faults(path)


def test_no_code_is_made_of_the_definitions_in_a_bag(tmp_path):
    bag = Bag(tmp_path, ROS1)
    path = bag.write({"/imu": imu_topic(bag)})
    mark = tmp_path / "ran"
    data = path.read_bytes().replace(b"float64 x\n", b'string X="\nimport os\n', 1)
    path.write_bytes(data)
    with pytest.raises(InputError):
        load(path)
    assert not mark.exists()


def test_a_definition_of_another_layout_is_refused_with_the_lengths(tmp_path):
    bag = Bag(tmp_path, ROS1)
    path = bag.write({"/imu": imu_topic(bag)})
    data = path.read_bytes().replace(b"float64 w\n", b"float32 w\n")
    path.write_bytes(data)
    assert "bytes; its definition" in faults(path)


# --- the real fixtures


@pytest.fixture(scope="module")
def real():
    folder = os.environ.get("SIMCOMPARE_DATA")
    if not folder:
        pytest.skip("SIMCOMPARE_DATA is not set: it names the folder of real recordings")
    return Path(folder)


@pytest.mark.parametrize("name", ["example.bag", "example-bz2.bag", "example-lz4.bag"])
def test_a_real_ros_1_bag_has_the_values_that_rosbags_reads(real, name):
    from rosbags.highlevel import AnyReader

    path = real / "rosbag1" / name
    log = load(path)
    wanted = {}
    with AnyReader([path]) as reader:
        for connection, ns, data in reader.messages():
            if connection.topic == "/turtle1/pose":
                message = reader.deserialize(data, connection.msgtype)
                wanted.setdefault("x", []).append(float(message.x))
                wanted.setdefault("theta", []).append(float(message.theta))
                wanted.setdefault("ns", []).append(ns)
    one = stream(log, "turtle1/pose")
    assert np.array_equal(values(one, "x"), wanted["x"])
    assert np.array_equal(values(one, "theta"), wanted["theta"])
    got = np.rint(values(one, one.time) * 1e9).astype(np.int64)
    ns = np.array(wanted["ns"])
    assert np.array_equal(got, ns - START_OF_EXAMPLE_NS)
    assert not one.truncated


def test_the_real_bag_without_messages_is_refused(real):
    assert "holds no messages" in faults(real / "rosbag1" / "no-messages.bag")


def test_a_real_mcap_of_ros_2_has_the_values_that_rosbags_reads(real):
    from rosbags.highlevel import AnyReader

    file = real / "rosbag2/resources/mcap/convert_a/rewriter_a_0.mcap"
    one = stream(load(file), "b_basictypes")
    with AnyReader([file]) as reader:
        wanted = [c for c in reader.connections if c.topic == "b_basictypes"]
        rows = [
            (ns, reader.deserialize(data, connection.msgtype))
            for connection, ns, data in reader.messages(wanted)
        ]
    assert len(rows) == len(one) == 50
    for column in one.columns[1:]:
        wanted = [float(getattr(row, column.name)) for _, row in rows]
        assert np.array_equal(column.values, wanted)
    assert values(one, one.time) == pytest.approx([ns * 1e-9 for ns, _ in rows], abs=1e-12)


@pytest.mark.parametrize("folder", ["mcap/talker", "sqlite3/talker", "mcap/wbag", "sqlite3/wbag"])
def test_real_bags_of_text_are_refused_topic_by_topic(real, folder):
    assert "holds no numbers" in faults(real / "rosbag2/resources" / folder)


def test_long_lists_do_not_become_columns(tmp_path):
    bag = Bag(tmp_path, ROS1)
    layout = bag.make("std_msgs/msg/MultiArrayLayout", dim=[], data_offset=0)
    count = bag_layout.MOST_COLUMNS + 1
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
