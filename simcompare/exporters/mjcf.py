"""MJCF: the model that simcompare itself runs in MuJoCo, with its contact assisted."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree import ElementTree as ET

from simcompare.backends.mujoco.backend import BACKEND
from simcompare.backends.mujoco.mjcf import mjcf
from simcompare.engine.helps.spring_contact import steps_for
from simcompare.exporters import parts
from simcompare.exporters.parts import Twin, number
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings

#: sensors that the model holds
_HELD_SENSORS = ("force", "contact_force")


def write(scenario: Scenario) -> Twin:
    """A scenario as MJCF.

    A contact that bounces is a spring that lasts microseconds, so such a model gets the step that
    the spring needs. simcompare takes that step only during impacts.

    Raises:
        InputError: ball joints, limits of joints, or a name that MuJoCo keeps to itself.
    """
    parts.refuse(scenario, "mjcf", parts.joint_faults(scenario, ball=False, limits=False))
    parts.check_names(scenario, "mjcf", ["world"])
    root = ET.fromstring(mjcf(BACKEND.scene(scenario, Settings())))
    option = root.find("option")
    if bounces(scenario) and option is not None:
        option.set("timestep", number(_step_s(scenario)))
    left_out = tuple(_left_out(scenario))
    text = parts.finish(root, scenario, "mjcf", left_out)
    return Twin(
        scenario.name, "mjcf", text, tuple(scenario.bodies), tuple(scenario.joints), left_out
    )


def bounces(scenario: Scenario) -> bool:
    """Whether any contact has a restitution."""
    return any(contact.restitution > 0 for contact in scenario.contacts)


def _step_s(scenario: Scenario) -> float:
    """Step that the contact needs [s]."""
    return steps_for(scenario, stagger=-0.5).contact_step_s


def _left_out(scenario: Scenario) -> Iterator[str]:
    if bounces(scenario):
        step = _step_s(scenario)
        yield (
            f"steps of {scenario.world.engine_step_s:g} s: the contact that bounces is a spring"
            f" that needs {step:g} s"
        )
    yield from parts.drives(scenario, "set the control of the actuator {joint} to")
    yield from parts.motion_at_start(scenario)
    yield from parts.drag(scenario)
    yield from parts.sensors(scenario, _HELD_SENSORS)
