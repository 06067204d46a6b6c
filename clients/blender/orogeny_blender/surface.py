"""The ground as a mesh of quads, one vertex a sample, whose heights are set in place."""

from __future__ import annotations

import bpy
import numpy as np

from .core.grid import Samples
from .core.heights import Heights
from .core.mirror import Mirror

MAX_SAMPLES = 4_194_304
"""More vertices than these are too many for Blender to stay quick: a coarser level shows as much."""


class TooLarge(ValueError):
    """A region has too many samples at a level."""


def check_size(samples: Samples, level: int) -> None:
    """Refuse what would take Blender minutes."""
    if samples.width < 2 or samples.depth < 2:
        raise TooLarge(f"a mesh has at least 2 x 2 samples, the region has {samples.width} x {samples.depth}")
    count = samples.width * samples.depth
    if count > MAX_SAMPLES:
        raise TooLarge(
            f"{samples.width} x {samples.depth} samples of level {level} are more than {MAX_SAMPLES:,}: "
            "take a coarser level, or a smaller region"
        )


def make_mesh(name: str, heights: Heights) -> bpy.types.Mesh:
    """A mesh of a grid; its own coordinates are metres: x east, y north (minus z of the terrain), z up."""
    mesh = bpy.data.meshes.new(name)
    depth, width = heights.array.shape
    mesh.vertices.add(depth * width)
    mesh.vertices.foreach_set("co", coordinates(heights).ravel())
    corners = _corners(width, depth)
    mesh.loops.add(corners.size)
    mesh.loops.foreach_set("vertex_index", corners.ravel())
    mesh.polygons.add(len(corners))
    mesh.polygons.foreach_set("loop_start", np.arange(0, corners.size, 4, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(corners), dtype=bool))
    mesh.update(calc_edges=True)
    return mesh


def coordinates(heights: Heights) -> np.ndarray:
    """The vertices `(depth, width, 3)`, float32."""
    depth, width = heights.array.shape
    vertices = np.empty((depth, width, 3), dtype=np.float32)
    vertices[:, :, 0] = heights.x_m + heights.spacing_m * np.arange(width)
    vertices[:, :, 1] = -(heights.z_m + heights.spacing_m * np.arange(depth))[:, np.newaxis]
    vertices[:, :, 2] = np.nan_to_num(heights.array, nan=0.0)
    return vertices


def _corners(width: int, depth: int) -> np.ndarray:
    """The vertices of each quad, from the north-west over the south: counter-clockwise from above, so normals go up."""
    first = (np.arange(depth - 1)[:, np.newaxis] * width + np.arange(width - 1)).ravel()
    return np.stack([first, first + width, first + width + 1, first + 1], axis=1).astype(np.int32)


class Surface:
    """An object that shows a mirror."""

    def __init__(self, name: str, mirror: Mirror, collection: bpy.types.Collection) -> None:
        self.mirror = mirror
        heights = mirror.snapshot()
        self.heights = heights.array
        self._vertices = coordinates(heights)
        mesh = make_mesh(name, heights)
        object_ = bpy.data.objects.new(name, mesh)
        collection.objects.link(object_)
        self.name = object_.name

    @property
    def object(self) -> bpy.types.Object | None:
        """The object, unless it was deleted, renamed away, or given another mesh."""
        object_ = bpy.data.objects.get(self.name)
        if object_ is None or object_.type != "MESH" or len(object_.data.vertices) != self.heights.size:
            return None
        return object_

    def update(self) -> bool:
        """Set the heights as the mirror has them now; `False` if the object is gone."""
        object_ = self.object
        if object_ is None:
            return False
        self.mirror.copy_into(self.heights)
        np.nan_to_num(self.heights, copy=False, nan=0.0)
        self._vertices[:, :, 2] = self.heights
        object_.data.vertices.foreach_set("co", self._vertices.ravel())
        object_.data.update()
        return True
