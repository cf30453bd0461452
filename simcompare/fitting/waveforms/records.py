"""What fit.json says of a fit by waveform, as plain values, with the keys of one by bounces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from simcompare import units
from simcompare.compare.values import value_pairs
from simcompare.engine.assist import ALL
from simcompare.fitting.bounces.identifiability import Identifiability, Language, of_jacobian
from simcompare.fitting.waveforms.engines import EngineWaves
from simcompare.fitting.waveforms.holdout import rms_of
from simcompare.fitting.waveforms.reference import Fitted
from simcompare.fitting.waveforms.setup import Setup
from simcompare.inference.reference_model import Model
from simcompare.inference.segments import DURATION, Segment, as_trajectory, noise
from simcompare.inference.simulated import BEST, HALF
from simcompare.model.settings import ASSISTED
from simcompare.model.trajectory import Array, Trajectory
from simcompare.notation import sentence

#: version of what fit.json holds
FORMAT = 1


def of_fit(
    model: Model,
    setup: Setup,
    fitted: Fitted,
    engines: Sequence[EngineWaves],
    predicted: Mapping[str, Any],
    given: Mapping[str, float],
    step_s: float,
) -> dict[str, Any]:
    """The whole record of a fit.

    Args:
        model: the scenario.
        setup: what was fitted and held out.
        fitted: the reference as fitted.
        engines: what each engine must be given.
        predicted: the stretches that were held out.
        given: further parameters of the scenario.
        step_s: time between samples of the engines.
    """
    known = known_of(setup, fitted)
    sources = []
    for one in engines:
        row = _source(model, setup, fitted, one)
        row["identifiable"] = not any(direction.weak for direction in known.directions)
        row["holdout"] = [
            {"source": stream["stream"], **stream["engines"][one.engine]}
            for stream in predicted["streams"]
            if one.engine in stream["engines"]
        ]
        sources.append(row)
    found: dict[str, Any] = {
        "format": FORMAT,
        "by": "waveform",
        "contact": ASSISTED,
        "assist": ALL,
        "scenario": model.file.name,
        "given": dict(given),
        "probes": list(setup.probes),
        "measured": [
            {**_case(case), "fitted_start": dict(start)}
            for case, start in zip(setup.fitted, fitted.solution.starts, strict=True)
        ],
        "told": list(setup.told),
        "held_out": [_case(case) for case in setup.held],
        "closed_form": _closed(model, setup, fitted),
        "identifiability": known.to_dict(),
        "sources": sources,
        "holdout": dict(predicted),
        "valid": _valid(setup, step_s),
    }
    found["sentences"] = _sentences(found, fitted)
    return found


def known_of(setup: Setup, fitted: Fitted) -> Identifiability:
    """What the recording tells of the unknowns, nuisance ones included."""
    # one standard deviation of the data is what is left over, correlated or not
    spread = np.concatenate(
        [
            np.full(len(left), float(np.sqrt(np.mean(left**2))) or 1.0)
            for left in fitted.solution.residuals
        ]
    )
    language = Language(title, _unit, _advice)
    return of_jacobian(setup.every, fitted.solution.jacobian / spread[:, None], language)


def title(name: str) -> str:
    """A parameter as people call it: ``damping_N_m_s_rad`` is "damping"."""
    return name.removesuffix(units.suffix_of(name)).replace("_", " ")


def _unit(name: str) -> str:
    unit = units.symbol(units.unit_of(name))
    return "" if unit == "1" else f" {unit}"


def _advice(names: set[str]) -> str:
    together = " and ".join(title(name) for name in sorted(names))
    if len(names) == 1:
        return f"the recording hardly changes with {together}: give it (--set)"
    return (
        f"the recording cannot separate {together}: give one of them (--set), or compare another"
        " channel"
    )


def _closed(model: Model, setup: Setup, fitted: Fitted) -> dict[str, Any]:
    own = fitted.estimate
    return {
        "parameters": parameters(model, fitted, own.values, None),
        "names": list(own.names),
        "correlation": _correlation(fitted.covariance),
        "rms": own.rms,
        "how": own.how,
        "streams": list(own.streams),
        "single": {name: values.tolist() for name, values in own.single.items()},
        "at_bound": list(own.at_bound),
        "nuisance": dict(
            zip(setup.nuisance, fitted.solution.values[len(own.names) :].tolist(), strict=True)
        ),
        "known": {
            name: dict(zip(own.names, np.abs(move).tolist(), strict=True))
            for name, move in own.follows.items()
        },
    }


def coverage_factor(fitted: Fitted) -> float:
    """For 95 %: Student's t where few streams tell how much they scatter, else 1.96."""
    from scipy.stats import t

    streams = len(fitted.estimate.streams)
    return float(t.ppf(0.975, streams - 1)) if streams >= 3 else 1.96


