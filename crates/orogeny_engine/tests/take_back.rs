//! One operation is taken back from under others, and done again: the terrain is, bit for bit, as if it had not been, or had come last.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::path::Path;

use orogeny_engine::{
    Adapter, Entry, EntryId, EntryState, Error, ExportRequest, ImportRequest, Operation, Quiet, Settings,
    Terrain, TerrainGrid,
};

fn settings() -> Settings {
    Settings {
        adapter: Adapter::Cpu,
        page_budget_in_bytes: 64 << 20,
        author: "ann".to_owned(),
        ..Settings::default()
    }
}

/// What is done, one after another: an operation, or the import of a raster.
#[derive(Debug, Clone, Copy)]
enum Step {
    Do(&'static str),
    Import,
}

const STEPS: [Step; 10] = [
    Step::Do(r#"{"op": "fill", "brush": {"type": "noise", "feature_size": 200, "strength": 40}}"#),
    Step::Do(
        r#"{"op": "stroke", "brush": {"type": "raise", "radius": 60, "strength": 20}, "points": [[100, 100], [420, 300]]}"#,
    ),
    Step::Do(
        r#"{"op": "stroke", "brush": {"type": "smooth", "radius": 50, "width": 6}, "points": [[150, 60], [300, 330]]}"#,
    ),
    Step::Do(r#"{"op": "add_layer", "name": "Paths"}"#),
    Step::Do(
        r#"{"op": "stroke", "layer": "Paths", "seed": 3, "brush": {"type": "roughen", "radius": 40, "strength": 4}, "points": [[60, 300], [400, 90]]}"#,
    ),
    Step::Do(r#"{"op": "set_layer", "layer": "Paths", "opacity": 0.5}"#),
    Step::Import,
    Step::Do(r#"{"op": "select", "shape": {"rectangle": [90, 90, 200, 200]}, "feather": 20}"#),
    Step::Do(
        r#"{"op": "stroke", "brush": {"type": "grab", "radius": 80, "strength": 1, "gate": {"selection": true}}, "points": [[150, 150], [210, 190]]}"#,
    ),
    Step::Do(
        r#"{"op": "stroke", "brush": {"type": "terrace", "radius": 70, "step": 6}, "points": [[300, 200], [200, 330]]}"#,
    ),
];

/// The one that makes the layer which others are about.
const MAKES_LAYER: usize = 3;

fn terrain_of(path: &Path, steps: &[Step]) -> Terrain {
    let grid = TerrainGrid::new(520, 400, 1.0).unwrap();
    let mut terrain = Terrain::create(path, grid, 10.0, settings()).unwrap();
    for step in steps {
        take(&mut terrain, *step);
    }
    terrain
}

fn take(terrain: &mut Terrain, step: Step) {
    match step {
        Step::Do(text) => {
            terrain.apply(&[Operation::from_json_text(text).unwrap()], &mut Quiet).unwrap();
        }
        Step::Import => {
            let folder = tempfile::tempdir().unwrap();
            let file = folder.path().join("dunes.r32");
            let heights: Vec<u8> = (0..90 * 70_u32).flat_map(|k| ((k % 37) as f32).to_le_bytes()).collect();
            std::fs::write(&file, heights).unwrap();
            let mut request = ImportRequest::new(&file);
            request.options.size = Some((90, 70));
            request.at_m = [220.0, 200.0];
            request.layer = Some("Dunes".to_owned());
            terrain.import(&request, &mut Quiet).unwrap();
        }
    }
}

/// Every sample of what is seen, with the layers' names.
fn seen(terrain: &Terrain) -> (Vec<u8>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("seen.npy");
    terrain.export(&ExportRequest::new(&file), &mut Quiet).unwrap();
    let names = terrain.layers().unwrap().iter().map(|layer| layer.name.clone());
    (std::fs::read(file).unwrap(), names.collect())
}

fn log(terrain: &Terrain) -> Vec<(EntryId, EntryState)> {
    terrain.log().unwrap().iter().map(|Entry { id, state, .. }| (*id, *state)).collect()
}

#[test]
fn what_is_taken_back_is_as_if_it_had_never_been_and_done_again_as_if_it_came_last() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: String| folder.path().join(name);
    for taken in (0..STEPS.len()).filter(|taken| *taken != MAKES_LAYER) {
        let mut terrain = terrain_of(&path(format!("taken-{taken}.orogeny")), &STEPS);
        let before = seen(&terrain);
        let entry = EntryId(taken as u32 + 1);
        let redone = terrain.take_back(entry, &mut Quiet).unwrap();
        let num_later = STEPS.len() - 1 - taken;
        assert_eq!(redone.entries.len(), num_later);
        let rest: Vec<_> =
            STEPS.into_iter().enumerate().filter(|(k, _)| *k != taken).map(|(_, step)| step).collect();
        let mut never = terrain_of(&path(format!("never-{taken}.orogeny")), &rest);
        assert!(seen(&terrain) == seen(&never), "step {taken} taken back");
        // An undone selection is seen by what comes next.
        take(&mut terrain, STEPS[8]);
        take(&mut never, STEPS[8]);
        assert!(seen(&terrain) == seen(&never), "step {taken} taken back, and a stroke");
        terrain.undo(1).unwrap();
        never.undo(1).unwrap();

        terrain.do_again(entry, &mut Quiet).unwrap();
        take(&mut never, STEPS[taken]);
        assert!(seen(&terrain) == seen(&never), "step {taken} done again");

        // The old way is a branch that one can go back to.
        terrain.jump(EntryId(STEPS.len() as u32)).unwrap();
        assert!(seen(&terrain) == before, "step {taken}: the branch");
        terrain.close().unwrap();
        let report = Terrain::check(&path(format!("taken-{taken}.orogeny"))).unwrap();
        assert!(report.problems.is_empty(), "{report:?}");
    }
}

#[test]
fn what_others_need_is_not_taken_back_and_they_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut terrain = terrain_of(&folder.path().join("t.orogeny"), &STEPS);
    let (before, history) = (seen(&terrain), log(&terrain));
    let refused = terrain.take_back(EntryId(MAKES_LAYER as u32 + 1), &mut Quiet).unwrap_err();
    assert!(matches!(refused, Error::CannotTakeBack { entry: 4, .. }), "{refused}");
    assert!(refused.to_string().contains("entry 5 by ann"), "{refused}");
    for unknown in [0, 99] {
        let refused = terrain.take_back(EntryId(unknown), &mut Quiet).unwrap_err();
        assert!(matches!(refused, Error::CannotTakeBack { .. }), "{refused}");
        let refused = terrain.do_again(EntryId(unknown), &mut Quiet).unwrap_err();
        assert!(matches!(refused, Error::CannotReplay { .. }), "{refused}");
    }
    let shows = terrain.do_again(EntryId(2), &mut Quiet).unwrap_err();
    assert!(matches!(shows, Error::CannotReplay { entry: 2, .. }), "{shows}");
    assert!(seen(&terrain) == before);
    assert_eq!(log(&terrain), history);
}

#[test]
fn too_much_work_is_refused_and_the_last_one_is_simply_undone() {
    let folder = tempfile::tempdir().unwrap();
    let mut terrain = terrain_of(&folder.path().join("t.orogeny"), &STEPS[..1]);
    let dab = Operation::from_json_text(
        r#"{"op": "stroke", "brush": {"type": "raise", "radius": 8, "strength": 1}, "points": [[50, 50]]}"#,
    )
    .unwrap();
    terrain.apply(&vec![dab; 257], &mut Quiet).unwrap();
    let history = log(&terrain);
    let refused = terrain.take_back(EntryId(1), &mut Quiet).unwrap_err().to_string();
    assert!(refused.contains("257 operations") && refused.contains("at most 256"), "{refused}");
    assert!(refused.contains("2 by ann") && refused.contains("252 more"), "{refused}");
    assert_eq!(log(&terrain), history);
    let redone = terrain.take_back(EntryId(258), &mut Quiet).unwrap();
    assert_eq!((redone.entries.len(), log(&terrain).pop()), (0, Some((EntryId(258), EntryState::Undone))));
    let redone = terrain.do_again(EntryId(258), &mut Quiet).unwrap();
    assert_eq!((redone.entries, log(&terrain)), (vec![EntryId(258)], history));
}
