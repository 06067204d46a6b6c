//! From degrees or oblong pixels to square metres.
//!
//! The delivered spacing is the finer of the two a file has, at the latitude of its centre. The first delivered sample
//! is the file's north-west sample, and none lies beyond its south-east one. Heights between samples are those of the
//! Catmull-Rom spline, along x and then along z, held to the least and the greatest of the 4 × 4 samples they are made
//! of: so a cliff is not followed by a trench. Four rows are kept.

use crate::error::{Error, Result};
use crate::geodesy::{metres_per_degree_of_latitude, metres_per_degree_of_longitude};
use crate::options::ImportOptions;
use crate::place::Place;
use crate::source::{Header, RowSource, Spacing};

/// Pixels whose sides differ by less than this part are square: files round their spacing.
const SQUARE_TOLERANCE: f64 = 1.0e-6;

/// How many times as long as wide pixels may be: degrees reach it 0.6 degrees from a pole. It bounds how much larger
/// than its file a raster gets.
const MAX_OBLONGNESS: f64 = 100.0;

/// The size and spacing at which a raster is delivered.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    pub width: u32,
    pub depth: u32,
    pub spacing_m: Option<f64>,
    /// Metres between the file's samples along x and z, where it is resampled.
    resampled_from_m: Option<(f64, f64)>,
}

impl Plan {
    /// How a raster is delivered under `options`.
    pub fn new(header: &Header, options: &ImportOptions, place: &Place) -> Result<Self> {
        let as_it_is =
            |spacing_m| Self { width: header.width, depth: header.depth, spacing_m, resampled_from_m: None };
        if options.spacing_m.is_some() {
            return Ok(as_it_is(options.spacing_m));
        }
        let (x_m, z_m) = match header.spacing {
            Spacing::Unknown => return Ok(as_it_is(None)),
            Spacing::Unplaced { what, instead } => {
                return Err(Error::LocationNeeded { path: place.path.clone(), what, instead });
            }
            Spacing::Metres { x, z } if (x - z).abs() <= SQUARE_TOLERANCE * x => {
                return Ok(as_it_is(Some(x)));
            }
            Spacing::Metres { x, z } => (x, z),
            Spacing::Degrees { x, z, latitude } => {
                (x * metres_per_degree_of_longitude(latitude), z * metres_per_degree_of_latitude(latitude))
            }
        };
        let spacing_m = x_m.min(z_m);
        if x_m.max(z_m) > MAX_OBLONGNESS * spacing_m {
            return Err(place.unsupported(format!(
                "its pixels of {x_m} x {z_m} m are over {MAX_OBLONGNESS} times as long as wide: give a spacing"
            )));
        }
        let (width, depth) =
            (samples_along(header.width, x_m, spacing_m), samples_along(header.depth, z_m, spacing_m));
        let (width, depth) = place.check_size(width, depth, options.max_samples_per_side)?;
        Ok(Self { width, depth, spacing_m: Some(spacing_m), resampled_from_m: Some((x_m, z_m)) })
    }

    /// Whether the file's samples are delivered as they are.
    pub fn is_as_it_is(&self) -> bool {
        self.resampled_from_m.is_none()
    }

    /// What a person should know of it.
    pub fn notice(&self, header: &Header) -> Option<String> {
        let of_file = match header.spacing {
            Spacing::Unknown => return None,
            Spacing::Metres { x, z } => format!("{x} x {z} m"),
            Spacing::Degrees { x, z, latitude } => {
                format!("{x:.6} x {z:.6} degrees at latitude {latitude:.3}")
            }
            Spacing::Unplaced { what, .. } => what.to_owned(),
        };
        let (spacing_m, width, depth) = (self.spacing_m?, self.width, self.depth);
        if let Some((x_m, z_m)) = self.resampled_from_m {
            return Some(format!(
                "resampled from {} x {} samples of {of_file} ({x_m:.3} x {z_m:.3} m) to {width} x {depth} of {spacing_m:.3} m",
                header.width, header.depth
            ));
        }
        let square = header.spacing == Spacing::Metres { x: spacing_m, z: spacing_m };
        (!square).then(|| format!("its samples of {of_file} are taken as they are, {spacing_m} m apart"))
    }
}

/// How many samples `spacing_m` apart lie on `samples` that are `pixel_m` apart.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "`as` saturates, and the size is checked"
)]
fn samples_along(samples: u32, pixel_m: f64, spacing_m: f64) -> u64 {
    // A sample that misses the last by a rounding error is the last.
    let intervals = (f64::from(samples) - 1.0) * (pixel_m / spacing_m) + 1.0e-9;
    (intervals.floor() as u64).saturating_add(1)
}

