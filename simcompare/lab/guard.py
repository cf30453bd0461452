"""What stands before every page of the lab: who may ask, and what a browser may do with it."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING

from simcompare.lab import refusals

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

#: what pages of the lab may load: nothing from elsewhere, no script that stands in them
PAGE_POLICY = "; ".join(
    (
        "default-src 'self'",
        "script-src 'self'",
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' blob: data:",
        "media-src 'self' blob: data:",
        "worker-src 'self' blob:",
        "object-src 'none'",
        "base-uri 'none'",
        "form-action 'self'",
        "frame-ancestors 'none'",
    )
)
#: what a report may do: its own scripts run, but it is a stranger to the lab and to the net
REPORT_POLICY = "; ".join(
    (
        "sandbox allow-scripts allow-downloads",
        "default-src 'none'",
        "script-src 'unsafe-inline' blob:",
        "style-src 'unsafe-inline'",
        "img-src data: blob:",
        "font-src data:",
        "worker-src blob:",
        "frame-ancestors 'self'",
    )
)
_HEADERS = {
    "content-security-policy": PAGE_POLICY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "microphone=(self), camera=(), geolocation=()",
    "cache-control": "no-store",
}
_HARMLESS = ("GET", "HEAD", "OPTIONS")


class Guard:
    """Refuses requests of other pages and under other names; adds the headers of safety.

    Args:
        app: what is guarded.
        hosts: names and addresses by which the lab is known.
    """

    def __init__(self, app: ASGIApp, hosts: Collection[str]) -> None:
        self._app, self._hosts = app, frozenset(host.lower() for host in hosts)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers a request."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
        elif scope["type"] == "http":
            await self._answer(scope, receive, send)

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = _with_ours(message["headers"])
            await send(message)

        headers = {
            name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]
        }
        fault = self._fault(scope["method"], headers)
        if fault:
            await _refuse(guarded, fault, headers)
        else:
            await self._app(scope, receive, guarded)

    def _fault(self, method: str, headers: dict[str, str]) -> str:
        """Why a request is not answered; empty where it is."""
        host = headers.get("host", "")
        if name_of(host) not in self._hosts:
            return "bad_host"
        if method in _HARMLESS:
            return ""
        origin = headers.get("origin")
        if origin is not None and origin.partition("://")[2] != host:
            return "foreign"
        return "" if headers.get("sec-fetch-site", "none") in ("none", "same-origin") else "foreign"


def name_of(host: str) -> str:
    """The name in a Host header, without its port."""
    if host.startswith("["):
        return host[1:].partition("]")[0].lower()
    return host.partition(":")[0].lower()


async def _refuse(send: Send, fault: str, headers: dict[str, str]) -> None:
    language = refusals.language_of(None, headers.get("accept-language", ""))
    body = json.dumps({"faults": [refusals.say(language, fault)]}).encode()
    given = [(b"content-type", b"application/json"), (b"content-length", b"%d" % len(body))]
    await send({"type": "http.response.start", "status": 403, "headers": given})
    await send({"type": "http.response.body", "body": body})


def _with_ours(given: Iterable[tuple[bytes, bytes]]) -> list[tuple[bytes, bytes]]:
    """Headers of an answer and ours; what the answer says itself stays."""
    kept = [(name, value) for name, value in given if name.lower() != b"set-cookie"]
    said = {name.lower() for name, _ in kept}
    ours = ((name.encode(), value.encode()) for name, value in _HEADERS.items())
    return kept + [(name, value) for name, value in ours if name not in said]
