"""What a validation found, in plain words: how large the gap is, how sure, what it is made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from simcompare import units

#: what the parameters rest on
KNOWN, HELD_OUT, SAME = "known before", "held out", "same data"
_PARTS = {
    "removed": "parameters",
    "model_form": "the form of the model",
    "numerical": "the engines' steps",
    "noise": "noise of the measurement",
}


def verdict(row: Mapping[str, Any], basis: str) -> str:
    """One value in words; "within the noise level" is not "validated"."""
    if row["e_n"] is None:
        return "cannot be judged: a part of the uncertainty is unknown"
    if not row["within_noise"]:
        return "differs by more than the uncertainties explain"
    if basis == SAME:
        return "within the noise level, but fitted to the same data"
    return "within the noise level"


def sentences(found: Mapping[str, Any]) -> list[str]:
    """The answer of a validation.

    Args:
        found: the record of the validation.
    """
    if not found["waveforms"]:
        return ["No engine ran, so nothing can be said."]
    return [
        _how_large(found),
        *_made_of(found),
        *_how_sure(found),
        _basis(found),
    ]


def _how_large(found: Mapping[str, Any]) -> str:
    last = "fitted" if found["fit"] is not None else KNOWN
    rows = [r for r in found["waveforms"] if r["judged"] and r["parameters"] == last]
    rows = [r for r in rows if r["aligned"]] or rows
    worst = max(rows, key=lambda row: row["nrmse"] or 0.0)
    best = min(rows, key=lambda row: row["nrmse"] or 0.0)
    label = _label(found, worst["probe"])
    shares = dict.fromkeys((_share(best), _share(worst)))
    told = (
        f"With the {'fitted' if last == 'fitted' else 'known'} parameters the simulated {label}"
        f" is {' to '.join(shares)} of the measured range off (root mean square);"
        f" the largest is {_number(worst['rmse'], worst['unit'])}"
        f" ({worst['source']}, {_stretch(worst)}"
        f"at most {_number(worst['max_abs'], worst['unit'])})."
    )
    spread = _spread(rows)
    return told + (f" {spread}" if spread else "")


def _label(found: Mapping[str, Any], probe: str) -> str:
    text = str(found["compare"][probe]["label"])
    return text[:1].lower() + text[1:]


def _stretch(row: Mapping[str, Any]) -> str:
    return "" if row["stream"] == "log" else f"stretch {row['stream']}, "


def _spread(rows: Sequence[Mapping[str, Any]]) -> str:
    """How far engines are from each other, beside how far they are from the measurement."""
    by_case: dict[tuple[str, str], list[float]] = {}
    for row in rows:
        by_case.setdefault((row["stream"], row["probe"]), []).append(row["rmse"])
    ratios = [(max(v) - min(v)) / max(v) for v in by_case.values() if len(v) > 1 and max(v) > 0]
    if not ratios:
        return ""
    return (
        f"The engines differ from each other by at most {_percent(max(ratios))} of that: they agree"
        " far better with each other than with reality."
        if max(ratios) < 0.2
        else f"The engines differ from each other by up to {_percent(max(ratios))} of that."
    )


def _made_of(found: Mapping[str, Any]) -> list[str]:
    told = []
    for probe in dict.fromkeys(row["probe"] for row in found["gaps"]):
        rows = [row for row in found["gaps"] if row["probe"] == probe]
        shares = {key: [row["shares"][key] for row in rows] for key in _PARTS}
        order = sorted(_PARTS, key=lambda key: -max(shares[key]))
        parts = [f"{_PARTS[key]} {_range(shares[key])}" for key in order if any(shares[key])]
        label = _label(found, probe)
        before = "" if found["fit"] is not None else (
            " Nothing was fitted: what other parameters would change is part of the model's form."
        )  # fmt: skip
        told.append(
            f"What the gap of the {label} is made of, in shares of its mean square:"
            f" {'; '.join(parts)}.{before}{_explained(rows)}"
        )
    return told


def _explained(rows: Sequence[Mapping[str, Any]]) -> str:
    """Whether what is called model form could as well be what is not known of the parameters."""
    covered = [row["covered"] for row in rows if row["covered"] is not None]
    if not covered:
        return ""
    if min(covered) >= 0.95:
        return (
            " But what is not known of the parameters (k = 2) covers"
            f" {_range(covered)} of the samples: the model's form need not be at fault."
        )
    return (
        f" What is not known of the parameters (k = 2) covers {_range(covered)} of the samples;"
        " the rest is more than that."
    )


def _how_sure(found: Mapping[str, Any]) -> list[str]:
    rows = [row for row in found["values"] if row["e_n"] is not None]
    if not rows:
        return ["No single value could be judged, because its uncertainty is not known."]
    within = sum(row["within_noise"] for row in rows)
    worst = max(rows, key=lambda row: abs(row["e_n"]))
    told = f"Of {len(rows)} single values {within} agree within the noise level (|E_n| ≤ 1, k = 2)"
    if within < len(rows):
        told += (
            f"; the furthest is {worst['measure'].replace('_', ' ')} of {worst['source']}"
            f" with E_n = {worst['e_n']:+.1f}"
        )
    return [f"{told}."]


def _basis(found: Mapping[str, Any]) -> str:
    if found["basis"] == KNOWN:
        return "All parameters were known before the measurement was looked at."
    fitted = ", ".join(row["name"] for row in found["parameters"] if row["fitted"] is not None)
    streams = _places(found["fit"]["recording"], found["fit"]["streams"])
    judged = _places(found["recording"], [case["stream"] for case in found["cases"]])
    if found["basis"] == SAME:
        return (
            f"{fitted} were fitted to {streams}, which is also what was judged: this is a fit, not"
            " a validation. Judge stretches that were not fitted."
        )
    return (
        f"{fitted} were fitted to {streams} and held against {judged}, which they had not seen:"
        " what is said here is a prediction. It holds for motions like these, not beyond."
    )


def _places(recording: str, streams: Sequence[str]) -> str:
    """Streams of a recording; one that has only one is called by its own name."""
    if list(streams) == ["log"]:
        return recording
    return f"{', '.join(streams)} of {recording}"


def _share(row: Mapping[str, Any]) -> str:
    return "an unknown share" if row["nrmse"] is None else _percent(row["nrmse"])


def _range(shares: Sequence[float]) -> str:
    low, high = _percent(min(shares)), _percent(max(shares))
    return low if low == high else f"{low} to {high}"


def _percent(value: float) -> str:
    if 0 < value < 5e-4:
        return "below 0.05 %"
    if value < 0:
        return f"{100 * value:.0f} % (worse than before)"
    return f"{100 * value:.2g} %" if value < 0.1 else f"{100 * value:.0f} %"


def _number(value: float, unit: str) -> str:
    shown = units.symbol(unit)
    return f"{value:.3g}" + ("" if shown == "1" else f" {shown}")
