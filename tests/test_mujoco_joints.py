"""What MuJoCo is given and what it holds, where its own ways would tell otherwise."""

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, DEFAULT, Settings

MUJOCO = engines.get("mujoco")
G = 9.80665


def scene(bodies, duration_s=0.3, **parts):
    tree = {
        "name": "toy", "title": "Toy", "question": "What does it read?",
        "world": {"duration_s": duration_s, "step_s": 0.001}, "bodies": bodies, **parts,
    }  # fmt: skip
    return Scenario.model_validate(tree)


def solid(**more):
    return {"mass_kg": 0.1, "inertia_kg_m2": [1e-4, 1e-4, 1e-4], **more}


FLOOR = {"fixed": True, "shapes": [{"type": "plane"}]}


def test_a_body_on_many_points_is_weighed_with_all_of_them():
    box = {"type": "box", "size_m": [0.02, 0.02, 0.02]}
    table = solid(
        position_m=[0, 0, 0.01],
        shapes=[{**box, "position_m": place} for place in ([0, 0, 0], [0.1, 0, 0], [0, 0.1, 0])],
        inertia_kg_m2=[1e-3, 1e-3, 1e-3],
    )
    # twelve corners touch; the centre of mass is above the first box, at its edge of support
    scenario = scene(
        {"floor": FLOOR, "table": table},
        contacts=[{"pair": ["table", "floor"], "friction": 0.5}],
        sensors={"scale": {"type": "contact_force", "pair": ["table", "floor"]}},
    )
    found = MUJOCO.simulate(scenario, Settings()).signals["scale.normal_force_N"]
    assert found[-1] == pytest.approx(0.1 * G, rel=1e-6)


@pytest.mark.parametrize("mode", [ASSISTED, DEFAULT])
def test_moving_bodies_touch_where_a_contact_names_them_and_else_only_by_default(mode):
    ball = {"type": "sphere", "radius_m": 0.05}

    def gap(contacts):
        scenario = scene(
            {"rail": {"fixed": True}, "one": solid(shapes=[ball]),
             "two": solid(shapes=[ball], position_m=[0.2, 0, 0])},
            joints={
                "left": {"type": "slider", "parent": "rail", "child": "one", "axis": [1, 0, 0],
                         "rate": 1.0},
                "right": {"type": "slider", "parent": "rail", "child": "two", "axis": [1, 0, 0]},
            },
            contacts=contacts,
        )  # fmt: skip
        found = MUJOCO.simulate(scenario, Settings(mode)).signals
        return found["two.position_m"][-1, 0] - found["one.position_m"][-1, 0]

    assert gap([{"pair": ["one", "two"]}]) > 0.09
    assert (gap([]) > 0.09) == (mode == DEFAULT)


def test_joints_are_read_back_with_axis_anchor_spring_and_damper():
    scenario = scene(
        {"post": {"fixed": True, "orientation_wxyz": [0.6, 0, 0.8, 0]},
         "arm": solid(position_m=[0.1, 0.2, 0.3])},
        joints={"pivot": {"type": "hinge", "parent": "post", "child": "arm", "axis": [1, 2, 2],
                          "anchor_m": [0.1, 0, 0], "stiffness": 2.0, "rest": 0.3, "damping": 0.1,
                          "friction": 0.01, "armature": 1e-3}},
    )  # fmt: skip
    simulation = MUJOCO.open(scenario, Settings())
    simulation.close()
    held = {row.quantity: row.read_value for row in simulation.audit}
    assert held["pivot.rest"] == 0.3
    assert held["pivot.damping"] == pytest.approx(0.1)
    axis = [held[f"pivot.axis.{c}"] for c in "xyz"]
    assert np.linalg.norm(axis) == pytest.approx(1)
    assert held["pivot.anchor_m.x"] is not None


def test_a_spring_and_damper_are_of_second_order():
    errors = []
    for step_s in (0.004, 0.002):
        scenario = scene(
            {"wall": {"fixed": True}, "cart": solid()},
            joints={"slide": {"type": "slider", "parent": "wall", "child": "cart",
                              "axis": [1, 0, 0], "stiffness": 10.0, "damping": 0.4, "rest": 0.1}},
        )  # fmt: skip
        world = scenario.world.model_copy(update={"step_s": step_s, "duration_s": 0.6})
        found = MUJOCO.simulate(scenario.model_copy(update={"world": world}), Settings())
        t = found.time_s
        decay, omega = 2.0, np.sqrt(100 - 4.0)
        truth = 0.1 * (
            1 - np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))
        )
        errors.append(np.abs(found.signals["slide.position_m"] - truth).max())
    assert 3.3 < errors[0] / errors[1] < 4.7
