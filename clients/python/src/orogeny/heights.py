"""Heights of a region as a NumPy array, and the bytes that carry them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .errors import AnswerError
from .grid import Region


@dataclass(frozen=True)
class Heights:
    """Heights of a region.

    `array` is float32 of shape `(depth, width)`, indexed `[z, x]`, metres; row 0 is the northernmost. Its first
    sample lies `x_m` metres east and `z_m` metres south of the terrain's corner; samples are `spacing_m` apart.
    """

    array: npt.NDArray[np.float32]
    x_m: float
    z_m: float
    spacing_m: float

    @property
    def region(self) -> Region:
        """The metres that the samples cover, one spacing each."""
        depth, width = self.array.shape
        return Region(self.x_m, self.z_m, width * self.spacing_m, depth * self.spacing_m)

    def at(self, x_m: float, z_m: float) -> float:
        """The height at a place in metres, bilinear between samples; the edges go on beyond them."""
        depth, width = self.array.shape
        column: float = min(max((x_m - self.x_m) / self.spacing_m, 0.0), width - 1.0)
        row: float = min(max((z_m - self.z_m) / self.spacing_m, 0.0), depth - 1.0)
        left, top = min(int(column), max(width - 2, 0)), min(int(row), max(depth - 2, 0))
        right, bottom = min(left + 1, width - 1), min(top + 1, depth - 1)
        along_x, along_z = column - left, row - top
        north = (1 - along_x) * float(self.array[top, left]) + along_x * float(self.array[top, right])
        south = (1 - along_x) * float(self.array[bottom, left]) + along_x * float(self.array[bottom, right])
        height: float = (1 - along_z) * north + along_z * south
        return height


def heights_to_r32(array: npt.ArrayLike) -> tuple[bytes, int, int]:
    """Turn an array `[z, x]` of metres into raw `r32` bytes; also its width and depth in samples."""
    heights = np.asarray(array)
    if heights.ndim != 2 or heights.size == 0:
        raise ValueError(f"heights are an array [z, x], this one has shape {heights.shape}")
    with np.errstate(over="ignore"):
        heights = np.ascontiguousarray(heights, dtype="<f4")
    bad = int(np.size(heights) - np.count_nonzero(np.isfinite(heights)))
    if bad:
        raise ValueError(f"{bad} of {heights.size} heights are no finite numbers: fill them first")
    depth, width = heights.shape
    return heights.tobytes(), width, depth


def heights_from_r32(headers: Mapping[str, str], body: bytes) -> Heights:
    """Read an answer with raw `r32` heights; `headers` have lower-case names."""
    try:
        x_m, z_m = float(headers["orogeny-x"]), float(headers["orogeny-z"])
        width, depth = int(headers["orogeny-width"]), int(headers["orogeny-depth"])
        spacing_m = float(headers["orogeny-spacing"])
    except (KeyError, ValueError) as error:
        raise AnswerError(f"an answer with heights lacks a header, or has a wrong one: {error}") from error
    if width < 1 or depth < 1 or len(body) != width * depth * 4:
        raise AnswerError(f"{len(body)} bytes of heights for {width} x {depth} samples")
    array = np.frombuffer(body, "<f4").astype(np.float32).reshape(depth, width)
    return Heights(array, x_m, z_m, spacing_m)
