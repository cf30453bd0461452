"""The answer of a fit in at most 40 words, and the few numbers that it begins with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from simcompare.engine.calibration.calibration import MAX_RESTITUTION
from simcompare.notation import capital
from simcompare.reports.fit import fits
from simcompare.reports.fit.fits import RESTITUTION
from simcompare.reports.render import numbers
from simcompare.reports.render.parts import KeyNumber
from simcompare.reports.run import runs
from simcompare.reports.validation import phrases
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.records.fit_parts import EngineRow
from simcompare.results.records.fit_tosses import TossErrors, TossFit, TossMean, TossParameter
from simcompare.results.records.fit_waveforms import WaveformFit
from simcompare.results.run import Run

#: parameters that are told at the top; the table has all
_PARAMETERS = 2


def short(run: Run) -> tuple[str, ...]:
    """What the fit found, in one to three sentences."""
    found = fits.of_any(run)
    if isinstance(found, BouncesFit):
        return _of_bounces(found)
    return _of_signals(found) if isinstance(found, WaveformFit) else _of_tosses(found)


def others(run: Run, sentences: Sequence[str]) -> list[str]:
    """The sentences that the short answer does not hold already."""
    said = short(run)
    return [sentence for sentence in sentences if sentence not in said]


def key_numbers(run: Run) -> tuple[KeyNumber, ...]:
    """Three or four numbers."""
    found = fits.of_any(run)
    if isinstance(found, BouncesFit):
        return _numbers_of_bounces(found)
    if isinstance(found, WaveformFit):
        return _numbers_of_signals(run, found)
    return _numbers_of_tosses(found)


def able(sources: Sequence[EngineRow]) -> list[str]:
    """Names of the engines that were fitted."""
    return [source.name for source in sources if source.status == "ok"]


def key_number(label: str, words: str, unit: str) -> KeyNumber:
    """A number with its interval below it.

    Args:
        label: what it is.
        words: such as ``0.774 ± 0.003``, ``(1.5 ± 0.4)·10⁻⁴`` or ``0.77 (0.76 to 0.80)``.
        unit: of it, "1" for none.
    """
    after = "" if unit == "1" else f" {unit}"
    inner, _, power = words[1:].partition(")") if words.startswith("(") else (words, "", "")
    value, found, half = inner.partition(" ± ")
    if found:
        return KeyNumber(label, f"{value}{power}{after}", f"± {half}{power} (95 %)")
    value, found, ends = inner.partition(" (")
    return KeyNumber(label, f"{value}{after}", f"{ends.rstrip(')')} (95 %)" if found else "95 %")


def engines_words(sources: Sequence[EngineRow]) -> str:
    """How many engines were fitted: ``6 of 7 engines``, or the one that was."""
    good = able(sources)
    if len(sources) == 1 and good:
        return good[0]
    return f"{len(good)} of {phrases.counted(len(sources), 'engine')}"


# bounces


def _of_bounces(found: BouncesFit) -> tuple[str, ...]:
    return (fits.restitution_words(found), _engines(found))


def _engines(found: BouncesFit) -> str:
    good = able(found.sources)
    if not good:
        return "No engine could be fitted."
    if found.tuned_to is None:
        verb = "was" if len(good) == 1 else "were"
        return f"{engines_words(found.sources)} {verb} fitted, with our helps."
    goal = found.tuned_to
    if goal.restitution > MAX_RESTITUTION:
        return (
            f"Engines are tuned up to {MAX_RESTITUTION:g}; this ball has"
            f" {numbers.plain(goal.restitution, 4)} at the first impact, so none bounces as it"
            " does."
        )
    verb = "bounces" if len(good) == 1 else "bounce"
    so = "so"
    if found.choice.disagree:
        so = f"with {numbers.plain(goal.restitution, 3)}, the models' mean,"
    return (
        f"With the numbers below, {engines_words(found.sources)} {verb} {so} at the first impact"
        f" ({numbers.plain(goal.speed_m_s, 3)} m/s), at a step of"
        f" {numbers.plain(1e3 * found.valid.engine_step_s, 4)} ms."
    )


def _numbers_of_bounces(found: BouncesFit) -> tuple[KeyNumber, ...]:
    closed = found.closed_form.parameters
    first = [key_number(*fits.restitution_of_first(found), "1")] if RESTITUTION in closed else []
    heights = [(name, row) for name, row in closed.items() if name.startswith("drop_height_m")][:1]
    known = [key_number(fits.titles(found)[name], fits.told_95(found, row), fits.unit(name))
             for name, row in heights]  # fmt: skip
    return (*first, *known, _used(found), _fitted(found.sources))


def _used(found: BouncesFit) -> KeyNumber:
    """How much was measured, and how much of it was left out."""
    impacts = sum(len(drop.times_s) for drop in found.measured)
    intervals = sum(len(drop.intervals_s) for drop in found.measured)
    dropped = sum(len(drop.dropped) for drop in found.measured)
    missed = sum(len(drop.missed) for drop in found.measured)
    notes = [f"{dropped} left out"] if dropped else []
    notes += [f"{missed} not recorded"] if missed else []
    if intervals and not impacts:
        return KeyNumber("intervals used", str(intervals), ", ".join(notes) or "none left out")
    if not impacts:
        heights = sum(len(drop.heights_m) for drop in found.measured)
        return KeyNumber("heights used", str(heights), ", ".join(notes) or "none left out")
    samples = sum(drop.samples for drop in found.measured)
    if samples:
        return KeyNumber("samples used", str(samples), ", ".join(notes) or "none left out")
    return KeyNumber("impacts used", str(impacts), ", ".join(notes) or "none left out")


def _fitted(sources: Sequence[EngineRow]) -> KeyNumber:
    missing = [source.name for source in sources if source.status != "ok"]
    note = f"not {phrases.listed(missing)}" if missing else "all could be fitted"
    return KeyNumber("engines", f"{len(able(sources))} of {len(sources)}", note)


# signals over time


def _of_signals(found: WaveformFit) -> tuple[str, ...]:
    streams = phrases.counted(len(found.measured), "segment")
    names = phrases.parameters(list(found.closed_form.parameters))
    verb = "was" if len(found.closed_form.parameters) == 1 else "were"
    words = [f"{capital(names)} {verb} fitted to {streams} of the recording."]
    words.append(f"{engines_words(found.sources)} could be fitted.")
    if not found.holdout.streams:
        words.append("No segment was kept back to test the fit.")
    return tuple(words)


def _numbers_of_signals(run: Run, found: WaveformFit) -> tuple[KeyNumber, ...]:
    closed = list(found.closed_form.parameters.items())
    more = len(closed) - _PARAMETERS
    rows = [key_number(phrases.parameter(name), fits.of_95(row), fits.unit(name))
            for name, row in closed[:_PARAMETERS]]  # fmt: skip
    if more > 0:
        rows[-1] = replace(rows[-1], note=f"{rows[-1].note}, {more} more below")
    probe = found.probes[0]
    unit = runs.probes(run)[probe].unit
    off = phrases.human(found.closed_form.rms, unit)
    rows.append(KeyNumber("fit and recording differ by", off, "RMS"))
    return (*rows, _fitted(found.sources))


# tosses


def _of_tosses(found: TossFit) -> tuple[str, ...]:
    good = [source for source in found.sources if source.parameters]
    if not good:
        return ("No engine could be fitted.",)
    held = [(source.name, source.holdout) for source in good if source.holdout is not None]
    words = [f"{capital(phrases.parameters(found.unknowns))} were fitted to"
             f" {phrases.counted(len(found.fitted), 'toss', 'tosses')}."]  # fmt: skip
    if len(found.unknowns) == 1:
        words[0] = words[0].replace(" were ", " was ")
    if held:
        name, best = min(held, key=lambda one: one[1].position.mean)
        nearest = f"the nearest engine, {name}," if len(held) > 1 else name
        words.append(
            f"In {len(best.positions)} other tosses {nearest} is off by"
            f" {_mean(best.position)} % of the cube's width (95 %)."
        )
    return tuple(words)


def _mean(own: TossMean) -> str:
    low, high = own.interval95
    return numbers.with_u(own.mean, (high - low) / 2)


def _numbers_of_tosses(found: TossFit) -> tuple[KeyNumber, ...]:
    good = [source for source in found.sources if source.parameters]
    rows = [KeyNumber(fits.title(name), _among([s.parameters[name] for s in good]), _who(good))
            for name in found.unknowns[:_PARAMETERS] if good]  # fmt: skip
    held = [source.holdout for source in good if source.holdout is not None]
    if held:
        rows.append(
            KeyNumber("predicted tosses off by", _best(held), "of the cube's width, ± 95 %")
        )
    return (*rows, _fitted(found.sources))


def _among(rows: Sequence[TossParameter]) -> str:
    if len(rows) == 1:
        return numbers.with_u(rows[0].value, rows[0].u)
    low, high = (end(row.value for row in rows) for end in (min, max))
    return phrases.ends(numbers.plain(low, 3), numbers.plain(high, 3))


def _who(sources: Sequence[EngineRow]) -> str:
    return f"in {sources[0].name}, ± u" if len(sources) == 1 else f"in {len(sources)} engines"


def _best(held: Sequence[TossErrors]) -> str:
    return f"{_mean(min(held, key=lambda one: one.position.mean).position)} %"
