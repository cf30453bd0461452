"""What a fit of bounces assumes of the recorder where nobody states it: how well, and why.

Gravity and drag are the scenario's: their uncertainty is stated there.

A quartz is offered with ±20 ppm at room temperature; with temperature, age and its load an
oscillator of a sound card stays within ±100 ppm (http://psn.quake.net/psnlist/060711_090558_1.html).
So u = 50 ppm, of which ±100 ppm are 95 %. A device may lie outside: two of three telephones
differed by 3 ppm, the third by 270 ppm (https://protyposis.net/clockdrift/user-guide/).

A camera's frame rate is often rounded: "30" stands for 30/1.001 as well, which is 0.1 % less
(SMPTE ST 170). The length of a video comes from a rod in the picture. That it is true to ±1 % is an
assumption, not a measurement: 2 cm nearer to a camera 2 m away than the ball is 1 %.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence

from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.unknowns import CLOCK, SCALE
from simcompare.results.records.fit_forms import Prior

QUARTZ = Prior(
    0.0, 50e-6, "a quartz of a telephone, sound card or stopwatch: ±100 ppm with 95 %",
    "http://psn.quake.net/psnlist/060711_090558_1.html",
)  # fmt: skip
FRAMES = Prior(
    0.0, 1e-3 / math.sqrt(3), "a frame rate of 30 may be 30/1.001: ±0.1 %", "SMPTE ST 170"
)
LENGTHS = Prior(
    1.0, 1e-2 / math.sqrt(3), "a rod in the picture, 2 cm of 2 m nearer or farther: ±1 %"
)


def of_recorder(drops: Sequence[Impacts], sought: Collection[str] = ()) -> Mapping[str, Prior]:
    """What is assumed of the clock, and of lengths that were filmed.

    Args:
        drops: what was measured.
        sought: unknowns that the user names. A scale that is sought is not known by a rod; the
            quartz of a clock that is sought stays one.
    """
    if any(drop.track is not None for drop in drops):
        found = {CLOCK: FRAMES, SCALE: LENGTHS}
        return {name: prior for name, prior in found.items() if name != SCALE or name not in sought}
    timed = any(len(drop.times_s) or len(drop.intervals_s) for drop in drops)
    return {CLOCK: QUARTZ} if timed else {}
