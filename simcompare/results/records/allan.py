"""What is found in the noise of a record at rest."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare.results.records.run import Software
from simcompare.statistics.allan_terms import GaussMarkov


@dataclass(frozen=True)
class NoiseTerm:
    """One noise of one axis.

    Attributes:
        name: "N", "B", "K", "Q" or "R".
        value: the coefficient, ``None`` where the record does not show it.
        u: its standard uncertainty.
        limit: it is below this with 95 % probability.
        unit: SI unit of these.
        sheet_unit: unit of data sheets.
        sheet_size: size of that unit in SI.
    """

    name: str
    value: float | None
    u: float | None
    limit: float
    unit: str
    sheet_unit: str
    sheet_size: float


@dataclass(frozen=True)
class AxisNoise:
    """The noise of one channel.

    Attributes:
        channel: its name.
        unit: SI unit of the readings.
        mean: of the readings.
        samples: how many readings.
        tau_s: averaging times [s].
        deviation: overlapping Allan deviation.
        low: lower ends of the 95 % intervals.
        high: upper ends of them.
        noise_types: at each averaging time, such as "white".
        terms: N, B, K, Q and R.
        gauss_markov: where the record shows one.
        fitted: Allan deviation of all noises that are seen.
        chi_squared: of the fit.
        degrees_of_freedom: of it.
        from_s: shortest averaging time that was fitted [s].
        widened: factor on the standard uncertainties, above 1 where the fit is poor.
        best_tau_s: averaging time of the lowest deviation [s].
        best: the lowest deviation.
        still_falls: whether it is the longest averaging time that has the lowest deviation.
        rounding: noise density that rounding to whole counts adds, one-sided, SI; 0 where readings
            are not quantised.
    """

    channel: str
    unit: str
    mean: float
    samples: int
    tau_s: tuple[float, ...]
    deviation: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    noise_types: tuple[str, ...]
    terms: tuple[NoiseTerm, ...]
    gauss_markov: GaussMarkov | None
    fitted: tuple[float, ...]
    chi_squared: float
    degrees_of_freedom: int
    from_s: float
    widened: float
    best_tau_s: float
    best: float
    still_falls: bool
    rounding: float

    def term(self, name: str) -> NoiseTerm:
        """One of the noises."""
        return next(term for term in self.terms if term.name == name)


@dataclass(frozen=True)
class AgainstSheet:
    """White noise of one channel beside what a data sheet says.

    Attributes:
        channel: its name.
        sheet: name of the data sheet.
        part: of the chip.
        stated: noise density in the sheet, one-sided, SI.
        found: noise density of the record, one-sided: √2 of N, less what rounding to counts adds.
        u: its standard uncertainty.
        ratio: of the two.
        u_ratio: standard uncertainty of the ratio.
    """

    channel: str
    sheet: str
    part: str
    stated: float
    found: float
    u: float
    ratio: float
    u_ratio: float


@dataclass(frozen=True)
class Finding:
    """One test of an audit.

    Attributes:
        test: its name.
        channel: of which channel; empty for several.
        fault: whether the stream fails it.
        p: chance of so extreme a stream without the fault; 0 where it is impossible.
        text: what was found, in a sentence; what is in brackets is of this channel.
    """

    test: str
    channel: str
    fault: bool
    p: float
    text: str


@dataclass(frozen=True)
class Match:
    """A sensor of a data sheet beside the noise of a stream.

    Attributes:
        sheet: name of the data sheet.
        part: of the chip.
        ratio: noise of the stream over that of the sheet, mean of the axes.
        fits: whether every axis agrees.
    """

    sheet: str
    part: str
    ratio: float
    fits: bool


@dataclass(frozen=True, kw_only=True)
class NoiseAnalysis:
    """Noise of the channels of a record.

    Attributes:
        created: date and time, ISO 8601.
        source: the recording as the user named it.
        title: what the recording is.
        rate_Hz: readings in a second.
        start_s: where the stretch begins [s].
        end_s: where it ends [s].
        length_s: of the whole record [s].
        chosen: "given" by the user, "still" where it is the longest still stretch, "all" where
            that is the whole record, "whole" where the whole record is asked for, "gap".
        still_s: the still part, where something may move in the stretch that was given [s].
        axes: the channels.
        silent: channels whose readings are all the same.
        against: the channels beside a data sheet, where one is named.
        audited: whether the stream was audited.
        findings: of the audit.
        matches: data sheets beside the stream, of the audit.
        software: versions.
    """

    created: str
    source: str
    title: str
    rate_Hz: float
    start_s: float
    end_s: float
    length_s: float
    chosen: str
    axes: tuple[AxisNoise, ...]
    silent: tuple[str, ...] = ()
    still_s: tuple[float, float] | None = None
    against: tuple[AgainstSheet, ...] = ()
    audited: bool = False
    findings: tuple[Finding, ...] = ()
    matches: tuple[Match, ...] = ()
    software: Software
