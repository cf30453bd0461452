"""What a fit by waveform fits, what it holds out, and what it takes as known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from simcompare import units
from simcompare.errors import InputError, UnknownName
from simcompare.inference import plan as plans
from simcompare.inference import sources
from simcompare.inference.plan import Plan
from simcompare.inference.segment_reader import segments_of
from simcompare.inference.segments import Segment
from simcompare.inference.sources import Source
from simcompare.results.records.fit_waveforms import Chosen
from simcompare.scenarios.scenario_file import ScenarioFile


@dataclass(frozen=True)
class Setup:
    """What is fitted to what.

    Attributes:
        plan: that of the first recording.
        names: the parameters that are fitted.
        nuisance: parameters that are fitted too, but belong to the recording alone.
        probes: what is compared, the leading one first.
        fitted: segments that are fitted.
        held: segments that are predicted.
        chosen: what of each recording is fitted, and what is held out.
    """

    plan: Plan
    names: tuple[str, ...]
    nuisance: tuple[str, ...]
    probes: tuple[str, ...]
    fitted: tuple[Segment, ...]
    held: tuple[Segment, ...]
    chosen: tuple[Chosen, ...]

    @property
    def every(self) -> tuple[str, ...]:
        """All unknowns."""
        return (*self.names, *self.nuisance)

    @property
    def starts(self) -> tuple[str, ...]:
        """Parameters that each segment has for itself, read off it."""
        u = self.fitted[0].u
        return tuple(n for n in self.plan.start if n not in self.every and u.get(n, 0.0) > 0)

    def known(self) -> dict[str, float]:
        """Parameters that all segments share and that are known with some uncertainty."""
        first = self.fitted[0]
        return {
            name: u
            for name, u in first.u.items()
            if u > 0 and name not in self.every and name not in self.plan.start
        }


def prepare(
    file: ScenarioFile,
    recordings: Sequence[str],
    hold_out: Sequence[str],
    *,
    unknowns: Sequence[str],
    given: Mapping[str, float],
    mapping: str | Path | None,
) -> Setup:
    """Reads the recordings and chooses what is fitted.

    Args:
        file: a scenario that can be fitted by waveform.
        recordings: logs, stored recordings, or public data sets that are fitted.
        hold_out: the same, which are only predicted.
        unknowns: what is fitted; what the plan calibrates, or all that the scenario names, where
            empty.
        given: parameters that the user sets; they are not fitted.
        mapping: mapping file for the logs.

    Raises:
        InputError: every fault of the request or of a recording.
    """
    found = [_found(file, name, mapping) for name in recordings]
    plan = found[0][1]
    names, nuisance = _unknowns(file, plan, unknowns, given)
    fitted: list[Segment] = []
    held: list[Segment] = []
    chosen = []
    for source, own in found:
        one, other, what = _split(file, source, own, given)
        several = len(found) > 1
        fitted += _named(one, source, several)
        held += _named(other, source, several)
        chosen.append(what)
    for name in hold_out:
        source, own = _found(file, name, mapping)
        held += _named(segments_of(file, own, source.recording, own.streams, given), source, True)
    probes = tuple(probe for probe, compared in plan.compare.items() if compared.judged)
    return Setup(plan, names, nuisance, probes, tuple(fitted), tuple(held), tuple(chosen))


def _found(file: ScenarioFile, name: str, mapping: str | Path | None) -> tuple[Source, Plan]:
    source = sources.find(name, mapping=mapping)
    command = plans.template_command(file.name, name, mapping)
    plan = plans.choose(source.plans, file.name, command)
    faults = plans.faults(plan, file.resolve())
    if plan.align.by != "none":
        faults["align.by"] = (
            f"is {plan.align.by}: a fit by waveform needs the scenario's clock to be that of the"
            " recording; read the start off it, and say align: {by: none, …}"
        )
    if not plan.compare:
        faults["compare"] = "compares no probe with a channel; say which"
    plans.refuse(faults, plan, source.plans)
    return source, plan


def _unknowns(
    file: ScenarioFile, plan: Plan, unknowns_: Sequence[str], given: Mapping[str, float]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """What is fitted, and what besides."""
    assert file.fit is not None
    fittable = file.fit.parameters
    names: list[str] = []
    for text in unknowns_:
        name = units.find_name(text, fittable)
        if name is None:
            raise UnknownName(f"parameter of {file.name} that can be fitted", text, fittable)
        names.append(name)
    calibration = plan.calibrate
    if not names:
        names = list(calibration.parameters if calibration is not None else fittable)
    wanted, names = names, [name for name in dict.fromkeys(names) if name not in given]
    if not names:
        fault = f"nothing is left to fit: {', '.join(dict.fromkeys(wanted))} are given"
        raise InputError(file.name, [f"{fault} with --set, --fix or --preset; leave one out"])
    bounds = file.parameters
    fixed = [n for n in names if not bounds[n].max > bounds[n].min]
    if fixed:
        raise InputError(file.name, [f"{name} has no room between its bounds" for name in fixed])
    nuisance = calibration.nuisance if calibration is not None else ()
    return tuple(names), tuple(n for n in nuisance if n not in given and n not in names)


def _split(
    file: ScenarioFile, source: Source, plan: Plan, given: Mapping[str, float]
) -> tuple[list[Segment], list[Segment], Chosen]:
    """Segments that are fitted, and those that are predicted, as a validation has them."""
    calibration = plan.calibrate
    judged = segments_of(file, plan, source.recording, plan.streams, given)
    if calibration is None:
        return judged, [], Chosen(source.name, _streams(judged), source.name, (), stated=False)
    other = source if calibration.recording is None else sources.find(calibration.recording)
    own = plan if calibration.recording is None else plans.choose(other.plans, plan.scenario)
    fitted = segments_of(file, own, other.recording, calibration.streams, given, calibration.most_s)
    if calibration.recording is None:
        names = {case.stream for case in fitted}
        judged = [case for case in judged if case.stream not in names]
    return fitted, judged, Chosen(other.name, _streams(fitted), source.name, _streams(judged))


def _streams(cases: Sequence[Segment]) -> tuple[str, ...]:
    return tuple(case.stream for case in cases)


def _named(cases: Sequence[Segment], source: Source, several: bool) -> list[Segment]:
    """Streams of several recordings may have the same name."""
    if not several:
        return list(cases)
    return [replace(case, stream=f"{source.name}: {case.stream}") for case in cases]
