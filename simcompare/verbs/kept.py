"""What a run keeps while it goes on, so that nothing is lost however it ends.

Each simulation is stored when it has ended; where the run is ended early, ``resume`` goes on.
"""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import io
import json
import shlex
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Integral, Real
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.engine import engines
from simcompare.errors import InputError, OutputError, SimcompareError
from simcompare.model import plain
from simcompare.model.plain import Plain
from simcompare.results import run_record, store, unfinished
from simcompare.results.records.run import Software
from simcompare.results.unfinished import Unfinished
from simcompare.running import messages
from simcompare.running.jobs import MISSING, Job, Outcome
from simcompare.running.wire import Arrays
from simcompare.verbs.request import RunRequest
from simcompare.verbs.result import Result
from simcompare.verbs.run_plan import RunPlan, planned

#: version of what is kept
FORMAT = 1
_ASKED, _ENDED = "asked.json", "{:06}.npz"
_HEAD = "head"


@dataclass(frozen=True)
class _Asked:
    """What a run was asked when it began, and what must not have changed when it goes on."""

    format: int
    created: str
    request: RunRequest
    scenario_sha256: str
    jobs_sha256: str
    software: Software


class Kept:
    """The simulations of one run that have ended, in memory and in its folder.

    Args:
        plan: what the run does.
        out: where its folder is made when the first has ended; nothing is stored where ``None``.
        begun: its folder, where it was begun before.
        outcomes: what was kept then.
        created: when it began.

    Attributes:
        plan: what the run does.
        outcomes: number of the job -> how it ended.
    """

    def __init__(
        self,
        plan: RunPlan,
        out: str | Path | None,
        begun: Unfinished | None = None,
        outcomes: Mapping[int, Outcome] | None = None,
        created: str | None = None,
    ) -> None:
        self.plan, self.outcomes = plan, dict(outcomes or {})
        self._out, self._begun = None if out is None else Path(out), begun
        self._created = created or run_record.now()
        self._numbers = {id(job): number for number, job in enumerate(plan.jobs)}

    @classmethod
    def of(cls, place: Path) -> Kept:
        """What a run that was ended early has kept.

        Raises:
            InputError: there is no such run, it still goes on, or what it was begun with has
                changed.
        """
        begun = unfinished.opened(place)
        try:
            parts = begun.parts()
            asked = _asked(place, parts)
            plan = planned(asked.request)
            _check(place, asked, plan)
            kept = dict(_read(parts, plan.jobs))
            _check_engines(place, asked, kept.values())
        except BaseException:
            begun.close()
            raise
        return cls(plan, place.parent, begun, kept, asked.created)

    @property
    def missing(self) -> list[Job]:
        """The simulations that have not ended."""
        return [job for number, job in enumerate(self.plan.jobs) if number not in self.outcomes]

    def keep(self, job: Job, outcome: Outcome) -> None:
        """Takes one that has ended; an engine that is missing may be there the next time.

        Raises:
            OutputError: it cannot be stored; says what is.
        """
        number = self._numbers[id(job)]
        if self._out is not None and outcome.status != MISSING:
            try:
                self._store(self._out, number, outcome)
            except OutputError as error:
                raise OutputError(f"{error}{self._told()}") from None
        self.outcomes[number] = outcome

    def _store(self, out: Path, number: int, outcome: Outcome) -> None:
        if self._begun is None:
            name = self.plan.steps[0].nominal.name
            self._begun = unfinished.begin(out, self._created, name)
            self._begun.add(_ASKED, self._asked())
        self._begun.add(_ENDED.format(number), _packed(*messages.sent(number, outcome)))

    def all(self, new: Iterable[Outcome]) -> list[Outcome]:
        """How every simulation ended, in the order of the plan.

        Args:
            new: how those ended that were missing before.
        """
        by_number = {self._numbers[id(outcome.job)]: outcome for outcome in new}
        return [
            by_number.get(number) or self.outcomes[number] for number in range(len(self.plan.jobs))
        ]

    def stored(self, result: Result) -> Result:
        """The run, stored in the folder in which its simulations were kept.

        Raises:
            OutputError: it cannot be written; says what is kept.
        """
        record = dataclasses.replace(result.record, created=self._created)
        result = dataclasses.replace(result, record=record)
        if self._out is None:
            return result
        try:
            return store.save(result, self._out, begun=self._begun)
        except OutputError as error:
            raise OutputError(f"{error}{self._told()}") from None

    def close(self) -> None:
        """Lets others go on with the run; deletes its folder where nothing is kept in it."""
        if self._begun is not None and not self.outcomes:
            self._begun.drop()
        elif self._begun is not None:
            self._begun.close()

    def _told(self) -> str:
        if self._begun is None or not self.outcomes:
            return ""
        done = f"{len(self.outcomes)} of {len(self.plan.jobs)} simulations are kept"
        return f"\n{done}; go on when there is room: {unfinished.resuming(self._begun.folder)}"

    def _asked(self) -> bytes:
        plan = self.plan
        asked = {
            "format": FORMAT,
            "created": self._created,
            "request": dataclasses.asdict(plan.request),
            "scenario_sha256": run_record.sha256_of(plan.file),
            "jobs_sha256": _digest(plan.jobs),
            "software": dataclasses.asdict(run_record.software()),
        }
        return json.dumps(asked, default=_plain, ensure_ascii=False, indent=1).encode()