/// The spline's weights of the samples −1, 0, 1 and 2 at `t` from sample 0 to 1.
fn weights(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [-0.5 * t + t2 - 0.5 * t3, 1.0 - 2.5 * t2 + 1.5 * t3, 0.5 * t + 2.0 * t2 - 1.5 * t3, -0.5 * t2 + 0.5 * t3]
}

/// Where a delivered sample lies among `samples` of the file.
#[derive(Debug, Clone, Copy)]
struct Tap {
    /// The four samples it is made of; at the border the last repeats.
    samples: [u32; 4],
    weights: [f64; 4],
}

impl Tap {
    /// The tap at `position`, in samples of the file.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the position is within the samples"
    )]
    fn new(position: f64, samples: u32) -> Self {
        let last = samples.saturating_sub(1);
        let base = (position.max(0.0) as u32).min(last);
        let t = (position - f64::from(base)).clamp(0.0, 1.0);
        let after = |n: u32| base.saturating_add(n).min(last);
        Self { samples: [base.saturating_sub(1), base, after(1), after(2)], weights: weights(t) }
    }
}

/// A row of the file, brought to the delivered columns.
#[derive(Debug, Clone, Default)]
struct Row {
    heights_m: Vec<f64>,
    /// Least and greatest of the four samples of each.
    bounds_m: Vec<(f32, f32)>,
}

/// Rows at a new spacing.
pub(crate) struct Resampled {
    inner: Box<dyn RowSource>,
    /// One row of the file.
    file_row: Vec<f32>,
    file_depth: u32,
    columns: Vec<Tap>,
    /// Rows of the file per delivered row: at most 1, so four rows are enough.
    rows_per_row: f64,
    /// Row `n` of the file is at `n % 4`.
    rows: [Row; 4],
    num_loaded: u32,
    num_delivered: u32,
}

impl Resampled {
    /// Rows of `inner` as `plan` says.
    pub fn new(inner: Box<dyn RowSource>, header: &Header, plan: &Plan) -> Self {
        let (x_m, z_m) = plan.resampled_from_m.unwrap_or((1.0, 1.0));
        let spacing_m = plan.spacing_m.unwrap_or(1.0);
        let columns = (0..plan.width)
            .map(|column| Tap::new(f64::from(column) * (spacing_m / x_m), header.width))
            .collect();
        Self {
            inner,
            file_row: vec![0.0; header.width as usize],
            file_depth: header.depth,
            columns,
            rows_per_row: spacing_m / z_m,
            rows: Default::default(),
            num_loaded: 0,
            num_delivered: 0,
        }
    }

    /// Reads the next row of the file and brings it to the delivered columns.
    #[expect(
        clippy::indexing_slicing,
        reason = "taps are made within the row, and a remainder by 4 indexes 4 rows"
    )]
    fn load(&mut self) -> Result<()> {
        self.inner.read_row(&mut self.file_row)?;
        let row = &mut self.rows[self.num_loaded as usize % 4];
        row.heights_m.clear();
        row.bounds_m.clear();
        for tap in &self.columns {
            let samples = tap.samples.map(|sample| self.file_row[sample as usize]);
            row.heights_m.push(
                tap.weights.iter().zip(samples).map(|(weight, sample)| weight * f64::from(sample)).sum(),
            );
            row.bounds_m.push(
                samples.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &sample| {
                    (low.min(sample), high.max(sample))
                }),
            );
        }
        self.num_loaded += 1;
        Ok(())
    }
}

