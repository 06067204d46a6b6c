"""The add-on's operators, against a stand-in for the service."""

from __future__ import annotations

import time
from types import SimpleNamespace

import bpy
import numpy as np
import pytest


def wait_for(addon, holds, within_s: float = 5.0) -> None:
    end = time.monotonic() + within_s
    while time.monotonic() < end:
        addon.session.drain()
        if holds():
            return
        time.sleep(0.02)
    raise AssertionError("it did not come about")


def shown(addon) -> np.ndarray:
    """The vertices of the object that is shown, `(depth, width, 3)`."""
    surface = addon.session.current().surface
    vertices = np.empty(surface.heights.size * 3, np.float32)
    surface.object.data.vertices.foreach_get("co", vertices)
    return vertices.reshape(*surface.heights.shape, 3)


def shows(addon, heights: np.ndarray):
    return lambda: np.array_equal(shown(addon)[:, :, 2], heights)


@pytest.fixture
def connected(addon, scene, fake):
    assert bpy.ops.orogeny.connect(url=fake.url, terrain="fake", author="ann") == {"FINISHED"}
    return fake


def test_a_region_is_shown_and_followed(addon, scene, connected) -> None:
    bpy.ops.orogeny.show_region(area=(100, 40, 400, 300))
    wait_for(addon, shows(addon, connected.heights()[20:170, 50:250]))
    vertices = shown(addon)
    assert vertices[0, 0, :2].tolist() == [100, -40]
    assert vertices[-1, -1, :2].tolist() == [100 + 199 * 2, -40 - 149 * 2]
    mesh = addon.session.current().surface.object.data
    assert len(mesh.polygons) == 199 * 149
    assert not mesh.validate()
    assert mesh.polygons[0].normal.z > 0
    pointer = mesh.as_pointer()
    bpy.ops.orogeny.stroke(points="[[200, 100], [240, 130, 0.5]]", brush="raise", radius=30, strength=5)
    assert connected.received[-1]["type"] in ("end_stroke", "ack")
    wait_for(addon, shows(addon, connected.heights()[20:170, 50:250]))
    assert addon.session.current().surface.object.data.as_pointer() == pointer
    bpy.ops.orogeny.undo()
    wait_for(addon, shows(addon, connected.ground[20:170, 50:250]))
    bpy.ops.orogeny.redo()
    wait_for(addon, shows(addon, connected.heights()[20:170, 50:250]))
    assert not np.array_equal(connected.heights(), connected.ground)


def test_a_coarser_level_and_all_of_it(addon, scene, connected) -> None:
    bpy.ops.orogeny.show_region(level=1)
    wait_for(addon, shows(addon, connected.heights(1)))
    assert shown(addon)[1, 1, :2].tolist() == [4, -4]


def test_a_mesh_that_does_not_follow(addon, scene, connected) -> None:
    bpy.ops.orogeny.show_region(area=(0, 0, 40, 20), follow=False)
    mesh = bpy.context.view_layer.objects.active.data
    assert len(mesh.vertices) == 200
    assert mesh.vertices[1].co[:] == pytest.approx((2, 0, connected.ground[0, 1]))


def test_what_is_wrong_is_told(addon, scene, fake) -> None:
    def refused(call, *words, **arguments):
        with pytest.raises(RuntimeError) as caught:
            call(**arguments)
        assert all(word in str(caught.value) for word in words), str(caught.value)

    refused(bpy.ops.orogeny.stroke, "not connected", points="1,1")
    refused(bpy.ops.orogeny.connect, "127.0.0.1", url="http://127.0.0.1:9")
    refused(bpy.ops.orogeny.connect, "no address", url="nonsense")
    refused(bpy.ops.orogeny.connect, "no such thing", url=fake.url, terrain="other")
    bpy.ops.orogeny.connect(url=fake.url)
    refused(bpy.ops.orogeny.show_region, "outside", area=(9000, 0, 10, 10))
    refused(bpy.ops.orogeny.show_region, "2 x 2", area=(0, 0, 1, 1))
    refused(bpy.ops.orogeny.show_region, "level 9", level=9)
    refused(bpy.ops.orogeny.stroke, "point 0", points="[[1]]")
    refused(bpy.ops.orogeny.stroke, "points", points="hello")
    refused(bpy.ops.orogeny.stroke, "no JSON", points="1,1", brush="{")
    refused(bpy.ops.orogeny.stroke, "carve", points="1,1", brush="carve")
    refused(bpy.ops.orogeny.push_image, "no image", image="none")


