"""What a validation rests on and what would teach more, in words."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence

from simcompare.inference.segments import DURATION
from simcompare.reports.validation import answer_gap, answer_values, phrases
from simcompare.results.records.validation import (
    SAME,
    CalibrationRecord,
    GapRecord,
    Validation,
    ValueRecord,
)

#: parameters that correlate by more than this cannot be told apart
_ONE = 0.99
#: a fit that leaves more than so many times the noise lacks something
_FAR = 3.0
#: a parameter with this share of a budget dominates it
_DOMINANT = 0.5
#: more parameters than these are counted and not named
_NAMED = 5


def sentences(validation: Validation) -> Iterator[str]:
    """Where the parameters come from."""
    if validation.fit is None:
        yield from _known(validation)
        return
    yield from _fitted(validation, validation.fit)
    yield from _read_off(validation)
    yield from _alike(validation.fit)


# where the parameters come from


def _names(validation: Validation, kind: str) -> list[str]:
    return [row.name for row in validation.parameters if row.kind == kind and row.name != DURATION]


def _known(validation: Validation) -> Iterator[str]:
    read_off = list(_read_off(validation))
    by_user, known, default = (_names(validation, kind) for kind in ("given", "known", "scenario"))
    yield from read_off
    if by_user:
        yield f"{_were(by_user)} given by the user."
    if known and not read_off and not by_user and not default:
        yield "All parameters were known before the measurement."
    elif known:
        yield f"{_were(known)} known before the measurement."
    if default:
        others = "All parameters are"
        if read_off or by_user or known:
            count = len(default)
            others = "One more parameter is" if count == 1 else f"The other {count} parameters are"
        yield f"{others} the scenario's own, taken as exact."


def _were(names: Sequence[str]) -> str:
    """Parameters as the beginning of a sentence; many are only counted."""
    if len(names) > _NAMED:
        return f"{len(names)} parameters were"
    return f"The {phrases.parameters(names)} {'was' if len(names) == 1 else 'were'}"


def _read_off(validation: Validation) -> Iterator[str]:
    names = _names(validation, "read off")
    if names:
        where = "each segment" if len(validation.cases) > 1 else "the recording"
        yield f"{_were(names)} read off the start of {where}."


def _fitted(validation: Validation, fit: CalibrationRecord) -> Iterator[str]:
    names = [row.name for row in validation.parameters if row.fitted is not None]
    fitted = f"{phrases.parameters(names)} {'were' if len(names) > 1 else 'was'} fitted to"
    yield f"{phrases.first_up(fitted)} {phrases.places(fit.recording, fit.streams)}."
    if validation.basis == SAME:
        yield "The same data were judged: this is a fit, not a validation."
        return
    if fit.chosen_knowing:
        yield ("The fitted segments were chosen with the judged ones in sight, so this is weaker"
               " than a prediction.")  # fmt: skip
        return
    yield "The judged data were not fitted, so this is a prediction."
    yield "It holds for motions like these, not beyond."


def _alike(fit: CalibrationRecord) -> Iterator[str]:
    for a, b, r in _same_pairs(fit):
        both = f"{phrases.parameter(a)} and {phrases.parameter(b)}"
        yield f"The fit cannot separate {both} (correlation {_near_one(r)})."


def _near_one(value: float) -> str:
    # what is below 1 must not be rounded to it
    digits = next((n for n in (3, 4, 5) if abs(value) < 1 - 0.5 / 10**n), 6)
    return f"{value:+.{digits}f}".replace("-", "−")


def _same_pairs(fit: CalibrationRecord) -> list[tuple[str, str, float]]:
    """Fitted parameters that correlate so closely that only a combination of them is known."""
    return [
        (fit.names[i], fit.names[j], fit.correlation[i][j])
        for i, j in itertools.combinations(range(len(fit.names)), 2)
        if abs(fit.correlation[i][j]) > _ONE
    ]


# what to do next


def advice(validation: Validation) -> Iterator[str]:
    """What to do first to learn more."""
    step = _advice(validation)
    # what begins elsewhere says nothing of the parameters or the model
    if step and not validation.apart:
        yield f"Next: {step}"


def _advice(validation: Validation) -> str:
    bound = [] if validation.fit is None else validation.fit.at_bound
    if bound:
        return f"ask why the fit pushed the {phrases.parameters(bound)} to the limit."
    if validation.basis == SAME:
        return "judge segments that were not fitted."
    part = _largest_part(validation.gaps)
    if part == "numerical":
        return "make the step shorter; most of what is left is its error."
    if part == "noise":
        return "use a quieter sensor or a longer record."
    if part is None:
        return ""
    return _about_parameters(validation) or (
        "improve the model; a shorter step or a quieter sensor would not help. What is left over"
        f" time shows where to look.{_also(validation)}"
    )


def _also(validation: Validation) -> str:
    """The parameter that most of the uncertainty of the values comes from."""
    name = _leading(validation.values)
    judged = answer_values.judged(validation.values)
    if not name or answer_values.dominant(judged)[0] != "u_input":
        return ""
    return f" Measure the {phrases.parameter(name)} better, too."


def _leading(values: Sequence[ValueRecord]) -> str:
    """The parameter that makes up most of the budgets; empty where none does."""
    name, share = answer_values.leading_parameter(answer_values.judged(values))
    return name if share >= _DOMINANT else ""


def _about_parameters(validation: Validation) -> str:
    """What to do about parameters; empty where they are not what is lacking."""
    name = _leading(validation.values)
    if answer_gap.is_covered(validation.gaps):
        what = "the parameters" if not name else f"the {phrases.parameter(name)}"
        return f"measure {what} better; its uncertainty hides what else is wrong.".replace(
            "its", "their" if not name else "its"
        )
    if name in _names(validation, "read off"):
        return f"measure the {phrases.parameter(name)} better, apart from this recording."
    if validation.fit is None:
        return "fit the parameters to one part of the recordings and judge another (calibrate:)."
    pairs = _same_pairs(validation.fit)
    residual = _residual(validation, validation.fit)
    worse = answer_gap.worse(validation, validation.gaps) > 0
    if not pairs or (residual <= _FAR and not worse):
        return ""
    first, second, _ = pairs[0]
    return (
        f"fit a recording that separates {phrases.parameter(first)} and"
        f" {phrases.parameter(second)}, such as one with large and small motions."
    )


def _residual(validation: Validation, fit: CalibrationRecord) -> float:
    """What the fit leaves on its own data over the noise of a sample; 0 where unknown."""
    probe = next((name for name, one in validation.compare.items() if one.judged), None)
    if probe is None:
        return 0.0
    u = [phrases.noise_of(validation, case.stream, probe) for case in validation.cases]
    known = [one for one in u if one]
    return fit.rms / (math.fsum(known) / len(known)) if known else 0.0


def _largest_part(rows: Sequence[GapRecord]) -> str | None:
    """The largest part of what the best parameters leave over, over all engines and segments."""
    sums = {
        key: math.fsum(getattr(row, key) ** 2 for row in rows)
        for key in ("model_form", "numerical", "noise")
    }
    largest = max(sums, key=lambda key: sums[key])
    return largest if sums[largest] > 0 else None
