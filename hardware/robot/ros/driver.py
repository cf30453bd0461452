"""ROS 2 node of the robot: reads its controller, publishes what it says, and drives its motors.

Not verified on hardware: it was tested with stand-ins for ROS and for the serial line.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import rclpy
import serial
from geometry_msgs.msg import TransformStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import Imu, JointState
from tf2_msgs.msg import TFMessage

from simcompare.hardware.robot.ros.core import Core, Reading, Robot, reading_of

#: how often the motors are told something [s]
PERIOD_S = 0.02


class Driver(Node):  # type: ignore[misc]
    """The node ``driver``: joint_states, imu/data_raw and odom out, cmd_vel in."""

    def __init__(self) -> None:
        super().__init__("driver")
        names = [field.name for field in dataclasses.fields(Robot)]
        values = {name: float(self._parameter(name, math.nan)) for name in names}
        missing = [name for name, value in values.items() if math.isnan(value)]
        if missing:
            raise ValueError(f"parameters of the driver are missing: {', '.join(missing)}")
        self.core = Core(Robot(**values))
        self.line = serial.Serial(
            self._parameter("port", "/dev/ttyUSB0"), self._parameter("baud", 115200), timeout=0
        )
        self._part = b""
        self._joints = self.create_publisher(JointState, "joint_states", 10)
        self._imu = self.create_publisher(Imu, "imu/data_raw", 10)
        self._odometry = self.create_publisher(Odometry, "odom", 10)
        self._frames = self.create_publisher(TFMessage, "/tf", 10)
        self.create_subscription(Twist, "cmd_vel", self.on_twist, 10)
        self.create_timer(PERIOD_S, self.on_timer)

    def _parameter(self, name: str, default: Any) -> Any:  # noqa: ANN401
        return self.declare_parameter(name, default).value

    def _now_s(self) -> float:
        return float(self.get_clock().now().nanoseconds) * 1e-9

    def on_twist(self, twist: Twist) -> None:
        """Takes what the robot is to do."""
        self.core.drive(twist.linear.x, twist.angular.z, self._now_s())

    def on_timer(self) -> None:
        """Reads all whole lines, publishes them, and tells the motors what to do."""
        *lines, self._part = (self._part + self.line.read(4096)).split(b"\n")
        for line in lines:
            reading = reading_of(line.decode("ascii", errors="replace"))
            if reading is None:
                self.get_logger().warning(f"a line was not understood: {line!r}")
                continue
            stamp = self.get_clock().now().to_msg()
            self._publish_imu(reading, stamp)
            if self.core.update(reading):
                self._publish_motion(stamp)
        self.line.write(self.core.command(self._now_s()).encode())

    def _publish_imu(self, reading: Reading, stamp: Any) -> None:  # noqa: ANN401
        message = Imu()
        message.header.stamp, message.header.frame_id = stamp, "imu_link"
        message.orientation_covariance[0] = -1.0  # there is none
        force, rate = message.linear_acceleration, message.angular_velocity
        force.x, force.y, force.z = reading.force_m_s2
        rate.x, rate.y, rate.z = reading.rate_rad_s
        self._imu.publish(message)

    def _publish_motion(self, stamp: Any) -> None:  # noqa: ANN401
        joints = JointState()
        joints.header.stamp = stamp
        joints.name = ["left", "right"]
        joints.position = list(self.core.angles_rad)
        joints.velocity = list(self.core.rates_rad_s)
        self._joints.publish(joints)
        pose = self.core.pose
        odometry = Odometry()
        odometry.header.stamp, odometry.header.frame_id = stamp, "odom"
        odometry.child_frame_id = "base_link"
        place, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
        place.x, place.y = pose.x_m, pose.y_m
        turn.z, turn.w = math.sin(pose.heading_rad / 2), math.cos(pose.heading_rad / 2)
        odometry.twist.twist.linear.x = pose.speed_m_s
        odometry.twist.twist.angular.z = pose.rate_rad_s
        self._odometry.publish(odometry)
        frame = TransformStamped()
        frame.header.stamp, frame.header.frame_id = stamp, "odom"
        frame.child_frame_id = "base_link"
        frame.transform.translation.x, frame.transform.translation.y = pose.x_m, pose.y_m
        frame.transform.rotation.z, frame.transform.rotation.w = turn.z, turn.w
        self._frames.publish(TFMessage(transforms=[frame]))

    def destroy_node(self) -> None:
        """Stops the motors, and ends."""
        self.core.drive(0.0, 0.0, self._now_s())
        self.line.write(self.core.command(self._now_s()).encode())
        self.line.close()
        super().destroy_node()


def main() -> None:
    """Runs the node until Ctrl-C."""
    rclpy.init()
    node = Driver()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
