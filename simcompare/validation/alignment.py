"""Clock alignment: t_log = a + (1 + s)·t_ref, by events, by correlation, by least squares.

Never align on the quantity that is judged: what is left after an alignment says little about it.
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from simcompare.errors import InputError
from simcompare.validation.clock_line import LEAST_SPAN_S, U_SKEW_PRIOR, Alignment, unaligned
from simcompare.validation.event_alignment import by_events
from simcompare.validation.wave_alignment import by_correlation, by_least_squares, by_waveform

__all__ = [
    "LEAST_SPAN_S",
    "U_SKEW_PRIOR",
    "Alignment",
    "align",
    "by_correlation",
    "by_events",
    "by_least_squares",
    "by_waveform",
    "unaligned",
]


def align(
    *,
    reference_events_s: ArrayLike | None = None,
    log_events_s: ArrayLike | None = None,
    u_events_s: ArrayLike | None = None,
    reference: tuple[ArrayLike, ArrayLike] | None = None,
    log: tuple[ArrayLike, ArrayLike] | None = None,
    window_s: tuple[float, float] | None = None,
    free_level: bool = False,
) -> Alignment:
    """Aligns two clocks: by events where both have at least two, otherwise by waveforms.

    Args:
        reference_events_s: times of events on the reference's clock, increasing [s].
        log_events_s: times of events on the log's clock, increasing [s].
        u_events_s: standard uncertainty of their differences [s].
        reference: times [s] and values of the reference's waveform.
        log: times [s] and values of the log's waveform.
        window_s: least and greatest offset [s].
        free_level: gain and bias of the log's waveform are fitted too.

    Raises:
        InputError: there are neither events nor waveforms, or they cannot be matched.
    """
    import numpy as np

    waves = reference is not None and log is not None
    if reference_events_s is not None and log_events_s is not None:
        least = min(np.size(reference_events_s), np.size(log_events_s))
        if least >= 2 or (least == 1 and not waves):
            found = by_events(reference_events_s, log_events_s, u_events_s, window_s=window_s)
            if len(found.matched) >= 2 or not waves:
                return found
    if reference is None or log is None:
        text = "there are no events in both, and no waveforms in both; name a probe to align by"
        raise InputError("alignment", [text])
    return by_waveform(*reference, *log, window_s=window_s, free_level=free_level)