def request_of(place: Path) -> RunRequest:
    """What a run that was ended early was asked.

    Raises:
        InputError: there is no such run.
    """
    with contextlib.closing(unfinished.opened(place)) as begun:
        return _asked(place, begun.parts()).request


def _asked(place: Path, parts: Mapping[str, bytes]) -> _Asked:
    try:
        found = json.loads(parts[_ASKED])
        if found["format"] != FORMAT:
            raise ValueError(f"its format is {found['format']!r}; expected {FORMAT}")
        return plain.of_plain(_Asked, found)
    except (KeyError, TypeError, ValueError):
        fault = f"what it was asked cannot be read from {unfinished.PARTS}/{_ASKED}; run it again"
        raise InputError(str(place), [fault]) from None


def _check(place: Path, asked: _Asked, plan: RunPlan) -> None:
    """Refuses to mix what was simulated before a change with what comes after it."""
    faults = []
    for name, now in dataclasses.asdict(run_record.software()).items():
        then = getattr(asked.software, name)
        if now != then:
            faults.append(f"it was begun with {name} {then}, and this is {now}")
    if asked.scenario_sha256 != run_record.sha256_of(plan.file):
        faults.append(f"{plan.file.path} has changed since it began")
    elif asked.jobs_sha256 != _digest(plan.jobs):
        faults.append("what it would simulate now is not what it began with")
    _refuse(place, asked, faults)


def _check_engines(place: Path, asked: _Asked, kept: Iterable[Outcome]) -> None:
    faults = {}
    for outcome in kept:
        name, then = outcome.job.engine, outcome.facts.version
        if then is not None and name not in faults and (now := _version(name)) != then:
            faults[name] = f"it was begun with {name} {then}, and here is {now or 'none'}"
    _refuse(place, asked, list(faults.values()))


def _version(engine: str) -> str | None:
    try:
        return str(engines.get(engine).version())
    except SimcompareError:
        return None


def _refuse(place: Path, asked: _Asked, faults: Sequence[str]) -> None:
    if faults:
        again = f"run it again: {shlex.join(asked.request.command())}"
        raise InputError(str(place), [*faults[:-1], f"{faults[-1]}; {again}"])


def _read(parts: Mapping[str, bytes], jobs: Sequence[Job]) -> Iterable[tuple[int, Outcome]]:
    """What was kept; what cannot be read is simulated once more."""
    for number, job in enumerate(jobs):
        content = parts.get(_ENDED.format(number))
        if content is None:
            continue
        try:
            found = messages.received(number, job, *_unpacked(content))
        except Exception:  # noqa: BLE001  (a damaged file may be anything)
            continue
        assert isinstance(found, Outcome)
        yield number, found


def _packed(head: Plain, arrays: Arrays) -> bytes:
    """A file of NumPy, packed as fast as can be: it lasts no longer than the run."""
    text = np.frombuffer(json.dumps(head).encode(), np.uint8)
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as packed:
        for name, array in [(_HEAD, text), *((f"a{i}", one) for i, one in enumerate(arrays))]:
            with packed.open(f"{name}.npy", "w", force_zip64=True) as part:
                np.lib.format.write_array(part, array, allow_pickle=False)
    return file.getvalue()


def _unpacked(content: bytes) -> tuple[Plain, Arrays]:
    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        arrays = [file[f"a{i}"] for i in range(len(file.files) - 1)]
        return json.loads(file[_HEAD].tobytes()), arrays


def _digest(jobs: Sequence[Job]) -> str:
    """The same for jobs that simulate the same."""
    scenes: dict[int, str] = {}
    found = hashlib.sha256()
    for job in jobs:
        scene = scenes.setdefault(id(job.scenario), repr(job.scenario))
        # a set has no order that holds from one process to the next
        helps = None if job.settings.helps is None else sorted(job.settings.helps)
        settings = dataclasses.replace(job.settings, helps=None)
        whose = (job.engine, job.repeat, job.label, job.without, job.at, helps)
        found.update(f"{whose}{settings}{scene}".encode())
    return found.hexdigest()


def _plain(value: Any) -> Any:  # noqa: ANN401
    """What JSON does not know by itself."""
    if isinstance(value, Real):
        return int(value) if isinstance(value, Integral) else float(value)
    return str(value) if isinstance(value, Path) else list(value)
