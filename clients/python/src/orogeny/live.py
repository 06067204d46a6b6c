"""The live channel of a terrain for asyncio: strokes while they are drawn, pages whenever they change."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import weakref
from collections.abc import AsyncIterable, AsyncIterator, Iterable, Sequence
from types import TracebackType

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidStatus

from . import calls, frames, messages, operations
from .errors import AnswerError, ConnectionLost, OrogenyException, StrokeCut
from .events import Event, Events, error_of, parse_event
from .frames import PageFrame
from .grid import RegionLike
from .mirror import Mirror
from .operations import Brush, LayerName, Operation, Points
from .results import Change, Hello
from .subscription import LiveMirror, Subscription

DEFAULT_WINDOW = 16
"""Page frames under way at most, before the service waits to hear that some were taken."""

_MAX_MESSAGE_BYTES = 16 * 1024 * 1024

SomePoints = Points | AsyncIterable[Sequence[float]]
"""Points at once, or as they come: then each is one `[x, z, ...]`."""


class Live:
    """A connection to a terrain's live channel: `async with Live(url, "island") as live:`.

    One task reads; everything else may be used by any number of tasks of the same loop.
    """

    def __init__(self, url: str, terrain: str, token: str | None = None, author: str | None = None) -> None:
        self.terrain = terrain
        self._url = calls.live_url(url, terrain, author)
        self._headers = calls.authorization(token)
        self._numbers = itertools.count(1)
        self._waiting: dict[int, asyncio.Future[Change]] = {}
        self._strokes: dict[int, LiveStroke] = {}
        self._listeners: weakref.WeakSet[Events] = weakref.WeakSet()
        self._subscription: Subscription | None = None
        self._taken = 0
        self._acknowledged = 0
        self._hello: Hello | None = None
        self._connection: ClientConnection | None = None
        self._reader: asyncio.Task[None] | None = None
        self._lost: OrogenyException | None = None

    @property
    def hello(self) -> Hello:
        """What the service said first: the terrain's size, and who this client is."""
        if self._hello is None:
            raise ConnectionLost("the live channel is not open yet: use `async with`")
        return self._hello

    async def open(self) -> Live:
        """Connect, and wait for `hello`."""
        try:
            connection = await connect(self._url, additional_headers=self._headers, max_size=_MAX_MESSAGE_BYTES)
        except InvalidStatus as error:
            response = error.response
            raise calls.refusal(calls.Answer(response.status_code, {}, bytes(response.body or b""))) from error
        except (OSError, InvalidHandshake, TimeoutError) as error:
            raise ConnectionLost(f"{self._url}: {error!r}") from error
        self._connection = connection
        try:
            event = parse_event(await connection.recv())
            if event["event"] == "error":
                raise error_of(event)
            if event["event"] != "hello":
                raise AnswerError(f"the live channel began with `{event['event']}`, not with `hello`")
            self._hello = Hello.parse(event)
            if self._hello.page_size != frames.PAGE_SIZE:
                raise AnswerError(
                    f"pages have {self._hello.page_size} samples a side, this client knows {frames.PAGE_SIZE}"
                )
        except ConnectionClosed as error:
            raise ConnectionLost(f"{self._url} was closed before `hello`: {error}") from error
        except OrogenyException:
            await connection.close()
            raise
        self._reader = asyncio.create_task(self._read(connection), name=f"orogeny live {self.terrain}")
        return self

    async def close(self) -> None:
        """Close the connection; a stroke that is still drawn is up to the service."""
        if self._connection is not None:
            await self._connection.close()
        if self._reader is not None:
            await asyncio.gather(self._reader, return_exceptions=True)

    async def __aenter__(self) -> Live:
        return await self.open()

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    async def begin_stroke(
        self, brush: Brush, *, layer: LayerName | None = None, seed: int | None = None, target: str | None = None
    ) -> LiveStroke:
        """Begin a stroke whose points are yet to come."""
        number, done = self._expect()
        stroke = LiveStroke(self, number, done)
        self._strokes[number] = stroke
        operation = operations.stroke(brush, layer=layer, seed=seed, target=target)
        await self._send(messages.begin_stroke(number, operation))
        return stroke

    async def stroke(
        self,
        brush: Brush,
        points: SomePoints,
        layer: LayerName | None = None,
        seed: int | None = None,
        *,
        target: str | None = None,
    ) -> Change:
        """Draw a stroke, and wait until it is on disk.

        `points` may be an async iterator: each point is drawn when it comes. Where the service cuts the stroke since
        others wait, another one goes on from the point before: it is then several entries of the history. If the
        points fail, or the task is cancelled, the stroke is taken back.
        """
        stroke = await self.begin_stroke(brush, layer=layer, seed=seed, target=target)
        before: list[list[float]] = []
        done: Change | None = None
        try:
            async for part in _parts(points):
                try:
                    await stroke.points(part)
                except StrokeCut:
                    done = _joined(done, await stroke.end())
                    stroke = await self.begin_stroke(brush, layer=layer, seed=seed, target=target)
                    await stroke.points(before + part)
                before = part[-1:] or before
            return _joined(done, await stroke.end())
        except BaseException:
            with contextlib.suppress(OrogenyException):
                await stroke.cancel()
            raise

    async def apply(self, todo: Iterable[Operation]) -> Change:
        """Run operations, all or none."""
        number, done = self._expect()
        return await self._ask(messages.apply(number, todo), done)

    async def undo(self, *, anyone: bool = False) -> Change:
        """Take back what this author did last."""
        number, done = self._expect()
        return await self._ask(messages.undo(number, anyone), done)

    async def redo(self, *, anyone: bool = False) -> Change:
        """Do again what this author took back last."""
        number, done = self._expect()
        return await self._ask(messages.redo(number, anyone), done)

    async def cursor(self, x_m: float, z_m: float, radius_m: float) -> None:
        """Show the others where this client's pointer is, metres."""
        await self._send(messages.cursor(x_m, z_m, radius_m))

    async def subscribe(
        self, region: RegionLike | None = None, level: int = 0, form: str = "r32", window: int = DEFAULT_WINDOW
    ) -> Subscription:
        """Ask for the pages of a region as they are and whenever they change; an earlier subscription ends.

        `form` is `r32`, or `r16`, which takes half as much and rounds.
        """
        if not 0 <= level <= self.hello.levels:
            raise ValueError(f"level {level} is not there, the coarsest is {self.hello.levels}")
        mirror = Mirror(self.hello.grid, region, level)
        await self._drop_subscription()
        subscription = Subscription(self._take, mirror)
        self._subscription = subscription
        await self._send(messages.subscribe(region, level, form, window))
        return subscription

    async def mirror(
        self, region: RegionLike | None = None, level: int = 0, form: str = "r32", window: int = DEFAULT_WINDOW
    ) -> LiveMirror:
        """Subscribe, and put the pages together into one array that stays up to date."""
        return LiveMirror(await self.subscribe(region, level, form, window))

    async def unsubscribe(self) -> None:
        """Ask for no more pages."""
        await self._drop_subscription()
        await self._send(messages.unsubscribe())

    def events(self) -> Events:
        """All events from this call on, as they come, until the connection closes."""
        events = Events()
        if self._lost is None:
            self._listeners.add(events)
        else:
            events.end()
        return events

    async def _send(self, message: str) -> None:
        if self._lost is not None:
            raise ConnectionLost(str(self._lost)) from self._lost
        if self._connection is None:
            raise ConnectionLost("the live channel is not open yet: use `async with`")
        try:
            await self._connection.send(message)
        except ConnectionClosed as error:
            raise ConnectionLost(f"the live channel is closed: {error}") from error

    def _expect(self) -> tuple[int, asyncio.Future[Change]]:
        number = next(self._numbers)
        done: asyncio.Future[Change] = asyncio.get_running_loop().create_future()
        # Who gave up waiting shall not be told that no one heard the answer.
        done.add_done_callback(lambda future: future.cancelled() or future.exception())
        self._waiting[number] = done
        return number, done

    async def _ask(self, message: str, done: asyncio.Future[Change]) -> Change:
        await self._send(message)
        return await done

    async def _take(self, count: int, more_waiting: bool) -> None:
        """Count frames as taken, and tell so now and then: at once where no other is waiting."""
        self._taken += count
        if count == 0 or (more_waiting and self._taken - self._acknowledged < DEFAULT_WINDOW // 4):
            return
        taken = self._taken
        with contextlib.suppress(ConnectionLost):
            await self._send(messages.ack(taken))
            self._acknowledged = max(self._acknowledged, taken)

    async def _drop_subscription(self) -> None:
        """End the subscription; what had come of it and was not looked at counts as taken."""
        if self._subscription is not None:
            subscription, self._subscription = self._subscription, None
            await self._take(subscription.end(None), more_waiting=False)

    async def _read(self, connection: ClientConnection) -> None:
        lost: OrogenyException = ConnectionLost("the live channel was closed")
        try:
            async for message in connection:
                if isinstance(message, bytes):
                    await self._take_frame(frames.decode(message))
                else:
                    self._take_event(parse_event(message))
        except ConnectionClosed as error:
            lost = ConnectionLost(f"the live channel was closed: {error}")
        except OrogenyException as error:
            lost = error
            await connection.close(1002)
        finally:
            self._end(lost)

    async def _take_frame(self, frame: PageFrame) -> None:
        # Frames of a subscription that has just been replaced may still be on their way.
        if self._subscription is None or not self._subscription.offer(frame):
            await self._take(1, more_waiting=False)

    def _take_event(self, event: Event) -> None:
        kind, number = event["event"], event.get("id")
        if isinstance(number, int):
            if kind == "done":
                self._settle(number, Change.parse(event))
            elif kind == "error":
                self._settle(number, error_of(event))
            elif kind == "cut" and (stroke := self._strokes.get(number)) is not None:
                stroke.is_cut = True
        elif kind == "error" and self._subscription is not None and not self._subscription.has_begun:
            # An error without a number is about the connection: a subscription is all that could be refused.
            self._subscription.end(error_of(event))
        for listener in list(self._listeners):
            listener.put(event)

    def _settle(self, number: int, outcome: Change | OrogenyException) -> None:
        done = self._waiting.pop(number, None)
        self._strokes.pop(number, None)
        if done is None or done.done():
            return
        if isinstance(outcome, Change):
            done.set_result(outcome)
        else:
            done.set_exception(outcome)

    def _end(self, lost: OrogenyException) -> None:
        self._lost = lost
        for number in list(self._waiting):
            self._settle(number, lost)
        if self._subscription is not None:
            self._subscription.end(lost)
        for listener in list(self._listeners):
            listener.end()


class LiveStroke:
    """A stroke while it is drawn; ended or taken back as a context manager, the latter on an exception."""

    def __init__(self, live: Live, number: int, done: asyncio.Future[Change]) -> None:
        self.is_cut = False
        self._live = live
        self._number = number
        self._done = done
        self._is_ended = False

    async def points(self, more: Points) -> None:
        """Draw on to further points; raises `StrokeCut` once the service has ended the stroke."""
        if self._done.done() and not self._done.cancelled() and (error := self._done.exception()) is not None:
            raise error
        if self.is_cut or self._done.done():
            raise StrokeCut("the service ended the stroke since others waited for it: begin another one to go on")
        for message in messages.points(self._number, more):
            await self._live._send(message)

    async def end(self) -> Change:
        """Lift the hand, and wait until the stroke is on disk."""
        if not self._is_ended and not self.is_cut and not self._done.done():
            self._is_ended = True
            await self._live._send(messages.end_stroke(self._number))
        return await asyncio.shield(self._done)

    async def cancel(self) -> None:
        """Take the stroke back, bit for bit. Nothing happens where it is done."""
        if not self._done.done():
            self._is_ended = True
            await self._live._send(messages.cancel_stroke(self._number))

    async def __aenter__(self) -> LiveStroke:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is None:
            await self.end()
        else:
            with contextlib.suppress(OrogenyException):
                await self.cancel()


async def _parts(points: SomePoints) -> AsyncIterator[list[list[float]]]:
    if isinstance(points, AsyncIterable):
        async for point in points:
            yield operations.point_list([point])
    else:
        yield operations.point_list(points)


def _joined(done: Change | None, change: Change) -> Change:
    return change if done is None else done.then(change)
