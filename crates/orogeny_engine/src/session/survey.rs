//! A terrain at a glance: all of it, as coarsely as befits a small map or a histogram.

use orogeny_field::TerrainGrid;

use crate::ground::Ground;
use crate::map::shaded;
use crate::{ExportSource, Observer, Picture, Result, Terrain};

/// Less than this much selected is as good as not.
const LEAST_SELECTED: f32 = 1.0e-3;

/// All of a terrain in few heights: the mean of each square of so many samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    ground: Ground,
    /// By how much each height is higher than it was, metres, where a past is open.
    higher_m: Option<Vec<f32>>,
    /// Samples, each way, that a height stands for.
    pub samples_each: u32,
    /// The level of the terrain that was read: 0 for full resolution.
    pub level: u8,
    /// Width and depth of what the heights cover, metres: the terrain's, and up to a height more.
    pub size_m: [f64; 2],
    /// `[x, z, width, depth]` in metres around all that is selected, up to a sample of a coarse level too wide; `None`: nothing is.
    pub selected_m: Option<[f64; 4]>,
}

impl Survey {
    /// Of a terrain, within so many heights each way, compared with how it was.
    ///
    /// # Errors
    /// As [`Terrain::draw_map`]; [`crate::Error::Cancelled`].
    pub(super) fn of(
        terrain: &Terrain,
        past: Option<&Terrain>,
        max_side: u32,
        observer: &mut dyn Observer,
    ) -> Result<Self> {
        let grid: TerrainGrid = terrain.grid();
        let rect = grid.bounds();
        let samples_each = rect.width().max(rect.depth()).div_ceil(max_side.max(1)).max(1);
        let (ground, level, _) = terrain.mean_heights(rect, samples_each, observer)?;
        let size_m =
            [ground.width, ground.depth()].map(|num| num as f64 * f64::from(samples_each) * grid.spacing_m());
        let selected_m = selected_m(terrain, max_side)?;
        let earlier = past.map(|past| past.mean_heights(rect, samples_each, observer)).transpose()?;
        let higher_m = earlier.map(|(earlier, ..)| {
            let pairs = ground.heights.iter().zip(&earlier.heights);
            pairs.map(|(now_m, earlier_m)| now_m - earlier_m).collect()
        });
        Ok(Self { ground, higher_m, samples_each, level, size_m, selected_m })
    }

    /// Heights a row.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.ground.width
    }

    /// Rows.
    #[must_use]
    pub const fn depth(&self) -> usize {
        self.ground.depth()
    }

    /// The heights, metres, row by row from the north.
    #[must_use]
    pub fn heights_m(&self) -> &[f32] {
        &self.ground.heights
    }

    /// By how much each height is higher than it was, metres; `None` unless a past is open.
    #[must_use]
    pub fn higher_m(&self) -> Option<&[f32]> {
        self.higher_m.as_deref()
    }

    /// A shaded map of it, one pixel a height.
    #[must_use]
    pub fn map(&self) -> Picture {
        Picture {
            width_px: self.ground.width as u32,
            height_px: self.ground.depth() as u32,
            rgb: shaded(&self.ground, self.ground.range_m()),
        }
    }
}

/// What lies around all that is selected, by a level of few samples.
fn selected_m(terrain: &Terrain, max_side: u32) -> Result<Option<[f64; 4]>> {
    let grid = terrain.grid();
    let top = terrain.settled()?.layout().top_level(&grid);
    let is_small = |level: &u8| {
        let bounds = grid.bounds_at(*level);
        bounds.width().max(bounds.depth()) <= max_side
    };
    let level = (0..top).find(is_small).unwrap_or(top);
    let (width, _, shares) = terrain.heights(&ExportSource::Selection, None, level)?;
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for (z, row) in shares.chunks_exact(width.max(1) as usize).enumerate() {
        let mut selected = row.iter().enumerate().filter(|(_, share)| **share > LEAST_SELECTED);
        let Some((first, _)) = selected.next() else { continue };
        let last = selected.next_back().map_or(first, |(last, _)| last);
        low = [low[0].min(first as f64), low[1].min(z as f64)];
        high = [high[0].max(last as f64), high[1].max(z as f64)];
    }
    if low[0] > high[0] {
        return Ok(None);
    }
    let sample_m = grid.spacing_m() * f64::from(1_u32 << level);
    // Of a coarse level, the samples beside it may hide some of it.
    let around = if level > 0 { 1.0 } else { 0.0 };
    let [x, z] = low.map(|low| (low - around).max(0.0) * sample_m);
    let [right, below] = high.map(|high| (high + 1.0 + around) * sample_m);
    Ok(Some([x, z, right - x, below - z]))
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use crate::session::{Event, Session, Ticket, Travel};
    use crate::{Adapter, Operation, Settings, Terrain, TerrainGrid};

    use super::*;

    /// The next survey of a session, which is awaited.
    fn next(session: &Session) -> (Ticket, Survey) {
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(60) {
            for event in session.events() {
                if let Event::Surveyed { ticket, survey } = event {
                    return (ticket, *survey);
                }
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        panic!("no survey came");
    }

    #[test]
    fn it_is_of_the_terrain_as_it_is_when_its_turn_comes() {
        let folder = tempfile::tempdir().unwrap();
        let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
        let grid = TerrainGrid::new(1000, 700, 2.0).unwrap();
        let terrain = Terrain::create(&folder.path().join("t.orogeny"), grid, 5.0, settings).unwrap();
        let session = Session::of(terrain, || {}).unwrap();
        let text = r#"{"op": "stroke", "brush": {"type": "raise", "radius": 300, "strength": 40}, "points": [[400, 1000]]}"#;
        session.apply(vec![Operation::from_json_text(text).unwrap()]);
        let text = r#"{"op": "select", "shape": {"rectangle": [600, 200, 300, 400]}}"#;
        session.apply(vec![Operation::from_json_text(text).unwrap()]);
        let asked = session.survey(128);
        session.travel(Travel::Undo(2));
        session.survey(128);
        let (ticket, survey) = next(&session);
        assert_eq!(ticket, asked);
        assert_eq!((survey.width(), survey.depth(), survey.samples_each), (125, 88, 8));
        assert_eq!(survey.size_m, [2000.0, 1408.0]);
        let at = |[x_m, z_m]: [usize; 2]| survey.heights_m()[z_m / 16 * 125 + x_m / 16];
        assert!(at([400, 1000]) > 40.0 && at([1200, 400]) == 5.0, "{}", at([400, 1000]));
        // Of level 3, 16 m a sample, with one around it.
        let [x, z, width, depth] = survey.selected_m.unwrap();
        assert!((568.0..=600.0).contains(&x) && (168.0..=200.0).contains(&z), "{x} {z}");
        assert!((300.0..=364.0).contains(&width) && (400.0..=464.0).contains(&depth), "{width} {depth}");
        let map = survey.map();
        assert_eq!((map.width_px, map.height_px, map.rgb.len()), (125, 88, 125 * 88 * 3));
        let (_, flat) = next(&session);
        assert_eq!(flat.selected_m, None);
        assert!(flat.heights_m().iter().all(|height_m| *height_m == 5.0));
        session.close().unwrap();
    }
}
