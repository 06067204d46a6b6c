"""The archive, installed by Blender itself as an extension, into a folder of its own."""

from __future__ import annotations

import os
import subprocess
import sys

SCRIPT = """
import sys, bpy, addon_utils
bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True)
assert "bl_ext.user_default.orogeny_blender" in bpy.context.preferences.addons
for url, said in (("http://127.0.0.1:9", "refused"), ("http://terrain.invalid", "offline")):
    try:
        bpy.ops.orogeny.connect(url=url)
    except RuntimeError as error:
        assert said in str(error), error
    else:
        raise AssertionError(url)
addon_utils.disable("bl_ext.user_default.orogeny_blender")
assert not hasattr(bpy.types.Scene, "orogeny")
print("as it should be")
"""


def test_blender_installs_it(tmp_path) -> None:
    import build

    archive = build.pack(tmp_path)
    assert archive.read_bytes() == build.pack(tmp_path / "again").read_bytes()
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "blender")}
    command = [sys.executable, "-c", SCRIPT, str(archive)]
    ran = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=False)
    assert "as it should be" in ran.stdout, ran.stdout + ran.stderr
