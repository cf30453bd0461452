"""What fit.json says of a fit to signals over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

from pydantic import Field

from simcompare.results.records.fit_parts import AnyKind, EngineParameter, EngineRow, Known, Rms

#: version of what is stored
FORMAT = 1


@dataclass(frozen=True)
class MeasuredProbe:
    """What a segment has of one probe.

    Attributes:
        samples: how many.
        missing: samples that were not measured.
        u: standard uncertainty of a sample.
        u_from: where it comes from.
    """

    samples: int
    missing: int
    u: float
    u_from: str


@dataclass(frozen=True, kw_only=True)
class FitSegment:
    """A part of a recording.

    Attributes:
        stream: its name.
        start_s: where it begins on the clock of the recording [s].
        duration_s: how long it lasts [s].
        start: what is known of its start.
        probes: what was measured.
        fitted_start: start that the fit found.
    """

    stream: str
    start_s: float
    duration_s: float
    start: Mapping[str, float]
    probes: Mapping[str, MeasuredProbe]
    fitted_start: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Chosen:
    """Which streams of a recording are fitted, and which are held out.

    Attributes:
        fitted: recording that is fitted.
        fitted_streams: its streams that are.
        held_out: recording that is held out; the same where a recording is split.
        held_out_streams: its streams that are.
        stated: whether the recording says which streams are fitted.
    """

    fitted: str
    fitted_streams: tuple[str, ...]
    held_out: str
    held_out_streams: tuple[str, ...]
    stated: bool = True


@dataclass(frozen=True, kw_only=True)
class WaveParameter(EngineParameter):
    """A parameter with the parts of its uncertainty.

    Attributes:
        low: lower end of the 95 % interval.
        high: upper end.
        u_data: from the data.
        u_known: from what was known before.
    """

    low: float
    high: float
    u_data: float
    u_known: float


@dataclass(frozen=True, kw_only=True)
class FittedReference:
    """The reference as it was fitted.

    Attributes:
        parameters: what was fitted.
        names: of them, in the order of the correlation.
        correlation: of them.
        rms: of the residuals, in the unit of the leading probe.
        how: where the covariance comes from, in words.
        streams: that were fitted.
        single: stream -> estimates of that stream alone.
        at_bound: parameters that ended at a bound.
        nuisance: parameters that belong to the recording alone.
        known: parameter that was known -> how far each estimate follows its standard uncertainty.
    """

    parameters: Mapping[str, WaveParameter]
    names: tuple[str, ...]
    correlation: tuple[tuple[float | None, ...], ...]
    rms: float
    how: str
    streams: tuple[str, ...]
    single: Mapping[str, tuple[float, ...]]
    at_bound: tuple[str, ...]
    nuisance: Mapping[str, float]
    known: Mapping[str, Mapping[str, float]]


@dataclass(frozen=True)
class EffectiveSignal:
    """What an engine shows, as the reference would need it or as a measure sees it.

    Attributes:
        value: mean over the fitted segments.
        u: standard uncertainty.
        unit: of all of them.
        measured: what was measured, of a measure.
    """

    value: float
    u: float | None
    unit: str
    measured: float | None = None


@dataclass(frozen=True, kw_only=True)
class JudgedValue:
    """A value of a measure in a segment that was not fitted, simulated and measured.

    Attributes:
        measure: its name.
        probe: that it looks at.
        unit: of all numbers.
        simulated: value.
        measured: value.
        u_num: standard uncertainty from the step.
        u_input: from the parameters.
        u_data: of the measurement.
        u_val: all of them together.
        e_n: the difference over twice that.
    """

    measure: str
    probe: str
    unit: str
    simulated: float | None
    measured: float | None
    u_num: float | None
    u_input: float | None
    u_data: float | None
    u_val: float | None
    e_n: float | None


@dataclass(frozen=True, kw_only=True)
class Predicted:
    """What a source predicts of a segment: residuals (RMS) by probe, and values of measures."""

    rms: Rms
    values: tuple[JudgedValue, ...]


@dataclass(frozen=True, kw_only=True)
class SourcePrediction(Predicted):
    """The same with the stream of the segment."""

    source: str


@dataclass(frozen=True, kw_only=True)
class HeldOutSegment(Predicted):
    """A segment that was not fitted, as the reference predicts it, and what engines predict."""

    stream: str
    duration_s: float
    engines: Mapping[str, Predicted]


@dataclass(frozen=True)
class WaveHoldout:
    """All segments that were not fitted, and what they say in words."""

    streams: tuple[HeldOutSegment, ...] = ()
    drops: tuple[()] = ()
    text: str = ""


@dataclass(frozen=True)
class WaveValid:
    """Where a fit holds: step, length of the longest segment, range of every probe."""

    step_s: float
    duration_s: float
    ranges: Mapping[str, tuple[float, float]]


@dataclass(frozen=True, kw_only=True)
class WaveEngine(EngineRow):
    """What one engine must be given, and what it then shows.

    Attributes:
        parameters: what it must be given; empty where it failed.
        effective: what it shows.
        change: of the unknowns that one more round would bring.
        rms: of the residuals, segment by segment and probe by probe.
        holdout: what it predicts of segments that were not fitted.
    """

    parameters: Mapping[str, WaveParameter] = field(default_factory=dict)
    effective: Mapping[str, EffectiveSignal] = field(default_factory=dict)
    change: Annotated[Mapping[str, float], Field(alias="left")] = field(default_factory=dict)
    rms: Mapping[str, Rms] = field(default_factory=dict)
    holdout: tuple[SourcePrediction, ...] = ()


@dataclass(frozen=True, kw_only=True)
class WaveformFit(AnyKind):
    """What fit.json says of a fit to signals over time.

    Attributes:
        by: the kind.
        format: version of what is stored.
        probes: what is compared, the leading one first.
        measured: segments that were fitted.
        chosen: what of each recording is fitted and what is held out.
        chosen_words: the same in words.
        held_out: segments that were not fitted.
        closed_form: the reference.
        identifiability: what the data can tell of the unknowns.
        sources: the engines.
        holdout: what is predicted of segments that were not fitted.
        valid: where it holds.
    """

    by: Literal["waveform"] = "waveform"
    format: int = FORMAT
    probes: tuple[str, ...]
    measured: tuple[FitSegment, ...]
    chosen: tuple[Chosen, ...] = ()
    chosen_words: Annotated[tuple[str, ...], Field(alias="told")] = ()
    held_out: tuple[FitSegment, ...]
    closed_form: FittedReference
    identifiability: Known
    sources: tuple[WaveEngine, ...]
    holdout: WaveHoldout
    valid: WaveValid
