"""The routes of the lab; each answers at once or waits, none computes."""

from __future__ import annotations

import asyncio
import contextlib
import shutil
from collections.abc import AsyncIterator, Collection
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route
from starlette.types import ASGIApp

from simcompare.lab import contents, delivery, uploads
from simcompare.lab.answers import FAULTS, language, said
from simcompare.lab.groups import Group
from simcompare.lab.guard import Guard
from simcompare.lab.laboratory import Lab, faults
from simcompare.lab.queue import DONE, FAILED, Job
from simcompare.lab.refusals import Faulty, Refused, say
from simcompare.model import whole
from simcompare.scenarios import catalogue

#: longest time that an answer waits for a job [s]
_LONGEST_WAIT_S = 20.0


def build(lab: Lab, hosts: Collection[str]) -> ASGIApp:
    """The lab as an application of ASGI.

    Args:
        lab: what it holds.
        hosts: names and addresses by which it is known.
    """

    @contextlib.asynccontextmanager
    async def life(_: Starlette) -> AsyncIterator[None]:
        lab.queue.begin()
        try:
            yield
        finally:
            await lab.queue.end()

    app = Starlette(routes=_ROUTES, lifespan=life, exception_handlers=FAULTS)
    app.state.lab = lab
    return Guard(app, hosts)


def _lab(request: Request) -> Lab:
    found: Lab = request.app.state.lab
    return found


# ---- pages


def _page(request: Request) -> Response:
    body = delivery.page("index.html", language(request))
    return Response(body, media_type="text/html")


def _teacher_page(request: Request) -> Response:
    pin = "yes" if _lab(request).pin.is_wanted else "no"
    body = delivery.page("teacher.html", language(request), pin=pin)
    return Response(body, media_type="text/html")


def _static(request: Request) -> Response:
    return delivery.static(request, request.path_params["name"])


def _file(request: Request) -> Response:
    group = _lab(request).groups.find(request.path_params["group"])
    path = group.file(request.path_params["name"])
    return delivery.file(path, downloaded="download" in request.query_params)


# ---- what can be simulated


async def _scenarios(request: Request) -> Response:
    answer = await _lab(request).known("scenarios", language=language(request))
    return delivery.json_of(request, answer)


async def _scenario(request: Request) -> Response:
    name = request.path_params["name"]
    if name not in catalogue.names():
        raise Refused(404, "bad_name", name=name)
    answer = await _lab(request).known("scenario", name=name, language=language(request))
    return delivery.json_of(request, answer)


# ---- jobs


async def _add_job(request: Request) -> Response:
    lab, asked = _lab(request), await uploads.document(request)
    job = await lab.job(asked, language(request))
    return said(request, {"id": job.id, "place": lab.queue.place(job)}, 202)


async def _job(request: Request) -> Response:
    lab, job_id = _lab(request), request.path_params["id"]
    job = lab.queue.find(job_id)
    if job is not None:
        await _wait(job, request.query_params.get("wait", "0"))
    if job is None or job.state == DONE:
        return await asyncio.to_thread(_stored, request, job_id)
    return said(request, _state(lab, job, language(request)))


async def _wait(job: Job, text: str) -> None:
    """Waits until a job has ended, or as long as is asked for."""
    seconds = float(text) if text.isdecimal() and len(text) < 4 else 0.0
    with contextlib.suppress(TimeoutError):
        await asyncio.wait_for(job.ended.wait(), min(seconds, _LONGEST_WAIT_S))


def _state(lab: Lab, job: Job, spoken: str) -> dict[str, Any]:
    told = {"state": job.state, "place": lab.queue.place(job)}
    return told | ({"faults": faults(job.ending, spoken)} if job.state == FAILED else {})


def _stored(request: Request, job_id: str) -> Response:
    """The result of a job that is done, also one from before a restart."""
    place = _lab(request).groups.result(job_id)
    if place is None:
        raise Refused(404, "no_job")
    return delivery.json_of(request, (place / "result.json").read_bytes())


# ---- recordings


async def _add_recording(request: Request) -> Response:
    lab, asked = _lab(request), request.query_params
    lab.queue.check_open()
    group = await asyncio.to_thread(lab.groups.join, asked.get("group"))
    wish, name = asked.get("kind", ""), asked.get("name", "")
    upload = await uploads.recording(request, group, name, wish)
    try:
        return await _hear(request, group, upload)
    except (Faulty, Refused):
        place = group.recording(upload.id)
        await asyncio.to_thread(shutil.rmtree, place, ignore_errors=True)
        raise


