"""What tests of saving share: a box, steps, and a ball that is saved within an impact."""

import numpy as np

from simcompare.model.settings import ASSISTED, Settings
from simcompare.scenarios import catalogue

EDGE = 0.04


def box(place, **more):
    return {
        "mass_kg": 0.1, "inertia_kg_m2": [2.7e-5, 2.7e-5, 2.7e-5],
        "position_m": [0.002 * place, 0, EDGE * (place + 0.5)],
        "shapes": [{"type": "box", "size_m": [EDGE, EDGE, EDGE]}], **more,
    }  # fmt: skip


def stepped(simulation, count):
    """Everything that is read after each of some steps."""
    found = []
    for _ in range(count):
        simulation.step()
        found.append(np.hstack(list(simulation.read().values())))
    return np.array(found)


def recorded(simulation, count):
    """Motion and forces of some steps, which an engine may take in one native call."""
    return np.asarray(simulation.record(count), dtype=float)


def bounces_as_before_the_impact(engine):
    """Saves a ball before the step of its first impact, and asks that it bounces twice alike."""
    simulation = engine.open(catalogue.load("ball").resolve({}), Settings(ASSISTED))
    while simulation.read()["ball.velocity_m_s"][2] < 1:  # it falls
        before = simulation.save()
        simulation.step()
    bounced = stepped(simulation, 20)
    simulation.restore(before)  # the impact is within the next step
    assert simulation.read()["ball.velocity_m_s"][2] < -1
    simulation.step()
    assert np.array_equal(stepped(simulation, 20), bounced)
    simulation.close()
