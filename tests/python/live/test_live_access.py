"""Who gets into the live page: names, origins, tokens; and what the command refuses."""

import contextlib
import socket
from collections.abc import Iterator
from http.client import HTTPConnection
from pathlib import Path

import pytest
from live_page import Page
from quiesce.live.access import Policy, is_local
from quiesce.live.crowd import MOST_OF_ADDRESS
from quiesce.live.server import CONNECTIONS
from quiesce_benchmarks.live.rig import PATIENCE_S
from websockets.exceptions import InvalidStatus

TOKEN = "correct-horse-battery"


def scope(kind: str = "http", method: str = "GET", path: str = "/", **headers: str) -> dict:
    named = [(n.replace("_", "-").encode(), v.encode("latin-1")) for n, v in headers.items()]
    return {"type": kind, "method": method, "path": path, "headers": named}


LOCAL = Policy("127.0.0.1")
OPEN = Policy("0.0.0.0", TOKEN)


@pytest.mark.parametrize(
    "host", ["127.0.0.1:8642", "localhost:8642", "LOCALHOST", "[::1]:8642", "127.0.0.1"]
)
def test_own_names_are_let_in(host: str) -> None:
    assert LOCAL.refusal(scope(host=host)) is None


@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:8642", "127.0.0.1.evil.example", "localhost.evil.example", "",
     "user@127.0.0.1", "127.0.0.1:x", "127.0.0.1/evil", "[::1", "10.0.0.5:8642", "0.0.0.0:8642"],
)  # fmt: skip
def test_other_names_are_refused(host: str) -> None:
    refusal = LOCAL.refusal(scope(host=host))
    assert refusal is not None and refusal.status == 421


def test_a_request_without_a_name_is_refused() -> None:
    assert LOCAL.refusal(scope()).status == 421
    assert Policy("0.0.0.0").refusal(scope(host="a")).status == 421  # never without a token


HOST = "127.0.0.1:8642"


@pytest.mark.parametrize("kind", ["http", "websocket"])
@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "null", "", "http://127.0.0.1:9999", "http://localhost:8642",
     "file://", "http://127.0.0.1:8642.evil.example", "ftp://127.0.0.1:8642"],
)  # fmt: skip
def test_other_sites_are_refused(kind: str, origin: str) -> None:
    assert LOCAL.refusal(scope(kind, "POST", host=HOST, origin=origin)).status == 403


def test_the_page_itself_is_let_in() -> None:
    for kind in ("http", "websocket"):
        assert LOCAL.refusal(scope(kind, "POST", host=HOST, origin=f"http://{HOST}")) is None
    assert LOCAL.refusal(scope("websocket", host=HOST, sec_fetch_site="same-origin")) is None
    # A link on another site may lead here; a form on it may not post.
    assert LOCAL.refusal(scope(host=HOST, sec_fetch_site="cross-site")) is None
    assert LOCAL.refusal(scope(method="POST", host=HOST, sec_fetch_site="cross-site")).status == 403
    assert LOCAL.refusal(scope("websocket", host=HOST, sec_fetch_site="cross-site")).status == 403


@pytest.mark.parametrize(
    ("headers", "is_in"),
    [
        ({}, False),
        ({"authorization": f"Bearer {TOKEN}"}, True),
        ({"authorization": f"bearer  {TOKEN} "}, True),
        ({"authorization": "Bearer wrong"}, False),
        ({"authorization": "Bearer"}, False),
        ({"authorization": f"Basic {TOKEN}"}, False),
        ({"authorization": "Bearer \xff\xfe"}, False),
        ({"cookie": f"quiesce_live={TOKEN}"}, True),
        ({"cookie": f"a=b; quiesce_live={TOKEN}"}, True),
        ({"cookie": "quiesce_live="}, False),
        ({"cookie": f"quiesce_live={TOKEN}x"}, False),
        ({"cookie": "=;;;\x01=\xff"}, False),
    ],
)
def test_token_in_header_or_cookie(headers: dict[str, str], is_in: bool) -> None:
    for kind in ("http", "websocket"):
        refusal = OPEN.refusal(scope(kind, path="/socket", host="10.0.0.5:8642", **headers))
        assert (refusal is None) == is_in
        assert is_in or refusal.status == 401


def test_without_the_token_only_the_place_to_enter_it() -> None:
    for path, is_in in (("/login", True), ("/", False), ("/stop", False), ("/live.js", False)):
        assert (OPEN.refusal(scope(path=path, host="a:1")) is None) == is_in, path


