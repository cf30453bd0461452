"""A ROS 2 package of the robot: description, launch file and driver, from templates."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from string import Template
from xml.sax.saxutils import escape

import yaml

from simcompare.hardware.robot.built import body_of
from simcompare.hardware.robot.description import Robot
from simcompare.hardware.robot.wiring import leads

_HERE = Path(__file__).parent / "ros"
#: what the modules are imported by here; the package has its own name
_OURS = "simcompare.hardware.robot.ros"
#: where the controller's program is
CONTROLLER = "controller/main.py"
#: numbers of pins in it -> the wires that lead there
_WIRES = {
    "left_speed": "driver.PWMA", "left_forward": "driver.AIN1", "left_backward": "driver.AIN2",
    "right_speed": "driver.PWMB", "right_forward": "driver.BIN1", "right_backward": "driver.BIN2",
    "left_barrier": "left_encoder.DO", "right_barrier": "right_encoder.DO",
    "standby": "driver.STBY", "sda": "imu.SDA", "scl": "imu.SCL",
}  # fmt: skip
_MADE = "# made by simcompare\n"


def package_files(robot: Robot, urdf: str) -> Mapping[str, str]:
    """The package as path -> text.

    Args:
        robot: what it is of.
        urdf: the robot's description.
    """
    package = f"{robot.name}_ros"
    words = {
        "package": package, "name": robot.name, "title": robot.title, "frames": _frames(robot),
        "title_xml": escape(robot.title), "title_py": repr(robot.title),
    }  # fmt: skip
    texts = {
        "package.xml": "package.xml.txt", "setup.py": "setup.py.txt", "setup.cfg": "setup.cfg.txt",
        "README.md": "README.md.txt", "launch/robot.launch.py": "launch.py.txt",
    }  # fmt: skip
    made = {path: Template(_read(name)).substitute(words) for path, name in texts.items()}
    for name in ("__init__.py", "core.py", "driver.py"):
        made[f"{package}/{name}"] = _MADE + _read(name).replace(_OURS, package)
    made[f"urdf/{robot.name}.urdf"] = urdf
    made["config/driver.yaml"] = _settings(robot)
    made[f"resource/{package}"] = ""
    made |= _controller(robot)
    return {f"{package}/{path}": text for path, text in made.items()}


def _controller(robot: Robot) -> Mapping[str, str]:
    """What runs on the controller; nothing where it, or a wire that it needs, is another one."""
    pins = {
        f"{one.name}.{one.pin}": one.to_pin.removeprefix("IO")
        for one in leads(robot)
        if one.to_pin.startswith("IO")
    }
    imu = robot.parts.get("imu")
    if imu is None or imu.i2c is None or not pins.keys() >= set(_WIRES.values()):
        return {}
    words = {word: pins[wire] for word, wire in _WIRES.items()}
    text = Template(_read("controller.py.txt")).substitute(words, imu_address=hex(imu.i2c))
    return {CONTROLLER: text}


def _read(name: str) -> str:
    return (_HERE / name).read_text(encoding="utf-8")


def _frames(robot: Robot) -> str:
    """Where body and sensors are, seen from the floor below the axle, as lines of a dictionary."""
    height = robot.wheels.radius_m
    places = {robot.body: body_of(robot).center_m.tolist()}
    places |= {p.frame: p.position_m for p in robot.parts.values() if p.frame is not None}
    return "\n".join(
        f'    "{frame}": ("base_link", ({x:.6g}, {y:.6g}, {z + height:.6g})),'
        for frame, (x, y, z) in places.items()
    )


def _settings(robot: Robot) -> str:
    """Parameters of the driver; a motor needs V = R·(τ_c + b·N·ω)/k + k·N·ω without a load."""
    drive, wheels = robot.motor.drive, robot.wheels
    ohm_per_k = drive.resistance_Ohm / drive.torque_constant_N_m_A
    volts = drive.torque_constant_N_m_A + ohm_per_k * drive.rotor_damping_N_m_s_rad
    values = {
        "port": "/dev/ttyUSB0",
        "baud": 115200,
        "radius_m": wheels.radius_m,
        "track_m": wheels.track_m,
        "marks": float(drive.shaft_marks * drive.gear_ratio),
        "volts_per_rad_s": drive.gear_ratio * volts,
        "start_V": ohm_per_k * drive.rotor_friction_N_m,
        "battery_V": drive.battery_V,
        "gain": 0.5,
        "timeout_s": 0.5,
    }
    settings = {"driver": {"ros__parameters": values}}
    return _MADE + yaml.safe_dump(settings, sort_keys=False)
