//! Which keys give which command, after the habits of several programs.

use std::collections::BTreeMap;

use egui::{Event, Key, KeyboardShortcut, Modifiers};
use orogeny_engine::{BrushType, Mode};

use crate::{Command, Hand};

/// Whose keys are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Habit {
    /// This program's own.
    #[default]
    Orogeny,
    /// Unreal Engine's landscape mode.
    Unreal,
    /// Unity's terrain tools.
    Unity,
    /// Godot's editor with a terrain add-on.
    Godot,
    /// Blender's sculpt mode.
    Blender,
}

impl Habit {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Orogeny, Self::Unreal, Self::Unity, Self::Godot, Self::Blender];

    /// What people call it.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Orogeny => "Orogeny",
            Self::Unreal => "Unreal",
            Self::Unity => "Unity",
            Self::Godot => "Godot",
            Self::Blender => "Blender",
        }
    }

    /// What it has otherwise than this program's own.
    fn others(self) -> Vec<(Command, KeyboardShortcut)> {
        match self {
            Self::Orogeny => Vec::new(),
            Self::Unreal => vec![
                (Command::FrameAll, key(Key::F)),
                (Command::Redo, control(Key::Y)),
                (Command::Mode(Mode::Wireframe), alt(Key::Num2)),
                (Command::Mode(Mode::Textured), alt(Key::Num4)),
                (Command::Mode(Mode::Shaded), alt(Key::Num3)),
            ],
            Self::Unity => vec![
                (Command::Redo, control(Key::Y)),
                (Command::Brush(BrushType::Raise), key(Key::F1)),
                (Command::Brush(BrushType::SetHeight), key(Key::F2)),
                (Command::Brush(BrushType::Smooth), key(Key::F3)),
                (Command::Brush(BrushType::Stamp), key(Key::F4)),
            ],
            Self::Godot => vec![
                (Command::Brush(BrushType::Raise), key(Key::E)),
                (Command::Brush(BrushType::Smooth), key(Key::R)),
                (Command::Brush(BrushType::SetHeight), key(Key::H)),
                (Command::Brush(BrushType::PaintMask), key(Key::B)),
            ],
            Self::Blender => vec![
                (Command::FrameAll, key(Key::Home)),
                (Command::LookDown, key(Key::Num7)),
                (Command::CommandPalette, key(Key::F3)),
                (Command::Brush(BrushType::Raise), key(Key::X)),
                (Command::Brush(BrushType::Grab), key(Key::G)),
                (Command::Brush(BrushType::Level), shift(Key::T)),
                (Command::Mode(Mode::Wireframe), shift(Key::Z)),
            ],
        }
    }
}

/// Keys of commands.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Keymap {
    keys: BTreeMap<String, (Command, KeyboardShortcut)>,
}

const fn key(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}

const fn control(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

const fn control_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key)
}

const fn shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::SHIFT, key)
}

const fn alt(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::ALT, key)
}

