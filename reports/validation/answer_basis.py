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
#: a share of the gap by which a fit made it larger that is worth a word
_WORSE = 0.005
#: a parameter with this share of a budget dominates it
_DOMINANT = 0.5
#: more parameters than these are counted and not named
_NAMED = 5


def sentences(validation: Validation) -> Iterator[str]:
    """Where the parameters come from."""
    if validation.fit is None:
        yield _known(validation)
        return
    yield " ".join(
        [_fitted(validation, validation.fit), *_read_off(validation), *_alike(validation.fit)]
    )


# where the parameters come from


def _names(validation: Validation, kind: str) -> list[str]:
    return [row.name for row in validation.parameters if row.kind == kind and row.name != DURATION]


def _known(validation: Validation) -> str:
    parts = list(_read_off(validation))
    by_user, known, default = (_names(validation, kind) for kind in ("given", "known", "scenario"))
    if by_user:
        parts.append(f"{_were(by_user)} given by the user.")
    if known and not parts and not default:
        return "All parameters were known before the measurement was looked at."
    if known:
        parts.append(f"{_were(known)} known before the measurement was looked at.")
    if default:
        others = "All parameters are"
        if parts:
            count = len(default)
            others = "One more parameter is" if count == 1 else f"The other {count} parameters are"
        parts.append(f"{others} the scenario's own, with no uncertainty.")
    return " ".join(parts)


def _were(names: Sequence[str]) -> str:
    """Parameters as the beginning of a sentence; many are only counted."""
    if len(names) > _NAMED:
        return f"{len(names)} parameters were"
    return f"The {phrases.parameters(names)} {'was' if len(names) == 1 else 'were'}"


def _read_off(validation: Validation) -> Iterator[str]:
    names = _names(validation, "read off")
    if names:
        of_each = "each segment of it" if len(validation.cases) > 1 else "it"
        yield (f"{_were(names)} read off the recording that is judged, at the start of {of_each}.")


def _fitted(validation: Validation, fit: CalibrationRecord) -> str:
    names = [row.name for row in validation.parameters if row.fitted is not None]
    fitted = f"{phrases.parameters(names)} {'were' if len(names) > 1 else 'was'} fitted to"
    fitted = phrases.first_up(fitted)
    streams = phrases.places(fit.recording, fit.streams)
    judged = phrases.places(validation.recording, [case.stream for case in validation.cases])
    if validation.basis == SAME:
        return (
            f"{fitted} {streams}, which is also what was judged: this is a fit, not a validation."
        )
    start = f"{fitted} {streams} and held against {judged}, which the fit had not seen"
    if fit.chosen_knowing:
        return (
            f"{start}; but the fitted segments were chosen knowing the judged ones, so this is"
            " weaker than a prediction. It holds for motions like these, not beyond."
        )
    return (
        f"{start}: what is said here is a prediction. It holds for motions like these, not beyond."
    )


def _alike(fit: CalibrationRecord) -> Iterator[str]:
    pairs = _same_pairs(fit)
    if pairs:
        named = "; ".join(
            f"{phrases.parameter(a)} and {phrases.parameter(b)} ({_near_one(r)})"
            for a, b, r in pairs
        )  # fmt: skip
        yield f"The fit cannot tell apart (correlation): {named}."


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
    if step:
        yield f"Next: {step}"


def _advice(validation: Validation) -> str:
    bound = [] if validation.fit is None else validation.fit.at_bound
    if bound:
        return (
            f"ask why the fit pushed the {phrases.parameters(bound)} to its bound; the model may"
            " lack something."
        )
    if validation.basis == SAME:
        return "judge segments that were not fitted."
    part = _largest_part(validation.gaps)
    if part == "numerical":
        return "a shorter step, since numerical error is most of what is left."
    if part == "noise":
        return "a quieter sensor or a longer record; this one holds no more about the model."
    if part is None:
        return ""
    return _about_parameters(validation) or (
        "a better model; neither a shorter step nor a quieter sensor would close this gap. What is"
        f" left over time shows where to look.{_also(validation)}"
    )


def _also(validation: Validation) -> str:
    """The parameter that most of the uncertainty of the values comes from."""
    name = _leading(validation.values)
    judged = answer_values.judged(validation.values)
    if not name or answer_values.dominant(judged)[0] != "u_input":
        return ""
    return (
        f" Most of the values' uncertainty comes from the {phrases.parameter(name)}: measure it"
        " better."
    )


def _leading(values: Sequence[ValueRecord]) -> str:
    """The parameter that makes up most of the budgets; empty where none does."""
    name, share = answer_values.leading_parameter(answer_values.judged(values))
    return name if share >= _DOMINANT else ""


def _about_parameters(validation: Validation) -> str:
    """What to do about parameters; empty where they are not what is lacking."""
    name = _leading(validation.values)
    if answer_gap.is_covered(validation.gaps):
        what = "the parameters" if not name else f"the {phrases.parameter(name)}"
        return (
            f"measure {what} better; until then the uncertainty of the parameters hides what else"
            " is wrong with the model."
        )
    if name in _names(validation, "read off"):
        return (
            f"measure the {phrases.parameter(name)} better, apart from this recording; it was read"
            " off, and most of the parameters' uncertainty is its own."
        )
    if validation.fit is None:
        return (
            "fit the parameters to one part of the recordings and judge another (calibrate:), to"
            " tell wrong parameters from a wrong model."
        )
    pairs = _same_pairs(validation.fit)
    residual = _residual(validation, validation.fit)
    worse = any(row.shares.removed < -_WORSE for row in validation.gaps)
    if not pairs or (residual <= _FAR and not worse):
        return ""
    first, second, _ = pairs[0]
    why = f" The fit leaves {residual:.2g} times the noise of a sample." if residual > _FAR else ""
    return (
        f"fit a recording that tells {phrases.parameter(first)} and {phrases.parameter(second)}"
        " apart, such as one with motions of many sizes; as it is, wrong parameters and a wrong"
        f" model look alike.{why}"
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
