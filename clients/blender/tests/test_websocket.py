from __future__ import annotations

import asyncio
import os
import struct
import threading

import pytest


@pytest.fixture
def server():
    """An echo by the `websockets` library, which keeps to the protocol; some texts make it do more."""
    from websockets.asyncio.server import serve

    loop, ready, stop = asyncio.new_event_loop(), threading.Event(), asyncio.Event()
    heard: list[object] = []
    place: list[int] = []

    async def handler(connection):
        heard.append(dict(connection.request.headers))
        async for message in connection:
            if message == "close":
                await connection.close(1001, "good bye")
            elif message == "ping":
                heard.append(await asyncio.wait_for(await connection.ping(b"are you there"), 5))
                await connection.send("pong came")
            elif message == "parts":
                await connection.send(["a", "", "bc"])
            else:
                await connection.send(message)

    def refuse(connection, request):
        if request.path == "/refuse":
            return connection.respond(401, '{"error": {"code": "unauthorized", "message": "no"}}')
        return None

    async def run():
        async with serve(handler, "127.0.0.1", 0, process_request=refuse, max_size=None) as running:
            place.append(running.sockets[0].getsockname()[1])
            ready.set()
            await stop.wait()

    thread = threading.Thread(target=loop.run_until_complete, args=(run(),), daemon=True)
    thread.start()
    assert ready.wait(5)
    yield f"ws://127.0.0.1:{place[0]}", heard
    loop.call_soon_threadsafe(stop.set)
    thread.join(5)


def test_messages_of_all_sizes_come_back(addon, server) -> None:
    url, heard = server
    socket = addon.feed.WebSocket(f"{url}/x?y=1", {"authorization": "Bearer t"})
    for size in (0, 1, 3, 125, 126, 127, 65535, 65536, 300_001):
        text = ("aü" * size)[:size]
        socket.send_text(text)
        assert socket.receive() == text
    assert heard[0]["authorization"] == "Bearer t"
    socket.send_text("parts")
    assert socket.receive() == "abc"
    socket.send_text("ping")
    assert socket.receive() == "pong came"
    socket.close()


def test_closing(addon, server) -> None:
    lost = addon.core.errors.ConnectionLost
    socket = addon.feed.WebSocket(server[0], {})
    socket.send_text("close")
    with pytest.raises(lost, match="good bye"):
        socket.receive()
    socket = addon.feed.WebSocket(server[0], {})
    threading.Timer(0.2, socket.close).start()
    with pytest.raises(lost):
        socket.receive()
    with pytest.raises(lost):
        socket.send_text("x")
    with pytest.raises(lost):
        addon.feed.WebSocket("ws://127.0.0.1:9", {})


def test_a_refused_handshake_keeps_its_answer(addon, server) -> None:
    with pytest.raises(addon.feed.HandshakeRefused) as caught:
        addon.feed.WebSocket(f"{server[0]}/refuse", {})
    assert caught.value.answer.status == 401
    assert b"unauthorized" in caught.value.answer.body


class Bytes:
    """A socket that has received what a test says."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.sent = b""

    def recv(self, count: int) -> bytes:
        data, self.data = self.data[:count], self.data[count:]
        return data

    def sendall(self, data: bytes) -> None:
        self.sent += data


def fed(addon, data: bytes):
    socket = object.__new__(addon.feed.WebSocket)
    socket._socket, socket._buffer = Bytes(data), b""
    socket._sending, socket._is_closing = threading.Lock(), False
    return socket


@pytest.mark.parametrize(
    "data",
    [
        b"\xc1\x00",  # a reserved bit
        b"\x81\x80\0\0\0\0",  # masked
        b"\x83\x00",  # an opcode that is none
        b"\x80\x00",  # the rest of nothing
        b"\x01\x01a\x81\x01b",  # a message within another
        b"\x09\x00",  # a ping in parts
        b"\x89\x7e\x00\x7e" + bytes(126),  # a long ping
        b"\x81\x02\xff\xff",  # no UTF-8
        b"\x82\x7f" + struct.pack(">Q", 4 << 30),  # four gigabytes
        b"\x02\x7f" + struct.pack(">Q", 9 << 20) + bytes(9 << 20) + b"\x80\x7f" + struct.pack(">Q", 9 << 20),
    ],
)
def test_what_is_no_websocket_is_refused(addon, data: bytes) -> None:
    with pytest.raises(addon.core.errors.AnswerError):
        fed(addon, data).receive()


def test_any_bytes_end_in_a_message_or_an_error(addon) -> None:
    for _ in range(3000):
        socket = fed(addon, os.urandom(12))
        with pytest.raises((addon.core.errors.AnswerError, addon.core.errors.ConnectionLost)):
            while True:
                socket.receive()


def test_what_is_sent_is_masked(addon) -> None:
    socket = fed(addon, b"")
    socket.send_text("hello")
    sent = socket._socket.sent
    assert sent[:2] == b"\x81\x85"
    assert bytes(a ^ b for a, b in zip(sent[6:], (sent[2:6] * 2)[:5], strict=True)) == b"hello"
