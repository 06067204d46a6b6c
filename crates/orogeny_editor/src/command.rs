//! Everything that can be done by name: one list for menus, keys, the command palette and tests.

use orogeny_engine::{BrushType, Mode};

use crate::Hand;
use crate::preferences::NUM_PLACES;

/// Something that can be done by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Command {
    /// Make a terrain.
    New,
    /// Open a terrain.
    Open,
    /// Read heights of another program.
    Import,
    /// Write heights for another program.
    Export,
    /// Close the window.
    Quit,
    /// Take the last operation back.
    Undo,
    /// Do it again.
    Redo,
    /// Give up what is running and what waits.
    Cancel,
    /// Show all of the terrain.
    FrameAll,
    /// Look straight down on all of it.
    LookDown,
    /// See it from a second place beside the first, or no more.
    SplitView,
    /// Work in the other half of the view.
    SwitchView,
    /// Keep where the eye is under a number.
    KeepPlace(u8),
    /// Go back there.
    GoToPlace(u8),
    /// See by how much the terrain differs from how it was before the last entry of the history, or no more.
    Compare,
    /// See the terrain as it was, while the key is held.
    SeeEarlier,
    /// The terrain from above.
    ShowMap,
    /// How much of it lies how high.
    ShowHistogram,
    /// A brush twice as wide in three steps.
    Larger,
    /// And back.
    Smaller,
    /// A stronger brush.
    Stronger,
    /// And back.
    Weaker,
    /// Copy from what is under the pointer, by the brush for that.
    CopyFromHere,
    /// The height under the pointer is what the brush for that sets.
    TakeHeight,
    /// Add a brush that the user wrote.
    AddBrush,
    /// Take a preset from a file.
    AddPreset,
    /// Take a brush.
    Brush(BrushType),
    /// Have the left button do something.
    Hand(Hand),
    /// Show the ground so.
    Mode(Mode),
    /// Put a layer of heights on top.
    AddLayer,
    /// Put a layer on top that the brush makes, everywhere: it can be tuned later.
    AddProcedure,
    /// Put a layer on top that applies the brush to all that lies below: it can be tuned later.
    AddEffect,
    /// Give the layer that a brush makes the brush in the hand.
    TuneLayer,
    /// Make plain heights of the layer that is worked on.
    CollapseLayer,
    /// Copy the layer that is worked on.
    DuplicateLayer,
    /// Take it away.
    RemoveLayer,
    /// One up in the stack.
    RaiseLayer,
    /// One down.
    LowerLayer,
    /// Hide it or show it.
    ToggleLayer,
    /// Copy the ground that is selected.
    Copy,
    /// Have what was copied float over the ground.
    Paste,
    /// Blend what floats into the ground.
    PutDown,
    /// Select all of the terrain.
    SelectAll,
    /// Select nothing.
    SelectNothing,
    /// Select what is not selected.
    InvertSelection,
    /// Select what lies near to what is selected, too.
    GrowSelection,
    /// No longer select what lies near to its edge.
    ShrinkSelection,
    /// Make its edge soft.
    FeatherSelection,
    /// Show what is selected, whatever is in the hand.
    ShowSelection,
    /// Find a command by its name.
    CommandPalette,
    /// Light or dark.
    ToggleTheme,
    /// Everything larger.
    LargerInterface,
    /// Everything smaller.
    SmallerInterface,
    /// What was told.
    ShowMessages,
    /// What the program noted.
    ShowLog,
    /// Keys and more.
    ShowPreferences,
    /// The five first steps.
    ShowTutorial,
}

/// A menu of the bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Menu {
    /// Terrains and files.
    File,
    /// Back and forth, selections.
    Edit,
    /// Camera and modes.
    View,
    /// Brushes.
    Brush,
    /// The stack.
    Layer,
    /// The rest.
    Help,
}

