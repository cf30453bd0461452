"""The longest stretch of a record in which nothing moved, told from the record itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simcompare.model.trajectory import Array

#: samples of one block, and its length where the rate is high [s]
_LEAST_BLOCK, _BLOCK_S = 16, 0.5
#: a block is still where it scatters less than this, relative to the quietest quarter of blocks
_SCATTER = 2.0
#: and where its mean moves less than this from one block to the next, in standard deviations
_MOVES = 8.0


def longest_still(channels: Array, rate_Hz: float) -> tuple[int, int]:
    """First sample and end of the longest stretch in which no channel moves.

    Blocks of half a second count as still where every channel scatters as little as in the quietest
    quarter of the record, and where its mean hardly changes.

    Args:
        channels: evenly spaced readings (n, channels); NaN is never still.
        rate_Hz: how many there are in a second.
    """
    size = max(_LEAST_BLOCK, round(_BLOCK_S * rate_Hz))
    count = len(channels) // size
    if count < 3:
        return 0, len(channels)
    blocks = channels[: count * size].reshape(count, size, -1)
    scatter = blocks.std(axis=1)
    quiet = np.nanquantile(scatter, 0.25, axis=0)
    moves = np.abs(np.diff(blocks.mean(axis=1), axis=0, prepend=blocks[:1].mean(axis=1)))
    calm = (scatter <= _SCATTER * quiet) & (moves <= _MOVES * quiet / np.sqrt(size))
    still = (calm | (scatter == 0)).all(axis=1)
    first, last = _longest_run(still)
    return first * size, len(channels) if last == count else last * size


def _longest_run(still: NDArray[np.bool_]) -> tuple[int, int]:
    """First and end of the longest run of true; nothing at all where there is none."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], still.astype(int), [0]))))
    starts, ends = edges[::2], edges[1::2]
    if not len(starts):
        return 0, 0
    best = int(np.argmax(ends - starts))
    return int(starts[best]), int(ends[best])
