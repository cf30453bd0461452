"""Whether the data contradict a drag that was assumed from the settings of a scene.

Where the restitution may depend on the speed, a slope takes up what a wrong drag does, so that the
drag itself is not pulled. Laws without drag then describe the data better.
"""

from __future__ import annotations

from simcompare.errors import InputError
from simcompare.fitting.bounces import model_selection
from simcompare.fitting.bounces.bounce_models import MODELS
from simcompare.fitting.bounces.model_selection import Choice
from simcompare.fitting.bounces.request import Constraints
from simcompare.fitting.bounces.unknowns import SPEED


def excess(choice: Choice, constraints: Constraints) -> float | None:
    """By how much Akaike's criterion of the best law without drag is below that of the choice.

    Args:
        choice: what was chosen with the drag of the settings.
        constraints: with which it was; ``None`` is returned where no drag was assumed.
    """
    prior = constraints.priors.get(SPEED)
    if prior is None or not prior.reason:
        return None
    others = {name: one for name, one in constraints.priors.items() if name != SPEED}
    try:
        airless = model_selection.compare(
            choice.best.problem.drops, [name for name, one in MODELS.items() if not one.drag],
            extra=constraints.extra, fixed=constraints.fixed, priors=others,
        )  # fmt: skip
    except InputError:
        return None
    both = [row.fit for row in (*choice.candidates, *airless.candidates)]
    scatter, dof = model_selection.scatter_of(both)
    with_drag, without = (
        min(model_selection.candidate(row.model, row.fit, scatter, dof).aic
            for row in one.candidates) for one in (choice, airless)
    )  # fmt: skip
    return with_drag - without
