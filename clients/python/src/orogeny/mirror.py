"""A region of a terrain, put together from page frames."""

from __future__ import annotations

import threading

import numpy as np
import numpy.typing as npt

from .errors import FrameError
from .frames import PAGE_SIZE, PageFrame
from .grid import Grid, RegionLike, Samples
from .heights import Heights


class Mirror:
    """The heights of a region at a level, kept up to date by `apply`.

    It begins as NaN; `is_complete` tells whether every page has come. Safe to be used by several threads.
    """

    def __init__(self, grid: Grid, region: RegionLike | None = None, level: int = 0) -> None:
        self.level = level
        self.spacing_m = grid.spacing_at(level)
        self.samples = grid.samples_in(region, level)
        if self.samples.is_empty:
            raise ValueError("no sample of the terrain lies in the region")
        self.revision = 0
        self._bounds = grid.samples_at(level)
        self._array = np.full((self.samples.depth, self.samples.width), np.nan, dtype=np.float32)
        self._missing = set(self.samples.pages())
        self._lock = threading.Lock()

    @property
    def is_complete(self) -> bool:
        """Whether every page of the region has come at least once."""
        return not self._missing

    @property
    def shape(self) -> tuple[int, int]:
        """`(depth, width)` in samples."""
        return self.samples.depth, self.samples.width

    def concerns(self, frame: PageFrame) -> bool:
        """Whether a frame is of this level and has samples of this region."""
        return frame.level == self.level and not self._part(frame).is_empty

    def apply(self, frame: PageFrame) -> Samples | None:
        """Take a frame; returns the rows and columns of the array that it holds, `None` if it concerns it not."""
        if frame.level != self.level:
            return None
        page = self._page(frame)
        if frame.width != page.width or frame.depth != page.depth:
            raise FrameError(
                "size",
                f"page {frame.page_x}, {frame.page_z} of level {frame.level} has {frame.width} x {frame.depth} "
                f"samples, the terrain has {page.width} x {page.depth} there",
            )
        part = self._part(frame)
        if part.is_empty:
            return None
        inside = frame.heights[
            part.z0 - frame.first_z : part.z1 - frame.first_z, part.x0 - frame.first_x : part.x1 - frame.first_x
        ]
        x0, z0 = part.x0 - self.samples.x0, part.z0 - self.samples.z0
        here = Samples(x0, z0, x0 + part.width, z0 + part.depth)
        with self._lock:
            self._array[here.z0 : here.z1, here.x0 : here.x1] = inside
            self._missing.discard((frame.page_x, frame.page_z))
            self.revision = max(self.revision, frame.revision)
        return here

    def snapshot(self) -> Heights:
        """A copy of the heights as they are now; NaN where no page has come yet."""
        with self._lock:
            array = self._array.copy()
        return Heights(array, self.samples.x0 * self.spacing_m, self.samples.z0 * self.spacing_m, self.spacing_m)

    def copy_into(self, out: npt.NDArray[np.float32]) -> None:
        """Copy the heights into an array of the same shape, without making another."""
        with self._lock:
            np.copyto(out, self._array)

    def _page(self, frame: PageFrame) -> Samples:
        """The samples of the terrain that a frame's page holds."""
        square = Samples(frame.first_x, frame.first_z, frame.first_x + PAGE_SIZE, frame.first_z + PAGE_SIZE)
        return square.intersection(self._bounds)

    def _part(self, frame: PageFrame) -> Samples:
        return self._page(frame).intersection(self.samples)
