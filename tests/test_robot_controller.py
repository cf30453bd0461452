"""The program of the robot's controller, with stand-ins for MicroPython."""

from __future__ import annotations

import math
from types import ModuleType, SimpleNamespace

import pytest
import yaml

from simcompare.hardware.robot import robot_file, ros_package
from simcompare.hardware.robot.description import Robot
from simcompare.hardware.robot.ros import core
from tests.micropython_stand_in import I2C, PWM, Clock, Line, Pin


def program(robot):
    files = ros_package.package_files(robot, "")
    return files.get("robot_ros/controller/main.py")


@pytest.fixture
def started(monkeypatch):
    """Runs the program for some loops of 10 ms: ``started(loops) -> (lines, clock, line)``."""
    monkeypatch.setattr(Pin, "made", {})
    clock, line = Clock(2**30 - 35_000), Line()
    text = program(robot_file.read())
    module = ModuleType("main")
    found = {
        "machine": SimpleNamespace(I2C=I2C, PWM=PWM, Pin=Pin),
        "time": clock,
        "select": SimpleNamespace(poll=line.poll, POLLIN=Line.POLLIN),
        "sys": SimpleNamespace(stdin=line, stdout=line.out),
    }
    for name, stand_in in found.items():
        monkeypatch.setitem(__import__("sys").modules, name, stand_in)
    exec(compile(text, "main.py", "exec"), module.__dict__)
    monkeypatch.undo()
    Pin.made.clear()

    def run(loops, on_sleep=lambda: None):
        clock.on_sleep = on_sleep
        module.run(loops)
        return line.out.getvalue().splitlines()

    return run, line


def test_its_lines_are_those_that_the_driver_reads(started):
    run, _ = started

    def turn():
        for _ in range(3):
            Pin.made[34].handler(Pin.made[34])
        Pin.made[35].handler(Pin.made[35])

    readings = [core.reading_of(line) for line in run(10, turn)]
    assert None not in readings
    # the clock has turned back to 0 on the way, and time goes on
    assert [one.time_s for one in readings] == pytest.approx([0.01 * i for i in range(10)])
    assert readings[-1].marks == (27, 9)
    assert readings[-1].force_m_s2 == pytest.approx((0, 0, 9.80665))
    assert readings[-1].rate_rad_s == pytest.approx((0, 0, math.radians(1)))


def test_it_drives_as_the_driver_tells(started):
    run, line = started
    line.typed = core.with_checksum("M 500 -1000")
    run(1)
    duties = {number: pin.pwm.duty for number, pin in Pin.made.items() if hasattr(pin, "pwm")}
    assert duties == {25: 32767, 13: 65535}
    assert {n: Pin.made[n].level for n in (26, 27, 32, 33, 14)} == {
        26: 1,
        27: 0,
        32: 0,
        33: 1,
        14: 1,
    }


@pytest.mark.parametrize(
    "text", ["M 500 500*00\n", "M 500*4A\n", "M a b*50\n", "\n", "x" * 1000 + "\n"]
)
def test_damaged_lines_move_nothing(started, text):
    run, line = started
    line.typed = text
    run(1)
    assert Pin.made[25].pwm.duty == Pin.made[13].pwm.duty == 0


def test_it_stops_when_nobody_tells_it_anything(started):
    run, line = started
    line.typed = core.with_checksum("M 500 500")
    run(52)
    assert Pin.made[25].pwm.duty == 0


def test_another_wiring_gets_no_program_that_is_not_its_own():
    tree = yaml.safe_load(robot_file.OWN.read_text(encoding="utf-8"))
    del tree["parts"]["driver"]["wires"]["PWMA"]
    assert program(Robot.model_validate(tree)) is None
    tree["parts"]["driver"]["wires"]["PWMA"] = ["board.IO23", "out"]
    assert "Wheel(23, 26, 27, 34)" in program(Robot.model_validate(tree))
