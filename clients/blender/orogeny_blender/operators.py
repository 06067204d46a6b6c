"""The operators. Each takes all that it needs as arguments; where one is left out, the panel's setting counts.

Places are metres from the terrain's north-west corner, x to the east and z to the south.
"""

from __future__ import annotations

import concurrent.futures
from collections.abc import Set
from typing import Any

import bpy
from bpy.props import BoolProperty, FloatProperty, FloatVectorProperty, IntProperty, StringProperty

from . import brushes, images, session, settings
from .core import messages
from .core.errors import OrogenyException
from .core.grid import Region
from .core.results import Change
from .hand import Hand
from .surface import check_size, make_mesh

Result = Set[str]


class Base:
    """What all operators have in common: what goes wrong is told, and nothing else happens."""

    bl_options = {"REGISTER"}  # noqa: RUF012 - as Blender wants it

    def execute(self, context: bpy.types.Context) -> Result:
        """Do it."""
        try:
            said = self.do(context)
        except (OrogenyException, ValueError, TimeoutError, concurrent.futures.TimeoutError) as error:
            self.report({"ERROR"}, str(error) or type(error).__name__)
            return {"CANCELLED"}
        if said:
            self.report({"INFO"}, said)
        return {"FINISHED"}

    def do(self, context: bpy.types.Context) -> str:
        """Do it, and tell what was done."""
        raise NotImplementedError

    def given(self, name: str, otherwise: Any) -> Any:
        """An argument, or what counts where it was not given."""
        return getattr(self, name) if self.properties.is_property_set(name) else otherwise

    def region(self, context: bpy.types.Context) -> Region | None:
        """The region that is meant; `None`: all of the terrain."""
        x, z, width, depth = self.given("area", context.scene.orogeny.region)
        return Region(x, z, width, depth) if width > 0 and depth > 0 else None


def _area() -> Any:
    return FloatVectorProperty(
        name="Region", size=4, description="x, z, width, depth in metres; no width or depth: all of the terrain"
    )


def _level() -> Any:
    return IntProperty(name="Level", min=0, max=31, description="0 is full resolution, each next has half of it")


class OROGENY_OT_connect(Base, bpy.types.Operator):
    """Connect to the service, and follow one of its terrains"""

    bl_idname = "orogeny.connect"
    bl_label = "Connect"

    url: StringProperty(name="Service")
    token: StringProperty(name="Token", subtype="PASSWORD", options={"SKIP_SAVE", "HIDDEN"})
    terrain: StringProperty(name="Terrain", description="Empty: the first")
    author: StringProperty(name="Author")

    def do(self, context):
        here = context.scene.orogeny
        if self.properties.is_property_set("token"):
            here.token = self.token
        if self.properties.is_property_set("url"):
            here.url = self.url
        author = self.given("author", here.author) or settings.default_author()
        connected = session.connect(here.url, settings.token(), self.given("terrain", here.terrain), author)
        here.terrain = connected.calls.name
        hello = connected.hello
        return f"`{hello.terrain}`: {hello.width} x {hello.depth} samples, one every {hello.spacing_m:g} m"


class OROGENY_OT_disconnect(Base, bpy.types.Operator):
    """Disconnect; what is shown stays as it is"""

    bl_idname = "orogeny.disconnect"
    bl_label = "Disconnect"

    def do(self, context):
        session.disconnect()
        return ""


class OROGENY_OT_show_region(Base, bpy.types.Operator):
    """Show a region as a mesh, which follows what anyone paints"""

    bl_idname = "orogeny.show_region"
    bl_label = "Show Region"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    area: _area()
    level: _level()
    follow: BoolProperty(name="Follow", default=True, description="Keep it up to date; else it is a mesh as any other")

    def do(self, context):
        connected = session.needed()
        region, level = self.region(context), self.given("level", context.scene.orogeny.level)
        if self.follow:
            name = connected.follow(region, level, context.collection).name
        else:
            check_size(connected.samples(region, level), level)
            heights = connected.sender.send(connected.calls.read_heights(region, level, None))
            shown = bpy.data.objects.new(connected.calls.name, make_mesh(connected.calls.name, heights))
            context.collection.objects.link(shown)
            name = shown.name
        context.view_layer.objects.active = bpy.data.objects[name]
        return f"`{name}`"


