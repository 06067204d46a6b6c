"""The panel in the sidebar of the 3D viewport."""

from __future__ import annotations

import bpy

from . import brushes, session


class OROGENY_PT_panel(bpy.types.Panel):
    """Terrains of an Orogeny service"""

    bl_label = "Orogeny"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Orogeny"

    def draw(self, context):
        layout, here = self.layout, context.scene.orogeny
        layout.use_property_split = True
        layout.use_property_decorate = False
        connected = session.current()
        self._draw_service(layout.column(), here, connected)
        if connected is None:
            return
        if connected.problem:
            layout.label(text=connected.problem, icon="ERROR")
        self._draw_region(layout.column(), here)
        self._draw_brush(layout.column(), here)
        self._draw_images(layout.column(), here)

    def _draw_service(self, column, here, connected):
        column.prop(here, "url")
        column.prop(here, "token")
        column.prop(here, "terrain")
        column.prop(here, "author")
        row = column.row(align=True)
        row.operator("orogeny.connect", icon="LINKED")
        if connected is not None:
            row.operator("orogeny.disconnect", text="", icon="UNLINKED")
            hello = connected.hello
            column.label(text=f"{hello.width} x {hello.depth} samples, one every {hello.spacing_m:g} m")
            if connected.others:
                column.label(text="Also here: " + ", ".join(connected.others), icon="COMMUNITY")

    def _draw_region(self, column, here):
        column.separator()
        column.prop(here, "region", text="Region (x, z, width, depth)")
        column.prop(here, "level")
        column.operator("orogeny.show_region", icon="MESH_GRID")

    def _draw_brush(self, column, here):
        column.separator()
        column.prop(here, "brush")
        column.prop(here, "radius")
        is_metres = brushes.strength_is(here.brush) == brushes.METRES
        column.prop(here, "strength_m" if is_metres else "strength_share")
        column.prop(here, "layer")
        column.operator("orogeny.brush_modal", icon="BRUSH_DATA")
        row = column.row(align=True)
        row.operator("orogeny.undo", icon="LOOP_BACK")
        row.operator("orogeny.redo", icon="LOOP_FORWARDS")

    def _draw_images(self, column, here):
        column.separator()
        column.operator("orogeny.pull_image", icon="IMPORT")
        column.template_ID(here, "image", open="image.open")
        column.operator("orogeny.push_image", icon="EXPORT")


CLASSES = [OROGENY_PT_panel]
