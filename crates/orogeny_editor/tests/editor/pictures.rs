//! The pictures of the guide to the editor. `cargo xtask pictures` draws them anew, which sets `OROGENY_PICTURES=write`; `OROGENY_PICTURES=split,map`
//! draws these alone. Without that they are held to what the guide says.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Duration;

use egui::{Modifiers, Rect, TextureHandle, TextureOptions, pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use orogeny_editor::{Command, Hand};
use orogeny_engine::{BrushType, ImportRequest, Mode, Picture, Quiet, Terrain};
use tracing::Level;

use crate::support::{MIDDLE, Window, curve, pixels, settings};

/// The longest that a picture may be, bytes.
const MAX_BYTES: u64 = 300_000;

/// What is drawn of a window.
enum Part {
    All,
    /// The panel at the left, or at the right.
    Left,
    Right,
    /// What lies below the ground.
    Below,
    /// A dialog, by its title.
    Dialog(&'static str),
}

/// The name of a picture, what brings the window to show it, and what of that is drawn.
type Shot = (&'static str, fn(&mut Window), Part);

const SHOTS: [Shot; 14] = [
    ("window", |_| {}, Part::All),
    ("split", split, Part::All),
    ("own-brush", own_brush, Part::Left),
    ("curve", profile_curve, Part::Left),
    ("layers", |window| window.run(Command::AddProcedure), Part::Right),
    ("map", map_and_histogram, Part::Right),
    ("tape", tape, Part::Below),
    ("export", export, Part::Dialog("Export heights")),
    ("import", import, Part::Dialog("Import heights")),
    ("new", new_terrain, Part::Dialog("New terrain")),
    ("preferences", |window| window.run(Command::ShowPreferences), Part::Dialog("Preferences")),
    ("commands", commands, Part::Dialog("Find a command")),
    ("log", log, Part::Below),
    ("first-steps", |window| window.run(Command::ShowTutorial), Part::All),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn file(name: &str) -> PathBuf {
    root().join(format!("docs/images/editor-{name}.png"))
}

fn split(window: &mut Window) {
    window.run(Command::SplitView);
    window.run(Command::LookDown);
    window.run(Command::Mode(Mode::Slope));
    window.run(Command::SwitchView);
}

fn own_brush(window: &mut Window) {
    std::fs::create_dir_all(window.path("brushes")).unwrap();
    for name in ["crater.wgsl", "strata.wgsl"] {
        std::fs::copy(root().join("docs/brushes").join(name), window.path("brushes").join(name)).unwrap();
    }
    window.click("Reload");
    window.click("Crater");
}

fn profile_curve(window: &mut Window) {
    window.run(Command::Brush(BrushType::Raise));
    window.harness.get_by_label("Profile curve").scroll_to_me();
    window.frames(12);
    window.click("Profile curve");
    window.frames(12);
    window.click("Shape");
    window.click("S");
    window.harness.get_by_label("Add point").scroll_to_me();
    window.frames(12);
}

fn map_and_histogram(window: &mut Window) {
    window.run(Command::ShowMap);
    window.run(Command::ShowHistogram);
}

fn tape(window: &mut Window) {
    window.run(Command::Hand(Hand::Tape));
    window.draw(&[MIDDLE - vec2(120.0, 0.0), MIDDLE + vec2(90.0, -40.0)], Modifiers::NONE);
}

fn export(window: &mut Window) {
    window.run(Command::Export);
    window.type_into("Path", "terrains/island.r16");
    window.click("Preset");
    window.click("Unreal R16");
}

fn import(window: &mut Window) {
    window.run(Command::Import);
    // From where tests run: no path of the machine is in a picture.
    window.type_into("Path", "../../assets/terrain/frazier_1024_int16.tif");
}

fn new_terrain(window: &mut Window) {
    window.run(Command::New);
    window.type_into("Path", "terrains/island.orogeny");
}

fn commands(window: &mut Window) {
    window.run(Command::CommandPalette);
    window.harness.event(egui::Event::Text("layer".to_owned()));
}

fn log(window: &mut Window) {
    window.log.push(Level::INFO, "orogeny_engine::backend", "the CPU back end is used: there is no GPU");
    window.log.push(
        Level::WARN,
        "orogeny_engine::apply",
        "the device was lost; it is done again on a new device",
    );
    window.run(Command::ShowLog);
}

impl Window {
    /// With the terrain that comes along, drawn on once.
    fn with_hills() -> Self {
        let mut window = Self::empty_of(vec2(1200.0, 800.0));
        let path = window.path("frazier.orogeny");
        let raster = root().join("assets/terrain/frazier_1024_int16.tif");
        let (terrain, _) =
            Terrain::from_raster(&path, &ImportRequest::new(raster), settings(), &mut Quiet).unwrap();
        terrain.close().unwrap();
        window.editor().open(&path);
        window.settle();
        window.draw(&curve(8), Modifiers::NONE);
        window
    }

    /// Shows the ground as it was drawn last: by copies, as the panels are drawn on another device.
    fn copy_ground(&mut self) -> Vec<TextureHandle> {
        let (gpu, ctx) = (self.gpu.clone(), self.harness.ctx.clone());
        let mut copies = Vec::new();
        self.editor().take_pictures(|view, _| {
            let image = pixels(&gpu, view);
            let copy = ctx.load_texture("ground", image, TextureOptions::LINEAR);
            let id = copy.id();
            copies.push(copy);
            id
        });
        copies
    }

    fn rect_of(&self, part: &Part) -> Rect {
        // Around the window there is a margin.
        let all = self.harness.ctx.content_rect().shrink(8.0);
        let ground = self.harness.get_by_label_contains("The terrain: draw").rect();
        match part {
            Part::All => all,
            Part::Left => {
                Rect::from_min_max(pos2(all.left(), ground.top()), pos2(ground.left(), all.bottom()))
            }
            Part::Right => Rect::from_min_max(pos2(ground.right(), ground.top()), all.max),
            Part::Below => Rect::from_min_max(pos2(all.left(), ground.bottom()), all.max),
            Part::Dialog(title) => {
                let area = self
                    .harness
                    .ctx
                    .memory(|memory| memory.area_rect(egui::Id::unique(Some(Cow::Borrowed(*title)))));
                area.unwrap().expand(6.0).intersect(all)
            }
        }
    }
}

fn draw(name: &str, bring: fn(&mut Window), part: &Part) {
    let mut window = Window::with_hills();
    bring(&mut window);
    window.settle();
    // The pointer is in no one's way.
    window.harness.event(egui::Event::PointerGone);
    window.frames(10);
    // The ground is drawn fine once nothing has moved for a while, and then finer from frame to frame.
    window.has_time.store(true, Ordering::Relaxed);
    std::thread::sleep(Duration::from_millis(500));
    for _ in 0..8 {
        window.editor().renew_pictures();
        window.frames(1);
    }
    let ground = window.copy_ground();
    window.frames(2);
    let image = window.harness.render().unwrap();
    let rect = window.rect_of(part);
    drop(ground);
    let [left, top] = [rect.left() as u32, rect.top() as u32];
    let [width_px, height_px] = [rect.width() as u32, rect.height() as u32];
    let places = (top..top + height_px).flat_map(|y| (left..left + width_px).map(move |x| (x, y)));
    let rgb = places.flat_map(|(x, y)| image.get_pixel(x, y).0[..3].to_vec()).collect();
    Picture { width_px, height_px, rgb }.write_small(&file(name)).unwrap();
}

#[test]
fn every_picture_is_in_the_guide_and_small() {
    let asked_for = std::env::var("OROGENY_PICTURES").unwrap_or_default();
    for (name, bring, part) in SHOTS {
        if asked_for == "write" || asked_for.split(',').any(|asked| asked == name) {
            draw(name, bring, &part);
        }
    }
    let guide = std::fs::read_to_string(root().join("docs/editor.md")).unwrap();
    for (name, ..) in SHOTS {
        let bytes = std::fs::read(file(name)).unwrap();
        assert!(
            bytes.starts_with(b"\x89PNG") && (bytes.len() as u64) < MAX_BYTES,
            "{name}: {} bytes",
            bytes.len()
        );
        assert!(guide.contains(&format!("(images/editor-{name}.png)")), "{name} is not in the guide");
    }
    let num_named = guide.matches("(images/editor-").count();
    assert_eq!(num_named, SHOTS.len(), "the guide names pictures that nothing draws");
}
