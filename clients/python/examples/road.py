"""Paints a road along a list of points: levels the ground along a smoothed line.

    python road.py http://127.0.0.1:4750 island --points road.csv --width 8 --shoulder 6 --max-grade 8

The points are lines `x,z` in metres in a CSV file, x to the east and z to the south from the terrain's north-west
corner; without a file the road goes across the terrain. The road is a chain of short strokes of the brush `ramp`,
whose falloff makes the shoulders. All of them are one request: the road is painted as a whole, or not at all.
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from orogeny import Client, Heights, OrogenyException, Region, Terrain

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Plan:
    """A road: `line` is `(n, 2)`, places `[x, z]` a step apart; `along` are metres from its beginning, `(n,)`."""

    line: Array
    along: Array
    ground: Array
    heights: Array
    width_m: float
    shoulder_m: float

    @property
    def length_m(self) -> float:
        """Metres from end to end."""
        return float(self.along[-1])

    @property
    def reach_m(self) -> float:
        """Metres from the middle to where nothing changes any more."""
        return self.width_m / 2 + self.shoulder_m


def read_points(path: Path) -> Array:
    """Points `[x, z]` of a CSV file; lines that do not begin with a number are left out."""
    with path.open(newline="") as file:
        points = [point for row in csv.reader(file) if (point := _point(row)) is not None]
    return np.array(points).reshape(-1, 2)


def across(width_m: float, depth_m: float) -> Array:
    """A winding road from the west to the east of a terrain of that size."""
    shares = [(0.08, 0.30), (0.25, 0.42), (0.38, 0.36), (0.55, 0.55), (0.70, 0.52), (0.92, 0.70)]
    return np.array(shares) * (width_m, depth_m)


def smooth_line(points: Array, step_m: float, rounding_m: float) -> Array:
    """Put points `step_m` apart onto the line through `points`, its corners rounded over about `rounding_m`."""
    dense = _resample(points, step_m)
    return _resample(_blur(dense, rounding_m / step_m), step_m)


def profile(along: Array, ground: Array, smoothing_m: float, max_grade: float) -> Array:
    """Heights of the road: the ground's, smoothed over about `smoothing_m`, nowhere steeper than `max_grade`."""
    step_m = along[1] - along[0]
    smooth = _blur(ground[:, np.newaxis], smoothing_m / step_m)[:, 0]
    # The highest line below and the lowest line above that are gentle enough; midway between them is as gentle.
    rise = max_grade * np.abs(along[:, np.newaxis] - along[np.newaxis, :])
    below, above = (smooth[np.newaxis, :] + rise).min(axis=1), (smooth[np.newaxis, :] - rise).max(axis=1)
    middle: Array = (below + above) / 2
    return middle


def plan(points: Array, ground: Heights, args: argparse.Namespace) -> Plan:
    """Lay the road out over the ground."""
    step_m = max(args.width / 2, 1.5 * ground.spacing_m)
    line = smooth_line(points, step_m, args.rounding)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    below = np.array([ground.at(x, z) for x, z in line])
    return Plan(
        line, along, below, profile(along, below, args.smoothing, args.max_grade / 100), args.width, args.shoulder
    )


def operations(road: Plan, layer: str | None) -> list[dict[str, Any]]:
    """The strokes that paint the road."""
    where = {} if layer is None else {"layer": layer}
    # A ramp is round and level at its ends, so each one levels the last bit of the one before. Short ones are told the
    # height of the road a little further back: what stays of them together then has the grade that was planned.
    back_m = 0.375 * road.width_m
    heights = np.interp(road.along - back_m, road.along, road.heights)
    shape = {"type": "ramp", "radius": road.reach_m, "falloff": road.shoulder_m}
    return [
        {
            "op": "stroke",
            "brush": shape | {"height": float(heights[i]), "end_height": float(heights[i + 1])},
            "points": road.line[i : i + 2].tolist(),
            **where,
        }
        for i in range(len(road.line) - 1)
    ]


def report(road: Plan, ground: Heights) -> str:
    """What came of it, from the heights that the service then has."""
    middle = np.array([ground.at(x, z) for x, z in road.line])
    grades = np.abs(np.diff(middle) / np.diff(road.along))
    sideways = np.gradient(road.line, axis=0)
    sideways = np.stack([-sideways[:, 1], sideways[:, 0]], axis=1) / np.hypot(*sideways.T)[:, np.newaxis]
    edges = [[ground.at(x, z) for x, z in road.line + side * road.width_m / 2 * 0.7 * sideways] for side in (-1.0, 1.0)]
    falls = np.abs(np.array(edges) - middle).max(axis=0)
    moved = middle - road.ground
    return (
        f"road of {road.length_m:.0f} m, {road.width_m:g} m wide with shoulders of {road.shoulder_m:g} m\n"
        f"heights {middle.min():.1f} to {middle.max():.1f} m; cut up to {max(0.0, -moved.min()):.1f} m, "
        f"filled up to {max(0.0, moved.max()):.1f} m\n"
        f"max grade {grades.max() * 100:.1f} %, 95 % of it below {np.percentile(grades, 95) * 100:.1f} %; "
        f"was {np.abs(np.diff(road.ground) / np.diff(road.along)).max() * 100:.1f} % over the bare ground\n"
        f"off the plan by {np.abs(middle - road.heights).max():.2f} m at most, "
        f"across the roadway {falls.max():.2f} m at most"
    )