impl Keymap {
    /// Those of a habit, with changes of the user's: ids of commands and keys as [`Self::text`] writes them, empty for none.
    /// What cannot be understood of them is left out.
    #[must_use]
    pub fn new(habit: Habit, changes: &BTreeMap<String, String>) -> Self {
        let numbers = [Key::Num1, Key::Num2, Key::Num3, Key::Num4];
        let places = (1..).zip(numbers).flat_map(|(number, key)| {
            [(Command::KeepPlace(number), control(key)), (Command::GoToPlace(number), alt(key))]
        });
        let own = [
            (Command::New, control(Key::N)),
            (Command::Open, control(Key::O)),
            (Command::Import, control(Key::I)),
            (Command::Export, control(Key::E)),
            (Command::Quit, control(Key::Q)),
            (Command::Undo, control(Key::Z)),
            (Command::Redo, control_shift(Key::Z)),
            (Command::Cancel, key(Key::Escape)),
            (Command::FrameAll, key(Key::F)),
            (Command::LookDown, key(Key::T)),
            (Command::SplitView, control(Key::Backslash)),
            (Command::SwitchView, key(Key::Backslash)),
            (Command::Larger, key(Key::CloseBracket)),
            (Command::Smaller, key(Key::OpenBracket)),
            (Command::Stronger, key(Key::Equals)),
            (Command::Weaker, key(Key::Minus)),
            (Command::CopyFromHere, key(Key::C)),
            (Command::TakeHeight, key(Key::H)),
            (Command::Copy, control(Key::C)),
            (Command::Paste, control(Key::V)),
            (Command::PutDown, key(Key::Enter)),
            (Command::SelectAll, control(Key::A)),
            (Command::SelectNothing, control(Key::D)),
            (Command::InvertSelection, control_shift(Key::I)),
            (Command::Hand(Hand::Brush), key(Key::B)),
            (Command::Hand(Hand::Rectangle), key(Key::R)),
            (Command::Hand(Hand::Lasso), key(Key::O)),
            (Command::Hand(Hand::Tape), key(Key::M)),
            (Command::ShowMap, control(Key::M)),
            (Command::ShowHistogram, control(Key::H)),
            (Command::ShowLog, control(Key::L)),
            (Command::Compare, shift(Key::V)),
            (Command::SeeEarlier, key(Key::V)),
            (Command::CommandPalette, control(Key::P)),
            (Command::LargerInterface, control(Key::Equals)),
            (Command::SmallerInterface, control(Key::Minus)),
            (Command::ShowPreferences, control(Key::Comma)),
            (Command::Brush(BrushType::Raise), key(Key::Num1)),
            (Command::Brush(BrushType::Lower), key(Key::Num2)),
            (Command::Brush(BrushType::Smooth), key(Key::Num3)),
            (Command::Brush(BrushType::Level), key(Key::Num4)),
            (Command::Brush(BrushType::Ramp), key(Key::Num5)),
            (Command::Brush(BrushType::Noise), key(Key::Num6)),
            (Command::Brush(BrushType::ErodeFluvial), key(Key::Num7)),
            (Command::Brush(BrushType::Clone), key(Key::Num8)),
            (Command::Brush(BrushType::PaintMask), key(Key::Num9)),
        ];
        let mut keymap = Self::default();
        for (command, shortcut) in own.into_iter().chain(places).chain(habit.others()) {
            keymap.set(command, Some(shortcut));
        }
        for (id, text) in changes {
            let Some(command) = Command::all().find(|command| command.id() == *id) else { continue };
            match Self::parse(text) {
                Some(shortcut) => keymap.set(command, Some(shortcut)),
                None if text.is_empty() => keymap.set(command, None),
                None => {}
            }
        }
        keymap
    }

    /// Gives a command a key, which whatever had it before loses.
    fn set(&mut self, command: Command, shortcut: Option<KeyboardShortcut>) {
        if let Some(shortcut) = shortcut {
            self.keys.retain(|_, (_, taken)| *taken != shortcut);
            self.keys.insert(command.id(), (command, shortcut));
        } else {
            self.keys.remove(&command.id());
        }
    }

    /// The keys of a command.
    #[must_use]
    pub fn shortcut(&self, command: Command) -> Option<KeyboardShortcut> {
        self.keys.get(&command.id()).map(|(_, shortcut)| *shortcut)
    }

    /// The commands whose keys were pressed, those with most modifiers first, as `Ctrl+Shift+Z` is no `Ctrl+Z`. Redo has `Ctrl+Y` too.
    pub fn take_pressed(&self, input: &mut egui::InputState) -> Vec<Command> {
        let mut keys: Vec<_> = self.keys.values().copied().collect();
        if !keys.iter().any(|(_, shortcut)| *shortcut == control(Key::Y)) {
            keys.push((Command::Redo, control(Key::Y)));
        }
        let num_modifiers = |shortcut: &KeyboardShortcut| {
            let Modifiers { alt, shift, command, ctrl, .. } = shortcut.modifiers;
            [alt, shift, command, ctrl].into_iter().filter(|is_held| *is_held).count()
        };
        keys.sort_by_key(|(_, shortcut)| std::cmp::Reverse(num_modifiers(shortcut)));
        keys.into_iter()
            .filter(|(_, shortcut)| input.consume_shortcut(shortcut) || take_clipboard(input, shortcut))
            .map(|(command, _)| command)
            .collect()
    }

