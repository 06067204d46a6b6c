//! Packages of Debian and its kin, installed by apt.

use std::process::{Command, Stdio};

use anyhow::{Context as _, ensure};

use crate::cargo::{status, succeeds};

/// Installs packages. Where there is no apt, `by_other_means` says what to install how.
///
/// # Errors
///
/// They cannot be installed; the message holds the line that does it.
pub fn install(packages: &[&'static str], by_other_means: &str) -> anyhow::Result<()> {
    let is_root = {
        use std::os::unix::fs::MetadataExt as _;
        std::fs::metadata("/proc/self").is_ok_and(|process| process.uid() == 0)
    };
    let has_apt = succeeds(Command::new("apt-get").arg("--version"));
    ensure!(has_apt, "there is no apt-get here; install {by_other_means}");
    let by_hand = format!("sudo apt-get update && sudo apt-get install --yes {}", packages.join(" "));
    let may_install = is_root || succeeds(Command::new("sudo").args(["-n", "true"]));
    ensure!(may_install, "no right to install packages; run this line, then try again:\n\n    {by_hand}\n");

    let [update, install] = commands(is_root, packages);
    if !run_words(&update)? {
        println!("apt-get update failed; trying with the package lists that are there");
    }
    ensure!(run_words(&install)?, "apt-get could not install the packages; by hand: {by_hand}");
    Ok(())
}

/// `apt-get update` and `apt-get install`, asking nothing, waiting for another package manager to finish.
fn commands(is_root: bool, packages: &[&'static str]) -> [Vec<&'static str>; 2] {
    let mut apt = if is_root { Vec::new() } else { vec!["sudo", "-n"] };
    apt.extend(["env", "DEBIAN_FRONTEND=noninteractive", "apt-get"]);
    apt.extend(["-o", "DPkg::Lock::Timeout=300", "-o", "Acquire::Retries=3"]);
    let mut install = apt.clone();
    install.extend(["install", "--yes", "--no-install-recommends"]);
    install.extend(packages);
    apt.push("update");
    [apt, install]
}

fn run_words(words: &[&str]) -> anyhow::Result<bool> {
    println!("$ {}", words.join(" "));
    let (program, args) = words.split_first().context("an empty command")?;
    Ok(status(Command::new(program).args(args).stdin(Stdio::null()))?.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn apt_asks_nothing_and_root_needs_no_sudo() {
        for is_root in [true, false] {
            let [update, install] = commands(is_root, &["one", "two"]);
            assert_eq!(update.first() == Some(&"sudo"), !is_root);
            assert_eq!(update.last(), Some(&"update"));
            assert!(install.ends_with(&["--yes", "--no-install-recommends", "one", "two"]));
            for words in [update, install] {
                assert!(words.contains(&"DEBIAN_FRONTEND=noninteractive"), "{words:?}");
                assert!(is_root || words.starts_with(&["sudo", "-n"]), "{words:?}");
            }
        }
    }
}