def test_a_token(addon, scene, fake, tmp_path) -> None:
    fake.token = "secret-token-7"
    with pytest.raises(RuntimeError, match="token"):
        bpy.ops.orogeny.connect(url=fake.url)
    bpy.ops.orogeny.connect(url=fake.url, token=fake.token)
    bpy.ops.orogeny.show_region(area=(0, 0, 40, 40))
    path = tmp_path / "saved.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    assert fake.url.encode() in path.read_bytes()
    assert fake.token.encode() not in path.read_bytes()


def test_images_there_and_back(addon, scene, connected, tmp_path) -> None:
    path = tmp_path / "heights.exr"
    bpy.ops.orogeny.pull_image(area=(100, 40, 60, 40), name="part", filepath=str(path))
    image = bpy.data.images["part"]
    assert tuple(image.size) == (30, 20)
    expected = connected.ground[20:40, 50:80]
    again = bpy.data.images.load(str(path))
    again.colorspace_settings.name = "Non-Color"
    for each in (image, again):
        assert np.array_equal(addon.images.from_image(each, 0, 1), expected.astype(np.float64))
    bpy.ops.orogeny.push_image(image="part", x=200, z=100)
    assert np.array_equal(connected.heights()[50:70, 100:130], expected)
    bpy.ops.orogeny.push_image(image=again.name, x=0, z=0, low=10, high=12)
    assert np.array_equal(connected.heights()[:20, :30], (10 + expected * 2).astype(np.float32))
    coloured = bpy.data.images.new("coloured", 4, 4)
    with pytest.raises(RuntimeError, match="Non-Color"):
        bpy.ops.orogeny.push_image(image=coloured.name)
    bpy.ops.orogeny.pull_image(level=1, name="coarse")
    with pytest.raises(RuntimeError, match="coarser"):
        bpy.ops.orogeny.push_image(image="coarse")


def test_it_lives_through_deletion_undo_and_new_files(addon, scene, connected) -> None:
    bpy.ops.orogeny.show_region(area=(0, 0, 100, 100))
    wait_for(addon, shows(addon, connected.ground[:50, :50]))
    surface = addon.session.current().surface
    surface.object.data.vertices[0].co.z = 1234
    addon.session._on_undo()
    wait_for(addon, shows(addon, connected.ground[:50, :50]))
    bpy.data.objects.remove(surface.object)
    addon.session._on_undo()
    wait_for(addon, lambda: addon.session.current().surface is None)
    bpy.ops.orogeny.show_region(area=(0, 0, 100, 100))
    bpy.ops.wm.read_homefile(use_empty=True)
    assert addon.session.current().surface is None
    bpy.ops.orogeny.stroke(points="10,10", brush="raise", strength=2)
    addon.session.drain()


def test_a_lost_connection_comes_back(addon, scene, connected) -> None:
    bpy.ops.orogeny.show_region(area=(0, 0, 100, 100))
    wait_for(addon, shows(addon, connected.ground[:50, :50]))
    connected.drop_all()
    wait_for(addon, lambda: len(connected.viewers) == 1)
    wait_for(addon, lambda: addon.session.current().feed.error is None)
    bpy.ops.orogeny.stroke(points="20,20", brush="raise", radius=10, strength=3)
    wait_for(addon, shows(addon, connected.heights()[:50, :50]))


def event(kind: str, value: str = "NOTHING", **more) -> SimpleNamespace:
    rest = {"alt": False, "ctrl": False, "shift": False, "is_tablet": False, "pressure": 1.0, "at": (0, 0)}
    return SimpleNamespace(type=kind, value=value, **{**rest, **more})


@pytest.fixture
def painter(addon, scene, connected):
    here = scene.orogeny
    here.brush, here.radius, here.strength_m = "raise", 20, 4
    return addon.modal.Painter(addon.session.current().feed, lambda e: e.at and addon.axes.Place(*e.at), here)


