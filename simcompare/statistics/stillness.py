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


#: blocks of a stretch that is only a part: fewer are still by chance in a swing
_LEAST_BLOCKS = 6
#: readings from which a tone can be told, and its part of all changes
_LEAST_OF_TONE, _TONE = 256, 0.5


def swings(values: Array) -> bool:
    """Whether most of what changes from reading to reading is one tone: a motion, and no noise."""
    changes = np.diff(values)
    if len(changes) < _LEAST_OF_TONE or not np.any(changes):
        return False
    power = np.abs(np.fft.rfft((changes - changes.mean()) * np.hanning(len(changes)))) ** 2
    # a line of a Hann window is three wide
    return bool(np.convolve(power, np.ones(3), "same").max() > _TONE * power.sum())


def longest_still(channels: Array, rate_Hz: float) -> tuple[int, int]:
    """First sample and end of the longest stretch in which no channel moves.

    Blocks of half a second count as still where every channel scatters as little as in the quietest
    quarter of the record, and where its mean hardly changes. A part of the record must be several
    blocks long, and nothing in it may swing.

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
    low, high = first * size, len(channels) if last == count else last * size
    is_part = 0 < last - first < min(count, _LEAST_BLOCKS)
    return (0, 0) if is_part or any(map(swings, channels[low:high].T)) else (low, high)


def _longest_run(still: NDArray[np.bool_]) -> tuple[int, int]:
    """First and end of the longest run of true; nothing at all where there is none."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], still.astype(int), [0]))))
    starts, ends = edges[::2], edges[1::2]
    if not len(starts):
        return 0, 0
    best = int(np.argmax(ends - starts))
    return int(starts[best]), int(ends[best])
