"""WHAT of a scenario is estimated: which probe or signal plays which part for which estimator."""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import Field

from simcompare.model.shapes import Frozen


class EstimatePlan(Frozen):
    """How one estimator is used on a scenario.

    Attributes:
        signals: role -> what is measured: a probe, or a signal of a sensor such as
            ``imu.specific_force_m_s2``.
        truth: role -> what it is judged by: a probe or a signal.
        options: numbers of the estimator.
        sensors: sensor -> data sheet that it follows where the user names none.
        text: one sentence on what is estimated.
    """

    signals: Mapping[str, str] = Field(min_length=1)
    truth: Mapping[str, str] = Field(default_factory=dict)
    options: Mapping[str, float] = Field(default_factory=dict)
    sensors: Mapping[str, str] = Field(default_factory=dict)
    text: str = ""
