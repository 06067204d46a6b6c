//! The terrain as it was, beside how it is.
//!
//! It stays where it is meanwhile, and goes on being worked on: what it was comes with the pages. In the picture colours tell by how much
//! it differs; while a key is held, the ground is seen as it was.

use egui::{Align2, Color32, Context, FontId, Painter, Rect, Rgba, pos2, vec2};
use orogeny_engine::{EntryId, Mode};

use crate::command::Command;
use crate::document::Past;
use crate::editor::Editor;
use crate::pane::Pane;

/// What is told where something is to be changed while it is not seen.
const NOT_NOW: &str = "the terrain is seen as it was: go back to now (V or Esc), then change it";

/// Colours of differences from the most down to the most up, in linear light, as `shaders/terrain/analysis.wgsl` has them.
const RAMP: [[f32; 3]; 5] =
    [[0.02, 0.16, 0.60], [0.25, 0.50, 0.85], [0.62, 0.62, 0.60], [0.90, 0.45, 0.15], [0.65, 0.06, 0.02]];

/// Of what is said of what is compared.
pub(crate) const COMPARING: Color32 = Color32::from_rgb(230, 170, 70);

/// The legend's bar, in points.
const BAR: egui::Vec2 = vec2(240.0, 12.0);
/// Parts that its colours are drawn in.
const NUM_PARTS: u8 = 48;

impl Editor {
    /// Whether what is open may be changed; tells people where not.
    pub(crate) fn may_change(&mut self) -> bool {
        let Some(document) = &self.document else { return false };
        let may = document.past.is_none_or(|past| !past.is_seen);
        if !may {
            self.tell(NOT_NOW, false);
        }
        may
    }

    /// Whether the terrain is compared with how it was.
    #[must_use]
    pub fn is_comparing(&self) -> bool {
        self.past().is_some()
    }

    /// Whether the ground is seen as it was.
    #[must_use]
    pub fn sees_earlier(&self) -> bool {
        self.past().is_some_and(|past| past.is_seen)
    }

    fn past(&self) -> Option<Past> {
        self.document.as_ref()?.past
    }

    /// Shows by how much the terrain differs from how it was before the last entry, or no more.
    pub(crate) fn toggle_comparing(&mut self) {
        match self.past() {
            Some(_) if self.document.as_ref().is_some_and(|document| document.pane.is_compared) => {
                self.stop_comparing();
            }
            Some(past) => self.compare_with(past.entry),
            None => self.look_back(false),
        }
    }

    /// Shows by how much the terrain differs from how it was after an entry.
    pub(crate) fn compare_with(&mut self, entry: EntryId) {
        self.open_past(entry, false);
    }

    /// Sees the ground as it was, until the key is let go.
    pub(crate) fn see_earlier(&mut self, is_held: bool) {
        // A hand that draws sees what it draws.
        if self.viewport.is_busy() {
            return;
        }
        if self.past().is_none() {
            self.look_back(true);
        }
        self.set_seen(true, is_held);
    }

    /// Sees the ground as it was, or as it is again.
    pub(crate) fn toggle_earlier(&mut self) {
        if self.sees_earlier() {
            self.see_now();
        } else {
            self.see_earlier(false);
        }
    }

    /// Sees the ground as it is again, where the key that shows how it was is no longer down.
    pub(crate) fn let_go_of_earlier(&mut self, ctx: &Context) {
        if self.past().is_some_and(|past| past.is_held) {
            let key = self.keymap.shortcut(Command::SeeEarlier).map(|shortcut| shortcut.logical_key);
            if !key.is_some_and(|key| ctx.input(|input| input.key_down(key))) {
                self.see_now();
            }
        }
    }

    /// Shows the ground in a mode; that of the difference compares it.
    pub(crate) fn show_mode(&mut self, mode: Mode) {
        if mode != Mode::Difference {
            self.stop_comparing();
            // What is opened next is shown so too.
            self.request.mode = mode;
            if let Some(document) = &mut self.document {
                document.pane.mode = mode;
            }
        } else if self.mode() != mode {
            self.toggle_comparing();
        }
    }

    /// Shows no difference where it is worked, and what it is compared with in no other pane is no longer open.
    fn stop_comparing(&mut self) {
        let Some(document) = &mut self.document else { return };
        document.pane.is_compared = false;
        if !document.is_compared() {
            self.end_comparing();
        }
    }

    /// Shows the terrain as it is, and nothing else.
    pub(crate) fn end_comparing(&mut self) {
        let Some(document) = &mut self.document else { return };
        if let Err(err) = document.close_past() {
            self.tell(err.to_string(), true);
        }
    }

