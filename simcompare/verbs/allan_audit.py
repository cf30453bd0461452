"""The audit of ``allan``: is a stream the noise of a sensor, and of which?"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from simcompare import units
from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors.data_sheet import DataSheet, Part
from simcompare.model.trajectory import Array
from simcompare.results.records.allan import AxisNoise, Finding, NoiseTerm
from simcompare.statistics import allan_bounds, allan_covariance, noise_audit
from simcompare.statistics.noise_audit import Told
from simcompare.verbs.allan_stretch import Stretch

#: part of all clean streams in which an audit finds a fault by chance
FALSE_ALARMS = 0.02
#: what a simulator may claim of its noise -> what it is
CLAIMS = {
    "density": "one-sided noise density, in SI per √Hz",
    "bias": "standard deviation of the bias process, in SI",
    "bias_time": "its correlation time, in s",
}
_GRAVITY, _ACCELERATION = 9.80665, "m/s**2"
#: a mean of that size, but for offsets, is one of 1 g; and counts are alike to so much
_NEARLY_ONE, _ALIKE = 0.2, 0.05


def findings(
    stretch: Stretch, axes: Sequence[AxisNoise], sheet: DataSheet | None,
    claims: Mapping[str, float], again: tuple[Stretch, Sequence[AxisNoise]] | None,
    silent: Sequence[str] = (),
) -> tuple[Finding, ...]:  # fmt: skip
    """All tests, corrected for how many they are; faults first."""
    quiet = Told(0.0, "there is no noise at all: every reading is the same")
    made = [_finding("noise", name, quiet) for name in silent]
    made += [*_alone(stretch), *_claimed(axes, claims)]
    if sheet is not None:
        made += _beside(stretch, sheet)
    if again is not None:
        made += _twice(stretch, axes, *again)
    fails = noise_audit.holm([one.p for one in made], FALSE_ALARMS)
    judged = [replace(one, fault=fault) for one, fault in zip(made, fails, strict=True)]
    return tuple(sorted(judged, key=lambda one: (not one.fault, one.p)))


def refuse_claims_of_several(claims: Mapping[str, float], stretch: Stretch) -> None:
    """A size that is claimed is of one kind of sensor.

    Raises:
        InputError: the channels are of several units.
    """
    measured = list(dict.fromkeys(units.symbol(stretch.units[name]) for name in stretch.values))
    if len(measured) > 1 and set(claims) - {"bias_time"}:
        names = ", ".join(stretch.values)
        raise InputError(
            "--claim",
            [
                f"the channels are in {' and '.join(measured)}, and a claim is of one unit; choose "
                f"with --channel what it is of ({names})"
            ],
        )


def checked_claims(claims: Mapping[str, float]) -> None:
    """Refuses claims that mean nothing.

    Raises:
        UnknownName: a claim that is not known.
        InputError: a number that is not above 0, or half of what a bias process needs.
    """
    for name, value in claims.items():
        if name not in CLAIMS:
            raise UnknownName("claim", name, CLAIMS)
        if not 0 < value < math.inf:
            raise InputError("--claim", [f"{name}={value:g}: expected a number above 0"])
    if ("bias" in claims) != ("bias_time" in claims):
        raise InputError("--claim", ["a bias process has both bias and bias_time; give both"])


def _finding(test: str, channel: str, told: Told) -> Finding:
    return Finding(test, channel, False, told.p, told.text)


def _alone(stretch: Stretch) -> Iterator[Finding]:
    """What a stream tells by itself."""
    for name, values in stretch.values.items():
        shape = noise_audit.normal(values)
        if shape is not None:
            yield _finding("normal numbers", name, shape)
        yield _finding("no repetition", name, noise_audit.repeated(values))
        yield _finding("fresh readings", name, noise_audit.held(values))
    for one, other in itertools.combinations(stretch.values, 2):
        told = noise_audit.same_numbers(stretch.values[one], stretch.values[other])
        yield _finding("independent axes", f"{one}, {other}", told)
    yield from _gravity(stretch, 0.5)


def _gravity(stretch: Stretch, u: float) -> Iterator[Finding]:
    """Whether three axes at rest feel their own weight; u is that of an offset."""
    from scipy import stats

    means = [
        float(values.mean()) for name, values in stretch.values.items()
        if stretch.units[name] == _ACCELERATION
    ]  # fmt: skip
    if len(means) == 3:
        size = math.sqrt(sum(mean * mean for mean in means))
        text = f"gravity is missing (at rest the size of the specific force is {size:.2g} m/s²)"
        if abs(size - 1) < _NEARLY_ONE:
            text = f"readings are in g, not in m/s² (at rest their size is {size:.3g})"
        p = 2 * float(stats.norm.sf(abs(size - _GRAVITY) / (2 * u)))
        # a sensor that is badly calibrated is none without gravity
        yield Finding("gravity", "", False, p if size < _GRAVITY / 2 else 1.0, text)


def _beside(stretch: Stretch, sheet: DataSheet) -> Iterator[Finding]:
    """What a data sheet says that the stream must show."""
    for unit in dict.fromkeys(stretch.units.values()):
        part = sheet.part_for(unit)
        names = [name for name in stretch.values if stretch.units[name] == unit]
        if part is None:
            continue
        for name in names:
            yield from _ranges(name, stretch.values[name], part)
        yield from _offset(stretch, names, part)


def _ranges(name: str, values: Array, part: Part) -> Iterator[Finding]:
    """Whether readings are whole counts of one of the ranges, and stay inside it."""
    step = noise_audit.smallest_step(values)
    counts = sorted(one.count for one in part.ranges.values() if one.count > 0)
    alike = [
        one for one in part.ranges.values() if one.count and abs(step / one.count - 1) < _ALIKE
    ]
    if counts:
        text = f"readings are not quantised; {part.sheet} gives whole counts"
        if step > 0:
            text = f"readings have other counts than {part.sheet}"
            text += f" (steps of {step:.3g}; the finest range has {counts[0]:.3g})"
        yield Finding("quantisation", name, False, 1.0 if alike else 0.0, text)
    full_scale = max(one.full_scale for one in alike or part.ranges.values())
    beyond = float(np.abs(values).max()) > 1.001 * full_scale
    text = f"readings go beyond the range of {part.sheet}; nothing saturates"
    yield Finding("saturation", name, False, 0.0 if beyond else 1.0, text)


def _offset(stretch: Stretch, names: Sequence[str], part: Part) -> Iterator[Finding]:
    """Whether a bias was ever added: means as near to those of no bias as chance hardly brings.

    An accelerometer without one that stands upright reads gravity on one axis and 0 on the others.
    """
    from scipy import stats

    sizes = [e.distribution.u for e in part.terms.values() if e.term == "offset" and e.used]
    if not sizes or (part.unit == _ACCELERATION and len(names) < 3):
        return
    means = np.array([stretch.values[name].mean() for name in names])
    if part.unit == _ACCELERATION:
        up = int(np.argmax(np.abs(means)))
        means[up] -= math.copysign(_GRAVITY, means[up])
    near = []
    for name, mean in zip(names, means.tolist(), strict=True):
        values = stretch.values[name]
        limit = max(abs(mean), 3 * float(values.std()) / math.sqrt(len(values)))
        near.append(math.erf(limit / (min(sizes) * math.sqrt(2))))
    # the product of as many uniform numbers (R. A. Fisher, 1932)
    p = float(stats.combine_pvalues(near).pvalue)
    what = "0 or gravity" if part.unit == _ACCELERATION else "0"
    text = f"no bias is added, where {part.sheet} has offsets (all means are {what})"
    yield Finding("offset", ", ".join(names), False, p, text)


def _claimed(axes: Sequence[AxisNoise], claims: Mapping[str, float]) -> Iterator[Finding]:
    """Whether noise is what the simulator says that it adds."""
    for axis in axes:
        if "density" in claims:
            yield _density(axis, axis.term("N"), claims["density"])
        if "bias_time" in claims:
            yield from _process(axis, claims["bias"], claims["bias_time"])


def _density(axis: AxisNoise, white: NoiseTerm, claimed: float) -> Finding:
    if white.value is None or white.u is None:
        text = f"there is less white noise than is claimed (below {2**0.5 * white.limit:.3g})"
        # half of a normal distribution, of which the limit is the 95 % quantile of one side
        z = 1.645 * claimed / (2**0.5 * white.limit)
        return Finding("claimed density", axis.channel, False, _chance(z), text)
    found = 2**0.5 * white.value
    text = f"there is {_more(found, claimed)} white noise than is claimed"
    text += f" ({found / claimed:.3g} times its density)"
    return Finding("claimed density", axis.channel, False,
                   _chance((found - claimed) / (2**0.5 * white.u)), text)  # fmt: skip


def _process(axis: AxisNoise, sigma: float, time_s: float) -> Iterator[Finding]:
    """The bias process that is claimed: its size and its time."""
    seen = axis.gauss_markov
    if seen is not None and math.isfinite(seen.u_time_s):
        z = math.log(seen.time_s / time_s) * seen.time_s / seen.u_time_s
        than = "longer" if seen.time_s > time_s else "shorter"
        text = f"the bias has a {than} correlation time than is claimed"
        text += f" ({seen.time_s:.3g} s instead of {time_s:g} s)"
        yield Finding("claimed bias time", axis.channel, False, _chance(z), text)
        z = math.log(seen.sigma / sigma) * seen.sigma / seen.u_sigma
        text = f"the bias wanders by {_more(seen.sigma, sigma)} than is claimed"
        text += f" ({seen.sigma / sigma:.3g} times)"
        yield Finding("claimed bias size", axis.channel, False, _chance(z), text)
    else:
        yield _unseen(axis, sigma, time_s)


def _unseen(axis: AxisNoise, sigma: float, time_s: float) -> Finding:
    """A bias process that should be seen at some averaging time, and is at none."""
    from scipy import stats

    interval = axis.tau_s[0]
    m = np.round(np.array(axis.tau_s) / interval)
    kernel = allan_covariance.gauss_markov(time_s / interval)
    white = (axis.term("N").value or 0.0) ** 2 / np.array(axis.tau_s)
    expected = sigma**2 * allan_covariance.shape(kernel, m) + white
    observed = np.array(axis.deviation) ** 2
    freedom = np.array([
        allan_bounds.edf("oadev", -2, int(one), axis.samples) for one in m.tolist()
    ])  # fmt: skip
    rows = np.atleast_1d(stats.chi2.cdf(freedom * observed / expected, freedom))
    p = min(1.0, len(rows) * float(rows.min()))
    text = f"the bias process that is claimed is not seen ({sigma:.3g} with {time_s:g} s)"
    return Finding("claimed bias", axis.channel, False, p, text)


def _twice(
    stretch: Stretch, axes: Sequence[AxisNoise], other: Stretch, others: Sequence[AxisNoise]
) -> Iterator[Finding]:
    """Two runs of one simulator: other numbers each time, and noise that knows the rate."""
    for name in stretch.values.keys() & other.values.keys():
        one, two = stretch.values[name], other.values[name]
        count = min(len(one), len(two))
        same = count > 0 and bool((one[:count] == two[:count]).all())
        text = "two runs give the same numbers to the last bit; the seed is fixed"
        yield Finding("other numbers each run", name, False, 0.0 if same else 1.0, text)
    if abs(math.log(stretch.rate_Hz / other.rate_Hz)) > math.log(1.2):
        by_name = {axis.channel: axis for axis in others}
        for axis in axes:
            if axis.channel in by_name:
                yield _scaling(axis, by_name[axis.channel], stretch.rate_Hz / other.rate_Hz)


def _scaling(one: AxisNoise, other: AxisNoise, rates: float) -> Finding:
    """Whether the density stays while the rate changes."""
    a, b = one.term("N"), other.term("N")
    if not (a.value and a.u and b.value and b.u):
        return Finding("noise knows the rate", one.channel, False, 1.0, "")
    log = math.log(a.value / b.value)
    z = log / math.hypot(a.u / a.value, b.u / b.value)
    per_sample = abs(log + 0.5 * math.log(rates)) < abs(log) / 3
    text = "noise density changes with the rate"
    if per_sample:
        text = "the same standard deviation is added to each reading at any rate"
    text += f" (the density changes {math.exp(abs(log)):.3g} times)"
    return Finding("noise knows the rate", one.channel, False, _chance(z), text)


def _more(found: float, claimed: float) -> str:
    return "more" if found > claimed else "less"


def _chance(z: float) -> float:
    from scipy import stats

    return 2 * float(stats.norm.sf(abs(z)))