@pytest.mark.parametrize(
    ("host", "answer"),
    [("127.0.0.1", True), ("::1", True), ("127.9.9.9", True), ("localhost", True),
     ("0.0.0.0", False), ("::", False), ("10.0.0.5", False), ("rig.local", False), ("", False)],
)  # fmt: skip
def test_local_addresses(host: str, answer: bool) -> None:
    assert is_local(host) is answer


# With a server


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    """On a bus on which nobody is, with a token."""
    folder = tmp_path_factory.mktemp("live_access")
    (folder / "token").write_text(f"{TOKEN}\n")
    one = Page(folder, "--token-file", "token", "--bus", "virtual:live-access")
    yield one
    assert one.end() == 0


def answer(page: Page, method: str, path: str, body: bytes | None = None, **headers: str):
    connection = HTTPConnection("127.0.0.1", page.port, timeout=PATIENCE_S)
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    with contextlib.closing(connection):
        connection.request(method, path, body, named)
        got = connection.getresponse()
        return got.status, got.read().decode(), {k.lower(): v for k, v in got.getheaders()}


BEARER = f"Bearer {TOKEN}"


def test_page_and_its_files_are_served(page: Page) -> None:
    for path in ("/", "/live.js", "/style.css", "/uPlot.iife.min.js", "/uPlot.min.css"):
        status, body, headers = answer(page, "GET", path, Authorization=BEARER)
        assert status == 200 and len(body) > 500, path
        assert headers["content-security-policy"].startswith("default-src 'self'")
        assert headers["x-content-type-options"] == "nosniff"
    for path in ("/../live.py", "/%2e%2e/server.py", "/docs", "/openapi.json", "/nothing"):
        assert answer(page, "GET", path, Authorization=BEARER)[0] == 404, path


def test_strangers_see_where_to_enter_the_token(page: Page) -> None:
    status, body, _ = answer(page, "GET", "/")
    assert status == 200 and "token" in body and "STOP" not in body
    assert answer(page, "GET", "/live.js")[0] == 401
    assert answer(page, "POST", "/stop")[0] == 401


def test_login_gives_a_cookie_that_lets_in(page: Page) -> None:
    body = b'{"token": "' + TOKEN.encode() + b'"}'
    status, _, headers = answer(page, "POST", "/login", body)
    cookie = headers["set-cookie"]
    assert status == 204 and "HttpOnly" in cookie and "samesite=strict" in cookie.lower()
    assert answer(page, "GET", "/live.js", cookie=cookie.partition(";")[0])[0] == 200


@pytest.mark.parametrize(
    "body",
    [b"", b"{}", b"[]", b'{"token": 1}', b'{"token": null}', b'{"token": "wrong"}', b"\xff\xfe",
     b'{"token": "\\ud800"}', b"[" * 4000, b'{"token": "' + b"x" * 10_000 + b'"}'],
)  # fmt: skip
def test_login_with_anything_else_is_refused(page: Page, body: bytes) -> None:
    assert answer(page, "POST", "/login", body)[0] == 403


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 403),
        ({"Authorization": "Bearer wrong"}, 403),
        ({"Authorization": BEARER, "Origin": "http://evil.example"}, 403),
        ({"Authorization": BEARER, "Origin": "null"}, 403),
    ],
)
def test_websocket_of_a_stranger_is_refused(page: Page, headers, status: int) -> None:
    with pytest.raises(InvalidStatus) as refused:
        page.socket(additional_headers=headers)
    assert refused.value.response.status_code == status


@pytest.mark.parametrize(
    "raw",
    [b"\x00" * 100, b"GET\r\n\r\n", b"GET / HTTP/1.1\r\n\r\n", b"POST /stop HTTP/1.1\r\nHost: a\r\n"
     b"Content-Length: x\r\n\r\n", b"GET / HTTP/1.1\r\nHost: a\r\nX: " + b"y" * 200_000],
)  # fmt: skip
def test_what_is_no_request_does_not_end_the_server(page: Page, raw: bytes) -> None:
    with socket.create_connection(("127.0.0.1", page.port), PATIENCE_S) as line:
        with contextlib.suppress(OSError):  # it may hang up before all is sent
            line.sendall(raw)
            line.shutdown(socket.SHUT_WR)
            while line.recv(65536):
                pass
    with page.viewer() as viewer:
        assert viewer.watch(2)


# Strangers who hold the line