def test_a_mouse_paints(addon, connected, painter) -> None:
    handle = painter.handle
    assert handle(event("MOUSEMOVE", at=(50, 50))) == "PASS_THROUGH"
    assert handle(event("MIDDLEMOUSE", "PRESS")) == "PASS_THROUGH"
    assert handle(event("LEFTMOUSE", "PRESS", at=None)) == "PASS_THROUGH"
    assert handle(event("LEFTMOUSE", "PRESS", alt=True, at=(50, 50))) == "PASS_THROUGH"
    assert handle(event("LEFTMOUSE", "PRESS", at=(50, 60), is_tablet=True, pressure=0.5)) == "RUNNING_MODAL"
    assert handle(event("MOUSEMOVE", at=(70, 60))) == "RUNNING_MODAL"
    assert handle(event("MOUSEMOVE", at=None)) == "RUNNING_MODAL"
    assert handle(event("LEFTMOUSE", "RELEASE", at=(70, 60))) == "RUNNING_MODAL"
    wait_for(addon, lambda: len(connected.entries) == 1)
    kinds = [message["type"] for message in connected.received]
    assert kinds == ["cursor", "begin_stroke", "points", "points", "end_stroke"]
    assert [p[:3] for m in connected.received[2:4] for p in m["points"]] == [[50, 60, 0.5], [70, 60, 1]]
    assert connected.received[1]["operation"]["brush"] == {"type": "raise", "radius": 20, "strength": 4}


def test_ctrl_shift_escape_and_brackets(addon, connected, painter, scene) -> None:
    painter.handle(event("LEFTMOUSE", "PRESS", ctrl=True, at=(50, 50)))
    assert painter.handle(event("ESC", "PRESS")) == "RUNNING_MODAL"
    painter.handle(event("LEFTMOUSE", "PRESS", shift=True, at=(50, 50)))
    painter.stop()
    wait_for(addon, lambda: len(connected.received) == 6)
    kinds = [m["operation"]["brush"]["type"] for m in connected.received if m["type"] == "begin_stroke"]
    assert kinds == ["lower", "smooth"]
    assert [m["type"] for m in connected.received].count("cancel_stroke") == 2
    assert connected.entries == []
    painter.handle(event("RIGHT_BRACKET", "PRESS"))
    assert scene.orogeny.radius == pytest.approx(23)
    assert painter.handle(event("ESC", "PRESS")) == "FINISHED"


def test_a_pointer_finds_the_place(addon, scene, connected) -> None:
    from mathutils import Matrix

    bpy.ops.orogeny.show_region(area=(100, 40, 400, 300))
    wait_for(addon, shows(addon, connected.ground[20:170, 50:250]))
    # Straight down onto x 200 to 300 and z 100 to 200, without perspective: 100 pixels a side, one a metre.
    window = SimpleNamespace(x=10, y=20, width=100, height=100)
    view_matrix = Matrix.Translation((-250, 150, -1000))
    to_window = Matrix.Diagonal((1 / 50, 1 / 50, -1 / 2000, 1))
    view = SimpleNamespace(view_matrix=view_matrix, perspective_matrix=to_window @ view_matrix, is_perspective=False)
    view.view_perspective = "ORTHO"
    pointer = addon.modal.Pointer(window, view)

    def where(x: int, y: int):
        return pointer.where(SimpleNamespace(mouse_x=10 + x, mouse_y=20 + y))

    assert where(0, 0) == pytest.approx((200, 200), abs=0.01)
    assert where(75, 90) == pytest.approx((275, 110), abs=0.01)
    assert where(100, 0) is None
    assert where(0, -1) is None
    addon.session.current().surface.object.location.x = 50
    bpy.context.view_layer.update()
    assert where(75, 90) == pytest.approx((225, 110), abs=0.01)


def test_painting_needs_a_viewport(addon, scene, fake) -> None:
    assert not bpy.ops.orogeny.brush_modal.poll()
    bpy.ops.orogeny.connect(url=fake.url)
    bpy.ops.orogeny.show_region()
    assert bpy.ops.orogeny.brush_modal.poll()


def test_manifest_and_operators(addon) -> None:
    import tomllib
    from pathlib import Path

    manifest = tomllib.loads((Path(addon.__file__).parent / "blender_manifest.toml").read_text())
    assert manifest["id"] == "orogeny_blender"
    assert set(manifest["permissions"]) == {"network", "files"}
    assert all(len(reason) <= 64 and not reason.endswith(".") for reason in manifest["permissions"].values())
    names = "connect show_region stroke brush_modal undo redo pull_image push_image"
    assert all(hasattr(bpy.ops.orogeny, name) for name in names.split())
    addon.unregister()
    assert not hasattr(bpy.types.Scene, "orogeny")
    addon.register()
