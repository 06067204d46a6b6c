"""Integration tests, against the running service that OROGENY_SERVICE_URL names; its first terrain is painted on.

The terrain should be of 1,024 x 1,024 samples or so. Every test takes back what it did.
"""

from __future__ import annotations

import asyncio
import io
import os
import uuid
from collections.abc import AsyncIterator, Iterator
from typing import Any

import httpx
import numpy as np
import pytest
import road

from orogeny import Client, Hello, Live, OrogenyError, Region, Terrain

RAISE = {"type": "raise", "radius": 60, "strength": 8}
LOWER = {"type": "lower", "radius": 40, "strength": 3}


@pytest.fixture
def hello(terrain: Terrain) -> Hello:
    with terrain.live() as live:
        return live.hello


@pytest.fixture
def raw(service_url: str, service_token: str | None) -> Iterator[httpx.Client]:
    headers = {"authorization": f"Bearer {service_token}"} if service_token else {}
    with httpx.Client(base_url=service_url, headers=headers, timeout=60) as client:
        yield client


def author() -> str:
    return f"test-{uuid.uuid4().hex[:8]}"


def middle(hello: Hello) -> tuple[float, float]:
    return hello.width * hello.spacing_m / 2, hello.depth * hello.spacing_m / 2


# Reading


def test_what_there_is(terrain: Terrain, hello: Hello) -> None:
    info = terrain.info()
    assert info["name"] == terrain.name == hello.terrain
    assert (info["width"], info["depth"], info["spacing"]) == (hello.width, hello.depth, hello.spacing_m)
    assert hello.lowest_m <= hello.highest_m
    assert isinstance(info["layers"], list)


def test_brushes_are_schemas(service_url: str, service_token: str | None) -> None:
    with Client(service_url, service_token) as client:
        brushes = {brush["type"]: brush["schema"] for brush in client.brushes()}
    assert {"raise", "ramp", "erode_fluvial"} <= set(brushes)
    assert brushes["raise"]["properties"]["radius"]["default"] > 0


@pytest.mark.parametrize("level", [0, 1, 2])
def test_all_of_a_level(terrain: Terrain, hello: Hello, level: int) -> None:
    heights = terrain.read_heights(level=level)
    samples = hello.grid.samples_at(level)
    assert heights.array.shape == (samples.depth, samples.width)
    assert (heights.x_m, heights.z_m, heights.spacing_m) == (0, 0, hello.spacing_m * 2**level)


@pytest.mark.parametrize("level", [0, 1, 2])
def test_a_region_is_a_part_of_all(terrain: Terrain, hello: Hello, level: int) -> None:
    s = hello.spacing_m
    region = (101 * s, 37 * s, 300 * s, 203 * s)
    everything, part = terrain.read_heights(level=level), terrain.read_heights(region, level)
    samples = hello.grid.samples_in(region, level)
    assert (part.x_m, part.z_m) == (samples.x0 * part.spacing_m, samples.z0 * part.spacing_m)
    assert np.array_equal(part.array, everything.array[samples.z0 : samples.z1, samples.x0 : samples.x1])


def test_formats_agree(terrain: Terrain, raw: httpx.Client) -> None:
    path = f"/v1/terrains/{terrain.name}/heights"
    where = {"x": 100, "z": 60, "width": 128, "depth": 64}
    expected = terrain.read_heights((100, 60, 128, 64)).array
    npy = raw.get(path, params=where | {"format": "npy"}).raise_for_status()
    assert np.array_equal(np.load(io.BytesIO(npy.content)), expected)
    r16 = raw.get(path, params=where | {"format": "r16"}).raise_for_status()
    low, high = float(r16.headers["orogeny-low"]), float(r16.headers["orogeny-high"])
    steps = np.frombuffer(r16.content, "<u2").reshape(expected.shape)
    assert np.abs(low + (high - low) * steps / 65535 - expected).max() <= (high - low) / 65535 * 0.51 + 1e-4
    png = raw.get(path, params=where | {"format": "png"}).raise_for_status()
    assert png.content.startswith(b"\x89PNG")
    assert png.headers["content-type"] == "image/png"


# Changing


def test_writing_is_exact_and_undone_exactly(terrain: Terrain, hello: Hello) -> None:
    before = terrain.read_heights()
    s = hello.spacing_m
    new = np.random.default_rng(1).normal(100, 20, (70, 90)).astype(np.float32)
    change = terrain.write_heights(new, 250 * s, 120 * s)
    assert change.entries
    assert np.array_equal(terrain.read_heights((250 * s, 120 * s, 90 * s, 70 * s)).array, new)
    after = terrain.read_heights()
    undone = terrain.undo()
    assert undone.revision > change.revision
    assert terrain.read_heights().array.tobytes() == before.array.tobytes()
    terrain.redo()
    assert terrain.read_heights().array.tobytes() == after.array.tobytes()
    terrain.undo()


