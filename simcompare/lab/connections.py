"""Connections to the lab: who keeps one without asking anything gives it back."""

from __future__ import annotations

import asyncio

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

#: longest time until the head of a request has come [s]
_HEAD_S = 15.0


class Connection(H11Protocol):  # type: ignore[misc]
    """A connection that is closed where the head of a request does not come in time.

    One address has at most half of all connections, so that no single device keeps the others out.
    """

    _late: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:
        """Takes a connection, unless its address has too many."""
        super().connection_made(transport)
        address = (self.client or "?")[0]  # it may have gone already
        own = sum((one.client or "?")[0] == address for one in self.connections)
        if 2 * own > self.limit_concurrency:
            transport.abort()
        else:
            self._wait_for_head()

    def data_received(self, data: bytes) -> None:
        """Takes what comes; each request has its own time."""
        super().data_received(data)
        if self.conn.their_state is not h11.IDLE:
            self._end_waiting()
        is_let_go_by = self.conn.our_state is h11.DONE  # the rest of what was refused already
        if self.conn.their_state is h11.IDLE or is_let_go_by:
            self._wait_for_head()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forgets the connection."""
        self._end_waiting()
        super().connection_lost(exc)

    def _wait_for_head(self) -> None:
        if self._late is None:
            self._late = self.loop.call_later(_HEAD_S, self.timeout_keep_alive_handler)

    def _end_waiting(self) -> None:
        if self._late is not None:
            self._late.cancel()
            self._late = None
