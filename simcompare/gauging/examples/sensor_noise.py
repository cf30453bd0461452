"""What a low-pass lets through of white noise, and what an encoder resolves."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.hardware.sensors import encoder
from simcompare.hardware.sensors.low_pass import noise_bandwidth

_BANDWIDTHS = {1: "1.570796327", 2: "1.110720735", 3: "1.047197551", 4: "1.026172153"}


def _checks() -> Iterator[Check]:
    for poles, exact in _BANDWIDTHS.items():
        found = noise_bandwidth(1.0, poles)
        yield Check(f"noise bandwidth over bandwidth, Butterworth {poles}", exact, found)
    yield Check(
        "20 marks counted for 50 ms, resolution (rad/s)",
        "6.283185307",
        encoder.gate_resolution(20, 0.05),
    )


EXAMPLE = Example(
    "Noise bandwidths and the resolution of an encoder",
    "(π/2p)/sin(π/2p) for p poles, and 2π/(n·T); computed with mpmath.",
    _checks,
    kind="exact",
    closed_form=True,
)