def parameters(
    model: Model, fitted: Fitted, values: Array, u_num: Array | None
) -> dict[str, dict[str, Any]]:
    """Values with their uncertainty and its parts; ``u_num`` is that of an engine's step."""
    k, factor = len(fitted.estimate.names), coverage_factor(fitted)
    numerical = np.zeros(k) if u_num is None else u_num[:k]
    u = np.sqrt(np.diag(fitted.covariance) + np.nan_to_num(numerical) ** 2)
    found = {}
    for i, name in enumerate(fitted.estimate.names):
        bounds, value, half = model.file.parameters[name], float(values[i]), factor * float(u[i])
        # what a parameter cannot be is in no interval of it
        low, high = max(value - half, bounds.min), min(value + half, bounds.max)
        found[name] = {
            "value": value, "u": float(u[i]), "low": low, "high": high, "interval95": [low, high],
            "unit": units.unit_of(name), "u_data": float(fitted.estimate.u[i]),
            "u_known": float(fitted.u_known[i]),
            "u_num": float(numerical[i]) if np.isfinite(numerical[i]) else None,
        }  # fmt: skip
    return found


def _correlation(covariance: Array) -> list[list[float]]:
    u = np.sqrt(np.diag(covariance))
    product = np.outer(u, u)
    found: list[list[float]] = (covariance / np.where(product > 0, product, 1.0)).tolist()
    return found


def _source(model: Model, setup: Setup, fitted: Fitted, one: EngineWaves) -> dict[str, Any]:
    plain: dict[str, Any] = {
        "name": one.engine, "version": one.version, "contact": ASSISTED, "status": one.status,
        "reason": one.reason, "simulations": one.simulations, "wall_s": one.wall_s,
    }  # fmt: skip
    if one.status != "ok":
        return {**plain, "parameters": {}, "effective": {}}
    k = len(setup.names)
    numerical = np.diag(np.nan_to_num(one.u_num[:k]) ** 2)
    effective = {
        name: {"value": float(value), "u": float(np.hypot(u, numerical[i, i] ** 0.5)),
               "unit": units.unit_of(name)}
        for i, (name, value, u) in enumerate(
            zip(setup.names, one.effective, np.sqrt(np.diag(fitted.covariance)), strict=False)
        )
    }  # fmt: skip
    return {
        **plain,
        "parameters": parameters(model, fitted, one.x, one.u_num),
        "correlation": _correlation(fitted.covariance + numerical),
        "effective": {**effective, **_shown(model, setup, one)},
        "left": dict(zip(setup.every, one.left.tolist(), strict=True)),
        "rms": {
            case.stream: {probe: rms_of(case, one.runs[i, BEST], probe) for probe in setup.probes}
            for i, case in enumerate(setup.fitted)
        },
    }


