"""What a validation found, in plain words: how large the gap is, how sure, what it is made of."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from simcompare.validation import phrases

#: what the parameters rest on
KNOWN, HELD_OUT, SAME = "known before", "held out", "same data"
Record = Mapping[str, Any]
_PARTS = {
    "removed": "parameters",
    "model_form": "model form",
    "numerical": "numerical error",
    "noise": "noise of the measurement",
}
#: parts of an uncertainty and what they come from
_SOURCES = {"u_num": "the steps", "u_input": "the parameters", "u_data": "the measurement"}
#: a part of this share is most of the whole; an error below the second is small beside another
_MOST, _SMALL = 0.5, 0.2
#: more quantities than these are told in one sentence
_MANY = 2
#: samples that a band with k = 2 holds where nothing else is wrong
_ALL = 0.95


def verdict(row: Record, basis: str) -> str:
    """One value in words; "within the noise level" is not "validated"."""
    if row["e_n"] is None:
        return "cannot be judged: a part of the uncertainty is unknown"
    if not row["within_noise"]:
        return "differs by more than the uncertainties explain"
    if basis == SAME:
        return "within the noise level, but fitted to the same data"
    return "within the noise level"


def sentences(found: Record) -> list[str]:
    """The answer of a validation.

    Args:
        found: the record of the validation.
    """
    if not found["waveforms"] and not found.get("timings"):
        return ["No engine ran, so nothing can be said."]
    return [
        *_how_large(found),
        *_made_of(found),
        *_when(found),
        *_how_sure(found),
        _basis(found),
        *_log(found),
        *_next(found),
    ]


# how large


def _how_large(found: Record) -> Iterator[str]:
    rows = [row for row in found["waveforms"] if row["judged"]]
    probes = list(dict.fromkeys(row["probe"] for row in rows))
    by_probe = {probe: [row for row in rows if row["probe"] == probe] for probe in probes}
    if len(probes) > _MANY:
        yield " ".join([_sizes(found, by_probe), *_engines(found["gaps"])])
        return
    for probe, own in by_probe.items():
        gaps = [row for row in found["gaps"] if row["probe"] == probe]
        yield " ".join([_size(found, own), *_engines(gaps)])


def _sizes(found: Record, by_probe: Mapping[str, Sequence[Record]]) -> str:
    """One sentence for many quantities."""
    shown = [
        f"{phrases.label(found, probe)} {_off(_main(found, own))}"
        for probe, own in by_probe.items()
    ]
    text = "; ".join(shown).replace(" of the measured range", "")
    return (
        f"With {_whose(found)}, the simulated signals are off by these shares of the measured"
        f" range (root mean square): {text}."
    )


def _whose(found: Record) -> str:
    return "the parameters known before" if found["fit"] is None else "fitted parameters"


def _main(found: Record, rows: Sequence[Record]) -> list[Record]:
    """Rows with the parameters that are judged, on aligned clocks where there are any."""
    wanted = KNOWN if found["fit"] is None else "fitted"
    last = [row for row in rows if row["parameters"] == wanted]
    aligned = any(row["aligned"] for row in last)
    return [row for row in last if row["aligned"] == aligned]


def _size(found: Record, rows: Sequence[Record]) -> str:
    main = _main(found, rows)
    worst = max(main, key=lambda row: row["rmse"])
    told = (
        f"With {_whose(found)}, the simulated {phrases.label(found, worst['probe'])} is"
        f" {_off(main)} off (root mean square)"
    )
    if found["fit"] is not None:
        same = main[0]["aligned"]
        before = [r for r in rows if r["parameters"] == KNOWN and r["aligned"] == same]
        told += f"; before the fit it was {_off(before)}" if before else ""
    if main[0]["aligned"]:
        wanted = main[0]["parameters"]
        raw = [r for r in rows if r["parameters"] == wanted and not r["aligned"]]
        told += f"; with the clocks as recorded it would be {_off(raw)}" if raw else ""
    size, most = (phrases.sized(worst[key], worst["unit"]) for key in ("rmse", "max_abs"))
    return f"{told}. The largest: {phrases.who(worst)}, {size}, and {most} at one instant."


def _off(rows: Sequence[Record]) -> str:
    shares = [row["nrmse"] for row in rows]
    if None in shares:  # the measurement does not vary, so there is no range
        sizes = (min(row["rmse"] for row in rows), max(row["rmse"] for row in rows))
        return " to ".join(dict.fromkeys(phrases.sized(size, rows[0]["unit"]) for size in sizes))
    return f"{phrases.span(shares)} of the measured range"


def _engines(gaps: Sequence[Record]) -> Iterator[str]:
    """Whether the gap is the engines' own."""
    rows = [row for row in gaps if row["remaining"] > 0]
    share = max((row["numerical"] / row["remaining"] for row in rows), default=0.0)
    if share == 0:  # it is not known
        return
    several = len({row["source"] for row in rows}) > 1
    whose = "The numerical error of each engine" if several else "Its numerical error"
    size = (
        phrases.percent(share) if share < phrases.NOTHING else f"at most {phrases.percent(share)}"
    )
    if share >= _SMALL:
        yield f"{whose} is up to {phrases.percent(share)} of that: a shorter step comes first."
    elif several:
        yield (
            f"{whose} is {size} of that: they agree far better with each other than with reality."
        )
    else:
        yield f"{whose} is {size} of that."


