use std::path::Path;
use std::time::{Duration, Instant};

use orogeny_field::{PointerSample, TerrainGrid};
use orogeny_geomip::{Camera, Mode, PagePlace};
use orogeny_gpu::Gpu;

use super::LiveView;
use super::known::Known;
use crate::session::{Event, PageRequest, Session, Status, Ticket, Travel};
use crate::view::{ViewRequest, drawing_gpu};
use crate::{Adapter, BrushOperation, EntryId, Operation, Quiet, Settings, Terrain};

mod on_device;

const WAIT: Duration = Duration::from_secs(120);

fn settings() -> Settings {
    Settings { adapter: Adapter::Cpu, page_budget_in_bytes: 64 << 20, ..Settings::default() }
}

fn operation(text: &str) -> Operation {
    Operation::from_json_text(text).unwrap()
}

/// A terrain of several pages with relief, and an effect that looks around itself on top.
fn terrain_at(path: &Path) -> Terrain {
    let grid = TerrainGrid::new(700, 600, 1.0).unwrap();
    let mut terrain = Terrain::create(path, grid, 10.0, settings()).unwrap();
    let operations = [
        r#"{"op": "fill", "brush": {"type": "noise", "feature_size": 200, "strength": 40}}"#,
        r#"{"op": "add_layer", "name": "Paths"}"#,
        r#"{"op": "add_layer", "name": "Soft", "content": {"type": "effect", "brush": {"type": "smooth", "width": 8}}}"#,
        r#"{"op": "set_layer", "layer": "Soft", "opacity": 0.5}"#,
    ];
    terrain.apply(&operations.map(operation), &mut Quiet).unwrap();
    terrain
}

