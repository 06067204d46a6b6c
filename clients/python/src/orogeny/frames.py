"""Page frames, the binary messages of the live channel: a header of 40 bytes, then samples, all little-endian."""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .errors import FrameError

MAGIC = b"OROG"
VERSION = 1
HEADER_BYTES = 40
PAGE_SIZE = 256
"""Samples along each side of a page."""

MAX_LEVEL = 31
R32 = 0
R16 = 1
FORMATS = {"r32": R32, "r16": R16}

_HEADER = struct.Struct("<4sHHBBHHHIIQII")
_SCALE = struct.Struct("<ff")


@dataclass(frozen=True)
class PageFrame:
    """One page of heights as of a revision.

    `heights` is a float32 array of shape `(depth, width)`, metres, its first row in the north, its first column in
    the west. Pages at the far edges of the terrain are smaller than 256 x 256.
    """

    level: int
    page_x: int
    page_z: int
    revision: int
    heights: npt.NDArray[np.float32]
    field: int = 0

    @property
    def width(self) -> int:
        """Samples along x."""
        return int(self.heights.shape[1])

    @property
    def depth(self) -> int:
        """Samples along z."""
        return int(self.heights.shape[0])

    @property
    def first_x(self) -> int:
        """Column, in samples of the level, of the page's first sample."""
        return self.page_x * PAGE_SIZE

    @property
    def first_z(self) -> int:
        """Row, in samples of the level, of the page's first sample."""
        return self.page_z * PAGE_SIZE


def decode(data: bytes | bytearray | memoryview) -> PageFrame:
    """Read a page frame.

    Everything is checked before anything is allocated: a `FrameError` names the field that is wrong. The array of
    an `r32` frame is a read-only view of `data` on little-endian machines.
    """
    if len(data) < HEADER_BYTES:
        raise FrameError("length", f"{len(data)} bytes, a header has {HEADER_BYTES}")
    (magic, version, field, level, form, width, depth, zero_16, page_x, page_z, revision, payload, zero_32) = (
        _HEADER.unpack_from(data)
    )
    if magic != MAGIC:
        raise FrameError("magic", f"{bytes(magic)!r} instead of {MAGIC!r}")
    if version != VERSION:
        raise FrameError("version", f"{version}, this client reads {VERSION}")
    if field != 0:
        raise FrameError("field", f"{field} is unknown, 0 is the heights")
    if level > MAX_LEVEL:
        raise FrameError("level", f"{level}, the last is {MAX_LEVEL}")
    if form not in (R32, R16):
        raise FrameError("format", f"{form} is unknown")
    for what, samples in (("width", width), ("depth", depth)):
        if not 1 <= samples <= PAGE_SIZE:
            raise FrameError(what, f"{samples} samples, a page has 1 to {PAGE_SIZE}")
    if zero_16 != 0 or zero_32 != 0:
        raise FrameError("reserved", "bytes that are to be 0 are not")
    expected = _payload_bytes(form, width, depth)
    if payload != expected:
        raise FrameError("payload", f"{payload} bytes said, {width} x {depth} samples take {expected}")
    if len(data) != HEADER_BYTES + payload:
        raise FrameError("length", f"{len(data)} bytes, header and samples take {HEADER_BYTES + payload}")
    heights = _read_r32(data) if form == R32 else _read_r16(data)
    return PageFrame(level, page_x, page_z, revision, heights.reshape(depth, width), field)


def encode(frame: PageFrame, form: str = "r32") -> bytes:
    """Write a page frame, as the service does; of use to tests and relays.

    `form` is `r32` or `r16`; the latter spreads the heights of the page over the 65,536 steps.
    """
    if form not in FORMATS:
        raise FrameError("format", f"`{form}` is unknown")
    if frame.heights.ndim != 2 or not (1 <= frame.width <= PAGE_SIZE and 1 <= frame.depth <= PAGE_SIZE):
        raise FrameError("heights", f"shape {frame.heights.shape}, a page has 1 to {PAGE_SIZE} samples a side")
    samples = _write_r32(frame.heights) if form == "r32" else _write_r16(frame.heights)
    try:
        header = _HEADER.pack(
            MAGIC,
            VERSION,
            frame.field,
            frame.level,
            FORMATS[form],
            frame.width,
            frame.depth,
            0,
            frame.page_x,
            frame.page_z,
            frame.revision,
            len(samples),
            0,
        )
    except struct.error as error:
        raise FrameError("header", str(error)) from error
    return header + samples


def _payload_bytes(form: int, width: int, depth: int) -> int:
    return width * depth * 4 if form == R32 else _SCALE.size + width * depth * 2


def _read_r32(data: bytes | bytearray | memoryview) -> npt.NDArray[np.float32]:
    heights = np.frombuffer(data, "<f4", offset=HEADER_BYTES).astype(np.float32, copy=False)
    if not np.isfinite(heights).all():
        raise FrameError("samples", "a height is not a finite number")
    return heights


def _read_r16(data: bytes | bytearray | memoryview) -> npt.NDArray[np.float32]:
    first_m, step_m = _SCALE.unpack_from(data, HEADER_BYTES)
    if not (np.isfinite(first_m) and np.isfinite(step_m)):
        raise FrameError("scale", "the first height or the step is not a finite number")
    samples = np.frombuffer(data, "<u2", offset=HEADER_BYTES + _SCALE.size)
    heights: npt.NDArray[np.float64] = first_m + step_m * samples.astype(np.float64)
    return heights.astype(np.float32)


def _write_r32(heights: npt.NDArray[np.float32]) -> bytes:
    return heights.astype("<f4", copy=False).tobytes()


def _write_r16(heights: npt.NDArray[np.float32]) -> bytes:
    first_m = np.float32(heights.min())
    step_m = np.float32((np.float64(heights.max()) - np.float64(first_m)) / 65535)
    if step_m > 0:
        steps = np.rint((heights.astype(np.float64) - np.float64(first_m)) / np.float64(step_m))
    else:
        steps = np.zeros(heights.shape)
    samples: npt.NDArray[np.uint16] = np.clip(steps, 0, 65535).astype("<u2")
    return _SCALE.pack(first_m, step_m) + samples.tobytes()