@contextlib.contextmanager
def lines(page: Page, count: int) -> Iterator[list[socket.socket]]:
    """Connections on which nothing is said."""
    with contextlib.ExitStack() as stack:
        at = ("127.0.0.1", page.port)
        made = (socket.create_connection(at, PATIENCE_S) for _ in range(count))
        yield [stack.enter_context(one) for one in made]


def is_hung_up(line: socket.socket) -> bool:
    try:
        return line.recv(1) == b""
    except ConnectionResetError:
        return True


def test_strangers_who_hold_the_line_lock_nobody_out(page: Page) -> None:
    """They are more than all connections that the server has."""
    with lines(page, CONNECTIONS + 10) as strangers, page.viewer() as viewer:
        assert viewer.watch(2)
        assert all(is_hung_up(one) for one in strangers[:-MOST_OF_ADDRESS])
        assert answer(page, "GET", "/live.js", Authorization=BEARER)[0] == 200
        body = b'{"token": "' + TOKEN.encode() + b'"}'
        assert answer(page, "POST", "/login", body)[0] == 204


def test_who_has_the_token_is_not_among_those_who_have_to_go(page: Page) -> None:
    with page.viewer() as viewer, lines(page, 2 * MOST_OF_ADDRESS):
        assert viewer.watch(2)


def test_strangers_have_to_go_in_time(page: Page) -> None:
    """Also who was refused and does not hang up, and who sends a request bit by bit."""
    with lines(page, 2) as (silent, slow):
        slow.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Part")
        assert is_hung_up(silent) and is_hung_up(slow)


# The command


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], "which bus?"),
        (["--bus", "nonsense"], "INTERFACE:CHANNEL"),
        (["--bus", "virtual:a", "--port", "65536"], "--port 65536: 0 .. 65535"),
        (["--bus", "virtual:a", "--port", "-1"], "0 .. 65535"),
        (["--bus", "virtual:a", "--port", "x"], "--port"),
        (["--bus", "virtual:a", "--host", "256.1.1.1"], "cannot listen on 256.1.1.1"),
        (["--bus", "virtual:a", "--host", "no.such.host.invalid"], "cannot listen"),
        (["--bus", "virtual:a", "--host", "a" * 300], "cannot listen"),
        (["--bus", "virtual:a", "--host", ""], "an argument is empty"),
        (["--bus", "slcan:/nowhere/tty", "--port", "0"], "cannot open slcan:/nowhere/tty"),
        (["--bus", "virtual:a", "--token-file", "none"], "none: No such file"),
        (["--bus", "virtual:a", "--token-file", "empty"], "16 printable letters"),
        (["--bus", "virtual:a", "--token-file", "short"], "16 printable letters"),
        (["--bus", "virtual:a", "--token-file", "latin"], "16 printable letters"),
        (["--bus", "virtual:a", "--token-file", "."], "Is a directory"),
    ],
)
def test_option_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys, options: list[str], words: str
) -> None:
    from quiesce.cli.main import main

    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("QUIESCE_CAN_BUS", raising=False)
    (tmp_path / "empty").touch()
    (tmp_path / "short").write_text("abc\n")
    (tmp_path / "latin").write_bytes(b"\xe4" * 40)
    assert main(["live", *options]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1 and words in lines[0], lines


def test_port_that_is_taken_is_told(capsys) -> None:
    from quiesce.cli.main import main

    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        assert main(["live", "--bus", "virtual:a", "--port", port]) == 2
    assert f"port {port}" in capsys.readouterr().err


def test_missing_extra_is_told_in_one_line(monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    import sys

    from quiesce.cli.main import main

    for name in [one for one in sys.modules if one.startswith("quiesce.live.server")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    assert main(["live", "--bus", "virtual:a", "--port", "0"]) == 2
    line = capsys.readouterr().err
    assert "needs the extra 'live'" in line and "./tools/setup python" in line


def test_missing_plots_are_told_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    from quiesce.cli.main import main

    monkeypatch.setenv("QUIESCE_BUILD", str(tmp_path))
    assert main(["live", "--bus", "virtual:a", "--port", "0"]) == 2
    assert "./tools/setup page fetches it" in capsys.readouterr().err


@pytest.mark.slow
def test_another_address_makes_a_token_and_asks_for_it(tmp_path: Path) -> None:
    page = Page(tmp_path, "--host", "0.0.0.0", "--bus", "virtual:live-access-all")
    assert len(page.token) >= 40
    assert answer(page, "POST", "/stop")[0] == 401
    with page.viewer() as viewer:
        assert viewer.watch(2)
    assert page.end() == 0
