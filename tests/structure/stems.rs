//! One stage, one stem: a kernel's shader, its CPU twin, its plan and its tests have one file name in four folders.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::{assert_none, root};

/// A folder in which every stage has one file.
struct Place {
    folder: &'static str,
    extension: &'static str,
    /// Stems that are no stage, each with the reason.
    exceptions: &'static [(&'static str, &'static str)],
}

const MODULE: (&str, &str) = ("mod", "lists the stages");
const CUSTOM: (&str, &str) = ("custom", "plans kernels that users write; they have no twin");

const PLACES: [Place; 4] = [
    Place { folder: "shaders/brush", extension: "wgsl", exceptions: &[] },
    Place { folder: "crates/orogeny_reference/src/brush", extension: "rs", exceptions: &[MODULE] },
    Place { folder: "crates/orogeny_brush/src/kernels", extension: "rs", exceptions: &[MODULE, CUSTOM] },
    Place {
        folder: "tests/kernels",
        extension: "rs",
        exceptions: &[
            ("main", "lists the stages' tests"),
            ("agreement", "compares the back ends for every stage"),
            ("drainage", "compares the back ends for what `blend` pulls the ground to"),
            ("cloning", "compares the back ends for what `blend` pulls the ground to"),
            ("erosion", "compares the back ends for what `blend` pulls the ground to"),
            ("centre_line", "holds what a strength means, for every profile"),
            ("numpy", "compares what all stages share with NumPy"),
        ],
    },
];

/// The same of the steps that filters are made of.
const STEP_PLACES: [Place; 3] = [
    Place {
        folder: "shaders/field",
        extension: "wgsl",
        exceptions: &[("bounds", "finds the lowest and the highest height, whose twin every crate uses")],
    },
    Place {
        folder: "crates/orogeny_reference/src/field",
        extension: "rs",
        exceptions: &[
            MODULE,
            ("between", "values between samples, for those that look there"),
            ("compose", "joins layers, on the CPU"),
            ("fill_pits", "works on a whole region at once, on the CPU"),
            ("flow", "works on a whole region at once, on the CPU"),
            ("around", "the neighbours of a sample, for the two above"),
            ("padded", "parts of rows with what lies around them, for the simulations"),
            ("droplets", "works on a whole region at once, on the CPU"),
        ],
    },
    Place { folder: "crates/orogeny_brush/src/filter/kernels", extension: "rs", exceptions: &[MODULE] },
];

/// Every file that a stage lacks, and every folder that is not there.
fn orphans(root: &Path, places: &[Place]) -> Vec<String> {
    let mut problems = Vec::new();
    let mut stems_of = BTreeMap::new();
    for place in places {
        match stems(root, place) {
            Ok(stems) => _ = stems_of.insert(place.folder, stems),
            Err(err) => problems.push(format!("{}: {err}", place.folder)),
        }
    }
    let all: BTreeSet<&String> = stems_of.values().flatten().collect();
    if all.is_empty() {
        problems.push("there is no stage at all".to_owned());
    }
    for stem in all {
        for place in places {
            if !stems_of.get(place.folder).is_some_and(|stems| stems.contains(stem)) {
                problems
                    .push(format!("the stage `{stem}` lacks {}/{stem}.{}", place.folder, place.extension));
            }
        }
    }
    problems
}

fn stems(root: &Path, place: &Place) -> std::io::Result<BTreeSet<String>> {
    let mut stems = BTreeSet::new();
    for entry in std::fs::read_dir(root.join(place.folder))? {
        let path = entry?.path();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let is_exception = place.exceptions.iter().any(|(name, _)| *name == stem);
        if path.extension().is_some_and(|extension| extension == place.extension) && !is_exception {
            stems.insert(stem);
        }
    }
    Ok(stems)
}

#[test]
fn every_stage_has_its_stem_in_every_folder() {
    assert_none(&orphans(&root(), &PLACES));
    assert_none(&orphans(&root(), &STEP_PLACES));
}

mod bad_trees {
    //! The check finds what it is there to find.

    use super::*;

    fn tree(files: &[&str]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for folder in PLACES.iter().map(|place| place.folder) {
            std::fs::create_dir_all(root.path().join(folder)).unwrap();
        }
        for file in files {
            std::fs::write(root.path().join(file), "").unwrap();
        }
        root
    }

    const RAISE: [&str; 4] = [
        "shaders/brush/raise.wgsl",
        "crates/orogeny_reference/src/brush/raise.rs",
        "crates/orogeny_brush/src/kernels/raise.rs",
        "tests/kernels/raise.rs",
    ];

    #[test]
    fn a_whole_stage_passes_with_modules_and_other_files_beside_it() {
        let beside = [
            "crates/orogeny_reference/src/brush/mod.rs",
            "crates/orogeny_brush/src/kernels/mod.rs",
            "tests/kernels/main.rs",
            "shaders/brush/README.md",
        ];
        assert_none(&orphans(tree(&[RAISE.as_slice(), &beside].concat()).path(), &PLACES));
    }

    #[test]
    fn each_absence_is_found() {
        for absent in RAISE {
            let rest: Vec<_> = RAISE.into_iter().filter(|file| *file != absent).collect();
            assert_eq!(orphans(tree(&rest).path(), &PLACES), [format!("the stage `raise` lacks {absent}")]);
        }
    }

    #[test]
    fn an_orphan_is_found_in_each_folder() {
        for place in PLACES {
            let orphan = format!("{}/stray.{}", place.folder, place.extension);
            let problems = orphans(tree(&[RAISE.as_slice(), &[orphan.as_str()]].concat()).path(), &PLACES);
            assert_eq!(problems.len(), PLACES.len() - 1, "{problems:?}");
            assert!(
                problems.iter().all(|problem| problem.starts_with("the stage `stray` lacks ")),
                "{problems:?}"
            );
        }
    }

    #[test]
    fn an_exception_of_one_folder_is_none_in_another() {
        let problems =
            orphans(tree(&[RAISE.as_slice(), &["shaders/brush/main.wgsl"]].concat()).path(), &PLACES);
        assert_eq!(problems.len(), PLACES.len() - 1, "{problems:?}");
    }

    #[test]
    fn no_stage_and_no_folder_are_failures() {
        assert_eq!(orphans(tree(&[]).path(), &PLACES), ["there is no stage at all"]);
        let nothing = tempfile::tempdir().unwrap();
        assert_eq!(orphans(nothing.path(), &PLACES).len(), PLACES.len() + 1);
    }
}
