//! A part of the window that shows the ground: an eye, a mode, and what draws it. There are one or two, over the same terrain.

use std::collections::VecDeque;

use egui::{Rect, TextureId, Vec2, pos2, vec2};
use orogeny_engine::session::Session;
use orogeny_engine::{Camera, LiveView, Mode, ViewRequest};

use crate::{CameraControl, Result};

/// Points between two of them.
const GAP: f32 = 4.0;
/// The least share of the room that one of them has.
const MIN_SHARE: f32 = 0.15;

/// A part of the window that shows the ground.
#[derive(Debug)]
pub struct Pane {
    /// Which one: never that of another, so that pages come to the one that asked for them.
    pub number: u32,
    /// Whether it is the right one.
    pub is_right: bool,
    /// What draws it.
    pub view: LiveView,
    /// Where it is looked from.
    pub camera: CameraControl,
    /// How the ground is shown, where it is not compared.
    pub mode: Mode,
    /// Whether it shows by how much the terrain differs from what it is compared with.
    pub is_compared: bool,
    /// Its picture as egui knows it.
    picture: Option<TextureId>,
    /// Whether what is drawn went into a new texture.
    is_picture_new: bool,
}

impl Pane {
    /// One that nothing was drawn of yet.
    #[must_use]
    pub const fn new(number: u32, view: LiveView, camera: CameraControl, mode: Mode) -> Self {
        let (is_right, is_compared, picture, is_picture_new) = (false, false, None, true);
        Self { number, is_right, view, camera, mode, is_compared, picture, is_picture_new }
    }

    /// Draws with another view: one on another device, on which there are no pictures.
    pub fn draw_with(&mut self, view: LiveView) {
        self.view = view;
        (self.picture, self.is_picture_new) = (None, true);
    }

    /// Its picture, as egui knows it.
    #[must_use]
    pub const fn picture(&self) -> Option<TextureId> {
        self.picture
    }

    /// Has [`Self::take_picture`] show the picture again, though its texture is the same.
    pub const fn renew_picture(&mut self) {
        self.is_picture_new = true;
    }

    /// Has `show` make the picture known to egui, where its texture is another than when this was last asked; `show` is given the name
    /// that it had. Tells whether it has a name for the first time.
    pub fn take_picture(
        &mut self,
        show: &mut dyn FnMut(&wgpu::TextureView, Option<TextureId>) -> TextureId,
    ) -> bool {
        if !(std::mem::take(&mut self.is_picture_new) | self.view.take_is_resized()) {
            return false;
        }
        let known = self.picture;
        self.picture = Some(show(&self.view.picture_view(), known));
        known.is_none()
    }

    /// Draws, and asks for what is missing; who asked goes to the end of `asked`.
    ///
    /// # Errors
    /// As [`LiveView::draw`].
    pub fn draw(
        &mut self,
        camera: &Camera,
        size_px: [u32; 2],
        request: &ViewRequest,
        session: &Session,
        asked: &mut VecDeque<u32>,
    ) -> Result<()> {
        let drawn = self.view.draw(camera, size_px, request);
        let wanted = self.view.wanted();
        if !wanted.is_empty() {
            session.look(wanted);
            asked.push_back(self.number);
        }
        drawn?;
        Ok(())
    }
}

/// The rooms of the left and the right one and what lies between them, where the left one has a share of the width.
#[must_use]
pub fn split(room: Rect, share: f32) -> [Rect; 3] {
    let middle = room.left() + room.width() * share;
    let left = Rect::from_min_max(room.min, pos2(middle - GAP / 2.0, room.bottom()));
    let right = Rect::from_min_max(pos2(middle + GAP / 2.0, room.top()), room.max);
    [left, right, Rect::from_min_max(left.right_top(), right.left_bottom())]
}

/// The share of the left one, where what lies between them was dragged to a place.
#[must_use]
pub fn share_at(room: Rect, x: f32) -> f32 {
    ((x - room.left()) / room.width().max(1.0)).clamp(MIN_SHARE, 1.0 - MIN_SHARE)
}

/// Pixels of a room.
#[must_use]
pub fn size_px(size: Vec2, pixels_per_point: f32) -> [u32; 2] {
    let size = size.max(vec2(1.0, 1.0)) * pixels_per_point;
    [size.x, size.y].map(|side| (side as u32).clamp(1, 8192))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_of_them_share_the_room_and_each_keeps_some() {
        let room = Rect::from_min_size(pos2(100.0, 50.0), vec2(800.0, 600.0));
        for share in [share_at(room, -5.0), share_at(room, 300.0), share_at(room, 5000.0)] {
            let [left, right, between] = split(room, share);
            assert_eq!((left.min, right.max, between.width()), (room.min, room.max, GAP));
            assert!(left.width() >= 100.0 && right.width() >= 100.0, "{share}");
            assert!((left.width() + right.width() + GAP - room.width()).abs() < 1.0e-3);
        }
        assert_eq!(share_at(room, 300.0), 0.25);
        assert_eq!(size_px(vec2(100.0, 0.0), 1.5), [150, 1]);
    }
}
