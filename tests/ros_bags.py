"""ROS bags that tests write with rosbags, and how they look into what was read."""

from __future__ import annotations

import math

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware.conditioning.condition import condition
from simcompare.hardware.logs import importers
from simcompare.hardware.mapping import NOTHING
from simcompare.model.recording import Provenance

START_NS = 1_700_000_000_123_456_789
STEP_NS = 10_000_001
COUNT = 50

ROS1, SQLITE, MCAP = "ros1", "sqlite3", "mcap"
CONTAINERS = (ROS1, SQLITE, MCAP)


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


def joint_state(bag, ns, names, position, velocity=(), effort=()):
    return bag.make(
        "sensor_msgs/msg/JointState", header=bag.header(ns, ""), name=list(names),
        position=np.array(position, float), velocity=np.array(velocity, float),
        effort=np.array(effort, float),
    )  # fmt: skip


def range_message(bag, ns, distance):
    return bag.make(
        "sensor_msgs/msg/Range", header=bag.header(ns, "front"), radiation_type=1,
        field_of_view=0.5, min_range=0.25, max_range=4.0, range=distance,
    )  # fmt: skip