async def _hear(request: Request, group: Group, upload: uploads.Upload) -> Response:
    """Finds what is in a recording, and keeps it."""
    kind = "film" if upload.kind == contents.VIDEO else "recording"
    question = {"id": upload.id, "kind": upload.kind, "path": str(upload.path), "name": upload.name}
    answer = await _ask_about(request, group, kind, question)
    return await _keep_recording(request, group, upload.id, {"kind": upload.kind}, answer)


async def _scale(request: Request) -> Response:
    lab, recording_id = _lab(request), request.path_params["id"]
    asked = await uploads.document(request)
    group = lab.groups.find(str(asked.get("group") or request.query_params.get("group", "")))
    group.recording(recording_id)
    question = {"recording": recording_id} | {
        name: asked.get(name) for name in ("points", "metres")
    }
    answer = await _ask_about(request, group, "scale", question)
    return await _keep_recording(request, group, recording_id, {"kind": contents.VIDEO}, answer)


async def _ask_about(request: Request, group: Group, kind: str, question: dict[str, Any]) -> bytes:
    rest = {"folder": str(group.folder), "language": language(request)}
    return await _lab(request).ask(group.key, kind, question | rest)


async def _keep_recording(
    request: Request, group: Group, recording_id: str, head: dict[str, str], answer: bytes
) -> Response:
    """Stores what was found in a recording, and answers with it."""
    told = delivery.spoken({"id": recording_id, **head})
    joined = told if answer == b"{}" else told[:-1] + b"," + answer[1:]
    place = group.recording(recording_id) / "recording.json"
    await asyncio.to_thread(whole.write, place, joined)
    return delivery.json_of(request, joined)


async def _recording(request: Request) -> Response:
    group = _lab(request).groups.find(request.path_params["group"])
    place = group.recording(request.path_params["id"])
    found = place / "recording.json"
    if not found.is_file():  # the lab ended before it had been looked at
        return await _hear(request, group, uploads.kept(place))
    return delivery.json_of(request, await asyncio.to_thread(found.read_bytes))


# ---- groups


def _group(request: Request) -> Response:
    group = _lab(request).groups.find(request.path_params["group"])
    return said(request, group.listing())


def _result(request: Request) -> Response:
    group = _lab(request).groups.find(request.path_params["group"])
    place = group.result(request.path_params["id"])
    return delivery.json_of(request, (place / "result.json").read_bytes())


def _share(request: Request) -> Response:
    lab = _lab(request)
    if not lab.address:
        return said(request, {})
    warning = say(language(request), "share_warning")
    return said(request, {"url": lab.address, "qr_svg": lab.code, "sentence": warning})


# ---- the teacher


def _check_pin(request: Request) -> Lab:
    lab = _lab(request)
    address = request.client.host if request.client else ""
    lab.pin.check(request.headers.get("x-pin", ""), address)
    return lab


def _teacher(request: Request) -> Response:
    lab = _check_pin(request)
    return said(request, {**_open(lab), "groups": [one.listing() for one in lab.groups.all()]})


async def _teacher_queue(request: Request) -> Response:
    lab = _check_pin(request)
    lab.queue.is_open = bool((await uploads.document(request)).get("open", True))
    return said(request, _open(lab))


def _open(lab: Lab) -> dict[str, object]:
    return {"open": lab.queue.is_open, "waiting": lab.queue.waiting}


#: the name of a group may hold a slash: it is no path, only its hash names a folder
_ROUTES = [
    Route("/", _page),
    Route("/teacher", _teacher_page),
    Route("/static/{name}", _static),
    Route("/files/{group:path}/{name}", _file),
    Route("/api/scenarios", _scenarios),
    Route("/api/scenarios/{name}", _scenario),
    Route("/api/jobs", _add_job, methods=["POST"]),
    Route("/api/jobs/{id}", _job),
    Route("/api/recordings", _add_recording, methods=["POST"]),
    Route("/api/recordings/{id}/scale", _scale, methods=["POST"]),
    Route("/api/recordings/{group:path}/{id}", _recording),
    Route("/api/groups/{group:path}", _group),
    Route("/api/results/{group:path}/{id}", _result),
    Route("/api/share", _share),
    Route("/api/teacher", _teacher),
    Route("/api/teacher/queue", _teacher_queue, methods=["POST"]),
]
