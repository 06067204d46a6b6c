//! Running other programs, cargo above all, and where this workspace's folders are.

use std::path::PathBuf;
use std::process::{Command, ExitStatus, Stdio};

use anyhow::Context as _;

/// The folder of the workspace's `Cargo.toml`.
pub fn workspace_root() -> PathBuf {
    // Asked at run time first: a checkout may be moved after xtask was built.
    let package = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
    let mut root = PathBuf::from(package);
    root.pop();
    root.pop();
    root
}

/// A folder for xtask's own short-lived files, made if it is not there.
///
/// # Errors
///
/// The folder cannot be made.
pub fn scratch_folder() -> anyhow::Result<PathBuf> {
    let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    let folder = workspace_root().join(target).join("xtask");
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    Ok(folder)
}

/// A folder for `XDG_RUNTIME_DIR` that only this user may enter: without one, some drivers complain each time they are
/// loaded.
///
/// # Errors
///
/// The folder cannot be made.
pub fn private_runtime_folder() -> anyhow::Result<PathBuf> {
    let folder = scratch_folder()?.join("runtime");
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o700))
            .with_context(|| format!("cannot make the folder {} private", folder.display()))?;
    }
    Ok(folder)
}

/// The cargo that runs xtask, in the workspace's root, with these arguments.
pub fn cargo<const N: usize>(args: [&str; N]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(args).current_dir(workspace_root());
    command
}

/// Runs a command to its end, its output going where xtask's own goes.
///
/// # Errors
///
/// The program cannot be started. That it fails is not an error here: see the status.
pub fn status(command: &mut Command) -> anyhow::Result<ExitStatus> {
    command.status().with_context(|| format!("cannot start {}", command.get_program().display()))
}

/// Whether a command can be started and succeeds; it runs unseen, with no input.
pub fn succeeds(command: &mut Command) -> bool {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_holds_the_workspace() {
        let manifest = std::fs::read_to_string(workspace_root().join("Cargo.toml")).unwrap();
        assert!(manifest.contains("[workspace]"), "{manifest}");
    }

    #[test]
    fn success_is_told_from_failure_and_absence() {
        assert!(succeeds(&mut cargo(["--version"])));
        assert!(!succeeds(&mut cargo(["no-such-subcommand-of-cargo"])));
        assert!(!succeeds(&mut Command::new("no-such-program-anywhere")));
    }
}
