"""The uncertainty of a result by the scenario's closed form."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.comparison.repeats import truths_of
from simcompare.errors import InputError
from simcompare.model.formula import Formula
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array
from simcompare.propagation import formulas, results
from simcompare.propagation.propagated import Asked, Propagated, linear, with_trials
from simcompare.propagation.steps import Steps
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.statistics.budget import u_of

#: trials where the whole motion is calculated for each: some milliseconds
TRIALS = 2000
#: called with the number of trials made and of all
Told = Callable[[int, int], None]
#: how well a formula must give what the closed form gives
_SAME = 1e-6


@dataclass(frozen=True)
class ClosedForm:
    """A result as a function of the scenario's parameters.

    Attributes:
        file: the scenario.
        scenario: it with numbers.
        of: the result.
    """

    file: ScenarioFile
    scenario: Scenario
    of: str

    def at(self, values: Mapping[str, float]) -> float:
        """The result where some parameters have other values.

        Raises:
            InputError: it cannot be measured there.
        """
        scene = self.scenario
        if values:
            scene = self.file.moved(scene, values)
        truth = truths_of(self.file.path, [scene])[0]
        if truth is None:
            raise InputError(self.file.name, ["it has no closed form"])
        return results.value_of(scene, truth, self.of)

    @property
    def formula(self) -> Formula | None:
        """The result as a formula, where the scenario has one that gives the same."""
        said = self.file.uncertainty
        text = None if said is None else said.formulas.get(self.of)
        if text is None:
            return None
        known = formulas.formula_of(text, f"{self.file.path}, uncertainty.formulas.{self.of}")
        value, true = formulas.value_of(known, self.scenario.parameters), self.at({})
        if abs(value - true) > _SAME * abs(true):
            raise InputError(
                f"{self.file.path}, uncertainty.formulas.{self.of}",
                [f"gives {value:.9g}, and the closed form {true:.9g}; correct one of them"],
            )
        return known


def propagated(form: ClosedForm, asked: Asked, steps: Steps, told: Told) -> Propagated:
    """Budget and Monte Carlo of the closed form.

    Args:
        form: the closed form.
        asked: what is asked of it.
        steps: how far each input is moved for its sensitivity.
        told: called with the number of trials made and of all.
    """
    formula = form.formula
    if formula is not None:
        return formulas.propagated(formula, form.scenario.parameters, asked)
    slopes = {
        name: (form.at({name: ends.high}) - form.at({name: ends.low})) / (ends.high - ends.low)
        for name, ends in steps.items()
    }
    trials = TRIALS if asked.trials is None else asked.trials
    done = 0

    def model(**drawn: Array) -> Array:
        nonlocal done
        rows = zip(*drawn.values(), strict=True)
        values = []
        for row in rows:
            values.append(_drawn(form, dict(zip(drawn, map(float, row), strict=True))))
            done += 1
            told(done, trials)
        return np.array(values)

    return with_trials(asked, linear(asked, form.at({}), slopes), model, trials)


def beyond_near(form: ClosedForm, asked: Asked) -> tuple[str, ...]:
    """Why the closed form does not hold where an input is off by twice its u, a sentence each."""
    found = {}
    for name, known in asked.inputs.items():
        far = min(2 * u_of(known), known.half_width)
        for end in (known.center - far, known.center + far):
            with contextlib.suppress(InputError):  # no scene at all can be built there
                for why in form.file.moved(form.scenario, {name: end}).beyond:
                    found[name] = f"where {name} is {end:.3g}, {why[:1].lower()}{why[1:]}"
    return tuple(found.values())


def _drawn(form: ClosedForm, values: Mapping[str, float]) -> float:
    """The result of one draw.

    Raises:
        InputError: no scene can be built with it; says how to bound the inputs.
    """
    try:
        return form.at(values)
    except InputError as error:
        told = ", ".join(f"{name} = {value:.4g}" for name, value in values.items())
        cure = "bound the input, such as --u NAME=±10%, or make its uncertainty smaller"
        why = error.faults[0]
        raise InputError("--u", [f"Monte Carlo drew {told}, and {why}; {cure}"]) from None
