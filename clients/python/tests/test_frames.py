from __future__ import annotations

import contextlib
import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from orogeny import FrameError, PageFrame
from orogeny.frames import HEADER_BYTES, decode, encode

finite = st.floats(-1e6, 1e6, width=32)
shapes = hnp.array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=256)
pages = st.builds(
    PageFrame,
    level=st.integers(0, 31),
    page_x=st.integers(0, 2**32 - 1),
    page_z=st.integers(0, 2**32 - 1),
    revision=st.integers(0, 2**64 - 1),
    heights=shapes.flatmap(lambda shape: hnp.arrays(np.float32, shape, elements=finite, fill=finite)),
)


def sample() -> bytes:
    heights = np.arange(6, dtype=np.float32).reshape(2, 3)
    return encode(PageFrame(level=1, page_x=4, page_z=5, revision=9, heights=heights))


def test_header_is_as_documented() -> None:
    data = sample()
    assert data[:4] == b"OROG"
    assert struct.unpack_from("<HHBBHHHIIQII", data, 4) == (1, 0, 1, 0, 3, 2, 0, 4, 5, 9, 24, 0)
    assert len(data) == HEADER_BYTES + 24
    assert struct.unpack_from("<6f", data, 40) == (0, 1, 2, 3, 4, 5)


def test_r16_is_as_documented() -> None:
    header = struct.pack("<4sHHBBHHHIIQII", b"OROG", 1, 0, 0, 1, 2, 1, 0, 0, 0, 1, 12, 0)
    frame = decode(header + struct.pack("<ffHH", 100.0, 0.5, 0, 65535))
    assert frame.heights.tolist() == [[100.0, 100.0 + 0.5 * 65535]]


@given(pages)
def test_r32_round_trip_is_exact(page: PageFrame) -> None:
    again = decode(encode(page))
    assert (again.level, again.page_x, again.page_z, again.revision) == (
        page.level,
        page.page_x,
        page.page_z,
        page.revision,
    )
    assert again.heights.tobytes() == page.heights.tobytes()
    assert again.heights.shape == page.heights.shape


@given(pages)
def test_r16_round_trip_is_within_a_step(page: PageFrame) -> None:
    again = decode(encode(page, "r16"))
    span = float(page.heights.max()) - float(page.heights.min())
    error = np.abs(again.heights.astype(np.float64) - page.heights.astype(np.float64)).max()
    assert error <= span / 65535 * 0.51 + float(np.spacing(np.float32(np.abs(page.heights).max() + span)))


@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    with contextlib.suppress(FrameError):
        decode(data)


@given(st.integers(0, HEADER_BYTES - 1), st.integers(0, 255))
def test_any_header_byte_is_read_or_refused(place: int, value: int) -> None:
    data = bytearray(sample())
    data[place] = value
    try:
        frame = decode(data)
    except FrameError:
        return
    assert frame.heights.shape == (2, 3)


@given(st.integers(0, 63))
def test_a_cut_frame_is_refused(length: int) -> None:
    with pytest.raises(FrameError):
        decode(sample()[:length])


@pytest.mark.parametrize(
    ("what", "place", "form", "value"),
    [
        ("magic", 0, "<4s", b"OROX"),
        ("version", 4, "<H", 2),
        ("field", 6, "<H", 1),
        ("level", 8, "<B", 32),
        ("format", 9, "<B", 2),
        ("width", 10, "<H", 0),
        ("width", 10, "<H", 257),
        ("depth", 12, "<H", 0),
        ("depth", 12, "<H", 65535),
        ("reserved", 14, "<H", 1),
        ("payload", 32, "<I", 2**32 - 1),
        ("reserved", 36, "<I", 1),
        ("samples", 40, "<f", float("nan")),
    ],
)
def test_what_is_wrong_is_named(what: str, place: int, form: str, value: object) -> None:
    data = bytearray(sample())
    struct.pack_into(form, data, place, value)
    with pytest.raises(FrameError) as caught:
        decode(data)
    assert caught.value.what == what


def test_more_bytes_than_said_are_refused() -> None:
    with pytest.raises(FrameError, match="length"):
        decode(sample() + b"\0")
