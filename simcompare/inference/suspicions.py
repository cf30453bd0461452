"""Whether a recording, read another way, would fit its scenario: told, never repaired.

What may be mistaken follows from the plan alone: the sign, the zero and the unit of every channel
that is used, channels of one kind that are exchanged, a first angle that is turned, a size of which
the half is taken for the whole. Each is undone for a trial; the scenario's own reference judges.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from simcompare import units
from simcompare.errors import SimcompareError
from simcompare.inference.plan import Plan
from simcompare.inference.reference_model import Model
from simcompare.inference.segment_reader import segments_of
from simcompare.inference.segments import Segment
from simcompare.model.recording import Channel, Recording
from simcompare.model.trajectory import Array
from simcompare.statistics import suspicions
from simcompare.statistics.agreement import rms
from simcompare.statistics.suspicions import Change, Hypothesis, Suspicion

#: looked for where the reference is off by more than this part of the range of what was measured,
#: and told where it then is no longer; two mistakes together explain a lot, and must leave less
MISSES, LEFT_BY_TWO = 0.1, 0.05
#: samples of a channel at which both are compared
MOST_SAMPLES = 200
#: smallest constant error of an angle that is no matter of calibration [rad], and how often it is
#: looked for anew with what was found
LEAST_ZERO_RAD, ROUNDS = 0.05, 6
DEGREE = math.pi / 180
RPM = 2 * math.pi / 60
#: turns that are taken for none [rad]
TURNS = (math.pi, math.pi / 2, -math.pi / 2)
#: unit in SI -> other units that are taken for it, and what they are in it
_UNITS = {"rad": {"deg": DEGREE}, "rad/s": {"deg/s": DEGREE, "rpm": RPM}}


@dataclass(frozen=True)
class Read:
    """A recording as it is read for a trial.

    Attributes:
        recording: the recording.
        overrides: parameters that replace those of the plan.
    """

    recording: Recording
    overrides: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Trial:
    """What a reading is judged with.

    Attributes:
        model: the scenario.
        plan: which channel is what.
        streams: those that are judged; the first of them is looked at.
        fitted: parameters that were fitted.
    """

    model: Model
    plan: Plan
    streams: Sequence[str]
    fitted: Mapping[str, float]

    def segment(self, read: Read) -> Segment:
        """The first segment of a reading."""
        streams = list(self.streams)[:1]
        found = segments_of(self.model.file, self.plan, read.recording, streams, read.overrides)
        return found[0]

    def pairs(self, read: Read, channel: str = "") -> Iterator[tuple[Array, Array]]:
        """What was measured of each judged probe (of one channel), and what the reference says."""
        segment = self.segment(read)
        for probe, seen in segment.observed.items():
            one = self.plan.compare[probe]
            if one.judged and channel in ("", one.channel):
                every = max(1, len(seen.values) // MOST_SAMPLES)
                truth = self.model.at(segment, probe, self.fitted, seen.time_s[::every])
                yield seen.values[::every], truth

    def misfit(self, read: Read) -> float:
        """Root mean square deviation over the range of what was measured; infinite without one."""
        try:
            parts = [
                rms(theirs - ours) / (float(np.ptp(ours)) or math.inf)
                for ours, theirs in self.pairs(read)
            ]
        except SimcompareError:
            return math.inf
        return rms(np.array(parts)) if parts else math.inf


def suspected(
    model: Model,
    plan: Plan,
    recording: Recording,
    streams: Sequence[str],
    overrides: Mapping[str, float],
    fitted: Mapping[str, float],
) -> Suspicion | None:
    """The mistake in what is said of a recording that explains why it does not fit.

    Args:
        model: the scenario; nothing is suspected where it has no reference.
        plan: which channel is what.
        recording: the recording.
        streams: those that are judged.
        overrides: parameters that the user sets.
        fitted: parameters that were fitted.
    """
    if model.reference is None or not plan.compare:
        return None
    trial, given = Trial(model, plan, streams, fitted), Read(recording, overrides)
    before = trial.misfit(given)
    if not MISSES < before < math.inf:
        return None
    found = suspicions.suspected(given, list(_mistakes(trial, recording)), trial.misfit, paired=2)
    if found is None or found.after > (MISSES if len(found.says) == 1 else LEFT_BY_TWO):
        return None
    return found


def _mistakes(trial: Trial, recording: Recording) -> list[Hypothesis[Read]]:
    """All of them, the likeliest first."""
    plan = trial.plan
    inputs = [one.channel for one in plan.inputs.values()]
    compared = [one.channel for one in plan.compare.values()]
    started = [one.channel for one in plan.start.values()]
    every = list(dict.fromkeys([*compared, *started, *inputs]))
    unit_of = {name: _found(recording, name)[2].unit for name in every}
    angles = [n for n in dict.fromkeys((*compared, *started)) if unit_of[n] == "rad"]
    return [
        *(
            partial(_exchanged, *pair)
            for group in (inputs, compared)
            for pair in itertools.combinations(dict.fromkeys(group), 2)
            if unit_of[pair[0]] == unit_of[pair[1]]
        ),
        *(partial(_changed, name, -1.0, 0.0, "") for name in every),
        *(partial(_changed, name, 1.0, turn, "") for name in angles for turn in TURNS),
        *_of_parameters(trial),
        *(
            partial(_changed, name, factor, 0.0, unit)
            for name in every
            for unit, factor in _UNITS.get(unit_of[name], {}).items()
        ),
        *(partial(_zero, trial, name) for name in angles if name in compared),
    ]


def _of_parameters(trial: Trial) -> Iterator[Hypothesis[Read]]:
    """First angles that are turned, and sizes of which the half is taken for the whole."""
    bounds = trial.model.file.parameters
    for name, known in trial.plan.parameters.items():
        unit = None if name in trial.fitted else units.unit_of(name)
        if unit == "rad":
            yield from (partial(_parameter, name, known.value, 1.0, turn) for turn in TURNS)
        elif unit == "m" and (bounds[name].min or 0) > 0:
            yield from (partial(_parameter, name, known.value, part, 0.0) for part in (2.0, 0.5))


def _found(recording: Recording, name: str) -> tuple[str, str, Channel]:
    stream, full = recording.find(name)
    return stream, full, recording.streams[stream].channels[full]


def _with(recording: Recording, name: str, values: Array) -> Recording:
    stream_name, full, channel = _found(recording, name)
    stream = recording.streams[stream_name]
    channels = {**stream.channels, full: replace(channel, values=values)}
    changed = replace(stream, channels=channels)
    return replace(recording, streams={**recording.streams, stream_name: changed})


def _changed(name: str, factor: float, add: float, unit: str, read: Read) -> Change[Read]:
    """A channel whose sign, zero or unit is another one."""
    values = factor * _found(read.recording, name)[2].values + add
    if unit:
        says, cure = f"{name} in {unit}", f"write unit: {unit} for the channel {name}"
    elif add:
        says = f"{name} turned by {math.degrees(add):.3g}°"
        cure = f"add {add:.4f} rad as offset: to the channel {name}, in its own unit,"
    else:
        says, cure = f"the sign of {name} reversed", f"write sign: -1 for the channel {name}"
    changed = replace(read, recording=_with(read.recording, name, values))
    return Change(changed, says, f"{cure} in the mapping file")


def _exchanged(first: str, second: str, read: Read) -> Change[Read] | None:
    one, other = (_found(read.recording, name)[2].values for name in (first, second))
    if len(one) != len(other):
        return None
    both = _with(_with(read.recording, first, other), second, one)
    says = f"{first} and {second} exchanged"
    cure = f"exchange the columns of {first} and {second} in the mapping file"
    return Change(replace(read, recording=both), says, cure)


def _zero(trial: Trial, name: str, read: Read) -> Change[Read] | None:
    """The constant error of an angle, found from the mean of what is left."""
    by_rad = 0.0
    for _ in range(ROUNDS):
        try:
            pairs = list(trial.pairs(_changed(name, 1.0, by_rad, "", read).value, name))
        except SimcompareError:
            return None
        if not pairs:  # nothing judges this angle
            return None
        by_rad -= float(np.mean([np.nanmean(ours - theirs) for ours, theirs in pairs]))
    if not LEAST_ZERO_RAD < abs(by_rad) < math.pi:
        return None
    return _changed(name, 1.0, by_rad, "", read)


def _parameter(name: str, known: float, factor: float, add: float, read: Read) -> Change[Read]:
    value = factor * read.overrides.get(name, known) + add
    changed = replace(read, overrides={**read.overrides, name: value})
    return Change(changed, f"{name} = {value:.4g}", f"add --set {name}={value:.4g}")
