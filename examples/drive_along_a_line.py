"""A speed controller drives the robot along a line, the same one on every engine.

    python examples/drive_along_a_line.py

The robot's right motor is 10 % weaker than its left one. A proportional-integral controller holds
0.3 m/s by the common torque, and a proportional-derivative one keeps the heading by the difference
of the torques. Engines in a plane run the one-wheeled variant, where there is no heading to keep.
"""

import math

import simcompare
from simcompare.engine import engines
from simcompare.errors import EngineMissing, Unsupported

SPEED_M_S = 0.3
WEAKER = 0.9


class AlongALine:
    """Torques from speed, heading and rate; made anew for each run, since it remembers."""

    def __init__(self, step_s=0.001):
        self.step_s, self.integral = step_s, 0.0

    def __call__(self, time_s, readings):
        error = SPEED_M_S - readings["chassis.velocity_m_s"][0]
        self.integral += error * self.step_s
        common = 0.2 * error + 0.1 * self.integral
        if "left.rate_rad_s" not in readings:
            return {"drive": 2 * common}
        w, _, _, z = readings["chassis.orientation_wxyz"]
        heading, turning = 2 * math.atan2(z, w), readings["chassis.rate_rad_s"][2]
        difference = 0.02 * heading + 0.005 * turning
        return {"left_drive": common + difference, "right_drive": WEAKER * (common - difference)}


def main():
    for engine in engines.names():
        for scenario in ("robot", "robot_planar"):
            try:
                found = simcompare.control(scenario, AlongALine(), engine=engine)
            except EngineMissing as error:
                print(error)
                break
            except Unsupported:
                continue
            x, y, _ = found.signals["chassis.position_m"][-1]
            speed = found.signals["chassis.velocity_m_s"][-1, 0]
            print(
                f"{engine:9} {scenario:13} after {found.time_s[-1]:.2f} s: "
                f"{speed:.4f} m/s, {x:.3f} m along the line, {1000 * y:+.3f} mm beside it"
            )
            break


if __name__ == "__main__":
    main()