impl RowSource for Resampled {
    #[expect(clippy::cast_possible_truncation, reason = "heights are f32")]
    #[expect(clippy::indexing_slicing, reason = "rows hold a height for every delivered column")]
    fn read_row(&mut self, row: &mut [f32]) -> Result<()> {
        let tap = Tap::new(f64::from(self.num_delivered) * self.rows_per_row, self.file_depth);
        while self.num_loaded <= tap.samples[3] {
            self.load()?;
        }
        let sources = tap.samples.map(|sample| &self.rows[sample as usize % 4]);
        for (column, height_m) in row.iter_mut().enumerate() {
            let (mut sum_m, mut low_m, mut high_m) = (0.0, f32::INFINITY, f32::NEG_INFINITY);
            for (weight, source) in tap.weights.iter().zip(sources) {
                sum_m += weight * source.heights_m[column];
                let (low, high) = source.bounds_m[column];
                (low_m, high_m) = (low_m.min(low), high_m.max(high));
            }
            *height_m = (sum_m as f32).clamp(low_m, high_m);
        }
        self.num_delivered += 1;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::SampleType;
    use crate::source::MemoryRows;

    fn header(width: u32, depth: u32, spacing: Spacing) -> Header {
        Header {
            width,
            depth,
            sample: SampleType::F32,
            spacing,
            georeference: None,
            notices: Vec::new(),
            needs_scan: false,
        }
    }

    fn place() -> Place {
        Place { path: "raster".into(), format: crate::Format::Npy }
    }

    fn resample(
        width: u32,
        depth: u32,
        spacing: Spacing,
        height_m: impl Fn(u32, u32) -> f32,
    ) -> (Plan, Vec<f32>) {
        let header = header(width, depth, spacing);
        let plan = Plan::new(&header, &ImportOptions::default(), &place()).unwrap();
        let heights_m = (0..depth).flat_map(|row| (0..width).map(move |column| (column, row)));
        let heights_m = heights_m.map(|(column, row)| height_m(column, row)).collect();
        let mut rows = Resampled::new(Box::new(MemoryRows::new(heights_m)), &header, &plan);
        let mut out = vec![0.0; plan.width as usize * plan.depth as usize];
        for row in out.chunks_exact_mut(plan.width as usize) {
            rows.read_row(row).unwrap();
        }
        (plan, out)
    }

    #[test]
    fn a_plane_stays_a_plane_and_the_first_sample_the_first() {
        let plane = |x_m: f32, z_m: f32| 3.0 * x_m - 2.0 * z_m + 100.0;
        let (plan, out) = resample(9, 7, Spacing::Metres { x: 1.0, z: 2.5 }, |column, row| {
            plane(column as f32, row as f32 * 2.5)
        });
        assert_eq!((plan.width, plan.depth, plan.spacing_m), (9, 16, Some(1.0)));
        assert_eq!(out[0], 100.0);
        for row in 3..13_u32 {
            for column in 0..9_u32 {
                let height_m = out[(row * 9 + column) as usize];
                assert!(
                    (height_m - plane(column as f32, row as f32)).abs() < 1e-3,
                    "{column}, {row}: {height_m}"
                );
            }
        }
    }

    #[test]
    fn samples_that_fall_on_samples_are_unchanged() {
        let noise = |column: u32, row: u32| ((column * 7919 + row * 104_729) % 1009) as f32;
        let (plan, out) = resample(6, 5, Spacing::Metres { x: 2.0, z: 1.0 }, noise);
        assert_eq!((plan.width, plan.depth), (11, 5));
        for (row, column) in (0..5).flat_map(|row| (0..6).map(move |column| (row, column))) {
            assert_eq!(out[(row * 11 + column * 2) as usize], noise(column, row));
        }
    }

    #[test]
    fn a_cliff_neither_overshoots_nor_undershoots() {
        let (_, out) =
            resample(
                40,
                12,
                Spacing::Metres { x: 3.7, z: 1.0 },
                |column, _| if column < 20 { 0.0 } else { 500.0 },
            );
        assert!(out.iter().all(|height_m| (0.0..=500.0).contains(height_m)));
        assert!(out.iter().any(|height_m| (100.0..400.0).contains(height_m)), "the cliff's face was made");
    }

    #[test]
    fn degrees_become_the_metres_of_their_latitude() {
        let spacing = Spacing::Degrees { x: 1.0 / 1200.0, z: 1.0 / 1200.0, latitude: 60.0 };
        let plan = Plan::new(&header(1201, 1201, spacing), &ImportOptions::default(), &place()).unwrap();
        // 55,800 m of longitude and 111,412 m of latitude to a degree.
        assert_eq!((plan.width, plan.depth), (1201, 2396));
        assert!((plan.spacing_m.unwrap() - 46.5).abs() < 0.01);
    }

    #[test]
    fn a_pole_and_a_raster_grown_too_large_are_refused() {
        let spacing = Spacing::Degrees { x: 0.001, z: 0.001, latitude: 90.0 };
        let err = Plan::new(&header(1201, 1201, spacing), &ImportOptions::default(), &place()).unwrap_err();
        assert!(matches!(err, Error::Unsupported { .. }), "{err}");
        let long = header(11, 1 << 20, Spacing::Metres { x: 1.0, z: 2.0 });
        let err = Plan::new(&long, &ImportOptions::default(), &place()).unwrap_err();
        assert!(matches!(err, Error::Size { width: 11, depth: 2_097_151, .. }), "{err}");
    }

    #[test]
    fn the_tap_helper_tells_a_shifted_sample() {
        assert_eq!(Tap::new(2.0, 9).samples, [1, 2, 3, 4]);
        assert_ne!(Tap::new(2.5, 9).weights, Tap::new(2.0, 9).weights);
        assert_eq!(Tap::new(8.0, 9).samples, [7, 8, 8, 8]);
        assert_eq!(Tap::new(0.0, 1).samples, [0; 4]);
    }
}
