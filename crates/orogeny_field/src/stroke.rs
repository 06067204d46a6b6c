//! What a hand does: pointer samples, as they come.

use crate::{Brush, Error, Result, TerrainGrid};

/// How far from the terrain's corner a stroke point may lie, in samples: kernels hold a place as a 32-bit integer.
pub const MAX_COORDINATE_SAMPLES: f64 = (1_u32 << 29) as f64;

/// The most points of one stroke: hours of drawing.
pub const MAX_STROKE_POINTS: usize = 1 << 20;

/// One pointer sample. In JSON `[x, z]`, then, as far as they are given, pressure, time and tilt.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct PointerSample {
    /// Place in the world, in metres.
    pub position_m: [f64; 2],
    /// 0..1; 1 where the device has none.
    pub pressure: f32,
    /// Seconds since the stroke began, where known: an airbrush goes on while the pointer rests.
    pub time_s: Option<f64>,
    /// Degrees by which the pen leans: 0 upright, 90 flat.
    pub tilt_deg: f32,
}

impl PointerSample {
    /// A sample at full pressure.
    #[must_use]
    pub const fn at(x_m: f64, z_m: f64) -> Self {
        Self { position_m: [x_m, z_m], pressure: 1.0, time_s: None, tilt_deg: 0.0 }
    }

    /// The same place with another pressure, 0..1.
    #[must_use]
    pub const fn with_pressure(mut self, pressure: f32) -> Self {
        self.pressure = pressure;
        self
    }
}

impl TryFrom<Vec<f64>> for PointerSample {
    type Error = String;

    fn try_from(values: Vec<f64>) -> Result<Self, String> {
        match *values.as_slice() {
            [x_m, z_m] => Ok(Self::at(x_m, z_m)),
            [x_m, z_m, pressure] => Ok(Self::at(x_m, z_m).with_pressure(pressure as f32)),
            [x_m, z_m, pressure, time_s] => {
                Ok(Self { time_s: Some(time_s), ..Self::at(x_m, z_m).with_pressure(pressure as f32) })
            }
            [x_m, z_m, pressure, time_s, tilt_deg] => {
                let sample = Self::at(x_m, z_m).with_pressure(pressure as f32);
                Ok(Self { time_s: Some(time_s), tilt_deg: tilt_deg as f32, ..sample })
            }
            _ => Err(format!(
                "a point is [x, z] and up to three more, pressure, time and tilt, not {} numbers",
                values.len()
            )),
        }
    }
}

impl From<PointerSample> for Vec<f64> {
    fn from(sample: PointerSample) -> Self {
        let [x_m, z_m] = sample.position_m;
        let mut values = vec![x_m, z_m];
        let has_tilt = sample.tilt_deg != 0.0;
        if sample.pressure.to_bits() != 1.0_f32.to_bits() || sample.time_s.is_some() || has_tilt {
            values.push(f64::from(sample.pressure));
        }
        if has_tilt {
            // What comes after it has to be given a time, and then is.
            values.extend([sample.time_s.unwrap_or_default(), f64::from(sample.tilt_deg)]);
        } else {
            values.extend(sample.time_s);
        }
        values
    }
}

/// A brush drawn along pointer samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// What is drawn with.
    pub brush: Brush,
    /// Feeds everything random in it.
    pub seed: u32,
    /// Where, in order.
    pub points: Vec<PointerSample>,
}

impl PointerSample {
    /// Accepts a sample for a terrain; `index` is named in the error.
    ///
    /// # Errors
    /// [`Error::Point`] unless the position is finite and within [`MAX_COORDINATE_SAMPLES`], the pressure is within 0..1, the
    /// tilt within 0..90 degrees and the time, if any, is finite and not negative.
    pub fn check(&self, grid: &TerrainGrid, index: usize) -> Result<()> {
        let limit_m = MAX_COORDINATE_SAMPLES * grid.spacing_m();
        for (what, value) in [("x", self.position_m[0]), ("z", self.position_m[1])] {
            if !(-limit_m..=limit_m).contains(&value) {
                let limit = format!("it must be within ±{limit_m} m");
                return Err(Error::Point { index, what, value, limit });
            }
        }
        if !(0.0..=1.0).contains(&self.pressure) {
            let limit = "it must be within 0 to 1".to_owned();
            return Err(Error::Point { index, what: "pressure", value: f64::from(self.pressure), limit });
        }
        if !(0.0..=90.0).contains(&self.tilt_deg) {
            let limit = "it must be within 0 to 90 degrees".to_owned();
            return Err(Error::Point { index, what: "tilt", value: f64::from(self.tilt_deg), limit });
        }
        match self.time_s {
            Some(value) if !(value.is_finite() && value >= 0.0) => Err(Error::Point {
                index,
                what: "time",
                value,
                limit: "it must be 0 or more seconds".to_owned(),
            }),
            _ => Ok(()),
        }
    }
}

impl Stroke {
    /// Accepts a stroke for a terrain.
    ///
    /// # Errors
    /// As [`Brush::check`]; [`Error::EmptyStroke`] without points, [`Error::TooManyPoints`] with more than
    /// [`MAX_STROKE_POINTS`], [`Error::Point`] for the first unusable one.
    pub fn check(&self, grid: &TerrainGrid) -> Result<()> {
        self.brush.check()?;
        if self.points.is_empty() {
            return Err(Error::EmptyStroke);
        }
        if self.points.len() > MAX_STROKE_POINTS {
            return Err(Error::TooManyPoints { num_points: self.points.len(), limit: MAX_STROKE_POINTS });
        }
        self.points.iter().enumerate().try_for_each(|(index, point)| point.check(grid, index))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_read_and_write_as_short_as_they_can() {
        for text in ["[1.0,2.0]", "[1.0,2.0,0.5]", "[1.0,2.0,1.0,3.25]", "[1.0,2.0,1.0,3.25,45.0]"] {
            let point: PointerSample = serde_json::from_str(text).unwrap();
            assert_eq!(serde_json::to_string(&point).unwrap(), text);
        }
        assert!(serde_json::from_str::<PointerSample>("[1.0]").is_err());
        assert!(serde_json::from_str::<PointerSample>("[1,2,3,4,5,6]").is_err());
    }

    #[test]
    fn points_that_are_no_place_are_refused() {
        let grid = TerrainGrid::new(64, 64, 1.0).unwrap();
        for (x_m, z_m) in [(f64::NAN, 0.0), (0.0, f64::INFINITY), (1.0e12, 0.0)] {
            assert!(matches!(
                PointerSample::at(x_m, z_m).check(&grid, 3),
                Err(Error::Point { index: 3, .. })
            ));
        }
        for pressure in [-0.1, 1.1, f32::NAN] {
            assert!(PointerSample::at(0.0, 0.0).with_pressure(pressure).check(&grid, 0).is_err());
        }
        assert!(PointerSample::at(-1.0e6, 1.0e6).check(&grid, 0).is_ok());
    }
}