def test_a_stroke_changes_what_it_says(terrain: Terrain, hello: Hello) -> None:
    before = terrain.read_heights()
    x, z = middle(hello)
    change = terrain.stroke(RAISE, [[x, z], [x + 50, z + 20, 0.5]], seed=3)
    after = terrain.read_heights()
    rows, columns = np.nonzero(after.array != before.array)
    assert len(rows) > 100
    assert change.rect is not None
    s = hello.spacing_m
    assert change.rect.x <= columns.min() * s
    assert change.rect.x + change.rect.width > columns.max() * s
    assert change.rect.z <= rows.min() * s
    assert change.rect.z + change.rect.depth > rows.max() * s
    newest = terrain.history(limit=1)
    assert len(newest) == 1
    assert "raise" in str(newest[0])
    terrain.undo()
    assert terrain.read_heights().array.tobytes() == before.array.tobytes()


def test_all_or_none(terrain: Terrain, hello: Hello) -> None:
    before = terrain.read_heights()
    x, z = middle(hello)
    good: dict[str, Any] = {"op": "stroke", "brush": RAISE, "points": [[x, z]]}
    for bad in (good | {"colour": 1}, good | {"brush": {"type": "carve"}}, good | {"layer": "no such layer"}):
        with pytest.raises(OrogenyError) as caught:
            terrain.apply([good, bad])
        assert caught.value.status is not None
        assert 400 <= caught.value.status < 500
        assert caught.value.message
        assert terrain.read_heights().array.tobytes() == before.array.tobytes()
    with pytest.raises(OrogenyError, match="colour"):
        terrain.apply([good | {"colour": 1}])


def test_undo_goes_by_author(service_url: str, service_token: str | None, terrain: Terrain, hello: Hello) -> None:
    before = terrain.read_heights()
    x, z = middle(hello)
    with Client(service_url, service_token, author()) as ann, Client(service_url, service_token, author()) as ben:
        a, b = ann.terrain(terrain.name), ben.terrain(terrain.name)
        b.stroke(LOWER, [[x + 30, z]])
        alone = terrain.read_heights()
        b.undo()
        a.stroke(RAISE, [[x, z]])
        b.stroke(LOWER, [[x + 30, z]])
        a.undo()
        assert terrain.read_heights().array.tobytes() == alone.array.tobytes()
        assert a.undo().rect == Region(0, 0, 0, 0)
        b.undo()
        assert terrain.read_heights().array.tobytes() == before.array.tobytes()


def test_no_such_terrain(service_url: str, service_token: str | None) -> None:
    with Client(service_url, service_token) as client:
        for name in ("no such terrain", "../etc/passwd", "a/b"):
            with pytest.raises(OrogenyError) as caught:
                client.terrain(name).info()
            assert caught.value.status == 404


def test_wrong_token(service_url: str, service_token: str | None) -> None:
    if service_token is None:
        pytest.skip("OROGENY_SERVICE_TOKEN is not set: the service runs without a token")
    for token in (None, "wrong"):
        with Client(service_url, token) as client, pytest.raises(OrogenyError) as caught:
            client.terrains()
        assert caught.value.status == 401


# The live channel


@pytest.fixture
async def live(service_url: str, service_token: str | None, terrain: Terrain) -> AsyncIterator[Live]:
    async with Live(service_url, terrain.name, service_token, author()) as channel:
        yield channel


async def settle(mirror: Any) -> np.ndarray[Any, np.dtype[np.float32]]:
    """The mirror's heights once nothing has come for a moment."""
    while True:
        try:
            await asyncio.wait_for(mirror.changed(), 1)
        except asyncio.TimeoutError:
            array: np.ndarray[Any, np.dtype[np.float32]] = mirror.snapshot().array
            return array


@pytest.mark.parametrize(("level", "form"), [(0, "r32"), (1, "r32"), (0, "r16")])
async def test_mirror_is_what_the_service_has(live: Live, terrain: Terrain, level: int, form: str) -> None:
    s = live.hello.spacing_m
    x, z = middle(live.hello)
    region = (x - 150 * s, z - 150 * s, 301 * s, 300 * s)
    mirror = await live.mirror(region, level, form, window=4)

    async def check() -> None:
        mine, theirs = await settle(mirror), (await asyncio.to_thread(terrain.read_heights, region, level)).array
        assert mine.shape == theirs.shape
        if form == "r32":
            assert mine.tobytes() == theirs.tobytes()
        else:
            assert np.abs(mine - theirs).max() < 0.05

    await asyncio.wait_for(mirror.ready(), 10)
    await check()
    await live.stroke(RAISE, [[x, z], [x + 100, z + 30]])
    await check()
    await asyncio.to_thread(terrain.stroke, LOWER, [[x, z + 50]])
    await check()
    await live.undo()
    await check()
    await asyncio.to_thread(terrain.undo)
    await check()


