"""The page's own name and icon, where viser has its own."""

import gzip
import re
from html import escape
from urllib.parse import quote

from websockets.http11 import Response

_ICON = """<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 64 64'>
<rect width='64' height='64' rx='14' fill='#266ea0'/>
<g fill='none' stroke='#fff' stroke-width='6' stroke-linecap='round' stroke-linejoin='round'>
<path d='M16 52V36L34 18M8 54h18'/><path d='M30 8l14 6-6 14M44 14l6-4M38 28l10 6'/></g>
<circle cx='16' cy='36' r='5' fill='#f08a33'/></svg>"""
_LINK = re.compile(rb'<link\s+rel="icon".*?/>', re.DOTALL)
_TITLE = re.compile(rb"<title>.*?</title>", re.DOTALL)


class Face:
    """Puts a title and our icon into the page that viser's server gives out."""

    def __init__(self, title: str) -> None:
        self._title = f"<title>{escape(title)} · manyhands</title>".encode()
        self._link = f'<link rel="icon" href="data:image/svg+xml,{quote(_ICON)}" />'.encode()
        self._pages: dict[bytes, bytes] = {}

    def put_on(self, response: Response) -> None:
        """Changes a response if it is the page; all else stays."""
        if not response.body or not response.headers.get("Content-Type", "").startswith("text/html"):
            return
        given = bytes(response.body)
        if given not in self._pages:
            packed = response.headers.get("Content-Encoding") == "gzip"
            page = gzip.decompress(given) if packed else given
            page = _TITLE.sub(lambda _: self._title, _LINK.sub(lambda _: self._link, page, count=1), count=1)
            self._pages[given] = gzip.compress(page) if packed else page
        response.body = self._pages[given]
        del response.headers["Content-Length"]
        response.headers["Content-Length"] = str(len(response.body))
