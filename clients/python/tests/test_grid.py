from __future__ import annotations

import numpy as np
import pytest

from orogeny import FrameError, Grid, Heights, Mirror, PageFrame, Region, Samples


def test_levels_halve_and_round_up() -> None:
    grid = Grid(3601, 3000, 30)
    sizes = [(grid.samples_at(level).width, grid.samples_at(level).depth) for level in range(5)]
    assert sizes == [(3601, 3000), (1801, 1500), (901, 750), (451, 375), (226, 188)]


def test_far_edges_of_a_region_are_outside() -> None:
    grid = Grid(100, 80, 0.1)
    assert grid.samples_in((0.3, 0, 0.3, 0.1), 0) == Samples(3, 0, 6, 1)
    assert grid.samples_in((-5, -5, 500, 500), 0) == Samples(0, 0, 100, 80)
    assert grid.samples_in((0.3, 0, 0.3, 0.1), 1) == Samples(2, 0, 3, 1)
    assert grid.samples_in((50, 0, 1, 1), 0).is_empty


@pytest.mark.parametrize("region", [(0, 0, 0, 1), (0, 0, 1, -1), (float("nan"), 0, 1, 1), (0, 0, float("inf"), 1)])
def test_regions_that_are_none(region: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="region"):
        Region.of(region)


def test_empty_regions_add_nothing() -> None:
    empty, full = Region(0, 0, 0, 0), Region(5, 6, 7, 8)
    assert empty.is_empty
    assert empty.union(full) == full.union(empty) == full
    assert full.union(Region(0, 10, 1, 10)) == Region(0, 6, 12, 14)


def test_mirror_puts_pages_together() -> None:
    grid = Grid(600, 300, 2)
    whole = np.arange(600 * 300, dtype=np.float32).reshape(300, 600)
    mirror = Mirror(grid, (500, 400, 400, 300))
    assert mirror.shape == (100, 200)
    for page_z in range(2):
        for page_x in range(3):
            heights = whole[page_z * 256 : page_z * 256 + 256, page_x * 256 : page_x * 256 + 256]
            mirror.apply(PageFrame(0, page_x, page_z, 3, heights))
    assert mirror.is_complete
    now = mirror.snapshot()
    assert (now.x_m, now.z_m, now.spacing_m) == (500, 400, 2)
    assert np.array_equal(now.array, whole[200:300, 250:450])


def test_mirror_refuses_a_page_of_wrong_size() -> None:
    mirror = Mirror(Grid(600, 300, 2))
    with pytest.raises(FrameError, match="size"):
        mirror.apply(PageFrame(0, 2, 0, 1, np.zeros((256, 256), np.float32)))
    with pytest.raises(FrameError, match="size"):
        mirror.apply(PageFrame(0, 4_000_000_000, 0, 1, np.zeros((256, 256), np.float32)))
    assert mirror.apply(PageFrame(1, 0, 0, 1, np.zeros((150, 256), np.float32))) is None


def test_heights_between_samples() -> None:
    heights = Heights(np.array([[0, 10], [20, 30]], np.float32), 100, 200, 10)
    assert heights.at(100, 200) == 0
    assert heights.at(105, 200) == 5
    assert heights.at(105, 205) == 15
    assert heights.at(1000, 1000) == 30
    assert heights.region == Region(100, 200, 20, 20)
