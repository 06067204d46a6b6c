//! Linux: the Vulkan loader and lavapipe, Mesa's software Vulkan driver, found by looking and installed by apt.
//!
//! Found means what the loader itself would find: a driver manifest in the folders it reads, naming a library that is
//! there. Nothing is loaded, so that a broken driver cannot take xtask down.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::bail;

use super::{Need, apt};

const LOADER: &str = "libvulkan.so.1";
const LAVAPIPE: &str = "libvulkan_lvp.so";
const PACKAGES: [&str; 2] = ["libvulkan1", "mesa-vulkan-drivers"];
const BY_OTHER_MEANS: &str = "a Vulkan loader and Mesa's lavapipe with this system's package manager (Fedora: \
    vulkan-loader mesa-vulkan-drivers; Arch: vulkan-icd-loader vulkan-swrast)";

/// See [`super::graphics`].
pub fn graphics(need: Need) -> anyhow::Result<()> {
    let missing = match Search::of_this_machine().find() {
        Ok(manifest) => {
            println!("graphics: Vulkan loader and lavapipe are there ({})", manifest.display());
            return Ok(());
        }
        Err(missing) => missing,
    };
    if need == Need::Optional {
        println!(
            "graphics: {missing} is missing; the CPU back end needs none (`cargo xtask setup` installs it)"
        );
        return Ok(());
    }
    println!("graphics: {missing} is missing");
    apt::install(&PACKAGES, BY_OTHER_MEANS)?;
    match Search::of_this_machine().find() {
        Ok(manifest) => println!("graphics: installed ({})", manifest.display()),
        Err(missing) => {
            bail!("{} are installed, but {missing} is still not found{}", PACKAGES.join(" and "), hint())
        }
    }
    Ok(())
}

/// What can hide an installed driver.
fn hint() -> &'static str {
    if driver_override().is_some() {
        ": VK_DRIVER_FILES or VK_ICD_FILENAMES is set and names no lavapipe"
    } else {
        ""
    }
}

/// Where the Vulkan loader looks for itself and for drivers.
struct Search {
    /// Driver manifests, or folders of them.
    manifests: Vec<PathBuf>,
    /// Libraries known to the dynamic linker.
    libraries: Vec<PathBuf>,
    /// Folders of libraries.
    library_folders: Vec<PathBuf>,
}

impl Search {
    fn of_this_machine() -> Self {
        let manifests = driver_override().map_or_else(standard_manifest_folders, |value| split(&value));
        let added = std::env::var_os("VK_ADD_DRIVER_FILES").map(|value| split(&value)).unwrap_or_default();
        let arch = std::env::consts::ARCH;
        let mut library_folders =
            std::env::var_os("LD_LIBRARY_PATH").map(|value| split(&value)).unwrap_or_default();
        let usual = [format!("/usr/lib/{arch}-linux-gnu"), format!("/lib/{arch}-linux-gnu")];
        library_folders.extend(usual.map(PathBuf::from));
        library_folders.extend(["/usr/local/lib", "/usr/lib64", "/usr/lib"].map(PathBuf::from));
        Self {
            manifests: manifests.into_iter().chain(added).collect(),
            libraries: linker_cache(),
            library_folders,
        }
    }

    /// The manifest of a lavapipe that the loader can load, or what is missing for that.
    fn find(&self) -> Result<PathBuf, &'static str> {
        let loader = self.library(LOADER);
        match (loader, self.lavapipe()) {
            (Some(_), Some(manifest)) => Ok(manifest),
            (None, Some(_)) => Err("the Vulkan loader"),
            (Some(_), None) => Err("lavapipe, the software Vulkan driver,"),
            (None, None) => Err("a Vulkan driver"),
        }
    }

    fn lavapipe(&self) -> Option<PathBuf> {
        self.manifests
            .iter()
            .flat_map(|path| if path.is_dir() { json_files(path) } else { vec![path.clone()] })
            .find(|manifest| self.is_working_lavapipe(manifest))
    }

    /// Whether a manifest names lavapipe's library, and that library is there.
    fn is_working_lavapipe(&self, manifest: &Path) -> bool {
        let Some(library) = library_path(manifest) else { return false };
        if library.file_name().is_none_or(|name| name != LAVAPIPE) {
            return false;
        }
        // A bare name is looked up by the dynamic linker, a path is the manifest's.
        match library.parent() {
            Some(folder) if folder.as_os_str().is_empty() => self.library(LAVAPIPE).is_some(),
            _ => manifest.parent().is_some_and(|folder| folder.join(&library).is_file()),
        }
    }

    fn library(&self, name: &str) -> Option<PathBuf> {
        let cached = self.libraries.iter().find(|path| path.file_name().is_some_and(|found| found == name));
        let in_folders = || self.library_folders.iter().map(|folder| folder.join(name));
        cached.cloned().into_iter().chain(in_folders()).find(|path| path.is_file())
    }
}