def _shown(model: Model, setup: Setup, one: EngineWaves) -> dict[str, Any]:
    """Values of the scenario's measures in the fitted stretches, mean over them."""
    rows: dict[str, list[tuple[float, float, float | None]]] = {}
    unit_of: dict[str, str] = {}
    for i, case in enumerate(setup.fitted):
        found = _values(model, case, one.runs[i, BEST])
        finer = _values(model, case, one.runs[i, HALF]) if (i, HALF) in one.runs else {}
        for name, both in found.items():
            change = abs(finer[name].simulated - both.simulated) if name in finer else None
            rows.setdefault(name, []).append((both.simulated, both.measured, change))
            unit_of[name] = both.unit
    return {
        name: {
            "value": float(np.mean([row[0] for row in own])),
            "u": float(np.mean([row[2] for row in own])) if None not in [r[2] for r in own]
            else None,
            "unit": unit_of[name],
            "measured": float(np.mean([row[1] for row in own])),
        }
        for name, own in rows.items()
    }  # fmt: skip


def _values(model: Model, case: Segment, run: Trajectory) -> Mapping[str, Any]:
    from simcompare.model.resampling import interpolated

    whole = as_trajectory(case)
    inside = (whole.time_s >= run.time_s[0]) & (whole.time_s <= run.time_s[-1])
    times = whole.time_s[inside]
    measured = Trajectory(
        whole.source, times, {name: signal[inside] for name, signal in whole.signals.items()}
    )
    ours = {n: interpolated(run.time_s, run.signals[n], times) for n in measured.signals}
    simulated = Trajectory(run.source, times, ours, run.version, run.contact)
    return value_pairs(model.scenario(case), simulated, measured, tuple(measured.signals))


def _case(case: Segment) -> dict[str, Any]:
    return {
        "stream": case.stream,
        "start_s": case.start_s,
        "duration_s": case.duration_s,
        "start": {name: value for name, value in case.values.items() if name != DURATION},
        "probes": {
            probe: {"samples": len(seen.values), "missing": seen.missing, "u": noise(seen)[0],
                    "u_from": noise(seen)[1]}
            for probe, seen in case.observed.items()
        },
    }  # fmt: skip


def _valid(setup: Setup, step_s: float) -> dict[str, Any]:
    """Within what the fit was made: step, length, and range of every compared quantity."""
    ranges = {
        probe: [
            float(min(case.observed[probe].values.min() for case in setup.fitted)),
            float(max(case.observed[probe].values.max() for case in setup.fitted)),
        ]
        for probe in setup.probes
    }
    lasts = max(case.duration_s for case in setup.fitted)
    return {"step_s": step_s, "duration_s": lasts, "ranges": ranges}


def _sentences(found: Mapping[str, Any], fitted: Fitted) -> list[str]:
    from simcompare.notation import number

    said = []
    for name, row in found["closed_form"]["parameters"].items():
        said.append(
            f"The {title(name)} is {number(row['value'], row['u'])}{_unit(name)}, with 95 % between"
            f" {row['low']:.6g} and {row['high']:.6g} ({fitted.estimate.how})."
        )
        if row["u_known"] > row["u_data"]:
            most = max(found["closed_form"]["known"].items(), key=lambda own: own[1][name])[0] \
                if found["closed_form"]["known"] else "the start"  # fmt: skip
            said.append(
                f"Most of the uncertainty of the {title(name)} comes from what was known before,"
                f" above all from {title(most)}."
            )
    said += [
        f"The {title(name)} ended at a bound of the scenario: the recording asks for more than it"
        " allows, or for an effect that the scenario does not have."
        for name in fitted.estimate.at_bound
    ]
    said += [sentence(text) for text in found["identifiability"]["words"]]
    said += _disagreement(found)
    said.append(found["holdout"]["text"])
    return said


def _disagreement(found: Mapping[str, Any]) -> list[str]:
    """How far the engines' own parameters are from each other."""
    said = []
    good = [source for source in found["sources"] if source["parameters"]]
    for name in found["closed_form"]["names"] if len(good) > 1 else ():
        values = [source["parameters"][name]["value"] for source in good]
        closed = found["closed_form"]["parameters"][name]
        spread = max(values) - min(values)
        if spread > 2 * closed["u"] > 0:
            said.append(
                f"To show the same, {len(good)} engines must be given values of {title(name)} that"
                f" differ by {spread:.2g}{_unit(name)}: their steps differ."
            )
    return said
