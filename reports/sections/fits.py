"""The sections of each kind of fit, in the order in which a reader wants them."""

from __future__ import annotations

from simcompare.reports.render.parts import Section
from simcompare.reports.sections import fit_bounces, fit_tosses, fit_waveforms, pictures
from simcompare.reports.sections.tuning import tuning
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.fit_tosses import TossFit
from simcompare.results.records.fit_waveforms import WaveformFit
from simcompare.results.records.run import Record

#: of parameters fitted to measured bounces
BOUNCES: tuple[Section, ...] = (
    fit_bounces.answer,
    pictures.moving,
    fit_bounces.residuals,
    fit_bounces.holdout,
    fit_bounces.engines,
    tuning,
    fit_bounces.speed,
    fit_bounces.forms,
    fit_bounces.identifiability,
    fit_bounces.others,
    fit_bounces.measured,
)
#: of parameters fitted to signals over time
WAVES: tuple[Section, ...] = (
    fit_waveforms.answer,
    pictures.moving,
    fit_waveforms.residuals,
    fit_waveforms.engines,
    fit_waveforms.holdout,
    fit_waveforms.identifiability,
)
#: of parameters fitted to tosses
TOSSES: tuple[Section, ...] = (fit_tosses.answer, fit_tosses.identifiability)


def of_fit(record: Record) -> tuple[Section, ...]:
    """Those that suit a fit."""
    assert isinstance(record, FitRecord)
    if isinstance(record.fit, TossFit):
        return TOSSES
    return WAVES if isinstance(record.fit, WaveformFit) else BOUNCES
