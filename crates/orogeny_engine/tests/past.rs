//! The terrain as it was, beside how it is: bit for bit as if one had gone there, and nothing of the file is changed by looking.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test that cannot go on has failed"
)]

use std::path::Path;
use std::time::{Duration, Instant};

use orogeny_engine::session::{Event, PageData, PageRequest, Session, Ticket};
use orogeny_engine::{
    Adapter, EntryId, Error, ExportSource, Operation, PagePlace, Quiet, Settings, Terrain, TerrainGrid,
};

fn settings() -> Settings {
    Settings { adapter: Adapter::Cpu, page_budget_in_bytes: 64 << 20, ..Settings::default() }
}

fn apply(terrain: &mut Terrain, text: &str) {
    terrain.apply(&[Operation::from_json_text(text).unwrap()], &mut Quiet).unwrap();
}

/// Numbers as if by chance, the same ones each time.
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }
}

/// What is done to a terrain, by chance: strokes on layers and masks, layers that come and go, ways back that leave branches behind.
fn work(terrain: &mut Terrain, chance: &mut Chance, steps: u32) {
    for step in 0..steps {
        let [x, z, to_x, to_z] = [(); 4].map(|()| chance.below(600));
        let layer = usize::try_from(chance.below(terrain.layers().unwrap().len() as u64)).unwrap();
        let layer = terrain.layers().unwrap()[layer].id;
        let points = format!(r#""points": [[{x}, {z}], [{to_x}, {to_z}]]"#);
        let stroke = |target: &str, brush: &str| {
            format!(
                r#"{{"op": "stroke", "layer": {layer}, "target": "{target}", "seed": {step}, "brush": {brush}, {points}}}"#
            )
        };
        let count = terrain.layers().unwrap().len();
        match chance.below(10) {
            0 => apply(terrain, &format!(r#"{{"op": "add_layer", "name": "Layer {step}"}}"#)),
            1 if count > 1 => apply(terrain, &format!(r#"{{"op": "remove_layer", "layer": {layer}}}"#)),
            2 => apply(terrain, &format!(r#"{{"op": "set_layer", "layer": {layer}, "opacity": 0.{step}}}"#)),
            3 => apply(terrain, &stroke("mask", r#"{"type": "erase_mask", "radius": 120, "strength": 0.8}"#)),
            4 | 5 => _ = terrain.undo(1 + u32::try_from(chance.below(3)).unwrap()).unwrap(),
            6 => apply(terrain, &stroke("heights", r#"{"type": "roughen", "radius": 70, "strength": 5}"#)),
            7 => apply(terrain, &stroke("heights", r#"{"type": "terrace", "radius": 90, "step": 7}"#)),
            _ => apply(terrain, &stroke("heights", r#"{"type": "raise", "radius": 80, "strength": 25}"#)),
        }
    }
}

fn worked_on(path: &Path, seed: u64) -> Terrain {
    let grid = TerrainGrid::new(600, 600, 1.0).unwrap();
    let mut terrain = Terrain::create(path, grid, 10.0, settings()).unwrap();
    work(&mut terrain, &mut Chance(seed), 24);
    terrain
}

/// All that a terrain shows: layers, and heights of all levels.
fn shown(terrain: &Terrain) -> (String, Vec<u32>) {
    let mut bits = Vec::new();
    for level in 0..=2 {
        let (.., heights) = terrain.heights(&ExportSource::Composite, None, level).unwrap();
        bits.extend(heights.into_iter().map(f32::to_bits));
    }
    (format!("{:?}", terrain.layers().unwrap()), bits)
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap()
}

#[test]
fn every_entry_looks_as_if_one_had_gone_there() {
    for seed in [3, 17] {
        let folder = tempfile::tempdir().unwrap();
        let (path, copy) = (folder.path().join("t.orogeny"), folder.path().join("copy.orogeny"));
        worked_on(&path, seed).close().unwrap();
        std::fs::copy(&path, &copy).unwrap();
        let before = bytes(&path);
        let mut gone = Terrain::open(&copy, settings()).unwrap();
        let entries: Vec<_> = gone.log().unwrap().into_iter().map(|entry| entry.id).collect();
        assert!(entries.len() >= 10, "{}", entries.len());
        let here = shown(&Terrain::open_to_read(&path, settings()).unwrap());
        let mut others = 0;
        for entry in std::iter::once(EntryId::CREATION).chain(entries) {
            gone.jump(entry).unwrap();
            let past = Terrain::open_to_read_at(&path, entry, settings()).unwrap();
            let (looked, expected) = (shown(&past), shown(&gone));
            assert!(looked.0 == expected.0, "seed {seed}, entry {entry}: {} for {}", looked.0, expected.0);
            assert!(looked.1 == expected.1, "seed {seed}, entry {entry}: other heights");
            others += usize::from(looked.1 != here.1);
            past.close().unwrap();
        }
        assert!(others >= 8, "{others} of them differ from how it is");
        assert!(bytes(&path) == before, "seed {seed}: the file was changed");
        let files = std::fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().file_name());
        let left: Vec<_> = files.filter(|name| name.to_string_lossy().starts_with("t.")).collect();
        assert_eq!(left, ["t.orogeny"]);
    }
}

#[test]
fn the_past_stays_while_the_terrain_is_worked_on_and_can_be_read_anew() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.orogeny");
    let mut terrain = worked_on(&path, 5);
    terrain.flush().unwrap();
    let entry = terrain.log().unwrap()[3].id;
    let mut past = Terrain::open_to_read_at(&path, entry, settings()).unwrap();
    let then = shown(&past);
    work(&mut terrain, &mut Chance(8), 12);
    terrain.flush().unwrap();
    assert!(shown(&past) == then, "it changed with the terrain");
    past.refresh().unwrap();
    assert!(shown(&past) == then, "it is another one when it is read anew");
    let refused = past.undo(1);
    assert!(refused.is_err(), "it is open for reading");
    let unknown = Terrain::open_to_read_at(&path, EntryId(999), settings());
    let Err(Error::Store(err)) = unknown else { panic!("entry 999 was found") };
    assert!(err.to_string().contains("999") && err.to_string().contains("`log`"), "{err}");
    terrain.jump(entry).unwrap();
    terrain.flush().unwrap();
    assert!(shown(&terrain) == then);
    past.close().unwrap();
    terrain.close().unwrap();
}

/// What comes of a session until something is so.
fn until<T>(session: &Session, mut is_so: impl FnMut(Event) -> Option<T>) -> T {
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(120) {
        if let Some(found) = session.events().into_iter().find_map(&mut is_so) {
            return found;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    panic!("nothing came");
}

fn pages(session: &Session, places: &[PagePlace]) -> Vec<PageData> {
    session.look(places.iter().map(|place| PageRequest { place: *place, rect: None }).collect());
    until(session, |event| if let Event::Pages(pages) = event { Some(pages) } else { None })
}

fn done(session: &Session, ticket: Ticket) -> Result<(), String> {
    until(session, |event| match event {
        Event::Done { ticket: done, .. } if done == ticket => Some(Ok(())),
        Event::Failed { ticket: failed, message, .. } if failed == ticket => Some(Err(message)),
        _ => None,
    })
}

#[test]
fn pages_of_a_session_come_with_how_they_were_and_no_one_waits_for_that() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.orogeny");
    let terrain = worked_on(&path, 11);
    let entry = terrain.log().unwrap()[4].id;
    let session = Session::of(terrain, || {}).unwrap();
    let places = [0, 1].map(|x| PagePlace { level: 0, z: 1, x });
    assert!(pages(&session, &places).iter().all(|page| page.earlier.is_none()));

    done(&session, session.open_past(entry)).unwrap();
    let raise = r#"{"op": "fill", "brush": {"type": "raise", "strength": 3}}"#;
    done(&session, session.apply(vec![Operation::from_json_text(raise).unwrap()])).unwrap();
    let past = Terrain::open_to_read_at(&path, entry, settings()).unwrap();
    let (width, _, heights) = past.heights(&ExportSource::Composite, None, 0).unwrap();
    for page in pages(&session, &places) {
        let earlier = page.earlier.unwrap().page;
        assert_ne!(earlier.samples()[0], page.heights[0], "{:?}: it was raised", page.place);
        for (row, z) in (0..page.rect.depth()).zip(page.rect.z0..) {
            let start = z.unsigned_abs() as usize * width as usize + page.rect.x0.unsigned_abs() as usize;
            let expected = &heights[start..start + page.rect.width() as usize];
            assert_eq!(earlier.row(row, 0, page.rect.width()).unwrap(), expected, "{:?}", page.place);
        }
        // What is known of it holds for both.
        let (_, summary) = page.summaries.iter().find(|(place, _)| *place == page.place).unwrap();
        let all = page.heights.iter().chain(earlier.row(0, 0, page.rect.width()).unwrap());
        assert!(all.into_iter().all(|m| (summary.bounds.min_m..=summary.bounds.max_m).contains(m)));
    }
    past.close().unwrap();
    session.survey(64);
    let survey =
        until(&session, |event| if let Event::Surveyed { survey, .. } = event { Some(survey) } else { None });
    assert!(survey.higher_m().unwrap().iter().any(|m| m.abs() > 1.0));
    let err = done(&session, session.open_past(EntryId(999))).unwrap_err();
    assert!(err.contains("999"), "{err}");
    assert!(pages(&session, &places).iter().all(|page| page.earlier.is_none()), "none is open then");
    done(&session, session.open_past(entry)).unwrap();
    session.close_past();
    assert!(pages(&session, &places).iter().all(|page| page.earlier.is_none()));
    done(&session, session.open_past(entry)).unwrap();
    session.close().unwrap();
    let left: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().file_name()).collect();
    assert_eq!(left, ["t.orogeny"], "no log stays, though a past was open");
}
