"""The server of the lab, from its first moment to Ctrl-C."""

from __future__ import annotations

import contextlib
import os
import secrets
import socket
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import uvicorn
from starlette.types import ASGIApp

from simcompare.errors import InputError
from simcompare.lab import application, share
from simcompare.lab.connections import Connection
from simcompare.lab.desk import Perform
from simcompare.lab.groups import Groups
from simcompare.lab.laboratory import Lab
from simcompare.lab.pin import Pin
from simcompare.lab.queue import Queue
from simcompare.running import interruption

#: connections at once; time that answers in work get at the end, and that idle ones are kept [s]
_CONNECTIONS, _LAST_S, _IDLE_S = 500, 1, 15


@dataclass(frozen=True)
class Wanted:
    """How a lab is to be opened.

    Attributes:
        folder: of results.
        port: to listen at; 0 takes a free one.
        shared: whether others may come in.
        host: name or address that they use; empty: found out.
        pin: of the teacher; where it is ``None`` and others may come in, one is made.
    """

    folder: Path
    port: int = 8000
    shared: bool = False
    host: str = ""
    pin: str | None = None


@dataclass(frozen=True)
class Opened:
    """A lab that is ready to be served.

    Attributes:
        lab: what it holds.
        server: that serves it.
        listening: where.
        address: for this machine.
        pin: of the teacher, where one is wanted.
        fingerprint: of its certificate, where it has one.
    """

    lab: Lab
    server: uvicorn.Server
    listening: socket.socket
    address: str
    pin: str | None
    fingerprint: str


class _Server(uvicorn.Server):  # type: ignore[misc]
    """Leaves signals to us."""

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


def open_lab(wanted: Wanted, perform: Perform) -> Opened:
    """Makes all ready.

    Args:
        wanted: how it is to be opened.
        perform: what a job does.

    Raises:
        InputError: the folder cannot be written, the port is taken, or no phone gets here.
    """
    hosts = [*share.LOCAL, *(_outside(wanted) if wanted.shared else ())]
    groups = _groups(wanted.folder)
    listening = _listen(wanted)
    port = int(listening.getsockname()[1])
    pin = wanted.pin or (f"{secrets.randbelow(10**6):06d}" if wanted.shared else None)
    lab = Lab(groups, Queue(perform, os.cpu_count() or 2), Pin(pin))
    certificate = share.certificate(groups.folder, hosts) if wanted.shared else None
    if wanted.shared:
        lab.address = share.url(hosts[len(share.LOCAL)], port, secure=True)
        lab.code = share.code(lab.address)
    server = _server(application.build(lab, hosts), certificate)
    here = share.url("127.0.0.1", port, secure=wanted.shared)
    return Opened(lab, server, listening, here, pin, certificate.fingerprint if certificate else "")


def serve(opened: Opened, begun: Callable[[], None] = lambda: None) -> None:
    """Serves until Ctrl-C.

    Args:
        opened: the lab.
        begun: called before.
    """

    def leave() -> None:
        opened.server.should_exit = True

    with interruption.held(leave):
        begun()
        opened.server.run(sockets=[opened.listening])
        interruption.answer()


def _server(app: ASGIApp, certificate: share.Certificate | None) -> uvicorn.Server:
    config = uvicorn.Config(
        app,
        loop="asyncio",
        http=Connection,
        ws="none",
        lifespan="on",
        log_level="error",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        limit_concurrency=_CONNECTIONS,
        timeout_keep_alive=_IDLE_S,
        timeout_graceful_shutdown=_LAST_S,
        ssl_certfile=certificate.path if certificate else None,
    )
    return _Server(config)


def _outside(wanted: Wanted) -> list[str]:
    """Names and addresses by which others reach this machine, that to be scanned first.

    Raises:
        InputError: what they are told to use is none, or there is none.
    """
    found = share.addresses()
    if wanted.host:
        try:
            found.insert(0, share.host(wanted.host))
        except ValueError:
            cure = "give it without https:// and without a port, such as 192.168.1.5"
            fault = f"is no name or address of a computer; {cure}"
            raise InputError(f"--host {wanted.host:.60}", [fault]) from None
    if not found:
        cure = "join the Wi-Fi and start again, or leave out --share"
        raise InputError("--share", [f"no phone can get here without a network; {cure}"])
    return [*dict.fromkeys([*found, *share.names()])]


def _groups(folder: Path) -> Groups:
    try:
        return Groups(folder)
    except OSError as error:
        raise InputError(f"--folder {folder}", [f"cannot be written: {error.strerror}"]) from None


def _listen(wanted: Wanted) -> socket.socket:
    """A socket that listens: to this machine alone, or to all with either kind of address.

    Raises:
        InputError: the port is taken.
    """
    port, both = wanted.port, wanted.shared and socket.has_dualstack_ipv6()
    family = socket.AF_INET6 if both else socket.AF_INET
    address = ("" if wanted.shared else "127.0.0.1", port)
    try:
        return socket.create_server(
            address, family=family, backlog=_CONNECTIONS, dualstack_ipv6=both
        )
    except OSError as error:
        other = port + 1 if 1024 <= port < 65535 else 8000
        fault = f"cannot be had: {os.strerror(error.errno or 0)}; cure: simcompare lab --port"
        raise InputError(f"--port {port}", [f"{fault} {other}"]) from None
