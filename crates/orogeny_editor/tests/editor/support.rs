//! An editor in a window that no one sees.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use egui::{ColorImage, Event, Key, Modifiers, PointerButton, Pos2, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use orogeny_editor::{Command, Editor, EditorOptions, Log, Preferences};
use orogeny_engine::{
    Adapter, ExportSource, Gpu, Operation, Presets, Quiet, Settings, Terrain, TerrainGrid, drawing_gpu,
};

const WAIT: Duration = Duration::from_secs(120);

/// The middle of the ground in the window.
pub const MIDDLE: Pos2 = pos2(500.0, 420.0);

pub struct Window {
    /// What it draws on.
    pub gpu: Gpu,
    pub harness: Harness<'static, Editor>,
    pub folder: tempfile::TempDir,
    /// What it notes.
    pub log: Log,
    /// Whether there is time to draw as finely as can be.
    pub has_time: Arc<AtomicBool>,
}

pub fn settings() -> Settings {
    Settings { adapter: Adapter::Cpu, page_budget_in_bytes: 64 << 20, ..Settings::default() }
}

/// A file that is dropped on the window.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|err| err.to_string())
    }
}

/// A terrain of several pages with some hills.
pub fn make_terrain(path: &Path) {
    let grid = TerrainGrid::new(600, 600, 1.0).unwrap();
    let mut terrain = Terrain::create(path, grid, 10.0, settings()).unwrap();
    let fill = r#"{"op": "fill", "brush": {"type": "noise", "feature_size": 300, "strength": 25}}"#;
    terrain.apply(&[Operation::from_json_text(fill).unwrap()], &mut Quiet).unwrap();
    terrain.close().unwrap();
}

impl Window {
    /// With a terrain open.
    pub fn open() -> Self {
        let mut window = Self::empty();
        let path = window.path("t.orogeny");
        make_terrain(&path);
        window.editor().open(&path);
        window.settle();
        assert_eq!(window.editor().open_file(), Some(path.as_path()));
        window
    }

    /// With nothing open, and preferences that have seen the first steps.
    pub fn empty() -> Self {
        Self::empty_of(egui::vec2(1000.0, 760.0))
    }

