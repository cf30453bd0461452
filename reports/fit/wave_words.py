"""What a fit to signals over time says, in sentences."""

from __future__ import annotations

from dataclasses import replace

from simcompare import units
from simcompare.notation import number, sentence
from simcompare.reports.fit import identifiability_words
from simcompare.reports.fit.identifiability_words import parameter
from simcompare.results.records.fit_waveforms import Chosen, WaveformFit


def worded(fit: WaveformFit, unit: str) -> WaveformFit:
    """The record of a fit with all its sentences.

    Args:
        fit: what was found.
        unit: of the leading probe, as people write it.
    """
    known = identifiability_words.of_signals(fit.identifiability)
    found = replace(
        fit,
        chosen_words=tuple(map(_chosen, fit.chosen)),
        identifiability=replace(fit.identifiability, words=known),
        holdout=replace(fit.holdout, text=_holdout(fit, unit)),
    )
    return replace(found, sentences=tuple(_sentences(found)))


def _chosen(one: Chosen) -> str:
    """What of a recording is fitted and what is held out."""
    if not one.stated:
        return (
            f"{one.fitted} does not say which streams are fitted (calibrate:), so all"
            f" {len(one.fitted_streams)} are, and nothing is held out."
        )
    streams = ", ".join(one.fitted_streams)
    held = ", ".join(one.held_out_streams) or "nothing"
    if one.held_out != one.fitted:
        return f"Fitted to {one.fitted} ({streams}); held out: {one.held_out} ({held})."
    return f"Fitted to {streams} of {one.fitted}; held out: {held}."


def _unit(name: str) -> str:
    unit = units.symbol(units.unit_of(name))
    return "" if unit == "1" else f" {unit}"


def _sentences(fit: WaveformFit) -> list[str]:
    closed, words = fit.closed_form, []
    for name, row in closed.parameters.items():
        words.append(
            f"The {parameter(name)} is {number(row.value, row.u)}{_unit(name)}, with 95 % between"
            f" {row.low:.6g} and {row.high:.6g} ({closed.how})."
        )
        if row.u_known > row.u_data:
            most = max(closed.known, key=lambda own: closed.known[own][name], default="the start")
            words.append(
                f"Most of the uncertainty of the {parameter(name)} comes from what was known"
                f" before, above all from {parameter(most)}."
            )
    words += [
        f"The {parameter(name)} ended at a bound of the scenario: the recording asks for more than"
        " it allows, or for an effect that the scenario does not have."
        for name in closed.at_bound
    ]
    words += [sentence(text) for text in fit.identifiability.words]
    return [*words, *_disagreement(fit), fit.holdout.text]


def _disagreement(fit: WaveformFit) -> list[str]:
    """How far the engines' own parameters are from each other."""
    words = []
    good = [source for source in fit.sources if source.parameters]
    for name, closed in fit.closed_form.parameters.items() if len(good) > 1 else ():
        values = [source.parameters[name].value or 0.0 for source in good]
        spread = max(values) - min(values)
        if spread > 2 * (closed.u or 0.0) > 0:
            words.append(
                f"To show the same, {len(good)} engines must be given values of {parameter(name)}"
                f" that differ by {spread:.2g}{_unit(name)}: their steps differ."
            )
    return words


def _holdout(fit: WaveformFit, unit: str) -> str:
    if not fit.holdout.streams:
        return "No stream was held out, so nothing was validated."
    predicted = [own for row in fit.holdout.streams for own in row.engines.values()]
    if not predicted:
        return "Streams were held out, but no engine could be run for them."
    judged = [v.e_n for own in predicted for v in own.values if v.e_n is not None]
    good = sum(abs(value) <= 1 for value in judged)
    probe = fit.probes[0]
    sizes = [own.rms[probe] for own in predicted]
    return (
        f"{good} of {len(judged)} values that engines predict for streams that were held out agree"
        " with the measured ones within their uncertainty (|E_n| ≤ 1, k = 2);"
        f" {probe} is {number(float(f'{min(sizes):.3g}'))} to"
        f" {number(float(f'{max(sizes):.3g}'))} {unit} off (root mean square)."
    )
