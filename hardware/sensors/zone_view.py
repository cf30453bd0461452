"""What a range sensor of a scenario looks at, over a trajectory: rays, surfaces, reflectances."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from simcompare.engine.kinematics import placed_on
from simcompare.engine.ray_scene import RayScene
from simcompare.engine.rays import Hits
from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors.multizone import Frames, Multizone, View
from simcompare.model.rotations import rotate
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array, Trajectory

Indices = NDArray[np.int_]
#: of bodies of which none is said: the white target of the data sheet
WHITE = 0.88


def view(
    device: Multizone,
    scenario: Scenario,
    sensor: str,
    signals: Mapping[str, Array],
    reflectance: Mapping[str, float] | None = None,
    in_a_row: int = 5,
) -> View:
    """What the rays of a sensor meet, by our own casting.

    Args:
        device: whose rays they are.
        scenario: the scene.
        sensor: name of a sensor that looks.
        signals: position and orientation of all moving bodies, in n samples.
        reflectance: of bodies at the sensor's wavelength, 0 to 1; white where none is said.
        in_a_row: rays in a row of a zone, and rows of them.

    Raises:
        UnknownName: no such sensor, or no such body.
        InputError: a reflectance that cannot be.
    """
    looking = scenario.range_sensors()
    if sensor not in looking:
        raise UnknownName(f"range sensor of {scenario.name}", sensor, looking)
    own = looking[sensor]
    count = next((len(values) for values in signals.values()), 1)
    place, turn = placed_on(scenario, own, count, signals)
    rays = device.rays(in_a_row).reshape(-1, 3)
    lengths = np.linalg.norm(rays, axis=1)
    along = rotate(np.repeat(turn, len(rays), 0), np.tile(rays / lengths[:, None], (count, 1)))
    along = along.reshape(count, -1, 3)
    seen = RayScene(scenario, own.body or "")
    hits = seen.cast(place, along, signals)
    matt = np.array([*_reflectances(seen, scenario, reflectance or {}), 0.0])
    return seen_by(hits, along, lengths, matt, device.zones)


def seen_by(hits: Hits, along: Array, lengths: Array, matt: Array, zones: int = 8) -> View:
    """What rays meet, as a sensor needs it.

    Args:
        hits: of n frames with k rays, or of k rays for a single frame.
        along: unit vectors (n, k, 3) or (k, 3).
        lengths: of these rays until x = 1 m in the sensor's frame (k,).
        matt: reflectance of what ``hits.index`` counts, and 0 for nothing at the end.
        zones: in a row.
    """
    cosine = -np.einsum("...ki,...ki->...k", hits.normal, along)
    shape = (-1, zones**2, along.shape[-2] // zones**2)
    return View(
        (hits.distance_m / lengths).reshape(shape), cosine.reshape(shape),
        matt[hits.index].reshape(shape),
    )  # fmt: skip


def frames(
    device: Multizone,
    scenario: Scenario,
    sensor: str,
    trajectory: Trajectory,
    generator: np.random.Generator,
    reflectance: Mapping[str, float] | None = None,
) -> tuple[Array, Frames]:
    """What a device tells over a trajectory, a frame for each of its periods.

    The scene of a frame is that of the sample nearest to the middle of its period.

    Returns:
        Times at which frames are told (m,) [s], and the frames.

    Raises:
        InputError: the trajectory is shorter than a period.
    """
    period_s, time_s = 1 / device.rate_Hz, trajectory.time_s
    count = int((time_s[-1] - time_s[0]) / period_s * (1 + 1e-12) + 1e-9)
    if count < 1:
        length = f"{time_s[-1] - time_s[0]:g} s are no whole frame of {period_s:.4g} s"
        raise InputError(f"range sensor {sensor}", [f"{length}; simulate for longer"])
    told = time_s[0] + period_s * np.arange(1, count + 1)
    middle = told - device.latency_s
    samples = nearest(time_s, middle)
    poses = {
        f"{name}.{part}": trajectory.signals[f"{name}.{part}"][samples]
        for name in scenario.moving_bodies()
        for part in ("position_m", "orientation_wxyz")
    }
    poses = poses or {"": samples.astype(float)}
    looked = view(device, scenario, sensor, poses, reflectance)
    return told, device.read(looked, generator)


def nearest(time_s: Array, at_s: Array) -> Indices:
    """The samples (m,) nearest to some instants, of increasing times (n,) [s]."""
    after = np.searchsorted(time_s, at_s).clip(1, len(time_s) - 1)
    is_before = at_s - time_s[after - 1] <= time_s[after] - at_s
    return np.where(is_before, after - 1, after)


def _reflectances(seen: RayScene, scenario: Scenario, said: Mapping[str, float]) -> list[float]:
    for name, value in said.items():
        if name not in scenario.bodies:
            raise UnknownName(f"body of {scenario.name}", name, scenario.bodies)
        if not 0 <= value <= 1:
            raise InputError(f"reflectance of {name}", [f"{value:g}; expected 0 to 1"])
    return [said.get(name, WHITE) for name in seen.bodies]
