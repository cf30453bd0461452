"""Two clocks brought together by events that both saw, such as bounces, steps or claps."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from simcompare.alignment.clock_line import Alignment, Line, from_centre, line
from simcompare.alignment.matching import Matching, match, times_of
from simcompare.errors import InputError
from simcompare.model.trajectory import Array
from simcompare.statistics.agreement import MAD_TO_SD, rms

#: greatest skew that is looked for: ten times what quartz clocks show
MAX_SKEW = 500e-6
#: coarse tolerance: at least this [s], and never more than a quarter of the median interval
_COARSE_S = 5e-3
#: events that take part in the first search; more would not find another offset
_MAX_VOTERS = 48
_MAX_LOG = 1500
_MAX_SKEWS = 61
#: a pair so far from the line that chance puts one of this many there does not belong together
_ONE_OF = 10_000


@dataclass(frozen=True)
class _Candidate:
    """One offset that was tried: at the centre of the reference, with its matching."""

    offset_s: float
    skew: float
    matching: Matching

    @property
    def count(self) -> int:
        return len(self.matching.pairs)

    @property
    def cost(self) -> float:
        lost = len(self.matching.missed) + len(self.matching.extra)
        return float(np.abs(self.matching.errors_s).sum()) + lost * self.matching.tolerance_s / 2


def by_events(
    reference_s: ArrayLike,
    log_s: ArrayLike,
    u_s: ArrayLike | None = None,
) -> Alignment:
    """Offset and skew from events of which some may be missing or spurious.

    Every difference of a log's and a reference's time votes for an offset, for each of several
    skews within ±500 ppm. The offsets with most votes are matched in order of time, pairs far from
    the line are taken out, and the rest gives a weighted least-squares line (:func:`line`).

    Args:
        reference_s: times of the events on the reference's clock, increasing (n,) [s].
        log_s: times of the events on the log's clock, increasing (m,) [s].
        u_s: standard uncertainty of a difference of the two, one number or one per event of the
            log [s]; from the scatter where ``None``.

    Raises:
        InputError: there is no event, or none can be matched.
    """
    reference, log = times_of(reference_s, "reference"), times_of(log_s, "log")
    if not len(reference) or not len(log):
        text = f"{len(reference)} events in the reference and {len(log)} in the log; both need one"
        raise InputError("events", [text])
    each = None if u_s is None else np.broadcast_to(np.asarray(u_s, dtype=float), log.shape)
    if each is not None and not np.all(each > 0):
        raise InputError("events", ["a standard uncertainty is not positive"])
    tolerance = _tolerance(reference, log, each)
    candidates = _candidates(reference, log, tolerance)
    best, others = _choose(candidates, tolerance)
    matching, fitted = _refined(reference, log, each, best, tolerance)
    return _alignment(reference, log, matching, fitted, others, each is not None)


def _tolerance(reference: Array, log: Array, each: Array | None) -> float:
    """Greatest error of a pair in the first matching [s]."""
    coarse = _COARSE_S if each is None else max(_COARSE_S, 10 * float(np.median(each)))
    for times in (reference, log):
        if len(times) > 1:
            coarse = min(coarse, max(1e-6, 0.25 * float(np.median(np.diff(times)))))
    return coarse


def _candidates(reference: Array, log: Array, tolerance: float) -> list[_Candidate]:
    """Offsets with most votes, matched, best first."""
    centre = (reference[0] + reference[-1]) / 2
    pick = np.unique(np.linspace(0, len(reference) - 1, _MAX_VOTERS).round().astype(int))
    low = max(0, (len(log) - _MAX_LOG) // 2)
    voters, events = reference[pick], log[low : low + _MAX_LOG]
    differences = events[None, :] - voters[:, None]
    places: list[tuple[int, float, float]] = []
    for skew in _skews(reference, tolerance):
        offsets = np.sort((differences - skew * (voters - centre)[:, None]).ravel())
        places += _densest(offsets, float(skew), tolerance)
    # many votes first; of equals the smaller skew
    places.sort(key=lambda entry: (-entry[0], abs(entry[2])))
    candidates: list[_Candidate] = []
    for _, offset, skew in places:
        if len(candidates) == 12:
            break
        if all(abs(offset - known.offset_s) > 3 * tolerance for known in candidates):
            moved = log - offset - skew * (log - offset - centre)
            matching = match(reference, moved, tolerance)
            if matching.pairs:
                candidates.append(_Candidate(offset, skew, matching))
    return sorted(candidates, key=lambda one: (-one.count, one.cost))


def _skews(reference: Array, tolerance: float) -> Array:
    half = (reference[-1] - reference[0]) / 2
    if half <= 0:
        return np.zeros(1)
    steps = min(_MAX_SKEWS // 2, int(np.ceil(MAX_SKEW * half / tolerance)))
    return np.linspace(-MAX_SKEW, MAX_SKEW, 2 * steps + 1)


def _densest(offsets: Array, skew: float, tolerance: float) -> list[tuple[int, float, float]]:
    """The crowded places among sorted offsets: (votes, middle, skew)."""
    end = np.searchsorted(offsets, offsets + 2 * tolerance, side="right")
    votes = end - np.arange(len(offsets))
    places: list[tuple[int, float, float]] = []
    for k in np.argsort(-votes, kind="stable")[:200]:
        middle = float(np.median(offsets[k : end[k]]))
        if all(abs(middle - other) > 3 * tolerance for _, other, _ in places):
            places.append((int(votes[k]), middle, skew))
        if len(places) == 8:
            break
    return places


def _choose(candidates: list[_Candidate], tolerance: float) -> tuple[_Candidate, list[_Candidate]]:
    """The best candidate, and those that are about as good."""
    most = candidates[0].count
    equal = [one for one in candidates if one.count == most]
    cheap = min(one.cost for one in equal)
    equal = [one for one in equal if one.cost <= cheap + 0.1 * most * tolerance]
    best = min(equal, key=lambda one: abs(one.offset_s))
    enough = max(2 if most > 1 else 1, most - max(1, most // 10))
    return best, [one for one in candidates if one is not best and one.count >= enough]


def _refined(
    reference: Array, log: Array, each: Array | None, best: _Candidate, tolerance: float
) -> tuple[Matching, Line]:
    """Match, fit, match again more closely, until the pairs stay."""
    centre = (reference[0] + reference[-1]) / 2
    offset, skew, matching = best.offset_s, best.skew, best.matching
    for _ in range(8):
        i, j = _indices(matching)
        kept = _near(reference[i], log[j], None if each is None else each[j])
        matching = _without(matching, kept)
        i, j = _indices(matching)
        fitted = line(reference[i], log[j], _u_of(each, j, tolerance))
        offset, skew = fitted.offset_s, fitted.skew
        centre = fitted.centre_s
        moved = centre + (log - centre - offset) / (1 + skew)
        again = match(reference, moved, tolerance)
        i, j = _indices(again)
        again = _without(again, _near(reference[i], log[j], None if each is None else each[j]))
        if again.pairs == matching.pairs:
            break
        matching = again
    i, j = _indices(matching)
    return matching, line(reference[i], log[j], _u_of(each, j, tolerance))


def _u_of(each: Array | None, j: Array, tolerance: float) -> Array | None:
    if each is not None:
        return np.asarray(each[j])
    # a single pair has no scatter; all that is known of it is that it was matched
    return np.array([tolerance / np.sqrt(3)]) if len(j) == 1 else None


def _indices(matching: Matching) -> tuple[Array, Array]:
    pairs = np.array(matching.pairs, dtype=int).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


def _near(reference: Array, log: Array, each: Array | None) -> Array:
    """Which pairs lie on the line of the others, told by medians of slopes and of distances."""
    from scipy import stats

    if len(reference) < 3:
        return np.ones(len(reference), dtype=bool)
    distances = log - reference
    distances = distances - _slope(reference, distances) * (reference - reference.mean())
    distances = np.abs(distances - np.median(distances))
    made = MAD_TO_SD * float(np.median(distances)) * np.sqrt(len(distances) / (len(distances) - 2))
    if each is not None:
        return np.asarray(distances <= stats.norm.isf(0.5 / _ONE_OF) * np.maximum(each, made))
    # the fewer the pairs, the less is known of their scatter
    return np.asarray(distances <= stats.t.isf(0.5 / _ONE_OF, len(distances) - 2) * max(made, 1e-9))


def _slope(x: Array, y: Array) -> float:
    """Median of the slopes of all pairs (Theil and Sen), within what clocks may do."""
    pick = np.unique(np.linspace(0, len(x) - 1, 200).round().astype(int))
    a, b = np.triu_indices(len(pick), 1)
    run = x[pick][b] - x[pick][a]
    rise = y[pick][b] - y[pick][a]
    apart = run > 0
    if not apart.any():
        return 0.0
    return float(np.clip(np.median(rise[apart] / run[apart]), -2 * MAX_SKEW, 2 * MAX_SKEW))


def _without(matching: Matching, kept: Array) -> Matching:
    """The matching without the pairs that are not kept; their events have no partner."""
    if kept.all():
        return matching
    lost = [pair for pair, keep in zip(matching.pairs, kept, strict=True) if not keep]
    return replace(
        matching,
        pairs=tuple(pair for pair, keep in zip(matching.pairs, kept, strict=True) if keep),
        missed=tuple(sorted([*matching.missed, *(i for i, _ in lost)])),
        extra=tuple(sorted([*matching.extra, *(j for _, j in lost)])),
        errors_s=matching.errors_s[kept],
    )


def _alignment(
    reference: Array,
    log: Array,
    matching: Matching,
    fitted: Line,
    others: list[_Candidate],
    known: bool,
) -> Alignment:
    alignment = Alignment(
        0.0, 0.0, 0.0, 0.0, "events",
        matched=matching.pairs, missed=matching.missed, extra=matching.extra,
        text=_text(reference, log, matching, fitted, others, known),
        residual=rms(fitted.residuals_s),
        ambiguous=bool(others),
    )  # fmt: skip
    return from_centre(fitted.centre_s, fitted.offset_s, fitted.skew, fitted.covariance, alignment)


def _text(
    reference: Array,
    log: Array,
    matching: Matching,
    fitted: Line,
    others: list[_Candidate],
    known: bool,
) -> str:
    n = len(matching.pairs)
    parts = [
        f"{n} of {len(reference)} events of the reference matched to {n} of {len(log)} of the log."
    ]
    if fitted.fitted:
        parts.append("Offset and skew fitted by least squares.")
    else:
        parts.append(
            "The events tell less about the skew than is known of quartz clocks, so a skew of "
            "0 ± 50 ppm was assumed beside them."
        )
    if not known:
        parts.append("The uncertainty of the events' times was taken from their scatter.")
    elif fitted.scale > 1.3:
        parts.append(
            f"They scatter {fitted.scale:.1f} times as much as their uncertainties say; "
            "the uncertainties were widened by that."
        )
    if others:
        near = ", ".join(f"{one.offset_s:.4g} s ({one.count} events)" for one in others[:3])
        parts.append(
            f"Ambiguous: the events repeat, and other offsets match about as many: {near}. "
            "A longer window of the recording may settle it."
        )
    return " ".join(parts)
