"""How large the gap between simulations and a recording is and what it is made of, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from simcompare.reports.validation import phrases
from simcompare.results.records.validation import (
    FITTED,
    KNOWN,
    SAME,
    GapRecord,
    Validation,
    WaveformRecord,
)

_PARTS = {
    "removed": "the parameters",
    "model_form": "the model",
    "numerical": "the step",
    "noise": "noise",
}
#: a part of this share is most of the whole; an error below the second is small beside another
_DOMINANT, _SMALL = 0.5, 0.2
#: engines this close together, beside how far they are from reality, agree far better
_CLOSE = 0.1
#: and these are the same but for rounding
_SAME = 1e-9
#: a share of the gap by which a fit made it larger that is worth a word
_WORSE = 0.005
#: more quantities than these are told in one sentence
_MANY = 2
#: samples that a band with k = 2 holds where nothing else is wrong
_ALL = 0.95


def sentences(validation: Validation) -> list[str]:
    """How large, and what it is made of."""
    return [*_how_large(validation), *_made_of(validation)]


def is_covered(rows: Sequence[GapRecord]) -> bool:
    """Whether what is not known of the parameters may explain all that is left."""
    covered = [row.covered for row in rows if row.covered is not None]
    return bool(covered) and min(covered) >= _ALL


def judged_rows(validation: Validation, probe: str) -> list[WaveformRecord]:
    """Rows of a quantity with the parameters that are judged, on aligned clocks if there are any.

    Args:
        validation: the record of the validation.
        probe: which quantity.
    """
    parameters = KNOWN if validation.fit is None else FITTED
    last = [r for r in validation.waveforms if r.probe == probe and r.parameters == parameters]
    aligned = any(row.aligned for row in last)
    return [row for row in last if row.aligned == aligned]


def off(validation: Validation, rows: Sequence[WaveformRecord]) -> str:
    """How far simulations are off, in a unit that a person uses, and as a share of the range."""
    size = phrases.size_span([row.rmse for row in rows], rows[0].unit)
    if any(phrases.is_constant(validation, row) for row in rows):
        return size
    return f"{size}, {phrases.span([row.nrmse or 0.0 for row in rows])} of the measured range"


def before_the_fit(validation: Validation, rows: Sequence[WaveformRecord]) -> list[WaveformRecord]:
    """The rows that belong to some fitted ones with the parameters known before."""
    return [
        row for row in validation.waveforms
        if validation.fit is not None and row.probe == rows[0].probe
        and (row.parameters, row.aligned) == (KNOWN, rows[0].aligned)
    ]  # fmt: skip


def worse(validation: Validation, rows: Sequence[GapRecord]) -> float:
    """By which part a fit made the gap (root mean square) larger at most; 0 where it did not.

    Args:
        validation: the record of the validation.
        rows: its gaps, or some of them.
    """
    removed = [row.shares.removed for row in rows]
    if validation.fit is None or not removed or min(removed) > -_WORSE:
        return 0.0
    return math.sqrt(1 - min(removed)) - 1


# how large


def _how_large(validation: Validation) -> Iterator[str]:
    probes = list(dict.fromkeys(row.probe for row in validation.waveforms if row.judged))
    if len(probes) > _MANY:
        shown = (f"{phrases.label(validation, probe)} {_short_off(validation, probe)}"
                 for probe in probes)  # fmt: skip
        yield f"The simulation is off by (root mean square): {'; '.join(shown)}."
        yield from _numerical(validation.gaps)
        yield from _spread(validation, probes)
        return
    for probe in probes:
        yield from _size(validation, probe)
        yield from _numerical([row for row in validation.gaps if row.probe == probe])
        yield from _spread(validation, [probe])


def _short_off(validation: Validation, probe: str) -> str:
    rows = judged_rows(validation, probe)
    return phrases.size_span([row.rmse for row in rows], rows[0].unit)


def _size(validation: Validation, probe: str) -> Iterator[str]:
    rows = judged_rows(validation, probe)
    label = phrases.label(validation, probe)
    yield f"The simulated {label} is off by {off(validation, rows)} (root mean square)."
    before = before_the_fit(validation, rows)
    if before:
        yield f"Before the fit it was {_sizes(before)}."
    raw = [r for r in validation.waveforms if r.probe == probe and not r.aligned]
    raw = [r for r in raw if r.parameters == rows[0].parameters]
    if rows[0].aligned and raw:
        yield f"With the clocks as recorded it would be {_sizes(raw)}."
    worst = max(rows, key=lambda row: row.max_abs)
    there = [row for row in rows if row.stream == worst.stream]
    most = phrases.human(worst.max_abs, worst.unit)
    alike = [row.source for row in there if phrases.human(row.max_abs, row.unit) == most]
    who = phrases.whose(alike, phrases.engines_of(there))
    yield f"At one instant it is off by {most}, in {who}{phrases.where(validation, worst)}."


def _sizes(rows: Sequence[WaveformRecord]) -> str:
    return phrases.size_span([row.rmse for row in rows], rows[0].unit)


def _numerical(gaps: Sequence[GapRecord]) -> Iterator[str]:
    """How much of the gap is the engines' own error."""
    rows = [row for row in gaps if row.remaining > 0 and row.numerical]
    if not rows:  # it is not known
        return
    share = max(row.numerical / row.remaining for row in rows)
    if share >= _SMALL:
        yield (f"The error of the step is up to {phrases.percent(share)} of the gap: make the step"
               " shorter first.")  # fmt: skip
        return
    most = "" if share < phrases.NOTHING else "at most "
    yield f"The error of the step is {most}{phrases.percent(share)} of the gap."


