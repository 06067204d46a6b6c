"""The service as a client for asyncio: the same calls as `orogeny.client`, awaited."""

from __future__ import annotations

from collections.abc import Iterable
from types import TracebackType
from typing import Any, TypeVar

import httpx
import numpy.typing as npt

from . import calls, operations
from .calls import Answer, Call, TerrainCalls
from .client import DEFAULT_TIMEOUT_S
from .errors import ConnectionLost
from .grid import RegionLike
from .heights import Heights
from .live import Live
from .operations import Brush, LayerName, Operation, Points
from .results import Change

T = TypeVar("T")


class AsyncClient:
    """A service; see `orogeny.Client`."""

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
        self._http = httpx.AsyncClient(
            base_url=self.url, headers=calls.authorization(token), timeout=httpx.Timeout(timeout_s, connect=10)
        )

    async def terrains(self) -> list[dict[str, Any]]:
        """Which terrains there are; each has a `name`."""
        return await self.send(calls.terrains())

    def terrain(self, name: str) -> AsyncTerrain:
        """One of the terrains. Nothing is asked yet."""
        return AsyncTerrain(self, name)

    async def brushes(self) -> list[dict[str, Any]]:
        """Every brush: its `type`, and its `schema`."""
        return await self.send(calls.brushes())

    def live(self, terrain: str) -> Live:
        """The live channel of a terrain: `async with client.live(name) as live:`."""
        return Live(self.url, terrain, self._token, self.author)

    async def send(self, call: Call[T]) -> T:
        """Send a call, and read its answer."""
        try:
            answer = await self._http.request(call.method, call.path, content=call.body, headers=dict(call.headers))
        except httpx.TransportError as error:
            raise ConnectionLost(f"{self.url}: {error!r}") from error
        return call.result(Answer(answer.status_code, answer.headers, answer.content))

    async def close(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    async def __aenter__(self) -> AsyncClient:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()


class AsyncTerrain:
    """A terrain of a service; see `orogeny.Terrain`."""

    def __init__(self, client: AsyncClient, name: str) -> None:
        self.name = name
        self._client = client
        self._calls = TerrainCalls(name, client.author)

    async def info(self) -> dict[str, Any]:
        """Size, layers, place in the history, who is there."""
        return await self._client.send(self._calls.info())

    async def read_heights(
        self, region: RegionLike | None = None, level: int = 0, *, layer: LayerName | None = None
    ) -> Heights:
        """Read heights of a region `(x, z, width, depth)` in metres at a level."""
        return await self._client.send(self._calls.read_heights(region, level, layer))

    async def write_heights(
        self, array: npt.ArrayLike, x_m: float, z_m: float, layer: LayerName | None = None
    ) -> Change:
        """Write heights `[z, x]`, metres, onto a layer, from `x_m`, `z_m` on."""
        return await self._client.send(self._calls.write_heights(array, x_m, z_m, layer))

    async def apply(self, operations: Iterable[Operation]) -> Change:
        """Run operations, all of them or none."""
        return await self._client.send(self._calls.apply(operations))

    async def stroke(
        self,
        brush: Brush,
        points: Points,
        layer: LayerName | None = None,
        seed: int | None = None,
        *,
        target: str | None = None,
    ) -> Change:
        """Draw a stroke along `points`."""
        return await self.apply([operations.stroke(brush, points, layer=layer, seed=seed, target=target)])

    async def undo(self, count: int = 1, *, anyone: bool = False) -> Change:
        """Take back what this author did last; with `anyone`, what was done last."""
        return await self._client.send(self._calls.undo(count, anyone))

    async def redo(self, count: int = 1, *, anyone: bool = False) -> Change:
        """Do again what was taken back last."""
        return await self._client.send(self._calls.redo(count, anyone))

    async def history(self, before: int | None = None, limit: int | None = None) -> list[dict[str, Any]]:
        """What was done, newest first."""
        return await self._client.send(self._calls.history(before, limit))

    def live(self) -> Live:
        """The live channel of this terrain."""
        return self._client.live(self.name)