impl Menu {
    /// From left to right.
    pub const ALL: [Self; 6] = [Self::File, Self::Edit, Self::View, Self::Brush, Self::Layer, Self::Help];

    /// Its title.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::View => "View",
            Self::Brush => "Brush",
            Self::Layer => "Layer",
            Self::Help => "Help",
        }
    }
}

impl Command {
    /// Those that stand alone, in the order of their menus.
    const PLAIN: [Self; 52] = [
        Self::New,
        Self::Open,
        Self::Import,
        Self::Export,
        Self::ShowPreferences,
        Self::Quit,
        Self::Undo,
        Self::Redo,
        Self::Cancel,
        Self::Copy,
        Self::Paste,
        Self::PutDown,
        Self::SelectAll,
        Self::SelectNothing,
        Self::InvertSelection,
        Self::GrowSelection,
        Self::ShrinkSelection,
        Self::FeatherSelection,
        Self::Compare,
        Self::SeeEarlier,
        Self::FrameAll,
        Self::LookDown,
        Self::SplitView,
        Self::SwitchView,
        Self::ShowSelection,
        Self::ShowMap,
        Self::ShowHistogram,
        Self::ToggleTheme,
        Self::LargerInterface,
        Self::SmallerInterface,
        Self::Larger,
        Self::Smaller,
        Self::Stronger,
        Self::Weaker,
        Self::CopyFromHere,
        Self::TakeHeight,
        Self::AddBrush,
        Self::AddPreset,
        Self::AddLayer,
        Self::AddProcedure,
        Self::AddEffect,
        Self::TuneLayer,
        Self::CollapseLayer,
        Self::DuplicateLayer,
        Self::RemoveLayer,
        Self::RaiseLayer,
        Self::LowerLayer,
        Self::ToggleLayer,
        Self::CommandPalette,
        Self::ShowMessages,
        Self::ShowLog,
        Self::ShowTutorial,
    ];

    /// All of them, in the order of their menus.
    pub fn all() -> impl Iterator<Item = Self> {
        let modes = Mode::ALL.into_iter().map(Self::Mode);
        let brushes = BrushType::ALL.into_iter().map(Self::Brush);
        let hands = Hand::ALL.into_iter().map(Self::Hand);
        let go = (1..=NUM_PLACES).map(Self::GoToPlace);
        let places = go.chain((1..=NUM_PLACES).map(Self::KeepPlace));
        Self::PLAIN.into_iter().chain(places).chain(hands).chain(modes).chain(brushes)
    }

