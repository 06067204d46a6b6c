"""A WebSocket client (RFC 6455) over a plain or TLS socket: as much of it as the live channel takes.

`receive` belongs to one thread; `send_text` and `close` may be called by any.
"""

from __future__ import annotations

import base64
import contextlib
import hashlib
import os
import socket
import ssl
import struct
import threading
from collections.abc import Mapping
from urllib.parse import urlsplit

from .core.calls import Answer
from .core.errors import AnswerError, ConnectionLost

_MAGIC = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
_CONTINUATION, _TEXT, _BINARY, _CLOSE, _PING, _PONG = 0x0, 0x1, 0x2, 0x8, 0x9, 0xA
_MAX_HEAD_BYTES = 16 * 1024
MAX_MESSAGE_BYTES = 16 * 1024 * 1024


class HandshakeRefused(Exception):
    """The service answered the handshake with an ordinary answer."""

    def __init__(self, answer: Answer) -> None:
        super().__init__(f"status {answer.status}")
        self.answer = answer


class WebSocket:
    """A connection that is open."""

    def __init__(self, url: str, headers: Mapping[str, str], timeout_s: float = 10) -> None:
        self._sending = threading.Lock()
        self._buffer = b""
        self._is_closing = False
        try:
            self._socket = _connect(url, timeout_s)
        except OSError as error:
            raise ConnectionLost(f"{url}: {error}") from error
        try:
            self._shake_hands(url, headers)
            self._socket.settimeout(None)
        except OSError as error:
            self._socket.close()
            raise ConnectionLost(f"{url}: {error}") from error
        except BaseException:
            self._socket.close()
            raise

    def send_text(self, text: str) -> None:
        """Send a text message."""
        if self._is_closing:
            raise ConnectionLost("the live channel was closed")
        self._send(_TEXT, text.encode())

    def receive(self) -> str | bytes:
        """Wait for the next message: text or bytes. Raises `ConnectionLost` once the connection is closed."""
        kind, parts, size = None, [], 0
        while True:
            is_last, opcode, payload = self._frame(MAX_MESSAGE_BYTES - size)
            if opcode == _PING:
                self._send(_PONG, payload)
            elif opcode == _CLOSE:
                self._answer_close(payload)
            elif opcode in (_TEXT, _BINARY, _CONTINUATION):
                if (opcode == _CONTINUATION) != (kind is not None):
                    raise self._broken("a message within another, or the rest of none")
                kind = opcode if kind is None else kind
                parts.append(payload)
                size += len(payload)
                if is_last:
                    return self._message(kind, b"".join(parts))
            elif opcode != _PONG:
                raise self._broken(f"opcode {opcode}")

    def close(self) -> None:
        """Close the connection; a `receive` in another thread ends."""
        self._is_closing = True
        with contextlib.suppress(ConnectionLost):
            self._send(_CLOSE, struct.pack(">H", 1000))
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()

    def _message(self, kind: int, data: bytes) -> str | bytes:
        if kind == _BINARY:
            return data
        try:
            return data.decode()
        except UnicodeDecodeError as error:
            raise self._broken("text that is no UTF-8") from error

    def _frame(self, most_bytes: int) -> tuple[bool, int, bytes]:
        first, second = self._exactly(2)
        if first & 0x70 or second & 0x80:
            raise self._broken("a frame with reserved bits, or masked by the service")
        opcode, length = first & 0x0F, second & 0x7F
        if opcode >= _CLOSE and (length > 125 or not first & 0x80):
            raise self._broken("a control frame that is long or in parts")
        if length == 126:
            (length,) = struct.unpack(">H", self._exactly(2))
        elif length == 127:
            (length,) = struct.unpack(">Q", self._exactly(8))
        if length > most_bytes:
            raise self._broken(f"a message of more than {MAX_MESSAGE_BYTES} bytes")
        return bool(first & 0x80), opcode, self._exactly(length)

    def _exactly(self, count: int) -> bytes:
        try:
            while len(self._buffer) < count:
                more = self._socket.recv(max(65536, count - len(self._buffer)))
                if not more:
                    raise ConnectionLost("the live channel was closed")
                self._buffer += more
        except OSError as error:
            raise ConnectionLost(f"the live channel is lost: {error}") from error
        data, self._buffer = self._buffer[:count], self._buffer[count:]
        return data

    def _send(self, opcode: int, payload: bytes) -> None:
        length = len(payload)
        if length < 126:
            head = struct.pack(">BB", 0x80 | opcode, 0x80 | length)
        elif length < 65536:
            head = struct.pack(">BBH", 0x80 | opcode, 0x80 | 126, length)
        else:
            head = struct.pack(">BBQ", 0x80 | opcode, 0x80 | 127, length)
        mask = os.urandom(4)
        try:
            with self._sending:
                self._socket.sendall(head + mask + _masked(payload, mask))
        except OSError as error:
            raise ConnectionLost(f"the live channel is lost: {error}") from error

    def _answer_close(self, payload: bytes) -> None:
        if not self._is_closing:
            with contextlib.suppress(ConnectionLost):
                self._send(_CLOSE, payload[:2])
        reason = payload[2:].decode("utf-8", "replace")
        raise ConnectionLost("the service closed the live channel" + (f": {reason}" if reason else ""))

    def _broken(self, what: str) -> AnswerError:
        return AnswerError(f"what came is no WebSocket: {what}")

    def _shake_hands(self, url: str, headers: Mapping[str, str]) -> None:
        parts = urlsplit(url)
        key = base64.b64encode(os.urandom(16)).decode()
        target = parts.path + (f"?{parts.query}" if parts.query else "")
        own = {"Host": parts.netloc, "Upgrade": "websocket", "Connection": "Upgrade"}
        own |= {"Sec-WebSocket-Key": key, "Sec-WebSocket-Version": "13"}
        lines = [f"GET {target} HTTP/1.1", *(f"{name}: {value}" for name, value in {**own, **headers}.items())]
        self._socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode("ascii"))
        answer = self._head()
        if answer.status != 101:
            body = self._exactly(min(int(answer.headers.get("content-length", "0")), 65536))
            raise HandshakeRefused(Answer(answer.status, answer.headers, body))
        expected = base64.b64encode(hashlib.sha1((key + _MAGIC).encode()).digest()).decode()
        if answer.headers.get("sec-websocket-accept") != expected:
            raise self._broken("the handshake's answer belongs to another question")

    def _head(self) -> Answer:
        while b"\r\n\r\n" not in self._buffer:
            more = self._socket.recv(4096)
            if not more or len(self._buffer) > _MAX_HEAD_BYTES:
                raise ConnectionLost("the handshake was not answered")
            self._buffer += more
        head, self._buffer = self._buffer.split(b"\r\n\r\n", 1)
        first, *lines = head.decode("latin-1").split("\r\n")
        try:
            status = int(first.split(" ")[1])
        except (IndexError, ValueError) as error:
            raise self._broken(f"`{first[:80]}`") from error
        fields = (line.partition(":") for line in lines)
        return Answer(status, {name.strip().lower(): value.strip() for name, _, value in fields}, b"")


def _connect(url: str, timeout_s: float) -> socket.socket:
    parts = urlsplit(url)
    is_safe = parts.scheme == "wss"
    address = (parts.hostname or "", parts.port or (443 if is_safe else 80))
    plain = socket.create_connection(address, timeout_s)
    plain.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    if not is_safe:
        return plain
    return ssl.create_default_context().wrap_socket(plain, server_hostname=parts.hostname)


def _masked(payload: bytes, mask: bytes) -> bytes:
    if not payload:
        return b""
    repeated = (mask * (len(payload) // 4 + 1))[: len(payload)]
    return (int.from_bytes(payload, "big") ^ int.from_bytes(repeated, "big")).to_bytes(len(payload), "big")
