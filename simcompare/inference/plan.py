"""The plan of a validation: which channel is which quantity of a scenario, and what is known."""

from __future__ import annotations

import shlex
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, Self

from pydantic import (
    Field,
    NonNegativeFloat,
    PositiveFloat,
    ValidationError,
    model_validator,
)

from simcompare.errors import InputError, UnknownName
from simcompare.hardware.mapping import UNKNOWN
from simcompare.model.frozen import Frozen
from simcompare.model.scenario import Scenario
from simcompare.model.yaml_file import describe, faults_of


class _Part(Frozen):
    @model_validator(mode="after")
    def _filled_in(self) -> Self:
        if getattr(self, "channel", None) == UNKNOWN:
            raise ValueError("channel is still ?; write a channel, or delete the line")
        return self


class Known(_Part):
    """A parameter that was known before the recording was looked at.

    Attributes:
        value: in the unit of the parameter's name.
        u: standard uncertainty (JCGM 100:2008, 4).
        source: where both come from.
    """

    value: float
    u: NonNegativeFloat
    source: str = Field(min_length=3)


class ReadOff(_Part):
    """A parameter that is read off the recording, where the window begins.

    Attributes:
        channel: which channel.
        over_s: a parabola (a cubic for a rate) is laid through the samples of this time [s].
        derivative: 0 the value, 1 its rate of change.
        offset: is added, for a parameter that is counted from elsewhere.
    """

    channel: str
    over_s: PositiveFloat = 0.05
    derivative: Literal[0, 1] = 0
    offset: float = 0.0


class Compared(_Part):
    """A probe of the scenario and the channel that measured the same.

    Attributes:
        channel: which channel.
        u: standard uncertainty of a sample; the channel's own, or an estimate, where ``None``.
        offset: is added to the channel.
        judged: whether it is judged, or only used to align the clocks.
    """

    channel: str
    u: PositiveFloat | None = None
    offset: float = 0.0
    judged: bool = True


class Driven(_Part):
    """An input of the scenario that follows a channel."""

    channel: str


class Happened(_Part):
    """Events of the recording that are held against a series of times of the scenario.

    Attributes:
        series: what a measure of the scenario calls these times ("impact_time").
        event: what the recording calls them.
    """

    series: str
    event: str = "impact"


class Window(_Part):
    """The part of each stream that is looked at, on its own clock [s]."""

    start_s: NonNegativeFloat = 0.0
    duration_s: PositiveFloat | None = None


class Calibration(_Part):
    """Parameters that are fitted to some streams, so that others can be predicted.

    Attributes:
        recording: name of another data set; this recording where ``None``.
        streams: streams that are fitted.
        parameters: which parameters.
        nuisance: parameters that are fitted as well, but belong to that recording alone, such as
            how its zero was set; they are not carried over.
        most_s: longest part of a stream that is used [s].
        chosen_knowing: whether it was chosen after it was seen what the others say.
    """

    recording: str | None = None
    streams: tuple[str, ...] = ()
    parameters: tuple[str, ...] = Field(min_length=1)
    nuisance: tuple[str, ...] = ()
    most_s: PositiveFloat | None = None
    chosen_knowing: bool = False


class ClockPlan(_Part):
    """How the clock of the recording is brought to that of the scenario.

    Attributes:
        by: "none" where both are one clock, or the start is read off the recording; "events" by
            the plan's events, of which then only the intervals are judged; "correlation" by a
            probe.
        probe: which compared quantity is used; it must not be judged.
        reason: why so.
    """

    by: Literal["none", "events", "correlation"] = "none"
    probe: str | None = None
    reason: str = ""

    @model_validator(mode="after")
    def _has_a_probe(self) -> ClockPlan:
        if (self.by == "correlation") != (self.probe is not None):
            raise ValueError("a probe is needed to align by correlation, and only then")
        return self


class Plan(_Part):
    """How one scenario is held against a recording.

    Attributes:
        scenario: its name.
        parameters: what was known before.
        start: parameters that are read off the recording.
        inputs: inputs that follow the recording.
        compare: probe -> channel; the first one leads.
        events: events that are compared.
        streams: those that are judged; all where empty.
        window: the part of each that is looked at.
        calibrate: what is fitted, and where.
        align: how clocks are aligned.
        note: what the reader must know.
    """

    scenario: str
    parameters: Mapping[str, Known] = Field(default_factory=dict)
    start: Mapping[str, ReadOff] = Field(default_factory=dict)
    inputs: Mapping[str, Driven] = Field(default_factory=dict)
    compare: Mapping[str, Compared] = Field(default_factory=dict)
    events: Happened | None = None
    streams: tuple[str, ...] = ()
    window: Window = Window()
    calibrate: Calibration | None = None
    align: ClockPlan = ClockPlan()
    note: str = ""

    @model_validator(mode="after")
    def _consistent(self) -> Plan:
        if not any(compared.judged for compared in self.compare.values()) and self.events is None:
            raise ValueError("nothing is judged; at least one probe, or events, must be")
        if self.calibrate and not any(one.judged for one in self.compare.values()):
            raise ValueError(
                "calibrate fits a judged probe, and compare: has none; a ball is fitted to its"
                " impacts by simcompare fit"
            )
        if self.align.by == "events" and self.events is None:
            raise ValueError("align.by is events, and there are none; say which under events:")
        if self.align.probe is not None:
            used = self.compare.get(self.align.probe)
            if used is None:
                raise ValueError(f"align.probe {self.align.probe} is not among those compared")
            shared = [n for n, c in self.compare.items() if c.judged and c.channel == used.channel]
            if used.judged or shared:
                raise ValueError(
                    f"align.probe {self.align.probe} is judged as well: what clocks are aligned on"
                    " must not be judged; say judged: false there, or align on another quantity"
                )
        twice = set(self.start) & set(self.parameters)
        if twice:
            raise ValueError(f"{', '.join(sorted(twice))} is both known and read off")
        return self


