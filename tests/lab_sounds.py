"""Sounds that a student may send to the lab."""

from __future__ import annotations

from pathlib import Path

import numpy as np

RATE_HZ = 48000
GRAVITY = 9.80665


def ball(height_m: float = 0.4, restitution: float = 0.8, count: int = 8, seed: int = 1):
    """A ball of one restitution: clicks at its impacts in quiet noise, as samples."""
    random = np.random.default_rng(seed)
    fall = np.sqrt(2 * height_m / GRAVITY)
    times = 0.2 + fall + np.concatenate(
        ([0.0], np.cumsum(2 * fall * restitution ** np.arange(1, count)))
    )  # fmt: skip
    clock = np.arange(round((times[-1] + 0.4) * RATE_HZ)) / RATE_HZ
    sound = random.normal(0, 1e-4, len(clock))
    for number, time in enumerate(times):
        later = np.maximum(clock - time, 0)
        click = np.exp(-later / 2e-3) * np.sin(2 * np.pi * 3000 * later)
        sound += 0.5 * restitution**number * click
    return sound


def together(*sounds):
    """Sounds one over the other, each 0.1 s later than the one before."""
    late = RATE_HZ // 10
    made = np.zeros(max(len(sound) + i * late for i, sound in enumerate(sounds)))
    for i, sound in enumerate(sounds):
        made[i * late : i * late + len(sound)] += sound
    return made


def music(seconds: float = 4.0):
    """A chord every half second."""
    clock = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    beat = np.exp(-6 * (clock % 0.5))
    return sum(0.2 * np.sin(2 * np.pi * pitch * clock) * beat for pitch in (440, 554, 659))


def speech(seconds: float = 4.0, seed: int = 2):
    """Syllables: noise that swells and ebbs."""
    random = np.random.default_rng(seed)
    clock = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    loud = sum(
        np.exp(-(((clock - at) / width) ** 2))
        for at, width in zip(random.uniform(0.2, seconds, 14), random.uniform(0.05, 0.2, 14),
                             strict=True)
    )  # fmt: skip
    return 0.1 * loud * random.normal(0, 1, len(clock))


def silence(seconds: float = 2.0):
    """A microphone that is muted."""
    return np.zeros(round(seconds * RATE_HZ))


def write(path: Path, sound, **more) -> Path:
    """Stores a sound as WAV."""
    import soundfile

    soundfile.write(path, sound, RATE_HZ, **more)
    return path
