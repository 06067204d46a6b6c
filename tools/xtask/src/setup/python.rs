//! Pythons of their own: one with what the service's clients and their tests work by, where tests whose modules are not there skip
//! themselves; one with the libraries that benchmarks run beside.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::apt;
use crate::cargo::{scratch_folder, status, succeeds};

/// A package, and the module by which it is known to be there.
type Package = (&'static str, &'static str);

const OF_CLIENTS: [Package; 9] = [
    ("numpy", "numpy"),
    ("httpx", "httpx"),
    ("websockets", "websockets"),
    ("aiohttp", "aiohttp"),
    ("pytest", "pytest"),
    ("pytest-asyncio", "pytest_asyncio"),
    ("hypothesis", "hypothesis"),
    ("schemathesis", "schemathesis"),
    ("playwright", "playwright"),
];

/// Blender as a module: 350 MB, for the long tests alone.
const BLENDER: Package = ("bpy", "bpy");

/// What a user would take instead: filters and pyramids, pictures, rasters.
const OF_BENCHMARKS: [Package; 4] =
    [("numpy", "numpy"), ("opencv-python-headless", "cv2"), ("pillow", "PIL"), ("rasterio", "rasterio")];

/// See [`super::python()`].
pub fn python(is_long: bool) -> Option<PathBuf> {
    match make("python", &OF_CLIENTS) {
        Ok((python, said)) => {
            println!("test tools: Python for the service's clients {said}");
            if is_long
                && !has(&python, BLENDER)
                && !install(&python, &[BLENDER.0]).is_ok_and(|is_there| is_there)
            {
                println!("test tools: the tests of the Blender add-on will skip: pip could not install bpy");
            }
            Some(python)
        }
        Err(err) => {
            println!("test tools: the tests of the service's clients will skip: {err:#}");
            None
        }
    }
}

/// See [`super::bench_python()`].
pub fn bench_python() -> Option<PathBuf> {
    match make("bench-python", &OF_BENCHMARKS) {
        Ok((python, said)) => {
            println!("benchmarks: Python with OpenCV, Pillow and GDAL {said}");
            Some(python)
        }
        Err(err) => {
            println!("benchmarks: nothing of Python's will be measured: {err:#}");
            None
        }
    }
}

fn has(python: &Path, (_, module): Package) -> bool {
    succeeds(Command::new(python).args(["-c", &format!("import {module}")]))
}

/// An environment with packages, made where it is not there.
fn make(name: &str, packages: &[Package]) -> anyhow::Result<(PathBuf, &'static str)> {
    let folder = scratch_folder()?.join(name);
    let python = folder.join("bin/python");
    let is_complete = packages.iter().all(|package| has(&python, *package));
    if !is_complete {
        if !python.exists() && !make_environment(&folder)? {
            apt::install(&["python3-venv"], "Python's venv with this system's package manager")?;
            anyhow::ensure!(make_environment(&folder)?, "`python3 -m venv` failed");
        }
        let packages: Vec<_> = packages.iter().map(|(package, _)| *package).collect();
        anyhow::ensure!(install(&python, &packages)?, "pip could not install {}", packages.join(", "));
    }
    Ok((python, if is_complete { "is there" } else { "is made" }))
}

fn make_environment(folder: &Path) -> anyhow::Result<bool> {
    println!("$ python3 -m venv {}", folder.display());
    Ok(status(Command::new("python3").args(["-m", "venv"]).arg(folder))?.success())
}

fn install(python: &Path, packages: &[&str]) -> anyhow::Result<bool> {
    println!("$ {} -m pip install {}", python.display(), packages.join(" "));
    let options = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-input"];
    Ok(status(Command::new(python).args(options).args(packages))?.success())
}
