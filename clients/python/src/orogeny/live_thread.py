"""The live channel for programs without asyncio: a loop on a thread of its own, and blocking methods."""

from __future__ import annotations

import asyncio
import concurrent.futures
import threading
from collections.abc import AsyncIterator, Callable, Coroutine, Iterable, Iterator
from types import TracebackType
from typing import Any, TypeVar

from .errors import ConnectionLost
from .events import Event
from .frames import PageFrame
from .grid import RegionLike, Samples
from .heights import Heights
from .live import DEFAULT_WINDOW, Live, LiveStroke
from .operations import Brush, LayerName, Operation, Points
from .results import Change, Hello
from .subscription import LiveMirror, Subscription

T = TypeVar("T")


class LiveThread:
    """A live channel with blocking methods: `with terrain.live() as live:`. Any thread may call them.

    `timeout_s` of a method is how long it waits, by default for ever. After a `TimeoutError` a `stroke` that was not
    done is taken back; what else was asked for may yet be done.
    """

    def __init__(self, url: str, terrain: str, token: str | None = None, author: str | None = None) -> None:
        self._live = Live(url, terrain, token, author)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name=f"orogeny live {terrain}", daemon=True)
        self._is_closed = False

    @property
    def hello(self) -> Hello:
        """What the service said first: the terrain's size, and who this client is."""
        return self._live.hello

    def open(self) -> LiveThread:
        """Connect, and wait for `hello`."""
        self._thread.start()
        try:
            self.run(self._live.open())
        except BaseException:
            self._stop()
            raise
        return self

    def close(self) -> None:
        """Close the connection, and end the thread."""
        if not self._is_closed and self._thread.is_alive():
            try:
                self.run(self._live.close(), 10)
            finally:
                self._stop()

    def __enter__(self) -> LiveThread:
        return self.open()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def begin_stroke(
        self, brush: Brush, *, layer: LayerName | None = None, seed: int | None = None, target: str | None = None
    ) -> ThreadStroke:
        """Begin a stroke whose points are yet to come."""
        stroke = self.run(self._live.begin_stroke(brush, layer=layer, seed=seed, target=target))
        return ThreadStroke(self, stroke)

    def stroke(
        self,
        brush: Brush,
        points: Points,
        layer: LayerName | None = None,
        seed: int | None = None,
        *,
        target: str | None = None,
        timeout_s: float | None = None,
    ) -> Change:
        """Draw a stroke, and wait until it is on disk."""
        return self.run(self._live.stroke(brush, points, layer, seed, target=target), timeout_s)

    def apply(self, operations: Iterable[Operation], *, timeout_s: float | None = None) -> Change:
        """Run operations, all or none."""
        return self.run(self._live.apply(operations), timeout_s)

    def undo(self, *, anyone: bool = False, timeout_s: float | None = None) -> Change:
        """Take back what this author did last."""
        return self.run(self._live.undo(anyone=anyone), timeout_s)

    def redo(self, *, anyone: bool = False, timeout_s: float | None = None) -> Change:
        """Do again what this author took back last."""
        return self.run(self._live.redo(anyone=anyone), timeout_s)

    def cursor(self, x_m: float, z_m: float, radius_m: float) -> None:
        """Show the others where this client's pointer is, metres."""
        self.run(self._live.cursor(x_m, z_m, radius_m))

    def pages(
        self,
        region: RegionLike | None = None,
        level: int = 0,
        form: str = "r32",
        window: int = DEFAULT_WINDOW,
        *,
        timeout_s: float | None = None,
    ) -> Iterator[PageFrame]:
        """Subscribe, and hand out pages as they come, until none came for `timeout_s`."""
        subscription = self.run(self._live.subscribe(region, level, form, window))
        while True:
            try:
                frame = self.run(_next(subscription), timeout_s)
            except TimeoutError:
                return
            if frame is None:
                return
            yield frame

    def mirror(
        self, region: RegionLike | None = None, level: int = 0, form: str = "r32", window: int = DEFAULT_WINDOW
    ) -> ThreadMirror:
        """Subscribe, and put the pages together into one array that stays up to date."""
        return ThreadMirror(self, self.run(self._live.mirror(region, level, form, window)))

    def listen(self, hear: Callable[[Event], None]) -> Callable[[], None]:
        """Call `hear` with every event, on the channel's thread; returns how to stop that."""

        async def follow(events: AsyncIterator[Event]) -> None:
            async for event in events:
                hear(event)

        async def begin() -> asyncio.Task[None]:
            return asyncio.create_task(follow(self._live.events()))

        following = self.run(begin())

        def stop() -> None:
            self._loop.call_soon_threadsafe(following.cancel)

        return stop

    def run(self, coroutine: Coroutine[Any, Any, T], timeout_s: float | None = None) -> T:
        """Run a coroutine on the channel's thread, and wait for it."""
        if self._is_closed or not self._thread.is_alive():
            coroutine.close()
            raise ConnectionLost("the live channel is not open: use `with`")
        running = asyncio.run_coroutine_threadsafe(coroutine, self._loop)
        try:
            return running.result(timeout_s)
        except concurrent.futures.TimeoutError as error:
            if running.done():
                raise
            running.cancel()
            raise TimeoutError(f"no answer within {timeout_s} s") from error

    def _stop(self) -> None:
        self._is_closed = True
        asyncio.run_coroutine_threadsafe(_cancel_others(), self._loop).result(10)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(10)
        self._loop.close()


class ThreadStroke:
    """A stroke while it is drawn."""

    def __init__(self, thread: LiveThread, stroke: LiveStroke) -> None:
        self._thread = thread
        self._stroke = stroke

    def points(self, more: Points) -> None:
        """Draw on to further points; raises `StrokeCut` once the service has ended the stroke."""
        self._thread.run(self._stroke.points(more))

    def end(self, *, timeout_s: float | None = None) -> Change:
        """Lift the hand, and wait until the stroke is on disk."""
        return self._thread.run(self._stroke.end(), timeout_s)

    def cancel(self) -> None:
        """Take the stroke back, bit for bit."""
        self._thread.run(self._stroke.cancel())


class ThreadMirror:
    """A region put together from its pages, kept up to date until `close`."""

    def __init__(self, thread: LiveThread, mirror: LiveMirror) -> None:
        self._thread = thread
        self._mirror = mirror

    @property
    def revision(self) -> int:
        """The latest revision that a page has come with."""
        return self._mirror.revision

    def snapshot(self) -> Heights:
        """A copy of the heights as they are now; NaN where no page has come yet."""
        return self._mirror.snapshot()

    def ready(self, *, timeout_s: float | None = None) -> Heights:
        """Wait until every page has come, and copy the heights."""
        return self._thread.run(self._mirror.ready(), timeout_s)

    def changed(self, *, timeout_s: float | None = None) -> list[Samples]:
        """Wait until something changed since the last call; returns which rows and columns of the array."""
        return self._thread.run(self._mirror.changed(), timeout_s)

    def reached(self, revision: int, *, timeout_s: float | None = None) -> Heights:
        """Wait until a page of that revision or a later one has come, and copy the heights."""
        return self._thread.run(self._mirror.reached(revision), timeout_s)

    def close(self) -> None:
        """Follow no longer."""
        self._thread.run(self._mirror.close())


async def _next(subscription: Subscription) -> PageFrame | None:
    return await anext(subscription, None)


async def _cancel_others() -> None:
    others = [task for task in asyncio.all_tasks() if task is not asyncio.current_task()]
    for task in others:
        task.cancel()
    await asyncio.gather(*others, return_exceptions=True)
