//! The editor in a real window, on a screen that no one sees, driven by mouse and keys as by a person.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use orogeny_tests::{Killed, Screen, skip};
use serde_json::{Value, json};

use crate::program::Folder;

const WAIT: Duration = Duration::from_secs(120);
/// What a frame takes at most on a busy machine: what is typed before a dialog is there is not for it, and what is drawn before one is gone is
/// not for the ground.
const FRAME: Duration = Duration::from_secs(3);
/// The middle of the ground in the window.
const MIDDLE: [i32; 2] = [700, 480];

/// Someone before a screen, with a mouse and keys.
struct Person(Screen);

impl Person {
    /// `None` where there is no program that makes a screen, or none that moves hands.
    fn new() -> Option<Self> {
        let asked =
            Command::new("xdotool").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        asked.is_ok_and(|status| status.success()).then(|| Screen::new(None))?.map(Self)
    }

    fn hands(&self, arguments: &[&str]) {
        let status =
            Command::new("xdotool").env("DISPLAY", &self.0.display).args(arguments).status().unwrap();
        assert!(status.success(), "xdotool {arguments:?}");
    }

    fn key(&self, key: &str) {
        self.hands(&["key", "--clearmodifiers", key]);
        std::thread::sleep(Duration::from_millis(300));
    }

    fn words(&self, text: &str) {
        self.hands(&["type", "--delay", "30", text]);
        std::thread::sleep(Duration::from_millis(300));
    }

    fn move_to(&self, x: i32, y: i32) {
        self.hands(&["mousemove", &x.to_string(), &y.to_string()]);
        std::thread::sleep(Duration::from_millis(25));
    }

    /// Draws with the left button; leaves it pressed if so asked.
    fn draw(&self, is_left_pressed: bool) {
        std::thread::sleep(FRAME);
        let [x, y] = MIDDLE;
        self.move_to(x - 80, y);
        self.hands(&["mousedown", "1"]);
        for step in 0..16 {
            self.move_to(x - 80 + 10 * step, y + (step % 5) * 6);
        }
        if !is_left_pressed {
            self.hands(&["mouseup", "1"]);
        }
    }

    fn editor(&self, folder: &Folder) -> Killed {
        let mut command = folder.command("edit t.orogeny --preferences editor.json");
        command.env("DISPLAY", &self.0.display).env_remove("WAYLAND_DISPLAY");
        command.stdout(Stdio::null()).stderr(std::fs::File::create(folder.path("stderr.txt")).unwrap());
        let child = Killed(command.spawn().unwrap());
        self.hands(&["search", "--sync", "--onlyvisible", "--name", "^Orogeny$"]);
        // There is no window manager that would do it.
        self.hands(&["search", "--name", "^Orogeny$", "windowfocus"]);
        until("the terrain is open", || {
            let text = String::from_utf8(folder.read("editor.json")).unwrap();
            let preferences: Value = serde_json::from_str(&text).unwrap_or_default();
            preferences["recent"][0].as_str().is_some_and(|path| path.ends_with("t.orogeny"))
        });
        child
    }
}

fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < WAIT, "never: {what}");
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// Operations of the history that show.
fn applied(folder: &Folder) -> Vec<String> {
    let log = folder.succeed("log t.orogeny");
    let entries = log["entries"].as_array().unwrap().iter();
    let is_applied = |entry: &&Value| entry["state"] == "applied";
    entries
        .filter(is_applied)
        .map(|entry| entry["operation"]["op"].as_str().unwrap_or("?").to_owned())
        .collect()
}

#[test]
fn a_person_paints_exports_is_cut_off_and_goes_on() {
    let Some(screen) = Person::new() else {
        return skip("edit", "Xvfb and xdotool are not both there; `cargo xtask setup` installs them");
    };
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 600x600 --spacing 1");
    folder.write("editor.json", json!({"has_seen_tutorial": true, "mode": "shaded"}).to_string());
    let mut editor = screen.editor(&folder);

    screen.draw(false);
    until("a stroke is done", || applied(&folder) == ["stroke"]);
    screen.key("ctrl+z");
    until("it is taken back", || applied(&folder).is_empty());
    screen.key("ctrl+shift+z");
    until("it is done again", || applied(&folder) == ["stroke"]);
    screen.key("ctrl+p");
    std::thread::sleep(FRAME);
    screen.words("add layer");
    screen.key("Return");
    until("there is a layer more", || applied(&folder) == ["stroke", "add_layer"]);
    screen.draw(false);
    until("it is drawn on", || applied(&folder) == ["stroke", "add_layer", "stroke"]);

    screen.key("ctrl+e");
    std::thread::sleep(FRAME);
    screen.key("ctrl+a");
    screen.words(folder.path("out.r32").to_str().unwrap());
    screen.key("Return");
    until("heights are written", || {
        folder.path("out.r32").is_file() && folder.read("out.r32").len() == 600 * 600 * 4
    });
    let seen = folder.heights("out.r32");
    folder.succeed("export t.orogeny beside.r32");
    assert!(seen == folder.heights("beside.r32"), "other heights than are there");
    assert!(seen.iter().any(|height_m| *height_m > 0.0));

    // Cut off in the middle of a stroke.
    screen.draw(true);
    editor.0.kill().unwrap();
    editor.0.wait().unwrap();
    screen.hands(&["mouseup", "1"]);
    folder.succeed("check t.orogeny");
    assert_eq!(applied(&folder), ["stroke", "add_layer", "stroke"]);

    let mut editor = screen.editor(&folder);
    screen.draw(false);
    until("it goes on", || applied(&folder).len() == 4);
    screen.key("ctrl+q");
    until("it ends", || editor.0.try_wait().unwrap().is_some());
    let status = editor.0.wait().unwrap();
    let said = String::from_utf8_lossy(&folder.read("stderr.txt")).into_owned();
    assert!(status.success(), "{said}");
    assert!(!folder.path("t.orogeny-wal").exists(), "the terrain is one file when it is closed");
    folder.succeed("check t.orogeny");
}
