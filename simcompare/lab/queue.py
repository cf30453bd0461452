"""Jobs of several groups, taken in turn: ten of one group do not keep the others waiting."""

from __future__ import annotations

import asyncio
import secrets
import traceback
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from simcompare.lab.desk import Desk, Ending, Perform, Task
from simcompare.lab.refusals import Refused

#: states of a job
WAITING, RUNNING, DONE, FAILED = "waiting", "running", "done", "failed"
#: jobs that one group may have waiting, and all together; jobs that are remembered
_OF_A_GROUP, _OF_ALL, _KEPT = 20, 1000, 5000
#: kinds of jobs that take long: one worker is kept free of them, so that sliders answer at once
LONG = ("fit", "report", "film")
#: kinds of which recordings are read, by one worker that has no engines: beside them each reading
#: would begin a Python of its own, which takes four times as long as what it does
READING = ("recording", "scale")
#: longest time for a job [s]
LIMIT_S = 120.0


@dataclass(eq=False)
class Job:
    """What a group wants to have done.

    Attributes:
        group: key of the group.
        task: what is to be done.
        id: cannot be guessed.
        state: waiting, running, done or failed.
        ending: how it ended.
        ended: set when it has.
    """

    group: str
    task: Task
    id: str = field(default_factory=lambda: secrets.token_hex(8))
    state: str = WAITING
    ending: Ending = field(default_factory=Ending)
    ended: asyncio.Event = field(default_factory=asyncio.Event)


class Queue:
    """Jobs and the workers that do them; used within one event loop.

    Args:
        perform: what a job does.
        workers: how many work at once.
        limits_s: longest times for kinds of jobs, where they are not the usual one.
    """

    def __init__(
        self, perform: Perform, workers: int, limits_s: Mapping[str, float] | None = None
    ) -> None:
        self._perform, self._count, self._limits_s = perform, workers, dict(limits_s or {})
        self._waiting: list[Job] = []
        self._running: list[Job] = []
        self._jobs: dict[str, Job] = {}
        self._served: dict[str, int] = {}
        self._came = asyncio.Event()
        self._desks: list[Desk] = []
        self._clerks: list[asyncio.Task[None]] = []
        self.is_open = True

    def begin(self) -> None:
        """Starts the workers."""
        self._desks = [Desk(self._perform) for _ in range(self._count)]
        self._desks.append(Desk(self._perform, "warm_reader"))
        self._clerks = [asyncio.create_task(self._serve(desk)) for desk in self._desks]

    async def end(self) -> None:
        """Ends the workers; jobs that wait are lost."""
        for clerk in self._clerks:
            clerk.cancel()
        await asyncio.gather(*self._clerks, return_exceptions=True)
        await asyncio.gather(*(asyncio.to_thread(desk.end) for desk in self._desks))

    @property
    def workers(self) -> int:
        """How many jobs run at once, beside those that read."""
        return self._count

    @property
    def waiting(self) -> int:
        """How many jobs wait."""
        return len(self._waiting)

    def check_open(self) -> None:
        """Raises ``Refused`` while the queue is closed."""
        if not self.is_open:
            raise Refused(503, "closed")

    def add(self, job: Job) -> Job:
        """Takes a job in; one of no group, as pages need it to open, also while it is closed.

        Raises:
            Refused: the queue is closed, or too many wait already.
        """
        if job.group:
            self.check_open()
        own = sum(other.group == job.group for other in self._waiting)
        if own >= _OF_A_GROUP or len(self._waiting) >= _OF_ALL:
            raise Refused(429, "too_many_jobs", waiting=own or len(self._waiting))
        self._waiting.append(job)
        self._jobs[job.id] = job
        self._forget()
        self._came.set()
        return job

    def find(self, job_id: str) -> Job | None:
        """The job of this id, where it is remembered."""
        return self._jobs.get(job_id)

    def place(self, job: Job) -> int:
        """Its place in the row, the first is 1; 0 where it has begun."""
        if job not in self._waiting:
            return 0
        return self._order().index(job) + 1

    def _order(self) -> list[Job]:
        """The waiting jobs, as they would begin if none came or ended."""
        return in_turn(
            [(job.group, job) for job in self._waiting],
            Counter(job.group for job in self._running),
            self._served,
        )

    async def _serve(self, desk: Desk) -> None:
        while True:
            while (job := self._next(desk)) is None:
                self._came.clear()
                await self._came.wait()
            self._waiting.remove(job)
            self._served[job.group] = max(self._served.values(), default=0) + 1
            await self._run(job, desk)

    def _next(self, desk: Desk) -> Job | None:
        """The job whose turn it is at a desk."""
        return next((job for job in self._order() if self._takes(desk, job.task.kind)), None)

    def _takes(self, desk: Desk, kind: str) -> bool:
        first, reader = self._desks[0], self._desks[-1]
        if kind in READING or desk is reader:
            return kind in READING and desk is reader
        return kind not in LONG or desk is not first or self._count == 1

    async def _run(self, job: Job, desk: Desk) -> None:
        job.state = RUNNING
        self._running.append(job)
        try:
            ending = await desk.do(job.task, self._limits_s.get(job.task.kind, LIMIT_S))
        except OSError:  # the system lets no new worker begin; other jobs still want an answer
            traceback.print_exc()
            ending = Ending(fault="died")
        finally:
            self._running.remove(job)
        self._end(job, ending)

    def _end(self, job: Job, ending: Ending) -> None:
        job.ending = ending
        job.state = DONE if ending.is_fine else FAILED
        job.ended.set()

    def _forget(self) -> None:
        """Lets the oldest jobs go that have ended."""
        over = len(self._jobs) - _KEPT
        for job_id in [one.id for one in self._jobs.values() if one.ended.is_set()][: max(over, 0)]:
            del self._jobs[job_id]


def in_turn(
    waiting: Sequence[tuple[str, Job]], running: Mapping[str, int], served: Mapping[str, int]
) -> list[Job]:
    """The order in which jobs begin: of the group with the fewest in work, then served longest ago.

    Args:
        waiting: groups and jobs as they came.
        running: jobs of each group in work.
        served: when each group was served last, as a number that grows.
    """
    had = Counter(running)
    keyed = []
    for came, (group, job) in enumerate(waiting):
        keyed.append((had[group], served.get(group, 0), came, job))
        had[group] += 1
    return [job for *_, job in sorted(keyed, key=lambda one: one[:3])]