/// `ICD.library_path` of a driver manifest; `None` where the file is not one.
fn library_path(manifest: &Path) -> Option<PathBuf> {
    let text = std::fs::read_to_string(manifest).ok()?;
    let json: serde_json::Value = serde_json::from_str(&text).ok()?;
    Some(json.get("ICD")?.get("library_path")?.as_str()?.into())
}

fn json_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<_> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|ext| ext == "json"))
        .collect();
    files.sort();
    files
}

/// The user's own choice of drivers: the loader then reads no folder at all.
fn driver_override() -> Option<OsString> {
    ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"]
        .into_iter()
        .find_map(std::env::var_os)
        .filter(|value| !value.is_empty())
}

/// The folders of the loader's documentation ("Driver Discovery on Linux").
fn standard_manifest_folders() -> Vec<PathBuf> {
    let home = std::env::var_os("HOME").map(PathBuf::from).unwrap_or_default();
    let user = |name: &str, default: &str| {
        vec![std::env::var_os(name).map_or_else(|| home.join(default), PathBuf::from)]
    };
    let system = |name: &str, default: &str| split(&std::env::var_os(name).unwrap_or_else(|| default.into()));
    let roots = [
        user("XDG_CONFIG_HOME", ".config"),
        system("XDG_CONFIG_DIRS", "/etc/xdg"),
        vec![PathBuf::from("/etc")],
        user("XDG_DATA_HOME", ".local/share"),
        system("XDG_DATA_DIRS", "/usr/local/share:/usr/share"),
        vec![PathBuf::from("/usr/share")], // XDG_DATA_DIRS of some containers leaves it out, loaders read it all the same
    ];
    roots.into_iter().flatten().map(|root| root.join("vulkan").join("icd.d")).collect()
}

fn split(paths: &std::ffi::OsStr) -> Vec<PathBuf> {
    std::env::split_paths(paths).filter(|path| !path.as_os_str().is_empty()).collect()
}

/// The libraries of `ldconfig -p`; none where there is no ldconfig.
fn linker_cache() -> Vec<PathBuf> {
    ["ldconfig", "/sbin/ldconfig", "/usr/sbin/ldconfig"]
        .iter()
        .find_map(|program| Command::new(program).arg("-p").stdin(Stdio::null()).output().ok())
        .map(|output| libraries_of_cache(&String::from_utf8_lossy(&output.stdout)))
        .unwrap_or_default()
}

