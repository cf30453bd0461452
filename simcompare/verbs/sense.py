"""The function ``sense``: what a real sensor would read of a trajectory, a run or a recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.arguments import checked
from simcompare.errors import InputError
from simcompare.hardware.sensors import signals as names
from simcompare.hardware.sensors.device import Device
from simcompare.hardware.sensors.drawn import DrawnSensor
from simcompare.model.recording import Recording
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array, Trajectory
from simcompare.results import frames, run_record, sensing
from simcompare.results.asked_sensors import Drawn, devices_of
from simcompare.results.run import Run, Stored
from simcompare.scenarios import catalogue
from simcompare.verbs.sensed import Sensed

Thing = Trajectory | Run | Recording


@checked
def sense(
    thing: Thing,
    signal: str | Sequence[str],
    device: str | Path | Device | Mapping[str, Any],
    *,
    seed: int = 0,
    engine: str | None = None,
    contact: str | None = None,
) -> Sensed:
    """What a real sensor would read, beside the ideal signal.

    ::

        run = simcompare.run("robot", engine="mujoco")
        read = simcompare.sense(run, "imu", "mpu6050")
        read.samples("imu.rate_rad_s")           # time, ideal, measured, saturated
        read.plot().savefig("imu.pdf")
        simcompare.sense(run, "left.angle_rad", {"rate_Hz": 100, "noise_rad_per_rtHz": 0.001})

    Args:
        thing: a trajectory, a run or a recording; a run, where many zones look at its scene.
        signal: sensor or signal, such as "imu", "imu.rate_rad_s" or "chassis.position_m.x"; of a
            recording a channel, or three for the axes x, y, z.
        device: name or file of a data sheet, a device, or terms as under ``errors`` of a scenario;
            of many zones also ``ambient_klux``, ``crosstalk``, ``order`` and ``reflectance``, as in
            ``{"sheet": "vl53l5cx", "ambient_klux": 1, "reflectance": {"ball": 0.1}}``.
        seed: of the device that is drawn, and of its noise.
        engine: of a run; the truth where there is one, where ``None``.
        contact: contact level of that engine; the last one where ``None``.

    Raises:
        UnknownName: no such signal, sheet, engine or level.
        InputError: what the device cannot be, or what does not fit the signal.
    """
    if seed < 0:
        raise InputError("seed", [f"{seed} is below 0; expected a whole number from 0 on"])
    if isinstance(thing, Recording):
        whose, moved = _of_recording(thing, signal)
        wanted = names.widths(moved.signals)
    else:
        if not isinstance(signal, str):
            raise InputError("signal", ["only a recording has its axes in channels; give one name"])
        whose, moved = _moved(thing, engine, contact)
        wanted = names.chosen(signal, names.widths(moved.signals), whose)
    devices = _devices(device, wanted, moved.time_s, seed, thing)
    read = sensing.read_all(devices, [Stored(whose, "", 0, moved)], seed)
    found = sensing.record_of(devices, read, seed)
    assert found is not None
    return Sensed(whose, found, devices, {one.signal: one.reading for one in read})


def _moved(
    thing: Trajectory | Run, engine: str | None, contact: str | None
) -> tuple[str, Trajectory]:
    """A trajectory, and whose it is."""
    if isinstance(thing, Trajectory):
        return thing.source, thing
    wanted = frames.chosen(thing, engine, contact)
    true = [one for one in wanted if not one.contact]
    one = (true or wanted)[0 if true else -1]
    return " ".join(filter(None, (one.source, one.contact))), one.trajectory


def _of_recording(recording: Recording, signal: str | Sequence[str]) -> tuple[str, Trajectory]:
    """Channels as one signal; samples without a value are left out."""
    asked = [signal] if isinstance(signal, str) else list(signal)
    if len(asked) not in (1, 3):
        raise InputError("signal", [f"{len(asked)} channels; expected one, or three for x, y, z"])
    places = [recording.find(name) for name in asked]
    streams = dict.fromkeys(stream for stream, _ in places)
    if len(streams) > 1:
        fault = f"the channels are of several streams ({', '.join(streams)}); expected one"
        raise InputError("signal", [fault])
    stream = recording.streams[places[0][0]]
    values = np.column_stack([stream.channels[name].values for _, name in places])
    known = np.isfinite(values).all(axis=1)
    block: Array = values[known] if len(asked) == 3 else values[known, 0]
    whose = recording.provenance.file
    name = f"{places[0][0].replace('.', '_')}.{places[0][1]}"
    return whose, Trajectory(whose, stream.time_s[known], {name: block})


def _devices(
    device: str | Path | Device | Mapping[str, Any],
    wanted: Mapping[str, int],
    time_s: Array,
    seed: int,
    thing: Thing,
) -> tuple[Drawn, ...]:
    if isinstance(device, Device):
        return tuple(
            DrawnSensor(name, names.unit_of(name), "xyz" if width == 3 else "", device, ())
            for name, width in wanted.items()
        )
    said = device if isinstance(device, Mapping) else {"sheet": str(device)}
    rate_Hz = (len(time_s) - 1) / float(time_s[-1] - time_s[0]) if len(time_s) > 1 else 1.0
    looks = any(map(names.is_zones, wanted.values()))
    scene = _scene_of(thing) if looks and isinstance(thing, Run) else None
    return devices_of(said, wanted, rate_Hz, seed, scene)


def _scene_of(run: Run) -> Scenario:
    """The scenario of a run, in which a range sensor looks.

    Raises:
        SimcompareError: its file is gone, or is another one now.
    """
    file = catalogue.load(str(run.record.scenario_asked or run.record.scenario))
    if run_record.sha256_of(file) != run.record.scenario_sha256:
        raise InputError(str(file.path), ["is not what was run; run it again"])
    return file.resolve(run.record.parameters)
