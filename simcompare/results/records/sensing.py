"""What a record says of sensors that are not ideal: their devices, and how far readings are off."""

from __future__ import annotations

from dataclasses import dataclass

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
    """

    axis: str
    mean: float
    scatter: float
    rms: float
    saturated: int


@dataclass(frozen=True)
class SourceDeviation:
    """How far a reading of one source is from its ideal signal.

    Attributes:
        source: whose motion was read.
        contact: its contact level, empty where it has none.
        samples: of the reading.
        axes: one for each axis.
        notes: what the reader should know.
    """

    source: str
    contact: str
    samples: int
    axes: tuple[AxisDeviation, ...]
    notes: tuple[str, ...] = ()


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
