"""Who may come in."""

import gzip
import http.client
import urllib.request
from collections.abc import Iterator

import pytest
from viewed import falling_ball

from manyhands.viewer import Viewer


def answer(viewer: Viewer, path: str = "/", **headers: str) -> tuple[int, dict[str, str]]:
    """Status and headers of a request; `upgrade` asks for a socket."""
    connection = http.client.HTTPConnection("127.0.0.1", viewer.server.get_port(), timeout=5)
    if headers.pop("upgrade", ""):
        headers |= {
            "Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13",
            "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Sec-WebSocket-Protocol": f"viser-v{_viser_version()}",
        }  # fmt: skip
    connection.request("GET", path, headers=headers)
    response = connection.getresponse()
    given = dict(response.getheaders())
    connection.close()
    return response.status, given


def _viser_version() -> str:
    import viser

    return viser.__version__


@pytest.fixture(scope="module")
def guarded() -> Iterator[Viewer]:
    with Viewer(falling_ball(), port=18420, token="open sesame!", announce=False) as viewer:
        yield viewer


@pytest.mark.parametrize("packed", [False, True])
def test_the_page_has_a_name_and_an_icon_of_its_own(here: Viewer, packed: bool) -> None:
    """viser's page says "Viser", and shows its logo."""
    address = f"http://127.0.0.1:{here.server.get_port()}/"
    asked = urllib.request.Request(address, headers={"Accept-Encoding": "gzip"} if packed else {})
    for _ in range(2):
        with urllib.request.urlopen(asked, timeout=5) as response:
            body = response.read()
            assert int(response.headers["Content-Length"]) == len(body)
        page = gzip.decompress(body) if packed else body
        assert b"<title>world \xc2\xb7 manyhands</title>" in page and b"<title>Viser" not in page
        assert page.count(b'rel="icon"') == 1 and b"%23266ea0" in page
        assert page.rstrip().endswith(b"</html>")


def test_this_machine_needs_no_token(here: Viewer) -> None:
    own = f"http://127.0.0.1:{here.server.get_port()}"
    assert answer(here)[0] == 200
    assert answer(here, upgrade="yes", Origin=own)[0] == 101
    assert answer(here, upgrade="yes")[0] == 101


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "http://localhost:1", "null", "https://127.0.0.1.evil.example"]
)
def test_a_foreign_page_is_refused(here: Viewer, origin: str) -> None:
    assert answer(here, upgrade="yes", Origin=origin)[0] == 403
    assert answer(here, Origin=origin)[0] == 403


def test_a_foreign_name_for_this_machine_is_refused(here: Viewer) -> None:
    # DNS rebinding: the page's origin and the host agree, but neither is ours.
    assert answer(here, upgrade="yes", Host="evil.example:18410", Origin="http://evil.example:18410")[0] == 403


def test_a_token_opens_and_a_cookie_keeps_open(guarded: Viewer) -> None:
    own = f"http://127.0.0.1:{guarded.server.get_port()}"
    assert answer(guarded)[0] == 403
    assert answer(guarded, upgrade="yes", Origin=own)[0] == 403
    assert answer(guarded, "/?token=wrong")[0] == 403
    status, headers = answer(guarded, "/?token=open%20sesame!")
    assert status == 200
    cookie = headers["Set-Cookie"]
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie and "sesame" not in cookie
    shown = cookie.partition(";")[0]
    assert answer(guarded, upgrade="yes", Origin=own, Cookie=shown)[0] == 101
    # A foreign page cannot use the cookie, nor can a cookie of another token.
    assert answer(guarded, upgrade="yes", Origin="http://localhost:1", Cookie=shown)[0] == 403
    assert answer(guarded, upgrade="yes", Origin=own, Cookie=shown[:-3] + "abc")[0] == 403


def test_other_addresses_get_a_token_by_themselves(capsys: pytest.CaptureFixture[str]) -> None:
    with Viewer(falling_ball(), host="0.0.0.0", port=18430) as viewer:
        assert "?token=" in viewer.url
        assert viewer.url in capsys.readouterr().out
        assert answer(viewer)[0] == 403
        assert answer(viewer, "/?" + viewer.url.partition("?")[2])[0] == 200


def test_pages_are_not_shared_with_the_world(here: Viewer) -> None:
    from viser import _messages

    assert _messages.ShareUrlRequest not in here.server._websock_server._incoming_handlers
