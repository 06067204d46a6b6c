"""Messages of the live channel from the client, as JSON text; apart from how they are sent."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from .frames import FORMATS
from .grid import Region, RegionLike
from .operations import Operation, Points, point_list, to_json

POINTS_PER_MESSAGE = 512
"""More points than these are sent as several messages."""


def begin_stroke(number: int, operation: Operation) -> str:
    """Begin a stroke; `operation` is a `stroke`, with or without points."""
    return _message("begin_stroke", id=number, operation=operation)


def points(number: int, more: Points) -> list[str]:
    """Go on with a stroke, as one or several messages."""
    checked = point_list(more)
    parts = range(0, len(checked), POINTS_PER_MESSAGE)
    return [_message("points", id=number, points=checked[start : start + POINTS_PER_MESSAGE]) for start in parts]


def end_stroke(number: int) -> str:
    """Lift the hand."""
    return _message("end_stroke", id=number)


def cancel_stroke(number: int) -> str:
    """Take back a stroke, or anything else that was asked for under that number and is not done."""
    return _message("cancel_stroke", id=number)


def apply(number: int, operations: Iterable[Operation]) -> str:
    """Run operations, all or none."""
    return _message("apply", id=number, operations=list(operations))


def undo(number: int, anyone: bool = False) -> str:
    """Take back what this author did last."""
    return _message("undo", id=number, **({"anyone": True} if anyone else {}))


def redo(number: int, anyone: bool = False) -> str:
    """Do again what this author took back last."""
    return _message("redo", id=number, **({"anyone": True} if anyone else {}))


def subscribe(region: RegionLike | None = None, level: int = 0, form: str = "r32", window: int = 16) -> str:
    """Ask for the pages of a region, `None`: of all of the terrain, now and whenever they change."""
    if form not in FORMATS:
        raise ValueError(f"a format is one of {', '.join(FORMATS)}, not `{form}`")
    where = {} if region is None else {"region": Region.of(region).as_list()}
    return _message("subscribe", **where, level=level, format=form, window=window)


def unsubscribe() -> str:
    """Ask for no more pages."""
    return _message("unsubscribe")


def ack(frames: int) -> str:
    """Tell how many page frames have been taken since the connection began."""
    return _message("ack", frames=frames)


def cursor(x_m: float, z_m: float, radius_m: float) -> str:
    """Tell the others where this client's pointer is."""
    return _message("cursor", x=x_m, z=z_m, radius=radius_m)


def _message(kind: str, **fields: Any) -> str:
    return to_json({"type": kind, **fields})
