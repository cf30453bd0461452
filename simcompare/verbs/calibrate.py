"""The verb ``calibrate``: sensitivity and offset of a real sensor, or of one that is drawn."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from simcompare import units
from simcompare.arguments import checked
from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors import (
    data_sheet,
    ellipsoid,
    rate_table,
    readings_table,
    session,
    six_position,
    still_poses,
    triads,
    two_point,
)
from simcompare.hardware.sensors.calibrated import Readings
from simcompare.hardware.sensors.calibration import Calibration, Taken
from simcompare.hardware.sensors.triads import Triad
from simcompare.inference import sources
from simcompare.model import plain, record_file, recording_store
from simcompare.model.recording import Recording
from simcompare.reports.calibration import words
from simcompare.results import store
from simcompare.results.records.calibration import (
    Truth,
    plain_of,
    rows_of,
)
from simcompare.results.run_record import now, software
from simcompare.statistics.distributions import normal, rectangular
from simcompare.statistics.streams import stream
from simcompare.verbs.calibrated import Calibrated
from simcompare.verbs.damaged import told_as_damaged

KINDS = ("six-position", "ellipsoid", "rate-table", "two-point")
FILE = "calibration.json"
#: directions of "up" in which a simulated device is verified: corners and edges of its box
_OTHERS = np.array([(1, 1, 1), (-1, 1, 1), (1, -1, 1), (1, 1, -1), (1, 1, 0), (0, -1, -1)]) / 1.0
#: of a simulated g, as a map and the height above the sea tell it [m/s²]
_U_SIMULATED_G = 1e-3


@dataclass(frozen=True)
class _Known:
    """What is taken as known."""

    gravity: Taken
    tilt: Taken
    noise: float | None


@checked
def calibrate(
    source: str | Path | None = None,
    *,
    kind: str | None = None,
    simulate: str | None = None,
    gravity: str | float | None = None,
    gravity_u: str | float | None = None,
    level: str | float | None = None,
    noise: str | float | None = None,
    sensor: str = "",
    mapping: str | Path | None = None,
    apply: str | Path | None = None,
    seed: int = 0,
    out: str | Path | None = None,
) -> Calibrated:
    """Calibrates a sensor: what it is off by, and what is left after a correction.

    ::

        found = simcompare.calibrate("poses.csv", gravity=9.8128, gravity_u=0.0002)
        found = simcompare.calibrate(simulate="mpu6050")
        corrected = found.apply(readings)

    Args:
        source: table of mean readings (``pose,ax,ay,az``), log or recording with still poses, or a
            stored calibration.json.
        kind: "six-position", "ellipsoid", "rate-table" or "two-point"; ``None``: what the readings
            allow.
        simulate: data sheet of which a device is drawn and laid on its six sides, in place of a
            source.
        gravity: local g [m/s²]; ``None``: that of anywhere at sea level.
        gravity_u: its standard uncertainty [m/s²].
        level: by which poses are off the vertical at most, such as "0.5deg".
        noise: standard uncertainty of a mean reading, in the unit of the sensor; ``None``: told by
            the readings.
        sensor: begin of the names of its channels, where a recording has several.
        mapping: YAML file that says of a log what it does not say itself.
        apply: log or recording that is corrected.
        seed: of a simulated device.
        out: folder for the folder of the results; nothing is stored where ``None``.

    Returns:
        The calibration, which corrects readings.

    Raises:
        UnknownName: no such recording, sheet or kind.
        InputError: readings from which nothing can be told; says what is missing.
        OutputError: the folder cannot be written to.
    """
    _check(source, simulate, kind, apply, out)
    if out is not None:
        store.check_writable(Path(out))
    known = _known(gravity, gravity_u, level, noise, simulated=simulate is not None)
    if simulate is not None:
        found = _simulated(simulate, known, seed)
    elif _is_stored(source):
        given = {
            "--kind": kind, "--gravity": gravity, "--gravity-u": gravity_u, "--level": level,
            "--noise": noise,
        }  # fmt: skip
        if faults := [f"{name} is in it already" for name, one in given.items() if one is not None]:
            raise InputError(f"{source}, a stored calibration", faults)
        found = _stored(Path(str(source)))
    else:
        found = _measured(str(source), kind, known, sensor, mapping)
    if out is None:
        return found
    return _saved(found, Path(out), apply, sensor, mapping)


def _check(
    source: str | Path | None, simulate: str | None, kind: str | None,
    apply: str | Path | None, out: str | Path | None,
) -> None:  # fmt: skip
    faults = []
    if (source is None) == (simulate is None):
        faults.append("give a table, log or recording, or --simulate SHEET; one of them")
    if apply is not None and out is None:
        faults.append("apply needs out: the folder for the corrected recording")
    if simulate is not None and kind not in (None, "six-position"):
        faults.append("--simulate is of six positions; leave out --kind")
    if faults:
        raise InputError("calibrate", faults)
    if kind is not None and kind not in KINDS:
        raise UnknownName("kind of calibration", kind, KINDS)


def _known(
    gravity: str | float | None, gravity_u: str | float | None, level: str | float | None,
    noise: str | float | None, *, simulated: bool,
) -> _Known:  # fmt: skip
    g = six_position.SOMEWHERE
    if simulated and gravity is None:
        g = Taken(normal(9.80665, _U_SIMULATED_G), "assumed for the simulated place")
    if gravity is not None:
        value = units.to_si(gravity, "m/s**2", "--gravity")
        u = _U_SIMULATED_G if gravity_u is None else units.to_si(gravity_u, "m/s**2", "--gravity-u")
        if not (9.7 < value < 9.9 and 0 < u < 0.1):
            fault = f"{value:g} m/s² with u = {u:g} is no g on Earth; expected 9.76 to 9.84"
            raise InputError("--gravity", [fault])
        g = Taken(normal(value, u))
    elif gravity_u is not None:
        raise InputError("--gravity-u", ["says nothing without --gravity"])
    tilt = six_position.ON_A_TABLE
    if level is not None:
        limit = units.to_si(level, "rad", "--level")
        if not 0 < limit < 0.2:
            raise InputError("--level", [f"{limit:g} rad is none; expected up to 10 deg"])
        tilt = Taken(rectangular(-limit, limit), "as stated, rectangular")
    return _Known(g, tilt, _number(noise))


def _number(noise: str | float | None) -> float | None:
    if noise is None:
        return None
    try:
        value = float(noise)
    except ValueError:
        value = units.si_of(str(noise), "--noise")[0]
    if not value > 0:
        raise InputError("--noise", [f"{value:g} is no uncertainty; expected a number above 0"])
    return value


def _refuse_noise(known: _Known, why: str) -> None:
    if known.noise is not None:
        raise InputError("--noise", [f"{why}; it is for a table of readings, so leave it out"])


def _is_stored(source: str | Path | None) -> bool:
    return source is not None and Path(source).suffix == ".json" and Path(source).is_file()


def _stored(path: Path) -> Calibrated:
    """A calibration that was stored."""
    content = record_file.read(path, "calibrate again")
    try:
        found = record_file.record(Calibrated, content, path)
        with told_as_damaged([path], "correction"):
            repr(found)
        return found
    except InputError as error:
        fault = f"is no stored calibration; expected {FILE} of simcompare calibrate"
        raise InputError(str(path), [fault, *error.faults]) from None


def _simulated(sheet: str, known: _Known, seed: int) -> Calibrated:
    _refuse_noise(known, "a simulated device has the noise of its data sheet")
    loaded = data_sheet.load(sheet)
    part = loaded.part_for("m/s**2")
    if part is None:
        raise InputError("--simulate", [f"{loaded.title} has no accelerometer"])
    device = part.drawn(seed, "calibrated device")
    g = float(known.gravity.known.draw(stream(seed, "calibrate", "g"), 1)[0])
    others = _OTHERS / np.linalg.norm(_OTHERS, axis=1, keepdims=True)
    generator = stream(seed, "calibrate", "session")
    held = session.hold(device, generator, g, known.tilt, others=others)
    found = six_position.calibrate(held.readings, known.gravity, known.tilt)
    sensitivity, offset = session.chord(device, g)
    truth = Truth(
        f"{loaded.title}, drawn with seed {seed}", rows_of(sensitivity), tuple(map(float, offset))
    )
    return _result(found, f"simulated {loaded.title}, seed {seed}", truth)


def _measured(
    source: str, kind: str | None, known: _Known, sensor: str, mapping: str | Path | None
) -> Calibrated:
    path = Path(source)
    if readings_table.is_table(path):
        return _result(_of_table(path, kind, known), path.name)
    _refuse_noise(known, "a recording tells its noise by the scatter within its poses")
    if kind in ("rate-table", "two-point"):
        cure = f"give a table ({readings_table.FORMS}); a recording does not say what acted"
        raise InputError(source, [f"{kind}: {cure}"])
    recording, triad = _sensor(source, six_position.UNIT, sensor, mapping)
    poses = still_poses.find(recording.streams[triad.stream].time_s, triad.values(recording))
    return _result(_of_poses(source, still_poses.readings_of(poses), kind, known), source)


def _of_table(path: Path, kind: str | None, known: _Known) -> Calibration:
    table = readings_table.read(path)
    readings = _with_noise(table.readings, known.noise)
    if table.kind == "accelerometer" and kind in (None, "six-position", "ellipsoid"):
        return _of_poses(str(path), readings, kind, known)
    if kind not in (None, table.kind):
        raise InputError(str(path), [f"is a table of {table.kind}; leave out --kind {kind}"])
    if table.rates is not None:
        return rate_table.calibrate(readings, table.rates, alignment=known.tilt)
    return two_point.calibrate(readings, table.known, "the table")


def _with_noise(readings: Readings, noise: float | None) -> Readings:
    if noise is None:
        return readings
    most = float(np.max(np.abs(readings.means), initial=0.0))
    if noise > most:
        fault = f"{noise:g} is more than every reading; expected at most {most:.4g}"
        raise InputError("--noise", [fault])
    return replace(
        readings, u=np.full_like(readings.means, noise), u_from="as stated",
        degrees_of_freedom=np.inf,
    )  # fmt: skip


def _of_poses(source: str, readings: Readings, kind: str | None, known: _Known) -> Calibration:
    missing = [name for name in six_position.POSITIONS if name not in readings.names]
    if kind is None:
        kind = "six-position" if not missing else "ellipsoid"
    try:
        if kind == "six-position":
            return six_position.calibrate(readings, known.gravity, known.tilt)
        return ellipsoid.calibrate(readings, known.gravity)
    except InputError as error:
        wanted = f"six positions: {', '.join(missing)} missing" if missing else ""
        told = words.of_few_poses(readings, known.gravity.known) if missing else ""
        faults = [wanted if kind == "ellipsoid" else "", *error.faults, told]
        raise InputError(source, list(filter(None, faults))) from None


def _result(found: Calibration, source: str, truth: Truth | None = None) -> Calibrated:
    return Calibrated(
        created=now(), source=source, truth=truth, software=software(), **plain_of(found)
    )


def _saved(
    found: Calibrated, folder: Path, apply: str | Path | None, sensor: str,
    mapping: str | Path | None,
) -> Calibrated:  # fmt: skip
    applied = None
    if apply is not None:
        recording, triad = _sensor(str(apply), found.unit, sensor, mapping)
        applied = triads.corrected(recording, triad, found.calibration)
    with store.new_folder(folder, found.created, "calibration", "calibration") as (place, partial):
        if applied is not None:
            recording_store.save(applied, partial / "corrected.rec")
        corrected = None if applied is None else place / "corrected.rec"
        stored = replace(found, folder=place, applied=corrected)
        (partial / FILE).write_text(plain.text(stored, indent=1) + "\n", encoding="utf-8")
    return stored


def _sensor(
    log: str, unit: str, sensor: str, mapping: str | Path | None
) -> tuple[Recording, Triad]:
    """A recording, and the sensor in it that measures in a unit."""
    recording = sources.find(log, mapping=mapping).recording
    return recording, triads.find(recording, unit, sensor)
