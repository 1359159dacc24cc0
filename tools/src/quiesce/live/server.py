"""The server of the page: its files, the websocket, STOP by HTTP where that is lost."""

import asyncio
import contextlib
import json
import socket
import threading
from collections.abc import Iterator
from pathlib import Path

import uvicorn
from fastapi import FastAPI, Request, Response, WebSocket
from fastapi.responses import FileResponse, JSONResponse

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.live.access import COOKIE, App, Door, Policy
from quiesce.live.crowd import MOST_STRANGERS, Crowd
from quiesce.live.protocol import MAX_MESSAGE_BYTES
from quiesce.live.room import MOST_VIEWERS, Room
from quiesce.live.viewer import Viewer

PAGE = Path(__file__).with_name("page")
TRY_AGAIN_LATER = 1013
PING_S = 5.0  # a viewer who does not answer for as long is gone, and with him his control
END_S = 2
# A report has its styles and pictures inside, and no script.
REPORT_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; sandbox"
STOP_LOOK_S = 0.1
CONNECTIONS = MOST_STRANGERS + 8 * MOST_VIEWERS  # a browser has six, and the websocket


def application(room: Room, policy: Policy, plots: Path, crowd: Crowd) -> App:
    """plots: the folder with uPlot."""
    app = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)
    for file in sorted(PAGE.iterdir()):
        add_file(app, f"/{file.stem}" if file.suffix == ".html" else f"/{file.name}", file)
    add_file(app, "/", PAGE / "index.html")
    for name in ("uPlot.iife.min.js", "uPlot.min.css"):
        add_file(app, f"/{name}", plots / name)

    @app.post("/stop")
    async def stop() -> Response:
        room.stop()
        return JSONResponse(room.desk.stop.told())

    @app.post("/login")
    async def login(request: Request) -> Response:
        if not policy.is_token(await token_in(request)):
            return Response("the token is wrong\n", 403)
        answer = Response(status_code=204)
        answer.set_cookie(COOKIE, policy.token, httponly=True, samesite="strict")
        return answer

    @app.get("/recordings/{name}")
    async def recording(name: str) -> Response:
        file = room.desk.recordings.file(name)
        if file is None or not file.is_file():
            return Response("no such recording\n", 404)
        return FileResponse(file, filename=name, media_type="application/octet-stream")

    @app.get("/commission/{name:path}")
    async def commissioned(name: str) -> Response:
        file = room.guide.page(name) if room.guide is not None else None
        if file is None:
            return Response("no such page\n", 404)
        return FileResponse(file, headers={"content-security-policy": REPORT_POLICY})

    @app.websocket("/socket")
    async def viewer(socket: WebSocket) -> None:
        number = room.come()
        if number is None:
            await socket.close(TRY_AGAIN_LATER, "there are enough viewers")
            return
        try:
            await socket.accept()
            await Viewer(socket, room, number).serve()
        finally:
            room.go(number)

    return Door(app, policy, crowd.leave)


def add_file(app: FastAPI, path: str, file: Path) -> None:
    app.add_api_route(path, lambda: FileResponse(file), methods=["GET", "HEAD"])


async def token_in(request: Request) -> str:
    """Of a body {"token": "..."}; empty where it is something else, or long."""
    body = b""
    async for part in request.stream():
        body += part
        if len(body) > MAX_MESSAGE_BYTES:
            return ""
    try:
        token = json.loads(body)["token"]
    except (ValueError, KeyError, TypeError, RecursionError):
        return ""
    return token if isinstance(token, str) else ""


def listen(host: str, port: int) -> socket.socket:
    """UsageError where that address cannot be had."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, port), family=family)
    except (OSError, OverflowError, UnicodeError) as error:
        raise UsageError(
            f"cannot listen on {host} port {port}: {one_line(error)}; choose others with --host "
            "and --port"
        )


class Server(uvicorn.Server):
    """Ends when it is told to, and leaves signals to who started it."""

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


async def serve(
    room: Room, policy: Policy, plots: Path, at: socket.socket, stop: threading.Event
) -> None:
    """Until `stop` is set. BenchFailure where the room's rig is gone before."""
    crowd = Crowd()
    config = uvicorn.Config(
        application(room, policy, plots, crowd),
        loop="asyncio",
        http=crowd.protocol,
        proxy_headers=False,  # an address that a header names is none
        ws="websockets-sansio",
        ws_max_size=MAX_MESSAGE_BYTES,
        ws_ping_interval=PING_S,
        ws_ping_timeout=PING_S,
        ws_per_message_deflate=False,
        lifespan="off",
        log_level="error",
        access_log=False,
        server_header=False,
        limit_concurrency=CONNECTIONS,
        timeout_graceful_shutdown=END_S,
    )
    server = Server(config)
    working = [asyncio.create_task(room.run()), asyncio.create_task(server.serve([at]))]
    try:
        while not stop.is_set() and not any(one.done() for one in working):
            await asyncio.sleep(STOP_LOOK_S)
            if room.rig is not None and room.rig.failure:
                raise BenchFailure(f"the rig in the computer is gone: {room.rig.failure}")
    finally:
        if room.guide is not None:
            await room.guide.end()  # while the bus is still heard
        server.should_exit = True
        await asyncio.wait(working[1:])
        working[0].cancel()
        await asyncio.to_thread(room.desk.recordings.close)
    for one in working:
        if one.done() and not one.cancelled():
            one.result()  # what ended it