/// The right-hand sides of lines such as `libvulkan.so.1 (libc6,x86-64) => /lib/x86_64-linux-gnu/libvulkan.so.1`.
fn libraries_of_cache(text: &str) -> Vec<PathBuf> {
    text.lines().filter_map(|line| Some(line.split_once(" => ")?.1.trim().into())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A machine in a folder: manifests in `icd.d`, libraries in `lib`.
    struct Machine {
        folder: tempfile::TempDir,
    }

    impl Machine {
        fn new(libraries: &[&str]) -> Self {
            let folder = tempfile::tempdir().unwrap();
            for name in ["icd.d", "lib"] {
                std::fs::create_dir(folder.path().join(name)).unwrap();
            }
            for library in libraries {
                std::fs::write(folder.path().join("lib").join(library), "").unwrap();
            }
            Self { folder }
        }

        fn with_manifest(self, name: &str, text: &str) -> Self {
            std::fs::write(self.path("icd.d").join(name), text).unwrap();
            self
        }

        fn with_driver(self, library_path: &str) -> Self {
            let text =
                format!(r#"{{"file_format_version": "1.0.1", "ICD": {{"library_path": "{library_path}"}}}}"#);
            self.with_manifest("lvp_icd.json", &text)
        }

        fn path(&self, name: &str) -> PathBuf {
            self.folder.path().join(name)
        }

        fn search(&self) -> Search {
            Search {
                manifests: vec![self.path("icd.d")],
                libraries: vec![],
                library_folders: vec![self.path("lib")],
            }
        }
    }

    #[test]
    fn a_manifest_and_both_libraries_are_enough() {
        let machine = Machine::new(&[LOADER, LAVAPIPE]).with_driver(LAVAPIPE);
        assert_eq!(machine.search().find(), Ok(machine.path("icd.d").join("lvp_icd.json")));

        let by_absolute_path = machine.path("lib").join(LAVAPIPE).display().to_string();
        assert!(Machine::new(&[LOADER]).with_driver(&by_absolute_path).search().find().is_ok());
        assert!(
            Machine::new(&[LOADER, LAVAPIPE]).with_driver("../lib/libvulkan_lvp.so").search().find().is_ok()
        );
    }

    #[test]
    fn the_linker_cache_and_a_named_manifest_count_too() {
        let machine = Machine::new(&[LOADER, LAVAPIPE]).with_driver(LAVAPIPE);
        let search = Search {
            manifests: vec![machine.path("icd.d").join("lvp_icd.json")],
            libraries: [LOADER, LAVAPIPE].map(|name| machine.path("lib").join(name)).to_vec(),
            library_folders: vec![],
        };
        assert!(search.find().is_ok());
    }

    #[test]
    fn what_is_missing_is_named() {
        let loader_only = Machine::new(&[LOADER]);
        assert!(loader_only.search().find().unwrap_err().contains("lavapipe"));
        let driver_only = Machine::new(&[LAVAPIPE]).with_driver(LAVAPIPE);
        assert!(driver_only.search().find().unwrap_err().contains("loader"));
        assert!(Machine::new(&[]).search().find().is_err());
    }

    #[test]
    fn a_manifest_that_does_not_lead_to_lavapipe_does_not_count() {
        for library in ["libvulkan_radeon.so", "/nowhere/libvulkan_lvp.so", "", "/"] {
            let machine = Machine::new(&[LOADER, LAVAPIPE]).with_driver(library);
            assert!(machine.search().find().is_err(), "{library}");
        }
        for text in ["", "libvulkan_lvp.so", "[]", r#"{"ICD": {}}"#, r#"{"ICD": {"library_path": 3}}"#] {
            let machine = Machine::new(&[LOADER, LAVAPIPE]).with_manifest("lvp_icd.json", text);
            assert!(machine.search().find().is_err(), "{text}");
        }
        let uninstalled = Machine::new(&[LOADER]).with_driver(LAVAPIPE);
        assert!(uninstalled.search().find().is_err());
        let machine = Machine::new(&[LOADER, LAVAPIPE])
            .with_manifest("lvp_icd.json.disabled", r#"{"ICD": {"library_path": "libvulkan_lvp.so"}}"#);
        assert!(machine.search().find().is_err());
    }

    #[test]
    fn a_library_in_the_cache_but_not_on_disk_does_not_count() {
        let search = Search {
            manifests: vec![],
            libraries: vec!["/nowhere/libvulkan.so.1".into()],
            library_folders: vec![],
        };
        assert_eq!(search.library(LOADER), None);
    }

    #[test]
    fn ldconfig_output_is_read() {
        let text = "2 libs found in cache `/etc/ld.so.cache'\n\
            \tlibvulkan.so.1 (libc6,x86-64) => /lib/x86_64-linux-gnu/libvulkan.so.1\n\
            \tlibz.so.1 (libc6,x86-64) => /lib/x86_64-linux-gnu/libz.so.1\n\
            Cache generated by: ldconfig (Debian GLIBC) stable release version 2.36\n";
        let expected = ["/lib/x86_64-linux-gnu/libvulkan.so.1", "/lib/x86_64-linux-gnu/libz.so.1"];
        assert_eq!(libraries_of_cache(text), expected.map(PathBuf::from));
    }
}
