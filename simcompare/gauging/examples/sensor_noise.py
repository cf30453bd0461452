"""What a low-pass lets through of white noise, and what an encoder resolves."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.hardware.sensors import encoder
from simcompare.hardware.sensors.low_pass import noise_bandwidth

_BANDWIDTHS = {1: "1.5708", 2: "1.1107", 3: "1.0472", 4: "1.0262"}


def _checks() -> Iterator[Check]:
    for poles, published in _BANDWIDTHS.items():
        found = noise_bandwidth(1.0, poles)
        yield Check(f"noise bandwidth over bandwidth, Butterworth {poles}", published, found)
    yield Check(
        "20 marks counted for 50 ms, resolution (rad/s)", "6.28", encoder.gate_resolution(20, 0.05)
    )


EXAMPLE = Example(
    "Noise bandwidths and the resolution of an encoder",
    "(π/2p)/sin(π/2p) for p poles, and 2π/(n·T); numbers computed independently.",
    _checks,
    closed_form=True,
)
