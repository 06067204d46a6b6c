//! Several work on the terrain of one session: their strokes are drawn one after another, each is undone for itself.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use std::path::Path;
use std::time::{Duration, Instant};

use orogeny_engine::session::{Event, Session, Ticket, Travel};
use orogeny_engine::{
    Adapter, BrushOperation, EntryId, EntryState, ExportRequest, Operation, PointerSample, Quiet, Settings,
    Terrain, TerrainGrid,
};

const WAIT: Duration = Duration::from_secs(60);

fn settings(author: &str) -> Settings {
    Settings {
        adapter: Adapter::Cpu,
        page_budget_in_bytes: 64 << 20,
        author: author.to_owned(),
        ..Settings::default()
    }
}

fn create(path: &Path) -> Terrain {
    Terrain::create(path, TerrainGrid::new(520, 400, 1.0).unwrap(), 10.0, settings("host")).unwrap()
}

fn stroke(brush: &str, points: &str) -> BrushOperation {
    let text = format!(r#"{{"op": "stroke", "seed": 1, "brush": {{"type": {brush}}}, "points": {points}}}"#);
    match Operation::from_json_text(&text).unwrap() {
        Operation::Brush(operation) => operation,
        other => panic!("{other:?}"),
    }
}

fn raise(points: &str) -> BrushOperation {
    stroke(r#""raise", "radius": 50, "strength": 5"#, points)
}

fn smooth(points: &str) -> BrushOperation {
    stroke(r#""smooth", "radius": 50, "width": 6"#, points)
}

fn at(x_m: f64, z_m: f64) -> Vec<PointerSample> {
    vec![PointerSample::at(x_m, z_m)]
}

fn seen(terrain: &Terrain) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("seen.npy");
    terrain.export(&ExportRequest::new(&file), &mut Quiet).unwrap();
    std::fs::read(file).unwrap()
}

/// How something that was asked for ended.
#[derive(Debug, Clone, PartialEq, Eq)]
enum End {
    Done { entries: Vec<u32>, cut_after: Option<usize> },
    Failed { is_cancelled: bool },
}

/// The ends of all tickets up to the one that is waited for, in order.
fn ends_until(session: &Session, ticket: Ticket) -> Vec<(Ticket, End)> {
    let (start, mut ends) = (Instant::now(), Vec::new());
    loop {
        for event in session.events() {
            match event {
                Event::Done { ticket, entries, cut_after, .. } => {
                    let entries = entries.into_iter().map(|entry| entry.0).collect();
                    ends.push((ticket, End::Done { entries, cut_after }));
                }
                Event::Failed { ticket, is_cancelled, .. } => {
                    ends.push((ticket, End::Failed { is_cancelled }))
                }
                _ => {}
            }
        }
        if ends.iter().any(|(ended, _)| *ended == ticket) {
            return ends;
        }
        assert!(start.elapsed() < WAIT, "{ticket:?} did not end: {ends:?}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn end_of(session: &Session, ticket: Ticket) -> End {
    ends_until(session, ticket).pop().unwrap().1
}

fn done(entries: impl Into<Vec<u32>>) -> End {
    End::Done { entries: entries.into(), cut_after: None }
}

#[test]
fn strokes_at_the_same_time_are_drawn_one_after_another_each_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.orogeny");
    let session = Session::of(create(&path), || {}).unwrap();
    let [ann, bob, cem] = ["ann", "bob", "cem"].map(|name| session.participant(name));
    let first = ann.begin_stroke(raise("[]"));
    let second = bob.begin_stroke(smooth("[]"));
    let third = cem.begin_stroke(raise("[]"));
    // Points of all three, mixed; the last one is lifted first.
    for k in 0..10 {
        let along = 100.0 + 20.0 * f64::from(k);
        ann.push_points(first, at(along, 150.0));
        bob.push_points(second, at(along, 170.0));
        cem.push_points(third, at(along, 190.0));
        std::thread::sleep(Duration::from_millis(3));
    }
    cem.lift(third);
    bob.lift(second);
    std::thread::sleep(Duration::from_millis(50));
    ann.lift(first);
    let ends = ends_until(&session, third);
    assert_eq!(ends, [(first, done([1])), (second, done([2])), (third, done([3]))]);
    session.close().unwrap();

    let line = |z_m: f64| {
        let points: Vec<_> = (0..10).map(|k| format!("[{}, {z_m}]", 100 + 20 * k)).collect();
        format!("[{}]", points.join(", "))
    };
    let mut plain = create(&folder.path().join("plain.orogeny"));
    for operation in [raise(&line(150.0)), smooth(&line(170.0)), raise(&line(190.0))] {
        plain.apply(&[Operation::Brush(operation)], &mut Quiet).unwrap();
    }
    let terrain = Terrain::open_to_read(&path, settings("host")).unwrap();
    assert!(seen(&terrain) == seen(&plain));
    let authors: Vec<_> = terrain.log().unwrap().into_iter().map(|entry| entry.author).collect();
    assert_eq!(authors, ["ann", "bob", "cem"]);
}

#[test]
fn each_undoes_their_own_and_does_it_again_on_top() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.orogeny");
    let session = Session::of(create(&path), || {}).unwrap();
    let [ann, bob] = ["ann", "bob"].map(|name| session.participant(name));
    let strokes = [
        (&ann, raise("[[100, 100], [300, 100]]")),
        (&bob, raise("[[120, 60], [120, 300]]")),
        (&ann, smooth("[[100, 120], [300, 140]]")),
        (&bob, smooth("[[140, 60], [180, 300]]")),
    ];
    for (by, operation) in &strokes {
        let ticket = by.apply(vec![Operation::Brush(operation.clone())]);
        assert!(matches!(end_of(&session, ticket), End::Done { .. }));
    }
    let go = |by: &orogeny_engine::session::Participant, travel| end_of(&session, by.travel(travel));
    // Ann's two, the last first: what Bob did since is done again.
    assert_eq!(go(&ann, Travel::UndoOwn), done([5]));
    assert_eq!(go(&ann, Travel::UndoOwn), done([6, 7]));
    assert_eq!(go(&ann, Travel::UndoOwn), done([]), "nothing of hers is left");
    // And again, the first one first.
    assert_eq!(go(&ann, Travel::RedoOwn), done([8]));
    // Whoever does something new leaves behind what was taken back; that of others is still there.
    assert_eq!(go(&bob, Travel::UndoOwn), done([9]));
    assert!(matches!(
        end_of(&session, ann.apply(vec![Operation::Brush(strokes[2].1.clone())])),
        End::Done { .. }
    ));
    assert_eq!(go(&ann, Travel::RedoOwn), done([]));
    assert_eq!(go(&bob, Travel::RedoOwn), done([11]));
    session.close().unwrap();

    let mut plain = create(&folder.path().join("plain.orogeny"));
    for (_, operation) in [&strokes[1], &strokes[0], &strokes[2], &strokes[3]] {
        plain.apply(&[Operation::Brush(operation.clone())], &mut Quiet).unwrap();
    }
    let terrain = Terrain::open_to_read(&path, settings("host")).unwrap();
    assert!(seen(&terrain) == seen(&plain));
    let log = terrain.log().unwrap();
    let applied = log.iter().filter(|entry| entry.state == EntryState::Applied);
    let authors: Vec<_> = applied.map(|entry| entry.author.as_str()).collect();
    assert_eq!(authors, ["bob", "ann", "ann", "bob"]);
    assert_eq!(Terrain::check(&path).unwrap().problems.len(), 0);
}

#[test]
fn one_of_many_is_given_up_before_and_while_it_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let session = Session::of(create(&folder.path().join("t.orogeny")), || {}).unwrap();
    let [ann, bob] = ["ann", "bob"].map(|name| session.participant(name));
    let first = ann.begin_stroke(raise("[]"));
    ann.push_points(first, at(100.0, 100.0));
    let second = bob.begin_stroke(raise("[]"));
    bob.push_points(second, at(100.0, 100.0));
    bob.lift(second);
    let third = bob.apply(vec![Operation::Brush(raise("[[300, 300]]"))]);
    bob.cancel(second);
    ann.cancel(first);
    let ends = ends_until(&session, third);
    let cancelled = End::Failed { is_cancelled: true };
    assert_eq!(ends, [(first, cancelled.clone()), (second, cancelled), (third, done([1]))]);
    session.close().unwrap();
}

#[test]
fn a_stroke_does_not_keep_others_waiting_for_ever_but_its_own_author() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.orogeny");
    let session = Session::of(create(&path), || {}).unwrap();
    let [ann, bob] = ["ann", "bob"].map(|name| session.participant(name));
    for brush in [raise("[]"), stroke(r#""clone", "radius": 50, "source": {"at": [300, 300]}"#, "[]")] {
        let held = ann.begin_stroke(brush);
        ann.push_points(held, at(100.0, 100.0));
        let own = ann.apply(vec![Operation::Brush(raise("[[200, 200]]"))]);
        std::thread::sleep(Duration::from_millis(2500));
        assert!(ends_until_now(&session).is_empty(), "the author's own wait cut the stroke");
        let other = bob.apply(vec![Operation::Brush(raise("[[300, 300]]"))]);
        let ends = ends_until(&session, other);
        let tickets: Vec<_> = ends.iter().map(|(ticket, _)| *ticket).collect();
        assert_eq!(tickets, [held, own, other]);
        assert!(
            matches!(&ends[0].1, End::Done { cut_after: Some(1), entries } if entries.len() == 1),
            "{ends:?}"
        );
        // What still comes of it belongs to nothing.
        ann.push_points(held, at(400.0, 100.0));
        ann.lift(held);
    }
    session.close().unwrap();
    let terrain = Terrain::open_to_read(&path, settings("host")).unwrap();
    assert_eq!(terrain.log().unwrap().last().unwrap().id, EntryId(6));
    assert_eq!(terrain.height_m([400.0, 100.0]).unwrap(), 10.0);
}

fn ends_until_now(session: &Session) -> Vec<Ticket> {
    let ended = session.events().into_iter().filter_map(|event| match event {
        Event::Done { ticket, .. } | Event::Failed { ticket, .. } => Some(ticket),
        _ => None,
    });
    ended.collect()
}

#[test]
fn what_comes_while_a_stroke_is_given_up_is_done() {
    let folder = tempfile::tempdir().unwrap();
    let session = Session::of(create(&folder.path().join("t.orogeny")), || {}).unwrap();
    let [ann, bob] = ["ann", "bob"].map(|name| session.participant(name));
    for round in 0..20_u64 {
        // It waits for all of its points.
        let held = ann.begin_stroke(stroke(r#""clone", "radius": 50, "source": {"at": [300, 300]}"#, "[]"));
        ann.push_points(held, at(100.0, 100.0));
        std::thread::sleep(Duration::from_millis(round % 7));
        ann.cancel(held);
        let other = bob.apply(vec![Operation::Brush(raise("[[300, 300]]"))]);
        assert!(matches!(end_of(&session, other), End::Done { .. }), "round {round}");
    }
    session.close().unwrap();
    // What is asked for afterwards is not done, and no one waits for it.
    let _ = bob.apply(vec![Operation::Brush(raise("[[300, 300]]"))]);
    session.close().unwrap();
}

#[test]
fn two_of_one_name_wait_for_each_other_no_longer_than_others() {
    let folder = tempfile::tempdir().unwrap();
    let session = Session::of(create(&folder.path().join("t.orogeny")), || {}).unwrap();
    let [first, second] = ["someone", "someone"].map(|name| session.participant(name));
    let held = first.begin_stroke(raise("[]"));
    first.push_points(held, at(100.0, 100.0));
    let other = second.apply(vec![Operation::Brush(raise("[[300, 300]]"))]);
    let ends = ends_until(&session, other);
    assert!(
        matches!(&ends[..], [(ticket, End::Done { cut_after: Some(1), .. }), _] if *ticket == held),
        "{ends:?}"
    );
}

#[test]
fn redo_goes_on_when_someone_else_did_again_what_was_taken_back() {
    let folder = tempfile::tempdir().unwrap();
    let session = Session::of(create(&folder.path().join("t.orogeny")), || {}).unwrap();
    let [ann, bob] = ["ann", "bob"].map(|name| session.participant(name));
    for points in ["[[100, 100]]", "[[200, 200]]"] {
        end_of(&session, ann.apply(vec![Operation::Brush(raise(points))]));
    }
    let go = |by: &orogeny_engine::session::Participant, travel| end_of(&session, by.travel(travel));
    go(&ann, Travel::UndoOwn);
    go(&ann, Travel::UndoOwn);
    go(&bob, Travel::Redo(1));
    assert_eq!(go(&ann, Travel::RedoOwn), done([2]), "the first shows already");
    assert_eq!(go(&ann, Travel::RedoOwn), done([]));
    // What was refused leaves what was taken back.
    go(&ann, Travel::UndoOwn);
    let refused =
        ann.apply(vec![Operation::from_json_text(r#"{"op": "remove_layer", "layer": "None"}"#).unwrap()]);
    assert_eq!(end_of(&session, refused), End::Failed { is_cancelled: false });
    assert_eq!(go(&ann, Travel::RedoOwn), done([2]));
}
