"""What the add-on is connected to and shows. One service, one terrain and one region at a time.

All of this belongs to Blender's main thread. What the live channel's thread has received is taken over by `drain`,
which a timer calls.
"""

from __future__ import annotations

from typing import Any
from urllib.parse import urlsplit

import bpy

from .core import calls
from .core.calls import TerrainCalls
from .core.errors import OrogenyException
from .core.grid import Region, Samples
from .core.results import Hello
from .feed import Feed
from .sender import Sender
from .surface import Surface, check_size

DRAIN_EVERY_S = 1 / 30
_HELLO_WITHIN_S = 10.0
_LOOPBACK = {"localhost", "127.0.0.1", "::1"}


class Session:
    """A connection to a terrain."""

    def __init__(self, url: str, token: str, terrain: str, author: str) -> None:
        self.sender = Sender(url, token)
        _check_online(url)
        self.terrains = [str(each.get("name", "")) for each in self.sender.send(calls.terrains())]
        if not terrain:
            if not self.terrains:
                raise ValueError("the service has no terrain")
            terrain = self.terrains[0]
        self.author = author
        self.calls = TerrainCalls(terrain, author)
        self.feed = Feed(self.sender, terrain, author)
        self.surface: Surface | None = None
        self.others: list[str] = []
        self.last_error = ""
        self.is_stale = False
        self.feed.start(_HELLO_WITHIN_S)

    @property
    def hello(self) -> Hello:
        """What the service said of the terrain."""
        assert self.feed.hello is not None
        return self.feed.hello

    @property
    def problem(self) -> str:
        """What is wrong now, for people; empty if nothing is."""
        return str(self.feed.error) if self.feed.error is not None else self.last_error

    def samples(self, region: Region | None, level: int) -> Samples:
        """The samples of a region, which the terrain must have."""
        if not 0 <= level <= self.hello.levels:
            raise ValueError(f"level {level} is not there, the coarsest is {self.hello.levels}")
        samples = self.hello.grid.samples_in(region, level)
        if samples.is_empty:
            raise ValueError("the region lies outside the terrain")
        return samples

    def follow(self, region: Region | None, level: int, collection: bpy.types.Collection) -> Surface:
        """Show a region as an object that follows the live channel; the one before is left as it is."""
        check_size(self.samples(region, level), level)
        mirror = self.feed.subscribe(region, level)
        self.surface = Surface(f"{self.calls.name} {level}", mirror, collection)
        return self.surface

    def drain(self) -> bool:
        """Take over what came; whether the object was changed."""
        for event in self.feed.take_events():
            self._hear(event)
        changed = self.feed.take_changed()
        if self.surface is None or not (changed or self.is_stale):
            return False
        self.is_stale = False
        if self.surface.update():
            return True
        # It was deleted, or given another mesh: what would it be kept up to date for?
        self.surface = None
        try:
            self.feed.unsubscribe()
        except OrogenyException as error:
            self.last_error = str(error)
        return False

    def close(self) -> None:
        """Disconnect; the object stays as it is."""
        self.feed.stop()

    def _hear(self, event: dict[str, Any]) -> None:
        kind = event.get("event")
        if kind == "clients":
            own = self.hello.client
            self.others = [str(c.get("author")) for c in event.get("clients", []) if c.get("client") != own]
        elif kind == "error":
            self.last_error = str(event.get("message"))
        elif kind == "done":
            self.last_error = ""


_current: Session | None = None


def current() -> Session | None:
    """The session, if there is one."""
    return _current


def needed() -> Session:
    """The session; raises where there is none."""
    if _current is None:
        raise ValueError("not connected: use Connect first")
    return _current


def connect(url: str, token: str, terrain: str, author: str) -> Session:
    """Connect, in place of what there was."""
    global _current
    disconnect()
    _current = Session(url, token, terrain, author)
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=DRAIN_EVERY_S, persistent=True)
    return _current


def disconnect() -> None:
    """Disconnect, if there is something to disconnect from."""
    global _current
    if _current is not None:
        _current.close()
        _current = None
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)


def drain() -> bool:
    """Take over what came from the live channel; whether the object was changed."""
    if _current is None or not _current.drain():
        return False
    _redraw()
    return True


def _tick() -> float | None:
    drain()
    return DRAIN_EVERY_S if _current is not None else None


def _redraw() -> None:
    for window in bpy.context.window_manager.windows if bpy.context.window_manager else []:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def _check_online(url: str) -> None:
    host = urlsplit(url).hostname
    if host not in _LOOPBACK and not getattr(bpy.app, "online_access", True):
        raise ValueError(f"{host} is on the network, and Blender is set to stay offline: allow online access first")


@bpy.app.handlers.persistent
def _on_load(*_: object) -> None:
    """Another file has other objects."""
    if _current is not None:
        _current.surface = None


@bpy.app.handlers.persistent
def _on_undo(*_: object) -> None:
    """Blender's own undo brings old heights back: the terrain's are still those of the service."""
    if _current is not None:
        _current.is_stale = True


_HANDLERS = [("load_pre", _on_load), ("undo_post", _on_undo), ("redo_post", _on_undo)]


def register() -> None:
    """Hear of files that are opened, and of Blender's undo."""
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    """Disconnect."""
    disconnect()
    for name, handler in _HANDLERS:
        handlers = getattr(bpy.app.handlers, name)
        if handler in handlers:
            handlers.remove(handler)
