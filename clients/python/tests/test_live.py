from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator

import numpy as np
import pytest

from orogeny import AsyncClient, Client, ConnectionLost, FrameError, Live, OrogenyError
from orogeny.events import Event

from .fake_service import TOKEN, FakeService

RAISE = {"type": "raise", "radius": 20, "strength": 5}


async def one_by_one(points: list[list[float]]) -> AsyncIterator[list[float]]:
    for point in points:
        await asyncio.sleep(0)
        yield point


async def test_hello_and_strokes(fake: FakeService) -> None:
    async with Live(fake.url, "fake", author="ann") as live:
        assert (live.hello.width, live.hello.spacing_m, live.hello.author) == (600, 2, "ann")
        first = await live.stroke(RAISE, [[100, 100], [150, 120]])
        second = await live.stroke(RAISE, one_by_one([[200, 100], [250, 120, 0.5]]), layer="Base")
        assert second.revision == first.revision + 1
        kinds = [message["type"] for message in fake.received]
        assert kinds == ["begin_stroke", "points", "end_stroke", "begin_stroke", "points", "points", "end_stroke"]
        assert fake.received[3]["operation"]["layer"] == "Base"
        await live.undo()
        await live.undo()
        assert np.array_equal(fake.heights(), fake.ground)
        await live.redo()
        await live.apply([{"op": "stroke", "brush": RAISE, "points": [[1, 1]]}])
        with pytest.raises(OrogenyError) as caught:
            await live.apply([{"op": "stroke", "brush": {"type": "carve"}, "points": [[1, 1]]}])
        assert caught.value.code == "invalid_operation"


async def test_a_stroke_that_fails_is_taken_back(fake: FakeService) -> None:
    async def failing() -> AsyncIterator[list[float]]:
        yield [100, 100]
        raise RuntimeError("the tablet is gone")

    async with Live(fake.url, "fake") as live:
        with pytest.raises(RuntimeError, match="tablet"):
            await live.stroke(RAISE, failing())
        with pytest.raises(KeyError):
            async with await live.begin_stroke(RAISE) as stroke:
                await stroke.points([[5, 5]])
                raise KeyError
        async with await live.begin_stroke(RAISE) as stroke:
            await stroke.points([[5, 5]])
        assert len(fake.entries) == 1


async def test_a_stroke_that_is_cut_goes_on(fake: FakeService) -> None:
    fake.cut_after_points = 2

    async def slowly() -> AsyncIterator[list[float]]:
        for x in (10, 20, 30, 40):
            yield [x, 50]
            await asyncio.sleep(0.05)

    async with Live(fake.url, "fake") as live:
        change = await live.stroke(RAISE, slowly())
    assert len(change.entries) == 2
    drawn = [message["points"] for message in fake.received if message["type"] == "points"]
    assert drawn == [[[10, 50]], [[20, 50]], [[20, 50], [30, 50]], [[40, 50]]]


@pytest.mark.parametrize(("level", "form"), [(0, "r32"), (1, "r32"), (0, "r16")])
async def test_mirror_follows(fake: FakeService, level: int, form: str) -> None:
    async with Live(fake.url, "fake") as live, Live(fake.url, "fake", author="ben") as other:
        mirror = await live.mirror((500, 100, 600, 400), level, form, window=2)
        first = await mirror.ready()
        step = 2**level
        x0, z0 = first.x_m / 2 / step, first.z_m / 2 / step
        where = np.s_[int(z0) : int(z0) + first.array.shape[0], int(x0) : int(x0) + first.array.shape[1]]
        tolerance = 0 if form == "r32" else 0.01
        assert np.allclose(first.array, fake.heights(level)[where], rtol=0, atol=tolerance)
        for i in range(10):
            change = await other.stroke(RAISE, [[500 + 30 * i, 300]])
        await mirror.reached(change.revision)
        await asyncio.sleep(0.2)
        assert np.allclose(mirror.snapshot().array, fake.heights(level)[where], rtol=0, atol=tolerance)
        assert await mirror.changed()
        assert max(viewer.most_under_way for viewer in fake.viewers) <= 2
        await mirror.close()
        with pytest.raises(ConnectionLost):
            await mirror.changed()


