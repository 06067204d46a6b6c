//! A preset's picture: its brush painted on a small fresh terrain, drawn as a relief.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use orogeny_field::{MAX_SPACING_M, MIN_SPACING_M, TerrainGrid};

use super::Preset;
use super::sample::{Sample, SampleGround, hills, rough_hills};
use crate::ground::Ground;
use crate::relief::{self, Relief};
use crate::{Adapter, Error, Picture, Quiet, Result, Settings, Terrain};

/// Samples a side of the terrain that is painted.
const SIDE_SAMPLES: u32 = 384;
/// Bytes of pages that painting it may keep.
const PAGE_BUDGET_IN_BYTES: u64 = 64 << 20;
/// Reliefs are drawn nearer to this share of the ground's width than they are, by this power: shallow brushes show, and
/// are still shallower than steep ones.
const RELIEF: f32 = 0.2;
const RELIEF_POWER: f32 = 0.4;
/// The mean slope (root of the mean square, where it slopes at all) beyond which nothing is exaggerated: what is rough but
/// not high would be all needles.
const MAX_MEAN_SLOPE: f32 = 0.8;
/// The drawn relief, as a share of the width, that runs through all tints on one side of the ground.
const TINTED_RELIEF: f32 = 0.1;
/// Hills have no low tints: those are for what lies below the ground. This is how far those would go on, in reliefs.
const BELOW_HILLS: f32 = 0.5;

/// How a thumbnail begins in a preset's file.
const DATA_URL_PREFIX: &str = "data:image/png;base64,";
const PNG_SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
/// Pixels along x of a thumbnail in a file.
const EMBEDDED_WIDTH_PX: u32 = 256;

impl Preset {
    /// Paints and draws it, on the CPU; a picture of `width_px` is three quarters as high.
    ///
    /// # Errors
    /// [`Error::PictureSize`]; whatever keeps its brush from being painted.
    pub fn draw_thumbnail(&self, width_px: u32) -> Result<Picture> {
        let size_px = [width_px, (width_px.saturating_mul(3) / 4).max(1)];
        // Before anything is painted in vain.
        Picture::new(size_px[0], size_px[1], relief::BACKGROUND)?;
        let sample = self.sample.unwrap_or_default();
        let (ground, is_flat) = match sample.ground {
            Some(ground) => (self.painted(&sample, ground)?, ground == SampleGround::Flat),
            None => {
                let flat = self.painted(&sample, SampleGround::Flat)?;
                let [low_m, high_m] = flat.range_m();
                match low_m < high_m || low_m != sample.height_m {
                    true => (flat, true),
                    false => (self.painted(&sample, SampleGround::Hills)?, false),
                }
            }
        };
        let base_m = is_flat.then_some(sample.height_m);
        relief::draw(&ground, &framed(&ground, base_m, size_px))
    }

    /// The same preset with its thumbnail in it.
    ///
    /// # Errors
    /// As [`Self::draw_thumbnail`].
    pub fn with_thumbnail(&self) -> Result<Self> {
        let png = self.draw_thumbnail(EMBEDDED_WIDTH_PX)?.to_png()?;
        let thumbnail = Some(format!("{DATA_URL_PREFIX}{}", STANDARD.encode(png)));
        Ok(Self { thumbnail, ..self.clone() })
    }

    fn painted(&self, sample: &Sample, kind: SampleGround) -> Result<Ground> {
        let brush = self.brush()?;
        let side_samples = f64::from(SIDE_SAMPLES);
        let spacing_m =
            (sample.width_in_radii() * brush.radius_m / side_samples).clamp(MIN_SPACING_M, MAX_SPACING_M);
        let side_m = side_samples * spacing_m;
        let grid = TerrainGrid::new(SIDE_SAMPLES.into(), SIDE_SAMPLES.into(), spacing_m)?;
        let folder =
            tempfile::tempdir().map_err(|source| Error::Write { path: std::env::temp_dir(), source })?;
        let settings = Settings {
            adapter: Adapter::Cpu,
            page_budget_in_bytes: PAGE_BUDGET_IN_BYTES,
            ..Settings::default()
        };
        let path = folder.path().join("thumbnail.orogeny");
        let mut terrain = Terrain::create(&path, grid, sample.height_m, settings)?;
        let mut operations = match kind {
            SampleGround::Flat => Vec::new(),
            SampleGround::Hills => hills(side_m),
            SampleGround::Rough => rough_hills(side_m),
        };
        operations.push(sample.operation(brush, side_m));
        terrain.apply(&operations, &mut Quiet)?;
        let (ground, ..) = terrain.mean_heights(grid.bounds(), 1, &mut Quiet)?;
        terrain.close()?;
        Ok(ground)
    }
}

