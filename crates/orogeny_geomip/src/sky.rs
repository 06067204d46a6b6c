//! What colour the sky has, and what is left of the sun: light that air, haze and ozone scatter once, and a share for all that they scatter more often.
//!
//! Densities and heights: Bruneton and Neyret, "Precomputed Atmospheric Scattering" (2008), with the ozone of Hillaire, "A Scalable and
//! Production Ready Sky and Atmosphere Rendering Technique" (2020). Radiances are those of a sun of irradiance 1 before the air, of the same
//! strength in red, green and blue.

use glam::DVec3;
use rayon::prelude::*;

const GROUND_RADIUS_M: f64 = 6_360_000.0;
const TOP_RADIUS_M: f64 = 6_460_000.0;
/// Where the eye is taken to be, over the ground: the sky hardly changes with a mountain's height.
const EYE_HEIGHT_M: f64 = 500.0;

/// Scattering by air at the ground, 1/m, and the height at which there is 1/e of it.
const AIR: DVec3 = DVec3::new(5.802e-6, 13.558e-6, 33.1e-6);
const AIR_HEIGHT_M: f64 = 8_000.0;
/// Scattering by haze, and what it swallows beside that.
const HAZE: f64 = 3.996e-6;
const HAZE_ABSORPTION: f64 = 4.4e-6;
const HAZE_HEIGHT_M: f64 = 1_200.0;
/// How much haze scatters forwards.
const HAZE_FORWARD: f64 = 0.8;
/// What ozone swallows, in a layer around 25 km.
const OZONE: DVec3 = DVec3::new(0.650e-6, 1.881e-6, 0.085e-6);

/// Steps along a ray, and from each towards the sun.
const NUM_STEPS: u32 = 24;
const NUM_SUN_STEPS: u32 = 8;

/// The share of light scattered once that comes again from all sides, having been scattered more often: fitted by eye to the blue of a zenith.
const SCATTERED_AGAIN: f64 = 0.45;

/// Columns and rows of [`Sky::texels`]: from the sun's side to the other, from the zenith to the horizon.
pub const SKY_SIZE: [u32; 2] = [64, 64];

/// The sky under one sun.
#[derive(Debug, Clone, PartialEq)]
pub struct Sky {
    /// To the sun, of length 1.
    pub to_sun: DVec3,
    /// Irradiance of what faces the sun, behind the air.
    pub sun_light: DVec3,
    /// Irradiance of what faces the zenith, but for the sun.
    pub sky_light: DVec3,
    /// Radiance, row by row. See `shaders/scene/light.wgsl` for which direction a texel is.
    pub texels: Vec<DVec3>,
}

impl Sky {
    /// Under a sun at an azimuth (degrees from north, clockwise) and an altitude above the horizon (-5 to 90 degrees; beyond these the nearer of
    /// them), in air with so many times the usual haze (0 to 20).
    #[must_use]
    pub fn new(azimuth_degrees: f64, altitude_degrees: f64, haze: f64) -> Self {
        let altitude = altitude_degrees.clamp(-5.0, 90.0).to_radians();
        let azimuth = azimuth_degrees.to_radians();
        let to_sun =
            DVec3::new(azimuth.sin() * altitude.cos(), altitude.sin(), -azimuth.cos() * altitude.cos());
        let air = Atmosphere { haze: haze.clamp(0.0, 20.0) };
        // Seen from the sun's side, so that the texture is the same for every azimuth.
        let sun = DVec3::new(altitude.cos(), altitude.sin(), 0.0);
        let [columns, rows] = SKY_SIZE;
        let direction = |index: u32| {
            let share = |place: u32, num: u32| f64::from(place) / f64::from(num - 1);
            let azimuth = share(index % columns, columns) * std::f64::consts::PI;
            // More rows near the horizon.
            let height = (1.0 - share(index / columns, rows)).powi(2);
            let level = (1.0 - height * height).max(0.0).sqrt();
            DVec3::new(azimuth.cos() * level, height, azimuth.sin() * level)
        };
        let texels: Vec<_> =
            (0..columns * rows).into_par_iter().map(|index| air.radiance(direction(index), sun)).collect();
        let sky_light = irradiance(&texels, direction);
        Self { to_sun, sun_light: air.sunlight(eye(), sun), sky_light, texels }
    }
}

fn eye() -> DVec3 {
    DVec3::new(0.0, GROUND_RADIUS_M + EYE_HEIGHT_M, 0.0)
}

/// Over the upper half of all directions, each by its cosine.
fn irradiance(texels: &[DVec3], direction: impl Fn(u32) -> DVec3) -> DVec3 {
    let [columns, rows] = SKY_SIZE;
    let mut sum = DVec3::ZERO;
    for (index, radiance) in (0_u32..).zip(texels) {
        // Heights are squares, so a row is as high as their change.
        let up = direction(index).y;
        let row_height = 2.0 * up.sqrt() / f64::from(rows - 1);
        let is_rim = index % columns == 0 || index % columns == columns - 1;
        let column_width =
            if is_rim { 0.5 } else { 1.0 } * 2.0 * std::f64::consts::PI / f64::from(columns - 1);
        sum += *radiance * (up * row_height * column_width);
    }
    sum
}

struct Atmosphere {
    haze: f64,
}

/// What there is at a height: scattering by air and by haze, and all that takes light away, 1/m.
struct Density {
    air: DVec3,
    haze: f64,
    extinction: DVec3,
}

