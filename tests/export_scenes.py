"""Scenes for the tests of the verb export, in which nothing is simple by chance."""

from __future__ import annotations

from simcompare.model.scenario import Scenario

HEAD = {"title": "Scene", "question": "Is it the same?"}
TURNED = [0.5, 0.5, 0.5, 0.5]
SKEW = [0.8, 0.36, -0.48, 0.0]


def moving(mass, inertia, position, *shapes, **more):
    return {"mass_kg": mass, "inertia_kg_m2": inertia, "position_m": position,
            "shapes": list(shapes), **more}  # fmt: skip


def scene(name, bodies, joints=None, **more):
    world = {"duration_s": 1, "step_s": 0.001, **more.pop("world", {})}
    whole = {"name": name, **HEAD, "world": world, "bodies": bodies, "joints": joints or {}, **more}
    return Scenario.model_validate(whole)


def arm(**more):
    """Hinge, slider and fixed joint on a base that stands askew; nothing lies along an axis."""
    bodies = {
        "floor": {"fixed": True, "shapes": [{"type": "plane"}]},
        "base": {"fixed": True, "position_m": [0.1, -0.2, 1.3], "orientation_wxyz": SKEW,
                 "shapes": [{"type": "box", "size_m": [0.1, 0.2, 0.3]}]},
        "upper": moving(1.7, [0.02, 0.03, 0.04], [0.5, 0.1, 1.1],
                        {"type": "capsule", "radius_m": 0.03, "length_m": 0.4,
                         "position_m": [0.01, 0.02, 0.03], "orientation_wxyz": SKEW},
                        orientation_wxyz=TURNED),
        "rod": moving(0.6, [0.004, 0.003, 0.002], [0.8, 0.3, 0.9],
                      {"type": "cylinder", "radius_m": 0.02, "length_m": 0.5}),
        "hand": moving(0.2, [0.0001, 0.0002, 0.00025], [1.0, 0.4, 0.7],
                       {"type": "sphere", "radius_m": 0.05}, orientation_wxyz=SKEW),
    }  # fmt: skip
    joints = {
        "shoulder": {"type": "hinge", "parent": "base", "child": "upper", "damping": 0.3,
                     "anchor_m": [0.05, -0.07, 0.11], "axis": [1, 2, -0.5], "friction": 0.02},
        "reach": {"type": "slider", "parent": "upper", "child": "rod", "axis": [0.3, -1, 0.4],
                  "anchor_m": [0.2, 0.1, -0.1], "stiffness": 5, "rest": 0.1, "armature": 0.02},
        "wrist": {"type": "fixed", "parent": "rod", "child": "hand"},
    }  # fmt: skip
    return scene("arm", bodies, joints, **more)


def cart(**more):
    """A robot on two wheels and a sliding caster, of 0.6 kg."""
    wheel = [1.0921875e-05, 1.584375e-05, 1.0921875e-05]
    ball = {"type": "sphere", "radius_m": 0.0325}
    bodies = {
        "floor": {"fixed": True, "shapes": [{"type": "plane"}]},
        "left_wheel": moving(0.03, wheel, [0, 0.06, 0.0325], ball),
        "chassis": moving(0.54, [0.0008, 0.0008, 0.0014], [-0.02, 0, 0.04],
                          {"type": "sphere", "radius_m": 0.01, "position_m": [-0.06, 0, -0.03]}),
        "right_wheel": moving(0.03, wheel, [0, -0.06, 0.0325], ball),
    }  # fmt: skip
    joints = {
        side: {"type": "hinge", "parent": "chassis", "child": f"{side}_wheel", "axis": [0, 1, 0],
               "anchor_m": [0.02, y, -0.0075]}
        for side, y in (("left", 0.06), ("right", -0.06))
    }  # fmt: skip
    contacts = [{"pair": [f"{side}_wheel", "floor"], "friction": 0.6} for side in joints]
    motor = {"type": "dc_motor", "joint": "left", "input": "volt", "resistance_Ohm": 6,
             "torque_constant_N_m_A": 0.0055, "gear_ratio": 48, "efficiency": 0.35,
             "rotor_friction_N_m": 4e-4, "rotor_damping_N_m_s_rad": 2e-7,
             "rotor_inertia_kg_m2": 1e-7}  # fmt: skip
    parts = {"contacts": contacts, "inputs": {"volt": {"signal": "constant", "value": 2}}, **more}
    if parts.pop("motor", False):
        parts["actuators"] = {"left_motor": motor}
    return scene("cart", bodies, joints, **parts)


def two_free():
    bodies = {name: moving(1, [0.1, 0.1, 0.1], [x, 0, 1]) for name, x in (("a", 0), ("b", 5))}
    return scene("two", bodies)


def sensed():
    sensors = {
        "acc": {"type": "accelerometer", "body": "upper", "position_m": [0.1, 0, 0]},
        "gyro": {"type": "gyroscope", "body": "upper", "orientation_wxyz": SKEW},
        "baro": {"type": "barometer", "body": "rod"},
        "force": {"type": "force", "joint": "wrist"},
        "marks": {"type": "encoder", "joint": "shoulder", "marks": 20},
    }
    return arm(sensors=sensors)


SCENES = {"arm": arm, "cart": cart, "two": two_free, "sensed": sensed,
          "motor": lambda: cart(motor=True)}  # fmt: skip
