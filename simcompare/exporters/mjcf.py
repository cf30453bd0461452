"""MJCF: the model that simcompare itself runs in MuJoCo, with its contact assisted."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree import ElementTree as ET

from simcompare.backends.mujoco.backend import BACKEND
from simcompare.backends.mujoco.mjcf import mjcf, shape_attributes
from simcompare.engine.helps.spring_contact import steps_for
from simcompare.engine.kinematics import vector_of
from simcompare.engine.range_sensing import REACH_M, rays_of
from simcompare.exporters import parts
from simcompare.exporters.parts import Twin, add, number, numbers
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings

#: sensors that the model holds
_HELD_SENSORS = ("force", "contact_force", "time_of_flight")


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
    for name in scenario.range_sensors():
        _add_rangefinders(root, scenario, name)
    _add_looks(root, scenario)
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


def _add_rangefinders(root: ET.Element, scenario: Scenario, name: str) -> None:
    """A site for each zone, which looks along its z axis, and what it reads."""
    sensor = scenario.sensors[name]
    body, readings = root.find(f".//body[@name='{sensor.body}']"), root.find("sensor")
    assert body is not None
    assert readings is not None
    comment = (
        f" {name}: distances along the ray of each zone, the reach beyond it, -1 where there is"
        " nothing at all; along the axis, as simcompare tells them, they are shorter by the cosine"
        " between ray and axis "
    )
    readings.append(ET.Comment(comment))
    reach_m, place = sensor.reach_m or REACH_M, numbers(sensor.position_m)
    for zone, (ray, length) in enumerate(zip(*rays_of(sensor), strict=True)):
        along = parts.turned(sensor.orientation_wxyz, vector_of(ray))
        own = f"{name}_{zone}"
        add(body, "site", name=own, pos=place, zaxis=numbers(along), size="0.001")
        far = number(reach_m * float(length))
        add(readings, "rangefinder", name=own, site=own, cutoff=far)


def _add_looks(root: ET.Element, scenario: Scenario) -> None:
    """Shapes that are only seen: they have no mass, and touch nothing.

    MuJoCo's rays meet them, except on the body that carries the sensor. So where a range sensor
    looks, no other body gets them.
    """
    carriers = {scenario.sensors[name].body for name in scenario.range_sensors()}
    for name, body in scenario.bodies.items():
        element = root.find(f".//body[@name='{name}']")
        assert element is not None
        for i, shape in enumerate(body.visual if not carriers or name in carriers else ()):
            seen = {"contype": "0", "conaffinity": "0", "mass": "0", "group": "1"}
            add(element, "geom", name=f"{name}.visual.{i}", **shape_attributes(shape), **seen)


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