    /// The same, so large.
    pub fn empty_of(size: egui::Vec2) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let preferences = Preferences { has_seen_tutorial: true, ..Preferences::default() };
        preferences.write(&folder.path().join("editor.json")).unwrap();
        Self::in_folder_of(folder, size)
    }

    /// With what a folder remembers.
    pub fn in_folder(folder: tempfile::TempDir) -> Self {
        Self::in_folder_of(folder, egui::vec2(1000.0, 760.0))
    }

    fn in_folder_of(folder: tempfile::TempDir, size: egui::Vec2) -> Self {
        let bundled = folder.path().join("bundled.orogeny");
        let log = Log::default();
        let options = EditorOptions {
            settings: settings(),
            presets: Presets::open(Some(folder.path().join("presets"))),
            log: log.clone(),
            own_brushes: Some(folder.path().join("brushes")),
            preferences: Some(folder.path().join("editor.json")),
            bundled: Box::new(move || {
                make_terrain(&bundled);
                Ok(bundled.clone())
            }),
        };
        let gpu = Self::new_gpu();
        let has_time = Arc::new(AtomicBool::new(false));
        let is_quick = Arc::clone(&has_time);
        let editor = Editor::new(options, gpu.clone(), || {});
        let harness = Harness::builder().with_size(size).with_max_steps(64).build_ui_state(
            move |ui, editor: &mut Editor| {
                let start = Instant::now();
                editor.update();
                editor.ui(ui);
                // A software driver draws as coarsely as it may.
                let elapsed = start.elapsed() + Duration::from_secs(1);
                editor.note_frame(if is_quick.load(Ordering::Relaxed) { Duration::ZERO } else { elapsed });
            },
            editor,
        );
        let mut window = Self { gpu, harness, folder, log, has_time };
        window.frames(6);
        window
    }

    /// A device to draw on.
    pub fn new_gpu() -> Gpu {
        drawing_gpu(&Settings { adapter: Adapter::Software, ..settings() }).unwrap()
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn editor(&mut self) -> &mut Editor {
        self.harness.state_mut()
    }

    pub fn frames(&mut self, num: usize) {
        self.harness.run_steps(num);
    }

    /// Until nothing is under way.
    pub fn settle(&mut self) {
        let start = Instant::now();
        self.frames(2);
        while !self.harness.state().is_settled() {
            assert!(start.elapsed() < WAIT, "it never settles: {:?}", self.harness.state().last_message());
            std::thread::sleep(Duration::from_millis(2));
            self.harness.step();
        }
        self.frames(2);
    }

    /// Presses or lifts the left button somewhere.
    pub fn button(&mut self, pos: Pos2, pressed: bool, modifiers: Modifiers) {
        self.harness.event(Event::PointerMoved(pos));
        self.harness.event(Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers });
        self.harness.step();
    }

    /// Draws along points of the window with the left button.
    pub fn draw(&mut self, points: &[Pos2], modifiers: Modifiers) {
        self.button(points[0], true, modifiers);
        for point in points {
            self.harness.event(Event::PointerMoved(*point));
            self.harness.step();
        }
        self.button(points[points.len() - 1], false, modifiers);
        self.settle();
    }

    /// Replaces what a text field says.
    pub fn type_into(&mut self, label: &str, text: &str) {
        self.harness.get_by_label(label).focus();
        self.frames(2);
        self.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        self.frames(1);
        self.harness.event(Event::Text(text.to_owned()));
        self.frames(2);
    }

    /// Types into a field for a number.
    pub fn type_number(&mut self, label: &str, text: &str) {
        self.harness.get_by_role_and_label(egui::accesskit::Role::SpinButton, label).focus();
        self.frames(2);
        self.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        self.frames(1);
        self.harness.event(Event::Text(text.to_owned()));
        self.harness.key_press(Key::Enter);
        self.frames(3);
    }

    /// Drops a file of the folder on the window.
    pub fn drop_file(&mut self, name: &str) {
        let file = Arc::new(Dropped(self.path(name)));
        self.harness.input_mut().dropped_files.push(file);
    }

    pub fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.frames(3);
    }

    /// What the history's entries are called, oldest first.
    pub fn history(&mut self) -> Vec<String> {
        self.harness.state().history().iter().map(|item| item.label.clone()).collect()
    }

    pub fn layers(&mut self) -> Vec<String> {
        self.harness.state().layers().iter().map(|layer| layer.name.clone()).collect()
    }

    /// All heights of a terrain that is closed or open, as bits.
    pub fn heights(path: &Path) -> Vec<u32> {
        let terrain = Terrain::open_to_read(path, settings()).unwrap();
        let (_, _, heights) = terrain.heights(&ExportSource::Composite, None, 0).unwrap();
        heights.into_iter().map(f32::to_bits).collect()
    }

    /// How much of each sample is selected.
    pub fn selected(path: &Path) -> Vec<f32> {
        let terrain = Terrain::open_to_read(path, settings()).unwrap();
        terrain.heights(&ExportSource::Selection, None, 0).unwrap().2
    }

    /// Gives a command, and waits until what it does is done.
    pub fn run(&mut self, command: Command) {
        let ctx = self.harness.ctx.clone();
        self.editor().run(command, &ctx);
        self.settle();
    }

    /// Closes the terrain, and gives the folder.
    pub fn close(mut self) -> tempfile::TempDir {
        self.editor().close().unwrap();
        let Self { harness, folder, .. } = self;
        drop(harness);
        folder
    }
}

/// A curve over the ground.
pub fn curve(num: u32) -> Vec<Pos2> {
    (0..num)
        .map(|k| {
            let along = k as f32 / num as f32;
            pos2(MIDDLE.x - 90.0 + 180.0 * along, MIDDLE.y + 40.0 * (7.0 * along).sin())
        })
        .collect()
}

/// A picture of the ground, as colours for egui.
pub fn pixels(gpu: &Gpu, view: &wgpu::TextureView) -> ColorImage {
    let texture = view.texture();
    let (device, queue) = (gpu.device(), gpu.queue());
    let (width, height) = (texture.width(), texture.height());
    let row_bytes = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row_bytes) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
    queue.submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |mapped| mapped.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let bytes = buffer.slice(..).get_mapped_range().unwrap();
    let rows = bytes.chunks_exact(row_bytes as usize);
    let rgb: Vec<u8> = rows
        .flat_map(|row| {
            row[..4 * width as usize].chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
        })
        .collect();
    ColorImage::from_rgb([width as usize, height as usize], &rgb)
}
