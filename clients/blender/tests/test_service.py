"""The add-on's operators, against the running service that OROGENY_SERVICE_URL names.

Its first terrain is painted on; every test takes back what it did.
"""

from __future__ import annotations

import time

import bpy
import numpy as np
import pytest
from test_addon import shown, shows, wait_for


@pytest.fixture
def connected(addon, scene, service_url, service_token):
    arguments = {"token": service_token} if service_token else {}
    bpy.ops.orogeny.connect(url=service_url, author="Blender's tests", **arguments)
    return addon.session.current()


def read(connected, region=None, level: int = 0):
    return connected.sender.send(connected.calls.read_heights(region, level, None))


def region_of(connected):
    hello = connected.hello
    s = hello.spacing_m
    return (hello.width * s / 2 - 150 * s, hello.depth * s / 2 - 120 * s, 300 * s, 241 * s)


@pytest.mark.parametrize("level", [0, 1])
def test_a_region_follows_strokes_undo_and_others(addon, connected, level: int) -> None:
    region = region_of(connected)
    before = read(connected, region, level).array
    bpy.ops.orogeny.show_region(area=region, level=level)
    wait_for(addon, shows(addon, before), 20)
    x, z = region[0] + region[2] / 2, region[1] + region[3] / 2
    bpy.ops.orogeny.stroke(points=f"[[{x}, {z}], [{x + 60}, {z + 20}, 0.5]]", brush="raise", radius=50, strength=6)
    after = read(connected, region, level).array
    assert not np.array_equal(after, before)
    wait_for(addon, shows(addon, after), 20)
    assert shown(addon)[0, 0, 0] == pytest.approx(read(connected, region, level).x_m)
    bpy.ops.orogeny.undo()
    wait_for(addon, shows(addon, before), 20)
    bpy.ops.orogeny.redo()
    wait_for(addon, shows(addon, after), 20)
    bpy.ops.orogeny.undo()
    other = addon.core.calls.TerrainCalls(connected.calls.name, "someone else")
    connected.sender.send(
        other.apply([{"op": "stroke", "brush": {"type": "lower", "radius": 30, "strength": 4}, "points": [[x, z]]}])
    )
    wait_for(addon, shows(addon, read(connected, region, level).array), 20)
    connected.sender.send(other.undo(1, False))
    wait_for(addon, shows(addon, before), 20)


def test_a_stroke_is_seen_while_it_is_drawn(addon, connected) -> None:
    region = region_of(connected)
    bpy.ops.orogeny.show_region(area=region)
    before = read(connected, region).array
    wait_for(addon, shows(addon, before), 20)
    hand = addon.hand.Hand(connected.feed, {"type": "raise", "radius": 40, "strength": 5}, None)
    x, z = region[0] + region[2] / 2, region[1] + region[3] / 2
    for i in range(10):
        hand.draw([[x + 5 * i, z]])
        time.sleep(0.02)
    wait_for(addon, lambda: not shows(addon, before)(), 10)
    hand.cancel()
    wait_for(addon, shows(addon, before), 20)


def test_images_there_and_back(addon, connected) -> None:
    x, z, width, depth = region_of(connected)
    bpy.ops.orogeny.pull_image(area=(x, z, width, depth), name="region")
    image = bpy.data.images["region"]
    before = read(connected).array
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    pixels[0::4] += 3
    image.pixels.foreach_set(pixels)
    bpy.ops.orogeny.push_image(image="region")
    after = read(connected, (x, z, width, depth)).array
    assert np.allclose(after, addon.images.from_image(image, 0, 1), rtol=0, atol=1e-4)
    bpy.ops.orogeny.undo()
    assert np.array_equal(read(connected).array, before)


def test_what_the_service_refuses_is_told(addon, connected) -> None:
    with pytest.raises(RuntimeError, match="carve"):
        bpy.ops.orogeny.stroke(points="1,1", brush="carve")
    with pytest.raises(RuntimeError, match="no such layer"):
        bpy.ops.orogeny.stroke(points="1,1", brush="raise", layer="no such layer")