async def test_subscriptions_replace_each_other(fake: FakeService) -> None:
    async with Live(fake.url, "fake") as live:
        first = await live.subscribe(window=3)
        assert (await anext(first)).level == 0
        second = await live.subscribe(level=1, window=3)
        with pytest.raises(StopAsyncIteration):
            await anext(first)
        pages = [await anext(second) for _ in range(2)]
        assert {(page.level, page.page_x) for page in pages} == {(1, 0), (1, 1)}
        for _ in range(5):
            again = await live.subscribe(window=2)
            got = [await anext(again) for _ in range(6)]
            assert len({(page.page_x, page.page_z) for page in got}) == 6
        await live.unsubscribe()
        (viewer,) = fake.viewers
        await asyncio.sleep(0.1)
        assert viewer.acknowledged == viewer.sent


async def test_a_lost_connection_ends_all_that_waits(fake: FakeService) -> None:
    async with Live(fake.url, "fake") as live:
        stroke = await live.begin_stroke(RAISE)
        mirror = await live.mirror()
        await mirror.ready()
        await mirror.changed()
        waiting = [asyncio.create_task(stroke._live._ask("{}", stroke._done)), asyncio.create_task(mirror.changed())]
        events = live.events()
        await asyncio.sleep(0.05)
        await asyncio.to_thread(fake.drop_all)
        for task in waiting:
            with pytest.raises(ConnectionLost):
                await asyncio.wait_for(task, 5)
        with pytest.raises(ConnectionLost):
            await live.stroke(RAISE, [[1, 1]])
        assert [event async for event in events] == []


async def test_a_wrong_frame_ends_the_connection(fake: FakeService) -> None:
    async with Live(fake.url, "fake") as live:
        subscription = await live.subscribe((0, 0, 10, 10))
        await anext(subscription)
        await asyncio.to_thread(fake.send_raw, b"OROGnonsense")
        with pytest.raises(FrameError):
            await asyncio.wait_for(anext(subscription), 5)
        with pytest.raises(ConnectionLost):
            await live.undo()


async def test_a_refused_subscription_ends(fake: FakeService) -> None:
    fake.most_pages = 2
    async with Live(fake.url, "fake") as live:
        with pytest.raises(ValueError, match="level 9"):
            await live.subscribe(level=9)
        mirror = await live.mirror()
        with pytest.raises(OrogenyError) as caught:
            await asyncio.wait_for(mirror.ready(), 5)
        assert caught.value.limit == 2
        assert await asyncio.wait_for((await live.mirror((0, 0, 10, 10))).ready(), 5)


async def test_events(fake: FakeService) -> None:
    async with Live(fake.url, "fake") as live, Live(fake.url, "fake", author="ben") as other:
        events = live.events()
        await other.cursor(1, 2, 3)
        await other.stroke(RAISE, [[1, 1]])
        event = await asyncio.wait_for(anext(events), 5)
        assert (event["event"], event["author"]) == ("operation", "ben")


async def test_refused(fake: FakeService) -> None:
    fake.token = TOKEN
    with pytest.raises(OrogenyError, match="token") as caught:
        await Live(fake.url, "fake").open()
    assert caught.value.status == 401
    async with AsyncClient(fake.url, TOKEN) as client, client.terrain("fake").live() as live:
        assert live.hello.terrain == "fake"
    with pytest.raises(OrogenyError, match="no such"):
        await Live(fake.url, "other", TOKEN).open()
    with pytest.raises(ConnectionLost):
        await Live("http://127.0.0.1:9", "fake").open()


def test_on_a_thread(fake: FakeService) -> None:
    heard: list[Event] = []
    with Client(fake.url, author="ann") as client, client.terrain("fake").live() as live:
        stop = live.listen(heard.append)
        mirror = live.mirror()
        before = mirror.ready(timeout_s=10)
        assert np.array_equal(before.array, fake.heights())
        stroke = live.begin_stroke(RAISE)
        stroke.points([[100, 100]])
        change = stroke.end(timeout_s=10)
        assert np.array_equal(mirror.reached(change.revision, timeout_s=10).array, fake.heights())
        live.undo(timeout_s=10)
        live.redo(timeout_s=10)
        live.begin_stroke(RAISE).cancel()
        live.cursor(1, 2, 3)
        mirror.changed(timeout_s=10)
        stop()
        with pytest.raises(TimeoutError):
            while True:
                mirror.changed(timeout_s=0.3)
        assert len(list(live.pages((0, 0, 10, 10), timeout_s=0.3))) == 1
        assert len(list(live.pages(timeout_s=0.3))) == 6
        live.stroke(RAISE, [[1, 1]], timeout_s=10)
    assert any(event["event"] == "operation" for event in heard)
    with pytest.raises(ConnectionLost):
        live.undo()
