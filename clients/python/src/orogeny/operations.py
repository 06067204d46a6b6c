"""Operations: what recipes hold and the service runs, as dictionaries."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Operation = Mapping[str, Any]
"""An operation, such as `{"op": "fill", "brush": {...}}`; the guide lists them."""

Brush = Mapping[str, Any]
"""A brush, such as `{"type": "raise", "radius": 40, "strength": 12}`, or `{"preset": "..."}` and what differs."""

Points = Iterable[Sequence[float]] | npt.NDArray[Any]
"""Points of a stroke: `[x, z]` in metres, then pressure 0..1, seconds, tilt in degrees; or an array `(n, 2..5)`."""

LayerName = str | int
"""A layer's name or id."""


def point_list(points: Points) -> list[list[float]]:
    """Take points as a list of lists of numbers, checked."""
    checked = []
    for index, point in enumerate(points):
        numbers = [float(value) for value in point]
        if not 2 <= len(numbers) <= 5:
            raise ValueError(
                f"point {index} has {len(numbers)} numbers: [x, z, pressure, seconds, tilt], 2 to 5 of them"
            )
        if not all(math.isfinite(value) for value in numbers):
            raise ValueError(f"point {index} is not of finite numbers: {numbers}")
        checked.append(numbers)
    return checked


def stroke(
    brush: Brush,
    points: Points | None = None,
    *,
    layer: LayerName | None = None,
    seed: int | None = None,
    target: str | None = None,
) -> dict[str, Any]:
    """Make the operation `stroke`; without `points` it is one that begins a stroke on the live channel."""
    operation: dict[str, Any] = {"op": "stroke", "brush": dict(brush)}
    if points is not None:
        operation["points"] = point_list(points)
        if not operation["points"]:
            raise ValueError("a stroke has at least one point")
    rest = {"layer": layer, "seed": seed, "target": target}
    return operation | {name: value for name, value in rest.items() if value is not None}


def to_json(value: object) -> str:
    """Write JSON; NumPy numbers and arrays count as numbers and lists, NaN and infinity are refused."""
    return json.dumps(value, default=_plain, allow_nan=False, separators=(",", ":"))


def _plain(value: object) -> object:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")