fn stroke(brush: &str, layer: &str, points: &[PointerSample]) -> BrushOperation {
    let points = serde_json::to_string(points).unwrap();
    let text =
        format!(r#"{{"op": "stroke", "seed": 7, "layer": "{layer}", "brush": {brush}, "points": {points}}}"#);
    match operation(&text) {
        Operation::Brush(operation) => operation,
        other => panic!("{other:?}"),
    }
}

fn zigzag() -> Vec<PointerSample> {
    let at = |k: u32| {
        let along = f64::from(k);
        PointerSample::at(60.0 + 9.0 * along, 250.0 + 180.0 * (along / 7.0).sin())
            .with_pressure(0.4 + 0.5 * (along / 11.0).cos().abs() as f32)
    };
    (0..60).map(at).collect()
}

/// Someone who looks at all pages of a session.
struct Onlooker {
    session: Session,
    known: Option<Known>,
    status: Option<Status>,
    done: Vec<Ticket>,
    failed: Vec<(Ticket, String, bool)>,
    num_live_pages: usize,
    is_awaiting: bool,
    /// Masks of the north-west page.
    masks: Option<Vec<[u8; 4]>>,
}

impl Onlooker {
    fn new(terrain: Terrain) -> Self {
        let session = Session::of(terrain, || {}).unwrap();
        let mut onlooker = Self {
            session,
            known: None,
            status: None,
            done: Vec::new(),
            failed: Vec::new(),
            num_live_pages: 0,
            is_awaiting: false,
            masks: None,
        };
        onlooker.until(|onlooker| onlooker.known.is_some());
        onlooker.session.look(onlooker.everything());
        onlooker.is_awaiting = true;
        onlooker.settle();
        onlooker
    }

    fn everything(&self) -> Vec<PageRequest> {
        let known = self.known.as_ref().unwrap();
        let (grid, layout) = (known.grid, known.layout);
        let mut open = vec![PagePlace::root(&grid, layout)];
        let mut all = Vec::new();
        while let Some(place) = open.pop() {
            all.push(PageRequest { place, rect: None });
            open.extend(place.children(&grid, layout));
        }
        assert!(all.len() >= 9, "{}", all.len());
        all
    }

    /// Takes what has happened, and asks for what is stale.
    fn look(&mut self) {
        for event in self.session.events() {
            match &event {
                Event::Status(status) => {
                    match &mut self.known {
                        Some(known) => known.take_status(status),
                        none => *none = Some(Known::new(status)),
                    }
                    self.status = Some((**status).clone());
                }
                Event::Changed { rects, is_settled } => {
                    self.known.as_mut().unwrap().note_changed(rects.as_deref(), *is_settled);
                }
                Event::Pages(pages) => {
                    self.is_awaiting = false;
                    for page in pages {
                        self.num_live_pages += usize::from(page.summaries.is_empty());
                        if page.place == (PagePlace { level: 0, z: 0, x: 0 }) {
                            self.masks.clone_from(&page.masks);
                        }
                        self.known.as_mut().unwrap().take(page);
                    }
                }
                Event::Done { ticket, .. } => self.done.push(*ticket),
                Event::Failed { ticket, message, is_cancelled, .. } => {
                    self.failed.push((*ticket, message.clone(), *is_cancelled));
                }
                Event::Progress { .. } | Event::Surveyed { .. } => {}
            }
        }
        if let Some(known) = self.known.as_mut().filter(|_| !self.is_awaiting) {
            let stale = known.take_stale(|_| true).into_iter();
            let requests: Vec<_> =
                stale.map(|(place, rect)| PageRequest { place, rect: Some(rect) }).collect();
            if !requests.is_empty() {
                self.is_awaiting = true;
                self.session.look(requests);
            }
        }
    }

    fn until(&mut self, is_so: impl Fn(&Self) -> bool) {
        let start = Instant::now();
        while !is_so(self) {
            assert!(start.elapsed() < WAIT, "nothing happens");
            self.look();
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn settle(&mut self) {
        self.until(|onlooker| !onlooker.is_awaiting && !onlooker.known.as_ref().unwrap().has_stale(|_| true));
    }

    fn until_ended(&mut self, ticket: Ticket) {
        self.until(|onlooker| {
            onlooker.done.contains(&ticket) || onlooker.failed.iter().any(|(failed, ..)| *failed == ticket)
        });
        self.settle();
    }

    /// What was seen page by page is what there is.
    fn check(&mut self, what: &str) {
        self.settle();
        let mut fresh = Known::new(self.status.as_ref().unwrap());
        self.session.look(self.everything());
        let start = Instant::now();
        'waiting: loop {
            assert!(start.elapsed() < WAIT, "{what}: nothing comes");
            for event in self.session.events() {
                if let Event::Pages(pages) = event {
                    pages.iter().for_each(|page| _ = fresh.take(page));
                    break 'waiting;
                }
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        let seen = self.known.as_ref().unwrap();
        for PageRequest { place, .. } in self.everything() {
            let bits = |known: &Known| -> Vec<u32> {
                known.page(place).unwrap().0.samples().iter().map(|height| height.to_bits()).collect()
            };
            assert!(bits(seen) == bits(&fresh), "{what}: {place:?} is not as it was seen");
        }
    }
}

const BRUSHES: [(&str, &str); 6] = [
    (r#"{"type": "raise", "radius": 60, "strength": 12}"#, "Base"),
    (r#"{"type": "raise", "radius": 40, "strength": 9, "profile": "sphere"}"#, "Paths"),
    (r#"{"type": "level", "radius": 50, "strength": 0.7}"#, "Paths"),
    (r#"{"type": "smooth", "radius": 60, "strength": 0.8}"#, "Base"),
    (r#"{"type": "roughen", "radius": 45, "strength": 0.5}"#, "Base"),
    (r#"{"type": "grab", "radius": 80, "strength": 1}"#, "Base"),
];

#[test]
fn a_stroke_that_is_watched_is_the_one_that_is_applied_at_once() {
    let folder = tempfile::tempdir().unwrap();
    for (index, (brush, layer)) in BRUSHES.into_iter().enumerate() {
        let points = zigzag();
        let mut applied = terrain_at(&folder.path().join(format!("applied-{index}.orogeny")));
        applied.apply(&[Operation::Brush(stroke(brush, layer, &points))], &mut Quiet).unwrap();
        let watched = terrain_at(&folder.path().join(format!("watched-{index}.orogeny")));
        let mut onlooker = Onlooker::new(watched);
        let num_before = onlooker.num_live_pages;
        let ticket = onlooker.session.begin_stroke(stroke(brush, layer, &[]));
        // In groups of 1, 2, 3 ... as frames of different lengths would give them.
        let mut rest = points.as_slice();
        let mut size = 1 + index;
        while !rest.is_empty() {
            let (now, later) = rest.split_at(size.min(rest.len()));
            onlooker.session.push_points(ticket, now.to_vec());
            (rest, size) = (later, size % 5 + 1);
            onlooker.settle();
            // What the hand has drawn by now is seen before it goes on; what moves ground as a whole, only when it is lifted.
            if rest.len() < points.len() / 2 && !brush.contains("grab") {
                onlooker.until(|onlooker| onlooker.num_live_pages > num_before);
            }
        }
        onlooker.session.lift(ticket);
        onlooker.until_ended(ticket);
        assert!(onlooker.failed.is_empty(), "{brush}: {:?}", onlooker.failed);
        onlooker.check(brush);
        let status = onlooker.status.clone().unwrap();
        assert_eq!(status.history.len(), applied.log().unwrap().len());
        let Onlooker { session, .. } = onlooker;
        session.close().unwrap();
        let path = folder.path().join(format!("watched-{index}.orogeny"));
        let watched = Terrain::open_to_read(&path, settings()).unwrap();
        let recorded = |terrain: &Terrain| terrain.log().unwrap().last().unwrap().operation_json.clone();
        assert_eq!(recorded(&watched), recorded(&applied), "{brush}");
        let bounds = applied.grid().bounds();
        let read = |terrain: &Terrain| {
            let mut heights = vec![f32::NAN; bounds.area() as usize];
            terrain
                .composite(crate::composite::Source::Composite, 0, bounds)
                .unwrap()
                .read_rows(&mut heights)
                .unwrap();
            heights.into_iter().map(f32::to_bits).collect::<Vec<_>>()
        };
        assert!(read(&watched) == read(&applied), "{brush}: other heights than at once");
    }
}

#[test]
fn a_stroke_that_is_given_up_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut onlooker = Onlooker::new(terrain_at(&folder.path().join("t.orogeny")));
    let before = onlooker.status.clone().unwrap();
    for (brush, layer) in
        [BRUSHES[0], BRUSHES[1], (r#"{"type": "clone", "radius": 40, "source": {"at": [100, 100]}}"#, "Base")]
    {
        let ticket = onlooker.session.begin_stroke(stroke(brush, layer, &[]));
        onlooker.session.push_points(ticket, zigzag());
        onlooker.settle();
        onlooker.session.cancel_all();
        onlooker.until_ended(ticket);
        // Points of it that were on their way are of no other stroke.
        onlooker.session.push_points(ticket, zigzag());
        onlooker.session.lift(ticket);
        onlooker.check(brush);
        let (_, _, is_cancelled) = onlooker.failed.pop().unwrap();
        assert!(is_cancelled && onlooker.done.is_empty());
        assert_eq!(onlooker.status.as_ref().unwrap().history, before.history);
    }
}

#[test]
fn what_is_undone_redone_and_done_to_layers_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    let mut onlooker = Onlooker::new(terrain_at(&folder.path().join("t.orogeny")));
    for (brush, layer) in BRUSHES {
        let ticket = onlooker.session.begin_stroke(stroke(brush, layer, &[]));
        onlooker.session.push_points(ticket, zigzag());
        onlooker.session.lift(ticket);
        onlooker.until_ended(ticket);
    }
    let last = onlooker.status.as_ref().unwrap().current_entry();
    for (what, travel) in [
        ("one back", Travel::Undo(1)),
        ("three back", Travel::Undo(3)),
        ("two forth", Travel::Redo(2)),
        ("before the layers", Travel::Undo(6)),
        ("to the last", Travel::Jump(last)),
    ] {
        let ticket = onlooker.session.travel(travel);
        onlooker.until_ended(ticket);
        onlooker.check(what);
    }
    let hide = r#"{"op": "set_layer", "layer": "Soft", "visible": false}"#;
    let ticket = onlooker.session.apply(vec![operation(hide)]);
    onlooker.until_ended(ticket);
    onlooker.check("hidden");
    assert!(onlooker.failed.is_empty(), "{:?}", onlooker.failed);
    let ticket = onlooker
        .session
        .apply(vec![operation(r#"{"op": "set_layer", "layer": "None such", "visible": false}"#)]);
    onlooker.until_ended(ticket);
    let (_, message, is_cancelled) = onlooker.failed.pop().unwrap();
    assert!(message.contains("None such") && !is_cancelled, "{message}");
}

#[test]
fn masks_come_with_pages_and_follow_the_brush() {
    let folder = tempfile::tempdir().unwrap();
    let mut onlooker = Onlooker::new(terrain_at(&folder.path().join("t.orogeny")));
    assert!(onlooker.masks.is_none());
    let names = ["selection", "Paths", "None such"].map(str::to_owned);
    onlooker.session.show_masks(names.to_vec());
    onlooker.until(|onlooker| onlooker.masks.is_some());
    // Nothing is selected; a mask that was never painted counts everywhere; what is not there is nothing.
    assert!(onlooker.masks.as_ref().unwrap().iter().all(|masks| *masks == [0, 255, 0, 0]));
    let erase = r#"{"type": "erase_mask", "radius": 30, "strength": 1}"#;
    let ticket = onlooker.session.begin_stroke(stroke(erase, "Paths", &[]));
    onlooker
        .session
        .push_points(ticket, vec![PointerSample::at(100.0, 100.0), PointerSample::at(140.0, 100.0)]);
    onlooker.session.lift(ticket);
    onlooker.until_ended(ticket);
    assert!(onlooker.failed.is_empty(), "{:?}", onlooker.failed);
    let masks = onlooker.masks.clone().unwrap();
    assert!(
        masks[100 * 256 + 120][1] < 40 && masks[200 * 256 + 120][1] == 255,
        "{:?}",
        masks[100 * 256 + 120]
    );
    onlooker.check("with masks");
}

#[test]
fn heights_are_told_from_the_finest_page_that_is_still_true() {
    let folder = tempfile::tempdir().unwrap();
    let mut onlooker = Onlooker::new(terrain_at(&folder.path().join("t.orogeny")));
    let known = onlooker.known.as_mut().unwrap();
    let place = [311.0, 257.0];
    let fine_m = known.height_at(place);
    known.note_changed(None, true);
    assert_eq!(known.height_at(place), fine_m, "until anything else is there");
    // The stroke that began meanwhile goes on over the same ground.
    known.hold_still(true);
    let coarse = known.take_stale(|place| place.level > 0);
    assert!(!coarse.is_empty());
    assert_eq!(known.height_at(place), fine_m);
    known.hold_still(false);
    // Only coarse pages were asked for again: the fine ones are of a ground that is no more.
    let coarse_m = known.height_at(place);
    assert!(coarse_m != fine_m && (coarse_m - fine_m).abs() < 5.0, "{coarse_m} {fine_m}");
}

/// Draws a session until all is there: how it was, or how it is.
fn drawn(session: &Session, view: &mut Option<LiveView>, mode: Mode, is_earlier: bool) -> Vec<u8> {
    let gpu = drawing_gpu(&Settings { adapter: Adapter::Software, ..settings() }).unwrap();
    let request = ViewRequest { mode, has_shadows: false, max_error_px: 0.1, ..ViewRequest::default() };
    drawn_until(&gpu, session, view, &request, is_earlier, |events| {
        let failed = events.iter().find(|event| matches!(event, Event::Failed { .. }));
        assert!(failed.is_none(), "{failed:?}");
        true
    })
}

/// Draws a session until all is there, and what was told meanwhile is what is waited for.
fn drawn_until(
    gpu: &Gpu,
    session: &Session,
    view: &mut Option<LiveView>,
    request: &ViewRequest,
    is_earlier: bool,
    mut is_over: impl FnMut(&[Event]) -> bool,
) -> Vec<u8> {
    let size_px = [160, 90];
    let (eye, target) = (glam::DVec3::new(350.0, 420.0, 760.0), glam::DVec3::new(350.0, 20.0, 300.0));
    let camera = Camera::looking_at(eye, target, 0.8, size_px);
    let start = Instant::now();
    loop {
        assert!(start.elapsed() < WAIT, "it is never complete");
        let events = session.events();
        for event in &events {
            if let (Event::Status(status), None) = (event, &view) {
                *view = Some(LiveView::new(gpu, status, 64 << 20).unwrap());
            }
            if let Some(view) = view {
                view.take(event).unwrap();
            }
        }
        let is_over = is_over(&events);
        let Some(view) = view else { continue };
        view.show_earlier(is_earlier).unwrap();
        view.draw(&camera, size_px, request).unwrap();
        let wanted = view.wanted();
        if !wanted.is_empty() {
            session.look(wanted);
        } else if view.is_complete() && is_over {
            return view.targets.read(&view.gpu).unwrap();
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// How many pixels are another colour, and not by rounding.
fn num_apart(a: &[u8], b: &[u8]) -> usize {
    let pixels = a.chunks_exact(4).zip(b.chunks_exact(4));
    pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 12)).count()
}

#[test]
fn the_ground_is_drawn_as_it_was_and_by_how_much_it_differs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.orogeny");
    let mut terrain = terrain_at(&path);
    let entry = terrain.log().unwrap().last().map_or(EntryId::CREATION, |entry| entry.id);
    let south = |PointerSample { position_m: [x, z], .. }: PointerSample| PointerSample::at(x, z + 120.0);
    let lower = r#"{"type": "lower", "radius": 60, "strength": 30}"#;
    for (brush, points) in [(BRUSHES[0].0, zigzag()), (lower, zigzag().into_iter().map(south).collect())] {
        terrain.apply(&[Operation::Brush(stroke(brush, "Base", &points))], &mut Quiet).unwrap();
    }
    terrain.flush().unwrap();
    let past = Session::of(Terrain::open_to_read_at(&path, entry, settings()).unwrap(), || {}).unwrap();
    let then = drawn(&past, &mut None, Mode::Shaded, false);
    past.close().unwrap();

    let session = Session::of(terrain, || {}).unwrap();
    let view = &mut None;
    let now = drawn(&session, view, Mode::Shaded, false);
    assert!(num_apart(&now, &then) > 500, "{}", num_apart(&now, &then));
    session.open_past(entry);
    // Nothing tells that it is open but what comes.
    let start = Instant::now();
    while view.as_ref().is_none_or(|view| view.unpainted_earlier_m.is_none()) {
        assert!(start.elapsed() < WAIT, "no past came");
        drawn(&session, view, Mode::Shaded, false);
    }
    assert_eq!(num_apart(&drawn(&session, view, Mode::Shaded, false), &now), 0);
    let earlier = drawn(&session, view, Mode::Shaded, true);
    assert!(num_apart(&earlier, &then) < 60, "{} of {}", num_apart(&earlier, &then), then.len() / 4);
    let difference = drawn(&session, view, Mode::Difference, false);
    let most_m = view.as_ref().unwrap().difference_m(&ViewRequest::default()).unwrap();
    assert!((20.0..400.0).contains(&most_m), "{most_m}");
    let count = |is_so: fn(&[u8]) -> bool| difference.chunks_exact(4).filter(|pixel| is_so(pixel)).count();
    let (num_red, num_blue) = (
        count(|pixel| pixel[0] > pixel[2].saturating_add(60)),
        count(|pixel| pixel[2] > pixel[0].saturating_add(60)),
    );
    assert!(num_red > 50 && num_blue > 50, "{num_red} red, {num_blue} blue");
    assert_eq!(num_apart(&drawn(&session, view, Mode::Shaded, false), &now), 0, "and as it is again");
    session.close().unwrap();
}
