"""What a record says of sensors that are not ideal: their devices, and how far readings are off."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from simcompare.hardware.sensors.drawn_terms import DrawnTerm
from simcompare.model.plain import Finite


@dataclass(frozen=True)
class AxisDeviation:
    """How far one axis of a reading is from the ideal signal.

    Attributes:
        axis: letter, empty where there is one axis.
        mean: of measured minus ideal.
        scatter: standard deviation about that mean.
        rms: of measured minus ideal.
        saturated: samples that were cut off.
        median: of measured minus ideal; of many zones alone, where a zone with an edge in it reads
            the mean of two things and the ideal ray sees one of them.
        half_68: half of the width that holds the middle 68 % of them; of many zones alone.
    """

    axis: str
    mean: float
    scatter: float
    rms: float
    saturated: int
    median: float | None = None
    half_68: float | None = None


@dataclass(frozen=True)
class SourceDeviation:
    """How far a reading of one source is from its ideal signal.

    Attributes:
        source: whose motion was read.
        contact: its contact level, empty where it has none.
        samples: of the reading; of many zones, frames.
        axes: one for each axis; of many zones, one over all that can be trusted.
        notes: what the reader should know.
        statuses: of many zones, what the chip says of them -> how often.
    """

    source: str
    contact: str
    samples: int
    axes: tuple[AxisDeviation, ...]
    notes: tuple[str, ...] = ()
    statuses: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class ZoneSettings:
    """How a range sensor of many zones looks, and at what.

    Attributes:
        in_a_row: zones, and rows.
        ambient_klux: light on the scene.
        crosstalk: what a cover glass sends back [1/m²].
        order: which of several targets in a zone is told.
        reflectance: of bodies of which one is said.
    """

    in_a_row: int
    ambient_klux: float
    crosstalk: float
    order: str
    reflectance: Mapping[str, float]


@dataclass(frozen=True, kw_only=True)
class SensorRecord:
    """One signal and the device that read it.

    Attributes:
        signal: such as "imu.rate_rad_s".
        unit: of it, SI.
        axes: letters of its axes, empty where there is one.
        sheet: name of the data sheet, empty where there is none.
        chip: what the sheet calls it.
        part: of the chip.
        document: of the sheet.
        rate_Hz: samples in a second; 0: those of the simulation.
        bandwidth_Hz: -3 dB; not finite where nothing is smoothed.
        poles: of the low-pass.
        full_scale: not finite where readings are never cut off.
        resolution: of one count; 0: not quantised.
        temperature_C: of the device.
        latency_s: by which a sample is older than its time stamp.
        jitter_s: standard deviation of the instant of a sample.
        terms: what was drawn, and what every device of its kind has.
        deviations: one for each source.
        zones: of a range sensor of many zones.
    """

    signal: str
    unit: str
    axes: str
    sheet: str = ""
    chip: str = ""
    part: str = ""
    document: str = ""
    rate_Hz: float
    bandwidth_Hz: Finite
    poles: int
    full_scale: Finite
    resolution: float
    temperature_C: float
    latency_s: float
    jitter_s: float
    terms: tuple[DrawnTerm, ...] = ()
    deviations: tuple[SourceDeviation, ...] = ()
    zones: ZoneSettings | None = None


@dataclass(frozen=True)
class Sensing:
    """All sensors of a run that are not ideal.

    Attributes:
        seed: of all that was drawn.
        sensors: one for each signal.
        sha256: digest of the file of readings in runs that do not tell it of every table.
    """

    seed: int
    sensors: tuple[SensorRecord, ...]
    sha256: str = ""
