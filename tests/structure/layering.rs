//! Which crate may see which.

use std::path::Path;

use crate::graph::Graph;
use crate::{assert_none, root};

/// A crate may depend only on crates above it.
const ORDER: [&str; 13] = [
    "orogeny_field",
    "orogeny_reference",
    "orogeny_shaders",
    "orogeny_gpu",
    "orogeny_store",
    "orogeny_pages",
    "orogeny_brush",
    "orogeny_geomip",
    "orogeny_formats",
    "orogeny_engine",
    "orogeny_service",
    "orogeny_editor",
    "orogeny",
];

/// Crates that build, with their tests, without wgpu.
const WITHOUT_WGPU: [&str; 5] =
    ["orogeny_field", "orogeny_reference", "orogeny_shaders", "orogeny_store", "orogeny_formats"];

/// Crates that may draw a user interface.
const WITH_EGUI: [&str; 2] = ["orogeny_editor", "orogeny"];

/// Crates that know nothing of each other.
const STRANGERS: [[&str; 2]; 2] = [["orogeny_brush", "orogeny_geomip"], ["orogeny_geomip", "orogeny_brush"]];

/// Fronts see the engine and each other, never the engine's parts.
const FRONTS: [(&str, &[&str]); 3] = [
    ("orogeny_service", &["orogeny_engine"]),
    ("orogeny_editor", &["orogeny_engine"]),
    ("orogeny", &["orogeny_engine", "orogeny_service", "orogeny_editor"]),
];

/// The harness, which any crate's own tests may use.
const HARNESS: &str = "orogeny_tests";

/// Packages whose folder has another name, with the reason.
const OTHER_FOLDER: [(&str, &str); 1] = [(HARNESS, "tests")]; // `tests/` is where everyone looks for tests

/// Packages that share types with others in the tree, so that a second version would not fit the first.
const ONE_VERSION: [&str; 2] = ["wgpu", "naga"];

type Rule = fn(&Graph) -> Vec<String>;

const RULES: [Rule; 8] = [
    crates_are_in_the_order,
    crates_depend_upwards,
    reference_sees_only_field,
    pure_crates_do_not_reach_wgpu,
    only_the_editor_reaches_egui,
    strangers_do_not_meet,
    fronts_see_only_the_engine,
    manifests_are_alike,
];

fn position(name: &str) -> Option<usize> {
    ORDER.iter().position(|listed| *listed == name)
}

fn crates_are_in_the_order(graph: &Graph) -> Vec<String> {
    let crates: Vec<_> =
        graph.ours().filter(|(_, folder, _)| folder.starts_with("crates/")).map(|(name, ..)| name).collect();
    if crates.is_empty() {
        return vec!["there is no crate in crates/".to_owned()];
    }
    let unlisted = crates.into_iter().filter(|name| position(name).is_none());
    unlisted.map(|name| format!("{name} has no place in the order of crates")).collect()
}

fn crates_depend_upwards(graph: &Graph) -> Vec<String> {
    let is_ours = |name: &str| graph.packages.get(name).is_some_and(|package| package.folder.is_some());
    let mut problems = Vec::new();
    for (name, _, package) in graph.ours() {
        let Some(own) = position(name) else { continue };
        let allowed = |dep: &str| !is_ours(dep) || position(dep).is_some_and(|other| other < own);
        let normal = package.dependencies.iter().filter(|dep| !allowed(dep));
        let dev = package.dev_dependencies.iter().filter(|dep| *dep != HARNESS && !allowed(dep));
        problems
            .extend(normal.chain(dev).map(|dep| format!("{name} depends on {dep}, which is not above it")));
    }
    problems
}

/// What the reference may use beside the vocabulary: it chooses instructions at run time and adds no arithmetic.
const REFERENCE_HELPERS: [&str; 1] = ["multiversion"];

fn reference_sees_only_field(graph: &Graph) -> Vec<String> {
    let others =
        graph.packages.get("orogeny_reference").into_iter().flat_map(|package| &package.dependencies);
    others
        .filter(|dep| *dep != "orogeny_field" && !REFERENCE_HELPERS.contains(&dep.as_str()))
        .map(|dep| format!("orogeny_reference depends on {dep}; the truth is plain code over orogeny_field"))
        .collect()
}

fn pure_crates_do_not_reach_wgpu(graph: &Graph) -> Vec<String> {
    let wgpu_of = |name| graph.reachable(name).into_iter().find(|reached| is_of_family(reached, "wgpu"));
    WITHOUT_WGPU.into_iter().filter_map(|name| Some(format!("{name} reaches {}", wgpu_of(name)?))).collect()
}

