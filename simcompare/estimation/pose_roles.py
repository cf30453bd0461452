"""What the pose filter is given, is judged by, and can be told."""

from __future__ import annotations

from simcompare.estimation.estimators import FAR, Option, Role

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
    **PLACE,
    "speed": Role("speed along the heading", "m/s", needed=False),
    "rate": Role("turning rate", "rad/s", needed=False),
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
    "friction_N": Option("friction of rolling and motors", 0.0),
    "speed_noise_m2_s3": Option("density of unknown accelerations", 0.1, 1e-12, loosens=True),
    "turn_noise_rad2_s3": Option(
        "density of unknown angular accelerations", 1.0, 1e-12, loosens=True
    ),
    **START,
    "u_start_m": Option("standard uncertainty of that place", 0.001, 1e-9),
    "u_start_heading_rad": Option("standard uncertainty of that heading", 0.001, 1e-9),
    "u_start_speed_m_s": Option("standard uncertainty of the speed there", 0.1, 1e-9),
    "u_start_rate_rad_s": Option("standard uncertainty of the rate there", 0.1, 1e-9),
    "ranger_ahead_m": Option("place of the range sensor ahead of the axle", 0.0, -FAR),
    "ranger_left_m": Option("its place to the left", 0.0, -FAR),
    "beam_rad": Option("direction of its beam", 0.0, -FAR),
    "wall_normal_rad": Option("direction from the origin to the wall", 0.0, -FAR),
    "wall_m": Option("distance of the wall from the origin", 0.0, -FAR),
    "bias": Option("1: the gyroscope's bias is a state", 0.0, 0.0, 1.0, bias_of="turning_rate"),
    "u_bias_rad_s": Option("standard uncertainty of the bias at the start", 0.35, 1e-9),
    "acceleration_bias": Option(
        "1: the accelerometer's bias is a state", 0.0, 0.0, 1.0, bias_of="acceleration"
    ),
    "u_acceleration_bias_m_s2": Option("standard uncertainty of it at the start", 0.5, 1e-9),
    "accelerometer_ahead_m": Option("place of the accelerometer ahead of the axle", 0.0, -FAR),
    "range_bias": Option(
        "1: what all ranges read too long is a state", 0.0, 0.0, 1.0, bias_of="range"
    ),
    "u_range_bias_m": Option("standard uncertainty of that at the start", 0.1, 1e-9),
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
    "bias_rad_s": "Bias of the gyroscope",
    "acceleration_bias_m_s2": "Bias of the accelerometer",
    "range_bias_m": "Bias of the ranges",
}
