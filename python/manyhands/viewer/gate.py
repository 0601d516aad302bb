"""Who may open the page, and the server behind it."""

import atexit
import contextlib
import hashlib
import http
import ipaddress
import secrets
import threading
from collections.abc import Callable, Iterator
from http.cookies import CookieError, SimpleCookie
from io import StringIO
from typing import Any
from urllib.parse import parse_qs, urlsplit

import viser
import websockets.asyncio.server
from viser import _messages as messages
from websockets.datastructures import Headers, MultipleValuesError
from websockets.http11 import Request, Response

from manyhands.viewer.face import Face

_REFUSAL = b"manyhands: this page needs its token: open the address that was printed when it started.\n"
_making = threading.Lock()


def is_loopback(host: str) -> bool:
    """Whether an address, or a name with or without port, is this machine's own."""
    name = urlsplit(f"//{host}").hostname or ""
    if name == "localhost":
        return True
    try:
        return ipaddress.ip_address(name).is_loopback
    except ValueError:
        return False


class Gate:
    """Lets in who knows the token, from anywhere; and without one, only pages of this server on this machine.

    A browser sends the token once, in the address (?token=...), and a cookie from then on. A cookie counts for pages
    of this server alone, so that a foreign page cannot use it. Where no token is asked for, names in `Host` must be
    this machine's own: a foreign name that leads here (DNS rebinding) is refused.
    """

    def __init__(self, token: str | None) -> None:
        """`token` None asks for none: for servers on a loopback address."""
        self.token = token
        digest = hashlib.sha256((token or "").encode()).hexdigest()
        self._cookie = f"manyhands-{digest[:12]}"
        # What the cookie holds is not the token: it opens no other door.
        self._pass = hashlib.sha256(f"cookie {token}".encode()).hexdigest()

    def lets_in(self, request: Request) -> bool:
        """Whether a request, for a page or for a socket, may pass."""
        try:
            host, origin = request.headers.get("Host", ""), request.headers.get("Origin")
        except MultipleValuesError:
            return False
        if self._gives_token(request):
            return True
        is_own = origin is None or urlsplit(origin).netloc == host
        if self.token is None:
            return is_own and is_loopback(host)
        return is_own and self._shows_cookie(request)

    def mark(self, request: Request, response: Response) -> None:
        """Gives the browser its cookie with the page that it asked for by the token."""
        if self._gives_token(request):
            response.headers["Set-Cookie"] = f"{self._cookie}={self._pass}; HttpOnly; SameSite=Strict; Path=/"

    def _gives_token(self, request: Request) -> bool:
        given = parse_qs(urlsplit(request.path).query).get("token", [])
        return self.token is not None and len(given) == 1 and _same(given[0], self.token)

    def _shows_cookie(self, request: Request) -> bool:
        try:
            cookie = SimpleCookie(request.headers.get("Cookie", "")).get(self._cookie)
        except (CookieError, MultipleValuesError):
            return False
        return cookie is not None and _same(cookie.value, self._pass)


def _same(a: str, b: str) -> bool:
    return secrets.compare_digest(a.encode(), b.encode())


def serve(host: str, port: int, title: str, gate: Gate) -> viser.ViserServer:
    """A server of viser's on `host`, at `port` or the next that is free, with `gate` before it.

    Raises RuntimeError if this version of viser opens its socket in another way: an open door is no option.
    """
    with _making, _before_requests(gate, Face(title)) as doors, quiet():
        server = viser.ViserServer(host, port, label=title, verbose=False)
        if not doors:
            server.stop()
            raise RuntimeError(f"viser {viser.__version__} cannot be guarded; install the version that pyproject names")
    # At the interpreter's end viewers stop their servers; viser would do so first, and say so on standard output.
    for stop in (server.stop, server._websock_server.stop):
        atexit.unregister(stop)
    # A tunnel to the outside, which any browser might ask for, would lead past the gate.
    server._websock_server.unregister_handler(messages.ShareUrlRequest)
    return server


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """viser announces what it does on standard output; the address that counts is printed by us."""
    with contextlib.redirect_stdout(StringIO()):
        yield


@contextlib.contextmanager
def _before_requests(gate: Gate, face: Face) -> Iterator[list[bool]]:
    """viser has no hook for requests, but hands websockets one of its own: ours goes before it."""
    module, doors = websockets.asyncio.server, []
    original = module.serve

    def guarded(*args: Any, process_request: Callable[..., Any], **options: Any) -> Any:
        def decide(connection: Any, request: Request) -> Response | None:
            if not gate.lets_in(request):
                headers = Headers({"Content-Type": "text/plain", "Content-Length": str(len(_REFUSAL))})
                return Response(http.HTTPStatus.FORBIDDEN, "Forbidden", headers, _REFUSAL)
            response = process_request(connection, request)
            if response is not None:
                face.put_on(response)
                gate.mark(request, response)
            return response

        doors.append(True)
        return original(*args, process_request=decide, **options)

    module.serve = guarded  # pyright: ignore[reportAttributeAccessIssue]
    try:
        yield doors
    finally:
        module.serve = original  # pyright: ignore[reportAttributeAccessIssue]
