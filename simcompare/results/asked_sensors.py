"""Sensors that are not ideal: those of a scenario, and those that a user asks for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from simcompare.errors import InputError, SimcompareError
from simcompare.hardware.sensors import drawn_zones, multizone
from simcompare.hardware.sensors.drawn import DrawnSensor, drawn
from simcompare.hardware.sensors.drawn_zones import DrawnZones
from simcompare.hardware.sensors.signals import chosen, is_zones, owner_of, part_of
from simcompare.model import sensor_errors
from simcompare.model.scenario import Scenario
from simcompare.model.sensor_errors import SensorErrors
from simcompare.model.yaml_file import describe, faults_of

Drawn = DrawnSensor | DrawnZones
#: what can be said of a sensor beside its sheet, for the hint that the sheet is missing
_SETTINGS = {*SensorErrors.model_fields, *multizone.SETTINGS, "reflectance"} - {"sheet"}


def asked_devices(
    scenario: Scenario, asked: Mapping[str, str | Path | float], seed: int
) -> tuple[Drawn, ...]:
    """One device for each signal that a real sensor is to read.

    Args:
        scenario: the scene, which may say more of its sensors.
        asked: owner, signal or component -> data sheet; and what else is said of one of these, such
            as ``eye.ambient_klux`` -> 1.
        seed: of all streams.

    Raises:
        InputError: unknown sensors, and sheets that do not exist or do not fit; all of them.
    """
    if seed < 0:
        raise InputError("--seed", [f"{seed} is below 0; expected a whole number from 0 on"])
    said, faults = _by_name(scenario, asked)
    found = {name: errors for name, errors in scenario.sensor_errors().items() if name not in said}
    devices: dict[str, Drawn] = {
        one.signal: one
        for name, errors in found.items()
        for one in drawn(errors, chosen(name, scenario.signals(), scenario.name), seed)
    }
    for name, terms in said.items():
        try:
            signals = chosen(name, scenario.signals(), scenario.name)
            made = devices_of(terms, signals, 1 / scenario.world.step_s, seed, scenario)
            devices.update({one.signal: one for one in made})
        except InputError as error:
            place = f"{name}={terms['sheet']}: "
            place += "" if error.where == name else f"{error.where}: "
            faults += [f"{place}{one}" for one in error.faults]
        except SimcompareError as error:
            faults.append(f"{name}={terms['sheet']}: {error}")
    if faults:
        raise InputError("--sensor", faults)
    return tuple(devices.values())


def devices_of(
    said: Mapping[str, Any], wanted: Mapping[str, int], rate_Hz: float, seed: int,
    scenario: Scenario | None,
) -> tuple[Drawn, ...]:  # fmt: skip
    """The devices that read signals of one sensor.

    Args:
        said: a sheet, terms and settings, as under ``errors`` of a scenario.
        wanted: signal -> number of components.
        rate_Hz: of the samples.
        seed: of all streams.
        scenario: in which a range sensor of many zones looks; ``None`` where there is none.

    Raises:
        UnknownName: no such sheet or range.
        InputError: what the device cannot be, or a sheet that does not fit.
    """
    zones = [name for name, width in wanted.items() if is_zones(width)]
    if zones and scenario is None:
        fault = "many zones look at a scene, and a trajectory has none; give the run instead"
        raise InputError(zones[0], [fault])
    if zones and scenario is not None:
        return (drawn_zones.of_sensor(scenario, owner_of(zones[0]), said, seed),)
    return drawn(_errors(said, wanted, rate_Hz), wanted, seed)


def _errors(said: Mapping[str, Any], wanted: Mapping[str, int], rate_Hz: float) -> SensorErrors:
    """Terms that were given as a mapping, checked as those of a scenario's file are."""
    try:
        errors = SensorErrors.model_validate(dict(said))
    except ValidationError as error:
        raise InputError("device", describe(faults_of(error, SensorErrors), {})) from None
    parts = {part_of(name): width for name, width in wanted.items()}
    faults = dict(sensor_errors.faults_of(errors, parts, rate_Hz))
    if faults:
        raise InputError("device", describe(faults, {}))
    return errors


def _by_name(
    scenario: Scenario, asked: Mapping[str, str | Path | float]
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """What is said of each sensor or signal, its sheet and settings, and faults of settings."""
    settings = {name: whose for name in asked if (whose := _whose(scenario, asked, name))}
    found: dict[str, dict[str, Any]] = {
        name: {"sheet": str(one)} for name, one in asked.items() if name not in settings
    }
    faults = []
    for name, whose in settings.items():
        if whose not in found:
            rest = name.removeprefix(f"{whose}.")
            own = [one for one in found if one.startswith(f"{whose}.")]
            cure = f"write {own[0]}.{rest}" if own else f"give that too, such as {whose}=SHEET"
            faults.append(f"{name}: {whose} has no sheet; {cure}")
            continue
        key, dot, part = name.removeprefix(f"{whose}.").partition(".")
        place = found[whose].setdefault(key, {}) if dot else found[whose]
        last = part if dot else key
        if not isinstance(place, dict) or last in place:
            faults.append(f"{name}: {whose}.{key} is given too; expected one of them")
            continue
        place[last] = _value(asked[name])
    return found, faults


def _whose(scenario: Scenario, asked: Mapping[str, object], name: str) -> str:
    """Of which sensor or signal a name is a setting; empty where it is itself a signal."""
    known, (owner, _, rest) = scenario.signals(), name.partition(".")

    def is_signal(one: str) -> bool:
        return one in known or one.rpartition(".")[0] in known

    if is_signal(name):
        return ""
    above = [
        one for one in asked if name.startswith(f"{one}.") and (one == owner or is_signal(one))
    ]
    if above:
        return max(above, key=len)
    return owner if rest.partition(".")[0] in _SETTINGS else ""


def _value(text: object) -> object:
    """A number where it is one."""
    try:
        return float(str(text))
    except ValueError:
        return str(text)