@dataclass(frozen=True)
class Entries:
    """Entries of ``validate:``, unread, and where they stand.

    Attributes:
        tree: one entry or a list of them.
        where: file, or data set, that holds them.
        lines: dotted place in that file -> line.
    """

    tree: object
    where: str
    lines: Mapping[str, int] = field(default_factory=dict)

    def __bool__(self) -> bool:
        return self.tree != ()

    def placed(self) -> dict[str, object]:
        """Dotted place -> entry."""
        if isinstance(self.tree, list | tuple):
            return {f"validate.{i}": entry for i, entry in enumerate(self.tree)}
        return {"validate": self.tree}

    def place_of(self, scenario: str) -> str | None:
        """Where the entry for a scenario stands; ``None`` where there is none."""
        return next((at for at, one in self.placed().items() if _name(one) == scenario), None)


def _name(entry: object) -> str | None:
    """The scenario that an entry is for."""
    name = entry.get("scenario") if isinstance(entry, Mapping) else None
    return name if isinstance(name, str) else None


def of_tree(
    tree: object,
    where: str,
    lines: Mapping[str, int] | None = None,
    place: str = "validate",
) -> Plan:
    """The plan in one entry of ``validate:``.

    Args:
        tree: the entry.
        where: file, or data set, that holds it.
        lines: dotted place in that file -> line.
        place: of the entry in it.

    Raises:
        InputError: all faults at once.
    """
    try:
        return Plan.model_validate(tree)
    except ValidationError as error:
        by_place = {
            f"{place}.{at}".rstrip("."): text for at, text in faults_of(error, Plan).items()
        }
        raise InputError(where, describe(by_place, lines or {})) from None


def template_command(
    scenario: str, recording: str | None = None, mapping: str | Path | None = None
) -> str:
    """The command that writes a mapping file to be filled in."""
    log = [] if recording is None else ["--recording", recording]
    own = [] if mapping is None else ["--map", str(mapping)]
    new = ["--template", "--out", f"{Path(scenario).stem}_map.yaml"]
    return shlex.join(["simcompare", "validate", scenario, *log, *own, *new])


def choose(entries: Entries, scenario: str, command: str = "") -> Plan:
    """The entry for a scenario.

    Args:
        entries: all that there are.
        scenario: its name.
        command: what writes a mapping file for it.

    Raises:
        InputError: there is none, or it has faults.
    """
    placed, place = entries.placed(), entries.place_of(scenario)
    if place is not None:
        return of_tree(placed[place], entries.where, entries.lines, place)
    for at, entry in placed.items():
        if _name(entry) is None:  # what it should have been for is not known: its faults are told
            of_tree(entry, entries.where, entries.lines, at)
    known = ", ".join(str(_name(entry)) for entry in placed.values()) or "none"
    raise InputError(
        entries.where,
        [
            f"is not prepared for the scenario {scenario} (prepared: {known}); a mapping file"
            " (--map) says under validate: which probe is which channel. This writes one to fill"
            f" in: {command or template_command(scenario)}"
        ],
    )


def checked(plan: Plan, scenario: Scenario, entries: Entries) -> Plan:
    """The plan, where it suits the scenario.

    Raises:
        InputError: it names what the scenario does not have.
    """
    refuse(faults(plan, scenario), plan, entries)
    return plan


def refuse(found: Mapping[str, str], plan: Plan, entries: Entries) -> None:
    """Ends with the faults of a plan, where it has some.

    Args:
        found: dotted place in the plan -> what is wrong.
        plan: the plan.
        entries: those that it is one of.

    Raises:
        InputError: all faults, with file and line.
    """
    if found:
        place = entries.place_of(plan.scenario)
        placed = {f"{place}.{at}": fault for at, fault in found.items()}
        raise InputError(entries.where, describe(placed, entries.lines))


def faults(plan: Plan, scenario: Scenario) -> dict[str, str]:
    """What the plan names and the scenario does not have, as dotted place -> sentence."""
    fitted, parameters = plan.calibrate, scenario.parameters
    named: list[tuple[str, str, Iterable[str], Collection[str]]] = [
        ("parameter", "parameters", plan.parameters, parameters),
        ("parameter", "start", plan.start, parameters),
        ("input", "inputs", plan.inputs, scenario.inputs),
        ("probe", "compare", plan.compare, scenario.probes),
        ("parameter", "calibrate.parameters", fitted.parameters if fitted else (), parameters),
        ("parameter", "calibrate.nuisance", fitted.nuisance if fitted else (), parameters),
    ]
    return {
        f"{place}.{name}": str(UnknownName(f"{kind} of {plan.scenario}", name, known))
        for kind, place, names, known in named
        for name in names
        if name not in known
    }
