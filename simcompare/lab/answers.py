"""Answers of the lab: the language that they speak, and what is said where something is refused."""

from __future__ import annotations

from typing import Any

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response

from simcompare.hardware import confined
from simcompare.lab import delivery, refusals
from simcompare.lab.refusals import Faulty, Refused, say


def language(request: Request) -> str:
    """The language that a request wants."""
    accepted = request.headers.get("accept-language", "")
    return refusals.language_of(request.query_params.get("lang"), accepted)


def said(request: Request, value: object, status: int = 200) -> Response:
    """A value as JSON."""
    return delivery.json_of(request, delivery.spoken(value), status)


async def _refused(request: Request, error: Exception) -> Response:
    assert isinstance(error, Refused)
    return _faulty(request, [say(language(request), error.key, **error.values)], error.status)


async def _told(request: Request, error: Exception) -> Response:
    assert isinstance(error, Faulty)
    return _faulty(request, error.faults, error.status)


async def _of_http(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    key = {404: "no_page", 405: "no_method"}.get(error.status_code, "bad_json")
    return _faulty(request, [say(language(request), key)], error.status_code)


async def _of_system(request: Request, error: Exception) -> Response:
    if not confined.is_full(error):
        raise error
    return _faulty(request, [say(language(request), "disk_full")], 507)


async def _wrong(request: Request, _: Exception) -> Response:
    return _faulty(request, [say(language(request), "wrong")], 500)


def _faulty(request: Request, sentences: list[str], status: int) -> Response:
    return said(request, {"faults": sentences}, status)


#: what answers each kind of error
FAULTS: Any = {
    Refused: _refused,
    Faulty: _told,
    HTTPException: _of_http,
    OSError: _of_system,
    Exception: _wrong,
}
