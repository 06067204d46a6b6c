"""Height images: 32-bit floats, metres, north at the top."""

from __future__ import annotations

import bpy
import numpy as np

from .core.heights import Heights


def to_image(name: str, heights: Heights) -> bpy.types.Image:
    """An image of heights; it remembers its place in custom properties."""
    depth, width = heights.array.shape
    image = bpy.data.images.new(name, width, depth, alpha=False, float_buffer=True, is_data=True)
    pixels = np.ones((depth, width, 4), dtype=np.float32)
    # Blender's first row is the lowest, a terrain's the northernmost.
    pixels[:, :, :3] = heights.array[::-1, :, np.newaxis]
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image["orogeny_x"], image["orogeny_z"] = heights.x_m, heights.z_m
    image["orogeny_spacing"] = heights.spacing_m
    return image


def from_image(image: bpy.types.Image, low_m: float, high_m: float) -> np.ndarray:
    """The heights `[z, x]` of an image's red: 0 is `low_m`, 1 is `high_m`, and beyond as well."""
    width, depth = image.size
    if width == 0 or depth == 0:
        raise ValueError(f"the image `{image.name}` has no pixels")
    if not image.colorspace_settings.is_data:
        raise ValueError(f"the image `{image.name}` is one of colours: set its colour space to Non-Color")
    pixels = np.empty(width * depth * image.channels, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    red = pixels.reshape(depth, width, image.channels)[::-1, :, 0]
    return low_m + red.astype(np.float64) * (high_m - low_m)


def save(image: bpy.types.Image, path: str) -> None:
    """Write an image as an OpenEXR file of 32-bit floats."""
    image.file_format = "OPEN_EXR"
    image.filepath_raw = path
    image.save()
