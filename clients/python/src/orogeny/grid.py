"""Places: regions in metres, samples and pages of a level."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from .frames import PAGE_SIZE

_SLACK = 1e-6
"""Share of a sample by which a place may miss one and still be on it: sums of metres are not exact."""

_FAR = 1e12
"""Samples beyond which a place is as good as nowhere."""


@dataclass(frozen=True)
class Region:
    """A rectangle in metres from the north-west corner of the terrain: x to the east, z to the south.

    The far edges, at `x + width` and `z + depth`, are outside.
    """

    x: float
    z: float
    width: float
    depth: float

    def __post_init__(self) -> None:
        if not all(math.isfinite(value) for value in (self.x, self.z, self.width, self.depth)):
            raise ValueError(f"a region has finite numbers, not {self}")
        if self.width < 0 or self.depth < 0:
            raise ValueError(f"a region has no width or depth below 0, this one {self.width} x {self.depth}")

    @property
    def is_empty(self) -> bool:
        """Whether nothing lies in it."""
        return self.width == 0 or self.depth == 0

    @classmethod
    def of(cls, region: RegionLike) -> Region:
        """Take a region, or `(x, z, width, depth)`, to ask for: it must hold something."""
        if not isinstance(region, Region):
            x, z, width, depth = (float(value) for value in region)
            region = cls(x, z, width, depth)
        if region.is_empty:
            raise ValueError(f"a region has a width and a depth above 0, not {region.width} x {region.depth}")
        return region

    def as_list(self) -> list[float]:
        """`[x, z, width, depth]`, as the service writes it."""
        return [self.x, self.z, self.width, self.depth]

    def union(self, other: Region) -> Region:
        """The smallest region that covers both."""
        if self.is_empty or other.is_empty:
            return other if self.is_empty else self
        x, z = min(self.x, other.x), min(self.z, other.z)
        right = max(self.x + self.width, other.x + other.width)
        bottom = max(self.z + self.depth, other.z + other.depth)
        return Region(x, z, right - x, bottom - z)


RegionLike = Region | Sequence[float]
"""A `Region`, or `(x, z, width, depth)` in metres."""


@dataclass(frozen=True)
class Samples:
    """A rectangle of samples of one level: columns `x0` to `x1` and rows `z0` to `z1`, the latter outside."""

    x0: int
    z0: int
    x1: int
    z1: int

    @property
    def width(self) -> int:
        """Samples along x."""
        return max(0, self.x1 - self.x0)

    @property
    def depth(self) -> int:
        """Samples along z."""
        return max(0, self.z1 - self.z0)

    @property
    def is_empty(self) -> bool:
        """Whether there are none."""
        return self.width == 0 or self.depth == 0

    def intersection(self, other: Samples) -> Samples:
        """What lies in both."""
        return Samples(max(self.x0, other.x0), max(self.z0, other.z0), min(self.x1, other.x1), min(self.z1, other.z1))

    def pages(self) -> Iterator[tuple[int, int]]:
        """The pages `(page_x, page_z)` that hold any of them, row by row."""
        if self.is_empty:
            return
        for page_z in range(self.z0 // PAGE_SIZE, (self.z1 - 1) // PAGE_SIZE + 1):
            for page_x in range(self.x0 // PAGE_SIZE, (self.x1 - 1) // PAGE_SIZE + 1):
                yield page_x, page_z


@dataclass(frozen=True)
class Grid:
    """The samples of a terrain: `width` x `depth` at full resolution, `spacing_m` metres apart."""

    width: int
    depth: int
    spacing_m: float

    def spacing_at(self, level: int) -> float:
        """Metres between samples of a level."""
        return self.spacing_m * float(2**level)

    def samples_at(self, level: int) -> Samples:
        """All samples of a level: half as many each way as of the level before, rounded up."""
        return Samples(0, 0, ((self.width - 1) >> level) + 1, ((self.depth - 1) >> level) + 1)

    def samples_in(self, region: RegionLike | None, level: int) -> Samples:
        """The samples of a level that lie in a region; `None` is all of the terrain."""
        everything = self.samples_at(level)
        if region is None:
            return everything
        region = Region.of(region)

        def first_at(place_m: float) -> int:
            at_full = math.ceil(min(max(place_m / self.spacing_m, -_FAR), _FAR) - _SLACK)
            return -(-at_full >> level)

        inside = Samples(
            first_at(region.x),
            first_at(region.z),
            first_at(region.x + region.width),
            first_at(region.z + region.depth),
        )
        return inside.intersection(everything)
