//! The packages of the workspace and what they depend on, as plain data.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// One package, ours or not.
#[derive(Clone, Debug, Default)]
pub struct Package {
    /// Its folder relative to the workspace's root, `None` for a package that is not ours.
    pub folder: Option<String>,
    /// Whether it says `publish = false`.
    pub is_private: bool,
    /// Whether it takes the workspace's lints.
    pub inherits_lints: bool,
    /// Direct normal and build dependencies, by package name.
    pub dependencies: BTreeSet<String>,
    /// Direct dependencies of its tests.
    pub dev_dependencies: BTreeSet<String>,
}

/// All packages by name. Versions of one package are merged: what one reaches, all do.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    pub packages: BTreeMap<String, Package>,
}

impl Graph {
    /// The graph cargo resolves for this machine's platform; our own packages with their dependencies on every platform.
    pub fn of_workspace(root: &Path) -> Self {
        let host = run(Command::new("rustc").arg("-vV"));
        let host = host.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
        let metadata = run(Command::new(env!("CARGO"))
            .args(["metadata", "--format-version", "1", "--filter-platform", host])
            .current_dir(root));
        Self::from_metadata(&serde_json::from_str(&metadata).unwrap())
    }

    fn from_metadata(metadata: &Value) -> Self {
        let root = Path::new(metadata["workspace_root"].as_str().unwrap());
        let names: BTreeMap<&str, &str> = items(&metadata["packages"])
            .map(|package| (text(&package["id"]), text(&package["name"])))
            .collect();

        let mut graph = Self::default();
        for node in items(&metadata["resolve"]["nodes"]) {
            let package = graph.packages.entry(names[text(&node["id"])].to_owned()).or_default();
            for dep in items(&node["deps"]) {
                let is_dev = items(&dep["dep_kinds"]).all(|kind| kind["kind"] == "dev");
                let list = if is_dev { &mut package.dev_dependencies } else { &mut package.dependencies };
                list.insert(names[text(&dep["pkg"])].to_owned());
            }
        }
        for ours in items(&metadata["packages"]).filter(|package| package["source"].is_null()) {
            let manifest = Path::new(text(&ours["manifest_path"]));
            let package = graph.packages.entry(text(&ours["name"]).to_owned()).or_default();
            let folder = manifest.parent().unwrap().strip_prefix(root).unwrap();
            package.folder = Some(folder.to_str().unwrap().replace('\\', "/"));
            package.is_private = ours["publish"].as_array().is_some_and(Vec::is_empty);
            package.inherits_lints = inherits_lints(&std::fs::read_to_string(manifest).unwrap());
            for dep in items(&ours["dependencies"]) {
                let is_dev = dep["kind"] == "dev";
                let list = if is_dev { &mut package.dev_dependencies } else { &mut package.dependencies };
                list.insert(text(&dep["name"]).to_owned());
            }
        }
        graph
    }

    /// Our packages with their folders.
    pub fn ours(&self) -> impl Iterator<Item = (&str, &str, &Package)> {
        self.packages
            .iter()
            .filter_map(|(name, package)| Some((name.as_str(), package.folder.as_deref()?, package)))
    }

    /// Everything that building `name` and its own tests compiles.
    pub fn reachable(&self, name: &str) -> BTreeSet<&str> {
        let mut reached = BTreeSet::new();
        let Some(start) = self.packages.get(name) else { return reached };
        let mut waiting: Vec<&str> =
            start.dependencies.iter().chain(&start.dev_dependencies).map(String::as_str).collect();
        while let Some(next) = waiting.pop() {
            if reached.insert(next) {
                let package = self.packages.get(next);
                waiting.extend(
                    package.into_iter().flat_map(|package| &package.dependencies).map(String::as_str),
                );
            }
        }
        reached
    }
}

/// Whether a manifest holds `[lints] workspace = true`, which cargo's metadata does not tell.
fn inherits_lints(manifest: &str) -> bool {
    let mut section = "";
    manifest.lines().map(|line| line.split('#').next().unwrap_or_default().trim()).any(|line| {
        if line.starts_with('[') {
            section = line;
        }
        let words: String = line.split_whitespace().collect();
        (section == "[lints]" && words == "workspace=true")
            || (section.is_empty() && words == "lints.workspace=true")
    })
}

fn run(command: &mut Command) -> String {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn items(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().unwrap().iter()
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}

#[test]
fn lints_are_seen_only_in_their_own_section() {
    for manifest in
        ["[package]\n[lints]\nworkspace = true # all\n", "[lints]\nworkspace=true", "lints.workspace = true"]
    {
        assert!(inherits_lints(manifest), "{manifest}");
    }
    for manifest in
        ["", "[lints]\n[x]\nworkspace = true", "[lints]\n# workspace = true", "[lints]\nworkspace = false"]
    {
        assert!(!inherits_lints(manifest), "{manifest}");
    }
}

#[test]
fn metadata_becomes_a_graph() {
    let manifest = root_manifest_of_tests();
    let metadata = serde_json::json!({
        "workspace_root": manifest.parent().unwrap().parent().unwrap(),
        "packages": [
            {"id": "1", "name": "orogeny_tests", "source": null, "manifest_path": manifest, "publish": [],
             "dependencies": [{"name": "winapi", "kind": "build"}, {"name": "tempfile", "kind": "dev"}]},
            {"id": "2", "name": "wgpu", "source": "registry"},
        ],
        "resolve": {"nodes": [
            {"id": "1", "deps": [{"pkg": "2", "dep_kinds": [{"kind": null}, {"kind": "dev"}]}]},
            {"id": "2", "deps": [{"pkg": "1", "dep_kinds": [{"kind": "dev"}]}]},
        ]},
    });
    let graph = Graph::from_metadata(&metadata);
    let ours = &graph.packages["orogeny_tests"];
    assert_eq!(ours.folder.as_deref(), Some("tests"));
    assert!(ours.is_private && ours.inherits_lints);
    assert_eq!(ours.dependencies.iter().collect::<Vec<_>>(), ["wgpu", "winapi"]);
    assert_eq!(ours.dev_dependencies.iter().collect::<Vec<_>>(), ["tempfile"]);
    assert_eq!(graph.packages["wgpu"].folder, None);
    assert_eq!(
        graph.reachable("orogeny_tests").into_iter().collect::<Vec<_>>(),
        ["tempfile", "wgpu", "winapi"]
    );
}

fn root_manifest_of_tests() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")
}
