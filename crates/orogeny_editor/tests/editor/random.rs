//! Whatever hands may do: keys, clicks, drags, wheels, sizes of the window and files dropped on it, by chance.

use std::time::{Duration, Instant};

use egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, TouchPhase, pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use orogeny_engine::Terrain;

use crate::support::{Window, make_terrain};

/// What is done in a usual run; what of each seed in a long one, and for how long that goes on.
const NUM_STEPS: u32 = 60;
const LONG_STEPS: u32 = 2000;
const LONG: Duration = Duration::from_secs(600);

/// Numbers by xorshift64*.
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        ((self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) as usize) % limit
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    fn place(&mut self) -> Pos2 {
        // Mostly over the ground, where most can be done.
        let (width, height) = if self.below(4) > 0 { (400, 500) } else { (1000, 760) };
        let first = if width == 400 { pos2(290.0, 40.0) } else { Pos2::ZERO };
        first + vec2(self.below(width) as f32, self.below(height) as f32)
    }

    fn modifiers(&mut self) -> Modifiers {
        let held = [Modifiers::NONE, Modifiers::NONE, Modifiers::SHIFT, Modifiers::COMMAND, Modifiers::ALT];
        let (one, other) = (self.one_of(&held), self.one_of(&held));
        one | other
    }
}

fn button(pos: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) -> Event {
    Event::PointerButton { pos, button, pressed, modifiers }
}

/// One thing that is done. Nothing is typed where a file's name is: files are only made where the test has its folder.
fn act(window: &mut Window, chance: &mut Chance) {
    let buttons = [
        PointerButton::Primary,
        PointerButton::Primary,
        PointerButton::Primary,
        PointerButton::Secondary,
        PointerButton::Middle,
    ];
    let at_path = window.harness.query_by_label("Path").is_some();
    match chance.below(20) {
        0..=6 => {
            let (which, modifiers) = (chance.one_of(&buttons), chance.modifiers());
            let mut at = chance.place();
            window.harness.event(Event::PointerMoved(at));
            window.harness.event(button(at, which, true, modifiers));
            for _ in 0..chance.below(8) {
                window.harness.step();
                at += vec2(chance.below(61) as f32 - 30.0, chance.below(61) as f32 - 30.0);
                window.harness.event(Event::PointerMoved(at));
            }
            // Some are let go only when something else is pressed.
            if chance.below(10) > 0 {
                window.harness.event(button(at, which, false, modifiers));
            }
        }
        7..=12 => {
            let (key, modifiers) = (chance.one_of(Key::ALL), chance.modifiers());
            if !at_path {
                window.harness.key_press_modifiers(modifiers, key);
            }
        }
        13 if !at_path => {
            let text = chance.one_of(&["a", "7", "-", ".", "1e9", "ä", " ", "NaN"]);
            window.harness.event(Event::Text(text.to_owned()));
        }
        14 => window.harness.key_press(chance.one_of(&[Key::Escape, Key::Enter, Key::Tab])),
        15 | 16 => {
            window.harness.event(Event::PointerMoved(chance.place()));
            window.harness.event(Event::MouseWheel {
                unit: MouseWheelUnit::Line,
                delta: vec2(0.0, chance.below(9) as f32 - 4.0),
                phase: TouchPhase::Move,
                source: egui::MouseWheelSource::Wheel,
                modifiers: chance.modifiers(),
            });
        }
        17 => {
            let size = chance.one_of(&[
                vec2(1000.0, 760.0),
                vec2(640.0, 400.0),
                vec2(200.0, 90.0),
                vec2(1300.0, 800.0),
            ]);
            window.harness.set_size(size);
        }
        18 => {
            let name =
                chance.one_of(&["t.orogeny", "other.orogeny", "no.orogeny", "heights.r16", "notes.txt"]);
            window.drop_file(name);
        }
        _ => std::thread::sleep(Duration::from_millis(5)),
    }
    window.harness.step();
}

fn run(seed: u64, is_done: impl Fn(u32) -> bool) -> u32 {
    let mut window = Window::open();
    make_terrain(&window.path("other.orogeny"));
    std::fs::write(window.path("heights.r16"), vec![7_u8; 2 * 65 * 65]).unwrap();
    std::fs::write(window.path("notes.txt"), "no heights").unwrap();
    let mut chance = Chance(seed);
    let mut step = 0;
    while !is_done(step) {
        act(&mut window, &mut chance);
        step += 1;
    }
    window.harness.set_size(vec2(1000.0, 760.0));
    for _ in 0..4 {
        window.harness.key_press(Key::Escape);
        window.frames(2);
    }
    window.settle();
    let folder = window.close();
    for name in ["t.orogeny", "other.orogeny"] {
        let report = Terrain::check(&folder.path().join(name)).unwrap();
        assert!(report.problems.is_empty(), "seed {seed}, {name}: {:?}", report.problems);
    }
    step
}

#[test]
fn whatever_is_done_by_chance_neither_panics_nor_harms_a_terrain() {
    if std::env::var_os("OROGENY_TEST_LONG").is_some() {
        let start = Instant::now();
        let mut seed = 1;
        while start.elapsed() < LONG {
            let num_steps = run(seed, |step| step >= LONG_STEPS || start.elapsed() > LONG);
            println!("seed {seed}: {num_steps} steps, {:.0} s so far", start.elapsed().as_secs_f64());
            seed += 1;
        }
    } else {
        assert_eq!(run(54, |step| step >= NUM_STEPS), NUM_STEPS);
    }
}
