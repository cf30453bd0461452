"""The verb ``run``: a scenario through engines, held against the truth and against measurements."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from simcompare.arguments import checked
from simcompare.engine import engines
from simcompare.engine.assist import ALL
from simcompare.model.settings import ASSISTED, DEFAULT, TUNED
from simcompare.results import store
from simcompare.running import interruption
from simcompare.running.runner import TIME_LIMIT_S, Interrupted, Progress, run_jobs
from simcompare.verbs import levels
from simcompare.verbs.gathered import gathered
from simcompare.verbs.kept import Kept
from simcompare.verbs.notebook_line import with_line
from simcompare.verbs.request import RunRequest
from simcompare.verbs.result import Result
from simcompare.verbs.run_plan import RunPlan, planned


@checked
@with_line
def run(
    scenario: str | Path = "ball",
    *,
    engine: str | Sequence[str] = "all",
    contact: str | Sequence[str] = (DEFAULT, TUNED, ASSISTED),
    assist: str | Sequence[str] = ALL,
    judge: str | Sequence[str] = ASSISTED,
    set: Mapping[str, str | float] | None = None,
    own: Mapping[str, str | float] | None = None,
    robot: str | Path | None = None,
    preset: str | None = None,
    step: str | float | Sequence[str | float] | None = None,
    seeds: int | None = None,
    against: str | Path | None = None,
    sensor: Mapping[str, str | Path | float] | None = None,
    seed: int = 0,
    out: str | Path | None = None,
    trust: bool = False,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Result:
    """Simulates a scenario on engines and compares the results.

    ::

        run = simcompare.run("ball", engine="mujoco,pymunk", set={"drop_height": "30cm"})
        run.table("settling_time")
        run.plot("height_m").savefig("ball.pdf")

    Args:
        scenario: name, folder or file.
        engine: ``"all"``, names with commas or a list of names; "mujoco:rk4" is a variant.
        contact: contact levels, a list or a text with commas; also the fit.json of a fit, with
            which each engine runs with its own fitted parameters.
        assist: our helps in "assisted": "all", "none" or names (see ``simcompare.engine.helps``).
        judge: levels in which a tolerance that is missed is a failure of the run; "assisted"
            always is.
        set: parameters that differ from the file; text may carry a unit ("30cm").
        own: an engine's own contact values for a bounce, such as ``{"pymunk.elasticity": 0.9}``;
            with them the engine runs once more, at the level "by hand".
        robot: file of a robot (``simcompare robot --template``), from which those parameters follow
            that the scenario has; applied after ``preset`` and before ``set``.
        preset: named set of parameters, applied first.
        step: the engine's step, "1ms" or in seconds; samples may be coarser. Of several, as a list
            or a text with commas, each makes a source of its own, such as "pymunk@2ms".
        seeds: number of dithered repeats; the scenario's own where ``None``.
        against: table of measured bounces: a file or the name of a published one.
        sensor: sensor, joint, actuator or body, or one of their signals -> data sheet of a real
            one, in place of the scenario's ``errors``; and its settings, such as
            ``{"eye": "vl53l5cx", "eye.ambient_klux": 1}``. Engines and scores stay ideal; what it
            reads is in ``readings``.
        seed: of all that is drawn for sensors.
        out: folder in which the run's own folder is made; nothing is stored where ``None``.
        trust: run the Python files beside the scenario, where it comes from elsewhere; a yes is
            remembered until they change.
        time_limit_s: longest time for one simulation [s].
        progress: called as ``progress(engine, done, total)``.

    Returns:
        The run; a run that Ctrl-C ended is marked so and keeps what had finished.

    Raises:
        SimcompareError: faults of the arguments or of a file, or nowhere to store the run.
    """
    request = request_of(
        scenario, engine=engine, contact=contact, assist=assist, judge=judge, set=set,
        own=own, robot=robot, preset=preset, step=step, seeds=seeds, against=against,
        sensor=sensor, seed=seed,
    )  # fmt: skip
    plan = planned(request, trust=trust)
    if out is not None:
        store.check_writable(Path(out))
    return _ended(plan, Kept(plan, out), time_limit_s, progress)


@checked
@with_line
def resume(
    place: str | Path, *, time_limit_s: float = TIME_LIMIT_S, progress: Progress | None = None
) -> Result:
    """Goes on with a run that was ended early; what had finished is not simulated again.

    ::

        run = simcompare.resume("runs/20260101-120000-ball")

    Args:
        place: folder of the run.
        time_limit_s: longest time for one simulation [s].
        progress: called as ``progress(engine, done, total)``; counts what was missing.

    Returns:
        The run, the same as if nobody had ended it.

    Raises:
        InputError: no such run, it still goes on, or scenario, engines or simcompare have changed
            since it began; names which.
    """
    kept = Kept.of(Path(place))
    return _ended(kept.plan, kept, time_limit_s, progress)


def request_of(
    scenario: str | Path,
    *,
    engine: str | Sequence[str],
    contact: str | Sequence[str],
    assist: str | Sequence[str],
    judge: str | Sequence[str],
    **more: Any,  # noqa: ANN401
) -> RunRequest:
    """What ``run`` is asked, lists and texts with commas alike."""
    return RunRequest(
        scenario=str(scenario), engine=engines.listed(engine), contact=levels.names(contact),
        assist=levels.names(assist), judge=levels.names(judge), **more,
    )  # fmt: skip


def _ended(plan: RunPlan, kept: Kept, time_limit_s: float, progress: Progress | None) -> Result:
    """Simulates what is not kept yet, and stores all of it.

    Raises:
        KeyboardInterrupt: before anything had finished, or when all of it was stored.
        OutputError: it cannot be stored; says what is kept.
    """
    interrupted = False
    with contextlib.closing(kept), interruption.held():
        try:
            new = run_jobs(
                kept.missing, time_limit_s=time_limit_s, progress=progress, keep=kept.keep
            )
        except Interrupted as stop:
            if not kept.outcomes:
                raise KeyboardInterrupt("nothing had finished") from None
            interruption.answer()
            new, interrupted = stop.outcomes, True
        result = kept.stored(gathered(plan, kept.all(new), interrupted=interrupted))
        if interruption.came() and not interrupted:
            where = f"stored in {result.folder}" if result.folder else "not stored, as asked"
            raise KeyboardInterrupt(f"all of it had finished, and is {where}")
    return result
