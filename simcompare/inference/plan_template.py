"""A plan to be filled in: every key of ``validate:`` for a scenario, with channels that may fit."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from simcompare import measures, units
from simcompare.hardware.mapping import UNKNOWN
from simcompare.model.scenario import Scenario
from simcompare.scenarios.scenario_file import ScenarioFile

#: keys that are wanted now and then, as a line each; ``{}`` is filled in by the scenario
_MORE = (
    "# window: {start_s: 0.0, duration_s: 9.0}   # the part that is looked at, on the log's clock",
    "# streams: [log]   # the streams that are judged; all of them without this line",
    "# align: {by: none, reason: ...}   # one clock for both; or by: events, or by: correlation,",
    "#   with probe: a quantity that is compared and has judged: false",
    "# note: ...   # what the reader of the report must know",
)
_CALIBRATE = (
    "# calibrate:   # fitted to some streams, so that the others are a prediction",
    "#   parameters: [{parameters}]",
    "#   streams: [...]   # those that are fitted; or recording: another.csv",
    "#   nuisance: []   # fitted as well, but of that recording alone, such as its zero",
    "#   most_s: 10   # longest part of a stream that is used",
    "#   chosen_knowing: true   # where the streams were chosen after seeing what the others say",
)


@dataclass(frozen=True)
class Candidate:
    """A channel that a plan may name.

    Attributes:
        name: what the plan calls it.
        unit: its SI unit; ``?`` where the log does not say.
    """

    name: str
    unit: str


def of_scenario(file: ScenarioFile, channels: Sequence[Candidate] = ()) -> str:
    """The text of ``validate:`` for a scenario, ready to be edited.

    Args:
        file: the scenario.
        channels: those of the recording, where one is at hand.
    """
    scene = file.resolve()
    lines = ["validate:", f"  scenario: {file.name}", *_compare(scene, channels)]
    lines += [*_inputs(scene, channels), *_events(scene), *_parameters(file), *_start(file)]
    fitted = file.fit.parameters if file.fit else list(file.parameters)[:2]
    lines += [f"  {line.format(parameters=', '.join(fitted))}" for line in _CALIBRATE]
    lines += [f"  {line}" for line in _MORE]
    return "\n".join(lines) + "\n"


def _compare(scene: Scenario, channels: Sequence[Candidate]) -> Iterator[str]:
    yield "  compare:   # what is simulated: the channel that measured it; the first one leads"
    yield "    # a line may also have u: 0.01 (standard uncertainty), offset: 0.0 (is added to the"
    yield "    # channel), judged: false (only aligns the clocks)"
    for name, probe in scene.probes.items():
        fitting = _fitting(units.si_of(probe.unit, name)[2], channels)
        about = f"{probe.label} [{probe.unit}]{_hint(fitting, channels)}"
        yield f"    {name}: {{channel: {_chosen(fitting)}}}   # {about}"


def _inputs(scene: Scenario, channels: Sequence[Candidate]) -> Iterator[str]:
    if scene.inputs:
        yield "  inputs:   # what drives the scene: the channel that it follows; delete for its own"
    for name in scene.inputs:
        yield f"    {name}: {{channel: {_quoted(UNKNOWN)}}}{_all_of(channels)}"


def _events(scene: Scenario) -> Iterator[str]:
    times = [
        measure.name_of(name)
        for measure in scene.measures
        for name in measures.load(measure.function).series
        if measures.units_of(measure, scene)[name] == "s"
    ]
    if times:
        several = f"; series: {', '.join(dict.fromkeys(times))}" if times[1:] else ""
        yield f"  # events: {{series: {times[0]}, event: impact}}   # when events happened{several}"


def _parameters(file: ScenarioFile) -> Iterator[str]:
    yield "  # parameters:   # known before, with standard uncertainty and source; others are the"
    yield "  #   scenario's own"
    for name, one in file.parameters.items():
        yield f"  #   {name}: {{value: {one.value!r}, u: 0.0, source: ...}}   # {one.text}"


def _start(file: ScenarioFile) -> Iterator[str]:
    yield "  # start:   # read off the recording where the window begins: a parabola through over_s"
    for name in [name for name in file.parameters if name.startswith("start")] or ["PARAMETER"]:
        yield f"  #   {name}: {{channel: ..., over_s: 0.05, derivative: 0, offset: 0.0}}"


def _fitting(unit: str, channels: Sequence[Candidate]) -> list[str]:
    return [channel.name for channel in channels if channel.unit in (unit, UNKNOWN)]


def _chosen(fitting: Sequence[str]) -> str:
    """The one channel that fits; else the user writes it."""
    return _quoted(fitting[0] if len(fitting) == 1 else UNKNOWN)


def _hint(fitting: Sequence[str], channels: Sequence[Candidate]) -> str:
    if not channels:
        return ""
    return f"; one of {', '.join(fitting)}" if fitting else "; no channel has this unit"


def _all_of(channels: Sequence[Candidate]) -> str:
    return f"   # one of {', '.join(one.name for one in channels)}" if channels else ""


def _quoted(text: str) -> str:
    """A YAML string, whatever it holds: JSON strings are such."""
    return json.dumps(text, ensure_ascii=False)