# what it is made of


def _made_of(found: Record) -> Iterator[str]:
    probes = list(dict.fromkeys(row["probe"] for row in found["gaps"]))
    if len(probes) > _MANY:
        yield _many_parts(found, probes)
        return
    for probe in probes:
        rows = [row for row in found["gaps"] if row["probe"] == probe]
        label = phrases.label(found, probe)
        told = _split(rows, label) if found["fit"] is not None else _unsplit(rows, label)
        yield told + _explained(rows)


def _many_parts(found: Record, probes: Sequence[str]) -> str:
    """One sentence for many quantities."""
    shown = []
    for probe in probes:
        shares = [r["shares"]["model_form"] for r in found["gaps"] if r["probe"] == probe]
        shown.append(f"{phrases.label(found, probe)} {phrases.span(shares)}")
    why = (
        " Nothing was fitted, so it may come from the parameters as well as from the form of the"
        " model."
        if found["fit"] is None
        else " This is called model form; what the fit took away is in the table."
    )
    return (
        "Of the mean square of each gap this is neither noise nor numerical error"
        f"{'' if found['fit'] is None else ' nor the parameters'}: {'; '.join(shown)}.{why}"
        + _explained(found["gaps"])
    )


def _split(rows: Sequence[Record], label: str) -> str:
    shares = {key: [row["shares"][key] for row in rows] for key in _PARTS}
    order = sorted(_PARTS, key=lambda key: -max(shares[key]))
    parts = [
        f"{_PARTS[key]} {phrases.span([max(share, 0.0) for share in shares[key]])}"
        for key in order
        if max(shares[key]) > 0
    ]
    told = (
        f"What the gap of the {label} is made of, in shares of its mean square: {'; '.join(parts)}."
    )
    worse = -min(shares["removed"])
    if worse > 0.005:
        told += (
            f" The fitted parameters made the gap larger, by up to {phrases.percent(worse)}, so"
            " they do not carry over, and the parts sum to more than 100 %."
        )
    if max(shares["model_form"]) > _MOST and not _is_covered(rows):
        told += (
            " Model form is what no choice of these parameters takes away: something is missing in"
            " the equations, or in what drives them."
        )
    return told


def _unsplit(rows: Sequence[Record], label: str) -> str:
    shares = [row["shares"]["model_form"] for row in rows]
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


def _explained(rows: Sequence[Record]) -> str:
    """Whether what is called model form could as well be what is not known of the parameters."""
    covered = [row["covered"] for row in rows if row.get("covered") is not None]
    if not covered:
        return ""
    start = (
        f" The uncertainty of the parameters (k = 2) covers {phrases.span(covered)} of the samples"
    )
    if _is_covered(rows):
        return f"{start}: it may explain the gap without any fault of the model."
    return f"{start}; the others differ by more than that."


def _is_covered(rows: Sequence[Record]) -> bool:
    """Whether what is not known of the parameters may explain all that is left."""
    covered = [row["covered"] for row in rows if row.get("covered") is not None]
    return bool(covered) and min(covered) >= _ALL


# events and single values


def _when(found: Record) -> Iterator[str]:
    rows = [row for row in found.get("timings") or () if row["matched"]]
    if not rows:
        return
    worst = max(rows, key=lambda row: row["rmse_s"])
    lost = sum(row["missed"] + row["extra"] for row in rows)
    series = phrases.spaced(worst["series"])
    told = (
        f"{series[:1].upper()}{series[1:]}: simulated and measured are at most"
        f" {phrases.sized(worst['rmse_s'], 's')} apart (root mean square,"
        f" {phrases.who(worst)})"
    )
    told += f"; {lost} {'has' if lost == 1 else 'have'} no partner" if lost else ""
    judged = [i["e_n"] for row in rows for i in row["intervals"] if i["e_n"] is not None]
    if judged:
        within = sum(abs(e_n) <= 1 for e_n in judged)
        told += f". {_agreeing(within, len(judged), 'interval')}"
    yield f"{told}."


