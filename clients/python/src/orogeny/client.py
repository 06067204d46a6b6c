"""The service as a plain, blocking client."""

from __future__ import annotations

from collections.abc import Iterable
from types import TracebackType
from typing import Any, TypeVar

import httpx
import numpy.typing as npt

from . import calls, operations
from .calls import Answer, Call, TerrainCalls
from .errors import ConnectionLost
from .grid import RegionLike
from .heights import Heights
from .live_thread import LiveThread
from .operations import Brush, LayerName, Operation, Points
from .results import Change

T = TypeVar("T")

DEFAULT_TIMEOUT_S = 600.0
"""How long an answer may take: erosion of a large region takes minutes."""


class Client:
    """A service.

    `url` is such as `http://127.0.0.1:4750`, `token` what it asks for where it does not listen on the machine
    itself, `author` the name that the history keeps and that undo goes by. Closes its connections as a context manager.
    """

    def __init__(
        self,
        url: str,
        token: str | None = None,
        author: str | None = None,
        *,
        timeout_s: float = DEFAULT_TIMEOUT_S,
    ) -> None:
        self.url = calls.check_url(url)
        self.author = author
        self._token = token
        self._http = httpx.Client(
            base_url=self.url, headers=calls.authorization(token), timeout=httpx.Timeout(timeout_s, connect=10)
        )

    def terrains(self) -> list[dict[str, Any]]:
        """Which terrains there are: `name`, `width` and `depth` in samples, `spacing` in metres and more."""
        return self.send(calls.terrains())

    def terrain(self, name: str) -> Terrain:
        """One of the terrains. Nothing is asked yet."""
        return Terrain(self, name)

    def brushes(self) -> list[dict[str, Any]]:
        """Every brush: its `type`, and as a JSON `schema` its parameters with their ranges and defaults."""
        return self.send(calls.brushes())

    def live(self, terrain: str) -> LiveThread:
        """The live channel of a terrain, on a thread of its own."""
        return LiveThread(self.url, terrain, self._token, self.author)

    def send(self, call: Call[T]) -> T:
        """Send a call, and read its answer."""
        try:
            answer = self._http.request(call.method, call.path, content=call.body, headers=dict(call.headers))
        except httpx.TransportError as error:
            raise ConnectionLost(f"{self.url}: {error!r}") from error
        return call.result(Answer(answer.status_code, answer.headers, answer.content))

    def close(self) -> None:
        """Close the connections."""
        self._http.close()

    def __enter__(self) -> Client:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class Terrain:
    """A terrain of a service."""

    def __init__(self, client: Client, name: str) -> None:
        self.name = name
        self._client = client
        self._calls = TerrainCalls(name, client.author)

    def info(self) -> dict[str, Any]:
        """`width` and `depth` in samples, `spacing` in metres, `layers`, `levels`, who is there and more."""
        return self._client.send(self._calls.info())

    def read_heights(
        self, region: RegionLike | None = None, level: int = 0, *, layer: LayerName | None = None
    ) -> Heights:
        """Read heights.

        `region` is `(x, z, width, depth)` in metres, all of the terrain by default; `level` 0 is full resolution, each
        next one has one sample for two each way. With a `layer`, that layer's own heights; else what all come to.
        """
        return self._client.send(self._calls.read_heights(region, level, layer))

    def write_heights(self, array: npt.ArrayLike, x_m: float, z_m: float, layer: LayerName | None = None) -> Change:
        """Write heights onto a layer, the lowest by default.

        `array` is of shape `(depth, width)`, indexed `[z, x]`, metres, at full resolution; its first sample lies at
        `x_m`, `z_m`, metres from the north-west corner.
        """
        return self._client.send(self._calls.write_heights(array, x_m, z_m, layer))

    def apply(self, operations: Iterable[Operation]) -> Change:
        """Run operations, all of them or none; they are on disk when this returns."""
        return self._client.send(self._calls.apply(operations))

    def stroke(
        self,
        brush: Brush,
        points: Points,
        layer: LayerName | None = None,
        seed: int | None = None,
        *,
        target: str | None = None,
    ) -> Change:
        """Draw a stroke along `points`, `[x, z]` in metres, each with pressure 0..1, seconds and tilt if you like."""
        return self.apply([operations.stroke(brush, points, layer=layer, seed=seed, target=target)])

    def undo(self, count: int = 1, *, anyone: bool = False) -> Change:
        """Take back what this author did last, `count` of it; with `anyone`, what was done last.

        Where there is nothing to take back, nothing happens, and the change's `rect` is empty.
        """
        return self._client.send(self._calls.undo(count, anyone))

    def redo(self, count: int = 1, *, anyone: bool = False) -> Change:
        """Do again what this author took back last; with `anyone`, what was taken back last."""
        return self._client.send(self._calls.redo(count, anyone))

    def history(self, before: int | None = None, limit: int | None = None) -> list[dict[str, Any]]:
        """What was done, newest first: up to `limit` entries, those before the entry `before`.

        Each has its number as `entry`, `what` was done, `author` and `state`.
        """
        return self._client.send(self._calls.history(before, limit))

    def live(self) -> LiveThread:
        """The live channel of this terrain, on a thread of its own."""
        return self._client.live(self.name)
