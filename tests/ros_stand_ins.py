"""Stand-ins for ROS 2 and a serial line: messages by ROS's own definitions, and a robot of sums."""

from __future__ import annotations

import math
import sys
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

PACKAGES = {
    "geometry_msgs": ("TransformStamped", "Twist"),
    "nav_msgs": ("Odometry",),
    "sensor_msgs": ("Imu", "JointState"),
    "tf2_msgs": ("TFMessage",),
}


class Definitions:
    """Classes of messages that take only what their definition has, of the type that it has."""

    def __init__(self):
        typesys = pytest.importorskip("rosbags.typesys")
        self.types = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)

    def kind(self, name):
        fields = dict(self.types.fielddefs[name][1])

        def set_field(message, field, value):
            assert field in fields, f"{name} has no {field}"
            assert self._fits(fields[field], value), f"{name}.{field} does not take {value!r}"
            object.__setattr__(message, field, value)

        def init(message, **given):
            for field, definition in fields.items():
                object.__setattr__(message, field, self._empty(definition))
            if name.endswith("Quaternion"):
                object.__setattr__(message, "w", 1.0)
            for field, value in given.items():
                setattr(message, field, value)

        return type(name, (), {"__setattr__": set_field, "__init__": init, "kind": name})

    def _empty(self, definition):
        what, of = definition
        match what.name:
            case "NAME":
                return self.kind(of)()
            case "BASE":
                return {"string": "", "float64": 0.0}.get(of[0], 0)
            case "ARRAY":
                return np.zeros(of[1])
            case _:
                return []

    def _fits(self, definition, value):
        what, of = definition
        match what.name:
            case "NAME":
                return getattr(value, "kind", None) == of
            case "BASE":
                kinds = {"string": str, "float64": float}
                return isinstance(value, kinds.get(of[0], int)) and value == value
            case _:
                return all(self._fits(of[0], one) for one in value)

    def wire(self, message):
        """What a message is on the wire, read back from there: that it can be sent."""
        raw = self.types.serialize_cdr(self._plain(message), message.kind)
        return self.types.deserialize_cdr(raw, message.kind)

    def _plain(self, value):
        if isinstance(value, list):
            if value and isinstance(value[0], float):
                return np.array(value)
            return [self._plain(one) for one in value] or np.zeros(0)
        if not hasattr(value, "kind"):
            return value
        fields = {name: self._plain(getattr(value, name))
                  for name, _ in self.types.fielddefs[value.kind][1]}  # fmt: skip
        if value.kind.endswith("JointState"):
            fields["name"] = value.name
        return self.types.types[value.kind](**fields)


class Controller:
    """The robot's controller and motors, as far as its lines tell.

    Args:
        settings: parameters of the driver. checksum: of its lines. load_V: that a motor needs more
        than without a load.
    """

    def __init__(self, settings, checksum, load_V=0.0):
        self.settings, self.checksum, self.load_V = settings, checksum, load_V
        self.time_us, self.turned, self.rates = 5_000_000, [0.0, 0.0], [0.0, 0.0]
        self.told, self.noise, self.is_open = [], b"", True

    def read(self, _):
        marks = [int(turn / (2 * math.pi) * self.settings["marks"]) for turn in self.turned]
        counts = f"{marks[0]} {marks[1]} 0 0 16384 0 0 131"
        line, self.noise = self.noise + self.checksum(f"S {self.time_us} {counts}").encode(), b""
        return line

    def write(self, raw):
        text, _, _ = raw.decode().partition("*")
        assert raw.decode() == self.checksum(text)
        parts = [int(part) for part in text.split()[1:]]
        self.told.append(parts)
        self._move(parts, 0.02)

    def _move(self, parts, span_s):
        """Rates that follow at once; a barrier counts marks whichever way the wheel turns."""
        rest = self.settings["start_V"] + self.load_V
        for i, part in enumerate(parts):
            volts = abs(part) / 1000 * self.settings["battery_V"]
            self.rates[i] = max(0.0, volts - rest) / self.settings["volts_per_rad_s"]
            self.turned[i] += self.rates[i] * span_s
        self.time_us += round(span_s * 1e6)

    def close(self):
        self.is_open = False


class Node:
    """What the driver is made from: it knows the ``ros`` that it stands in."""

    ros: Ros

    def __init__(self, name):
        assert name == "driver"

    def declare_parameter(self, name, default):
        return SimpleNamespace(value=self.ros.settings.get(name, default))

    def create_publisher(self, kind, topic, depth):
        def publish(message):
            assert type(message) is kind
            self.ros.sent.setdefault(topic, []).append(self.ros.definitions.wire(message))

        return SimpleNamespace(publish=publish)

    def create_subscription(self, kind, topic, call, depth):
        assert topic == "cmd_vel"

    def create_timer(self, period_s, call):
        assert period_s == 0.02

    def get_logger(self):
        return SimpleNamespace(warning=self.ros.warnings.append)

    def get_clock(self):
        ns = self.ros.now_ns
        stamp = self.ros.definitions.kind("builtin_interfaces/msg/Time")
        made = stamp(sec=ns // 10**9, nanosec=ns % 10**9)
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=ns, to_msg=lambda: made))

    def destroy_node(self):
        pass


class Ros:
    """Modules that the driver imports, in place of ROS's own."""

    def __init__(self, definitions, settings):
        self.definitions, self.settings = definitions, settings
        self.sent, self.warnings, self.now_ns = {}, [], 10**9

    def install(self, monkeypatch, make_line):
        node = type("Node", (Node,), {"ros": self})
        modules = {"rclpy": {}, "rclpy.node": {"Node": node}, "serial": {"Serial": make_line}}
        for package, names in PACKAGES.items():
            kinds = {name: self.definitions.kind(f"{package}/msg/{name}") for name in names}
            modules |= {package: {}, f"{package}.msg": kinds}
        for name, members in modules.items():
            module = ModuleType(name)
            vars(module).update(members)
            monkeypatch.setitem(sys.modules, name, module)