def _how_sure(found: Record) -> Iterator[str]:
    rows = [row for row in found["values"] if row["e_n"] is not None]
    if not found["values"]:
        if found["waveforms"]:
            yield "No single value of the scenario can be read off this recording."
        return
    if not rows:
        yield "No single value can be judged, because a part of its uncertainty is not known."
        return
    within = sum(row["within_noise"] for row in rows)
    told = _agreeing(within, len(rows), "single value")
    if within < len(rows):
        worst = max(rows, key=lambda row: abs(row["e_n"]))
        # one just outside must not look like one just inside
        digits = 2 if abs(worst["e_n"]) < 2 else 1
        e_n = f"{worst['e_n']:+.{digits}f}".replace("-", "−")
        measure = phrases.spaced(worst["measure"])
        told += f"; the furthest is the {measure} of {phrases.who(worst)}, E_n = {e_n}"
    elif found["basis"] != SAME:
        told += "; that shows no fault, and proves no model"
    source, share = _dominant(rows)
    most = "Nearly all" if share > 0.99 else phrases.percent(share)
    yield f"{told}. {most} of the squared uncertainty comes from {_SOURCES[source]}."


def _agreeing(within: int, count: int, noun: str) -> str:
    level = "within the noise level (|E_n| ≤ 1, k = 2)"
    if count == 1:
        return f"The one {noun} {'agrees' if within else 'does not agree'} {level}"
    if within == 0:
        return f"None of {count} {noun}s agrees {level}"
    return f"Of {count} {noun}s {within} agree{'s' if within == 1 else ''} {level}"


def _dominant(rows: Sequence[Record]) -> tuple[str, float]:
    """The part that makes up most of the squared uncertainty, and its mean share."""
    shares = {
        key: sum((row[key] / row["u_val"]) ** 2 for row in rows) / len(rows) for key in _SOURCES
    }
    return max(shares.items(), key=lambda item: item[1])


# what it rests on


def _basis(found: Record) -> str:
    if found["basis"] == KNOWN:
        return "All parameters were known before the measurement was looked at."
    names = [
        phrases.parameter(row["name"]) for row in found["parameters"] if row["fitted"] is not None
    ]
    fitted = f"{phrases.listed(names)} {'were' if len(names) > 1 else 'was'} fitted to"
    fitted = fitted[:1].upper() + fitted[1:]
    streams = phrases.places(found["fit"]["recording"], found["fit"]["streams"])
    judged = phrases.places(found["recording"], [case["stream"] for case in found["cases"]])
    if found["basis"] == SAME:
        return (
            f"{fitted} {streams}, which is also what was judged: this is a fit, not a validation."
        )
    return (
        f"{fitted} {streams} and held against {judged}, which the fit had not seen: what is said"
        " here is a prediction. It holds for motions like these, not beyond."
    )


def _log(found: Record) -> Iterator[str]:
    """Defects of the log that a reader of the answer must know of."""
    repairs = found["provenance"]["repairs"]
    told = []
    for severity, words in (("repair", "repaired"), ("warning", "left and marked")):
        rules = dict.fromkeys(
            phrases.spaced(r["rule"]) for r in repairs if r["severity"] == severity
        )
        if rules:
            told.append(f"{words}: {', '.join(rules)}")
    if told:
        yield f"The log had defects ({'; '.join(told)}); the section on the recording has the rows."


def _next(found: Record) -> Iterator[str]:
    """What to do first to learn more."""
    advice = _advice(found)
    if advice:
        yield f"Next: {advice}"


def _advice(found: Record) -> str:
    bound = [] if found["fit"] is None else found["fit"]["at_bound"]
    if bound:
        names = phrases.listed([phrases.parameter(name) for name in bound])
        return f"ask why the fit pushed the {names} to its bound; the model may lack something."
    if found["basis"] == SAME:
        return "judge stretches that were not fitted."
    part = _largest_left(found["gaps"])
    if part == "numerical":
        return "a shorter step, since numerical error is most of what is left."
    if part == "noise":
        return "a quieter sensor or a longer record; this one holds no more about the model."
    if part is None:
        return ""
    if _is_covered(found["gaps"]):
        return (
            "know the parameters better; until then their uncertainty hides what else is wrong"
            " with the model."
        )
    if found["fit"] is None:
        return (
            "fit the parameters to one part of the recordings and judge another (calibrate:), to"
            " tell wrong parameters from a wrong model."
        )
    return (
        "a better model; neither a shorter step nor a quieter sensor would close this gap. What is"
        " left over time shows where to look."
    )


def _largest_left(rows: Sequence[Record]) -> str | None:
    """The largest part of what the best parameters leave over, over all engines and stretches."""
    sums = {
        key: math.fsum(row[key] ** 2 for row in rows)
        for key in ("model_form", "numerical", "noise")
    }
    largest = max(sums, key=lambda key: sums[key])
    return largest if sums[largest] > 0 else None
