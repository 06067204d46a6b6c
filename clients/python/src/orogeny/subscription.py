"""Pages of the live channel for who takes them: one by one, or put together."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from .errors import ConnectionLost, OrogenyException
from .frames import PageFrame
from .grid import Samples
from .heights import Heights
from .mirror import Mirror


class Subscription:
    """Pages as they come: `async for frame in subscription`.

    A frame counts as taken, and is acknowledged, once the next one is asked for; until then the service holds others
    back, and sends the latest state afterwards. `take` hears how many were taken, and whether more are here.
    """

    def __init__(self, take: Callable[[int, bool], Awaitable[None]], mirror: Mirror) -> None:
        self.region_mirror = mirror
        self._take = take
        self._frames: asyncio.Queue[PageFrame | None] = asyncio.Queue()
        self.has_begun = False
        self._handed_out = 0
        self._is_ended = False
        self._lost: OrogenyException | None = None

    def offer(self, frame: PageFrame) -> bool:
        """Take a frame into the queue, if it belongs here."""
        if self._is_ended or not self.region_mirror.concerns(frame):
            return False
        self.has_begun = True
        self._frames.put_nowait(frame)
        return True

    def end(self, lost: OrogenyException | None) -> int:
        """Hand out no more; returns how many frames had come and were not taken."""
        if self._is_ended:
            return 0
        left = self._handed_out + self._frames.qsize()
        self._is_ended, self._handed_out, self._lost = True, 0, lost
        while not self._frames.empty():
            self._frames.get_nowait()
        self._frames.put_nowait(None)
        return left

    def __aiter__(self) -> Subscription:
        return self

    async def __anext__(self) -> PageFrame:
        taken, self._handed_out = self._handed_out, 0
        await self._take(taken, not self._frames.empty())
        frame = await self._frames.get()
        if frame is None:
            self._frames.put_nowait(None)
            if self._lost is not None:
                raise self._lost
            raise StopAsyncIteration
        self._handed_out = 1
        return frame


class LiveMirror:
    """A region put together from its pages, kept up to date by a task until `close`."""

    def __init__(self, subscription: Subscription) -> None:
        self._mirror = subscription.region_mirror
        self._news = asyncio.Condition()
        self._changed: list[Samples] = []
        self._lost: BaseException | None = None
        self._is_closed = False
        self._task = asyncio.create_task(self._follow(subscription), name="orogeny mirror")

    @property
    def revision(self) -> int:
        """The latest revision that a page has come with."""
        return self._mirror.revision

    @property
    def is_complete(self) -> bool:
        """Whether every page has come at least once."""
        return self._mirror.is_complete

    def snapshot(self) -> Heights:
        """A copy of the heights as they are now; NaN where no page has come yet."""
        return self._mirror.snapshot()

    async def ready(self) -> Heights:
        """Wait until every page has come, and copy the heights."""
        async with self._news:
            await self._news.wait_for(lambda: self.is_complete or self._is_over())
        if not self.is_complete:
            raise self._why()
        return self.snapshot()

    async def changed(self) -> list[Samples]:
        """Wait until something changed since the last call; returns which rows and columns of the array."""
        async with self._news:
            await self._news.wait_for(lambda: bool(self._changed) or self._is_over())
            if not self._changed:
                raise self._why()
            changed, self._changed = self._changed, []
        return changed

    async def reached(self, revision: int) -> Heights:
        """Wait until a page of that revision or a later one has come, and copy the heights."""
        async with self._news:
            await self._news.wait_for(lambda: (self.is_complete and self.revision >= revision) or self._is_over())
        if self.revision < revision:
            raise self._why()
        return self.snapshot()

    async def close(self) -> None:
        """Follow no longer."""
        self._is_closed = True
        self._task.cancel()
        await asyncio.gather(self._task, return_exceptions=True)
        async with self._news:
            self._news.notify_all()

    def _is_over(self) -> bool:
        return self._is_closed or self._task.done() or self._lost is not None

    def _why(self) -> BaseException:
        if isinstance(self._lost, OrogenyException):
            return self._lost
        return ConnectionLost("the mirror is closed, or another subscription took its place")

    async def _follow(self, subscription: Subscription) -> None:
        try:
            async for frame in subscription:
                here = self._mirror.apply(frame)
                if here is not None:
                    async with self._news:
                        self._note(here)
                        self._news.notify_all()
        except OrogenyException as error:
            self._lost = error
        else:
            self._is_closed = True
        async with self._news:
            self._news.notify_all()

    def _note(self, here: Samples) -> None:
        if here not in self._changed:
            self._changed.append(here)
