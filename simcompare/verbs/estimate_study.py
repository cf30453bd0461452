"""How well chips tell what an estimator estimates, where its module asks that."""

from __future__ import annotations

import importlib
from typing import Any

from simcompare.errors import InputError
from simcompare.estimation.estimate import Given
from simcompare.estimation.estimators import Estimator
from simcompare.estimation.joint_angle_study import Feasibility


def chips_of(estimator: Estimator, asked: tuple[str, ...]) -> tuple[str, ...]:
    """The chips that are asked for; all that can serve where none is.

    Raises:
        InputError: this estimator has no study of chips.
    """
    if estimator.study:
        return asked or tuple(_module(estimator).with_accelerometer())
    if asked:
        fault = f"{asked[0]!r} is not of the form sensor=sheet, such as imu={asked[0]}"
        raise InputError("--sensors", [fault])
    return ()


def of(
    estimator: Estimator, ideal: Given, chips: tuple[str, ...], pairs: int, seed: int
) -> tuple[Feasibility, ...]:
    """The study of one motion; nothing where the estimator has none.

    Args:
        estimator: whose study it is.
        ideal: what perfect sensors read of the motion, with the truth.
        chips: names of data sheets.
        pairs: pairs of devices that are drawn of each.
        seed: of the draws.

    Raises:
        InputError: a chip that cannot serve.
    """
    if not estimator.study:
        return ()
    found: tuple[Feasibility, ...] = _module(estimator).of_given(
        ideal, chips, pairs=pairs, seed=seed
    )
    return found


def _module(estimator: Estimator) -> Any:  # noqa: ANN401
    return importlib.import_module(f"simcompare.estimation.{estimator.study}")
