"""Events: what the service says on the live channel as text."""

from __future__ import annotations

import asyncio
import json
from collections import deque
from collections.abc import Mapping
from typing import Any

from .errors import AnswerError, OrogenyError

_KEPT_EVENTS = 1024

Event = Mapping[str, Any]
"""A message of the service with an `event`, as it came."""


class Events:
    """Events as they come: `async for event in events`. Who does not keep up misses the oldest: 1,024 are kept."""

    def __init__(self) -> None:
        self._kept: deque[Event] = deque(maxlen=_KEPT_EVENTS)
        self._has_news = asyncio.Event()
        self._is_ended = False

    def put(self, event: Event) -> None:
        """Keep an event for who iterates."""
        self._kept.append(event)
        self._has_news.set()

    def end(self) -> None:
        """Hand out what has come, and then no more."""
        self._is_ended = True
        self._has_news.set()

    def __aiter__(self) -> Events:
        return self

    async def __anext__(self) -> Event:
        await self._has_news.wait()
        if not self._kept:
            raise StopAsyncIteration
        event = self._kept.popleft()
        if not self._kept and not self._is_ended:
            self._has_news.clear()
        return event


def parse_event(message: str | bytes) -> dict[str, Any]:
    """Read an event."""
    try:
        event = json.loads(message) if isinstance(message, str) else None
    except ValueError:
        event = None
    if not isinstance(event, dict) or not isinstance(event.get("event"), str):
        raise AnswerError(f"a message that is no event: {message[:200]!r}")
    return event


def error_of(event: Event) -> OrogenyError:
    """The exception for the event `error`."""
    return OrogenyError(str(event.get("code")), str(event.get("message")), event.get("limit"))
