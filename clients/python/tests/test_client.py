from __future__ import annotations

import asyncio

import httpx
import numpy as np
import pytest

from orogeny import AnswerError, AsyncClient, Client, ConnectionLost, OrogenyError, Region
from orogeny.calls import Answer, TerrainCalls

from .fake_service import TOKEN, FakeService

RAISE = {"type": "raise", "radius": 20, "strength": 5}


def test_reads_what_is_there(fake: FakeService) -> None:
    with Client(fake.url) as client:
        assert [terrain["name"] for terrain in client.terrains()] == ["fake"]
        assert client.terrain("fake").info()["width"] == 600
        assert {brush["type"] for brush in client.brushes()} >= {"raise"}
        heights = client.terrain("fake").read_heights()
        assert heights.array.dtype == np.float32
        assert np.array_equal(heights.array, fake.heights())
        part = client.terrain("fake").read_heights((101, 50, 40, 20), level=1)
        assert (part.x_m, part.z_m, part.spacing_m) == (104, 52, 4)
        assert np.array_equal(part.array, fake.heights(1)[13:18, 26:36])


def test_writes_and_takes_back(fake: FakeService) -> None:
    before = fake.heights()
    with Client(fake.url, author="ann") as client:
        terrain = client.terrain("fake")
        new = np.full((7, 9), 55, np.float64)
        change = terrain.write_heights(new, 40, 60)
        assert change.rect == Region(40, 60, 18, 14)
        assert np.array_equal(terrain.read_heights((40, 60, 18, 14)).array, new)
        stroke = terrain.stroke(RAISE, np.array([[100, 100], [120, 110]]), seed=3)
        assert stroke.revision == change.revision + 1
        assert [entry["author"] for entry in terrain.history(limit=5)] == ["ann", "ann"]
        terrain.undo(2)
        assert np.array_equal(terrain.read_heights().array, before)
        terrain.redo()
        assert np.array_equal(terrain.read_heights((40, 60, 18, 14)).array, new)


def test_undo_goes_by_author(fake: FakeService) -> None:
    with Client(fake.url, author="ann") as ann, Client(fake.url, author="ben") as ben:
        ann.terrain("fake").stroke(RAISE, [[100, 100]])
        nothing = ben.terrain("fake").undo()
        assert nothing.rect is not None
        assert nothing.rect.is_empty
        ben.terrain("fake").undo(anyone=True)


def test_errors_carry_code_message_and_limit(fake: FakeService) -> None:
    with Client(fake.url) as client:
        with pytest.raises(OrogenyError) as caught:
            client.terrain("fake").apply([{"op": "stroke", "brush": RAISE, "points": [[1, 1]], "colour": 1}])
        assert caught.value.code == "invalid_operation"
        assert "`colour`" in caught.value.message
        with pytest.raises(OrogenyError) as caught:
            client.terrain("fake").write_heights(np.zeros((1001, 1000)), 0, 0)
        assert caught.value.limit == {"samples": 1_000_000}
        with pytest.raises(OrogenyError, match="no such thing"):
            client.terrain("a/b?c").info()


def test_token(fake: FakeService) -> None:
    fake.token = TOKEN
    with Client(fake.url, TOKEN) as client:
        client.terrains()
    with Client(fake.url) as client, pytest.raises(OrogenyError, match="token"):
        client.terrains()
    with pytest.raises(ValueError, match="logs"):
        Client(f"{fake.url}/?token={TOKEN}")
    with pytest.raises(ValueError, match="logs"):
        Client("http://me:secret@127.0.0.1:1")
    with pytest.raises(ValueError, match="ASCII"):
        Client(fake.url, "a\r\nb")


def test_heights_that_are_none_are_not_sent(fake: FakeService) -> None:
    with Client(fake.url) as client:
        terrain = client.terrain("fake")
        for bad in ([[np.nan]], [[1e39]], [1, 2, 3], np.zeros((0, 3))):
            with pytest.raises(ValueError, match="heights"):
                terrain.write_heights(bad, 0, 0)
        for points in ([[1]], [[1, 2, 3, 4, 5, 6]], [[1, float("nan")]], []):
            with pytest.raises(ValueError, match="point"):
                terrain.stroke(RAISE, points)
    assert fake.entries == []


def test_answers_that_are_no_answers() -> None:
    call = TerrainCalls("t", None).read_heights(None, 0, None)
    good = {"orogeny-x": "0", "orogeny-z": "0", "orogeny-width": "2", "orogeny-depth": "1", "orogeny-spacing": "1"}
    assert call.result(Answer(200, good, bytes(8))).array.shape == (1, 2)
    for answer in (
        Answer(200, good, bytes(7)),
        Answer(200, {}, bytes(8)),
        Answer(200, good | {"orogeny-width": "-2"}, bytes(8)),
        Answer(502, {}, b"<html>"),
        Answer(500, {}, b'{"error": 5}'),
    ):
        with pytest.raises(AnswerError):
            call.result(answer)
    for body in (b"nonsense", b"[]", b"{}", b'{"revision": "x"}'):
        with pytest.raises(AnswerError):
            TerrainCalls("t", None).undo(1, False).result(Answer(200, {}, body))


def test_no_service() -> None:
    with Client("http://127.0.0.1:9") as client, pytest.raises(ConnectionLost):
        client.terrains()


async def test_async_does_the_same(fake: FakeService) -> None:
    async with AsyncClient(fake.url, author="ann") as client:
        terrain = client.terrain("fake")
        assert [each["name"] for each in await client.terrains()] == ["fake"]
        assert (await terrain.info())["depth"] == 300
        assert await client.brushes()
        before = await terrain.read_heights()
        strokes = [terrain.stroke(RAISE, [[50 * i, 100]]) for i in range(4)]
        changes = await asyncio.gather(*strokes)
        assert len({change.revision for change in changes}) == 4
        assert len(await terrain.history()) == 4
        await terrain.undo(4)
        assert np.array_equal((await terrain.read_heights()).array, before.array)
        await terrain.redo()
        await terrain.write_heights([[1, 2]], 0, 0)
        assert (await terrain.read_heights((0, 0, 4, 2))).array.tolist() == [[1, 2]]


def test_requests_are_encoded() -> None:
    call = TerrainCalls("a b/ü", "Ann & Bo").write_heights([[1.5]], 2, 4, "Base #1")
    url = httpx.URL("http://h" + call.path)
    assert url.raw_path.startswith(b"/v1/terrains/a%20b%2F%C3%BC/heights?")
    assert dict(url.params) == {
        "format": "r32",
        "x": "2.0",
        "z": "4.0",
        "width": "1",
        "depth": "1",
        "layer": "Base #1",
        "author": "Ann & Bo",
    }
