"""The straight line between two clocks: t_log = a + (1 + s)·t_ref, with its uncertainty.

Never align on the quantity that is judged: what is left after an alignment says little about it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from simcompare.model.trajectory import Array

#: standard uncertainty of the skew of two quartz clocks before anything was measured [1]
U_SKEW_PRIOR = 50e-6
#: shortest span over which a skew is fitted without that knowledge [s]
MIN_SPAN_S = 5.0


@dataclass(frozen=True)
class Alignment:
    """How the clock of a log runs against that of a reference: t_log = a + (1 + s)·t_ref.

    Attributes:
        offset_s: a, what the log's clock shows where the reference shows 0 [s].
        skew: s, by how much the log's clock runs fast [1].
        u_offset_s: standard uncertainty of a [s].
        u_skew: standard uncertainty of s [1].
        method: "events" or "least squares".
        matched: pairs (event of the reference, event of the log); empty for waveforms.
        missed: events of the reference that the log does not have.
        extra: events of the log that the reference does not have.
        text: what was done and what the reader must know, in plain sentences.
        correlation: correlation of a and s.
        residual: rms of the residuals: of the events' times [s], or of the signal in its unit.
        ambiguous: another offset fits about as well.
    """

    offset_s: float
    skew: float
    u_offset_s: float
    u_skew: float
    method: str
    matched: tuple[tuple[int, int], ...] = ()
    missed: tuple[int, ...] = ()
    extra: tuple[int, ...] = ()
    text: str = ""
    correlation: float = 0.0
    residual: float | None = None
    ambiguous: bool = False

    def to_reference(self, time_s: ArrayLike) -> Array:
        """Times of the log on the reference's clock [s]."""
        return np.asarray((np.asarray(time_s, dtype=float) - self.offset_s) / (1 + self.skew))

    def to_log(self, time_s: ArrayLike) -> Array:
        """Times of the reference on the log's clock [s]."""
        times = np.asarray(time_s, dtype=float)
        return np.asarray(self.offset_s + times + self.skew * times)


def from_centre(
    centre_s: float,
    offset_s: float,
    skew: float,
    covariance: Array,
    alignment: Alignment,
) -> Alignment:
    """An alignment from the clocks' difference at a centre, where it hardly correlates with s.

    Args:
        centre_s: time of the reference [s].
        offset_s: what the log's clock shows there, minus that time [s].
        skew: s [1].
        covariance: of the two (2, 2).
        alignment: everything else.
    """
    turn = np.array([[1.0, -centre_s], [0.0, 1.0]])
    moved = turn @ covariance @ turn.T
    u_offset_s, u_skew = (math.sqrt(max(0.0, float(v))) for v in np.diag(moved))
    size = u_offset_s * u_skew
    correlation = float(moved[0, 1]) / size if size > 0 else 0.0
    return replace(
        alignment,
        offset_s=offset_s - skew * centre_s,
        skew=skew,
        u_offset_s=u_offset_s,
        u_skew=u_skew,
        correlation=min(1.0, max(-1.0, correlation)),
    )


@dataclass(frozen=True)
class Line:
    """A fitted line through differences of two clocks.

    Attributes:
        centre_s: weighted mean of the reference's times [s].
        offset_s: difference of the clocks there [s].
        skew: slope [1].
        covariance: of offset and skew (2, 2).
        residuals_s: (n,) [s].
        u_s: standard uncertainty of a difference that went in, or was found [s].
        scale: by how much the uncertainties were widened because the scatter asked for it.
        fitted: whether the skew comes from the data alone.
    """

    centre_s: float
    offset_s: float
    skew: float
    covariance: Array
    residuals_s: Array
    u_s: Array
    scale: float
    fitted: bool


def line(reference_s: Array, log_s: Array, u_s: Array | None) -> Line:
    """Weighted least squares of log - reference against reference.

    u(s) = σ/√Σ(t - mean t)² (JCGM 100:2008, H.3). Over less than 5 s, or where the data say less
    about the skew than is known of quartz clocks anyway, s ~ N(0, 50 ppm) is one more observation.
    A scatter beyond the given uncertainties widens them by √(χ²/ν) (R. T. Birge, 1932). Unknown
    uncertainties are taken from the scatter, and widened to half of Student's t, so that two of
    them cover 95 % (JCGM 100:2008, G.3).

    Args:
        reference_s: times of the reference (n,) [s].
        log_s: times of the log (n,) [s].
        u_s: standard uncertainties of the differences (n,) [s], ``None`` where unknown.
    """
    n = len(reference_s)
    each = u_s if u_s is not None else np.full(n, _scatter(reference_s, log_s))
    weight = 1 / each**2
    centre = float(weight @ reference_s / weight.sum())
    arm, gap = reference_s - centre, log_s - reference_s
    offset, spread = float(weight @ gap / weight.sum()), float(weight @ arm**2)
    free = float(np.ptp(reference_s)) >= MIN_SPAN_S and spread * U_SKEW_PRIOR**2 >= 1
    if not free:
        spread += U_SKEW_PRIOR**-2
    skew = float(weight @ (arm * gap)) / spread
    residuals = gap - offset - skew * arm
    # the part of the skew that the data determine costs that part of a degree of freedom
    dof = n - 1 - float(weight @ arm**2) / spread
    chi2 = float(weight @ residuals**2)
    scale = math.sqrt(max(1.0, chi2 / dof)) if u_s is not None and dof > 0.5 else 1.0
    covariance = np.diag([1 / weight.sum(), 1 / spread]) * scale**2
    if not free:
        covariance[1, 1] = min(covariance[1, 1], U_SKEW_PRIOR**2)
    return Line(centre, offset, skew, covariance, residuals, each, scale, free)


def _scatter(reference_s: Array, log_s: Array) -> float:
    """Standard uncertainty of the differences, from their scatter about a line [s]."""
    from scipy import stats

    gap, n = log_s - reference_s, len(reference_s)
    arm = reference_s - reference_s.mean()
    fits = n > 2 and float(arm @ arm) > 0
    slope = float(arm @ gap) / float(arm @ arm) if fits else 0.0
    residuals = gap - gap.mean() - slope * arm
    dof = max(1, n - 2 if fits else n - 1)
    u_s = math.sqrt(float(residuals @ residuals) / dof) * float(stats.t.ppf(0.975, dof)) / 1.96
    # times are doubles: nothing is known better than their last digits
    return max(u_s, 1e-9)
