"""A simulation that does not begin where the recording does, in words, and the cure."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from simcompare.reports.validation import phrases
from simcompare.results.records.validation import ApartRecord, Validation

#: what ``over_s`` is where nothing is said
_OVER_S = 0.05
_PLAIN = re.compile(r"[A-Za-z_][\w./]*")


def sentences(validation: Validation) -> Iterator[str]:
    """Where both begin, and what to write into the mapping."""
    if not validation.apart:
        return
    first = validation.apart[0]
    both = [first.simulated, first.measured]
    simulated, measured = phrases.sizes(both, first.unit)
    unique = {one.parameter: one for one in validation.apart}
    keys = ", ".join(f"{name}: {_read_off(one)}" for name, one in unique.items())
    yield (f"The simulation starts at {simulated}, the log at {measured}"
           f"{phrases.where(validation, first)}: add start: {{{keys}}} under validate: in the"
           " mapping.")  # fmt: skip


def _read_off(one: ApartRecord) -> str:
    channel = one.channel if _PLAIN.fullmatch(one.channel) else json.dumps(one.channel)
    keys = f"channel: {channel}"
    keys += f", over_s: {one.over_s:.2g}" if one.over_s > _OVER_S else ""
    keys += f", offset: {one.offset!r}" if one.offset else ""
    return f"{{{keys}}}"
