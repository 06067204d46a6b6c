"""Makes the extension `dist/orogeny_blender-VERSION.zip`: the add-on, and the parts of the Python client that it uses.

    python build.py [FOLDER]

With a FOLDER the add-on is laid out there instead, as Blender would unpack it.
"""

from __future__ import annotations

import re
import shutil
import sys
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ADDON = HERE / "orogeny_blender"
CLIENT = HERE.parent / "python" / "src" / "orogeny"
# What the client is made of, apart from how it is sent: no more than NumPy, which Blender has.
SHARED = ["calls", "errors", "frames", "grid", "heights", "messages", "mirror", "operations", "results"]


def lay_out(folder: Path) -> Path:
    """Put the add-on into `folder/orogeny_blender`."""
    target = folder / "orogeny_blender"
    if target.exists():
        shutil.rmtree(target)
    shutil.copytree(ADDON, target, ignore=shutil.ignore_patterns("__pycache__"))
    core = target / "core"
    core.mkdir()
    (core / "__init__.py").write_text(
        '"""The parts of the Python client that need only NumPy, copied by build.py."""\n'
    )
    for name in SHARED:
        shutil.copy(CLIENT / f"{name}.py", core)
    for name in ("LICENSE-MIT", "LICENSE-APACHE"):
        shutil.copy(HERE / name, target)
    return target


def pack(folder: Path) -> Path:
    """Make the archive: the same files make the same bytes."""
    manifest = (ADDON / "blender_manifest.toml").read_text()
    version = re.search(r'^version = "(.*)"', manifest, re.MULTILINE)
    assert version is not None
    addon = lay_out(folder / "build")
    archive = folder / "dist" / f"orogeny_blender-{version[1]}.zip"
    archive.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as file:
        for path in sorted(addon.rglob("*")):
            if path.is_file():
                entry = zipfile.ZipInfo(path.relative_to(addon).as_posix(), (2020, 1, 1, 0, 0, 0))
                entry.compress_type = zipfile.ZIP_DEFLATED
                entry.external_attr = 0o644 << 16
                file.writestr(entry, path.read_bytes())
    return archive


if __name__ == "__main__":
    print(lay_out(Path(sys.argv[1])) if len(sys.argv) > 1 else pack(HERE))
