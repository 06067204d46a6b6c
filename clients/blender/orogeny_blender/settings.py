"""What the panel holds. The token is kept in memory alone: a .blend file that is passed on has none."""

from __future__ import annotations

import getpass

import bpy
from bpy.props import EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, PointerProperty, StringProperty

from . import brushes, session

_token = ""


def token() -> str:
    """The token that was typed in."""
    return _token


def _get_token(_self: bpy.types.PropertyGroup) -> str:
    return _token


def _set_token(_self: bpy.types.PropertyGroup, value: str) -> None:
    global _token
    _token = value.strip()


def _terrains(_self: bpy.types.PropertyGroup, _context: bpy.types.Context, text: str) -> list[str]:
    connected = session.current()
    return [name for name in connected.terrains if text.lower() in name.lower()] if connected else []


def default_author() -> str:
    """Whom the history names: the person at this machine."""
    try:
        return f"{getpass.getuser()} (Blender)"
    except (OSError, KeyError, ImportError):
        return "Blender"


class OrogenySettings(bpy.types.PropertyGroup):
    """Settings of the panel."""

    url: StringProperty(name="Service", default="http://127.0.0.1:4750", description="Address of the service")
    token: StringProperty(
        name="Token",
        subtype="PASSWORD",
        get=_get_token,
        set=_set_token,
        description="What the service asks for, if it does; not saved",
    )
    terrain: StringProperty(name="Terrain", search=_terrains, description="Which terrain; empty: the first")
    author: StringProperty(name="Author", description="Whom the history names; empty: you")
    region: FloatVectorProperty(
        name="Region",
        size=4,
        default=(0, 0, 0, 0),
        description="x, z, width and depth in metres from the north-west corner; no width or depth: all of the terrain",
    )
    level: IntProperty(name="Level", min=0, max=31, description="0 is full resolution, each next has half of it")
    brush: EnumProperty(name="Brush", items=brushes.ITEMS, default="raise")
    radius: FloatProperty(name="Radius", default=40, min=0.01, soft_max=2000, subtype="DISTANCE", unit="LENGTH")
    strength_m: FloatProperty(name="Strength", default=5, min=0, soft_max=200, unit="LENGTH")
    strength_share: FloatProperty(name="Strength", default=0.5, min=0, max=1, subtype="FACTOR")
    layer: StringProperty(name="Layer", description="Which layer is painted on; empty: the lowest")
    image: PointerProperty(name="Image", type=bpy.types.Image)

    def strength_of(self, kind: str) -> float:
        """The strength that a type of brush has here."""
        return self.strength_m if brushes.strength_is(kind) == brushes.METRES else self.strength_share


def register() -> None:
    """Give each scene its settings."""
    bpy.utils.register_class(OrogenySettings)
    bpy.types.Scene.orogeny = PointerProperty(type=OrogenySettings)


def unregister() -> None:
    """Forget them, and the token."""
    global _token
    _token = ""
    del bpy.types.Scene.orogeny
    bpy.utils.unregister_class(OrogenySettings)
