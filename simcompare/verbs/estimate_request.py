"""What ``estimate`` is asked, checked against the scenario: estimator, sensors, options."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

from simcompare import units
from simcompare.errors import InputError, SimcompareError, UnknownName
from simcompare.estimation import estimators
from simcompare.estimation.estimators import Estimator
from simcompare.estimation.observing import observed
from simcompare.hardware.sensors import data_sheet
from simcompare.inference.sources import Source
from simcompare.model.estimate_plan import EstimatePlan, RecordedPlan
from simcompare.model.scenario import Scenario
from simcompare.model.sensor_errors import SensorErrors
from simcompare.scenarios import catalogue
from simcompare.verbs.request import Option, Place, Request, Values

Sheets = str | Mapping[str, str]


@dataclass(frozen=True, kw_only=True)
class EstimateRequest(Request):
    """What ``estimate`` is asked; the options are those of ``simcompare.estimate``."""

    verb: ClassVar[str] = "estimate"
    recording: Annotated[Place | None, Option("--recording")] = None
    mapping: Annotated[Place | None, Option("--map")] = None
    estimator: Annotated[str | None, Option("--estimator")] = None
    contact: Annotated[str, Option("--contact")] = "assisted"
    sensors: Annotated[tuple[str, ...], Option("--sensors", commas=True)] = ()
    options: Annotated[Values, Option("--option")] = None
    robot: Annotated[Place | None, Option("--robot")] = None
    preset: Annotated[str | None, Option("--preset")] = None
    draws: Annotated[int, Option("--draws")] = 40
    seed: Annotated[int, Option("--seed")] = 0

    def command(self) -> tuple[str, ...]:
        """The words of the command line that ask the same; a recording needs no engine."""
        words = super().command()
        if self.recording is None:
            return words
        at = words.index("--engine")
        return (*words[:at], *words[at + 2 :])


def plan_of(scenario: Scenario, estimator: str | None) -> tuple[Estimator, EstimatePlan]:
    """The estimator that is asked for, the scenario's first one where none is, and its plan.

    Raises:
        InputError: nothing is estimated of that scenario; says of which something is.
        UnknownName: not by that estimator.
    """
    if not scenario.estimate:
        others = ", ".join(prepared())
        fault = f"nothing is estimated of it; it needs estimate: in its file (has it: {others})"
        raise InputError(scenario.name, [fault])
    name = next(iter(scenario.estimate)) if estimator is None else estimator
    if name not in scenario.estimate:
        raise UnknownName(f"estimator of {scenario.name}", name, scenario.estimate)
    return estimators.load(name), scenario.estimate[name]


def recorded_plan_of(source: Source, scenario: str, estimator: str | None) -> RecordedPlan:
    """How an estimator is used on a recording; the first one for that scenario where none is named.

    Raises:
        InputError: the recording is not prepared for it; says what it is prepared for.
    """
    fitting = [one for one in source.estimates if one.scenario == scenario]
    for one in fitting:
        if estimator in (None, one.estimator):
            return one
    have = ", ".join(f"{one.scenario} by {one.estimator}" for one in source.estimates) or "none"
    by = "" if estimator is None else f" by {estimator}"
    fault = f"nothing is estimated of it for {scenario}{by} (prepared: {have}); a mapping file"
    raise InputError(source.name, [f"{fault} (--map) says under estimate: which channel is what"])


def prepared() -> list[str]:
    """Scenarios of which something is estimated."""
    return [name for name in catalogue.names() if catalogue.load(name).tree.get("estimate")]


def sheets_of(text: Sheets | None) -> dict[str, str]:
    """``imu=mpu6050,pressure=bmp280`` as sensor -> sheet.

    Raises:
        InputError: a part is not of that form.
    """
    if not isinstance(text, str):
        return dict(text or {})
    found = {}
    for part in filter(None, map(str.strip, text.split(","))):
        name, equals, sheet = (word.strip() for word in part.partition("="))
        if not (equals and name and sheet):
            fault = f"{part!r} is not of the form sensor=sheet, such as imu=mpu6050"
            raise InputError("--sensors", [fault])
        if name in found:
            raise InputError("--sensors", [f"{name} is given twice"])
        found[name] = sheet
    return found


def chips_of(sensors: Sheets | None) -> tuple[tuple[str, ...], Sheets | None]:
    """Words that name a data sheet alone, for a study of chips, and what is left.

    Raises:
        InputError: a chip stands there twice.
    """
    if not isinstance(sensors, str):
        return (), sensors
    words = [word.strip() for word in sensors.split(",")]
    chips = [word for word in words if word.lower() in data_sheet.names()]
    twice = [f"{chip} is given twice" for chip in dict.fromkeys(chips) if chips.count(chip) > 1]
    if twice:
        raise InputError("--sensors", twice)
    return tuple(chips), ",".join(word for word in words if word not in chips)


def with_sheets(plan: EstimatePlan, sheets: Mapping[str, str], scenario: Scenario) -> EstimatePlan:
    """The plan with other data sheets.

    Raises:
        InputError: every sensor that is not used, and every sheet that does not exist.
    """
    used = {observed(name, scenario).owner for name in plan.signals.values()}
    known = [name for name in (*scenario.sensors, *scenario.actuators) if name in used]
    faults, chosen = [], dict(plan.sensors)
    for sensor, sheet in sheets.items():
        if sensor not in known:
            faults.append(str(UnknownName("sensor of this estimate", sensor, known)))
            continue
        try:
            chip = data_sheet.load(sheet)
        except SimcompareError as error:
            faults.append(str(error))
            continue
        rate = chosen[sensor].rate_Hz if sensor in chosen else None
        fits = rate is not None and all(_has_rate(part, rate) for part in chip.parts.values())
        given = {"sheet": sheet, **({"rate_Hz": rate} if fits else {})}
        chosen[sensor] = SensorErrors.model_validate(given)
    if faults:
        raise InputError("--sensors", faults)
    return plan.model_copy(update={"sensors": chosen})


def _has_rate(part: data_sheet.Part, rate_Hz: float) -> bool:
    try:
        part.settings(rate_Hz=rate_Hz)
    except InputError:
        return False
    return True


def options_of(
    estimator: Estimator, given: Mapping[str, float], asked: Mapping[str, str | float]
) -> dict[str, float]:
    """All numbers of an estimator: its own, the scenario's, and those asked for.

    Raises:
        InputError: all that is unknown, missing, out of bounds or of a wrong unit.
    """
    chosen, faults = dict(given), []
    taken: set[str] = set()
    for name, value in asked.items():
        full = units.find_name(name, estimator.options)
        if full is None:
            faults.append(str(UnknownName("option of the estimator", name, estimator.options)))
            continue
        if full in taken:
            faults.append(f"{full} is given twice, with and without its unit")
        taken.add(full)
        try:
            chosen[full] = units.to_si(value, units.unit_of(full), full)
        except InputError as error:
            faults.append(str(error))
    faults += estimators.option_faults(estimator, chosen).values()
    if faults:
        raise InputError("--option", faults)
    return estimator.with_defaults(chosen)
