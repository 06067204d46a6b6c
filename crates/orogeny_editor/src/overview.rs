//! All of a terrain in few heights: what the map, the histogram and small pictures of the history are made of.

use std::collections::BTreeMap;

use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use orogeny_engine::EntryId;
use orogeny_engine::session::{Session, Survey, Ticket};

/// Heights each way, at most.
const MAX_SIDE: u32 = 512;
/// Pixels each way of a small picture of a moment, at most.
const MAX_SMALL_PX: usize = 128;
/// Moments of the history whose pictures are kept at most.
const MAX_MOMENTS: usize = 200;
/// Columns of the histogram.
pub const NUM_COLUMNS: usize = 64;

/// What is known of all of a terrain.
#[derive(Default)]
pub struct Overview {
    survey: Option<Survey>,
    /// Whether the terrain has changed since it was asked for.
    is_fresh: bool,
    asked: Option<Ticket>,
    map: Option<TextureHandle>,
    difference: Option<Difference>,
    /// Small maps, by the entry that was the last one then.
    moments: BTreeMap<EntryId, TextureHandle>,
}

/// A map of by how much the ground is higher, or lower, now.
#[derive(Clone)]
pub struct Difference {
    /// Red where it is higher now, blue where it is lower.
    pub map: TextureHandle,
    /// What full colour stands for, metres.
    pub most_m: f32,
}

impl std::fmt::Debug for Overview {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Overview").field("is_fresh", &self.is_fresh).finish_non_exhaustive()
    }
}

impl Overview {
    /// Asks for a survey if the last one is no longer true and none is on its way.
    pub fn want(&mut self, session: &Session) {
        if !self.is_fresh && self.asked.is_none() {
            self.is_fresh = true;
            self.asked = Some(session.survey(MAX_SIDE));
        }
    }

    /// Whether one is on its way.
    #[must_use]
    pub const fn is_waiting(&self) -> bool {
        self.asked.is_some()
    }

    /// Whether the last survey is of the terrain as it is.
    #[must_use]
    pub const fn is_true(&self) -> bool {
        self.is_fresh && self.asked.is_none() && self.survey.is_some()
    }

    /// The terrain has changed.
    pub const fn note_changed(&mut self) {
        self.is_fresh = false;
    }

    /// Takes a survey that has come.
    pub fn take(&mut self, ticket: Ticket, survey: Survey) {
        if self.asked == Some(ticket) {
            self.asked = None;
            self.survey = Some(survey);
            (self.map, self.difference) = (None, None);
        }
    }

    /// Whether what failed was a survey: it is asked for again if it was only given up, and not before something changes otherwise.
    pub fn take_failed(&mut self, ticket: Ticket, is_cancelled: bool) -> bool {
        if self.asked != Some(ticket) {
            return false;
        }
        self.asked = None;
        self.is_fresh = !is_cancelled;
        is_cancelled
    }

    /// Forgets pictures: the device that they were on is lost.
    pub fn forget_pictures(&mut self) {
        (self.map, self.difference) = (None, None);
        self.moments.clear();
    }

    /// The last survey.
    #[must_use]
    pub const fn survey(&self) -> Option<&Survey> {
        self.survey.as_ref()
    }

    /// A shaded map of it, with the picture of the entry that is the last one.
    pub fn map(&mut self, ctx: &Context, entry: EntryId) -> Option<TextureHandle> {
        let survey = self.survey.as_ref()?;
        if self.map.is_none() {
            let image = image(survey.map());
            if self.asked.is_none() && self.is_fresh {
                while self.moments.len() >= MAX_MOMENTS {
                    self.moments.pop_first();
                }
                let small = ctx.load_texture("moment", smaller(&image), TextureOptions::LINEAR);
                self.moments.insert(entry, small);
            }
            self.map = Some(ctx.load_texture("map", image, TextureOptions::LINEAR));
        }
        self.map.clone()
    }

    /// A small map of the terrain as it was after an entry, where it was looked at then.
    #[must_use]
    pub fn moment(&self, entry: EntryId) -> Option<&TextureHandle> {
        self.moments.get(&entry)
    }