def _spread(validation: Validation, probes: Sequence[str]) -> Iterator[str]:
    """How far the engines are from each other, beside how far they are from reality."""
    sizes: dict[tuple[str, str], list[float]] = {}
    for row in (row for probe in probes for row in judged_rows(validation, probe)):
        sizes.setdefault((row.stream, row.probe), []).append(row.rmse)
    ratios = []
    for one in validation.spread:
        rmses = sizes.get((one.stream, one.probe))
        if rmses and max(rmses) > 0:
            ratios.append(one.rms * len(rmses) / sum(rmses))
    if not ratios:
        return
    if max(ratios) < _SAME:
        yield "The engines give the same numbers."
        return
    text = f"The engines differ from each other by {phrases.span(ratios)} of the gap"
    if max(ratios) < _CLOSE:
        text += ": they agree better with each other than with reality"
    yield f"{text}."


# what it is made of


def _made_of(validation: Validation) -> Iterator[str]:
    probes = list(dict.fromkeys(row.probe for row in validation.gaps))
    if len(probes) > _MANY:
        yield from _many_parts(validation, probes)
        return
    for probe in probes:
        rows = [row for row in validation.gaps if row.probe == probe]
        label = phrases.label(validation, probe)
        yield from _unsplit(rows, label) if validation.fit is None else _split(rows, label)
        yield from _blame(validation, rows)
        yield from _explained(rows)


def _many_parts(validation: Validation, probes: Sequence[str]) -> Iterator[str]:
    """One sentence for many quantities."""
    shown = []
    for probe in probes:
        shares = [r.shares.model_form for r in validation.gaps if r.probe == probe]
        shown.append(f"{phrases.label(validation, probe)} {phrases.span(shares)}")
    left = "was not the parameters, noise, or the step" if validation.fit else (
        "is neither noise nor the step"
    )  # fmt: skip
    yield f"So much of each gap (mean square) {left}: {'; '.join(shown)}."
    if validation.fit is None:
        yield _UNFITTED
    yield from _explained(validation.gaps)


_UNFITTED = "Nothing was fitted, so the rest may be wrong parameters or a wrong model."


def _split(rows: Sequence[GapRecord], label: str) -> Iterator[str]:
    shares = {key: [getattr(row.shares, key) for row in rows] for key in _PARTS}
    order = sorted(_PARTS, key=lambda key: -max(shares[key]))
    parts = [
        f"{_PARTS[key]} {phrases.span([max(share, 0.0) for share in shares[key]])}"
        for key in order
        if max(shares[key]) > 0
    ]
    yield f"The gap of the {label} before the fit came from (mean square): {', '.join(parts)}."
    if max(max(part) for part in shares.values()) > 1:
        yield "A share above 100 % is an error that another one hid, in part, before the fit."


def _blame(validation: Validation, rows: Sequence[GapRecord]) -> Iterator[str]:
    """What a fit says of the parameters and of the model."""
    if validation.fit is None:
        return
    grown = worse(validation, rows)
    if grown:
        yield (f"The fitted parameters made the gap up to {phrases.percent(grown)} larger (root"
               " mean square): they do not carry over.")  # fmt: skip
    if max(row.shares.model_form for row in rows) > _DOMINANT and not is_covered(rows):
        where = "the recording" if validation.basis == SAME else "the data they were fitted to"
        yield ("What is left may lie in the equations, in the input, or in parameters that suit"
               f" only {where}.")  # fmt: skip


def _unsplit(rows: Sequence[GapRecord], label: str) -> Iterator[str]:
    shares = [row.shares.model_form for row in rows]
    if max(shares) == 0:
        yield f"Noise and the step alone explain the gap of the {label}."
        return
    share = phrases.span(shares)
    yield f"{share} of the gap of the {label} (mean square) is neither noise nor the step."
    yield _UNFITTED


def _explained(rows: Sequence[GapRecord]) -> Iterator[str]:
    """Whether the rest could as well be what is not known of the parameters."""
    covered = [row.covered for row in rows if row.covered is not None]
    if not covered:
        return
    start = f"The uncertainty of the parameters (2 u) covers {phrases.span(covered)} of the samples"
    end = "it may explain the gap" if is_covered(rows) else "it does not explain the whole gap"
    yield f"{start}: {end}."
