"""A small stand-in for the service, on a thread of its own, for tests of the clients alone.

It has one terrain, `fake`, knows the brushes `raise` and `lower` as flat discs, and keeps to the page on the
service: placement headers, errors, window and acknowledgement of page frames, undo by author.
"""

from __future__ import annotations

import asyncio
import itertools
import json
import threading
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
from aiohttp import WSMsgType, web

from orogeny import frames
from orogeny.frames import PageFrame
from orogeny.grid import Grid, Region, Samples

TOKEN = "secret-token"


class Refused(Exception):  # noqa: N818
    def __init__(self, code: str, message: str, status: int = 400, limit: Any = None) -> None:
        super().__init__(message)
        self.code, self.message, self.status, self.limit = code, message, status, limit

    def as_json(self) -> dict[str, Any]:
        error = {"code": self.code, "message": self.message}
        return error if self.limit is None else error | {"limit": self.limit}


@dataclass
class Entry:
    number: int
    author: str
    what: str
    delta: npt.NDArray[np.float32]
    applied: bool = True


@dataclass(eq=False)
class Viewer:
    number: int
    author: str
    socket: web.WebSocketResponse
    region: Samples | None = None
    level: int = 0
    form: str = "r32"
    window: int = 16
    sent: int = 0
    acknowledged: int = 0
    waiting: dict[tuple[int, int], None] = field(default_factory=dict)
    strokes: dict[int, dict[str, Any]] = field(default_factory=dict)
    most_under_way: int = 0