/// How high the relief is drawn and how it is tinted: flat ground at `base_m` has the middle tint.
fn framed(ground: &Ground, base_m: Option<f32>, size_px: [u32; 2]) -> Relief {
    let [low_m, high_m] = ground.range_m();
    let side_m = ground.spacing_m * ground.width as f32;
    let share = (high_m - low_m) / side_m;
    let exaggeration = match share > 0.0 {
        true => (RELIEF / share).powf(1.0 - RELIEF_POWER).min((MAX_MEAN_SLOPE / mean_slope(ground)).max(1.0)),
        false => 1.0,
    };
    let tint_range_m = match base_m {
        None => [low_m - BELOW_HILLS * (high_m - low_m), high_m],
        Some(base_m) => {
            let reach_m = (high_m - base_m).max(base_m - low_m).max(TINTED_RELIEF * side_m / exaggeration);
            [base_m - reach_m, base_m + reach_m]
        }
    };
    Relief { size_px, exaggeration, tint_range_m }
}

/// Metres up a metre along x, where it slopes at all.
fn mean_slope(ground: &Ground) -> f32 {
    let (mut sum, mut count) = (0.0_f64, 0_u32);
    for row in ground.heights.chunks_exact(ground.width) {
        for pair in row.windows(2) {
            if let [west_m, east_m] = pair
                && west_m != east_m
            {
                let slope = f64::from((east_m - west_m) / ground.spacing_m);
                sum += slope * slope;
                count += 1;
            }
        }
    }
    (sum / f64::from(count.max(1))).sqrt() as f32
}

/// What is wrong with a thumbnail in a file, for people.
pub(super) fn check_data_url(url: &str) -> Result<(), String> {
    let coded = url
        .strip_prefix(DATA_URL_PREFIX)
        .ok_or_else(|| format!("`thumbnail` must begin with `{DATA_URL_PREFIX}`"))?;
    let bytes = STANDARD.decode(coded).map_err(|err| format!("`thumbnail` is no base64: {err}"))?;
    match bytes.starts_with(PNG_SIGNATURE) {
        true => Ok(()),
        false => Err("`thumbnail` holds no PNG".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn preset(brush: &str) -> Preset {
        Preset::new("A", serde_json::from_str(brush).unwrap()).unwrap()
    }

    #[test]
    fn what_a_brush_does_is_seen() {
        let [raised, lowered, levelled] = [
            r#"{"type": "raise"}"#,
            r#"{"type": "lower"}"#,
            // Does nothing to flat ground, so hills are drawn.
            r#"{"type": "level"}"#,
        ]
        .map(|brush| preset(brush).draw_thumbnail(64).unwrap());
        assert_eq!([raised.width_px, raised.height_px], [64, 48]);
        let plain = preset(r#"{"type": "raise", "strength": 0}"#);
        let plain = Preset {
            sample: Some(Sample { ground: Some(SampleGround::Flat), ..Sample::default() }),
            ..plain
        };
        let plain = plain.draw_thumbnail(64).unwrap();
        assert!(raised != lowered && raised != levelled && lowered != levelled);
        assert!([raised, lowered, levelled].iter().all(|picture| *picture != plain));
    }

    #[test]
    fn every_radius_can_be_drawn() {
        for radius in ["1e-9", "1e9"] {
            preset(&format!(r#"{{"type": "raise", "radius": {radius}}}"#)).draw_thumbnail(32).unwrap();
            preset(&format!(r#"{{"type": "level", "radius": {radius}}}"#)).draw_thumbnail(32).unwrap();
        }
    }

    #[test]
    fn a_thumbnail_goes_into_the_file_and_is_accepted_there() {
        let with_thumbnail = preset(r#"{"type": "raise"}"#).with_thumbnail().unwrap();
        assert!(with_thumbnail.to_json_text().unwrap().len() < 100_000);
        assert_eq!(
            check_data_url("data:image/png;base64,!").unwrap_err().split(':').next(),
            Some("`thumbnail` is no base64")
        );
    }
}
