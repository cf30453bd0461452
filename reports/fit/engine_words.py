"""What a fit of bounces says of its engines, in sentences."""

from __future__ import annotations

from simcompare.reports.fit import fits
from simcompare.reports.render import numbers
from simcompare.reports.validation import phrases
from simcompare.results.records.fit_bounces import BouncesFit


def of_engines(fit: BouncesFit) -> list[str]:
    """What they show over all impacts, what they lack, and how far they were run."""
    return [*one_number(fit), *_mean(fit), *_run_short(fit)]


def one_number(fit: BouncesFit) -> list[str]:
    """That engines have one restitution for all speeds, where the ball is seen to differ."""
    one = fit.one_number
    if one is None or not fits.depends(fit.closed_form):
        return []
    slow, fast = fit.closed_form.restitution
    ends = [f"{numbers.plain(e.value, 3)} at {numbers.plain(e.speed_m_s, 2)} m/s"
            for e in (fast, slow)]  # fmt: skip
    which = (
        "that of the first impact" if fit.is_tuned else "the one that follows the measurement best"
    )
    return [
        f"The ball's restitution goes from {ends[0]} to {ends[1]}. Engines have one number for all"
        f" speeds, here {which}: {numbers.plain(one.value, 4)} differs from the ball's {one.off}."
        " All else is given to engines as the closed form has it."
    ]


def _mean(fit: BouncesFit) -> list[str]:
    shown = {s.name: s.effective["restitution"].value for s in fit.sources if s.effective}
    if len(shown) < 2:
        return []
    names = list(shown)
    ends = [end(shown, key=lambda name: shown[name]) for end in (min, max)]
    low, high = (f"{shown[name]:.4f} ({name})" for name in ends)
    same = f"{shown[ends[0]]:.4f}" == f"{shown[ends[1]]:.4f}"
    values = (
        f"{shown[ends[0]]:.4f} in {phrases.whose(names, names)}" if same else f"{low} to {high}"
    )
    return [f"Over all impacts, the engines' mean restitution is {values}."]


def _run_short(fit: BouncesFit) -> list[str]:
    """That a long drop was not run to its end."""
    wanted = sum(max(drop.numbers, default=0) for drop in fit.measured)
    ran = {len(source.impacts) for source in fit.sources if source.impacts}
    if not fit.is_tuned or not ran or min(ran) >= wanted:
        return []
    return [
        f"Engines were run over the first {min(ran)} of {wanted} impacts; what is told of them"
        " holds for these."
    ]