async def test_a_stroke_is_seen_while_it_is_drawn_and_taken_back(live: Live, terrain: Terrain) -> None:
    before = (await asyncio.to_thread(terrain.read_heights)).array
    x, z = middle(live.hello)
    mirror = await live.mirror()
    await asyncio.wait_for(mirror.ready(), 20)
    await settle(mirror)
    stroke = await live.begin_stroke(RAISE)
    await stroke.points([[x, z], [x + 30, z]])
    await stroke.points([[x + 60, z], [x + 100, z]])
    while np.array_equal(mirror.snapshot().array, before):
        await asyncio.wait_for(mirror.changed(), 10)
    await stroke.cancel()
    assert (await settle(mirror)).tobytes() == before.tobytes()
    assert (await asyncio.to_thread(terrain.read_heights)).array.tobytes() == before.tobytes()
    assert (await live.undo()).rect == Region(0, 0, 0, 0)


async def test_strokes_of_two_wait_for_each_other(
    live: Live, terrain: Terrain, service_url: str, service_token: str | None
) -> None:
    before = (await asyncio.to_thread(terrain.read_heights)).array
    x, z = middle(live.hello)

    async def slowly() -> AsyncIterator[list[float]]:
        for i in range(40):
            yield [x + i, z]
            await asyncio.sleep(0.1)

    async with Live(service_url, terrain.name, service_token, author()) as other:
        events = live.events()
        slow = asyncio.create_task(live.stroke(RAISE, slowly()))
        await asyncio.sleep(0.5)
        quick = await asyncio.wait_for(other.stroke(LOWER, [[x, z + 40]]), 6)
        change = await asyncio.wait_for(slow, 20)
        assert len(change.entries) == 2, "a stroke is cut once others have waited for two seconds"
        assert quick.revision < change.revision
        kinds = []
        while True:
            try:
                kinds.append((await asyncio.wait_for(anext(events), 0.5))["event"])
            except asyncio.TimeoutError:
                break
        assert "cut" in kinds
        assert kinds.count("operation") == 3
        await other.undo()
        await live.undo()
        await live.undo()
    assert (await asyncio.to_thread(terrain.read_heights)).array.tobytes() == before.tobytes()


async def test_all_hear_the_same_in_the_same_order(
    live: Live, terrain: Terrain, service_url: str, service_token: str | None
) -> None:
    x, z = middle(live.hello)
    async with Live(service_url, terrain.name, service_token, author()) as other:
        heard: list[list[tuple[int, str]]] = []

        async def hear(channel: Live) -> None:
            mine: list[tuple[int, str]] = []
            heard.append(mine)
            async for event in channel.events():
                if event["event"] == "operation":
                    mine.append((event["revision"], event["author"]))

        tasks = [asyncio.create_task(hear(channel)) for channel in (live, other)]
        await asyncio.sleep(0)
        for i in range(3):
            await asyncio.gather(live.stroke(RAISE, [[x, z + i]]), other.stroke(LOWER, [[x + i, z]]))
        for channel in (live, other):
            for _ in range(3):
                await channel.undo()
        await asyncio.sleep(0.5)
        for task in tasks:
            task.cancel()
    assert len(heard[0]) >= 12
    assert heard[0] == heard[1]
    assert [revision for revision, _ in heard[0]] == sorted({revision for revision, _ in heard[0]})


async def test_pointers_and_errors(live: Live, terrain: Terrain, service_url: str, service_token: str | None) -> None:
    async with Live(service_url, terrain.name, service_token, author()) as other:
        events = live.events()
        await other.cursor(10, 20, 5)
        while (event := await asyncio.wait_for(anext(events), 5))["event"] != "cursor":
            pass
        assert (event["client"], event["x"], event["z"], event["radius"]) == (other.hello.client, 10, 20, 5)
    with pytest.raises(OrogenyError) as caught:
        await live.stroke({"type": "carve"}, [[1, 1]])
    assert caught.value.code
    assert (await live.stroke(RAISE, [[100, 100]])).entries
    await live.undo()


async def test_no_such_terrain_live(service_url: str, service_token: str | None) -> None:
    with pytest.raises(OrogenyError) as caught:
        await Live(service_url, "no such terrain", service_token).open()
    assert caught.value.status == 404


# The example


def test_road(terrain: Terrain, service_url: str, service_token: str | None, tmp_path: Any, capsys: Any) -> None:
    before = terrain.read_heights()
    token = tmp_path / "token"
    token.write_text(service_token or "")
    name = author()
    options = ["--token-file", os.fspath(token)] if service_token else []
    terrain.apply([{"op": "fill", "brush": {"type": "noise", "feature_size": 600, "strength": 25, "seed": 3}}])
    hills = terrain.read_heights()
    assert road.main([service_url, terrain.name, "--author", name, "--width", "24", "--shoulder", "16", *options]) == 0
    said = capsys.readouterr().out
    assert "max grade" in said
    grade = float(said.split("max grade ")[1].split(" %")[0])
    assert grade < 10, said
    assert not np.array_equal(terrain.read_heights().array, hills.array)
    with Client(service_url, service_token, name) as client:
        client.terrain(terrain.name).undo(int(said.split("count of ")[1].split(" ")[0]))
    assert terrain.read_heights().array.tobytes() == hills.array.tobytes()
    terrain.undo()
    assert terrain.read_heights().array.tobytes() == before.array.tobytes()
