"""Sections of a report: what each shows of a run, ``None`` where there is nothing to show."""

from __future__ import annotations

from collections.abc import Callable

from simcompare.reports.render.parts import Part
from simcompare.reports.sections import fit_bounces, fit_tosses, fit_waveforms, pictures, validation
from simcompare.reports.sections.assistance import assistance
from simcompare.reports.sections.events import events
from simcompare.reports.sections.given import given
from simcompare.reports.sections.headline import headline
from simcompare.reports.sections.limits import limits
from simcompare.reports.sections.measurement import measurement
from simcompare.reports.sections.scores import scores
from simcompare.reports.sections.setup import setup
from simcompare.reports.sections.tuning import tuning
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.fit_tosses import TossFit
from simcompare.results.records.fit_waveforms import WaveformFit
from simcompare.results.records.run import Record
from simcompare.results.records.validation import ValidationRecord
from simcompare.results.run import Run

Section = Callable[[Run], Part | None]
#: at the end of every report
_LAST: tuple[Section, ...] = (given, limits, setup)
#: in the order in which a reader wants them
SECTIONS: tuple[Section, ...] = (
    headline,
    measurement,
    assistance,
    pictures.curves,
    events,
    pictures.energy,
    pictures.contrast,
    pictures.signals,
    scores,
    tuning,
    *_LAST,
)
#: the same for simulations held against a recording
VALIDATION: tuple[Section, ...] = (
    validation.answer,
    validation.gap,
    validation.residuals,
    validation.timings,
    validation.values,
    validation.parameters,
    validation.recording,
    *_LAST,
)
#: the same for parameters fitted to measured bounces
FIT: tuple[Section, ...] = (
    fit_bounces.answer,
    fit_bounces.engines,
    tuning,
    fit_bounces.forms,
    fit_bounces.speed,
    fit_bounces.identifiability,
    fit_bounces.holdout,
    fit_bounces.others,
    fit_bounces.measured,
    *_LAST,
)
#: the same for parameters fitted to signals over time
WAVES: tuple[Section, ...] = (
    fit_waveforms.answer,
    fit_waveforms.engines,
    fit_waveforms.holdout,
    fit_waveforms.identifiability,
    *_LAST,
)
#: the same for parameters fitted to tosses
TOSSES: tuple[Section, ...] = (fit_tosses.answer, fit_tosses.identifiability, *_LAST)


def of_run(record: Record) -> tuple[Section, ...]:
    """The sections that suit a run."""
    if isinstance(record, FitRecord):
        if isinstance(record.fit, TossFit):
            return TOSSES
        return WAVES if isinstance(record.fit, WaveformFit) else FIT
    return VALIDATION if isinstance(record, ValidationRecord) else SECTIONS