class FakeService:
    def __init__(self, width: int = 600, depth: int = 300, spacing: float = 2.0, token: str | None = None) -> None:
        self.grid = Grid(width, depth, spacing)
        self.token = token
        rows, columns = np.mgrid[0:depth, 0:width].astype(np.float32)
        self.ground: npt.NDArray[np.float32] = (columns * np.float32(0.25) + rows).astype(np.float32)
        self.entries: list[Entry] = []
        self.revision = 7
        self.viewers: set[Viewer] = set()
        self.received: list[dict[str, Any]] = []
        self.cut_after_points: int | None = None
        self.most_pages = 100
        self._numbers = itertools.count(1)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._tasks: set[asyncio.Future[None]] = set()
        self.url = ""

    # Lifetime

    def __enter__(self) -> FakeService:
        self._thread.start()
        asyncio.run_coroutine_threadsafe(self._start(), self._loop).result(10)
        return self

    def __exit__(self, *_: object) -> None:
        asyncio.run_coroutine_threadsafe(self._runner.cleanup(), self._loop).result(10)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(10)
        self._loop.close()

    def drop_all(self) -> None:
        async def drop() -> None:
            for viewer in list(self.viewers):
                await viewer.socket.close(code=1001)

        asyncio.run_coroutine_threadsafe(drop(), self._loop).result(10)

    def send_raw(self, data: bytes) -> None:
        async def send() -> None:
            for viewer in list(self.viewers):
                await viewer.socket.send_bytes(data)

        asyncio.run_coroutine_threadsafe(send(), self._loop).result(10)

    async def _start(self) -> None:
        app = web.Application(middlewares=[self._guard], client_max_size=64 * 1024 * 1024)
        terrain = "/v1/terrains/fake"
        app.add_routes(
            [
                web.get("/v1/terrains", self._terrains),
                web.get("/v1/brushes", self._brushes),
                web.get(terrain, self._info),
                web.get(f"{terrain}/heights", self._read),
                web.put(f"{terrain}/heights", self._write),
                web.post(f"{terrain}/operations", self._operations),
                web.post(f"{terrain}/undo", self._undo),
                web.post(f"{terrain}/redo", self._redo),
                web.get(f"{terrain}/history", self._history),
                web.get(f"{terrain}/live", self._live),
            ]
        )
        self._runner = web.AppRunner(app, shutdown_timeout=0.2)
        await self._runner.setup()
        site = web.TCPSite(self._runner, "127.0.0.1", 0)
        await site.start()
        host, port = self._runner.addresses[0][:2]
        self.url = f"http://{host}:{port}"

    @web.middleware
    async def _guard(self, request: web.Request, handler: Any) -> web.StreamResponse:
        try:
            if self.token is not None and request.headers.get("authorization") != f"Bearer {self.token}":
                raise Refused("unauthorized", "a token is needed", 401)
            response: web.StreamResponse = await handler(request)
            return response
        except Refused as refused:
            return web.json_response({"error": refused.as_json()}, status=refused.status)
        except web.HTTPNotFound:
            return web.json_response({"error": {"code": "not_found", "message": "no such thing"}}, status=404)

    # The terrain

    def heights(self, level: int = 0) -> npt.NDArray[np.float32]:
        total = self.ground.copy()
        for entry in self.entries:
            if entry.applied:
                total += entry.delta
        return np.ascontiguousarray(total[:: 2**level, :: 2**level])

    def draw(self, operation: dict[str, Any], into: npt.NDArray[np.float32]) -> None:
        unknown = set(operation) - {"op", "brush", "points", "layer", "seed", "target"}
        if unknown:
            raise Refused("invalid_operation", f"unknown field `{unknown.pop()}`", 422)
        brush = operation["brush"]
        if operation["op"] != "stroke" or brush.get("type") not in ("raise", "lower"):
            raise Refused("invalid_operation", f"unknown brush `{brush.get('type')}`", 422)
        sign = 1 if brush["type"] == "raise" else -1
        rows, columns = np.mgrid[0 : self.grid.depth, 0 : self.grid.width] * self.grid.spacing_m
        inside = np.zeros(into.shape, dtype=bool)
        for point in operation["points"]:
            inside |= (columns - point[0]) ** 2 + (rows - point[1]) ** 2 <= brush["radius"] ** 2
        into[inside] += np.float32(sign * brush["strength"])

    async def commit(self, author: str, what: str, delta: npt.NDArray[np.float32]) -> dict[str, Any]:
        self.entries = [entry for entry in self.entries if entry.applied]
        number = next(self._numbers)
        self.entries.append(Entry(number, author, what, delta))
        return await self._announce(author, what, [number], delta)

    async def toggle(self, author: str, value: dict[str, Any], applied: bool) -> dict[str, Any]:
        wanted = [e for e in self.entries if e.applied == applied and (value.get("anyone") or e.author == author)]
        chosen = wanted[::-1] if applied else wanted
        count = value.get("count", 1)
        if not chosen:
            return {"revision": self.revision, "entries": [], "rect": [0.0, 0.0, 0.0, 0.0]}
        delta = np.zeros_like(self.ground)
        for entry in chosen[:count]:
            entry.applied = not applied
            delta += np.abs(entry.delta)
        return await self._announce(author, "undo" if applied else "redo", [], delta)

    async def _announce(
        self, author: str, what: str, entries: list[int], delta: npt.NDArray[np.float32]
    ) -> dict[str, Any]:
        self.revision += 1
        rows, columns = np.nonzero(delta)
        spacing = self.grid.spacing_m
        rect = None
        if len(rows):
            x0, x1, z0, z1 = columns.min(), columns.max() + 1, rows.min(), rows.max() + 1
            rect = [float(v) * spacing for v in (x0, z0, x1 - x0, z1 - z0)]
        done = {"revision": self.revision, "entries": entries, "rect": rect}
        event = {"event": "operation", "author": author, "client": None, "what": what} | done
        for viewer in list(self.viewers):
            await viewer.socket.send_str(json.dumps(event))
            if viewer.region is not None and rect is not None:
                changed = self.grid.samples_in(Region(*rect), 0)
                step = 2**viewer.level
                coarse = Samples(changed.x0 // step, changed.z0 // step, changed.x1 // step + 1, changed.z1 // step + 1)
                self._queue(viewer, coarse.intersection(viewer.region))
        return done

    # HTTP

    async def _terrains(self, _: web.Request) -> web.Response:
        return web.json_response({"terrains": [{"name": "fake"}]})

    async def _brushes(self, _: web.Request) -> web.Response:
        return web.json_response(
            {"brushes": [{"type": kind, "schema": {"title": kind}} for kind in ("raise", "lower")]}
        )

    async def _info(self, _: web.Request) -> web.Response:
        grid = self.grid
        return web.json_response(
            {"name": "fake", "width": grid.width, "depth": grid.depth, "spacing": grid.spacing_m, "levels": 2}
        )

    async def _read(self, request: web.Request) -> web.Response:
        query = request.query
        level = int(query.get("level", "0"))
        region = None
        if "x" in query:
            region = Region(*(float(query[name]) for name in ("x", "z", "width", "depth")))
        samples = self.grid.samples_in(region, level)
        if samples.is_empty:
            raise Refused("outside", "the region lies outside the terrain", 422)
        spacing = self.grid.spacing_at(level)
        part = self.heights(level)[samples.z0 : samples.z1, samples.x0 : samples.x1]
        headers = {
            "orogeny-x": str(samples.x0 * spacing),
            "orogeny-z": str(samples.z0 * spacing),
            "orogeny-width": str(samples.width),
            "orogeny-depth": str(samples.depth),
            "orogeny-spacing": str(spacing),
        }
        return web.Response(body=part.astype("<f4").tobytes(), headers=headers)

    async def _write(self, request: web.Request) -> web.Response:
        query = request.query
        width, depth = int(query["width"]), int(query["depth"])
        body = await request.read()
        if len(body) != width * depth * 4:
            raise Refused("wrong_length", "that is not so many samples", 422)
        if width * depth > 1_000_000:
            raise Refused("too_large", "too many samples", 413, {"samples": 1_000_000})
        x0, z0 = round(float(query["x"]) / self.grid.spacing_m), round(float(query["z"]) / self.grid.spacing_m)
        delta = np.zeros_like(self.ground)
        where = np.s_[z0 : z0 + depth, x0 : x0 + width]
        delta[where] = np.frombuffer(body, "<f4").reshape(depth, width) - self.heights()[where]
        return web.json_response(await self.commit(query.get("author", "anonymous"), "import", delta))

    async def _operations(self, request: web.Request) -> web.Response:
        value = await request.json()
        return web.json_response(await self._run(value.get("author", "anonymous"), value["operations"]))

    async def _run(self, author: str, operations: list[dict[str, Any]]) -> dict[str, Any]:
        delta = np.zeros_like(self.ground)
        for operation in operations:
            self.draw(operation, delta)
        return await self.commit(author, f"stroke {operations[0]['brush']['type']}", delta)

    async def _undo(self, request: web.Request) -> web.Response:
        value = await request.json()
        return web.json_response(await self.toggle(value.get("author", "anonymous"), value, True))

    async def _redo(self, request: web.Request) -> web.Response:
        value = await request.json()
        return web.json_response(await self.toggle(value.get("author", "anonymous"), value, False))

    async def _history(self, request: web.Request) -> web.Response:
        newest = [
            {"entry": e.number, "author": e.author, "what": e.what, "applied": e.applied} for e in self.entries[::-1]
        ]
        return web.json_response({"entries": newest[: int(request.query.get("limit", "100"))]})

    # The live channel

    async def _live(self, request: web.Request) -> web.WebSocketResponse:
        socket = web.WebSocketResponse()
        await socket.prepare(request)
        viewer = Viewer(len(self.viewers) + 1, request.query.get("author", "anonymous"), socket)
        self.viewers.add(viewer)
        grid = self.grid
        hello = {"event": "hello", "client": viewer.number, "author": viewer.author, "terrain": "fake"}
        hello |= {"revision": self.revision, "width": grid.width, "depth": grid.depth, "spacing": grid.spacing_m}
        hello |= {"page_size": 256, "levels": 2, "lowest": 0.0, "highest": 500.0}
        try:
            await socket.send_str(json.dumps(hello))
            async for message in socket:
                if message.type == WSMsgType.TEXT:
                    value = json.loads(message.data)
                    self.received.append(value)
                    await self._hear(viewer, value)
        finally:
            self.viewers.discard(viewer)
        return socket

    async def _hear(self, viewer: Viewer, value: dict[str, Any]) -> None:
        kind, number = value["type"], value.get("id")
        try:
            done = await self._act(viewer, kind, number, value)
        except Refused as refused:
            about = {} if number is None else {"id": number}
            await viewer.socket.send_str(json.dumps({"event": "error"} | about | refused.as_json()))
        else:
            if done is not None:
                await viewer.socket.send_str(json.dumps({"event": "done", "id": number} | done))
        await self._flush(viewer)

    async def _act(self, viewer: Viewer, kind: str, number: Any, value: dict[str, Any]) -> dict[str, Any] | None:
        if kind == "begin_stroke":
            viewer.strokes[number] = value["operation"] | {"points": value["operation"].get("points", [])}
        elif kind == "points":
            if number in viewer.strokes:
                stroke = viewer.strokes[number]
                stroke["points"] += value["points"]
                if self.cut_after_points is not None and len(stroke["points"]) >= self.cut_after_points:
                    self.cut_after_points = None
                    await viewer.socket.send_str(json.dumps({"event": "cut", "id": number}))
                    return await self._run(viewer.author, [viewer.strokes.pop(number)])
        elif kind == "end_stroke":
            return await self._run(viewer.author, [viewer.strokes.pop(number)])
        elif kind == "cancel_stroke":
            if viewer.strokes.pop(number, None) is not None:
                raise Refused("cancelled", "the stroke was taken back")
        elif kind == "apply":
            return await self._run(viewer.author, value["operations"])
        elif kind in ("undo", "redo"):
            return await self.toggle(viewer.author, value, kind == "undo")
        elif kind == "subscribe":
            region = Region(*value["region"]) if "region" in value else None
            viewer.level, viewer.form, viewer.window = value["level"], value["format"], value["window"]
            wanted = self.grid.samples_in(region, viewer.level)
            if (pages := len(list(wanted.pages()))) > self.most_pages:
                raise Refused("too_many_pages", f"the region has {pages} pages", limit=self.most_pages)
            viewer.region = wanted
            viewer.waiting.clear()
            self._queue(viewer, viewer.region)
        elif kind == "unsubscribe":
            viewer.region = None
            viewer.waiting.clear()
        elif kind == "ack":
            if not viewer.acknowledged <= value["frames"] <= viewer.sent:
                raise Refused("bad_ack", f"{value['frames']} of {viewer.sent}")
            viewer.acknowledged = value["frames"]
        elif kind != "cursor":
            raise Refused("unknown_message", kind)
        return None

    def _queue(self, viewer: Viewer, samples: Samples) -> None:
        for page in samples.pages():
            viewer.waiting[page] = None
        task = asyncio.ensure_future(self._flush(viewer))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _flush(self, viewer: Viewer) -> None:
        while viewer.waiting and viewer.sent - viewer.acknowledged < viewer.window:
            page_x, page_z = next(iter(viewer.waiting))
            del viewer.waiting[page_x, page_z]
            heights = self.heights(viewer.level)[page_z * 256 : page_z * 256 + 256, page_x * 256 : page_x * 256 + 256]
            frame = PageFrame(viewer.level, page_x, page_z, self.revision, heights)
            viewer.sent += 1
            viewer.most_under_way = max(viewer.most_under_way, viewer.sent - viewer.acknowledged)
            await viewer.socket.send_bytes(frames.encode(frame, viewer.form))
