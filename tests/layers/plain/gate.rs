//! Gates by hand: bands of height, slope, way down and curvature, by central differences over the mirrored ground; a noise, a selection.

use orogeny_field::{AspectGate, Band, Brush, BrushType, Gate, Procedure};

use super::sheet::ulps;
use super::{Plain, Sheet, brush};

/// The ground at a sample.
pub struct Ground {
    pub height_m: f64,
    /// Metres a metre along x and z.
    pub slope: [f64; 2],
    /// 1/km, positive on crests.
    pub curvature_per_km: f64,
}

/// What a gate lets through of the ground, 0..1.
pub fn let_through(gate: &Gate, ground: &Ground) -> f64 {
    let [slope_x, slope_z] = ground.slope;
    let steepness = (slope_x * slope_x + slope_z * slope_z).sqrt();
    let through = |band: &Option<Band>, value: f64| band.as_ref().map_or(1.0, |band| within(band, value));
    let facing = |aspect: &AspectGate| {
        let down_deg = (-slope_z).atan2(-slope_x).to_degrees();
        let off_deg = (down_deg - aspect.angle_deg).rem_euclid(360.0);
        let band = Band { min: 0.0, max: aspect.width_deg, feather: aspect.feather_deg };
        if steepness < 1.0e-9 { 0.0 } else { within(&band, off_deg.min(360.0 - off_deg)) }
    };
    through(&gate.height_m, ground.height_m)
        * through(&gate.slope_deg, steepness.atan().to_degrees())
        * gate.aspect.as_ref().map_or(1.0, facing)
        * through(&gate.curvature_per_km, ground.curvature_per_km)
}

/// 1 within a range, 0 further outside than its feather, a smooth step between.
fn within(band: &Band, value: f64) -> f64 {
    let outside = (band.min - value).max(value - band.max);
    if outside <= 0.0 {
        return 1.0;
    }
    let inside = 1.0 - outside / band.feather;
    if inside > 0.0 { inside * inside * (3.0 - 2.0 * inside) } else { 0.0 }
}

/// The ground at a sample of a sheet.
fn ground(sheet: &Sheet, x: i32, z: i32, spacing_m: f64) -> Ground {
    let [west, east] = [-1, 1].map(|away| sheet.mirrored(x + away, z));
    let [north, south] = [-1, 1].map(|away| sheet.mirrored(x, z + away));
    let height_m = sheet.at(x, z);
    let bend = (west + east + north + south - 4.0 * height_m) / (spacing_m * spacing_m);
    Ground {
        height_m,
        slope: [(east - west) / (2.0 * spacing_m), (south - north) / (2.0 * spacing_m)],
        curvature_per_km: -0.5 * bend * 1000.0,
    }
}

/// What a gate lets through of the whole ground.
pub fn values(plain: &Plain<'_>, gate: &Gate, below: &Sheet) -> Sheet {
    assert_eq!(below.off, 0.0, "what hard ranges make of what is off has no bound");
    let spacing_m = plain.grid().spacing_m();
    let mut values =
        Sheet::from_fn(below.width, below.depth, |x, z| let_through(gate, &ground(below, x, z, spacing_m)));
    if gate.selection {
        values = values.zip(&plain.selection(), |value, selected| value * selected);
    }
    if let Some(noise_gate) = &gate.noise {
        // The brush `noise` of 1 m is the noise.
        let noise = noise_gate.noise.clone();
        let brush = Box::new(Brush { noise, ..Brush::new(BrushType::Noise, 1.0, 1.0) });
        let flat = below.map(0.0, |_| 0.0).off_by(0.0);
        match brush::brushed(plain, &Procedure { brush, seed: 0 }, &flat) {
            Some(noise) => {
                values = values.zip(&noise, |value, noise| value * within(&noise_gate.band, noise))
            }
            None => values = flat,
        }
    }
    if gate.is_inverted {
        values = values.map(1.0, |value| 1.0 - value);
    }
    values.off_by(ulps(4.0, 1.0))
}
