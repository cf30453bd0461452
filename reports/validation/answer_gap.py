"""How large the gap between simulations and a recording is and what it is made of, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

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
    "removed": "parameters",
    "model_form": "model form",
    "numerical": "numerical error",
    "noise": "noise of the measurement",
}
#: a part of this share is most of the whole; an error below the second is small beside another
_DOMINANT, _SMALL = 0.5, 0.2
#: engines this close together, beside how far they are from reality, agree far better
_CLOSE = 0.1
#: and these are the same but for rounding
_SAME = 1e-9
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


# how large


def _how_large(validation: Validation) -> Iterator[str]:
    rows = [row for row in validation.waveforms if row.judged]
    probes = list(dict.fromkeys(row.probe for row in rows))
    by_probe = {probe: [row for row in rows if row.probe == probe] for probe in probes}
    if len(probes) > _MANY:
        yield " ".join(
            [_sizes(validation, by_probe), *_numerical(validation.gaps), *_spread(validation, rows)]
        )
        return
    for probe, of_probe in by_probe.items():
        gaps = [row for row in validation.gaps if row.probe == probe]
        yield " ".join(
            [_size(validation, of_probe), *_numerical(gaps), *_spread(validation, of_probe)]
        )


def _sizes(validation: Validation, by_probe: Mapping[str, Sequence[WaveformRecord]]) -> str:
    """One sentence for many quantities."""
    mains = {probe: _main(validation, of_probe) for probe, of_probe in by_probe.items()}
    shown = "; ".join(
        f"{phrases.label(validation, probe)} {_off(validation, main)}"
        for probe, main in mains.items()
    ).replace(" of the measured range", "")
    still = [any(phrases.is_constant(validation, row) for row in main) for main in mains.values()]
    if all(still):
        how = "root mean square; what was measured varies no more than its noise"
    else:
        how = "root mean square, in shares of the measured range"
        how += " where it varies" if any(still) else ""
    return f"With {_whose(validation)}, the simulated signals are off by ({how}): {shown}."


def _whose(validation: Validation) -> str:
    return "the parameters known before" if validation.fit is None else "fitted parameters"


def _main(validation: Validation, rows: Sequence[WaveformRecord]) -> list[WaveformRecord]:
    """Rows with the parameters that are judged, on aligned clocks where there are any."""
    parameters = KNOWN if validation.fit is None else FITTED
    last = [row for row in rows if row.parameters == parameters]
    aligned = any(row.aligned for row in last)
    return [row for row in last if row.aligned == aligned]


def _size(validation: Validation, rows: Sequence[WaveformRecord]) -> str:
    main = _main(validation, rows)
    worst = max(main, key=lambda row: row.rmse)
    text = (
        f"With {_whose(validation)}, the simulated {phrases.label(validation, worst.probe)} is"
        f" {_off(validation, main)} off (root mean square)"
    )
    if validation.fit is not None:
        same = main[0].aligned
        before = [r for r in rows if r.parameters == KNOWN and r.aligned == same]
        text += f"; before the fit it was {_off(validation, before)}" if before else ""
    if main[0].aligned:
        parameters = main[0].parameters
        raw = [r for r in rows if r.parameters == parameters and not r.aligned]
        text += f"; with the clocks as recorded it would be {_off(validation, raw)}" if raw else ""
    size, most = _sizes_of(worst)
    who = _largest(validation, main, worst)
    return f"{text}. The largest: {who}, {size}, and {most} at one instant."


def _largest(validation: Validation, rows: Sequence[WaveformRecord], worst: WaveformRecord) -> str:
    """Who has the largest gap: all engines where theirs are the same in what is told."""
    there = [row for row in rows if row.stream == worst.stream]
    alike = [row.source for row in there if _sizes_of(row) == _sizes_of(worst)]
    return phrases.whose(alike, phrases.engines_of(there)) + phrases.where(validation, worst)


def _sizes_of(row: WaveformRecord) -> tuple[str, str]:
    """Root mean square and greatest deviation as they are told."""
    return phrases.sized(row.rmse, row.unit), phrases.sized(row.max_abs, row.unit)


def _off(validation: Validation, rows: Sequence[WaveformRecord]) -> str:
    """A share of the measured range; a size where that range is nothing but noise."""
    if any(phrases.is_constant(validation, row) for row in rows):
        return phrases.size_span([row.rmse for row in rows], rows[0].unit)
    return f"{phrases.span([row.nrmse or 0.0 for row in rows])} of the measured range"


def _numerical(gaps: Sequence[GapRecord]) -> Iterator[str]:
    """How much of the gap is the engines' own error."""
    rows = [row for row in gaps if row.remaining > 0 and row.numerical]
    if not rows:  # it is not known
        return
    share = max(row.numerical / row.remaining for row in rows)
    several = len(phrases.engines_of(rows)) > 1
    whose = "The numerical error of each engine" if several else "Its numerical error"
    if share >= _SMALL:
        yield f"{whose} is up to {phrases.percent(share)} of that: a shorter step comes first."
        return
    most = "" if share < phrases.NOTHING else "at most "
    yield f"{whose} is {most}{phrases.percent(share)} of that."


