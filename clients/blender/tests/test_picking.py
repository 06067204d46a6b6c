from __future__ import annotations

import numpy as np
import pytest


def ground() -> np.ndarray:
    z, x = np.mgrid[0:200, 0:300]
    return (10 * np.sin(x / 20) + 5 * np.cos(z / 15)).astype(np.float32)


def look(addon, origin, target):
    direction = np.array(target, float) - np.array(origin, float)
    return addon.picking.pick(ground(), 1000, 400, 2, np.array(origin, float), direction)


def test_straight_down(addon) -> None:
    place = look(addon, (1100, -500, 1000), (1100, -500, 0))
    assert place == pytest.approx((1100, 500))


def test_from_aside_meets_the_surface(addon) -> None:
    origin, target = np.array((900.0, -300.0, 80.0)), np.array((1250.0, -620.0, 0.0))
    place = look(addon, origin, target)
    share = (place.x_m - origin[0]) / (target[0] - origin[0])
    assert place.z_m == pytest.approx(300 + share * 320)
    column, row = (place.x_m - 1000) / 2, (place.z_m - 400) / 2
    height = 10 * np.sin(column / 20) + 5 * np.cos(row / 15)
    assert origin[2] + share * (target[2] - origin[2]) == pytest.approx(height, abs=0.1)


def test_what_is_missed(addon) -> None:
    assert look(addon, (900, -500, 1000), (900, -500, 0)) is None
    assert look(addon, (1100, -500, 1000), (1100, -500, 2000)) is None
    assert look(addon, (1100, -500, -1000), (1100, -500, 0)) is None
    assert look(addon, (900, -500, 50), (1600, -500, 50)) is None
