"""Terrains of an Orogeny service in Blender: meshes that follow the live channel, brushed in the viewport."""

from __future__ import annotations

import bpy

from . import modal, operators, panel, session, settings

_CLASSES = [*operators.CLASSES, *modal.CLASSES, *panel.CLASSES]


def register() -> None:
    """Make operators, panel and settings known."""
    settings.register()
    for each in _CLASSES:
        bpy.utils.register_class(each)
    session.register()


def unregister() -> None:
    """Disconnect, and take them back."""
    session.unregister()
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
    settings.unregister()
