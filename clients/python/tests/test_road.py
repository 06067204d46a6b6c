from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
import road

from orogeny import Heights


def hills() -> Heights:
    z, x = np.mgrid[0:400, 0:400] * 2.0
    return Heights((20 * np.sin(x / 60) * np.cos(z / 80)).astype(np.float32), 0, 0, 2)


def test_a_plan_keeps_to_grade_and_ends() -> None:
    args = road.arguments(["http://h", "--max-grade", "6", "--width", "10"])
    plan = road.plan(road.across(800, 800), hills(), args)
    grades = np.abs(np.diff(plan.heights) / np.diff(plan.along))
    assert grades.max() <= 0.06 + 1e-9
    assert np.allclose(plan.line[[0, -1]], road.across(800, 800)[[0, -1]])
    assert np.abs(np.diff(plan.ground) / np.diff(plan.along)).max() > 0.2


def test_strokes_are_ramps_from_one_to_the_next() -> None:
    args = road.arguments(["http://h", "--layer", "Road"])
    plan = road.plan(road.across(800, 800), hills(), args)
    strokes = road.operations(plan, args.layer)
    assert {stroke["brush"]["type"] for stroke in strokes} == {"ramp"}
    assert all(stroke["layer"] == "Road" for stroke in strokes)
    for one, other in itertools.pairwise(strokes):
        assert one["points"][1] == other["points"][0]
        assert one["brush"]["end_height"] == other["brush"]["height"]


def test_points_come_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "road.csv"
    file.write_text("x,z\n1,2\n\n# a note\n3.5,4,ignored\n")
    assert road.read_points(file).tolist() == [[1, 2], [3.5, 4]]
    file.write_text("x,z\n")
    assert road.read_points(file).shape == (0, 2)


def test_wrong_use_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        road.arguments(["http://h", "--width", "-3"])
    assert "--width is above 0" in capsys.readouterr().err
    assert road.main(["http://127.0.0.1:9", "t"]) == 1
    assert "error: http://127.0.0.1:9" in capsys.readouterr().err
