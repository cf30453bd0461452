"""The verb ``uncertainty``: how well a result of a scenario or of a formula is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from simcompare.arguments import checked
from simcompare.engine import engines
from simcompare.errors import InputError, UnknownName
from simcompare.model.settings import ASSISTED, CONTACT_LEVELS
from simcompare.propagation.inputs import NO_FILE, read_file
from simcompare.propagation.propagated import Asked
from simcompare.results import result_file, store
from simcompare.running.runner import TIME_LIMIT_S, Progress, check_time_limit
from simcompare.scenarios import catalogue
from simcompare.statistics.monte_carlo import MAX_TRIALS, fault_of
from simcompare.verbs.notebook_line import with_line
from simcompare.verbs.request import UncertaintyRequest
from simcompare.verbs.uncertain import Uncertain
from simcompare.verbs.uncertain_formula import of_formula
from simcompare.verbs.uncertain_scenario import of_scenario

FILE = "uncertainty.json"
#: trials on an engine: each is a run
MAX_RUNS = 10_000


@checked
@with_line
def uncertainty(
    scenario: str | Path | None = None,
    *,
    of: str | None = None,
    engine: str | Sequence[str] = "",
    set: Mapping[str, str | float] | None = None,
    robot: str | Path | None = None,
    u: Mapping[str, str | float] | None = None,
    inputs: str | Path | None = None,
    correlation: Mapping[str, str | float] | None = None,
    contact: str = ASSISTED,
    preset: str | None = None,
    step: str | float | None = None,
    seeds: int | None = None,
    trials: int | None = None,
    probability: float = 0.95,
    seed: int = 1,
    out: str | Path | None = None,
    trust: bool = False,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Uncertain:
    """Tells how well a result is known, and which input matters most.

    ::

        found = simcompare.uncertainty("robot", of="acceleration", engine="mujoco")
        found.table()  # the budget
        found.plot()
        simcompare.uncertainty(of="2*tau/r/m", set={"tau": 0.02, "r": "32.5mm", "m": "0.6kg"},
                               u={"tau": "2%", "r": "±0.1mm"})

    First order with degrees of freedom (JCGM 100), and Monte Carlo (JCGM 101) of the closed form
    or the formula, which tells whether first order is enough.

    Args:
        scenario: name, folder or file; left out for a formula alone.
        of: a result of the scenario, or a formula; the scenario's leading result where ``None``.
        engine: engines beside the closed form: "all", names with commas or a list of names.
        set: values that differ from the file, or those of the formula; text may carry a unit.
        u: input -> "2%", "0.1mm" (standard), "±5g" (limits), "0.1mm, dof 4" or "exact".
        inputs: YAML file with more inputs.
        correlation: "a,b" -> coefficient of correlation of two inputs.
        contact: contact level of the engines.
        robot: file of a robot (``simcompare robot --template``), applied before ``set``.
        preset: named set of parameters, applied first.
        step: the engine's step, "1ms" or in seconds.
        seeds: number of dithered repeats; the scenario's own where ``None``.
        trials: of Monte Carlo, also on the engines themselves; where ``None`` a million of a
            formula, 2000 of a closed form without one, and none on an engine.
        probability: that the value lies in an interval.
        seed: of the draws.
        out: folder for the folder of the results; nothing is stored where ``None``.
        trust: run the Python files beside the scenario, where it comes from elsewhere; a yes is
            remembered until they change.
        time_limit_s: longest time for one simulation [s].
        progress: called as ``progress(source, done, total)``.

    Raises:
        SimcompareError: faults of the arguments or of a file, or nowhere to store the results.
    """
    engine = engines.listed(engine)
    request = UncertaintyRequest(
        scenario="" if scenario is None else str(scenario), engine=engine, of=of, set=set, u=u,
        robot=robot,
        inputs=inputs, correlation=correlation, contact=contact, preset=preset, step=step,
        seeds=seeds, trials=trials, probability=probability, seed=seed,
    )  # fmt: skip
    _check(request, time_limit_s)
    more = NO_FILE if inputs is None else read_file(Path(inputs))
    request = replace(request, set={**more.values, **(set or {})})
    stated = {**more.uncertainties, **(u or {})}
    reasons = {name: why for name, why in more.reasons.items() if name not in (u or {})}
    pairs = {**more.correlation, **_pairs(correlation or {})}
    asked = Asked((), pairs, probability, trials, seed)
    if out is not None:
        store.check_writable(Path(out))
    if scenario is None:
        record = of_formula(request, asked, stated, reasons)
    else:
        catalogue.load(str(scenario), trust=trust)
        record = of_scenario(request, asked, stated, reasons, time_limit_s, progress)
    command = UncertaintyRequest(**{**vars(request), "set": set}).command()
    record = replace(record, command=" ".join(map(_quoted, command)))
    return record if out is None else result_file.save(record, Path(out), "uncertainty", FILE)


def _check(request: UncertaintyRequest, time_limit_s: float) -> None:
    check_time_limit(time_limit_s)
    if request.contact not in CONTACT_LEVELS:
        raise UnknownName("contact level", request.contact, CONTACT_LEVELS)
    faults = []
    most = MAX_RUNS if request.engine else MAX_TRIALS
    if fault := fault_of(request.trials, request.probability, most):
        faults.append(fault)
    if request.seed < 0:
        faults.append(f"--seed {request.seed} is below 0; expected a whole number from 0 on")
    if request.seeds is not None and request.seeds < 1:
        faults.append(f"--seeds {request.seeds} is not a number of repeats; expected 1 or more")
    if not request.scenario:
        for_scenes = {
            "--engine": request.engine,
            "--robot": request.robot,
            "--preset": request.preset,
            "--step": request.step,
        }
        faults += [
            f"{name} {value} is of a scenario, and a formula alone has none"
            for name, value in for_scenes.items()
            if value
        ]
        if request.of is None:
            faults.append("name a scenario, or a formula with --of")
    if faults:
        raise InputError("uncertainty", faults)


def _pairs(given: Mapping[str, str | float]) -> dict[tuple[str, str], float]:
    """Reads ``{"a,b": "0.5"}``."""
    pairs: dict[tuple[str, str], float] = {}
    faults = []
    for names, text in given.items():
        both = tuple(name.strip() for name in names.split(","))
        try:
            value = float(text)
        except ValueError:
            value = None
        if len(both) != 2 or value is None:
            faults.append(f"{names}={text} is not of the form a,b=0.5")
        elif any({*both} == {*one} for one in pairs):
            faults.append(f"the correlation of {both[0]} with {both[1]} is given twice")
        else:
            pairs[both[0], both[1]] = value
    if faults:
        raise InputError("--correlation", faults)
    return pairs


def _quoted(word: str) -> str:
    """A word as a shell takes it, in quotes that every system knows."""
    return f'"{word}"' if any(sign in word for sign in " *()%±<>|&;,") else word
