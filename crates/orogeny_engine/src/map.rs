//! A shaded map from above: hillshade with a tint by height.

use std::path::PathBuf;

use orogeny_field::{PageKey, SampleRect};

use crate::composite::{Source, damage_notice};
use crate::ground::Ground;
use crate::picture::{Picture, Ramp, check_size, colour_at};
use crate::progress::report;
use crate::{Observer, Result, Terrain};

/// Light from the north-west, the convention of maps, and weaker light from both sides of it, so that no slope is black:
/// azimuth in degrees from north, clockwise; share of the light.
const LIGHTS: [(f32, f32); 3] = [(315.0, 0.6), (270.0, 0.2), (0.0, 0.2)];
/// Height of the lights above the horizon, in degrees.
const LIGHT_ALTITUDE_DEGREES: f32 = 45.0;
/// What a slope that no light reaches keeps of its colour, and what light adds.
const AMBIENT: f32 = 0.32;
const DIRECT: f32 = 0.95;

/// Colours (sRGB) from the lowest to the highest ground.
const TINTS: Ramp<6> = [
    (0.0, [86.0, 124.0, 84.0]),
    (0.25, [146.0, 164.0, 104.0]),
    (0.45, [208.0, 192.0, 138.0]),
    (0.65, [176.0, 138.0, 100.0]),
    (0.85, [150.0, 134.0, 126.0]),
    (1.0, [246.0, 246.0, 246.0]),
];

/// What to draw, and where to.
#[derive(Debug, Clone, PartialEq)]
pub struct MapRequest {
    /// The PNG.
    pub file: PathBuf,
    /// `[x, z, width, depth]` in metres; `None`: the whole terrain.
    pub region_m: Option<[f64; 4]>,
    /// The picture is made to fit into this, in pixels. One pixel stands for a whole number of samples each way.
    pub size_px: [u32; 2],
    /// Heights of the first and last tint, in metres; `None`: the lowest and highest drawn.
    pub range_m: Option<[f32; 2]>,
}

/// What was drawn.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct MapSummary {
    /// The PNG.
    pub file: PathBuf,
    /// Pixels along x.
    pub width_px: u32,
    /// Pixels along z.
    pub height_px: u32,
    /// Samples, each way, that a pixel stands for.
    pub samples_per_px: u32,
    /// Heights of the first and last tint, in metres.
    pub range_m: [f32; 2],
    /// The level of the terrain that was read: 0 for full resolution.
    pub level: u8,
    /// What could not be shown as it is, for people.
    pub notices: Vec<String>,
}

impl MapRequest {
    /// The whole terrain within 1024 x 1024 pixels.
    #[must_use]
    pub fn new(file: impl Into<PathBuf>) -> Self {
        Self { file: file.into(), region_m: None, size_px: [1024, 1024], range_m: None }
    }
}

impl Terrain {
    /// Draws the composite from above.
    ///
    /// # Errors
    /// [`Error::PictureSize`](crate::Error::PictureSize), [`Error::OutsideTerrain`](crate::Error::OutsideTerrain),
    /// [`Error::Store`](crate::Error::Store), [`Error::Write`](crate::Error::Write).
    pub fn draw_map(&self, request: &MapRequest, observer: &mut dyn Observer) -> Result<MapSummary> {
        check_size(request.size_px)?;
        let [width, height] = request.size_px;
        let rect = self.region(request.region_m)?;
        let samples_per_px = rect.width().div_ceil(width).max(rect.depth().div_ceil(height));
        let (ground, level, damaged) = self.mean_heights(rect, samples_per_px, observer)?;
        let range_m = request.range_m.unwrap_or_else(|| ground.range_m());
        let (width_px, height_px) =
            (rect.width().div_ceil(samples_per_px), rect.depth().div_ceil(samples_per_px));
        Picture { width_px, height_px, rgb: shaded(&ground, range_m) }.write(&request.file)?;
        let notices = damaged.iter().map(damage_notice).collect();
        let file = request.file.clone();
        Ok(MapSummary { file, width_px, height_px, samples_per_px, range_m, level, notices })
    }

