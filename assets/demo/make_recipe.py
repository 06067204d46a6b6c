"""Makes recipe.json, which the demo applies to the bundled terrain.

    orogeny import assets/terrain/frazier_1024_int16.tif demo.orogeny
    orogeny export demo.orogeny demo.npy
    python3 assets/demo/make_recipe.py demo.npy > assets/demo/recipe.json

Needs NumPy and SciPy. A ridge is drawn into the plain in the north, along the mountains' front as the folds there run: a crest,
spurs from it and small spurs from those. A road keeps one height along the front: its way is the cheapest path that stays near
that height. A ledge runs below the road, two slopes are roughened, and it rains on the ridge.
"""

import heapq
import json
import math
import random
import sys

import numpy as np
from scipy.ndimage import gaussian_filter

SPACING_M = 25.401579576894903
ROAD_HEIGHT_M = 700.0
ROAD_FROM_PX, ROAD_TO_PX = (96, 404), (596, 372)


def rounded(points):
    return [[round(x), round(z)] + ([round(p, 2)] if p < 0.995 else []) for x, z, p in points]


def stroke(brush, points, **more):
    return {"op": "stroke", "brush": brush, "points": rounded(points), **more}


def resampled(points, step):
    """Places at equal distances along a polyline."""
    points = np.asarray(points, float)
    lengths = np.r_[0, np.cumsum(np.hypot(*np.diff(points, axis=0).T))]
    places = np.linspace(0, lengths[-1], max(2, round(lengths[-1] / step) + 1))
    return np.stack([np.interp(places, lengths, points[:, k]) for k in (0, 1)], axis=1)


def smoothed(points, sigma, step):
    """A polyline without its small bends; the ends stay."""
    points = resampled(points, step)
    reach = math.ceil(3 * sigma / step)
    padded = np.concatenate(
        [2 * points[0] - points[reach:0:-1], points, 2 * points[-1] - points[-2 : -reach - 2 : -1]]
    )
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) * step / sigma) ** 2)
    weights /= weights.sum()
    return np.stack([np.convolve(padded[:, k], weights, "valid") for k in (0, 1)], axis=1)


def ridge(rng):
    """A crest with spurs, as strokes of `raise`."""
    along = resampled([(3300, 5450), (6900, 4650), (10300, 5000), (13700, 4250)], 450)
    wander = np.convolve(rng.normal(0, 750, len(along) + 4), np.ones(5) / 5, "valid")
    crest = along + np.stack([0.4 * wander, wander], axis=1)
    rise = np.sin(np.linspace(0.12, math.pi - 0.12, len(crest))) ** 0.6
    bumps = 1 + np.convolve(rng.normal(0, 0.34, len(crest) + 2), np.ones(3) / 3, "valid")
    height = np.clip(rise * bumps, 0.12, None)
    height /= height.max()

    foot = {"type": "raise", "radius": 2100, "profile": "gauss", "strength": 300, "pressure": "both"}
    body = {"type": "raise", "radius": 1400, "profile": "power", "power": 0.6, "strength": 540}
    edge = {"type": "raise", "radius": 420, "profile": "tip", "strength": 130}
    strokes = [stroke(brush, np.c_[crest, height]) for brush in (foot, body, edge)]
    for k in range(1, len(crest) - 1):
        direction = crest[k + 1] - crest[k - 1]
        across = np.array([-direction[1], direction[0]]) / np.hypot(*direction)
        for side in (-1, 1):
            if rng.random() < 0.1:
                continue
            start = crest[k] + rng.normal(0, 90, 2)
            lean = rng.normal(0, 0.3)
            strokes += spur(rng, start, math.atan2(*(side * across)[::-1]) + lean, height[k])
    return strokes


