//! A Python of its own, with what the service's clients and their tests work by. Tests whose modules are not there skip themselves.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::apt;
use crate::cargo::{scratch_folder, status, succeeds};

/// Packages, and the module by which each is known to be there.
const PACKAGES: [(&str, &str); 9] = [
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
const BLENDER: (&str, &str) = ("bpy", "bpy");

/// See [`super::python()`].
pub fn python(is_long: bool) -> Option<PathBuf> {
    match make(is_long) {
        Ok((python, said)) => {
            println!("test tools: Python for the service's clients {said}");
            Some(python)
        }
        Err(err) => {
            println!("test tools: the tests of the service's clients will skip: {err:#}");
            None
        }
    }
}

fn make(is_long: bool) -> anyhow::Result<(PathBuf, &'static str)> {
    let folder = scratch_folder()?.join("python");
    let python = folder.join("bin/python");
    let has = |module: &str| succeeds(Command::new(&python).args(["-c", &format!("import {module}")]));
    let is_complete = PACKAGES.iter().all(|(_, module)| has(module));
    if !is_complete {
        if !python.exists() && !make_environment(&folder)? {
            apt::install(&["python3-venv"], "Python's venv with this system's package manager")?;
            anyhow::ensure!(make_environment(&folder)?, "`python3 -m venv` failed");
        }
        let packages = PACKAGES.map(|(package, _)| package);
        anyhow::ensure!(install(&python, &packages)?, "pip could not install {}", packages.join(", "));
    }
    if is_long && !has(BLENDER.1) && !install(&python, &[BLENDER.0])? {
        println!("test tools: the tests of the Blender add-on will skip: pip could not install bpy");
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
