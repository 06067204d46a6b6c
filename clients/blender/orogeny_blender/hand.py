"""A hand that draws strokes on the live channel: the same for a script's points and for a mouse's."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Future
from typing import Any

from .core import messages, operations
from .core.errors import OrogenyException
from .core.results import Change
from .feed import Feed


class Hand:
    """A stroke from its first point to when the hand is lifted. It waits for nothing: `lift` hands out a future."""

    def __init__(self, feed: Feed, brush: dict[str, Any], layer: str | None, seed: int | None = None) -> None:
        self._feed = feed
        self._operation = operations.stroke(brush, layer=layer or None, seed=seed)
        self._last: list[float] | None = None
        self._begin()

    def draw(self, points: Sequence[Sequence[float]]) -> None:
        """Go on to further points `[x, z, pressure, seconds]`, metres.

        A stroke that the service has cut, since others waited, goes on as another one.
        """
        more = operations.point_list(points)
        if not more:
            return
        if self._feed.is_cut(self._number) or self._done.done():
            self._begin()
            more = ([self._last] if self._last is not None else []) + more
        for message in messages.points(self._number, more):
            self._feed.send(message)
        self._last = more[-1]

    def lift(self) -> Future[Change]:
        """End the stroke; the future is done when it is on disk."""
        if not self._feed.is_cut(self._number) and not self._done.done():
            self._feed.send(messages.end_stroke(self._number))
        return self._done

    def cancel(self) -> None:
        """Take the stroke back, bit for bit."""
        try:
            if not self._done.done():
                self._feed.send(messages.cancel_stroke(self._number))
        except OrogenyException:
            pass  # A lost connection has no stroke that is under way.

    def _begin(self) -> None:
        self._number, self._done = self._feed.ask(lambda number: messages.begin_stroke(number, self._operation))
