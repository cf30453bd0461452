"""What a fit to signals over time says, in sentences."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from simcompare import units
from simcompare.notation import capital, sentence
from simcompare.reports.fit import fits, identifiability_words
from simcompare.reports.validation import phrases
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
    name, other = Path(one.fitted).name, Path(one.held_out).name
    if not one.stated:
        count = phrases.counted(len(one.fitted_streams), "segment")
        return f"Fitted: all of {name}, {count}. Nothing was kept back to test the fit."
    streams = ", ".join(one.fitted_streams)
    held = ", ".join(one.held_out_streams) or "nothing"
    if one.held_out != one.fitted:
        return f"Fitted: {name} ({streams}). Kept back to test it: {other} ({held})."
    return f"Fitted: {streams} of {name}. Kept back to test the fit: {held}."


def _unit(name: str) -> str:
    unit = units.symbol(units.unit_of(name))
    return "" if unit == "1" else f" {unit}"


def _sentences(fit: WaveformFit) -> list[str]:
    closed, words = fit.closed_form, []
    for name, row in closed.parameters.items():
        words.append(f"{capital(phrases.parameter(name))}: {fits.of_95(row, name)} (95 %).")
        if row.u_data is not None and row.u_known > row.u_data:
            most = max(closed.known, key=lambda own: closed.known[own][name], default="the start")
            words.append(
                f"Most of the uncertainty of the {phrases.parameter(name)} comes from that of the"
                f" {phrases.parameter(most)}."
            )
    words += [
        f"The {phrases.parameter(name)} ended at its limit: the model may lack something."
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
                f"The engines need values of {phrases.parameter(name)} that differ by"
                f" {spread:.2g}{_unit(name)} to move alike: their steps differ."
            )
    return words


def _holdout(fit: WaveformFit, unit: str) -> str:
    if not fit.holdout.streams:
        return "No segment was kept back, so the fit was not tested."
    predicted = [own for row in fit.holdout.streams for own in row.engines.values()]
    if not predicted:
        return "Segments were kept back, but no engine could run them."
    probe, words = fit.probes[0], []
    off = phrases.size_span([own.rms[probe] for own in predicted], unit)
    count = phrases.counted(len(fit.holdout.streams), "segment")
    verb = "was" if len(fit.holdout.streams) == 1 else "were"
    words.append(
        f"In {count} that {verb} not fitted, the engines are off by {off} (root mean square)."
    )
    judged = [v.e_n for own in predicted for v in own.values if v.e_n is not None]
    if judged:
        good = sum(abs(value) <= 1 for value in judged)
        agree = "agrees" if good == 1 else "agree"
        words.append(f"There, {good} of {phrases.counted(len(judged), 'value')} {agree} within the"
                     " uncertainty (|E_n| ≤ 1).")  # fmt: skip
    return " ".join(words)