    /// Takes what was typed after the key of a command that opens a dialog: it is for that, and no keys of other commands. On a slow
    /// machine all of it comes in one frame.
    pub fn take_late(&self, events: &mut Vec<Event>) -> Vec<Event> {
        let opens = |event: &Event| {
            let Event::Key { key, pressed: true, modifiers, .. } = event else { return false };
            let is_it = |shortcut: &KeyboardShortcut| {
                shortcut.logical_key == *key && modifiers.matches_logically(shortcut.modifiers)
            };
            self.keys.values().any(|(command, shortcut)| command.opens_dialog() && is_it(shortcut))
        };
        let Some(opening) = events.iter().position(opens) else { return Vec::new() };
        let after = events.split_off(opening + 1);
        let is_typed = |event: &Event| matches!(event, Event::Key { .. } | Event::Text(_) | Event::Paste(_));
        let (typed, others): (Vec<_>, Vec<_>) = after.into_iter().partition(is_typed);
        events.extend(others);
        typed
    }

    /// A key for preferences: `Ctrl+Shift+Z`.
    #[must_use]
    pub fn text(shortcut: &KeyboardShortcut) -> String {
        let Modifiers { alt, shift, command, ctrl, .. } = shortcut.modifiers;
        let held = [("Ctrl", command || ctrl), ("Alt", alt), ("Shift", shift)];
        let held = held.into_iter().filter(|(_, is_held)| *is_held).map(|(name, _)| name);
        held.chain([shortcut.logical_key.name()]).collect::<Vec<_>>().join("+")
    }

    /// The other way round; `None` for what is no key.
    #[must_use]
    pub fn parse(text: &str) -> Option<KeyboardShortcut> {
        let mut modifiers = Modifiers::NONE;
        let (held, name) = text.rsplit_once('+').map_or(("", text), |(held, name)| (held, name));
        for name in held.split('+').filter(|name| !name.is_empty()) {
            modifiers = modifiers.plus(match name {
                "Ctrl" => Modifiers::COMMAND,
                "Alt" => Modifiers::ALT,
                "Shift" => Modifiers::SHIFT,
                _ => return None,
            });
        }
        Some(KeyboardShortcut::new(modifiers, Key::from_name(name)?))
    }
}

/// Whether keys were pressed that come as what they usually do with the clipboard.
fn take_clipboard(input: &mut egui::InputState, shortcut: &KeyboardShortcut) -> bool {
    let is_it = |event: &Event| match event {
        Event::Copy => *shortcut == control(Key::C),
        Event::Cut => *shortcut == control(Key::X),
        Event::Paste(_) => *shortcut == control(Key::V),
        _ => false,
    };
    let num_events = input.events.len();
    input.events.retain(|event| !is_it(event));
    input.events.len() < num_events
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_has_two_commands() {
        for habit in Habit::ALL {
            let keymap = Keymap::new(habit, &BTreeMap::new());
            let mut keys: Vec<_> = keymap.keys.values().map(|(_, key)| Keymap::text(key)).collect();
            keys.sort();
            let num_keys = keys.len();
            keys.dedup();
            assert_eq!(keys.len(), num_keys, "{habit:?}");
            assert!(keymap.shortcut(Command::Undo).is_some() && keymap.shortcut(Command::Cancel).is_some());
        }
    }

    #[test]
    fn keys_are_written_and_read_back() {
        for habit in Habit::ALL {
            for (_, shortcut) in Keymap::new(habit, &BTreeMap::new()).keys.values() {
                let text = Keymap::text(shortcut);
                let read = Keymap::parse(&text).unwrap();
                assert_eq!(Keymap::text(&read), text);
            }
        }
        assert!(Keymap::parse("Hyper+Z").is_none() && Keymap::parse("Ctrl+Nothing").is_none());
    }

    #[test]
    fn the_user_s_changes_come_last() {
        let changes = BTreeMap::from([
            ("undo".to_owned(), "Alt+U".to_owned()),
            ("frame_all".to_owned(), String::new()),
            ("larger".to_owned(), "no key".to_owned()),
            ("no command".to_owned(), "Q".to_owned()),
        ]);
        let keymap = Keymap::new(Habit::Orogeny, &changes);
        assert_eq!(keymap.shortcut(Command::Undo).map(|key| Keymap::text(&key)).unwrap(), "Alt+U");
        assert!(keymap.shortcut(Command::FrameAll).is_none());
        assert!(keymap.shortcut(Command::Larger).is_some());
    }
}
