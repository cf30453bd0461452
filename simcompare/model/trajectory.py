"""WHAT comes out: a trajectory, the same value for engines and closed forms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import SimulationDiverged
from simcompare.model.audit import AuditRow
from simcompare.model.tuning import TuningRow

Array = NDArray[np.float64]

#: source of the true trajectory
TRUTH = "closed form"
#: what stands between the name of an engine and its step, in the name of a source
AT = "@"

#: what is recorded of every moving body, with its number of components
BODY_SIGNALS = {
    "position_m": 3,
    "orientation_wxyz": 4,
    "velocity_m_s": 3,
    "rate_rad_s": 3,
}
#: most components of a signal
_MOST = 1024


def components(count: int) -> tuple[str, ...]:
    """Names of the components of a vector, of a quaternion, or else their numbers."""
    return {3: ("x", "y", "z"), 4: ("w", "x", "y", "z")}.get(count) or tuple(map(str, range(count)))


def _read_only(values: Array) -> Array:
    view = values.view()
    view.setflags(write=False)
    return view


@dataclass(frozen=True, repr=False)
class Trajectory:
    """Signals over time from one source.

    Attributes:
        source: name of the engine, or what else produced the signals.
        time_s: sample times (n,), increasing, from the scenario's start [s].
        signals: name -> values, (n,) or (n, k); world frame, SI, the unit is in the name.
            Velocities are those that the source itself stores; a semi-implicit engine stores
            them half a step away from the positions.
        version: version of the source, empty for mathematics.
        contact: contact level ("default", "assisted", …), empty for mathematics.
        wall_s: wall time by stage [s] ("import", "build", "step").
        audit: what was set in the engine and what it held afterwards.
        notes: what the reader should know about this run.
        helps: our helps that acted in it.
        velocity_offset_s: velocities belong to the sample's time plus this [s].
        tuning: how the numbers for restitution were found, one row for each restitution.
        lacks: signals that this source does not give -> why.
    """

    source: str
    time_s: Array
    signals: Mapping[str, Array]
    version: str = ""
    contact: str = ""
    wall_s: Mapping[str, float] = field(default_factory=dict)
    audit: tuple[AuditRow, ...] = ()
    notes: tuple[str, ...] = ()
    helps: tuple[str, ...] = ()
    velocity_offset_s: float = 0.0
    tuning: tuple[TuningRow, ...] = ()
    lacks: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        times = np.asarray(self.time_s, dtype=float)
        if times.ndim != 1 or len(times) == 0 or np.any(np.diff(times) <= 0):
            raise ValueError(f"{times.shape=}: time_s must be one increasing row of times")
        for name, values in self.signals.items():
            if len(values) != len(times):
                raise ValueError(f"{name} has {len(values)} samples but {len(times)=}")
            if values.ndim > 2 or (values.ndim == 2 and not 3 <= values.shape[1] <= _MOST):
                raise ValueError(
                    f"{name} has {values.shape=}; a signal has 1, or 3 to {_MOST} components"
                )
            bad = ~np.isfinite(values).reshape(len(values), -1).all(axis=1)
            if bad.any():
                first = float(times[np.argmax(bad)])
                raise SimulationDiverged(
                    f"{self.source}: {name} is not finite from t = {first:g} s on; "
                    "try a smaller --step"
                )
        # read-only views: the caller's own arrays stay as they are
        views = {name: _read_only(values) for name, values in self.signals.items()}
        object.__setattr__(self, "signals", views)
        object.__setattr__(self, "time_s", _read_only(times))

    def __repr__(self) -> str:
        whose = " ".join(filter(None, (self.source, self.contact)))
        until = f"{len(self.time_s)} samples to {self.time_s[-1]:g} s"
        return f"Trajectory of {whose}: {until}; {', '.join(self.signals)}"

    def to_columns(self) -> dict[str, Array]:
        """One flat column per component: ``ball.position_m.z`` and so on, time first."""
        columns = {"time_s": self.time_s}
        for name, values in self.signals.items():
            if values.ndim == 1:
                columns[name] = values
                continue
            for i, component in enumerate(components(values.shape[1])):
                columns[f"{name}.{component}"] = values[:, i]
        return columns
