"""The add-on as it is packed, in the `bpy` module; against a stand-in for the service, or a running one."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
PYTHON = HERE.parent.parent / "python"
sys.path[:0] = [str(HERE.parent), str(PYTHON / "src"), str(PYTHON / "tests")]

try:
    import bpy
except ImportError:
    bpy = None


def pytest_report_header() -> str:
    return f"Blender {bpy.app.version_string}" if bpy else "NO bpy: nothing of the add-on is tested (pip install bpy)"


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    return True if bpy is None and collection_path.name.startswith("test_") else None


@pytest.fixture(scope="session")
def addon(tmp_path_factory: pytest.TempPathFactory):
    import build

    folder = build.lay_out(tmp_path_factory.mktemp("addon"))
    sys.path.insert(0, str(folder.parent))
    import orogeny_blender

    assert Path(orogeny_blender.__file__).parent == folder
    orogeny_blender.register()
    yield orogeny_blender
    orogeny_blender.unregister()


@pytest.fixture
def scene(addon) -> Iterator[object]:
    """An empty scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    # Factory settings unload add-ons that are not among the preferences', and this one is not.
    if not hasattr(bpy.types.Scene, "orogeny"):
        addon.register()
    yield bpy.context.scene
    addon.session.disconnect()


@pytest.fixture
def fake():
    from fake_service import FakeService

    with FakeService() as service:
        yield service


@pytest.fixture
def service_url() -> str:
    url = os.environ.get("OROGENY_SERVICE_URL")
    if not url:
        pytest.skip("OROGENY_SERVICE_URL names no running service: integration tests are NOT run")
    return url


@pytest.fixture
def service_token() -> str:
    return os.environ.get("OROGENY_SERVICE_TOKEN", "")