class OROGENY_OT_stroke(Base, bpy.types.Operator):
    """Draw a stroke"""

    bl_idname = "orogeny.stroke"
    bl_label = "Stroke"

    points: StringProperty(name="Points", description="[[x, z], [x, z, pressure, seconds]] or `x,z x,z`, metres")
    brush: StringProperty(name="Brush", description="A type such as `raise`, or a brush as a JSON object")
    radius: FloatProperty(name="Radius", default=40, min=0.001, description="Metres")
    strength: FloatProperty(name="Strength", default=1, description="Metres, or a share 0..1, as the brush takes it")
    layer: StringProperty(name="Layer")
    seed: IntProperty(name="Seed", min=0)
    wait: FloatProperty(name="Wait", default=60, min=0, description="Seconds until it has to be done; 0: do not wait")

    def do(self, context):
        connected, here = session.needed(), context.scene.orogeny
        points = brushes.parse_points(self.points)
        if not points:
            raise ValueError("a stroke has at least one point")
        kind = self.given("brush", here.brush)
        strength = self.given("strength", here.strength_of(kind))
        brush = brushes.make(kind, self.given("radius", here.radius), strength)
        hand = Hand(connected.feed, brush, self.given("layer", here.layer), self.given("seed", None))
        try:
            hand.draw(points)
            done = hand.lift()
        except BaseException:
            hand.cancel()
            raise
        return _told(done, self.wait)


class OROGENY_OT_undo(Base, bpy.types.Operator):
    """Take back what you painted last on the terrain; others' strokes stay"""

    bl_idname = "orogeny.undo"
    bl_label = "Undo on Terrain"

    anyone: BoolProperty(name="Anyone", description="What was done last, by whomever")

    def do(self, context):
        _, done = session.needed().feed.ask(lambda number: messages.undo(number, self.anyone))
        return _told(done, 60)


class OROGENY_OT_redo(Base, bpy.types.Operator):
    """Do again what you took back last on the terrain"""

    bl_idname = "orogeny.redo"
    bl_label = "Redo on Terrain"

    anyone: BoolProperty(name="Anyone", description="What was taken back last, by whomever")

    def do(self, context):
        _, done = session.needed().feed.ask(lambda number: messages.redo(number, self.anyone))
        return _told(done, 60)


class OROGENY_OT_pull_image(Base, bpy.types.Operator):
    """Make an image of a region's heights, in metres as 32-bit floats"""

    bl_idname = "orogeny.pull_image"
    bl_label = "Pull Height Image"

    area: _area()
    level: _level()
    name: StringProperty(name="Name", description="Of the image; empty: as the terrain")
    filepath: StringProperty(name="File", subtype="FILE_PATH", description="Also write an OpenEXR file")

    def do(self, context):
        connected = session.needed()
        region, level = self.region(context), self.given("level", context.scene.orogeny.level)
        heights = connected.sender.send(connected.calls.read_heights(region, level, None))
        image = images.to_image(self.name or f"{connected.calls.name} heights", heights)
        if self.filepath:
            images.save(image, bpy.path.abspath(self.filepath))
        context.scene.orogeny.image = image
        return f"`{image.name}`: {image.size[0]} x {image.size[1]}, from {heights.x_m:g}, {heights.z_m:g} m on"


class OROGENY_OT_push_image(Base, bpy.types.Operator):
    """Write an image's red onto the terrain as heights"""

    bl_idname = "orogeny.push_image"
    bl_label = "Push Height Image"

    image: StringProperty(name="Image", description="Name of the image")
    x: FloatProperty(name="X", description="Place of its north-west pixel, metres")
    z: FloatProperty(name="Z", description="Place of its north-west pixel, metres")
    low: FloatProperty(name="Low", default=0, description="Height of 0, metres")
    high: FloatProperty(name="High", default=1, description="Height of 1, metres; 0 and 1: the values are metres")
    layer: StringProperty(name="Layer")

    def do(self, context):
        connected, here = session.needed(), context.scene.orogeny
        image = bpy.data.images.get(self.image) if self.image else here.image
        if image is None:
            raise ValueError(f"there is no image `{self.image}`" if self.image else "choose an image first")
        heights = images.from_image(image, self.low, self.high)
        spacing = image.get("orogeny_spacing", connected.hello.spacing_m)
        if abs(spacing - connected.hello.spacing_m) > 1e-6 * spacing:
            raise ValueError(f"the image is of a coarser level ({spacing:g} m): only full resolution can be written")
        x, z = self.given("x", image.get("orogeny_x", 0.0)), self.given("z", image.get("orogeny_z", 0.0))
        layer = self.given("layer", here.layer) or None
        change = connected.sender.send(connected.calls.write_heights(heights, x, z, layer))
        return f"`{image.name}` at {x:g}, {z:g} m, revision {change.revision}"


def _told(done: concurrent.futures.Future[Change], wait_s: float) -> str:
    if wait_s <= 0:
        return ""
    change = done.result(wait_s)
    session.drain()
    return f"revision {change.revision}"


CLASSES = [
    OROGENY_OT_connect,
    OROGENY_OT_disconnect,
    OROGENY_OT_show_region,
    OROGENY_OT_stroke,
    OROGENY_OT_undo,
    OROGENY_OT_redo,
    OROGENY_OT_pull_image,
    OROGENY_OT_push_image,
]
