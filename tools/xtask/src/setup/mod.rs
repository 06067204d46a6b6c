//! `setup`: installs what the other commands need and a fresh machine lacks.
//!
//! What only one operating system has sits in modules of its own ([`linux`], [`mod@test_tools`]); elsewhere nothing is installed,
//! since the system brings its graphics driver along.

#[cfg(target_os = "linux")]
mod apt;
mod components;
#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
mod python;
#[cfg(target_os = "linux")]
mod test_tools;

use std::process::ExitCode;

pub use components::component;

/// How badly a command needs a Vulkan driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Need {
    /// Without one, the command cannot do its work: one is installed, or the command fails.
    Required,
    /// The command works without one, on the CPU: it is only told.
    Optional,
}

/// Installs everything that is missing.
///
/// # Errors
///
/// Something cannot be installed; the message holds the line that does it.
pub fn run() -> anyhow::Result<ExitCode> {
    graphics(Need::Required)?;
    test_tools();
    python(false);
    for name in ["rustfmt", "clippy"] {
        component(name)?;
    }
    println!("everything is set up");
    Ok(ExitCode::SUCCESS)
}

/// Sees to a graphics driver that needs no GPU, as far as it is needed.
///
/// # Errors
///
/// The driver is required, missing, and cannot be installed.
#[cfg(target_os = "linux")]
pub fn graphics(need: Need) -> anyhow::Result<()> {
    linux::graphics(need)
}

/// Says which adapter will be used; there is nothing to install.
///
/// # Errors
///
/// None: the signature is the same on every system.
#[cfg(not(target_os = "linux"))]
pub fn graphics(_need: Need) -> anyhow::Result<()> {
    let adapter = if cfg!(target_os = "macos") {
        "the Metal adapter of this Mac"
    } else if cfg!(target_os = "windows") {
        "a Direct3D 12 adapter (WARP, the software one, where there is no GPU)"
    } else {
        "whichever adapter the system offers"
    };
    println!("graphics: nothing to install; GPU work uses {adapter}");
    Ok(())
}

/// Sees to the programs that some tests work by, and without which they skip themselves: that is told and no failure.
#[cfg(target_os = "linux")]
pub fn test_tools() {
    test_tools::test_tools();
}

/// Sees to a Python in which the service's clients and their tests run, and gives it; for long tests, with Blender as a module. Without it those
/// tests skip themselves: that is told and no failure.
#[cfg(target_os = "linux")]
pub fn python(is_long: bool) -> Option<std::path::PathBuf> {
    python::python(is_long)
}

/// Sees to a Python with the libraries that benchmarks run beside, and gives it; without it their rows are left out: that is told and no
/// failure.
#[cfg(target_os = "linux")]
pub fn bench_python() -> Option<std::path::PathBuf> {
    python::bench_python()
}

/// Elsewhere it is the user's to give.
#[cfg(not(target_os = "linux"))]
pub const fn bench_python() -> Option<std::path::PathBuf> {
    None
}

/// Tests that need other programs run on Linux only.
#[cfg(not(target_os = "linux"))]
pub const fn python(_is_long: bool) -> Option<std::path::PathBuf> {
    None
}

/// Tests that need other programs run on Linux only.
#[cfg(not(target_os = "linux"))]
pub const fn test_tools() {}

/// Sees to valgrind, and says whether it is there.
#[cfg(target_os = "linux")]
pub fn valgrind() -> bool {
    test_tools::valgrind()
}

/// Counting instructions needs valgrind, which is at home on Linux.
#[cfg(not(target_os = "linux"))]
pub const fn valgrind() -> bool {
    false
}