def spur(rng, start, angle, height):
    """A spur from a crest down to the plain, with small spurs."""
    length = (900 + 1500 * height) * rng.uniform(0.8, 1.2)
    points, bend = [start], 0.0
    steps = max(4, round(length / 260))
    for _ in range(steps):
        bend = 0.6 * bend + rng.normal(0, 0.17)
        points.append(points[-1] + length / steps * np.array([math.cos(angle + bend), math.sin(angle + bend)]))
    t = np.linspace(0, 1, steps + 1)
    fall = np.sin(math.pi * np.clip(0.25 + 0.75 * t, 0, 1)) ** 0.9 * (0.35 + 0.65 * height)
    brush = {"type": "raise", "radius": 380, "profile": "power", "power": 0.5, "strength": round(200 * rng.uniform(0.8, 1.2))}
    strokes = [stroke(brush, np.c_[points, np.clip(fall, 0.02, 1)])]
    for k in range(2, steps - 1):
        turn = angle + rng.choice([-1, 1]) * rng.uniform(0.6, 1.0)
        twig_length = 620 * rng.uniform(0.7, 1.3) * (0.5 + 0.5 * height)
        twig = [points[k] + s * twig_length * np.array([math.cos(turn), math.sin(turn)]) for s in (0, 0.5, 1)]
        small = {"type": "raise", "radius": 190, "profile": "power", "power": 0.5, "strength": round(70 * (0.5 + 0.5 * height))}
        strokes.append(stroke(small, np.c_[twig, [0.8, 1.0, 0.1]]))
    return strokes


def cheapest_path(cost, start, end):
    """Dijkstra over the eight neighbours; places are (x, z) in samples."""
    depth, width = cost.shape
    best, before, queue = {start: 0.0}, {}, [(0.0, start)]
    while queue:
        spent, (x, z) = heapq.heappop(queue)
        if (x, z) == end:
            break
        if spent > best[x, z]:
            continue
        for dx, dz in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            there = (x + dx, z + dz)
            if 0 <= there[0] < width and 0 <= there[1] < depth:
                total = spent + math.hypot(dx, dz) * 0.5 * (cost[z, x] + cost[there[1], there[0]])
                if total < best.get(there, math.inf):
                    best[there], before[there] = total, (x, z)
                    heapq.heappush(queue, (total, there))
    path = [end]
    while path[-1] != start:
        path.append(before[path[-1]])
    return path[::-1]


def road(heights):
    """A way along the mountains' front that keeps its height, and the ledge below it."""
    ground = gaussian_filter(heights, 2)
    cost = 1 + ((ground - ROAD_HEIGHT_M) / 25) ** 2
    path = np.array(cheapest_path(cost, ROAD_FROM_PX, ROAD_TO_PX), float) * SPACING_M
    way = resampled(smoothed(path, 130, 40), 150)[4:-4]
    full = np.ones(len(way))
    level = {"type": "level", "radius": 130, "falloff": 70, "height": ROAD_HEIGHT_M, "blending": "wash"}
    part = way[len(way) // 3 : 2 * len(way) // 3]
    ahead = np.gradient(smoothed(part, 400, 150), axis=0)
    ahead /= np.hypot(*ahead.T)[:, None]
    below = smoothed(part[: len(ahead)] + 330 * np.c_[ahead[:, 1], -ahead[:, 0]], 200, 150)
    ledge = {"type": "ledge", "radius": 170, "falloff": 80, "strength": 45, "direction": "raise"}
    return [
        stroke(ledge, np.c_[below, np.ones(len(below))]),
        stroke(level, np.c_[way, full]),
    ]


def roughened():
    """The new ridge gets the grain of old ground; a slope beside the road becomes scree."""
    grain = {"type": "roughen", "radius": 2300, "falloff": 1200, "strength": 4}
    scree = {"type": "roughen", "radius": 800, "falloff": 500, "strength": 14}
    return [
        stroke(grain, [(3900, 5300, 1), (7500, 4800, 1), (10500, 4900, 1), (13300, 4400, 1)], seed=3),
        stroke(scree, [(10600, 9400, 1), (11700, 10600, 1), (12400, 11800, 1)], seed=5),
    ]


def rained_upon():
    """Rain cuts gullies into the new ridge and lays down fans at its foot."""
    rain = {"type": "erode_fluvial", "radius": 2400, "falloff": 900, "iterations": 150, "blending": "wash"}
    return [stroke(rain, [(3900, 5300, 1), (7500, 4800, 1), (10500, 4900, 1), (13300, 4400, 1)])]


def main():
    heights = np.load(sys.argv[1])
    operations = ridge(np.random.default_rng(2)) + road(heights) + roughened() + rained_upon()
    print('{"operations": [')
    print(",\n".join(json.dumps(operation) for operation in operations))
    print("]}")


main()