fn only_the_editor_reaches_egui(graph: &Graph) -> Vec<String> {
    let egui_of = |name| graph.reachable(name).into_iter().find(|reached| is_of_family(reached, "egui"));
    let others = ORDER.into_iter().filter(|name| !WITH_EGUI.contains(name));
    others.filter_map(|name| Some(format!("{name} reaches {}", egui_of(name)?))).collect()
}

/// Whether a package is `family` or one of its parts, such as `family-core` or `family_core`.
fn is_of_family(name: &str, family: &str) -> bool {
    name.strip_prefix(family).is_some_and(|rest| rest.is_empty() || rest.starts_with(['-', '_']))
}

fn strangers_do_not_meet(graph: &Graph) -> Vec<String> {
    let met = STRANGERS.into_iter().filter(|[one, other]| graph.reachable(one).contains(other));
    met.map(|[one, other]| format!("{one} reaches {other}")).collect()
}

fn fronts_see_only_the_engine(graph: &Graph) -> Vec<String> {
    let mut problems = Vec::new();
    for (front, allowed) in FRONTS {
        let deps = graph.packages.get(front).into_iter().flat_map(|package| &package.dependencies);
        let parts = deps.filter(|dep| position(dep).is_some() && !allowed.contains(&dep.as_str()));
        problems.extend(
            parts.map(|dep| format!("{front} depends on {dep}; a front sees {}", allowed.join(", "))),
        );
    }
    problems
}

fn manifests_are_alike(graph: &Graph) -> Vec<String> {
    let mut problems = Vec::new();
    for (name, folder, package) in graph.ours() {
        if !package.inherits_lints {
            problems.push(format!("{folder}/Cargo.toml lacks `[lints] workspace = true`"));
        }
        if !package.is_private {
            problems.push(format!("{folder}/Cargo.toml lacks `publish.workspace = true`"));
        }
        let is_named_alike = Path::new(folder).file_name().is_some_and(|last| last == name);
        if !is_named_alike && !OTHER_FOLDER.contains(&(name, folder)) {
            problems.push(format!("the folder {folder} holds a package of another name, {name}"));
        }
    }
    problems
}

/// Packages of [`ONE_VERSION`] that a lock file does not hold exactly once.
fn not_once(lock_file: &str) -> Vec<String> {
    let mut problems = Vec::new();
    for name in ONE_VERSION {
        let entry = format!("name = \"{name}\"");
        let count = lock_file.lines().filter(|line| *line == entry).count();
        if count != 1 {
            problems.push(format!("Cargo.lock holds {count} versions of {name}, not one"));
        }
    }
    problems
}

#[test]
fn the_workspace_is_layered() {
    let graph = Graph::of_workspace(&root());
    let problems: Vec<_> = RULES.iter().flat_map(|rule| rule(&graph)).collect();
    assert_none(&problems);
}

#[test]
fn shared_types_come_in_one_version() {
    assert_none(&not_once(&std::fs::read_to_string(root().join("Cargo.lock")).unwrap()));
}

mod bad_graphs {
    //! Each rule finds what it is there to find, and nothing in a good graph.

    use super::*;
    use crate::graph::Package;

    /// Every crate of the order in its folder, each front on the engine, the engine on wgpu by way of the GPU crate.
    fn good() -> Graph {
        let mut graph = Graph::default();
        for name in ORDER {
            let folder = Some(format!("crates/{name}"));
            let package = Package { folder, is_private: true, inherits_lints: true, ..Package::default() };
            graph.packages.insert(name.to_owned(), package);
        }
        let harness = Package { folder: Some("tests".to_owned()), ..graph.packages["orogeny"].clone() };
        graph.packages.insert(HARNESS.to_owned(), harness);
        for (from, to) in [
            ("orogeny_reference", "orogeny_field"),
            ("orogeny_gpu", "wgpu"),
            ("wgpu", "wgpu-core"),
            ("orogeny_engine", "orogeny_gpu"),
            ("orogeny_service", "orogeny_engine"),
            ("orogeny_editor", "orogeny_engine"),
            ("orogeny_editor", "egui"),
            ("orogeny", "orogeny_editor"),
            (HARNESS, "orogeny_engine"),
        ] {
            graph = with(graph, from, to);
        }
        with_dev(graph, "orogeny_engine", HARNESS)
    }

    fn with(mut graph: Graph, from: &str, to: &str) -> Graph {
        graph.packages.entry(from.to_owned()).or_default().dependencies.insert(to.to_owned());
        graph.packages.entry(to.to_owned()).or_default();
        graph
    }

    fn with_dev(mut graph: Graph, from: &str, to: &str) -> Graph {
        graph.packages.entry(from.to_owned()).or_default().dev_dependencies.insert(to.to_owned());
        graph
    }

    fn changed(name: &str, change: fn(&mut Package)) -> Graph {
        let mut graph = good();
        change(graph.packages.get_mut(name).unwrap());
        graph
    }

