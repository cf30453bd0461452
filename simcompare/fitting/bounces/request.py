"""What the user asks of a fit of bounces, checked before anything is read or simulated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from simcompare import units
from simcompare.errors import InputError, UnknownName
from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.roles import Roles
from simcompare.fitting.bounces.unknowns import SPEED
from simcompare.results.records.fit_forms import Prior
from simcompare.scenarios.scenario_file import ScenarioFile


@dataclass(frozen=True)
class Constraints:
    """Unknowns, fixed values and priors, by the closed form's names.

    Attributes:
        extra: unknowns beside those of the model.
        fixed: what is not fitted.
        priors: what is known beforehand.
    """

    extra: tuple[str, ...]
    fixed: Mapping[str, float]
    priors: Mapping[str, Prior]


#: uncertainties of instants that are believed [s]
_FINEST_S, _COARSEST_S = 1e-12, 1e9


def check_request(
    recordings: Sequence[str | Path],
    hold_out: Sequence[str | Path],
    u_time_s: float | None,
    roles: Roles,
    settings: Mapping[str, float],
) -> None:
    """Raises ``InputError`` for what would count data twice, or would be ignored."""
    if u_time_s is not None and not _FINEST_S <= u_time_s <= _COARSEST_S:
        fault = f"{u_time_s:g} s is no uncertainty of an instant; expected 1e-12 s to 1e9 s"
        raise InputError("--u-time", [fault])
    places = [str(Path(name).resolve()) for name in (*recordings, *hold_out)]
    twice = {str(n) for n, p in zip((*recordings, *hold_out), places, strict=True)
             if places.count(p) > 1}  # fmt: skip
    if twice:
        raise InputError(
            "--recording, --hold-out",
            [
                f"{name} is given twice; what was seen predicts nothing new"
                for name in sorted(twice)
            ],
        )
    fitted = {name: called for name, called in roles.fitted.items() if name in settings}
    if fitted:
        raise InputError(
            "--set",
            [
                f"{name} belongs to the bounce; give it with --fix or --prior"
                + ("" if name == called else f" as {called}")
                for name, called in fitted.items()
            ],
        )


def given_of(
    file: ScenarioFile, set: Mapping[str, str | float] | None, preset: str | None
) -> dict[str, float]:
    """Every parameter of the scenario: its own value, a preset's, or the user's."""
    values = {name: parameter.value for name, parameter in file.parameters.items()}
    return {**values, **file.of_preset(preset), **file.read_settings(set or {})}


def numbers_of(fixed: Mapping[str, str | float]) -> dict[str, float]:
    """Fixed values by the closed form's names [SI]."""
    return {
        name: units.to_si(value, units.unit_of(name), f"--fix {text}")
        for text, value in fixed.items() for name in named([text])
    }  # fmt: skip


def named(texts: Sequence[str]) -> tuple[str, ...]:
    """Unknowns or parameters as users type them, by the closed form's names.

    Raises:
        UnknownName: no closed form has one of that name.
    """
    found = [units.find_name(text, bounce_models.DEFAULTS) for text in texts]
    for text, name in zip(texts, found, strict=True):
        if name is None:
            raise UnknownName("parameter of a bounce", text, bounce_models.DEFAULTS)
    return tuple(dict.fromkeys(name for name in found if name is not None))


def candidates(model: str, constraints: Constraints) -> list[str]:
    """Closed forms that are compared; with a known terminal speed those without drag fall away."""
    known = SPEED in {**constraints.fixed, **constraints.priors}
    if model != "auto":
        one = bounce_models.model_of(model)
        return [one.name if one.drag or SPEED not in constraints.priors else f"{one.name}+drag"]
    return [name for name, one in bounce_models.MODELS.items() if one.drag or not known]
