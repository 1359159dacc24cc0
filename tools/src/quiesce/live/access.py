"""Who may come in: no site but the page itself, no name but the server's own, and with a token
nobody without it."""

import hmac
import ipaddress
import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from dataclasses import dataclass
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import urlsplit

COOKIE = "quiesce_live"
LOCAL_NAMES = ("localhost", "127.0.0.1", "::1")
# What somebody without the token sees: where to enter it.
OPEN_PATHS = ("/login", "/login.js", "/style.css", "/icon.svg")
SAFE_METHODS = ("GET", "HEAD")
HEADERS = (
    (b"content-security-policy", b"default-src 'self'; frame-ancestors 'none'; base-uri 'none'"),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
)

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]


def new_token() -> str:
    return secrets.token_urlsafe(32)


def is_local(host: str) -> bool:
    """Whether nobody outside of this computer reaches that address."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


@dataclass(frozen=True)
class Refusal:
    status: int  # of HTTP
    why: str


@dataclass(frozen=True)
class Policy:
    """host: what the server listens on; token: empty: none is asked for."""

    host: str
    token: str = ""

    def refusal(self, scope: Scope) -> Refusal | None:
        """Why a request or a websocket is not let in; None: it is."""
        headers = dict(scope["headers"])
        host = headers.get(b"host", b"").decode("latin-1").lower()
        if not self.is_own_name(host):
            return Refusal(421, "this server goes by another name")
        if self.is_cross_site(scope, headers, host):
            return Refusal(403, "another site asks")
        if self.token and scope["path"] not in OPEN_PATHS and not self.knows_token(headers):
            return Refusal(401, "the token is missing or wrong")
        return None

    def is_own_name(self, host: str) -> bool:
        """A site whose name was bent to this address (DNS rebinding) comes with that name. With a
        token that is no danger: cookies go by names, too."""
        name = urlsplit(f"//{host}").hostname if is_netloc(host) else None
        if not is_local(self.host):
            return bool(self.token) and name is not None
        return name in (*LOCAL_NAMES, self.host)

    def is_cross_site(self, scope: Scope, headers: dict[bytes, bytes], host: str) -> bool:
        origin = headers.get(b"origin")
        if origin is not None:
            return not is_same(origin.decode("latin-1").lower(), host)
        is_asking = scope["type"] == "http" and scope["method"] in SAFE_METHODS
        site = headers.get(b"sec-fetch-site", b"none")
        return site not in (b"same-origin", b"none") and not is_asking

    def knows_token(self, headers: dict[bytes, bytes]) -> bool:
        cookie = cookie_of(headers.get(b"cookie", b"").decode("latin-1"))
        scheme, _, bearer = headers.get(b"authorization", b"").decode("latin-1").partition(" ")
        given = bearer.strip() if scheme.lower() == "bearer" else cookie
        return self.is_token(given)

    def is_token(self, given: str) -> bool:
        """Takes as long whatever is given."""
        return hmac.compare_digest(given.encode("utf-8", "replace"), self.token.encode())


def is_netloc(host: str) -> bool:
    return bool(host) and not set(host) & set("/\\@?# ") and is_port_right(host)


def is_port_right(host: str) -> bool:
    try:
        return urlsplit(f"//{host}").port != 0
    except ValueError:
        return False


def is_same(origin: str, host: str) -> bool:
    return origin in (f"http://{host}", f"https://{host}")


def cookie_of(header: str) -> str:
    try:
        found = SimpleCookie(header).get(COOKIE)
    except CookieError:
        return ""
    return found.value if found else ""


class Door:
    """An ASGI application around another one: lets in whom the policy does, and tells whom."""

    def __init__(self, app: App, policy: Policy, let_in: Callable[[Any], None]) -> None:
        """let_in: is told his address and port."""
        self._app = app
        self._policy = policy
        self._let_in = let_in

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        refusal = self._policy.refusal(scope) if scope["type"] in ("http", "websocket") else None
        if refusal is None and scope.get("path") not in OPEN_PATHS:
            self._let_in(scope.get("client"))
        if scope["type"] == "websocket" and refusal is not None:
            await receive()
            await send({"type": "websocket.close", "code": 1008, "reason": refusal.why})
        elif refusal is not None and refusal.status == 401 and scope["path"] == "/":
            await self._app({**scope, "path": "/login"}, receive, with_headers(send))
        elif refusal is not None:
            await refuse(refusal, with_headers(send))
        else:
            await self._app(scope, receive, with_headers(send))


async def refuse(refusal: Refusal, send: Send) -> None:
    head = [(b"content-type", b"text/plain; charset=utf-8"), (b"connection", b"close")]
    await send({"type": "http.response.start", "status": refusal.status, "headers": head})
    await send({"type": "http.response.body", "body": f"{refusal.why}\n".encode()})


def with_headers(send: Send) -> Send:
    async def sending(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            own = list(message.get("headers", ()))
            names = {name for name, _ in own}
            message = {**message, "headers": own + [one for one in HEADERS if one[0] not in names]}
        await send(message)

    return sending