impl Atmosphere {
    fn density(&self, place: DVec3) -> Density {
        let height_m = (place.length() - GROUND_RADIUS_M).max(0.0);
        let air = AIR * (-height_m / AIR_HEIGHT_M).exp();
        let thinned = self.haze * (-height_m / HAZE_HEIGHT_M).exp();
        let ozone = OZONE * (1.0 - (height_m - 25_000.0).abs() / 15_000.0).max(0.0);
        let haze = HAZE * thinned;
        Density { air, haze, extinction: air + DVec3::splat(haze + HAZE_ABSORPTION * thinned) + ozone }
    }

    /// What arrives from the sun at a place; nothing in the earth's shadow.
    fn sunlight(&self, place: DVec3, sun: DVec3) -> DVec3 {
        let along = place.dot(sun);
        let nearest = (place.length_squared() - along * along).max(0.0).sqrt();
        // A sun of half a degree sets slowly.
        let dip = if along < 0.0 { (nearest - GROUND_RADIUS_M) / 40_000.0 } else { 1.0 };
        let length = to_top(place, sun);
        let step = length / f64::from(NUM_SUN_STEPS);
        let depth = (0..NUM_SUN_STEPS).map(|k| {
            let at = place + sun * (step * (f64::from(k) + 0.5));
            self.density(at).extinction * step
        });
        let depth = depth.sum::<DVec3>();
        (-depth).exp() * (0.5 + dip).clamp(0.0, 1.0)
    }

    fn radiance(&self, direction: DVec3, sun: DVec3) -> DVec3 {
        let cosine = direction.dot(sun);
        let of_air = 3.0 / (16.0 * std::f64::consts::PI) * (1.0 + cosine * cosine);
        let g = HAZE_FORWARD;
        // Cornette and Shanks, 1992.
        let of_haze = 3.0 / (8.0 * std::f64::consts::PI) * (1.0 - g * g) * (1.0 + cosine * cosine)
            / ((2.0 + g * g) * (1.0 + g * g - 2.0 * g * cosine).powf(1.5));
        let from_all_sides = SCATTERED_AGAIN / (4.0 * std::f64::consts::PI);
        let length = to_top(eye(), direction);
        let (mut sum, mut left, mut from) = (DVec3::ZERO, DVec3::ONE, 0.0);
        for k in 1..=NUM_STEPS {
            // Short steps near the eye.
            let to = length * (f64::from(k) / f64::from(NUM_STEPS)).powi(2);
            let (step, place) = (to - from, eye() + direction * (0.5 * (from + to)));
            let Density { air, haze, extinction } = self.density(place);
            let lit = self.sunlight(place, sun);
            let scattered = air * (of_air + from_all_sides) + DVec3::splat(haze * (of_haze + from_all_sides));
            let kept = (-extinction * step).exp();
            // The integral over the step, whose air is taken to be the same all along.
            sum += left * lit * scattered * (DVec3::ONE - kept) / extinction.max(DVec3::splat(1.0e-12));
            left *= kept;
            from = to;
        }
        sum
    }
}

/// Metres along a ray to the top of the air.
fn to_top(place: DVec3, direction: DVec3) -> f64 {
    let along = place.dot(direction);
    let inside = TOP_RADIUS_M * TOP_RADIUS_M - place.length_squared() + along * along;
    (inside.max(0.0).sqrt() - along).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_high_sun_is_white_and_its_sky_blue() {
        let sky = Sky::new(180.0, 60.0, 1.0);
        assert!(sky.sun_light.min_element() > 0.6 && sky.sun_light.max_element() < 1.0, "{}", sky.sun_light);
        assert!(sky.sky_light.z > 1.5 * sky.sky_light.x, "{}", sky.sky_light);
        // What the sky sends is a fraction of what the sun does.
        assert!(sky.sky_light.y > 0.04 && sky.sky_light.y < 0.35, "{}", sky.sky_light);
        assert!((sky.to_sun.length() - 1.0).abs() < 1.0e-12 && sky.to_sun.z > 0.49, "{}", sky.to_sun);
    }

    #[test]
    fn a_low_sun_is_red_and_one_below_the_horizon_dark() {
        let low = Sky::new(90.0, 3.0, 1.0);
        assert!(low.sun_light.x > 2.0 * low.sun_light.z, "{}", low.sun_light);
        let high = Sky::new(90.0, 50.0, 1.0);
        let night = Sky::new(90.0, -5.0, 1.0);
        let lights = [high, low, night].map(|sky| sky.sky_light.y);
        assert!(lights[0] > lights[1] && lights[1] > lights[2] && lights[2] >= 0.0, "{lights:?}");
    }

    #[test]
    fn haze_takes_from_the_sun_and_brightens_what_is_around_it() {
        let (clear, hazy) = (Sky::new(0.0, 30.0, 0.5), Sky::new(0.0, 30.0, 8.0));
        assert!(clear.sun_light.y > hazy.sun_light.y);
        // On the sun's side, 30 degrees up: half of the rows of height 0.5.
        let row = ((1.0 - 0.5_f64.sqrt()) * f64::from(SKY_SIZE[1] - 1)) as usize;
        let at_sun = |sky: &Sky| sky.texels[row * SKY_SIZE[0] as usize].y;
        assert!(at_sun(&hazy) > 1.5 * at_sun(&clear));
        assert!(hazy.texels.iter().all(|texel| texel.is_finite() && texel.min_element() >= 0.0));
    }
}
