"""What the fields of ROS messages mean: units, frames, covariances; and where types are defined."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from simcompare.hardware.logs.bags.container import Connection

#: type -> its fields as (name, description); a description is what rosbags' parsers return
Types = Mapping[str, list[tuple[str, Any]]]

#: kinds of a description
BASE, NAME, ARRAY, SEQUENCE = 1, 2, 3, 4

_G, _S = "geometry_msgs/msg/", "sensor_msgs/msg/"
#: its units depend on what its joints are
JOINT_STATE = f"{_S}JointState"

#: type -> field -> unit of all that is in it; "*" is every field
UNITS: Mapping[str, Mapping[str, str]] = {
    f"{_G}Point": {"*": "m"},
    f"{_G}Point32": {"*": "m"},
    f"{_G}Quaternion": {"*": "1"},
    f"{_G}Pose2D": {"x": "m", "y": "m", "theta": "rad"},
    f"{_G}Transform": {"translation": "m"},
    f"{_G}Twist": {"linear": "m/s", "angular": "rad/s"},
    f"{_G}Accel": {"linear": "m/s^2", "angular": "rad/s^2"},
    f"{_G}Wrench": {"force": "N", "torque": "N*m"},
    f"{_G}Inertia": {"m": "kg", "com": "m", "*": "kg*m^2"},
    f"{_S}Imu": {"angular_velocity": "rad/s", "linear_acceleration": "m/s^2"},
    f"{_S}MagneticField": {"magnetic_field": "T"},
    f"{_S}FluidPressure": {"fluid_pressure": "Pa"},
    f"{_S}Temperature": {"temperature": "degC"},
    f"{_S}RelativeHumidity": {"relative_humidity": "1"},
    f"{_S}Range": {"range": "m", "min_range": "m", "max_range": "m", "field_of_view": "rad",
                   "radiation_type": "1"},
    f"{_S}LaserScan": {"angle_min": "rad", "angle_max": "rad", "angle_increment": "rad",
                       "time_increment": "s", "scan_time": "s", "range_min": "m",
                       "range_max": "m", "ranges": "m", "intensities": "1"},
    f"{_S}BatteryState": {"voltage": "V", "current": "A", "temperature": "degC",
                          "percentage": "1", "power_supply_status": "1",
                          "power_supply_health": "1", "power_supply_technology": "1",
                          "present": "1", "cell_voltage": "V", "cell_temperature": "degC",
                          "charge": "A*h", "capacity": "A*h", "design_capacity": "A*h"},
    f"{_S}NavSatFix": {"latitude": "deg", "longitude": "deg", "altitude": "m",
                       "position_covariance": "m^2", "position_covariance_type": "1"},
    f"{_S}NavSatStatus": {"*": "1"},
    f"{_S}Joy": {"*": "1"},
    "ackermann_msgs/msg/AckermannDrive": {"steering_angle": "rad", "speed": "m/s",
                                          "steering_angle_velocity": "rad/s",
                                          "acceleration": "m/s^2", "jerk": "m/s^3"},
    "std_msgs/msg/Header": {"seq": "1"},
    "std_msgs/msg/Bool": {"data": "1"},
}  # fmt: skip

#: (type, field) whose parts are given in ``child_frame_id``, not in ``header.frame_id``
IN_CHILD_FRAME = {("nav_msgs/msg/Odometry", "twist")}

#: (type, field) in which ±infinity means "out of range" (REP 117)
OUT_OF_RANGE = {(f"{_S}Range", "range"), (f"{_S}LaserScan", "ranges")}

#: (type, covariance field) -> what its diagonal belongs to, in order
COVARIANCES: Mapping[tuple[str, str], tuple[str, ...]] = {
    (f"{_S}Imu", "orientation_covariance"): ("orientation",),
    (f"{_S}Imu", "angular_velocity_covariance"): ("angular_velocity",),
    (f"{_S}Imu", "linear_acceleration_covariance"): ("linear_acceleration",),
    (f"{_S}MagneticField", "magnetic_field_covariance"): ("magnetic_field",),
    (f"{_G}PoseWithCovariance", "covariance"): ("pose.position", "pose.orientation"),
    (f"{_G}TwistWithCovariance", "covariance"): ("twist.linear", "twist.angular"),
    (f"{_G}AccelWithCovariance", "covariance"): ("accel.linear", "accel.angular"),
}

#: (type, variance field) -> the number it belongs to
VARIANCES: Mapping[tuple[str, str], str] = {
    (f"{_S}FluidPressure", "variance"): "fluid_pressure",
    (f"{_S}Temperature", "variance"): "temperature",
    (f"{_S}RelativeHumidity", "variance"): "relative_humidity",
    (f"{_S}Range", "variance"): "range",
}

#: types that hold no measured numbers, with the reason why they are left out
NOT_MEASURED: Mapping[str, str] = {
    "rosgraph_msgs/msg/Log": "holds text",
    "rcl_interfaces/msg/Log": "holds text",
    "rosgraph_msgs/msg/Clock": "is the clock of a simulation",
    f"{_S}Image": "holds pictures",
    f"{_S}CompressedImage": "holds pictures",
    f"{_S}CameraInfo": "holds the calibration of a camera",
    "tf2_msgs/msg/TFMessage": "holds transforms of several frames in one message",
    "tf/msg/tfMessage": "holds transforms of several frames in one message",
}

#: fields of a point that are a length
LENGTHS = ("x", "y", "z", "range", "distance")

#: distributions whose definitions are tried for bags that hold none, the bag's own first
_DISTRIBUTIONS = ("humble", "jazzy")


class NotDefined(Exception):
    """The definition of a type is missing or cannot be read."""


def unit_of(kind: str, field: str, inherited: str) -> str:
    """Unit of a field of a type."""
    table = UNITS.get(kind, {})
    return table.get(field) or table.get("*") or inherited


def definitions(connection: Connection, distribution: str) -> list[tuple[str, Types]]:
    """Definitions that may fit the messages of a connection: (where they come from, types).

    Raises:
        NotDefined: none is known.
    """
    if connection.schema and connection.language in ("msg", "idl"):
        return [("", _parsed(connection))]
    if connection.schema:
        raise NotDefined(f"its definition is in {connection.language!r}; known: ROS msg and IDL")
    return _shipped(connection.kind, distribution)


def _parsed(connection: Connection) -> Types:
    """Types from the text in the bag; it is parsed, and no code is made of it."""
    from rosbags.typesys import get_types_from_idl, get_types_from_msg

    try:
        if connection.language == "msg":
            parsed = get_types_from_msg(connection.schema, connection.kind)
        else:
            parsed = {}
            line = "=" * 80 + "\n"
            for part in connection.schema.split(line):
                text = part.split("\n", 1)[-1] if part.startswith("IDL: ") else part
                if text.strip():
                    parsed.update(get_types_from_idl(text))
    # the parsers raise many kinds for text that is no definition
    except (Exception, RecursionError) as error:  # noqa: BLE001
        text = str(error).splitlines()[0][:200] if str(error) else type(error).__name__
        raise NotDefined(f"the definition of {connection.kind} cannot be read: {text}") from None
    if connection.kind not in parsed:
        raise NotDefined(f"the bag holds no definition of {connection.kind}")
    return {name: fields for name, (_, fields) in parsed.items()}


def _shipped(kind: str, distribution: str) -> list[tuple[str, Types]]:
    from rosbags.typesys import Stores, get_typestore

    known = {store.name.removeprefix("ROS2_").lower(): store for store in Stores}
    wanted = dict.fromkeys((distribution, *_DISTRIBUTIONS))
    definitions: list[tuple[str, Types]] = []
    for name in wanted:
        types = get_typestore(known[name]).fielddefs if name in known else {}
        if kind in types:
            definitions.append((name, {key: fields for key, (_, fields) in types.items()}))
    if not definitions:
        raise NotDefined(f"the bag holds no definition of {kind}, and it is no standard type")
    return definitions