    /// Opens how the terrain was before the last entry.
    fn look_back(&mut self, is_glance: bool) {
        let Some(document) = &self.document else { return };
        let current = document.status.current_entry();
        let before = document.status.history.iter().find(|item| item.id == current).map(|item| item.parent);
        match before {
            Some(before) => self.open_past(before, is_glance),
            None => self.tell("there is nothing before this to compare with", false),
        }
    }

    fn open_past(&mut self, entry: EntryId, is_glance: bool) {
        let Some(document) = &mut self.document else { return };
        document.pane.is_compared |= !is_glance;
        if document.past.is_some_and(|past| past.entry == entry) {
            return;
        }
        let ticket = document.session.open_past(entry);
        let seen = document.past.map(|Past { is_seen, is_held, .. }| (is_seen, is_held));
        let (is_seen, is_held) = seen.unwrap_or_default();
        document.past = Some(Past { entry, ticket, is_seen, is_held });
        document.overview.note_changed();
        document.note(ticket, "look back");
    }

    fn see_now(&mut self) {
        if self.document.as_ref().is_some_and(|document| !document.is_compared()) {
            return self.end_comparing();
        }
        self.set_seen(false, false);
    }

    fn set_seen(&mut self, is_seen: bool, is_held: bool) {
        let Some(document) = &mut self.document else { return };
        let Some(past) = &mut document.past else { return };
        (past.is_seen, past.is_held) = (is_seen, is_held);
        if let Err(err) = document.show_earlier(is_seen) {
            self.tell(err.to_string(), true);
        }
    }

    /// What people are told of what is compared in a pane, and how much full colour stands for there, metres.
    pub(crate) fn comparison(&self, pane: &Pane) -> Option<(String, Option<f32>)> {
        let past = self.past()?;
        let when = match past.entry {
            EntryId::CREATION => "it was made".to_owned(),
            entry => format!("entry {entry}"),
        };
        if past.is_seen {
            return Some((format!("As it was after {when}: V or Esc goes back to now"), None));
        }
        let most_m = pane.view.difference_m(&self.request).filter(|_| pane.is_compared)?;
        Some((format!("Since {when}: red {most_m:.2} m higher, blue {most_m:.2} m lower"), Some(most_m)))
    }
}

/// Draws over the picture what its colours stand for.
pub(crate) fn legend(painter: &Painter, rect: Rect, most_m: f32) {
    let bar = Rect::from_center_size(rect.center_bottom() - vec2(0.0, 44.0), BAR);
    painter.rect_filled(
        bar.expand2(vec2(36.0, 8.0)).with_max_y(bar.max.y + 24.0),
        4.0,
        Color32::from_black_alpha(170),
    );
    let width = BAR.x / f32::from(NUM_PARTS);
    for part in 0..NUM_PARTS {
        let left = bar.min.x + f32::from(part) * width;
        // A little wider, so that no gap shows between them.
        let of_part = Rect::from_min_size(pos2(left, bar.min.y), vec2(width + 0.5, BAR.y));
        painter.rect_filled(of_part, 0.0, colour(f32::from(part) / f32::from(NUM_PARTS - 1)));
    }
    let ends = [(bar.left(), -most_m), (bar.center().x, 0.0), (bar.right(), most_m)];
    for (x, metres) in ends {
        let text = if metres == 0.0 { "as it was".to_owned() } else { format!("{metres:+.2} m") };
        let place = pos2(x, bar.max.y + 4.0);
        painter.text(place, Align2::CENTER_TOP, text, FontId::proportional(13.0), Color32::WHITE);
    }
}

/// The colour of a difference: 0 for the most down, 1 for the most up.
fn colour(share: f32) -> Color32 {
    let at = share.clamp(0.0, 1.0) * 4.0;
    let mut colour = RAMP[0];
    for (part, pair) in RAMP.windows(2).enumerate() {
        if let [from, to] = pair {
            let along = (at - part as f32).clamp(0.0, 1.0);
            for ((channel, from), to) in colour.iter_mut().zip(from).zip(to) {
                *channel += along * (to - from);
            }
        }
    }
    let [red, green, blue] = colour;
    Rgba::from_rgb(red, green, blue).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_legend_has_the_colours_of_the_picture() {
        let shader = include_str!("../../../shaders/terrain/analysis.wgsl");
        for [red, green, blue] in RAMP {
            let text = format!("vec3<f32>({red:.2}, {green:.2}, {blue:.2})");
            assert!(shader.contains(&text), "{text}");
        }
        for (index, [red, green, blue]) in RAMP.into_iter().enumerate() {
            let expected: Color32 = Rgba::from_rgb(red, green, blue).into();
            let found = colour(index as f32 / 4.0);
            let apart =
                expected.to_array().into_iter().zip(found.to_array()).map(|(a, b)| a.abs_diff(b)).max();
            assert!(apart <= Some(1), "{expected:?} {found:?}");
        }
    }
}