    /// Never changes: what preferences call it.
    #[must_use]
    pub fn id(self) -> String {
        match self {
            Self::Brush(brush_type) => format!("brush.{}", brush_type.name()),
            Self::Mode(mode) => format!("mode.{}", mode.name()),
            Self::Hand(hand) => format!("hand.{}", hand.name()),
            Self::New => "new".to_owned(),
            Self::Open => "open".to_owned(),
            Self::Import => "import".to_owned(),
            Self::Export => "export".to_owned(),
            Self::Quit => "quit".to_owned(),
            Self::Undo => "undo".to_owned(),
            Self::Redo => "redo".to_owned(),
            Self::Cancel => "cancel".to_owned(),
            Self::FrameAll => "frame_all".to_owned(),
            Self::LookDown => "look_down".to_owned(),
            Self::SplitView => "split_view".to_owned(),
            Self::SwitchView => "switch_view".to_owned(),
            Self::KeepPlace(number) => format!("keep_place.{number}"),
            Self::GoToPlace(number) => format!("go_to_place.{number}"),
            Self::Compare => "compare".to_owned(),
            Self::SeeEarlier => "see_earlier".to_owned(),
            Self::ShowMap => "show_map".to_owned(),
            Self::ShowHistogram => "show_histogram".to_owned(),
            Self::Larger => "larger".to_owned(),
            Self::Smaller => "smaller".to_owned(),
            Self::Stronger => "stronger".to_owned(),
            Self::Weaker => "weaker".to_owned(),
            Self::CopyFromHere => "copy_from_here".to_owned(),
            Self::TakeHeight => "take_height".to_owned(),
            Self::AddBrush => "add_brush".to_owned(),
            Self::AddPreset => "add_preset".to_owned(),
            Self::AddLayer => "add_layer".to_owned(),
            Self::AddProcedure => "add_procedure".to_owned(),
            Self::AddEffect => "add_effect".to_owned(),
            Self::TuneLayer => "tune_layer".to_owned(),
            Self::CollapseLayer => "collapse_layer".to_owned(),
            Self::DuplicateLayer => "duplicate_layer".to_owned(),
            Self::RemoveLayer => "remove_layer".to_owned(),
            Self::RaiseLayer => "raise_layer".to_owned(),
            Self::LowerLayer => "lower_layer".to_owned(),
            Self::ToggleLayer => "toggle_layer".to_owned(),
            Self::Copy => "copy".to_owned(),
            Self::Paste => "paste".to_owned(),
            Self::PutDown => "put_down".to_owned(),
            Self::SelectAll => "select_all".to_owned(),
            Self::SelectNothing => "select_nothing".to_owned(),
            Self::InvertSelection => "invert_selection".to_owned(),
            Self::GrowSelection => "grow_selection".to_owned(),
            Self::ShrinkSelection => "shrink_selection".to_owned(),
            Self::FeatherSelection => "feather_selection".to_owned(),
            Self::ShowSelection => "show_selection".to_owned(),
            Self::CommandPalette => "command_palette".to_owned(),
            Self::ToggleTheme => "toggle_theme".to_owned(),
            Self::LargerInterface => "larger_interface".to_owned(),
            Self::SmallerInterface => "smaller_interface".to_owned(),
            Self::ShowMessages => "messages".to_owned(),
            Self::ShowLog => "log".to_owned(),
            Self::ShowPreferences => "preferences".to_owned(),
            Self::ShowTutorial => "tutorial".to_owned(),
        }
    }

    /// What people call it.
    #[must_use]
    pub fn title(self) -> String {
        match self {
            Self::Brush(brush_type) => capitalised(&format!("{} brush", words(brush_type.name()))),
            Self::Mode(mode) => format!("Show {}", words(mode.name())),
            Self::Hand(hand) => hand.title().to_owned(),
            Self::New => "New terrain…".to_owned(),
            Self::Open => "Open terrain…".to_owned(),
            Self::Import => "Import heights…".to_owned(),
            Self::Export => "Export heights…".to_owned(),
            Self::Cancel => "Cancel what is running".to_owned(),
            Self::FrameAll => "Show all of the terrain".to_owned(),
            Self::LookDown => "Look straight down".to_owned(),
            Self::SplitView => "Split the view, or close the other half".to_owned(),
            Self::SwitchView => "Work in the other half of the view".to_owned(),
            Self::KeepPlace(number) => format!("Keep this place as {number}"),
            Self::GoToPlace(number) => format!("Go to place {number}"),
            Self::Compare => "Compare with how it was before".to_owned(),
            Self::SeeEarlier => "See how it was, while the key is held".to_owned(),
            Self::ShowHistogram => "Show histogram of heights".to_owned(),
            Self::Larger => "Larger brush".to_owned(),
            Self::Smaller => "Smaller brush".to_owned(),
            Self::Stronger => "Stronger brush".to_owned(),
            Self::Weaker => "Weaker brush".to_owned(),
            Self::CopyFromHere => "Copy from under the pointer".to_owned(),
            Self::TakeHeight => "Take the height under the pointer".to_owned(),
            Self::AddBrush => "Add a brush of your own…".to_owned(),
            Self::AddPreset => "Add a preset from a file…".to_owned(),
            Self::Copy => "Copy the selected ground".to_owned(),
            Self::Paste => "Paste as a floating piece".to_owned(),
            Self::PutDown => "Put the floating piece down".to_owned(),
            Self::AddProcedure => "Add a layer that the brush makes".to_owned(),
            Self::AddEffect => "Add the brush as an effect on what lies below".to_owned(),
            Self::TuneLayer => "Give the layer the brush in the hand".to_owned(),
            Self::CollapseLayer => "Make plain heights of the layer".to_owned(),
            Self::RaiseLayer => "Move layer up".to_owned(),
            Self::LowerLayer => "Move layer down".to_owned(),
            Self::ToggleLayer => "Hide or show layer".to_owned(),
            Self::CommandPalette => "Find a command…".to_owned(),
            Self::ToggleTheme => "Light or dark".to_owned(),
            Self::ShowPreferences => "Preferences…".to_owned(),
            Self::ShowMessages => "Messages".to_owned(),
            Self::ShowTutorial => "First steps".to_owned(),
            other => capitalised(&words(&other.id())),
        }
    }

