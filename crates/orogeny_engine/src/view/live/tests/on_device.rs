//! Strokes that are drawn from where they lie on the device.

use super::*;

/// A terrain of several pages with relief, which is drawn on a device and worked on there.
fn plain_terrain_at(path: &Path, gpu: &Gpu) -> Terrain {
    let settings = Settings { adapter: Adapter::Software, ..settings() }.sharing(gpu);
    let grid = TerrainGrid::new(700, 600, 1.0).unwrap();
    let mut terrain = Terrain::create(path, grid, 10.0, settings).unwrap();
    let noise = r#"{"op": "fill", "brush": {"type": "noise", "feature_size": 200, "strength": 40}}"#;
    terrain.apply(&[operation(noise)], &mut Quiet).unwrap();
    terrain
}

/// What a session told.
#[derive(Default)]
struct Told {
    status: Option<Status>,
    ended: Vec<Ticket>,
    num_on_device: usize,
}

impl Told {
    fn take(&mut self, event: &Event) {
        match event {
            Event::Status(status) => self.status = Some((**status).clone()),
            Event::Done { ticket, .. } | Event::Failed { ticket, .. } => self.ended.push(*ticket),
            Event::Pages(pages) => {
                self.num_on_device += pages.iter().filter(|page| page.on_device.is_some()).count();
            }
            _ => {}
        }
    }
}

/// A window on a session.
struct Onlooker {
    gpu: Gpu,
    session: Session,
    view: Option<LiveView>,
    told: Told,
}

impl Onlooker {
    fn new(gpu: &Gpu, terrain: Terrain) -> Self {
        let session = Session::of(terrain, || {}).unwrap();
        Self { gpu: gpu.clone(), session, view: None, told: Told::default() }
    }

    /// Draws until all is there, and something is so.
    fn until(&mut self, is_so: impl Fn(&Told) -> bool) -> Vec<u8> {
        let request = ViewRequest {
            mode: Mode::Shaded,
            has_shadows: false,
            max_error_px: 0.1,
            range_m: Some([0.0, 60.0]),
            ..ViewRequest::default()
        };
        let Self { gpu, session, view, told } = self;
        drawn_until(gpu, session, view, &request, false, |events| {
            events.iter().for_each(|event| told.take(event));
            is_so(told)
        })
    }

    fn until_ended(&mut self, ticket: Ticket) -> Vec<u8> {
        self.until(|told| told.ended.contains(&ticket))
    }

    fn uploaded_bytes(&self) -> u64 {
        self.view.as_ref().unwrap().uploaded_bytes()
    }

    /// The picture of someone who has just come.
    fn afresh(&mut self) -> Vec<u8> {
        let fresh = LiveView::new(&self.gpu, self.told.status.as_ref().unwrap(), 64 << 20).unwrap();
        let old = self.view.replace(fresh);
        let picture = self.until(|_| true);
        self.view = old;
        picture
    }
}

#[test]
fn a_stroke_is_drawn_from_where_it_lies_and_nothing_goes_through_memory() {
    let folder = tempfile::tempdir().unwrap();
    let gpu = drawing_gpu(&Settings { adapter: Adapter::Software, ..settings() }).unwrap();
    let brushes = [
        r#"{"type": "raise", "radius": 60, "strength": 12}"#,
        r#"{"type": "level", "radius": 50, "strength": 0.7, "blending": "wash"}"#,
        r#"{"type": "smooth", "radius": 60, "strength": 0.8}"#,
    ];
    for (index, brush) in brushes.into_iter().enumerate() {
        let path = folder.path().join(format!("{index}.orogeny"));
        let mut onlooker = Onlooker::new(&gpu, plain_terrain_at(&path, &gpu));
        let before = onlooker.until(|_| true);
        let uploaded_before = onlooker.uploaded_bytes();
        assert!(uploaded_before > 0 && onlooker.told.num_on_device == 0);

        let ticket = onlooker.session.begin_stroke(stroke(brush, "Base", &[]));
        let mut pictures = vec![before.clone()];
        for points in zigzag().chunks(20) {
            onlooker.session.push_points(ticket, points.to_vec());
            let num_before = onlooker.told.num_on_device;
            pictures.push(onlooker.until(|told| told.num_on_device > num_before));
        }
        for pair in pictures.windows(2) {
            assert!(num_apart(&pair[0], &pair[1]) > 50, "{brush}: a part of it is not seen");
        }
        assert_eq!(onlooker.uploaded_bytes(), uploaded_before, "{brush}");
        onlooker.session.lift(ticket);
        let after = onlooker.until_ended(ticket);
        assert_eq!(onlooker.uploaded_bytes(), uploaded_before, "{brush}: once it is on disk");
        assert!(after == onlooker.afresh(), "{brush}: a view that opens afterwards shows something else");

        // Undone, it comes from the file.
        let undo = onlooker.session.travel(Travel::Undo(1));
        assert!(onlooker.until_ended(undo) == before, "{brush}");
        assert!(onlooker.uploaded_bytes() > uploaded_before);
        onlooker.session.close().unwrap();
    }
    gpu.check().unwrap();
}

#[test]
fn a_stroke_that_is_given_up_leaves_the_picture_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let gpu = drawing_gpu(&Settings { adapter: Adapter::Software, ..settings() }).unwrap();
    let mut onlooker = Onlooker::new(&gpu, plain_terrain_at(&folder.path().join("t.orogeny"), &gpu));
    let before = onlooker.until(|_| true);
    let brush = r#"{"type": "lower", "radius": 60, "strength": 12}"#;
    let ticket = onlooker.session.begin_stroke(stroke(brush, "Base", &[]));
    onlooker.session.push_points(ticket, zigzag());
    let meanwhile = onlooker.until(|told| told.num_on_device > 0);
    assert!(num_apart(&meanwhile, &before) > 50);
    onlooker.session.cancel_all();
    assert!(onlooker.until_ended(ticket) == before);
    onlooker.session.close().unwrap();
}

#[test]
fn a_terrain_of_several_layers_and_a_view_on_another_device_are_drawn_from_memory() {
    let folder = tempfile::tempdir().unwrap();
    let open = || drawing_gpu(&Settings { adapter: Adapter::Software, ..settings() }).unwrap();
    let (gpu, other) = (open(), open());
    assert!(gpu != other && gpu == gpu.clone());
    for (name, drawn_on, has_more) in [("layers", &gpu, true), ("device", &other, false)] {
        let mut terrain = plain_terrain_at(&folder.path().join(format!("{name}.orogeny")), &gpu);
        if has_more {
            terrain.apply(&[operation(r#"{"op": "add_layer", "name": "Paths"}"#)], &mut Quiet).unwrap();
            let mark = r#"{"op": "fill", "layer": "Paths", "brush": {"type": "raise", "strength": 3}}"#;
            terrain.apply(&[operation(mark)], &mut Quiet).unwrap();
        }
        let mut onlooker = Onlooker::new(drawn_on, terrain);
        let before = onlooker.until(|_| true);
        let brush = r#"{"type": "raise", "radius": 60, "strength": 12}"#;
        let ticket = onlooker.session.begin_stroke(stroke(brush, "Base", &[]));
        onlooker.session.push_points(ticket, zigzag());
        onlooker.session.lift(ticket);
        let after = onlooker.until_ended(ticket);
        assert!(num_apart(&after, &before) > 50, "{name}");
        assert!(after == onlooker.afresh(), "{name}");
        assert_eq!(onlooker.told.num_on_device > 0, !has_more, "{name}");
        onlooker.session.close().unwrap();
    }
}
