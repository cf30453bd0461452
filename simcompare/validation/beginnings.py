"""Whether a simulation begins where the recording does."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from simcompare.inference.estimate import Estimate
from simcompare.inference.evaluated import Evaluated
from simcompare.inference.plan import Plan
from simcompare.inference.segments import Observed, noise
from simcompare.inference.starts import over_s, starts_of
from simcompare.results.records.validation import ApartRecord

#: apart is what differs by so many times the uncertainty of a sample, and by this part of the range
_MANY_U, _PART = 10.0, 0.02


def apart(plan: Plan, one: Evaluated, fit: Estimate | None) -> Iterator[ApartRecord]:
    """The probes that begin elsewhere, where nothing but the scenario says where they do.

    Args:
        plan: how the recording was read.
        one: a segment of it.
        fit: what was fitted, ``None`` where nothing was.
    """
    if plan.align.by != "none":
        return
    starts = starts_of(one.scene.parameters, one.scene.probes, plan.compare)
    known = {*one.segment.values, *(() if fit is None else fit.names)}
    for name, start in starts.items():
        if start.derivative or name in known:
            continue
        measured, simulated = one.segment.observed[start.probe], one.scene.parameters[name]
        if _is_apart(measured, simulated):
            compared = plan.compare[start.probe]
            yield ApartRecord(
                stream=one.segment.stream,
                parameter=name,
                channel=compared.channel,
                offset=compared.offset,
                over_s=over_s(float(np.median(np.diff(measured.time_s)))),
                simulated=simulated,
                measured=float(measured.values[0]),
                unit=one.scene.probes[start.probe].unit,
            )


def _is_apart(measured: Observed, simulated: float) -> bool:
    difference = abs(float(measured.values[0]) - simulated)
    return difference > max(_MANY_U * noise(measured)[0], _PART * float(np.ptp(measured.values)))
