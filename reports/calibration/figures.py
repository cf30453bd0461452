"""The picture of a calibration: what each pose is off by, before and after."""

from __future__ import annotations

import numpy as np

from simcompare.reports.calibration import words
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.styles import Style
from simcompare.results.records.calibration import CalibrationRecord
from simcompare.units import symbol

_BEFORE = Style("#D55E00", marker="square")
_FITTED, _OTHERS = Style("#0072B2"), Style("#0072B2", marker="diamond", hollow=True)


def of(record: CalibrationRecord) -> Figure:
    """Two panels: the sensor as it is, and corrected, each on its own scale."""
    names = tuple(pose.name for pose in record.poses)
    x = np.arange(len(names), dtype=float)
    before = np.array([pose.before for pose in record.poses])
    after = np.array([pose.after for pose in record.poses])
    expanded = words.pose_coverage(record) * np.array([pose.u_after for pose in record.poses])
    fitted = np.array([pose.fitted for pose in record.poses])
    corrected = [Series("took part", x[fitted], after[fitted], _FITTED, expanded[fitted],
                        points=True, line=False)]  # fmt: skip
    if not fitted.all():
        others = ~fitted
        corrected.append(
            Series("took no part: | f | − g", x[others], after[others], _OTHERS,
                   expanded[others], points=True, line=False)
        )  # fmt: skip
    label = f"Off by ({symbol(record.unit)})"
    panels = (
        Panel("As it is", "", label, (Series("as it is", x, before, _BEFORE, points=True,
              line=False),), x_ticks=names),
        Panel("Corrected", "", label, tuple(corrected), x_ticks=names),
    )  # fmt: skip
    caption = (
        "What the reading of each pose is off by. The scales differ. Bars: 95 % uncertainty of what"
        " is left."
    )
    return Figure("poses", "What poses are off by", caption, panels)