    /// `rule` finds one problem, and its text holds all of `words`.
    #[track_caller]
    fn assert_finds(rule: Rule, graph: &Graph, words: &[&str]) {
        let problems = rule(graph);
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert!(words.iter().all(|word| problems[0].contains(word)), "{problems:?} should name {words:?}");
    }

    #[test]
    fn a_good_graph_passes_every_rule() {
        for rule in RULES {
            assert_none(&rule(&good()));
        }
    }

    #[test]
    fn a_crate_outside_the_order() {
        let mut graph = good();
        let package = Package { folder: Some("crates/orogeny_extra".to_owned()), ..Package::default() };
        graph.packages.insert("orogeny_extra".to_owned(), package);
        assert_finds(crates_are_in_the_order, &graph, &["orogeny_extra"]);
    }

    #[test]
    fn no_crates_at_all() {
        assert_finds(crates_are_in_the_order, &Graph::default(), &["no crate"]);
    }

    #[test]
    fn a_dependency_downwards() {
        let graph = with(good(), "orogeny_store", "orogeny_engine");
        assert_finds(crates_depend_upwards, &graph, &["orogeny_store", "orogeny_engine"]);
        let graph = with_dev(good(), "orogeny_store", "orogeny_engine");
        assert_finds(crates_depend_upwards, &graph, &["orogeny_store", "orogeny_engine"]);
    }

    #[test]
    fn a_crate_that_ships_the_harness() {
        assert_finds(crates_depend_upwards, &with(good(), "orogeny", HARNESS), &["orogeny", HARNESS]);
    }

    #[test]
    fn a_reference_with_help_from_outside() {
        let graph = with(good(), "orogeny_reference", "rayon");
        assert_finds(reference_sees_only_field, &graph, &["rayon"]);
    }

    #[test]
    fn a_pure_crate_that_reaches_wgpu() {
        let graph = with(with(good(), "orogeny_store", "middleman"), "middleman", "wgpu-types");
        assert_finds(pure_crates_do_not_reach_wgpu, &graph, &["orogeny_store", "wgpu-types"]);
        let graph = with_dev(good(), "orogeny_formats", "wgpu");
        assert_finds(pure_crates_do_not_reach_wgpu, &graph, &["orogeny_formats", "wgpu"]);
    }

    #[test]
    fn egui_outside_the_editor() {
        let graph = with(good(), "orogeny_engine", "egui_tiles");
        let problems = only_the_editor_reaches_egui(&graph);
        assert!(
            problems.iter().any(|problem| problem.contains("orogeny_engine reaches egui_tiles")),
            "{problems:?}"
        );
        assert!(problems.iter().any(|problem| problem.contains("orogeny_service")), "{problems:?}");
    }

    #[test]
    fn brush_and_geomip_that_meet() {
        let graph = with(with(good(), "orogeny_geomip", "middleman"), "middleman", "orogeny_brush");
        assert_finds(strangers_do_not_meet, &graph, &["orogeny_geomip", "orogeny_brush"]);
        let graph = with_dev(good(), "orogeny_brush", "orogeny_geomip");
        assert_finds(strangers_do_not_meet, &graph, &["orogeny_brush", "orogeny_geomip"]);
    }

    #[test]
    fn a_front_that_sees_a_part_of_the_engine() {
        for front in ["orogeny", "orogeny_editor", "orogeny_service"] {
            assert_finds(
                fronts_see_only_the_engine,
                &with(good(), front, "orogeny_store"),
                &[front, "orogeny_store"],
            );
        }
    }

    #[test]
    fn manifests_that_differ() {
        let no_lints = changed("orogeny_gpu", |package| package.inherits_lints = false);
        assert_finds(manifests_are_alike, &no_lints, &["crates/orogeny_gpu", "lints"]);
        let public = changed("orogeny_gpu", |package| package.is_private = false);
        assert_finds(manifests_are_alike, &public, &["crates/orogeny_gpu", "publish"]);
        let misnamed = changed("orogeny_gpu", |package| package.folder = Some("crates/gpu".to_owned()));
        assert_finds(manifests_are_alike, &misnamed, &["crates/gpu", "orogeny_gpu"]);
    }

    #[test]
    fn two_versions_or_none() {
        let entry = |name: &str| format!("[[package]]\nname = \"{name}\"\nversion = \"1.0.0\"\n");
        let good = entry("wgpu") + &entry("naga") + &entry("wgpu-core");
        assert_none(&not_once(&good));
        assert_eq!(
            not_once(&(good.clone() + &entry("wgpu"))),
            ["Cargo.lock holds 2 versions of wgpu, not one"]
        );
        assert_eq!(not_once(&entry("wgpu")), ["Cargo.lock holds 0 versions of naga, not one"]);
    }
}