def _spread(validation: Validation, waveforms: Sequence[WaveformRecord]) -> Iterator[str]:
    """How far the engines are from each other, beside how far they are from reality."""
    sizes: dict[tuple[str, str], list[float]] = {}
    for row in _main(validation, waveforms):
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
    text = f"The engines' spread about their own mean is {phrases.span(ratios)} of that"
    if max(ratios) < _CLOSE:
        text += ": they agree far better with each other than with reality"
    yield f"{text}."


# what it is made of


def _made_of(validation: Validation) -> Iterator[str]:
    probes = list(dict.fromkeys(row.probe for row in validation.gaps))
    if len(probes) > _MANY:
        yield _many_parts(validation, probes)
        return
    for probe in probes:
        rows = [row for row in validation.gaps if row.probe == probe]
        label = phrases.label(validation, probe)
        text = (
            _split(validation, rows, label) if validation.fit is not None else _unsplit(rows, label)
        )
        yield text + _explained(rows)


def _many_parts(validation: Validation, probes: Sequence[str]) -> str:
    """One sentence for many quantities."""
    shown = []
    for probe in probes:
        shares = [r.shares.model_form for r in validation.gaps if r.probe == probe]
        shown.append(f"{phrases.label(validation, probe)} {phrases.span(shares)}")
    if validation.fit is None:
        return (
            "Of the mean square of each gap this is neither noise nor numerical error:"
            f" {'; '.join(shown)}. Nothing was fitted, so it may come from the parameters or from"
            " the model." + _explained(validation.gaps)
        )
    return (
        "Of the mean square of each gap before the fit this is neither taken away by the fit nor"
        f" noise nor numerical error (model form): {'; '.join(shown)}."
        + _explained(validation.gaps)
    )


def _split(validation: Validation, rows: Sequence[GapRecord], label: str) -> str:
    shares = {key: [getattr(row.shares, key) for row in rows] for key in _PARTS}
    order = sorted(_PARTS, key=lambda key: -max(shares[key]))
    parts = [
        f"{_PARTS[key]} {phrases.span([max(share, 0.0) for share in shares[key]])}"
        for key in order
        if max(shares[key]) > 0
    ]
    text = (
        f"Before the fit, the gap of the {label} was made of (shares of its mean square):"
        f" {'; '.join(parts)}."
    )
    worse = -min(shares["removed"])
    if worse > 0.005:
        text += (
            f" The fitted parameters made the gap larger, by up to {phrases.percent(worse)}, so"
            " they do not carry over, and the parts sum to more than 100 %."
        )
    if max(shares["model_form"]) > _DOMINANT and not is_covered(rows):
        fitted = "there" if validation.basis == SAME else "elsewhere"
        text += (
            f" Model form is what parameters fitted {fitted} leave: it may lie in the equations, in"
            " what drives them, or in parameters that suit only what they were fitted to."
        )
    return text


def _unsplit(rows: Sequence[GapRecord], label: str) -> str:
    shares = [row.shares.model_form for row in rows]
    if max(shares) == 0:
        return (
            f"Noise and numerical error are as large as the gap of the {label}: more than that"
            " cannot be seen here."
        )
    return (
        f"Of the gap of the {label}, {phrases.span(shares)} of the mean square is neither noise nor"
        " numerical error. Nothing was fitted, so it may come from the parameters as well as from"
        " the form of the model."
    )


def _explained(rows: Sequence[GapRecord]) -> str:
    """Whether what is called model form could as well be what is not known of the parameters."""
    covered = [row.covered for row in rows if row.covered is not None]
    if not covered:
        return ""
    start = (
        f" The uncertainty of the parameters (k = 2) covers {phrases.span(covered)} of the samples"
    )
    if is_covered(rows):
        return f"{start}: it may explain the gap without any fault of the model."
    return f"{start}; the others differ by more than that."
