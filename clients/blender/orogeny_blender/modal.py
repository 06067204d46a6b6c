"""Painting in the viewport: turns mouse events into what a `Hand` draws, and nothing else."""

from __future__ import annotations

import time
from collections.abc import Callable

import bpy
import numpy as np
from bpy_extras import view3d_utils

from . import brushes, session
from .axes import Place
from .core import messages
from .core.errors import OrogenyException
from .feed import Feed
from .hand import Hand
from .picking import pick
from .settings import OrogenySettings

PASSED, TAKEN, ENDED = "PASS_THROUGH", "RUNNING_MODAL", "FINISHED"
_CURSOR_EVERY_S = 0.05


class Painter:
    """A mouse over the ground. `where` tells the place under the pointer; `brush` makes the brush of a type's name."""

    def __init__(
        self,
        feed: Feed,
        where: Callable[[bpy.types.Event], Place | None],
        settings: OrogenySettings,
        hold: Callable[[bool], None] = lambda _: None,
    ) -> None:
        self._feed = feed
        self._where = where
        self._settings = settings
        self._hold = hold
        self._hand: Hand | None = None
        self._began_s = 0.0
        self._told_s = 0.0

    @property
    def is_drawing(self) -> bool:
        """Whether a stroke is under way."""
        return self._hand is not None

    def handle(self, event: bpy.types.Event) -> str:
        """Take an event; returns what Blender wants to know of it."""
        if event.type == "LEFTMOUSE" and event.value == "PRESS":
            # Alt and the left button navigate, where the middle button is missing.
            return PASSED if event.alt else self._begin(event)
        if event.type == "LEFTMOUSE" and event.value == "RELEASE" and self.is_drawing:
            self._end(cancel=False)
            return TAKEN
        if event.type in {"MOUSEMOVE", "INBETWEEN_MOUSEMOVE"}:
            self._move(event)
            return TAKEN if self.is_drawing else PASSED
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            if self.is_drawing:
                self._end(cancel=True)
                return TAKEN
            return ENDED
        if event.value == "PRESS" and event.type in {"LEFT_BRACKET", "RIGHT_BRACKET"}:
            self._settings.radius *= 1.15 if event.type == "RIGHT_BRACKET" else 1 / 1.15
            return TAKEN
        return PASSED

    def stop(self) -> None:
        """Take back what is under way."""
        if self.is_drawing:
            self._end(cancel=True)

    def _begin(self, event: bpy.types.Event) -> str:
        place = self._where(event)
        if place is None:
            return PASSED
        self._hold(True)
        kind = "smooth" if event.shift else self._settings.brush
        kind = brushes.opposite(kind) if event.ctrl else kind
        brush = brushes.make(kind, self._settings.radius, self._settings.strength_of(kind))
        self._began_s = time.monotonic()
        self._hand = Hand(self._feed, brush, self._settings.layer)
        self._draw(place, event)
        return TAKEN

    def _move(self, event: bpy.types.Event) -> None:
        place = self._where(event)
        if place is None:
            return
        if self.is_drawing:
            self._draw(place, event)
        elif (now := time.monotonic()) - self._told_s >= _CURSOR_EVERY_S:
            self._told_s = now
            self._feed.send(messages.cursor(place.x_m, place.z_m, self._settings.radius))

    def _draw(self, place: Place, event: bpy.types.Event) -> None:
        assert self._hand is not None
        pressure = event.pressure if event.is_tablet else 1.0
        self._hand.draw([[place.x_m, place.z_m, pressure, time.monotonic() - self._began_s]])

    def _end(self, cancel: bool) -> None:
        hand, self._hand = self._hand, None
        self._hold(False)
        assert hand is not None
        if cancel:
            hand.cancel()
        else:
            hand.lift()


class Pointer:
    """Finds the place under the mouse. While a stroke is drawn, on the ground as it was before it."""

    def __init__(self, area_region: bpy.types.Region, view: bpy.types.RegionView3D) -> None:
        self._region = area_region
        self._view = view
        self._held: np.ndarray | None = None

    def hold(self, is_held: bool) -> None:
        """Keep the ground as it is now, or let it go."""
        surface = session.needed().surface
        self._held = surface.heights.copy() if is_held and surface is not None else None

    def where(self, event: bpy.types.Event) -> Place | None:
        """The place under an event."""
        surface = session.needed().surface
        shown = surface.object if surface is not None else None
        if surface is None or shown is None:
            return None
        at = (event.mouse_x - self._region.x, event.mouse_y - self._region.y)
        if not (0 <= at[0] < self._region.width and 0 <= at[1] < self._region.height):
            return None
        inverse = shown.matrix_world.inverted_safe()
        origin = inverse @ view3d_utils.region_2d_to_origin_3d(self._region, self._view, at)
        direction = inverse.to_3x3() @ view3d_utils.region_2d_to_vector_3d(self._region, self._view, at)
        mirror = surface.mirror
        x_m, z_m = mirror.samples.x0 * mirror.spacing_m, mirror.samples.z0 * mirror.spacing_m
        heights = surface.heights if self._held is None else self._held
        return pick(heights, x_m, z_m, mirror.spacing_m, np.array(origin), np.array(direction))


class OROGENY_OT_brush_modal(bpy.types.Operator):
    """Paint with the mouse: Ctrl does the opposite, Shift smooths, [ and ] change the radius, Esc ends"""

    bl_idname = "orogeny.brush_modal"
    bl_label = "Paint"
    bl_options = {"REGISTER"}  # noqa: RUF012

    @classmethod
    def poll(cls, context):
        connected = session.current()
        return connected is not None and connected.surface is not None

    def invoke(self, context, event):
        if context.area is None or context.area.type != "VIEW_3D":
            self.report({"ERROR"}, "painting goes on in a 3D viewport")
            return {"CANCELLED"}
        window = next(region for region in context.area.regions if region.type == "WINDOW")
        pointer = Pointer(window, context.area.spaces.active.region_3d)
        feed = session.needed().feed
        self._painter = Painter(feed, pointer.where, context.scene.orogeny, pointer.hold)
        context.workspace.status_text_set("Left button paints; Ctrl opposite, Shift smooths; [ ] radius; Esc ends")
        context.window.cursor_modal_set("PAINT_CROSS")
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        try:
            if not self.poll(context):
                return self._leave(context)
            answer = self._painter.handle(event)
        except (OrogenyException, ValueError) as error:
            self.report({"ERROR"}, str(error))
            return self._leave(context)
        return self._leave(context) if answer == ENDED else {answer}

    def cancel(self, context):
        """Blender ends the operator: a file is opened, or a window closed."""
        self._leave(context)

    def _leave(self, context):
        self._painter.stop()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        if context.window is not None:
            context.window.cursor_modal_restore()
        return {"FINISHED"}


CLASSES = [OROGENY_OT_brush_modal]
