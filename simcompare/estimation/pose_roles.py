"""What the pose filter is given, is judged by, and can be told."""

from __future__ import annotations

from dataclasses import dataclass, replace

from simcompare.estimation.estimators import FAR, Option, Role


def _state(what: str, reading: str) -> Option:
    """Whether a constant error of a reading is a state: 1, or 0 where it is not."""
    return Option(f"1: {what}", 0.0, 0.0, 1.0, bias_of=reading)


TITLE = "Pose of a robot on two wheels"
#: what odometry shares
WHEELS = {
    "left_marks": Role("marks of the left wheel that have passed", "1", needed=False),
    "right_marks": Role("marks of the right wheel that have passed", "1", needed=False),
    "left_rate": Role("rate of the left wheel, in place of marks", "rad/s", needed=False),
    "right_rate": Role("rate of the right wheel, in place of marks", "rad/s", needed=False),
}
PLACE = {
    "x": Role("place of the middle of the axle along x", "m", needed=False),
    "y": Role("place of the middle of the axle along y", "m", needed=False),
    "heading": Role("heading", "rad", needed=False),
}
START = {
    "start_x_m": Option("where it starts along x", 0.0, -FAR),
    "start_y_m": Option("where it starts along y", 0.0, -FAR),
    "start_heading_rad": Option("its heading there", 0.0, -FAR),
}
#: in the order of the states
FIRST = {
    **START,
    "start_speed_m_s": Option("its speed there", 0.0, -FAR),
    "start_rate_rad_s": Option("its turning rate there", 0.0, -FAR),
}
_U_START = dict(
    zip(
        FIRST,
        (
            "u_start_m",
            "u_start_m",
            "u_start_heading_rad",
            "u_start_speed_m_s",
            "u_start_rate_rad_s",
        ),
        strict=True,
    )
)
SIGNALS = {
    **WHEELS,
    "turning_rate": Role("reading of the gyroscope about the vertical", "rad/s", needed=False),
    "acceleration": Role("reading of the accelerometer along the robot", "m/s**2", needed=False),
    "left_voltage": Role("voltage at the left motor", "V", needed=False),
    "right_voltage": Role("voltage at the right motor", "V", needed=False),
    "left_current": Role("current of the left motor, in place of the voltage", "A", needed=False),
    "right_current": Role("current of the right motor, in place of the voltage", "A", needed=False),
    "range": Role("range to a beacon", "m", needed=False),
    "beacon_x": Role("place of that beacon along x", "m", needed=False),
    "beacon_y": Role("place of that beacon along y", "m", needed=False),
    "wall_range": Role("range to the wall", "m", needed=False),
}
TRUTHS = {
    # of a mark on the robot, which may lie ahead of the middle of the axle
    **PLACE,
    "speed": Role("speed along the heading", "m/s", needed=False),
    "rate": Role("turning rate", "rad/s", needed=False),
    "acceleration": Role("acceleration along the heading", "m/s**2", needed=False),
    "turn_acceleration": Role("angular acceleration", "rad/s**2", needed=False),
    "velocity": Role("velocity of the mark, in place of the speed", "m/s", 3, needed=False),
}
OPTIONS = {
    "radius_m": Option("radius of the wheels", least=1e-3),
    "track_m": Option("distance of the wheels", least=1e-3),
    "marks": Option("marks in one turn of a wheel", 0.0),
    "gate_s": Option("time in which marks are counted", 0.01, 1e-4),
    "inertia_kg": Option("mass with what wheels and rotors add", 1.0, 1e-9),
    "turning_inertia_kg_m2": Option("the same about the vertical", 1.0, 1e-12),
    "drive_N_V": Option("force of one motor for a volt, at rest", 0.0),
    "damping_N_s_m": Option("what one motor brakes at a given voltage", 0.0),
    "drive_N_A": Option("force of one motor for an ampere", 0.0),
    "current_damping_N_s_m": Option("what one motor brakes at a given current", 0.0),
    "left_motor": Option(
        "part by which the left motor is stronger than told", 0.0, -0.5, 0.5, u="u_motor"
    ),
    "right_motor": Option("the same of the right motor", 0.0, -0.5, 0.5, u="u_motor"),
    "u_motor": Option("standard uncertainty of these parts", 1e-9, 1e-9, 0.5),
    "u_input": Option("the same of the sensors that read voltages or currents", 0.0, 0.0, 0.5),
    "friction_N": Option("friction of rolling and motors", 0.0),
    "load_behind_kg_m": Option("mass, times how far its centre lies behind the axle", 0.0, -FAR),
    "jerk_density_m2_s5": Option(
        "density of what changes unknown accelerations", 1.0, 1e-12, loosens=True
    ),
    "turn_jerk_density_rad2_s5": Option(
        "density of what changes unknown angular accelerations", 10.0, 1e-12, loosens=True
    ),
    "lag_s": Option("time by which accelerations may be earlier or later than the model's", 0.0),
    "settling_s": Option("time in which the motion settles", 1.0, 1e-6),
    **{name: replace(one, u=_U_START[name]) for name, one in FIRST.items()},
    "u_start_m": Option("standard uncertainty of that place", 0.001, 1e-9),
    "u_start_heading_rad": Option("standard uncertainty of that heading", 0.001, 1e-9),
    "u_start_speed_m_s": Option("standard uncertainty of the speed there", 0.1, 1e-9),
    "u_start_rate_rad_s": Option("standard uncertainty of the rate there", 0.1, 1e-9),
    "u_push_m_s2": Option("the same of unknown accelerations there", 1.0, 1e-9),
    "u_turn_rad_s2": Option("the same of unknown angular accelerations", 10.0, 1e-9),
    "ranger_ahead_m": Option("place of the range sensor ahead of the axle", 0.0, -FAR),
    "ranger_left_m": Option("its place to the left", 0.0, -FAR),
    "beam_rad": Option("where it looks, from ahead to the left", 0.0, -FAR),
    "zone_rad": Option("where its beam goes from there; told is how far along", 0.0, -1.5, 1.5),
    "wall_normal_rad": Option("direction from the origin to the wall", 0.0, -FAR),
    "wall_m": Option("distance of the wall from the origin", 0.0, -FAR),
    "mark_ahead_m": Option("how far ahead of the axle the true place was taken", 0.0, -FAR),
    "truth_over_s": Option(
        "speeds are judged by how place and heading change in half of this time, accelerations by"
        " how that differs between its halves; 0: by what is told",
        0.0,
    ),
    "imu_late_s": Option("by how much accelerometer and gyroscope are late", 0.0, 0.0, 1.0),
    "bias": _state("the gyroscope's bias is a state", "turning_rate"),
    "u_bias_rad_s": Option("standard uncertainty of the bias at the start", 0.35, 1e-9),
    "scale": _state("the part by which the gyroscope reads too much is a state", "turning_rate"),
    "u_scale": Option("standard uncertainty of that part at the start", 0.03, 1e-9),
    "acceleration_bias": _state("the accelerometer's bias is a state", "acceleration"),
    "u_acceleration_bias_m_s2": Option("standard uncertainty of it at the start", 0.5, 1e-9),
    "acceleration_scale": _state(
        "the part by which the accelerometer reads too much is a state", "acceleration"
    ),
    "u_acceleration_scale": Option("standard uncertainty of that part at the start", 0.03, 1e-9),
    "accelerometer_ahead_m": Option("place of the accelerometer ahead of the axle", 0.0, -FAR),
    "range_bias": _state("what all ranges read too long is a state", "range"),
    "u_range_bias_m": Option("standard uncertainty of that at the start", 0.1, 1e-9),
    "wall_scale": _state(
        "the part by which ranges to the wall are too long is a state", "wall_range"
    ),
    "u_wall_scale": Option("standard uncertainty of that part at the start", 0.03, 1e-9),
    # 5: one right reading in 1.7 million. √χ²₀.₉₉ = 2.576 refuses one in a hundred; what is left of
    # a right filter's NIS is then 0.925 of what it should be, and the filter is too sure
    "gate": Option(
        "refuse readings beyond so many of their u; 0: none, 2.576: χ² of 99 %", 5.0, 0.0
    ),
}
LABELS = {
    "x_m": "Place along x",
    "y_m": "Place along y",
    "heading_rad": "Heading",
    "speed_m_s": "Speed",
    "rate_rad_s": "Turning rate",
    "acceleration_m_s2": "Acceleration",
    "turn_acceleration_rad_s2": "Angular acceleration",
    "bias_rad_s": "Bias of the gyroscope",
    "gyroscope_scale": "Scale error of the gyroscope",
    "acceleration_bias_m_s2": "Bias of the accelerometer",
    "accelerometer_scale": "Scale error of the accelerometer",
    "range_bias_m": "Bias of the ranges",
    "wall_range_scale": "Scale error of the range to the wall",
}


@dataclass(frozen=True)
class Error:
    """An error of a sensor that stays, and can be a state.

    Attributes:
        option: that makes it one.
        role: of the reading that has it.
        u: option with its standard uncertainty at the start.
        scales: whether it is a part of the reading, and not a constant.
    """

    option: str
    role: str
    u: str
    scales: bool = False


#: in the order of their labels
ERRORS = {
    "bias_rad_s": Error("bias", "turning_rate", "u_bias_rad_s"),
    "gyroscope_scale": Error("scale", "turning_rate", "u_scale", scales=True),
    "acceleration_bias_m_s2": Error(
        "acceleration_bias", "acceleration", "u_acceleration_bias_m_s2"
    ),
    "accelerometer_scale": Error(
        "acceleration_scale", "acceleration", "u_acceleration_scale", scales=True
    ),
    "range_bias_m": Error("range_bias", "range", "u_range_bias_m"),
    "wall_range_scale": Error("wall_scale", "wall_range", "u_wall_scale", scales=True),
}
