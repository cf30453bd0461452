"""What a lab holds while it is open: its groups, its queue, and what it was asked already."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field
from typing import Any

from simcompare.lab.desk import Ending, Task
from simcompare.lab.groups import Group, Groups
from simcompare.lab.pin import Pin
from simcompare.lab.queue import DONE, Job, Queue
from simcompare.lab.refusals import Faulty, Refused, say
from simcompare.scenarios import catalogue

#: kinds of jobs that a group may ask for
KINDS = ("run", "fit", "script", "report")
#: most that a job stores for good, such as a report [bytes]; of runs only the latest are kept
_JOB_BYTES = 30 * 10**6
#: what only the server says
_OWN = ("folder", "id", "language", "kind", "group")


@dataclass
class Lab:
    """An open lab.

    Attributes:
        groups: and what they have.
        queue: of their jobs.
        pin: of the teacher.
        address: to scan; empty where the lab is open to this machine alone.
        code: the same as a picture.
    """

    groups: Groups
    queue: Queue
    pin: Pin
    address: str = ""
    code: str = ""
    _known: dict[tuple[object, ...], asyncio.Task[bytes]] = field(default_factory=dict)

    async def job(self, asked: dict[str, Any], language: str) -> Job:
        """Takes in what a group asks for.

        Raises:
            Refused: it may not, or what it names is not there.
        """
        kind = asked.get("kind")
        if kind not in KINDS:
            raise Refused(400, "bad_kind", kind=str(kind), kinds=", ".join(KINDS))
        self.queue.check_open()
        group = await asyncio.to_thread(self._group_for, asked)
        made = Job(group.key, Task(str(kind), {}))
        given = {name: value for name, value in asked.items() if name not in _OWN}
        request = {**given, "folder": str(group.folder), "id": made.id, "language": language}
        made.task = Task(str(kind), request, group.folder / "results" / made.id)
        return self.queue.add(made)

    def _group_for(self, asked: dict[str, Any]) -> Group:
        """The group that asks, if all that it names is there, and room for what comes of it."""
        group = self.groups.join(asked.get("group"))
        scenario = asked.get("scenario")
        if scenario is not None and scenario not in catalogue.names():
            raise Refused(404, "bad_name", name=str(scenario))
        if asked.get("recording") is not None:
            group.recording(asked["recording"])
        if asked.get("result") is not None:
            group.result(asked["result"])
        group.make_room(0 if asked["kind"] == "run" else _JOB_BYTES)
        return group

    async def ask(self, group: str, kind: str, request: dict[str, Any]) -> bytes:
        """Has something done at once, and waits for it.

        Raises:
            Faulty: it could not be done.
        """
        job = self.queue.add(Job(group, Task(kind, request)))
        await job.ended.wait()
        if job.state != DONE:
            raise Faulty(422, faults(job.ending, str(request.get("language", "en"))))
        return job.ending.answer

    async def known(self, kind: str, **request: Any) -> bytes:  # noqa: ANN401
        """What never changes while the lab is open: it is asked for once."""
        key = (kind, *sorted(request.items()))
        task = self._known.get(key)
        if task is None or (task.done() and (task.cancelled() or task.exception())):
            task = self._known[key] = asyncio.create_task(self.ask("", kind, request))
        return await asyncio.shield(task)


def faults(ending: Ending, language: str) -> list[str]:
    """Why a job failed, in sentences."""
    return [*ending.faults, *([say(language, ending.fault)] if ending.fault else [])]
