"""A plan to be filled in: every key of ``validate:`` for a scenario, with channels that may fit."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from simcompare import measures, units
from simcompare.hardware.mapping import UNKNOWN
from simcompare.inference import starts
from simcompare.model.scenario import Probe, Scenario
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

#: a start is read off so long where the spacing of the samples is not known [s]
_OVER_S = 0.1


@dataclass(frozen=True)
class Candidate:
    """A channel that a plan may name.

    Attributes:
        name: what the plan calls it.
        unit: its SI unit; ``?`` where the log does not say.
        step_s: time between its samples [s]; ``None`` where the log does not say.
    """

    name: str
    unit: str
    step_s: float | None = None


def of_scenario(file: ScenarioFile, channels: Sequence[Candidate] = ()) -> str:
    """The text of ``validate:`` for a scenario, ready to be edited.

    Args:
        file: the scenario.
        channels: those of the recording, where one is at hand.
    """
    scene = file.resolve()
    lines = ["validate:", f"  scenario: {file.name}", *_compare(scene, channels)]
    lines += [
        *_inputs(scene, channels),
        *_events(scene),
        *_start(file, scene, channels),
        *_parameters(file),
    ]
    fitted = file.fit.parameters if file.fit else list(file.parameters)[:2]
    lines += [f"  {line.format(parameters=', '.join(fitted))}" for line in _CALIBRATE]
    lines += [f"  {line}" for line in _MORE]
    return "\n".join(lines) + "\n"


def _compare(scene: Scenario, channels: Sequence[Candidate]) -> Iterator[str]:
    yield "  compare:   # what is simulated: the channel that measured it; the first one leads"
    yield "    # a line may also have u: 0.01 (standard uncertainty), offset: 0.0 (is added to the"
    yield "    # channel), judged: false (only aligns the clocks)"
    usable = _usable(scene, channels)
    for name, probe in scene.probes.items():
        fitting = _fitting(probe, channels)
        about = f"{probe.label} [{probe.unit}]{_hint(fitting, channels)}"
        mark = "" if name in usable else "# "
        yield f"    {mark}{name}: {{channel: {_chosen(fitting)}}}   # {about}"


def _usable(scene: Scenario, channels: Sequence[Candidate]) -> list[str]:
    """Probes that a channel may have measured; all where none fits, for the user to decide."""
    fitting = [name for name, probe in scene.probes.items() if _fitting(probe, channels)]
    # one channel without a unit may be anything, but only one thing
    return fitting[: 1 if len(channels) == 1 else None] or list(scene.probes)


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


def _start(file: ScenarioFile, scene: Scenario, channels: Sequence[Candidate]) -> Iterator[str]:
    found = starts.starts_of(file.parameters, scene.probes, _usable(scene, channels))
    mark = "" if found else "# "
    yield f"  {mark}start:   # read off the recording where the window begins, over so many seconds"
    for name, start in found.items():
        fitting = _fitting(scene.probes[start.probe], channels)
        keys = f"channel: {_chosen(fitting)}, over_s: {_over_s(channels)}"
        keys += ", derivative: 1" if start.derivative else ""
        what = "the rate of change of " if start.derivative else ""
        yield f"    {name}: {{{keys}}}   # {what}{start.probe}"
    begun = [name for name in file.parameters if name.startswith("start") and name not in found]
    for name in begun or ([] if found else ["PARAMETER"]):
        yield f"    # {name}: {{channel: ..., over_s: 0.05, derivative: 0, offset: 0.0}}"


def _over_s(channels: Sequence[Candidate]) -> str:
    """For how long a start is read off: some samples of the slowest channel."""
    steps = [channel.step_s for channel in channels if channel.step_s is not None]
    return f"{starts.over_s(max(steps)) if steps else _OVER_S:.2g}"


def _fitting(probe: Probe, channels: Sequence[Candidate]) -> list[str]:
    unit = units.si_of(probe.unit, probe.label)[2]
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