    /// By how much the ground is higher now than it was; nothing unless that is compared.
    pub fn difference(&mut self, ctx: &Context) -> Option<Difference> {
        let survey = self.survey.as_ref()?;
        let higher_m = survey.higher_m()?;
        if self.difference.is_none() && self.asked.is_none() && self.is_fresh {
            let most_m = higher_m.iter().fold(0.0_f32, |most_m, by_m| most_m.max(by_m.abs()));
            let rgb =
                higher_m.iter().flat_map(|by_m| signed_colour(by_m / most_m.max(1.0e-6))).collect::<Vec<_>>();
            let image = ColorImage::from_rgb([survey.width(), survey.depth()], &rgb);
            let map = ctx.load_texture("difference", image, TextureOptions::LINEAR);
            self.difference = Some(Difference { map, most_m });
        }
        self.difference.clone()
    }
}

/// Red above 0, blue below, light grey at it.
fn signed_colour(share: f32) -> [u8; 3] {
    let share = share.clamp(-1.0, 1.0);
    // Little is seen, too.
    let strength = share.abs().sqrt();
    let end = if share > 0.0 { [178.0, 24.0, 43.0] } else { [33.0, 102.0, 172.0] };
    end.map(|channel: f32| (235.0 + strength * (channel - 235.0)) as u8)
}

fn image(picture: orogeny_engine::Picture) -> ColorImage {
    ColorImage::from_rgb([picture.width_px as usize, picture.height_px as usize], &picture.rgb)
}

/// Every n-th pixel each way, so that it is small enough.
fn smaller(image: &ColorImage) -> ColorImage {
    let [width, height] = image.size;
    let step = width.max(height).div_ceil(MAX_SMALL_PX).max(1);
    let rows = image.pixels.chunks_exact(width.max(1)).step_by(step);
    let pixels: Vec<_> = rows.flat_map(|row| row.iter().copied().step_by(step)).collect();
    ColorImage::new([width.div_ceil(step), height.div_ceil(step)], pixels)
}

/// How many of some heights lie in each of [`NUM_COLUMNS`] equal parts between the lowest and the highest; with these two.
#[must_use]
pub fn histogram(heights_m: &[f32]) -> (Vec<f64>, [f32; 2]) {
    let low_m = heights_m.iter().copied().fold(f32::INFINITY, f32::min);
    let high_m = heights_m.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let span_m = (high_m - low_m).max(f32::MIN_POSITIVE);
    let mut columns = vec![0.0; NUM_COLUMNS];
    for height_m in heights_m {
        let column = ((height_m - low_m) / span_m * NUM_COLUMNS as f32) as usize;
        if let Some(num) = columns.get_mut(column.min(NUM_COLUMNS - 1)) {
            *num += 1.0;
        }
    }
    (columns, [low_m, high_m])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_height_is_in_one_column() {
        let heights_m: Vec<f32> = (0..6400).map(|k| k as f32 / 10.0).collect();
        let (columns, range_m) = histogram(&heights_m);
        assert_eq!(range_m, [0.0, 639.9]);
        assert_eq!(columns.iter().sum::<f64>(), 6400.0);
        assert!(columns.iter().all(|num| (95.0..=105.0).contains(num)), "{columns:?}");
        let (flat, range_m) = histogram(&[7.0; 10]);
        assert_eq!((flat[0], range_m), (10.0, [7.0, 7.0]));
    }

    #[test]
    fn higher_is_red_and_lower_is_blue() {
        let [red, _, blue] = signed_colour(0.5);
        assert!(red > blue);
        let [red, _, blue] = signed_colour(-0.5);
        assert!(red < blue);
        assert_eq!(signed_colour(0.0), [235; 3]);
    }

    #[test]
    fn small_pictures_are_small() {
        let image = ColorImage::filled([512, 300], egui::Color32::RED);
        let small = smaller(&image);
        assert_eq!((small.size, small.pixels.len()), ([128, 75], 128 * 75));
        assert_eq!(smaller(&ColorImage::filled([100, 3], egui::Color32::RED)).size, [100, 3]);
    }
}
