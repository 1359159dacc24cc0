"""Connections of whom nobody knows yet whether they may come in: few, and not for long, so that
strangers who only hold the line cannot take the places of those who have the token."""

import asyncio
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

Client = tuple[str, int]  # address and port

STRANGER_S = 10.0  # to send a request that is let in
MOST_OF_ADDRESS = 16
MOST_STRANGERS = 64


class Crowd:
    """Who comes is always taken; where there are too many it is the oldest stranger who goes, of
    the same address first."""

    def __init__(self) -> None:
        self._strangers: dict[Client, tuple[asyncio.Transport, asyncio.TimerHandle]] = {}

    def come(self, client: Client, transport: asyncio.Transport) -> None:
        """In the server's loop, as all here."""
        loop = asyncio.get_running_loop()
        self.leave(client)
        self._strangers[client] = transport, loop.call_later(STRANGER_S, self._hang_up, client)
        of_address = [one for one in self._strangers if one[0] == client[0]]
        if len(of_address) > MOST_OF_ADDRESS:
            self._hang_up(of_address[0])
        elif len(self._strangers) > MOST_STRANGERS:
            self._hang_up(next(iter(self._strangers)))

    def leave(self, client: Client) -> None:
        """He is gone, or no stranger any more."""
        _, timer = self._strangers.pop(client, (None, None))
        if timer is not None:
            timer.cancel()

    def _hang_up(self, client: Client) -> None:
        transport, _ = self._strangers[client]
        self.leave(client)
        transport.abort()  # without waiting for what he does not read

    @property
    def protocol(self) -> type[H11Protocol]:
        """HTTP whose connections are strangers at first."""
        crowd = self

        class Watched(H11Protocol):
            def connection_made(self, transport: Any) -> None:
                super().connection_made(transport)
                if self.client is not None:
                    crowd.come(self.client, transport)

            def connection_lost(self, exc: Exception | None) -> None:
                if self.client is not None:
                    crowd.leave(self.client)
                super().connection_lost(exc)

        return Watched
