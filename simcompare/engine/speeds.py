"""How fast bodies turn in a scene, as far as its scenario says so."""

from __future__ import annotations

import math

import numpy as np

from simcompare.engine.drives import input_values, laws_of, open_loop
from simcompare.engine.kinematics import in_order
from simcompare.engine.simulation import sample_times
from simcompare.model.scenario import Scenario


def fastest_turn_rad_s(scenario: Scenario) -> float:
    """The fastest turn that a scenario states [rad/s].

    That is a rate at the start, or what motors reach without load, where damping and back-EMF take
    all of their effort; along a chain of joints they add up. What gravity, impacts and efforts
    without damping make of it is not foreseen.
    """
    times, laws = sample_times(scenario), laws_of(scenario)
    inputs = input_values(scenario, times)
    rates = {name: math.hypot(*body.rate_rad_s) for name, body in scenario.free_bodies().items()}
    for name, joint in in_order(scenario).items():
        own, law = abs(joint.rate) if joint.type == "hinge" else 0.0, laws.get(name)
        if joint.type == "hinge" and law is not None and law.gains and law.damping:
            largest = float(np.abs(open_loop({name: law}, inputs, len(times))).max())
            own = max(own, (largest - law.friction) / law.damping)
        rates[joint.child] = rates.get(joint.parent, 0.0) + own
    return max(rates.values(), default=0.0)
