"""Armature on bodies that turn: engines that have none, beside one that has."""

import math

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.errors import Unsupported
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings

SPATIAL, ALL = ("dart", "ode", "pybullet"), ("dart", "ode", "pybullet", "pymunk")


def scene(planar, step, driven, armature=0.002, sensed=False):
    """Three bodies on hinges, all of which tumble."""

    def part(at, moments, turn=(0.3, -0.5, 0.8)):
        axis, angle = ((0, 1, 0), turn[0]) if planar else (np.array(turn), np.linalg.norm(turn))
        unit = np.array(axis) / np.linalg.norm(axis)
        return {
            "mass_kg": 0.6,
            "inertia_kg_m2": moments,
            "position_m": (at[0], 0 if planar else at[1], at[2]),
            "orientation_wxyz": (math.cos(angle / 2), *(math.sin(angle / 2) * unit)),
        }

    root = part((0, 0, 0), (4e-3, 5e-3, 6e-3), (0.0, 0.0, 1e-9))
    spin = {"velocity_m_s": (0.2, 0, 0.1), "rate_rad_s": (0, 3, 0) if planar else (2, -3, 1)}
    bodies = {
        "root": {**root, **spin},
        "arm": part((0.2, 0.1, -0.1), (5e-3, 4e-3, 6e-3), (0.0, 0.0, 1e-9)),
        "tip": part((0.3, -0.2, 0.2), (5e-3, 6e-3, 4e-3), (0.0, 0.0, 1e-9)),
    }
    first = (0, 1, 0) if planar else (1, 0, 0)
    law = {"damping": 0.02, "stiffness": 0.5} if driven else {}
    hinge = {"type": "hinge", "armature": armature, **law}
    joints = {
        "one": {**hinge, "parent": "root", "child": "arm", "axis": first, "rate": 2.0,
                "anchor_m": (0.1, 0, 0)},
        "two": {**hinge, "parent": "arm", "child": "tip", "axis": (0, -1, 0), "rate": -1.5},
    }  # fmt: skip
    more = {}
    if driven:
        more["inputs"] = {"u": {"signal": "sine", "amplitude": 0.5, "frequency_Hz": 2.0}}
        more["actuators"] = {"motor": {"type": "torque", "joint": "one", "input": "u"}}
    if sensed:
        more["sensors"] = {"cell": {"type": "force", "joint": "two"}}
    world = {"duration_s": 0.2, "step_s": step, "gravity_m_s2": (0, 0, -9.8)}
    told = {"name": "toy", "title": "Toy", "question": "?", "world": world, **more}
    return Scenario.model_validate({**told, "bodies": bodies, "joints": joints})


def run(engine, scenario, contact="assisted"):
    return engines.get(engine).simulate(scenario, Settings(contact))


def largest(found, truth, every, part):
    return max(
        np.abs(values - truth.signals[name][::every]).max()
        for name, values in found.signals.items()
        if name.endswith(part)
    )


@pytest.mark.parametrize("driven", [True, False])
@pytest.mark.parametrize(
    ("engine", "planar"), [(e, False) for e in SPATIAL] + [(e, True) for e in ALL]
)
def test_armature_on_tumbling_bodies_comes_closer_with_the_step(engine, planar, driven):
    truth = run("mujoco", scene(planar, 2e-5, driven))
    coarse, fine = (run(engine, scene(planar, h, driven)) for h in (1e-3, 5e-4))
    assert not fine.notes
    for part, limit in (("position_m", 4e-4), ("angle_rad", 3e-3)):
        wrong, less = largest(coarse, truth, 50, part), largest(fine, truth, 25, part)
        assert less < limit
        assert wrong / less > 1.7 or less < 3e-5


@pytest.mark.parametrize("engine", ALL)
def test_forces_on_tumbling_bodies_know_of_the_armature(engine):
    truth = run("mujoco", scene(True, 1e-4, True, sensed=True)).signals["cell.force_N"]
    found = run(engine, scene(True, 5e-4, True, sensed=True)).signals["cell.force_N"]
    # a joint of bodies that have coordinates of their own must first find that they go round
    late = 4 if engine == "ode" else 0
    assert np.abs(found - truth[::5])[late:].max() < 0.01 * np.abs(truth).max()


@pytest.mark.parametrize("engine", ALL)
def test_armature_that_outweighs_its_parent_is_refused_or_told_of(engine):
    with pytest.raises(Unsupported, match=r"armature of one, two .* on root, arm would lag"):
        run(engine, scene(True, 1e-3, False, armature=0.1))
    (note,) = run(engine, scene(True, 1e-3, False, armature=0.01)).notes
    assert "armature of one, two" in note


@pytest.mark.parametrize("engine", ALL)
def test_without_its_recoil_a_note_names_the_joints(engine):
    (note,) = run(engine, scene(True, 1e-3, False), "default").notes
    assert "one, two" in note
    assert "no recoil" in note


@pytest.mark.parametrize("engine", ALL)
def test_a_state_brings_recoil_back(engine):
    simulation = engines.get(engine).open(scene(True, 1e-3, True), Settings())
    for _ in range(20):
        simulation.step()
    start, ends = simulation.state, []
    for _ in range(2):
        simulation.set_state(start)
        for _ in range(20):
            simulation.step()
        ends.append(simulation.state.bodies["tip"].position_m)
    simulation.close()
    assert ends[0] == pytest.approx(ends[1], rel=1e-12)
