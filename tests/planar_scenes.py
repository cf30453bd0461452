"""Small scenes in the x-z plane, and what pymunk makes of them."""

import math

from simcompare.engine import engines
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings

G = 9.80665
FRAME = {"frame": {"fixed": True}}


def body(mass=1.0, inertia=0.01, at=(0, 0, 0), **more):
    return {"mass_kg": mass, "inertia_kg_m2": [inertia] * 3, "position_m": at, **more}


def turned(angle):
    """Quaternion of a turn about +y."""
    return [math.cos(angle / 2), 0, math.sin(angle / 2), 0]


def scene(bodies, joints, duration=0.5, step=1e-3, substeps=1, gravity=G, **more):
    world = {"duration_s": duration, "step_s": step, "substeps": substeps}
    return Scenario.model_validate(
        {
            "name": "toy",
            "title": "Toy",
            "question": "?",
            "world": {**world, "gravity_m_s2": [0, 0, -gravity]},
            "bodies": bodies,
            "joints": joints,
            **more,
        }
    )


def run(scenario, contact="assisted"):
    return engines.get("pymunk").simulate(scenario, Settings(contact))


def signals(*args, **more):
    return run(scene(*args, **more)).signals
