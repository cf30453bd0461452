"""When something hit: onsets of short sounds in a waveform, to well below a millisecond.

Four steps, each as simple as it can be:

1. the waveform is high-passed (hum and handling noise leave, an onset stays where it is);
2. an impact is where the energy of the next millisecond exceeds the noise and all that was
   heard shortly before, so that neither ringing nor an echo counts again;
3. its onset is the sample at which the likelihood changes best from noise to sound, moved to
   where the rising edge leaves zero;
4. impacts of one recording sound alike: each is shifted over their mean until it fits best.
   This uses the whole sound, not its first moment alone, and leaves one delay common to all.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simcompare.model.trajectory import Array

#: below this there is hum, wind and handling noise, no impact [Hz]
HIGH_PASS_HZ = 200.0
#: time over which the energy of an impact is summed [s]
ENERGY_S = 1e-3
#: time before an impact with which it is compared [s]
BEFORE_S = 4e-3
#: longer time before it: what comes again so fast is buzz or rattle, unless it is louder
BUZZ_S, OVER_BUZZ = 0.025, 1.5
#: no second impact is looked for within this time: echoes in a room come earlier [s]
ECHO_S = 0.03
#: chance that noise alone exceeds the threshold within one ``ENERGY_S``
BY_CHANCE, TAIL = 1e-9, 1.5
#: energy of an impact against the loudest part of what was heard before it
OVER_BEFORE = 4.0
#: an impact is refined with the mean of all where it correlates with that at least so well
ALIKE = 0.8
#: length of the sound that is compared, before and after the onset [s]
_LEAD_S, _BODY_S = 5e-4, 6e-3
#: how far the first estimate of an onset may be off [s]
_REACH_S = 4e-4
#: steps within a sample at which sounds are laid over each other
_FINER = 8
#: what is left of rounding to samples after that, measured on sounds with a sharp edge
_U_SAMPLES = 0.12
#: impacts that are correlated together
_ROWS = 64
#: so many impacts at least must sound alike before their mean is used
_MIN_ALIKE = 3
#: samples that are analysed together
_CHUNK = 1 << 18

Spectra = NDArray[np.complex128]
#: gives samples first … last-1 of the waveform
Samples = Callable[[int, int], Array]


@dataclass(frozen=True)
class Onset:
    """One impact.

    Attributes:
        time_s: when it began, counted from the first sample.
        u_s: standard uncertainty of ``time_s``, without the delay that all onsets share.
        peak: largest absolute value of the waveform in it.
        alike: correlation with the mean of all impacts, 0 where it was not used.
    """

    time_s: float
    u_s: float
    peak: float
    alike: float


@dataclass(frozen=True)
class _Coarse:
    """An impact before refinement: its sound, and where the sound begins."""

    first: int
    sound: Array
    begin: float
    noise: float
    peak: float


def onsets(samples: Samples, count: int, rate_Hz: float, floor: float = 0.0) -> list[Onset]:
    """All impacts in a waveform.

    Args:
        samples: reads a piece of the waveform.
        count: length of the waveform.
        rate_Hz: samples in a second.
        floor: noise that is there even in digital silence (rms), such as that of rounding.
    """
    impacts = list(_coarse(samples, count, rate_Hz, floor))
    if not impacts:
        return []
    times, u, alike = _aligned(impacts, rate_Hz)
    return [
        Onset(float(t / rate_Hz), float(s / rate_Hz), c.peak, float(a))
        for t, s, c, a in zip(times, u, impacts, alike, strict=True)
    ]


def _coarse(samples: Samples, count: int, rate_Hz: float, floor: float) -> Iterator[_Coarse]:
    before = round(0.05 * rate_Hz)
    after = round(0.1 * rate_Hz)
    last = -math.inf
    for start in range(0, count, _CHUNK):
        first, end = max(0, start - before), min(count, start + _CHUNK + after)
        raw = samples(first, end)
        heard = high_passed(raw, rate_Hz)
        energy = _forward_energy(heard, rate_Hz)
        power, most = noise_power(energy[:: max(1, round(ENERGY_S * rate_Hz / 4))])
        noise = math.sqrt(max(power, floor**2))
        for peak in _peaks(energy, most * noise**2, rate_Hz, last - first):
            if not start <= first + peak < start + _CHUNK:
                continue
            last = first + peak
            yield _cut(raw, heard, peak, noise, first, rate_Hz)


def high_passed(raw: Array, rate_Hz: float) -> Array:
    """The waveform without what is slow, and with zero for what is missing."""
    from scipy import signal

    sos = signal.butter(2, min(HIGH_PASS_HZ, rate_Hz / 8), "highpass", fs=rate_Hz, output="sos")
    complete = np.nan_to_num(raw, nan=0.0, posinf=0.0, neginf=0.0)
    # the filter starts as if the first values had been there for ever: no step, no false impact
    level = (
        float(complete[: max(1, round(5 * ENERGY_S * rate_Hz))].mean()) if len(complete) else 0.0
    )
    start = signal.sosfilt_zi(sos) * level
    return np.asarray(signal.sosfilt(sos, complete, zi=start)[0])


def _forward_energy(heard: Array, rate_Hz: float) -> Array:
    """Mean square of the next ``ENERGY_S`` at each sample."""
    width = max(8, round(ENERGY_S * rate_Hz))
    total = np.concatenate(([0.0], np.cumsum(heard * heard), np.zeros(width)))
    total[len(heard) + 1 :] = total[len(heard)]
    return (total[width:-1] - total[: len(heard)]) / width


def noise_power(energy: Array) -> tuple[float, float]:
    """Mean square of the noise, and how many times this noise alone may reach by chance.

    The energy of noise over a short time is distributed as chi squared with as many degrees of
    freedom as its band has room for in that time: many for hiss, two for a hum. How far its
    quartiles lie apart tells their number. Short impacts leave quartiles alone.
    """
    from scipy import optimize, stats

    heard = energy[energy > 0]
    if len(heard) < 4:
        return 0.0, 1.0
    low, mid, high = np.quantile(heard, (0.25, 0.5, 0.75))

    def apart(log_degrees: float) -> float:
        degrees = math.exp(log_degrees)
        return math.log(float(stats.chi2.ppf(0.75, degrees) / stats.chi2.ppf(0.25, degrees)))

    wanted = math.log(high / low)
    limits = math.log(1.5), math.log(500.0)
    if wanted <= apart(limits[1]):
        degrees = 500.0
    elif wanted >= apart(limits[0]):
        degrees = 1.5
    else:
        degrees = math.exp(optimize.brentq(lambda x: apart(x) - wanted, *limits, xtol=1e-3))
    power = float(mid) * degrees / float(stats.chi2.median(degrees))
    # bands of different loudness together have longer tails than the quartiles tell
    most = float(stats.chi2.isf(BY_CHANCE, degrees)) / degrees
    return power, 1 + TAIL * (most - 1)


def _peaks(energy: Array, threshold: float, rate_Hz: float, last: float) -> Iterator[int]:
    """Samples at which the energy of an impact is largest, seldom exactly its onset."""
    width = max(8, round(ENERGY_S * rate_Hz))
    near = _largest_before(energy, width, round(BEFORE_S * rate_Hz))
    far = _largest_before(energy, width, round(BUZZ_S * rate_Hz))
    needed = threshold + OVER_BEFORE * np.maximum(near - threshold, 0.0)
    risen = energy > np.maximum(needed, OVER_BUZZ * far)
    dead = round(ECHO_S * rate_Hz)
    places = np.flatnonzero(risen)
    position = 0
    while position < len(places):
        begin = int(places[position])
        if begin - last >= dead:
            peak = begin + int(np.argmax(energy[begin : begin + 2 * width]))
            yield peak
            last = peak
        position = int(np.searchsorted(places, max(begin + 1, last + dead)))


def _largest_before(energy: Array, width: int, back: int) -> Array:
    """Largest energy among the ``back`` windows that ended before each sample."""
    from scipy import ndimage

    behind = ndimage.maximum_filter1d(energy, back, origin=back // 2 - (1 - back % 2))
    return np.concatenate((np.zeros(width), behind))[: len(energy)]


def _cut(raw: Array, heard: Array, peak: int, noise: float, first: int, rate_Hz: float) -> _Coarse:
    """The sound of one impact and its first onset, in samples of the waveform."""
    width = max(8, round(ENERGY_S * rate_Hz))
    lead, body = round(0.003 * rate_Hz), round((_BODY_S + 0.003) * rate_Hz)
    low, high = max(0, peak - lead), min(len(heard), peak + body)
    sound = heard[low:high].copy()
    begin = begins(sound, noise, peak - low, width)
    rise = low + math.floor(begin)
    near = raw[rise : max(rise, peak) + round(0.005 * rate_Hz) + 1]
    loudest = float(np.nanmax(np.abs(near), initial=0.0))
    return _Coarse(first + low, sound, begin, noise, loudest)


def begins(sound: Array, noise: float, guess: int, width: int) -> float:
    """Where a sound begins, to a fraction of a sample.

    Before its first sample there is noise of known power, after it sound of unknown power: the
    log-likelihood of each split is compared. From there the edge is followed back to zero.
    """
    end = min(len(sound), guess + width)
    square = sound[:end] ** 2
    power = max(noise**2, 1e-30)
    after = np.cumsum(square[::-1])[::-1]
    remaining = np.arange(end, 0, -1)
    mean = np.maximum(after / remaining, power)
    # log-likelihood of "sound from here on" against "noise all along"
    gain = 0.5 * (after / power - remaining * (1 + np.log(mean / power)))
    split = int(np.argmax(gain))
    return _edge(sound, noise, split, width)


def _edge(sound: Array, noise: float, split: int, width: int) -> float:
    """Where the straight line through a rising edge leaves zero."""
    near = sound[split : split + width]
    level = max(3 * noise, 0.25 * float(np.abs(near).max(initial=0.0)))
    over = np.flatnonzero(np.abs(near) >= level)
    if not len(over) or level <= 0:
        return float(split)
    top = int(over[0])
    wave = near[top:] * np.sign(near[top])
    turned = np.flatnonzero(wave <= 0)
    crest = int(np.argmax(wave[: int(turned[0])] if len(turned) else wave))
    # two samples alone may rise little by chance; the whole half-wave tells how steep it is
    below = sound[split + top - 1] * np.sign(near[top]) if split + top else 0.0
    slope = max(wave[0] - below, wave[crest] / (crest + 1))
    return float(max(split + top - wave[0] / slope, split - 0.2 * width, 0.0))


def _aligned(impacts: list[_Coarse], rate_Hz: float) -> tuple[Array, Array, Array]:
    """Onsets, their standard uncertainties [samples] and their likeness to the mean sound."""
    reach = max(2, round(_REACH_S * rate_Hz))
    lead, body = round(_LEAD_S * rate_Hz), round(_BODY_S * rate_Hz)
    starts = np.array([math.floor(c.begin) - lead - reach for c in impacts])
    size = lead + body + 2 * reach
    rows = np.array([_excerpt(c.sound, int(s), size) for c, s in zip(impacts, starts, strict=True)])
    own_onset = np.array([c.first + c.begin for c in impacts])
    noise = np.array([c.noise for c in impacts])
    u_own = np.array([_u_of_edge(c, rate_Hz) for c in impacts])
    if len(impacts) < _MIN_ALIKE:
        return own_onset, u_own, np.zeros(len(impacts))
    mean, shift, alike, u = _mean_sound(rows, noise, reach)
    quiet = float(np.median(noise)) / math.sqrt(len(impacts))
    begin = begins(mean, quiet, lead + reach, max(8, round(ENERGY_S * rate_Hz)))
    fitted = np.array([c.first for c in impacts]) + starts + shift + begin
    good = alike > 0
    good &= np.count_nonzero(good) >= _MIN_ALIKE
    return np.where(good, fitted, own_onset), np.where(good, u, u_own), np.where(good, alike, 0.0)


def _excerpt(sound: Array, start: int, size: int) -> Array:
    piece = np.zeros(size)
    low, high = max(0, start), min(len(sound), start + size)
    piece[low - start : high - start] = sound[low:high]
    return piece


def _u_of_edge(coarse: _Coarse, rate_Hz: float) -> float:
    """Noise over the steepness of the first rise; at least what rounding to a sample leaves."""
    begin = math.floor(coarse.begin)
    rise = np.abs(coarse.sound[begin : begin + max(8, round(ENERGY_S * rate_Hz))])
    steep = float(np.max(np.diff(rise), initial=0.0))
    return math.hypot(coarse.noise / steep if steep > 0 else 1.0, 1 / math.sqrt(12))


def _mean_sound(rows: Array, noise: Array, reach: int) -> tuple[Array, Array, Array, Array]:
    """The mean sound and, for each row, its shift, its likeness (0: another sound), and u."""
    size = rows.shape[1]
    total = np.sum(rows**2, axis=1)
    energy = np.maximum(total - size * noise**2, 0.1 * total)
    # what noise adds to the energy, with all that it may add by chance
    chance = size * noise**2 * (1 + 4 * math.sqrt(2 / size))
    spectra = np.fft.rfft(rows, 2 * size, axis=1)
    lags = np.arange(-reach * _FINER, reach * _FINER + 1)
    mean = rows[_most_typical(spectra, energy, lags, size)]
    for _ in range(4):
        power = max(float(mean @ mean), 1e-300)
        shift, best = _crests(spectra, np.fft.rfft(mean, 2 * size), lags)
        fit = best / power
        explained = best * fit
        same = (best > 0) & (total - explained <= chance + (1 / ALIKE**2 - 1) * explained)
        use = np.where(same, fit, 0.0)
        if not same.any():
            break
        mean = use @ _shifted(spectra, -shift, size) / (use @ use)
    rest = np.sqrt(np.mean((_shifted(spectra, -shift, size) - fit[:, None] * mean) ** 2, axis=1))
    # the mean has noise of its own, whose steepness says nothing of the sound
    noise_energy = size / 2 * float(np.median(rest)) ** 2 / max(float(use @ use), 1e-300)
    steep = float(np.sum(np.gradient(mean) ** 2))
    steep = math.sqrt(max(steep - noise_energy, 0.05 * steep, 1e-30))
    u = np.hypot(rest / (np.maximum(np.abs(fit), 1e-12) * steep), _U_SAMPLES)
    alike = np.clip(best / np.sqrt(energy * power), 1e-3, 1.0)
    return mean, shift, np.where(same, alike, 0.0), u


def _most_typical(spectra: Spectra, energy: Array, lags: NDArray[np.int64], size: int) -> int:
    """The row that fits best to all others; a knock of another kind is no model."""
    loud = np.argsort(energy)[::-1][:20]
    score = [
        float(np.median(
            _crests(spectra, spectra[i], lags)[1] / np.sqrt(energy * energy[i])
        ))
        for i in loud
    ]  # fmt: skip
    # nearly as typical and louder is better: less noise in it
    best = max(score)
    return int(next(i for i, s in zip(loud, score, strict=True) if s >= best - 0.02))


def _crests(spectra: Spectra, other: Spectra, lags: NDArray[np.int64]) -> tuple[Array, Array]:
    """Shift [samples] at which each row correlates best with one sound, and that correlation."""
    # zeros beyond the highest frequency: a crest between two samples is not lost, else the one
    # a period beside it might look higher
    length = 2 * (spectra.shape[1] - 1) * _FINER
    shift, best = np.empty(len(spectra)), np.empty(len(spectra))
    for start in range(0, len(spectra), _ROWS):
        part = slice(start, start + _ROWS)
        product = np.fft.irfft(spectra[part] * np.conj(other), length, axis=1)[:, lags] * _FINER
        shift[part], best[part] = _top(product, lags)
    return shift, best


def _top(product: Array, lags: NDArray[np.int64]) -> tuple[Array, Array]:
    """Place and height of the highest value of each row, by a parabola through three."""
    at = np.clip(np.argmax(product, axis=1), 1, len(lags) - 2)
    row = np.arange(len(product))
    left, mid, right = product[row, at - 1], product[row, at], product[row, at + 1]
    bend = left - 2 * mid + right
    offset = np.where(bend < 0, 0.5 * (left - right) / np.where(bend < 0, bend, 1.0), 0.0)
    offset = np.clip(offset, -1, 1)
    return (lags[at] + offset) / _FINER, mid - 0.25 * (left - right) * offset


def _shifted(spectra: Spectra, shift: Array, size: int) -> Array:
    """Rows moved to the right by a fraction of a sample."""
    frequency = np.fft.rfftfreq(2 * size)
    turned = spectra * np.exp(-2j * np.pi * frequency * shift[:, None])
    return np.fft.irfft(turned, axis=1)[:, :size]
