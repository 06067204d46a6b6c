//! Commands: each of them, with and without a terrain.

use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use orogeny_editor::{Command, Hand};
use orogeny_engine::BrushType;

use crate::support::{Window, curve};

#[test]
fn every_command_can_be_given_at_any_time() {
    let mut empty = Window::empty();
    let mut window = Window::open();
    // What not every brush can do has a test of its own.
    let others = [Command::Quit, Command::AddProcedure, Command::AddEffect];
    for command in Command::all().filter(|command| !others.contains(command)) {
        for window in [&mut empty, &mut window] {
            let ctx = window.harness.ctx.clone();
            window.editor().run(command, &ctx);
            window.frames(1);
            // What changes the terrain is done before the next one changes it again.
            let id = command.id();
            if ["layer", "selec", "undo", "redo"].iter().any(|part| id.contains(part)) {
                window.settle();
            }
            // Whatever it opened is closed again.
            window.editor().run(Command::Cancel, &ctx);
        }
    }
    let said: Vec<_> = window.editor().errors().collect();
    assert!(said.is_empty(), "{said:?}");
    let ctx = window.harness.ctx.clone();
    window.editor().run(Command::Quit, &ctx);
    assert!(window.editor().is_closing());
}

#[test]
fn the_palette_finds_a_command_by_parts_of_its_name() {
    let mut window = Window::open();
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    window.frames(3);
    window.harness.get_by_label("Find a command");
    window.harness.event(Event::Text("height ban".to_owned()));
    window.frames(2);
    window.harness.key_press(Key::Enter);
    window.frames(3);
    assert_eq!(window.editor().mode().name(), "height-bands");
    assert!(window.harness.query_by_label("Find a command").is_none());
}

/// All in one frame, as it comes where frames are slow: none of the letters is a key of a command.
#[test]
fn what_is_typed_before_the_palette_is_there_is_for_it() {
    let mut window = Window::open();
    let press =
        |key, modifiers| Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
    let events = &mut window.harness.input_mut().events;
    events.push(press(Key::P, Modifiers::COMMAND));
    for letter in ["l", "o", "w", "e", "r"] {
        events.push(press(Key::from_name(&letter.to_uppercase()).unwrap(), Modifiers::NONE));
        events.push(Event::Text(letter.to_owned()));
    }
    events.push(press(Key::Enter, Modifiers::NONE));
    window.frames(4);
    // O is the key of the lasso, R that of the rectangle.
    assert_eq!((window.editor().hand(), window.editor().brush_type()), (Hand::Brush, BrushType::Lower));
    assert!(window.harness.query_by_label("Find a command").is_none());
}

#[test]
fn layers_are_added_drawn_on_hidden_and_removed() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    let before = Window::heights(&path);
    let ctx = window.harness.ctx.clone();
    window.editor().run(Command::AddLayer, &ctx);
    window.settle();
    assert_eq!(window.layers(), ["Base", "Layer 1"]);
    window.draw(&curve(6), Modifiers::NONE);
    let drawn = Window::heights(&path);
    assert!(drawn != before);
    window.editor().run(Command::ToggleLayer, &ctx);
    window.settle();
    assert!(Window::heights(&path) == before, "hidden");
    window.editor().run(Command::ToggleLayer, &ctx);
    window.settle();
    assert!(Window::heights(&path) == drawn, "shown again");
    window.editor().run(Command::DuplicateLayer, &ctx);
    window.settle();
    window.editor().run(Command::LowerLayer, &ctx);
    window.settle();
    assert_eq!(window.layers(), ["Base", "Layer 1 copy", "Layer 1"]);
    window.editor().run(Command::RemoveLayer, &ctx);
    window.settle();
    assert_eq!(window.layers(), ["Base", "Layer 1"]);
    assert!(Window::heights(&path) == drawn);
}

#[test]
fn a_layer_that_a_brush_makes_is_tuned_and_collapsed() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    let ctx = window.harness.ctx.clone();
    window.editor().run(Command::Brush(BrushType::Noise), &ctx);
    window.editor().run(Command::AddProcedure, &ctx);
    window.settle();
    assert_eq!(window.layers(), ["Base", "Noise 1"]);
    window.editor().run(Command::Brush(BrushType::Terrace), &ctx);
    window.editor().run(Command::AddEffect, &ctx);
    window.settle();
    assert_eq!(window.layers(), ["Base", "Noise 1", "Terrace 1"]);
    let terraced = Window::heights(&path);
    // Drawing on it goes to its mask; weaker, it is nearer to what lies below.
    window.editor().run(Command::Weaker, &ctx);
    window.editor().run(Command::TuneLayer, &ctx);
    window.settle();
    let tuned = Window::heights(&path);
    assert!(tuned != terraced);
    window.editor().run(Command::CollapseLayer, &ctx);
    window.settle();
    assert!(Window::heights(&path) == tuned, "what is shown stays");
    // Filling a layer that a brush makes fills its mask: lower than all, it counts nowhere.
    window.run(Command::Undo);
    window.run(Command::Brush(BrushType::Lower));
    for _ in 0..9 {
        window.run(Command::Stronger);
    }
    window.harness.get_by_label("Fill").scroll_to_me();
    window.frames(12);
    window.click("Fill");
    window.settle();
    let history = window.history();
    assert_eq!(history.last().map(String::as_str), Some("fill lower"));
    assert!(Window::heights(&path) != tuned, "it counts as before");
    let said: Vec<_> = window.editor().errors().collect();
    assert!(said.is_empty(), "{said:?}");
}
