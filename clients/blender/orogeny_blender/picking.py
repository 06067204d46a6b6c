"""Where a ray meets the ground: worked out on the heights themselves, which needs no tree over the mesh."""

from __future__ import annotations

import numpy as np

from .axes import Place, to_terrain


def pick(
    heights: np.ndarray, x_m: float, z_m: float, spacing_m: float, origin: np.ndarray, direction: np.ndarray
) -> Place | None:
    """The first place where a ray, in the object's own coordinates, meets the ground.

    `heights` are `[z, x]`, metres, their first sample at `x_m`, `z_m`.
    """
    depth, width = heights.shape
    origin, direction = np.asarray(origin, dtype=np.float64), np.asarray(direction, dtype=np.float64)
    # From here on x and y are columns and rows.
    start = np.array([(origin[0] - x_m) / spacing_m, (-origin[1] - z_m) / spacing_m, origin[2]])
    step = np.array([direction[0] / spacing_m, -direction[1] / spacing_m, direction[2]])
    low, high = float(heights.min()), float(heights.max())
    near, far = _inside(start, step, np.array([0, 0, low - 1]), np.array([width - 1, depth - 1, high + 1]))
    if near > far:
        return None
    samples = np.hypot(step[0], step[1]) * (far - near)
    along = np.linspace(near, far, int(min(max(2 * samples, 2), 100_000)) + 1)
    above = _above(heights, start, step, along)
    crossings = np.nonzero((above[:-1] >= 0) & (above[1:] < 0))[0]
    if not len(crossings):
        return None
    before, after = along[crossings[0]], along[crossings[0] + 1]
    for _ in range(24):
        middle = (before + after) / 2
        if _above(heights, start, step, np.array([middle]))[0] >= 0:
            before = middle
        else:
            after = middle
    meets = origin + direction * before
    return to_terrain(float(meets[0]), float(meets[1]))


def _inside(start: np.ndarray, step: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[float, float]:
    """From where to where along the ray it is within a box, not behind its beginning."""
    near, far = 0.0, np.inf
    for axis in range(3):
        if abs(step[axis]) < 1e-12:
            if not low[axis] <= start[axis] <= high[axis]:
                return 1.0, 0.0
            continue
        one, other = (low[axis] - start[axis]) / step[axis], (high[axis] - start[axis]) / step[axis]
        near, far = max(near, min(one, other)), min(far, max(one, other))
    return near, far


def _above(heights: np.ndarray, start: np.ndarray, step: np.ndarray, along: np.ndarray) -> np.ndarray:
    """How high the ray is above the ground, which is bilinear between samples."""
    depth, width = heights.shape
    column = np.clip(start[0] + along * step[0], 0, width - 1)
    row = np.clip(start[1] + along * step[1], 0, depth - 1)
    left, top = np.minimum(column.astype(int), width - 2), np.minimum(row.astype(int), depth - 2)
    right, down = column - left, row - top
    north = heights[top, left] * (1 - right) + heights[top, left + 1] * right
    south = heights[top + 1, left] * (1 - right) + heights[top + 1, left + 1] * right
    return start[2] + along * step[2] - (north * (1 - down) + south * down)
