//! The window itself on a screen that no one sees: what is lost with a device that draws in it, and what comes back.
//!
//! A process has one loop of events, and a screen is named to it by the environment; so the window opens in a child.

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

use egui::{Event, Modifiers, PointerButton, Pos2, pos2};
use orogeny_engine::{Adapter, Operation, Presets, Quiet, Settings, Terrain, TerrainGrid};
use orogeny_tests::child::{acknowledge, acknowledged, child, child_path};
use orogeny_tests::{Screen as HiddenScreen, skip};
use winit::platform::x11::EventLoopBuilderExtX11 as _;

use super::*;
use crate::{Log, Preferences};

const WAIT: Duration = Duration::from_secs(120);
/// Where the child finds what the screen shows.
const FRAMEBUFFER: &str = "OROGENY_TEST_FRAMEBUFFER";
/// What of it is read: `[left, top, right, bottom]`, in pixels. Letters, and the ground.
const LETTERS: [usize; 4] = [0, 24, 250, 500];
const GROUND: [usize; 4] = [400, 250, 1000, 700];
/// The points of the stroke, and the one at which the device goes.
const NUM_POINTS: u16 = 16;
const LOST_AT: u16 = 8;

/// Colours that differ in a part of what the screen shows.
fn num_colours(framebuffer: &Path, [left, top, right, bottom]: [usize; 4]) -> usize {
    let bytes = std::fs::read(framebuffer).unwrap();
    let (numbers, _) = bytes.as_chunks::<4>();
    // The head of an XWD file: its own length, bytes of a row, colours between it and the rows.
    let head = |index: usize| u32::from_be_bytes(numbers[index]) as usize;
    let (start, row_bytes) = (head(0) + 12 * head(19), head(12));
    let pixels = (top..bottom).flat_map(|y| (left..right).map(move |x| start + y * row_bytes + 4 * x));
    pixels.map(|at| bytes[at..at + 3].to_vec()).collect::<std::collections::HashSet<_>>().len()
}

fn settings() -> Settings {
    Settings { adapter: Adapter::Cpu, page_budget_in_bytes: 64 << 20, ..Settings::default() }
}

fn point(index: u16) -> Pos2 {
    pos2(620.0 + 10.0 * f32::from(index), 480.0 + 6.0 * f32::from(index % 5))
}

/// How far the hand of the test has come.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    Opening,
    Drawing(u16),
    Waiting,
    Closing,
}

/// The program, with a hand that draws in it.
struct Driven {
    program: Program,
    framebuffer: PathBuf,
    step: Step,
    start: Instant,
    /// Frames since the last step.
    num_frames: u32,
}

impl Driven {
    fn drive(&mut self) {
        assert!(self.start.elapsed() < WAIT, "it never comes beyond {:?}", self.step);
        let Some(shown) = &mut self.program.shown else { return };
        let events = &mut shown.input.egui_input_mut().events;
        let is_settled = shown.editor.is_settled() && shown.editor.open_file().is_some();
        let colours = |what: &str| {
            let [letters, ground] = [LETTERS, GROUND].map(|part| num_colours(&self.framebuffer, part));
            acknowledge(&format!("{what} {letters} {ground}"));
        };
        let button = |pos, pressed| {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            Event::PointerButton { pos, button, pressed, modifiers }
        };
        self.step = match self.step {
            Step::Opening if is_settled && self.num_frames > 20 => {
                colours("before");
                events.extend([Event::PointerMoved(point(0)), button(point(0), true)]);
                Step::Drawing(0)
            }
            Step::Drawing(index) if self.num_frames > 0 => {
                events.push(Event::PointerMoved(point(index)));
                if index == LOST_AT {
                    shown.screen.gpu.device().destroy();
                }
                if index < NUM_POINTS {
                    Step::Drawing(index + 1)
                } else {
                    events.push(button(point(index), false));
                    Step::Waiting
                }
            }
            Step::Waiting if is_settled && self.num_frames > 20 => {
                colours("after");
                acknowledge(&format!("devices {}", shown.num_devices));
                for item in shown.editor.history() {
                    acknowledge(&format!("entry {}", item.label));
                }
                shown.screen.gpu.check().unwrap();
                shown.editor.request_close();
                Step::Closing
            }
            step => {
                shown.window.request_redraw();
                return self.step = step;
            }
        };
        self.num_frames = 0;
        shown.window.request_redraw();
    }
}

