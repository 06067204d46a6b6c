use std::time::{Duration, Instant};

use orogeny_field::{PointerSample, TerrainGrid};
use orogeny_geomip::PagePlace;

use crate::session::{Event, PageRequest, Session, Ticket};
use crate::stub_executor::{StubExecutor, dab};
use crate::{Adapter, BrushOperation, Operation, Quiet, Settings, Terrain};

const WAIT: Duration = Duration::from_secs(60);

fn settings() -> Settings {
    Settings { adapter: Adapter::Cpu, ..Settings::default() }
}

fn stroke() -> BrushOperation {
    match dab() {
        Operation::Brush(operation) => operation,
        other => panic!("{other:?}"),
    }
}

/// What a session told: how often pages, and what failed with which message.
#[derive(Debug, Default)]
struct Told {
    num_pages_events: usize,
    failed: Vec<(Ticket, String, bool)>,
}

impl Told {
    /// Listens until a ticket has failed.
    fn until_failed(&mut self, session: &Session, awaited: Ticket) {
        let start = Instant::now();
        while !self.failed.iter().any(|(ticket, ..)| *ticket == awaited) {
            assert!(start.elapsed() < WAIT, "{awaited:?} was not answered: {self:?}");
            for event in session.events() {
                match event {
                    Event::Pages(pages) => {
                        self.num_pages_events += 1;
                        assert!(pages.is_empty());
                    }
                    Event::Failed { ticket, message, is_fault, .. } => {
                        self.failed.push((ticket, message, is_fault))
                    }
                    Event::Done { ticket, .. } => panic!("{ticket:?} was done"),
                    _ => {}
                }
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

#[test]
fn all_who_ask_a_session_whose_thread_panicked_are_answered() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.orogeny");
    let grid = TerrainGrid::new(64, 64, 1.0).unwrap();
    let mut terrain = Terrain::create(&path, grid, 0.0, settings()).unwrap();
    terrain.apply(&[dab()], &mut Quiet).unwrap();
    terrain.set_executor(Box::new(StubExecutor(|| panic!("the executor's fault"))));
    let root = PagePlace::root(&grid, terrain.store().unwrap().layout());
    let session = Session::of(terrain, || {}).unwrap();

    let drawn = session.begin_stroke(stroke());
    // Kept for when the stroke is over, which it never is as it should be.
    let waiting = session.apply(vec![dab()]);
    let survey = session.survey(16);
    session.push_points(drawn, vec![PointerSample::at(8.0, 8.0), PointerSample::at(20.0, 8.0)]);
    session.lift(drawn);
    session.look(vec![PageRequest { place: root, rect: None }]);
    let mut told = Told::default();
    told.until_failed(&session, survey);
    let failed: Vec<Ticket> = told.failed.iter().map(|(ticket, ..)| *ticket).collect();
    assert_eq!(failed, [drawn, waiting, survey]);

    // Also who asks later, in the same words.
    session.look(vec![PageRequest { place: root, rect: None }]);
    let late = session.apply(vec![dab()]);
    told.until_failed(&session, late);
    assert!(told.num_pages_events >= 2, "{told:?}");
    for (_, message, is_fault) in &told.failed {
        assert!(message.contains("the executor's fault") && message.contains("open the terrain again"));
        assert!(is_fault);
    }

    // The file is free at once, and holds what was done before.
    let mut again = Terrain::open(&path, settings()).unwrap();
    assert_eq!(again.height_m([8.0, 8.0]).unwrap(), 1.0);
    assert_eq!(again.log().unwrap().len(), 1);
    again.apply(&[dab()], &mut Quiet).unwrap();
    let err = session.close().unwrap_err().to_string();
    assert!(err.contains("the executor's fault"), "{err}");
    again.close().unwrap();
}
