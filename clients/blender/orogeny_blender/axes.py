"""The one place that knows how a terrain lies in Blender.

A terrain has x to the east, z to the south and heights in metres. In Blender x is east, y is north and z is up, and
one unit is a metre: a place (x, z) of height h lies at (x, -z, h).
"""

from __future__ import annotations

from typing import NamedTuple


class Place(NamedTuple):
    """A place on a terrain, metres from its north-west corner."""

    x_m: float
    z_m: float


def to_blender(x_m: float, z_m: float, height_m: float) -> tuple[float, float, float]:
    """From a terrain to an object's own coordinates."""
    return x_m, -z_m, height_m


def to_terrain(x: float, y: float) -> Place:
    """From an object's own coordinates to a terrain."""
    return Place(x, -y)
