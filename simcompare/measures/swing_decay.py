"""How fast the swings of something become smaller."""

from __future__ import annotations

import math

from simcompare.measures import OF_PROBE, Measured, Request, _swings
from simcompare.model.trajectory import Trajectory

SERIES = ("turn_time", "amplitude", "amplitude_loss_each", "mean_amplitude")
ROLES: tuple[str, ...] = ()
OPTIONS = ("level", "band")
AXES = {"amplitude": "turn_time", "amplitude_loss_each": "mean_amplitude"}
UNITS = {
    "turn_time": "s",
    "amplitude": OF_PROBE,
    "amplitude_loss_each": OF_PROBE,
    "mean_amplitude": OF_PROBE,
    "log_decrement": "1",
    "amplitude_loss": OF_PROBE,
}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Turning points, and what a full swing takes off their distance from the level.

    Which law the friction follows shows in the loss of each swing over its amplitude: dry friction
    takes the same off every swing (4·F/k of a spring k), viscous friction the same part, the drag
    of the air a part that grows with the amplitude.

    Args:
        trajectory: the source, measured or computed; its times need not be even.
        request: its probe sees what swings; its option ``level`` is where it rests, and ``band``
            what it must leave on both sides to count as swinging.

    Returns:
        Series ``turn_time`` and ``amplitude`` of every turning point between two passages;
        ``amplitude_loss_each``, from each turning point to the next on its side, with the
        ``mean_amplitude`` of the two. Values for one full swing: ``log_decrement``, the natural
        logarithm of the ratio of amplitudes, and ``amplitude_loss``, both from the first and the
        last pair of turning points; ``None`` where there are fewer than four.
    """
    found = _swings.find(
        trajectory.time_s,
        request.seen(trajectory),
        request.options["level"],
        request.options["band"],
    )
    amplitude = found.amplitude
    values: dict[str, float | None] = {"log_decrement": None, "amplitude_loss": None}
    if len(amplitude) >= 4:
        # the mean of both sides, so that a level that is a little off does not count
        first, last = float(amplitude[:2].mean()), float(amplitude[-2:].mean())
        swings = (len(amplitude) - 2) / 2
        values = {
            "log_decrement": math.log(first / last) / swings,
            "amplitude_loss": (first - last) / swings,
        }
    return Measured(
        values=values,
        series={
            "turn_time": found.turn_s,
            "amplitude": amplitude,
            "amplitude_loss_each": amplitude[:-2] - amplitude[2:],
            "mean_amplitude": (amplitude[:-2] + amplitude[2:]) / 2,
        },
        units=UNITS,
        notes=() if len(amplitude) >= 4 else ("makes too few swings to tell their decay",),
    )


def against(measured: Measured, truth: Measured) -> dict[str, tuple[float | None, float]]:
    """What is judged: both losses of a swing, over the turning points that both have in common."""
    ours, theirs = measured.series["amplitude"], truth.series["amplitude"]
    common = min(len(ours), len(theirs))
    if truth.values["log_decrement"] is None:
        return {}
    if common < 4:
        return {name: (None, float(truth.values[name] or 0.0)) for name in truth.values}
    found: dict[str, tuple[float | None, float]] = {}
    swings = (common - 2) / 2
    pairs = [(float(a[:2].mean()), float(a[common - 2 : common].mean())) for a in (ours, theirs)]
    decrements = [math.log(first / last) / swings for first, last in pairs]
    losses = [(first - last) / swings for first, last in pairs]
    found["log_decrement"] = (decrements[0], decrements[1])
    found["amplitude_loss"] = (losses[0], losses[1])
    return found
