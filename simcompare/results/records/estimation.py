"""What estimate.json says of an estimation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from simcompare.estimation.consistency import Verdict
from simcompare.estimation.estimate import Number
from simcompare.estimation.joint_angle_study import Feasibility
from simcompare.model.plain import Finite
from simcompare.model.sensor_errors import SensorErrors
from simcompare.results.records.answered import Answered
from simcompare.running.jobs import OK, exit_code_of


@dataclass(frozen=True)
class WayError:
    """How far one way of telling a state is from the truth, over all draws.

    Attributes:
        way: such as "filtered".
        state: name with its unit.
        rms_error: root of the mean squared error [unit of the state]; ``None`` where nobody knows
            the truth.
        u: root of the mean squared standard uncertainty that this way states; ``None`` for none.
    """

    way: str
    state: str
    rms_error: float | None
    u: float | None


@dataclass(frozen=True)
class Curve:
    """One state over time, as one way tells it in the first draw.

    Attributes:
        way: such as "filtered".
        state: name with its unit.
        time_s: (n,) [s].
        values: (n,).
        u: standard uncertainty (n,), ``None`` where none is stated.
        truth: (n,), ``None`` where nobody knows.
    """

    way: str
    state: str
    time_s: tuple[float, ...]
    values: tuple[Finite, ...]
    u: tuple[Finite, ...] | None
    truth: tuple[Finite, ...] | None


@dataclass(frozen=True)
class Reading:
    """What is known of the innovations of one reading.

    Attributes:
        name: such as "wheel".
        whiteness: the test; ``None`` where hardly anything was read.
        refused: how many the gate kept out, in a draw.
        count: how many were read, in a draw.
        counted: whether it is a difference of counts, whose errors cancel.
    """

    name: str
    whiteness: Verdict | None
    refused: float
    count: float
    counted: bool = False


@dataclass(frozen=True)
class SourceEstimate:
    """What was estimated of one source: an engine, or a recording.

    Attributes:
        source: its name.
        version: of the engine, ``None`` where it is not known.
        status: "ok", "unsupported", "missing" or "failed".
        reason: one sentence where the status is not "ok".
        labels: state -> what it is, the one that leads first.
        errors: of each way and state.
        nees: test of the errors; ``None`` where nobody knows the truth, or nothing is filtered.
        nis: test of the innovations.
        nees_over_time: times [s] and NEES, its mean over the draws.
        readings: what is known of each of them.
        numbers: key numbers of the first draw.
        notes: what the reader must know.
        curves: of the first draw.
        chips: how well chips tell it, as bought and calibrated, where the estimator asks that.
    """

    source: str
    version: str | None
    status: str
    reason: str | None = None
    labels: Mapping[str, str] = field(default_factory=dict)
    errors: tuple[WayError, ...] = ()
    nees: Verdict | None = None
    nis: Verdict | None = None
    nees_over_time: tuple[tuple[float, ...], tuple[Finite, ...]] = ((), ())
    readings: tuple[Reading, ...] = ()
    numbers: Mapping[str, Number] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    curves: tuple[Curve, ...] = ()
    chips: tuple[Feasibility, ...] = ()

    def error_of(self, way: str, state: str) -> WayError | None:
        """The error of one way and state."""
        return next((e for e in self.errors if (e.way, e.state) == (way, state)), None)

    def curve_of(self, way: str, state: str) -> Curve | None:
        """The curve of one way and state."""
        return next((c for c in self.curves if (c.way, c.state) == (way, state)), None)

    @property
    def ways(self) -> list[str]:
        """Ways, the estimator's own first."""
        return list(dict.fromkeys(one.way for one in self.errors))


@dataclass(frozen=True, kw_only=True)
class Estimation(Answered):
    """What sensors told of a motion.

    Attributes:
        scenario: its name.
        estimator: its name.
        sensors: sensor -> data sheet, or own errors, that it has.
        options: numbers of the estimator.
        loosen: options that say what a motion does besides its model.
        biases: options that make a constant error of a sensor a state.
        sums: options that read differences as a sum, whose errors do not cancel.
        draws: how often each motion was measured.
        seed: of the draws.
        recording: name of it; empty where engines were measured.
        sentences: what there is to see.
        sources: what was estimated of each.
        command: words of the command line that do the same again.
    """

    scenario: str
    estimator: str
    sensors: Mapping[str, SensorErrors]
    options: Mapping[str, float]
    loosen: tuple[str, ...] = ()
    biases: tuple[str, ...] = ()
    sums: tuple[str, ...] = ()
    draws: int
    seed: int
    recording: str = ""
    engines_asked: str = "all"
    sentences: tuple[str, ...] = ()
    sources: tuple[SourceEstimate, ...]
    command: tuple[str, ...]

    @property
    def done(self) -> list[SourceEstimate]:
        """Sources of which something was estimated."""
        return [one for one in self.sources if one.status == OK]

    @property
    def labels(self) -> Mapping[str, str]:
        """State -> what it is; none where nothing was estimated."""
        return self.done[0].labels if self.done else {}

    @property
    def exit_code(self) -> int:
        """0 fine; 3 where an engine broke, none could do it, or one that was named is missing."""
        statuses = [one.status for one in self.sources]
        return exit_code_of(statuses, self.engines_asked, out_of_reach=False)
