//! Commits behind the painting: what is painted is seen at once, wherever it is, and however large it is.

use orogeny_engine::{Quiet, Settings, Terrain, TerrainGrid};
use orogeny_store::Store;
use rusqlite::Connection;
use serde_json::json;

use crate::support::{
    apply, assert_same_heights, assert_whole, create, heights, operation, settings, stroke,
};

#[test]
fn a_stroke_is_accepted_while_it_is_on_its_way_and_is_there_when_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.orogeny");
    let mut terrain = create(&path);
    let (mut num_ahead, mut num_read) = (0, 0);
    for number in 1..=20 {
        // No commit gets to the file as long as someone else is about to write.
        let other = Connection::open(&path).unwrap();
        other.execute_batch("BEGIN IMMEDIATE").unwrap();
        terrain.submit(&[stroke(number)], &mut Quiet).unwrap();
        let on_disk = Store::open_to_read(&path).unwrap().log().unwrap().len();
        assert_eq!(on_disk as u32, number - 1, "it is on disk already");
        num_ahead += 1;
        other.execute_batch("ROLLBACK").unwrap();
        drop(other);
        // A read waits for what was accepted; a flush changes nothing about it.
        let places_m = (0..18).flat_map(|x| (0..14).map(move |z| [f64::from(x) * 40.0, f64::from(z) * 40.0]));
        let read = |terrain: &Terrain| -> Vec<u32> {
            places_m.clone().map(|place_m| terrain.height_m(place_m).unwrap().to_bits()).collect()
        };
        if number % 5 == 0 {
            let before = read(&terrain);
            terrain.flush().unwrap();
            assert_eq!(before, read(&terrain));
            num_read += before.len();
        }
        assert_eq!(terrain.log().unwrap().len() as u32, number);
    }
    let before = heights(&path);
    let num_commits = terrain.describe().unwrap().num_commits;
    terrain.close().unwrap();
    assert_whole(&path);
    // What comes next stands on what was on its way.
    let waited = folder.path().join("waited.orogeny");
    let mut terrain = create(&waited);
    apply(&mut terrain, &(1..=20).map(stroke).collect::<Vec<_>>());
    drop(terrain);
    assert_same_heights(&before, &heights(&waited));
    assert_eq!(
        num_commits,
        Store::open_to_read(&path).unwrap().num_commits().unwrap(),
        "what is described is out of date"
    );
    println!("{num_ahead} strokes accepted before they were on disk, {num_read} heights read");
}

/// Large operations: many times the pages that a small budget holds, some of them painted again and again.
fn paint_large(path: &std::path::Path, page_budget_in_bytes: u64) -> (usize, u64) {
    let settings = Settings { page_budget_in_bytes, ..settings() };
    let grid = TerrainGrid::new(1600, 1500, 1.0).unwrap();
    let mut terrain = Terrain::create(path, grid, 50.0, settings).unwrap();
    let mut most_in_bytes = 0;
    let mut num_pages = 0;
    let to_and_fro = [[100, 100], [1500, 350], [100, 750], [1500, 1100], [100, 1400], [1550, 1450]];
    for brush in [
        json!({"type": "raise", "radius": 150, "strength": 60}),
        json!({"type": "roughen", "radius": 140, "strength": 3}),
        json!({"type": "ledge", "radius": 140, "strength": 25}),
        json!({"type": "level", "radius": 140, "strength": 0.7, "blending": "wash"}),
    ] {
        let large = operation(json!({"op": "stroke", "seed": 5, "brush": brush, "points": to_and_fro}));
        let applied = terrain.submit(&[large], &mut Quiet).unwrap();
        num_pages = num_pages.max(applied[0].num_pages);
        most_in_bytes = most_in_bytes.max(terrain.memory().total_in_bytes());
    }
    // Several operations at once, and one over everything.
    let fill = json!({"op": "fill", "seed": 9, "brush": {"type": "roughen", "strength": 1.5}});
    terrain.submit(&[stroke(1), operation(fill), stroke(2)], &mut Quiet).unwrap();
    terrain.undo(2).unwrap();
    terrain.redo(1).unwrap();
    most_in_bytes = most_in_bytes.max(terrain.memory().total_in_bytes());
    terrain.close().unwrap();
    (num_pages, most_in_bytes)
}

#[test]
fn an_operation_beyond_every_budget_gives_the_same_bits() {
    const SMALL_BYTES: u64 = 8 << 20;
    let folder = tempfile::tempdir().unwrap();
    let (small, large) = (folder.path().join("small.orogeny"), folder.path().join("large.orogeny"));
    let (num_pages, small_in_bytes) = paint_large(&small, SMALL_BYTES);
    let (_, large_in_bytes) = paint_large(&large, 1 << 30);
    assert_same_heights(&heights(&small), &heights(&large));
    assert_whole(&small);
    println!(
        "an operation of {num_pages} pages; in memory {small_in_bytes} bytes of {SMALL_BYTES}, with room {large_in_bytes}"
    );
    assert!(small_in_bytes <= SMALL_BYTES, "{small_in_bytes} bytes are more than the budget");
    // More than the whole budget, of which pages on their way get an eighth.
    assert!(num_pages as u64 * 256 * 256 * 4 > SMALL_BYTES);
    assert!(large_in_bytes > SMALL_BYTES, "the budget was never needed");
}
