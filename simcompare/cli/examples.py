"""Commands to try for each verb, shown below its options; those with runs/ need a stored run."""

EXAMPLES = {
    "run": (
        "simcompare run ball",
        "simcompare run ball --engine mujoco,pymunk --set drop_height=30cm",
        "simcompare run ball --step 0.5ms,2ms --details --open",
        "simcompare run --resume runs/20260101-120000-ball",
    ),
    "list": ("simcompare list", "simcompare list -v"),
    "show": ("simcompare show ball", "simcompare show robot -v"),
    "doctor": ("simcompare doctor", "simcompare doctor -v"),
    "explain": ("simcompare explain", "simcompare explain tuned"),
    "report": (
        "simcompare report runs/*-ball --open",
        "simcompare report runs/*-ball --format pdf",
    ),
    "compare": ("simcompare compare runs/*-ball",),
    "runs": ("simcompare runs", "simcompare runs --clean --older-than 30d"),
    "characterize": (
        "simcompare characterize bounce --engine mujoco,ode",
        "simcompare characterize --step 2ms --details",
    ),
    "allan": (
        "simcompare allan imu_broad_translation --sheet mpu6050",
        "simcompare allan imu_xio --channel gyr --from 1s --until 12s",
        "simcompare allan stream.csv --audit --sheet mpu6050",
    ),
    "sensor": (
        "simcompare sensor",
        "simcompare sensor mpu6050 --bandwidth 94Hz --open",
        "simcompare sensor mpu6050 --part gyroscope --draw 5",
        "simcompare sensor --template",
    ),
    "estimate": (
        "simcompare estimate robot_motor --engine mujoco",
        "simcompare estimate robot_motor --sensors imu=adxl345 --option bias=0",
        "simcompare estimate odometry --recording robot_labyrinth_exchanged",
    ),
    "gauge": ("simcompare gauge", "simcompare gauge gum_h1 jcgm_101_mass -v"),
    "calibrate": (
        "simcompare calibrate --simulate mpu6050",
        "simcompare calibrate examples/six_positions.csv --gravity 9.8128 --open",
    ),
    "export": (
        "simcompare export robot --format urdf -o robot.urdf",
        "simcompare export ball --format script --engine mujoco -o ball.py",
    ),
    "robot": (
        "simcompare robot --out my_robot",
        "simcompare robot --template",
        "simcompare run robot --robot my.yaml",
    ),
    "import": (
        "simcompare import my_log.csv",
        "simcompare import my_log.csv --template",
    ),
    "fit": (
        "simcompare fit ball --recording examples/ball.wav",
        "simcompare fit ball --recording examples/ball.wav --step 1ms --open",
    ),
    "tune": (
        "simcompare tune --restitution 0.8",
        "simcompare tune --restitution 0.8 --engine mujoco --step 2ms --snippet",
        "simcompare tune --engine mujoco --solref=-119338,-50.87",
    ),
    "validate": (
        "simcompare data fetch pendulum_free_swing",
        "simcompare validate pendulum --recording pendulum_free_swing",
    ),
    "lab": (
        "simcompare lab --open",
        "simcompare lab --share --pin 4711 --folder lesson",
    ),
    "uncertainty": (
        "simcompare uncertainty robot --of acceleration --engine mujoco",
        'simcompare uncertainty robot --u torque=1% --u "wheel_radius=±0.1mm"',
        'simcompare uncertainty --of "m*g*h" --set m=0.2kg --set g=9.81 --set h=1m --u h=2mm',
    ),
}


def epilog(verb: str) -> str:
    """What stands below the options of a verb."""
    # the parser keeps lines apart behind this sign
    return "\n".join(["\b", "Examples:", *(f"  {line}" for line in EXAMPLES.get(verb, ()))])
