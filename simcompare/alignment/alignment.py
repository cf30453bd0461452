"""Clock alignment: t_log = a + (1 + s)·t_ref, by events, by correlation, by least squares.

Never align on the quantity that is judged: what is left after an alignment says little about it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from simcompare.alignment.clock_line import LEAST_SPAN_S, U_SKEW_PRIOR, Alignment, unaligned
from simcompare.alignment.event_alignment import by_events
from simcompare.alignment.wave_alignment import by_correlation, by_least_squares, by_waveform
from simcompare.errors import InputError

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
    t_ref: ArrayLike | None = None,
    y_ref: ArrayLike | None = None,
    t_log: ArrayLike | None = None,
    y_log: ArrayLike | None = None,
    *,
    reference_events_s: ArrayLike | None = None,
    log_events_s: ArrayLike | None = None,
    u_events_s: ArrayLike | None = None,
    window_s: tuple[float, float] | None = None,
    free_level: bool = False,
) -> Alignment:
    """Aligns two clocks: by events where both have at least two, otherwise by waveforms.

    Args:
        t_ref: times of the reference [s].
        y_ref: its values; NaN where there are none.
        t_log: times of the log [s].
        y_log: its values, of the same kind.
        reference_events_s: times of events on the reference's clock, increasing [s].
        log_events_s: times of events on the log's clock, increasing [s].
        u_events_s: standard uncertainty of their differences, one or one per event of the log [s].
        window_s: least and greatest offset [s].
        free_level: gain and bias of the log's waveform are fitted too.

    Raises:
        InputError: there are neither events nor waveforms, or they cannot be matched.
    """
    waves = None
    if t_ref is not None and y_ref is not None and t_log is not None and y_log is not None:
        waves = (t_ref, y_ref, t_log, y_log)
    if reference_events_s is not None and log_events_s is not None:
        least = min(np.size(reference_events_s), np.size(log_events_s))
        if least >= 2 or (least == 1 and waves is None):
            found = by_events(reference_events_s, log_events_s, u_events_s, window_s=window_s)
            if len(found.matched) >= 2 or waves is None:
                return found
    if waves is None:
        text = "there are no events in both, and no waveforms in both; name a probe to align by"
        raise InputError("alignment", [text])
    return by_waveform(*waves, window_s=window_s, free_level=free_level)
