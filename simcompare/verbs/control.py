"""A controller in the loop: it reads the sensors and sets the inputs before each recorded step."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from pathlib import Path

from simcompare import units
from simcompare.arguments import checked
from simcompare.comparison.repeats import check_sample_step, one_step_s
from simcompare.engine import engines
from simcompare.engine.simulation import Controller
from simcompare.errors import InputError, UnknownName
from simcompare.model.settings import ASSISTED, CONTACT_LEVELS, Settings
from simcompare.scenarios import catalogue, robot_values
from simcompare.verbs.controlled import Controlled


@checked
def control(
    scenario: str | Path,
    controller: Controller,
    *,
    engine: str,
    contact: str = ASSISTED,
    set: Mapping[str, str | float] | None = None,
    robot: str | Path | None = None,
    preset: str | None = None,
    step: str | float | None = None,
    every: str | float | None = None,
) -> Controlled:
    """Runs a scenario on one engine with a controller in the loop.

    ::

        def push(time_s, readings):
            return {"left_drive": 0.01, "right_drive": 0.01}
        simcompare.control("robot", push, engine="mujoco").plot()

    Args:
        scenario: name, folder or file.
        controller: called as ``controller(time_s, readings)`` before each recorded step.
            ``readings`` has every signal by name, a number or a tuple of its components, such as
            ``readings["chassis.velocity_m_s"]``; what is not asked for costs nothing. It returns
            values of inputs by name, and those that it leaves out follow the scenario's signals. A
            controller that remembers something is made anew for each run.
        engine: name of the engine.
        contact: contact level.
        set: parameters that differ from the file; text may carry a unit.
        robot: file of a robot (``simcompare robot --template``), applied before ``set``.
        preset: named set of parameters, applied first.
        step: time between samples, "1ms" or in seconds.
        every: time between two calls of the controller, "20ms" or in seconds; what it gave is held.
            By default it is called before each recorded step.

    Returns:
        The trajectory; what the controller gave is recorded by the actuators.

    Raises:
        InputError: the controller does not take time and readings, or it returned something else
            than finite numbers by name; ``every`` is no whole number of steps.
        NoSuchReading: it asked for a reading that there is not; also a KeyError.
        UnknownName: it set an input that the scenario does not have, or there is no such level.
        Unsupported: the engine lacks what the scenario needs.
        Exception: whatever the controller raises, with a note of the engine and the time.
    """
    _check_called(controller)
    taken = robot_values.taken(catalogue.load(str(scenario)), robot)
    file = taken.file
    if contact not in CONTACT_LEVELS:
        raise UnknownName("contact level", contact, CONTACT_LEVELS)
    values = {**taken.values, **file.read_settings(set or {})}
    step_s = None if step is None else one_step_s(step)
    if step is not None and step_s is not None:
        check_sample_step(file.resolve(values, preset=preset), step, step_s)
    scene = file.resolve(values, preset=preset, step_s=step_s)
    held = 1 if every is None else _steps_between(every, scene.world.step_s)
    backend = engines.get(engine)
    simulation = backend.open(scene, Settings(contact))
    try:
        found = simulation.run(engine, backend.version(), controller, held)
    finally:
        simulation.close()
    recorded = {**vars(found), "contact": contact}
    return Controlled(**recorded, title=scene.title, probes=scene.probes, cautions=taken.left_out)


def _steps_between(every: str | float, step_s: float) -> int:
    """How many recorded steps lie between two calls of a controller."""
    every_s = units.to_si(every, "s", "every")
    count = round(every_s / step_s)
    # a time that is typed with a few digits is as good as a multiple
    if count < 1 or abs(every_s - count * step_s) > 1e-6 * every_s:
        raise InputError(
            "every",
            [f"{every} is no whole number of recorded steps of {step_s:g} s; expected such as"
             f" {max(count, 1) * step_s:g}"],
        )  # fmt: skip
    return count


def _check_called(controller: Controller) -> None:
    """Refuses a controller that cannot be called with a time and readings."""
    try:
        signature = inspect.signature(controller)
    except ValueError:  # of some functions that are written in C it is not known
        return
    try:
        signature.bind(0.0, {})
    except TypeError as error:
        name = getattr(controller, "__name__", type(controller).__name__)
        raise InputError(
            f"controller {name}{signature}",
            [f"cannot be called with two arguments ({error}); expected {name}(time_s, readings)"],
        ) from None
