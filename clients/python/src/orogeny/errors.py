"""What can go wrong, as exceptions. All of them are `OrogenyException`."""

from __future__ import annotations

from typing import Any


class OrogenyException(Exception):  # noqa: N818 - `OrogenyError` is what the service answers with
    """The base of every exception of this package."""


class OrogenyError(OrogenyException):
    """The service refused something, and nothing was changed.

    `code` is a word for programs, `message` a sentence for people. Where a limit was exceeded, `limit` tells it.
    `status` is the HTTP status, and `None` on the live channel.
    """

    def __init__(self, code: str, message: str, limit: Any = None, status: int | None = None) -> None:
        super().__init__(f"{message} ({code})")
        self.code = code
        self.message = message
        self.limit = limit
        self.status = status


class AnswerError(OrogenyException):
    """The service, or something in between, answered with what is not part of the protocol."""


class FrameError(OrogenyException, ValueError):
    """Bytes that are no page frame; `what` names the field that is wrong."""

    def __init__(self, what: str, message: str) -> None:
        super().__init__(f"{what}: {message}")
        self.what = what


class ConnectionLost(OrogenyException):
    """The live channel is closed. What was not answered with `done` may or may not have been done."""


class StrokeCut(OrogenyException):
    """The service ended a stroke since others had waited for it; what was drawn of it stays."""
