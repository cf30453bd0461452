"""What run.json says of a validation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from simcompare.alignment.clock_line import Alignment
from simcompare.comparison.events import EventComparison
from simcompare.comparison.waveform import Waveform
from simcompare.inference.compared_values import ComparedValue
from simcompare.inference.plan import ClockPlan
from simcompare.model.recording import Event, Provenance
from simcompare.results.records.run import Record
from simcompare.statistics.agreement import Birge
from simcompare.statistics.gap import Gap
from simcompare.statistics.suspicions import Suspicion

#: what the parameters rest on
KNOWN, HELD_OUT, SAME = "known before", "held out", "same data"
#: parameters of a waveform, besides those known before
FITTED = "fitted"


@dataclass(frozen=True)
class ComparedProbe:
    """A probe and the channel that measured the same.

    Attributes:
        channel: of the recording.
        label: of the probe.
        unit: of both.
        judged: whether it is judged, or only aligns the clocks.
    """

    channel: str
    label: str
    unit: str
    judged: bool = True


@dataclass(frozen=True)
class ParameterRecord:
    """What was known of a parameter, and what was fitted.

    Attributes:
        name: with its unit.
        unit: as people write it.
        kind: "known", "read off", "given" by the user, "fitted", or the "scenario"'s own.
        known: value known before; ``None`` where it differs from segment to segment.
        u_known: its standard uncertainty.
        fitted: fitted value; ``None`` where it was not fitted.
        u_fitted: its standard uncertainty.
        source: where the value known before comes from.
    """

    name: str
    unit: str
    kind: str
    known: float | None
    u_known: float | None
    fitted: float | None
    u_fitted: float | None
    source: str


@dataclass(frozen=True)
class CalibrationRecord:
    """The fit of a validation's parameters.

    Attributes:
        recording: on which it was fitted.
        chosen_knowing: whether its streams were chosen after it was seen what the others say.
        names: fitted parameters.
        streams: on which they were fitted.
        rms: root mean square of the residuals, in the unit of the leading probe.
        how: where the covariance comes from.
        correlation: of the parameters (k, k).
        single: stream -> parameters fitted to it alone.
        at_bound: parameters that ended at a bound.
    """

    recording: str
    chosen_knowing: bool
    names: tuple[str, ...]
    streams: tuple[str, ...]
    rms: float
    how: str
    correlation: tuple[tuple[float, ...], ...]
    single: Mapping[str, tuple[float, ...]]
    at_bound: tuple[str, ...]


@dataclass(frozen=True)
class ProbeRecord:
    """How well a quantity was measured in one segment.

    Attributes:
        samples: usable samples.
        missing: samples that were not measured.
        saturated: samples at the end of the sensor's range.
        u: standard uncertainty of a sample.
        u_from: where that comes from.
    """

    samples: int
    missing: int
    saturated: int
    u: float
    u_from: str


@dataclass(frozen=True)
class SegmentRecord:
    """One segment of the recording.

    Attributes:
        stream: its stream.
        start_s: where it begins on the clock of its stream [s].
        duration_s: how long it lasts [s].
        short: whether the log ends before the window does.
        start: parameters that are known or were read off.
        probes: probe -> how well it was measured.
    """

    stream: str
    start_s: float
    duration_s: float
    short: bool = False
    start: Mapping[str, float] = field(default_factory=dict)
    probes: Mapping[str, ProbeRecord] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class WaveformRecord(Waveform):
    """How far an engine is from a measured signal.

    Attributes:
        source: name of the engine.
        stream: of the recording.
        probe: which quantity.
        unit: of that.
        judged: whether it is judged.
        parameters: "known before" or "fitted".
        aligned: whether the clocks were aligned.
    """

    source: str
    stream: str
    probe: str
    unit: str
    judged: bool
    parameters: str
    aligned: bool


@dataclass(frozen=True, kw_only=True)
class ValueRecord(ComparedValue):
    """A simulated value held against the measured one.

    Attributes:
        source: name of the engine.
        stream: of the recording.
        words: verdict in words.
    """

    source: str
    stream: str
    words: str = ""


@dataclass(frozen=True, kw_only=True)
class GapRecord(Gap):
    """What the gap between an engine as known before and the measurement is made of.

    Attributes:
        source: name of the engine.
        stream: of the recording.
        probe: which quantity.
        unit: of that.
        input: rms of the standard uncertainty from the parameters; ``None`` without a reference.
        covered: share of the samples within twice all standard uncertainties together.
    """

    source: str
    stream: str
    probe: str
    unit: str
    input: float | None = None
    covered: float | None = None


@dataclass(frozen=True, kw_only=True)
class TimingRecord(EventComparison):
    """How far the events of an engine are from the measured ones.

    Attributes:
        source: name of the engine.
        stream: of the recording.
        series: what the scenario calls these times.
    """

    source: str
    stream: str
    series: str


@dataclass(frozen=True)
class SpreadRecord:
    """How far the engines are from each other.

    Attributes:
        stream: of the recording.
        probe: which quantity.
        engines: their names.
        rms: root mean square about their mean, over the measured samples.
    """

    stream: str
    probe: str
    engines: tuple[str, ...]
    rms: float


@dataclass(frozen=True, kw_only=True)
class AgreementRecord(Birge):
    """Whether the engines agree in a value within their own step errors.

    Attributes:
        stream: of the recording.
        measure: what was measured.
        unit: of that.
        engines: their names.
        left_out: engines whose step error is unknown.
    """

    stream: str
    measure: str
    unit: str
    engines: tuple[str, ...]
    left_out: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class ApartRecord:
    """A segment that does not begin where its simulation does.

    Attributes:
        stream: of the recording.
        parameter: the scenario's own value of it says where the simulation starts.
        channel: what the parameter could be read off.
        offset: is added to the channel.
        over_s: for how long it is read [s].
        simulated: where the simulation starts.
        measured: where the recording starts.
        unit: of both.
    """

    stream: str
    parameter: str
    channel: str
    offset: float = 0.0
    over_s: float
    simulated: float
    measured: float
    unit: str


@dataclass(frozen=True, kw_only=True)
class Validation:
    """Simulations held against a recording.

    Attributes:
        recording: as the user called it.
        about: title, citation, licence and so on.
        provenance: the file and all that was done to it.
        basis: what the parameters rest on: "known before", "held out" or "same data".
        note: what the reader must know.
        align: how clocks were to be aligned.
        compare: probe -> the channel that measured the same.
        inputs: input -> the channel that it follows.
        parameters: what was known and fitted of each.
        fit: of the parameters; ``None`` where nothing was fitted.
        cases: the segments that were compared.
        events: of the recording.
        waveforms: how far each engine is from each signal.
        values: single values, simulated and measured.
        gaps: what each gap is made of.
        timings: when things happened.
        spread: how far the engines are from each other.
        agreement: whether the engines agree in each value.
        alignments: of the clock of each segment; ``None`` where it was not aligned.
        apart: segments that do not begin where the simulation does.
        sentences: the answer in words.
        suspected: a mistake in what is said of the recording, where one explains that it misfits.
    """

    recording: str
    about: Mapping[str, str]
    provenance: Provenance
    basis: str
    note: str = ""
    align: ClockPlan
    compare: Mapping[str, ComparedProbe]
    inputs: Mapping[str, str]
    parameters: tuple[ParameterRecord, ...]
    fit: CalibrationRecord | None
    cases: tuple[SegmentRecord, ...]
    events: tuple[Event, ...] = ()
    waveforms: tuple[WaveformRecord, ...]
    values: tuple[ValueRecord, ...]
    gaps: tuple[GapRecord, ...]
    timings: tuple[TimingRecord, ...] = ()
    spread: tuple[SpreadRecord, ...] = ()
    agreement: tuple[AgreementRecord, ...] = ()
    alignments: tuple[Alignment | None, ...] = ()
    apart: tuple[ApartRecord, ...] = ()
    sentences: tuple[str, ...] = ()
    suspected: Suspicion | None = None

    @property
    def streams(self) -> tuple[str, ...]:
        """Streams of the segments, each once."""
        return tuple(dict.fromkeys(one.stream for one in self.cases))


@dataclass(frozen=True, kw_only=True)
class ValidationRecord(Record):
    """What run.json says of a validation.

    Attributes:
        validation: what was found.
        recording_asked: the recording as the user named it.
    """

    kind: Literal["validation"] = "validation"
    validation: Validation
    recording_asked: str | tuple[str, ...] = ()
