"""How fast the swings of something become smaller."""

from __future__ import annotations

import math

from simcompare.measures import OF_PROBE, Measured, Pairs, Request, _swings
from simcompare.model.trajectory import Array, Trajectory

SERIES = ("turn_time", "amplitude", "amplitude_loss_each", "mean_amplitude")
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
    swings = _swings.of(trajectory, request)
    amplitude = swings.amplitude
    return Measured(
        values=_losses(amplitude),
        series={
            "turn_time": swings.turn_s,
            "amplitude": amplitude,
            "amplitude_loss_each": amplitude[:-2] - amplitude[2:],
            "mean_amplitude": (amplitude[:-2] + amplitude[2:]) / 2,
        },
        notes=() if len(amplitude) >= 4 else ("makes too few swings to tell their decay",),
    )


def against(measured: Measured, truth: Measured) -> Pairs:
    """What is judged: both losses of a swing, over the turning points that both have in common."""
    ours, theirs = measured.series["amplitude"], truth.series["amplitude"]
    common = min(len(ours), len(theirs))
    if truth.values["log_decrement"] is None:
        return {}
    losses, true = _losses(ours[:common]), truth.values if common < 4 else _losses(theirs[:common])
    return {name: (losses[name], float(true[name] or 0.0)) for name in losses}


def _losses(amplitude: Array) -> dict[str, float | None]:
    """What a full swing takes off, from the first and the last two turning points."""
    if len(amplitude) < 4:
        return {"log_decrement": None, "amplitude_loss": None}
    # the mean of both sides, so that a level that is a little off does not count
    first, last = float(amplitude[:2].mean()), float(amplitude[-2:].mean())
    swings = (len(amplitude) - 2) / 2
    return {
        "log_decrement": math.log(first / last) / swings,
        "amplitude_loss": (first - last) / swings,
    }