    /// Whether it opens a dialog, in which something is typed or chosen.
    #[must_use]
    pub const fn opens_dialog(self) -> bool {
        matches!(
            self,
            Self::New
                | Self::Open
                | Self::Import
                | Self::Export
                | Self::AddBrush
                | Self::AddPreset
                | Self::CommandPalette
                | Self::ShowPreferences
                | Self::ShowTutorial
        )
    }

    /// The menu that it stands in.
    #[must_use]
    pub const fn menu(self) -> Menu {
        match self {
            Self::New | Self::Open | Self::Import | Self::Export | Self::Quit | Self::ShowPreferences => {
                Menu::File
            }
            Self::Undo
            | Self::Redo
            | Self::Cancel
            | Self::Copy
            | Self::Paste
            | Self::PutDown
            | Self::SelectAll
            | Self::SelectNothing
            | Self::InvertSelection
            | Self::GrowSelection
            | Self::ShrinkSelection
            | Self::FeatherSelection
            | Self::Compare
            | Self::SeeEarlier
            | Self::Hand(_) => Menu::Edit,
            Self::FrameAll
            | Self::LookDown
            | Self::SplitView
            | Self::SwitchView
            | Self::Mode(_)
            | Self::ShowSelection
            | Self::ShowMap
            | Self::ShowHistogram
            | Self::KeepPlace(_)
            | Self::GoToPlace(_)
            | Self::ToggleTheme
            | Self::LargerInterface
            | Self::SmallerInterface => Menu::View,
            Self::Larger
            | Self::Smaller
            | Self::Stronger
            | Self::Weaker
            | Self::CopyFromHere
            | Self::TakeHeight
            | Self::AddBrush
            | Self::AddPreset
            | Self::Brush(_) => Menu::Brush,
            Self::AddLayer
            | Self::AddProcedure
            | Self::AddEffect
            | Self::TuneLayer
            | Self::CollapseLayer
            | Self::DuplicateLayer
            | Self::RemoveLayer
            | Self::RaiseLayer
            | Self::LowerLayer
            | Self::ToggleLayer => Menu::Layer,
            Self::CommandPalette | Self::ShowMessages | Self::ShowLog | Self::ShowTutorial => Menu::Help,
        }
    }
}

/// The name of something as words.
pub(crate) fn words(name: &str) -> String {
    name.replace(['_', '-'], " ")
}

/// With a capital at its front.
pub(crate) fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_command_has_an_id_and_a_title_of_its_own() {
        let ids: BTreeSet<_> = Command::all().map(Command::id).collect();
        let titles: BTreeSet<_> = Command::all().map(Command::title).collect();
        assert_eq!(ids.len(), Command::all().count());
        assert_eq!(titles.len(), ids.len());
        assert!(titles.iter().all(|title| title.starts_with(char::is_uppercase)), "{titles:?}");
        for menu in Menu::ALL {
            assert!(Command::all().any(|command| command.menu() == menu), "{menu:?}");
        }
    }
}