impl ApplicationHandler<Happened> for Driven {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        self.program.resumed(events);
    }

    fn user_event(&mut self, events: &ActiveEventLoop, happened: Happened) {
        self.program.user_event(events, happened);
    }

    fn window_event(&mut self, events: &ActiveEventLoop, window: WindowId, event: WindowEvent) {
        self.num_frames += u32::from(matches!(event, WindowEvent::RedrawRequested));
        self.program.window_event(events, window, event);
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        self.program.about_to_wait(events);
        self.drive();
        events.set_control_flow(ControlFlow::wait_duration(Duration::from_millis(15)));
    }
}

/// What the child does.
fn draw_in_a_window(folder: &Path) {
    let options = EditorOptions {
        settings: settings(),
        presets: Presets::open(None),
        log: Log::default(),
        own_brushes: None,
        preferences: Some(folder.join("editor.json")),
        bundled: Box::new(|| Err(orogeny_engine::Error::Cancelled)),
    };
    let mut builder = EventLoop::<Happened>::with_user_event();
    let events = builder.with_any_thread(true).build().unwrap();
    let start = Some((options, Some(folder.join("t.orogeny"))));
    let program = Program { start, proxy: events.create_proxy(), shown: None, failure: None };
    let framebuffer = PathBuf::from(std::env::var_os(FRAMEBUFFER).unwrap());
    let mut driven =
        Driven { program, framebuffer, step: Step::Opening, start: Instant::now(), num_frames: 0 };
    events.run_app(&mut driven).unwrap();
    assert!(driven.program.failure.is_none(), "{:?}", driven.program.failure);
    acknowledge("closed");
}

/// In mid-stroke the device goes: the window takes another one, letters and ground are seen on it, the stroke goes on, and what was done before
/// and is done then is on disk.
#[test]
fn a_device_that_is_lost_in_mid_stroke_costs_the_window_nothing() {
    if let Some(folder) = child_path() {
        return draw_in_a_window(&folder);
    }
    let folder = tempfile::tempdir().unwrap();
    let Some(screen) = HiddenScreen::new(Some(folder.path())) else {
        return skip("window", "Xvfb is not there; `cargo xtask setup` installs it");
    };
    let path = folder.path().join("t.orogeny");
    let grid = TerrainGrid::new(600, 600, 1.0).unwrap();
    let mut terrain = Terrain::create(&path, grid, 10.0, settings()).unwrap();
    let fill = r#"{"op": "fill", "brush": {"type": "noise", "feature_size": 300, "strength": 25}}"#;
    terrain.apply(&[Operation::from_json_text(fill).unwrap()], &mut Quiet).unwrap();
    terrain.close().unwrap();
    let preferences = Preferences { has_seen_tutorial: true, ..Preferences::default() };
    preferences.write(&folder.path().join("editor.json")).unwrap();

    let test = "window::tests::a_device_that_is_lost_in_mid_stroke_costs_the_window_nothing";
    let mut command = child(test, folder.path());
    command.env("DISPLAY", &screen.display).env_remove("WAYLAND_DISPLAY");
    command.env(FRAMEBUFFER, folder.path().join("Xvfb_screen0")).stderr(Stdio::piped());
    let output = command.output().unwrap();
    let told = acknowledged(&output.stdout);
    assert!(output.status.success(), "{told:?} {}", String::from_utf8_lossy(&output.stderr));
    let colours = |what: &str| -> Vec<usize> {
        let line = told.iter().find_map(|line| line.strip_prefix(what)).unwrap();
        line.split_whitespace().map(|number| number.parse().unwrap()).collect()
    };
    let (before, after) = (colours("before"), colours("after"));
    assert!(before[0] > 30 && before[1] > 100, "{before:?}");
    assert!(after[0] > before[0] / 2 && after[1] > before[1] / 2, "{before:?} {after:?}");
    let others: Vec<_> =
        told.iter().filter(|line| !line.starts_with("before ") && !line.starts_with("after ")).collect();
    assert_eq!(others, ["devices 2", "entry fill noise", "entry stroke raise", "closed"]);
    assert!(Terrain::check(&path).unwrap().problems.is_empty());
}