def region_of(points: Array, margin_m: float) -> Region:
    """The region that holds all points and what lies within `margin_m` of them."""
    low, high = points.min(axis=0) - margin_m, points.max(axis=0) + margin_m
    return Region(max(0.0, low[0]), max(0.0, low[1]), high[0] - max(0.0, low[0]), high[1] - max(0.0, low[1]))


def paint(terrain: Terrain, args: argparse.Namespace) -> str:
    """Plan the road, paint it, and tell what came of it."""
    size = terrain.info()
    extent = size["width"] * size["spacing"], size["depth"] * size["spacing"]
    points = read_points(args.points) if args.points else across(*extent)
    if len(points) < 2:
        raise ValueError("a road has at least two points `x,z`")
    if points.min() < 0 or (points > extent).any():
        raise ValueError(f"a point lies outside the terrain of {extent[0]:g} x {extent[1]:g} m")
    around = region_of(points, args.width + args.shoulder + 4 * size["spacing"])
    road = plan(points, terrain.read_heights(around), args)
    todo = operations(road, args.layer)
    change = terrain.apply(todo)
    done = (
        f"{len(todo)} strokes, revision {change.revision}; `undo` with a count of {len(change.entries)} takes it back"
    )
    return f"{report(road, terrain.read_heights(around))}\n{done}"


def arguments(args: list[str]) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Paints a road along a list of points.")
    parser.add_argument("url", help="the service, such as http://127.0.0.1:4750")
    parser.add_argument("terrain", nargs="?", help="which terrain; by default the first")
    parser.add_argument("--points", type=Path, metavar="CSV", help="lines x,z in metres; by default across the terrain")
    parser.add_argument("--width", type=float, default=8, help="of the roadway, metres (%(default)s)")
    parser.add_argument("--shoulder", type=float, default=8, help="of either slope beside it, metres (%(default)s)")
    parser.add_argument("--max-grade", type=float, default=8, help="percent (%(default)s)")
    parser.add_argument(
        "--rounding", type=float, default=30, help="over which corners are rounded, metres (%(default)s)"
    )
    parser.add_argument(
        "--smoothing", type=float, default=60, help="over which heights are smoothed, metres (%(default)s)"
    )
    parser.add_argument("--layer", help="which layer is painted on; by default the lowest")
    parser.add_argument("--author", default="road.py", help="whom the history names (%(default)s)")
    parser.add_argument("--token-file", type=Path, help="a file with the service's token")
    parsed = parser.parse_args(args)
    for name in ("width", "shoulder", "max_grade", "rounding", "smoothing"):
        if not (math.isfinite(value := getattr(parsed, name)) and value > 0):
            parser.error(f"--{name.replace('_', '-')} is above 0, not {value}")
    return parsed


def main(argv: list[str]) -> int:
    """Do what the command line says."""
    args = arguments(argv)
    token = args.token_file.read_text().strip() if args.token_file else None
    try:
        with Client(args.url, token, args.author) as client:
            name = args.terrain or client.terrains()[0]["name"]
            print(paint(client.terrain(name), args))
    except (OrogenyException, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


def _point(row: list[str]) -> tuple[float, float] | None:
    try:
        return float(row[0]), float(row[1])
    except (IndexError, ValueError):
        return None


def _resample(points: Array, step_m: float) -> Array:
    """Points along a polyline, evenly spread and about `step_m` apart."""
    lengths = np.hypot(*np.diff(points, axis=0).T)
    points = points[np.concatenate([[True], lengths > 0])]
    along = np.concatenate([[0.0], np.cumsum(lengths[lengths > 0])])
    if along[-1] <= 0:
        raise ValueError("all points of the road are one")
    places = np.linspace(0, along[-1], max(2, round(along[-1] / step_m) + 1))
    return np.stack([np.interp(places, along, points[:, axis]) for axis in (0, 1)], axis=1)


def _blur(values: Array, width: float) -> Array:
    """A Gaussian over `width` values along the first axis; the ends stay where they are."""
    reach = min(max(1, math.ceil(width * 1.5)), len(values) - 1)
    offsets = np.arange(-reach, reach + 1)
    weights = np.exp(-0.5 * (offsets / (width / 2)) ** 2)
    # Turned about its ends, so that these stay.
    before, after = 2 * values[:1] - values[reach:0:-1], 2 * values[-1:] - values[-2 : -reach - 2 : -1]
    longer = np.concatenate([before, values, after])
    columns = [np.convolve(column, weights / weights.sum(), "valid") for column in longer.T]
    return np.stack(columns, axis=1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
