"""Who has no business here: each is refused, and the page goes on."""

import contextlib
import json
import socket
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.error import HTTPError

from websockets.exceptions import ConnectionClosed, InvalidStatus

from quiesce_benchmarks.live.rig import PATIENCE_S, Page
from quiesce_benchmarks.part import Effort, Measured

TITLE = "strangers: no token, other sites, oversized and malformed messages"
TOKEN = "a-token-of-the-benchmark"
FORMS = ({}, {"Authorization": "Bearer wrong"}, {"Authorization": f"Basic {TOKEN}"},
         {"Cookie": "quiesce_live=wrong"})  # fmt: skip
ORIGINS = ("http://evil.example", "null", "http://127.0.0.1:1", "file://")
MALFORMED = (
    "no JSON",
    "[]",
    '{"do": "fly"}',
    '{"do": "show", "series": [-1]}',
    b"\x00",
    "[" * 4000,
)
RAW = (b"\x00" * 64, b"GET\r\n\r\n", b"GET / HTTP/1.1\r\nHost: a\r\nX: " + b"y" * 100_000)
COUNT = len(FORMS) * 2 + len(ORIGINS) * 2 + len(MALFORMED) + len(RAW) + 1
FIGURES = (("strangers_refused", "1", float(COUNT), "higher"),)


def measure(effort: Effort) -> Measured:
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "token").write_text(TOKEN, encoding="ascii")
        page = Page(Path(name), "--token-file", "token", "--bus", "virtual:live-strangers")
        page.token = TOKEN
        try:
            refused = {what: is_refused() and is_alive(page) for what, is_refused in all_of(page)}
        finally:
            page.end()
    assert len(refused) == COUNT
    return Measured({"strangers_refused": float(sum(refused.values()))}, {"refused": refused})


def all_of(page: Page) -> Iterator[tuple[str, Callable[[], bool]]]:
    mine = {"Authorization": f"Bearer {TOKEN}"}
    for i, form in enumerate(FORMS):
        yield f"websocket, token {i}", lambda form=form: no_socket(page, form)
        yield f"stop, token {i}", lambda form=form: no_post(page, "/stop", form)
    for origin in ORIGINS:
        both = {**mine, "Origin": origin}
        yield f"websocket, {origin}", lambda both=both: no_socket(page, both)
        yield f"stop, {origin}", lambda both=both: no_post(page, "/stop", both)
    for message in MALFORMED:
        yield f"message {message[:20]!r}", lambda message=message: is_told(page, message)
    yield "oversized message", lambda: is_sent_away(page, "x" * 100_000)
    for raw in RAW:
        yield f"bytes {raw[:20]!r}", lambda raw=raw: is_no_request(page, raw)


def no_socket(page: Page, headers: dict[str, str]) -> bool:
    try:
        with page.socket(additional_headers=headers):
            return False
    except InvalidStatus as refusal:
        return refusal.response.status_code == 403


def no_post(page: Page, path: str, headers: dict[str, str]) -> bool:
    try:
        page.post(path, **headers)
    except HTTPError as refusal:
        return refusal.code in (401, 403)
    return False


def is_told(page: Page, message: str | bytes) -> bool:
    with page.viewer() as viewer:
        viewer.send(message)
        while True:
            said = viewer.recv(PATIENCE_S)
            if isinstance(said, str) and "note" in (note := json.loads(said)):
                return not note["note"]["is_ok"]


def is_sent_away(page: Page, message: str) -> bool:
    with page.viewer() as viewer:
        try:
            viewer.send(message)
            while True:
                viewer.recv(PATIENCE_S)
        except ConnectionClosed as closed:
            return closed.rcvd is not None and closed.rcvd.code == 1009


def is_no_request(page: Page, raw: bytes) -> bool:
    """Refused in words of HTTP, or hung up on."""
    answer = b""
    with socket.create_connection(("127.0.0.1", page.port), PATIENCE_S) as line:
        with contextlib.suppress(OSError):  # it may hang up before all is sent
            line.sendall(raw)
            line.shutdown(socket.SHUT_WR)
            answer = line.recv(65536)
    return b" 200 " not in answer


def is_alive(page: Page) -> bool:
    with page.viewer() as viewer:
        return "hello" in json.loads(viewer.recv(PATIENCE_S))
