"""The live channel on a thread of its own. Nothing here knows Blender: what came is fetched by its main thread."""

from __future__ import annotations

import itertools
import json
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from .core import calls, frames, messages
from .core.errors import AnswerError, ConnectionLost, OrogenyError, OrogenyException
from .core.grid import RegionLike, Samples
from .core.mirror import Mirror
from .core.results import Change, Hello
from .sender import Sender
from .websocket import HandshakeRefused, WebSocket

WINDOW = 8
_KEPT_EVENTS = 256
_FIRST_PAUSE_S, _LAST_PAUSE_S = 0.5, 10.0


class Feed:
    """A live channel that connects again when it is lost; what was subscribed is then asked for anew."""

    def __init__(self, sender: Sender, terrain: str, author: str) -> None:
        self.terrain = terrain
        self.hello: Hello | None = None
        self.error: OrogenyException | None = None
        self._url = calls.live_url(sender.url, terrain, author)
        self._headers = calls.authorization(sender.token)
        self._lock = threading.Lock()
        self._numbers = itertools.count(1)
        self._waiting: dict[int, Future[Change]] = {}
        self._cut: set[int] = set()
        self._events: deque[dict[str, Any]] = deque(maxlen=_KEPT_EVENTS)
        self._changed: list[Samples] = []
        self._mirror: Mirror | None = None
        self._wanted: tuple[RegionLike | None, int] | None = None
        self._socket: WebSocket | None = None
        self._is_open = threading.Event()
        self._is_stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"orogeny live {terrain}", daemon=True)

    def start(self, timeout_s: float) -> Hello:
        """Connect, and wait for `hello`; raises what went wrong."""
        self._thread.start()
        if not self._is_open.wait(timeout_s):
            error = self.error or ConnectionLost(f"no answer within {timeout_s:g} s")
            self.stop()
            raise error
        if self.hello is None:
            self.stop()
            raise self.error or ConnectionLost("the live channel was closed")
        return self.hello

    def stop(self) -> None:
        """Close the connection for good."""
        self._is_stopped.set()
        socket = self._socket
        if socket is not None:
            socket.close()
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join(5)

    def subscribe(self, region: RegionLike | None, level: int) -> Mirror:
        """Follow a region at a level, in place of what was followed before."""
        if self.hello is None:
            raise ConnectionLost("the live channel is not open")
        mirror = Mirror(self.hello.grid, region, level)
        with self._lock:
            self._mirror, self._wanted, self._changed = mirror, (region, level), []
        self.send(messages.subscribe(region, level, window=WINDOW))
        return mirror

    def unsubscribe(self) -> None:
        """Follow nothing."""
        with self._lock:
            self._mirror, self._wanted, self._changed = None, None, []
        self.send(messages.unsubscribe())

    def take_changed(self) -> list[Samples]:
        """Which rows and columns of the mirror changed since the last call."""
        with self._lock:
            changed, self._changed = self._changed, []
        return changed

    def take_events(self) -> list[dict[str, Any]]:
        """The events since the last call, the oldest first."""
        with self._lock:
            events = list(self._events)
            self._events.clear()
        return events

    def send(self, message: str) -> None:
        """Send a message."""
        socket = self._socket
        if socket is None:
            raise ConnectionLost(str(self.error or "the live channel is not open"))
        socket.send_text(message)

    def ask(self, write: Callable[[int], str]) -> tuple[int, Future[Change]]:
        """Send a message under a new number; the future is done when what it asks for is done."""
        done: Future[Change] = Future()
        with self._lock:
            number = next(self._numbers)
            self._waiting[number] = done
        try:
            self.send(write(number))
        except OrogenyException:
            with self._lock:
                self._waiting.pop(number, None)
            raise
        return number, done

    def is_cut(self, number: int) -> bool:
        """Whether the service ended that stroke since others waited."""
        return number in self._cut

    def _run(self) -> None:
        pause_s = _FIRST_PAUSE_S
        while not self._is_stopped.is_set():
            try:
                self._follow()
            except OrogenyException as error:
                self.error = error
            if self.hello is None:
                break
            if self._socket is not None:
                pause_s = _FIRST_PAUSE_S
            self._lose()
            if self._is_stopped.wait(pause_s):
                break
            pause_s = min(pause_s * 2, _LAST_PAUSE_S)
        self._lose()
        self._is_open.set()

    def _follow(self) -> None:
        try:
            socket = WebSocket(self._url, self._headers)
        except HandshakeRefused as refused:
            raise calls.refusal(refused.answer) from refused
        try:
            event = _parse(socket.receive())
            if event.get("event") != "hello":
                raise AnswerError(f"the live channel began with {event!r}")
            hello = Hello.parse(event)
            if hello.page_size != frames.PAGE_SIZE:
                raise AnswerError(f"pages have {hello.page_size} samples a side, not {frames.PAGE_SIZE}")
            self.hello, self.error = hello, None
            self._socket = socket
            self._resume(hello)
            self._is_open.set()
            self._read(socket)
        finally:
            socket.close()

    def _resume(self, hello: Hello) -> None:
        with self._lock:
            wanted = self._wanted
            if wanted is not None:
                fresh = Mirror(hello.grid, *wanted)
                if self._mirror is not None and fresh.shape != self._mirror.shape:
                    raise AnswerError("the terrain has another size than before: show it anew")
        if wanted is not None:
            self.send(messages.subscribe(*wanted, window=WINDOW))

    def _read(self, socket: WebSocket) -> None:
        for taken in itertools.count(1):
            while isinstance(message := socket.receive(), str):
                self._take_event(_parse(message))
            self._take_frame(message)
            socket.send_text(messages.ack(taken))

    def _take_frame(self, message: bytes) -> None:
        frame = frames.decode(message)
        with self._lock:
            here = self._mirror.apply(frame) if self._mirror is not None else None
            if here is not None and here not in self._changed:
                self._changed.append(here)

    def _take_event(self, event: dict[str, Any]) -> None:
        kind, number = event.get("event"), event.get("id")
        with self._lock:
            self._events.append(event)
            if kind == "cut" and isinstance(number, int):
                self._cut.add(number)
            if kind not in ("done", "error") or not isinstance(number, int):
                return
            done = self._waiting.pop(number, None)
            self._cut.discard(number)
        if done is None or done.done():
            return
        if kind == "done":
            done.set_result(Change.parse(event))
        else:
            done.set_exception(OrogenyError(str(event.get("code")), str(event.get("message")), event.get("limit")))

    def _lose(self) -> None:
        error = self.error or ConnectionLost("the live channel was closed")
        with self._lock:
            self._socket = None
            waiting, self._waiting = self._waiting, {}
            self._cut.clear()
        for done in waiting.values():
            if not done.done():
                done.set_exception(error)


def _parse(message: str | bytes) -> dict[str, Any]:
    try:
        event = json.loads(message) if isinstance(message, str) else None
    except ValueError:
        event = None
    if not isinstance(event, dict):
        raise AnswerError(f"a message that is no event: {message[:200]!r}")
    return event