    /// Mean heights, one a pixel; also the level that was read and the damaged pages met. Read is the finest level that has
    /// at least two samples a pixel each way, so that a map costs its pixels, and of the terrain only what is painted.
    pub(crate) fn mean_heights(
        &self,
        rect: SampleRect,
        samples_per_px: u32,
        observer: &mut dyn Observer,
    ) -> Result<(Ground, u8, Vec<PageKey>)> {
        let width = rect.width().div_ceil(samples_per_px) as usize;
        let depth = rect.depth().div_ceil(samples_per_px) as usize;
        let top = self.store()?.layout().top_level(&self.grid());
        let level = (samples_per_px.ilog2().saturating_sub(1) as u8).min(top);
        let level_rect = self.samples_at(&rect, level);
        // What painted pages add to the height of unpainted ground: so a map costs what is painted, not what there could be.
        let unpainted_m = f64::from(self.unpainted_height_m()?);
        let mut sums = vec![0.0_f64; width * depth];
        // The column or row of pixels that a sample of the level falls into.
        let pixel_along = |place: i32, start: i32| {
            ((place << level).saturating_sub(start).max(0).unsigned_abs() / samples_per_px) as usize
        };
        let painted = self.painted_rects(level, level_rect)?;
        let mut damaged = Vec::new();
        for (index, page) in painted.iter().enumerate() {
            let mut composite = self.composite(Source::Composite, level, *page)?.show_damage();
            let mut row = vec![0.0; page.width() as usize];
            for z in page.z0..page.z1 {
                composite.read_rows(&mut row)?;
                let row_start = pixel_along(z, rect.z0) * width;
                for (x, height_m) in (page.x0..).zip(&row) {
                    if let Some(sum) = sums.get_mut(row_start + pixel_along(x, rect.x0)) {
                        *sum += f64::from(*height_m) - unpainted_m;
                    }
                }
            }
            damaged.extend_from_slice(composite.damaged());
            report(observer, "drawing", index as u64 + 1, painted.len() as u64)?;
        }
        // How many samples of the level fall into a column or row of pixels.
        let counts = |start: i32, end: i32, first: i32, num_pixels: usize| {
            let mut counts = vec![0_u32; num_pixels];
            for place in start..end {
                if let Some(count) = counts.get_mut(pixel_along(place, first)) {
                    *count += 1;
                }
            }
            counts
        };
        let columns = counts(level_rect.x0, level_rect.x1, rect.x0, width);
        let rows = counts(level_rect.z0, level_rect.z1, rect.z0, depth);
        let areas = rows.iter().flat_map(|row| columns.iter().map(move |column| f64::from(row * column)));
        let mean = |(sum, area): (f64, f64)| (unpainted_m + sum / area.max(1.0)) as f32;
        let mut heights: Vec<f32> = sums.into_iter().zip(areas).map(mean).collect();
        // The last column or row may be so narrow that no sample of the level lies in it: it shows the one before.
        for row in heights.chunks_exact_mut(width) {
            if columns.last() == Some(&0) && width > 1 {
                row.copy_within(width - 2..width - 1, width - 1);
            }
        }
        if rows.last() == Some(&0) && depth > 1 {
            heights.copy_within((depth - 2) * width..(depth - 1) * width, (depth - 1) * width);
        }
        let spacing_m = (self.grid().spacing_m() * f64::from(samples_per_px)) as f32;
        Ok((Ground { width, heights, spacing_m }, level, damaged))
    }
}

/// RGB bytes, row by row.
pub(crate) fn shaded(ground: &Ground, [low_m, high_m]: [f32; 2]) -> Vec<u8> {
    let lights = LIGHTS.map(|(azimuth, share)| {
        let (azimuth, altitude) = (azimuth.to_radians(), LIGHT_ALTITUDE_DEGREES.to_radians());
        // North is -z.
        let to_light = [azimuth.sin() * altitude.cos(), altitude.sin(), -azimuth.cos() * altitude.cos()];
        (to_light, share)
    });
    let span_m = (high_m - low_m).max(f32::MIN_POSITIVE);
    let mut pixels = Vec::with_capacity(ground.heights.len() * 3);
    for z in 0..ground.depth().cast_signed() {
        for x in 0..ground.width.cast_signed() {
            let normal = ground.normal(x, z);
            let light: f32 = lights
                .iter()
                .map(|(to_light, share)| {
                    let cosine: f32 = normal.iter().zip(to_light).map(|(n, l)| n * l).sum();
                    share * cosine.max(0.0)
                })
                .sum();
            let tint = colour_at(&TINTS, ((ground.at(x, z) - low_m) / span_m).clamp(0.0, 1.0));
            pixels.extend(tint.map(|channel| (channel * (AMBIENT + DIRECT * light)).clamp(0.0, 255.0) as u8));
        }
    }
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_to_the_north_west_are_the_brightest() {
        let brightness = |slope_x: f32, slope_z: f32| {
            let height = |k: usize| slope_x * (k % 3) as f32 + slope_z * (k / 3) as f32;
            let plane = Ground { width: 3, heights: (0..9).map(height).collect(), spacing_m: 1.0 };
            shaded(&plane, [-1.0e6, 1.0e6]).get(12).copied().unwrap()
        };
        let (towards, flat, away) = (brightness(0.5, 0.5), brightness(0.0, 0.0), brightness(-0.5, -0.5));
        assert!(towards > flat && flat > away, "{towards} {flat} {away}");
    }

    /// Sides of which the last pixel holds no sample of the level that is read: 4106 samples, five a pixel, level 1.
    #[test]
    fn the_last_column_and_row_of_a_map_are_those_of_the_terrain() {
        use crate::{Adapter, Operation, Quiet, Settings, TerrainGrid};
        let folder = tempfile::tempdir().unwrap();
        let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
        let grid = TerrainGrid::new(4106, 4106, 1.0).unwrap();
        let mut terrain = Terrain::create(&folder.path().join("t.orogeny"), grid, 0.0, settings).unwrap();
        let text = r#"{"op": "fill", "brush": {"type": "set_height", "height": 50, "strength": 1}}"#;
        terrain.apply(&[Operation::from_json_text(text).unwrap()], &mut Quiet).unwrap();
        for region_m in [None, Some([4105.0, 0.0, 1.0, 4106.0]), Some([3.0, 5.0, 1.0, 4000.0])] {
            let request = MapRequest { region_m, ..MapRequest::new(folder.path().join("m.png")) };
            let summary = terrain.draw_map(&request, &mut Quiet).unwrap();
            assert_eq!((summary.level, summary.range_m), (1, [50.0, 50.0]), "{region_m:?}");
        }
    }
}
