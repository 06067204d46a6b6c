"""The brushes that the panel offers: those that need no more than a radius and a strength."""

from __future__ import annotations

import json
from typing import Any

from .core.operations import point_list

METRES = "metres"
SHARE = "share"

# Type, name, what it does, what its strength is, and what Ctrl makes of it.
BRUSHES = [
    ("raise", "Raise", "Adds height", METRES, "lower"),
    ("lower", "Lower", "Takes height away", METRES, "raise"),
    ("smooth", "Smooth", "Smooths what is narrow", SHARE, "sharpen"),
    ("sharpen", "Sharpen", "Makes what is narrow stand out", SHARE, "smooth"),
    ("level", "Level", "Flattens towards the height under the first point", SHARE, "level"),
    ("ramp", "Ramp", "Builds a slope from the first point to the last", SHARE, "ramp"),
    ("ledge", "Ledge", "Leaves a step on a slope", METRES, "ledge"),
    ("roughen", "Roughen", "Adds white noise", METRES, "smooth"),
    ("noise", "Noise", "Adds hills and mountains", METRES, "noise"),
    ("smear", "Smear", "Drags the ground along", SHARE, "smear"),
    ("grab", "Grab", "Moves the ground under the first point to the last", SHARE, "grab"),
    ("terrace", "Terrace", "Cuts the ground into steps", SHARE, "smooth"),
    ("erode_thermal", "Erode (scree)", "Lets steep ground slide down", SHARE, "erode_thermal"),
    ("erode_fluvial", "Erode (water)", "Lets rain cut gullies", SHARE, "erode_fluvial"),
]
ITEMS = [(kind, name, does) for kind, name, does, _, _ in BRUSHES]
_STRENGTH = {kind: strength for kind, _, _, strength, _ in BRUSHES}
_OPPOSITE = {kind: opposite for kind, _, _, _, opposite in BRUSHES}


def strength_is(kind: str) -> str:
    """Whether a brush's strength is metres, or a share 0..1."""
    return _STRENGTH.get(kind, SHARE)


def opposite(kind: str) -> str:
    """The brush that Ctrl makes of one."""
    return _OPPOSITE.get(kind, kind)


def make(brush: str, radius_m: float, strength: float) -> dict[str, Any]:
    """A brush of a type's name, or of a JSON object, which is taken as it is but for the radius that it lacks."""
    text = brush.strip()
    if not text.startswith("{"):
        return {"type": text, "radius": radius_m, "strength": strength}
    try:
        value = json.loads(text)
    except ValueError as error:
        raise ValueError(f"the brush is no JSON object: {error}") from error
    return value if "preset" in value else {"radius": radius_m, **value}


def parse_points(text: str) -> list[list[float]]:
    """Points of JSON `[[x, z], [x, z, pressure]]`, or of text `x,z x,z`; metres."""
    try:
        value = json.loads(text) if text.lstrip().startswith("[") else [p.split(",") for p in text.split()]
        return point_list(value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"points are [[x, z], ...] or `x,z x,z`, metres: {error}") from error
