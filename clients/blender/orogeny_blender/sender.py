"""Sends the calls of the client core by `urllib`."""

from __future__ import annotations

import urllib.error
import urllib.request
from typing import TypeVar

from .core import calls
from .core.calls import Answer, Call
from .core.errors import ConnectionLost

T = TypeVar("T")

TIMEOUT_S = 60.0


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    """A redirect would carry the token to another place: it counts as an answer."""

    def redirect_request(self, *_: object) -> None:
        return None


class Sender:
    """A service, and what it takes to talk to it."""

    def __init__(self, url: str, token: str | None) -> None:
        self.url = calls.check_url(url)
        self.token = token or None
        self._headers = calls.authorization(self.token)
        self._opener = urllib.request.build_opener(_NoRedirect)

    def send(self, call: Call[T]) -> T:
        """Send a call, and read its answer; raises what the client core raises."""
        headers = {**self._headers, **call.headers}
        request = urllib.request.Request(self.url + call.path, call.body, headers, method=call.method)
        try:
            with self._opener.open(request, timeout=TIMEOUT_S) as response:
                answer = _answer(response.status, response.headers, response.read())
        except urllib.error.HTTPError as error:
            with error:
                answer = _answer(error.code, error.headers, error.read())
        except OSError as error:
            raise ConnectionLost(f"{self.url}: {getattr(error, 'reason', error)}") from error
        return call.result(answer)


def _answer(status: int, headers, body: bytes) -> Answer:
    return Answer(status, {name.lower(): value for name, value in headers.items()}, body)
