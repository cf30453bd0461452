"""Sections of a report: a template name and a dictionary."""

from __future__ import annotations

from simcompare.reports.sections.assistance import Assistance
from simcompare.reports.sections.base import Section
from simcompare.reports.sections.contrast import Contrast
from simcompare.reports.sections.curves import Curves
from simcompare.reports.sections.energy import Energy
from simcompare.reports.sections.events import Events
from simcompare.reports.sections.fit_bounces import (
    FitAnswer,
    FitEngines,
    FitForms,
    FitHeldOut,
    FitKnown,
    FitMeasured,
    FitOthers,
    FitSpeed,
)
from simcompare.reports.sections.fit_waveforms import (
    WavesAnswer,
    WavesEngines,
    WavesHeldOut,
    WavesKnown,
)
from simcompare.reports.sections.given import Given
from simcompare.reports.sections.headline import Headline
from simcompare.reports.sections.limits import Limits
from simcompare.reports.sections.measured import Measured
from simcompare.reports.sections.scores import Scores
from simcompare.reports.sections.setup import Setup
from simcompare.reports.sections.signals import Signals
from simcompare.reports.sections.tuning import Tuning
from simcompare.reports.sections.validation import (
    Gap,
    Parameters,
    RealAnswer,
    RealValues,
    Residuals,
    Source,
    Timings,
)
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.run import Record
from simcompare.results.records.validation import ValidationRecord

#: in the order in which a reader wants them
SECTIONS: tuple[Section, ...] = (
    Headline(),
    Measured(),
    Assistance(),
    Curves(),
    Events(),
    Energy(),
    Contrast(),
    Signals(),
    Scores(),
    Tuning(),
    Given(),
    Limits(),
    Setup(),
)
#: the same for simulations held against a recording
VALIDATION: tuple[Section, ...] = (
    RealAnswer(),
    Gap(),
    Residuals(),
    Timings(),
    RealValues(),
    Parameters(),
    Source(),
    Given(),
    Limits(),
    Setup(),
)
#: the same for parameters fitted to measured bounces
FIT: tuple[Section, ...] = (
    FitAnswer(),
    FitEngines(),
    Tuning(),
    FitForms(),
    FitSpeed(),
    FitKnown(),
    FitHeldOut(),
    FitOthers(),
    FitMeasured(),
    Given(),
    Limits(),
    Setup(),
)
#: the same for parameters fitted to signals over time
WAVES: tuple[Section, ...] = (
    WavesAnswer(),
    WavesEngines(),
    WavesHeldOut(),
    WavesKnown(),
    Given(),
    Limits(),
    Setup(),
)


def of_run(record: Record) -> tuple[Section, ...]:
    """The sections that suit a run."""
    if isinstance(record, FitRecord):
        return WAVES if record.fit.get("by") == "waveform" else FIT
    return VALIDATION if isinstance(record, ValidationRecord) else SECTIONS
