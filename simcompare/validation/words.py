"""What a validation shows, in plain sentences, and never more than it shows.

Within the noise level is not "validated" (ASME V&V 20-2009, 1-5): it says what cannot be seen.
Parameters that were fitted to the same data show that a fit succeeds, not that it predicts.
"""

from __future__ import annotations

import math
from typing import Literal

from simcompare.validation.gap import Gap
from simcompare.validation.scores import VV20

#: what the parameters rest on: known beforehand, fitted on other data, fitted on the judged data
Basis = Literal["known", "held out", "same data"]

_PARTS = {
    "parameter": "the parameters",
    "model_form": "the form of the model",
    "numerical": "the numerical error",
    "noise": "noise of the measurement",
}


def verdict(found: VV20 | None, basis: Basis, quantity: str, unit: str) -> str:
    """One sentence about a single value.

    Args:
        found: comparison error and validation uncertainty; ``None`` where there is none.
        basis: what the parameters rest on.
        quantity: what is judged, as in "the period".
        unit: its unit.
    """
    if found is None or not found.u_val > 0:
        return f"{_first(quantity)} cannot be judged: no uncertainty is known."
    reach = found.k * found.u_val
    size = f"{number(abs(found.error), unit)} (uncertainty {number(reach, unit)}, k = {found.k:g})"
    side = "above" if found.error > 0 else "below"
    if basis == "same data":
        return (
            "Fitted, not validated: the parameters were fitted to the same data, and the simulated "
            f"value of {quantity} is {size} {side} the measured one."
        )
    start = "On data that were not used for fitting, the" if basis == "held out" else "The"
    if found.within_noise:
        most = max(abs(found.low), abs(found.high))
        return (
            f"{start} simulated value of {quantity} is {size} {side} the measured one. The model "
            f"error is within the noise level: up to {number(most, unit)} could not be seen."
        )
    low, high = sorted((abs(found.low), abs(found.high)))
    return (
        f"{start} simulated value of {quantity} is {size} {side} the measured one. That is more "
        f"than the uncertainties explain: the model error is between {number(low, unit)} and "
        f"{number(high, unit)}."
    )


def prediction(rmse: float, basis: Basis, quantity: str, unit: str) -> str:
    """One sentence about a whole record.

    Args:
        rmse: root mean square of simulated minus measured.
        basis: what the parameters rest on.
        quantity: what was compared.
        unit: its unit.
    """
    size = f"{number(rmse, unit)} (root mean square)"
    if basis == "held out":
        return f"The model predicts data it has not seen within {size} of {quantity}."
    if basis == "same data":
        return (
            f"Fitted, not validated: {quantity} is reproduced within {size}, "
            "with parameters fitted to the same data."
        )
    return f"With the parameters known beforehand, {quantity} is predicted within {size}."


def made_of(gap: Gap, quantity: str, unit: str) -> list[str]:
    """How large a gap is, how sure that is, and what it is made of, largest part first.

    Args:
        gap: the split of the gap.
        quantity: what was compared.
        unit: its unit.
    """
    if gap.total == 0:
        return [f"There is no gap in {quantity}: the two signals are equal."]
    said = [f"The gap in {quantity} is {number(gap.total, unit)} (root mean square)."]
    # parts that are nothing are left out, unless their being nothing is a result
    parts = sorted(
        ((part, name) for name, part in gap.mean_squares().items() if name in _PARTS),
        reverse=True,
    )
    shown = [
        f"{_PARTS[name]} ({number(math.sqrt(part), unit)}, {100 * part / gap.total**2:.0f} % of "
        "the mean square)"
        for part, name in parts
        if part > 0
    ]
    said.append(f"It is made of, largest first: {'; '.join(shown)}.")
    said.append(
        f"The form of the model makes up {number(gap.model_form_low, unit)} to "
        f"{number(gap.model_form_high, unit)} (95 %)."
    )
    if gap.clipped:
        said.append(
            "Noise and numerical error are together larger than what is left with the best "
            "parameters, so the part of the model's form was set to zero: it is within the noise "
            "level."
        )
    if abs(gap.correlation) > 0.1:
        said.append(
            f"The parts do not simply add: the parameter part and the rest are correlated "
            f"({gap.correlation:+.2f}), which {'adds' if gap.cross > 0 else 'takes away'} "
            f"{100 * abs(gap.cross) / gap.total**2:.0f} % of the mean square."
        )
    if gap.noise_from != "stated":
        said.append(f"The noise was estimated {gap.noise_from}.")
    return said


def number(value: float, unit: str) -> str:
    """A value with three significant digits and its unit."""
    return f"{value:.3g}" + ("" if unit in ("", "1") else f" {unit}")


def _first(text: str) -> str:
    return text[:1].upper() + text[1:]
