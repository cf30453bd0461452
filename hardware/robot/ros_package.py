"""A ROS 2 package of the robot: description, launch file and driver, from templates."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from string import Template

import yaml

from simcompare.hardware.robot.built import body_of
from simcompare.hardware.robot.description import Robot

_HERE = Path(__file__).parent / "ros"
#: what the modules are imported by here; the package has its own name
_OURS = "simcompare.hardware.robot.ros"
_MADE = "# made by simcompare\n"


def package_files(robot: Robot, urdf: str) -> Mapping[str, str]:
    """The package as path -> text.

    Args:
        robot: what it is of.
        urdf: the robot's description.
    """
    package = f"{robot.name}_ros"
    words = {"package": package, "name": robot.name, "title": robot.title, "frames": _frames(robot)}
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
    return {f"{package}/{path}": text for path, text in made.items()}


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
