//! How long a degree is on the WGS84 ellipsoid.
//!
//! With semi-major axis `a`, eccentricity `e` and geodetic latitude φ (J. P. Snyder, *Map Projections: A Working
//! Manual*, USGS Professional Paper 1395, 1987, chapter 4):
//!
//! - radius of curvature along the meridian: `M = a (1 − e²) / (1 − e² sin² φ)^(3/2)`; a degree of latitude is
//!   `M π / 180`;
//! - radius of the parallel: `a cos φ / (1 − e² sin² φ)^(1/2)`; a degree of longitude is that times `π / 180`.

/// Semi-major axis of WGS84, metres.
const SEMI_MAJOR_AXIS_M: f64 = 6_378_137.0;

/// Flattening of WGS84.
const FLATTENING: f64 = 1.0 / 298.257_223_563;

const ECCENTRICITY_SQUARED: f64 = FLATTENING * (2.0 - FLATTENING);

/// Metres in a degree of latitude at `latitude_degrees`, −90 to 90.
pub fn metres_per_degree_of_latitude(latitude_degrees: f64) -> f64 {
    let meridian_radius_m =
        SEMI_MAJOR_AXIS_M * (1.0 - ECCENTRICITY_SQUARED) / curvature(latitude_degrees).powf(1.5);
    meridian_radius_m.to_radians()
}

/// Metres in a degree of longitude at `latitude_degrees`, −90 to 90: 0 at the poles.
pub fn metres_per_degree_of_longitude(latitude_degrees: f64) -> f64 {
    let parallel_radius_m =
        SEMI_MAJOR_AXIS_M * latitude_degrees.to_radians().cos() / curvature(latitude_degrees).sqrt();
    parallel_radius_m.to_radians()
}

/// `1 − e² sin² φ`.
fn curvature(latitude_degrees: f64) -> f64 {
    1.0 - ECCENTRICITY_SQUARED * latitude_degrees.to_radians().sin().powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of Snyder's chapter 4 and of every handbook, rounded to a metre.
    #[test]
    fn degrees_have_their_published_lengths() {
        for (latitude, of_latitude, of_longitude) in [
            (0.0, 110_574.0, 111_320.0),
            (45.0, 111_132.0, 78_847.0),
            (60.0, 111_412.0, 55_800.0),
            (90.0, 111_694.0, 0.0),
        ] {
            assert!((metres_per_degree_of_latitude(latitude) - of_latitude).abs() < 1.0, "{latitude}");
            assert!((metres_per_degree_of_longitude(latitude) - of_longitude).abs() < 1.0, "{latitude}");
        }
    }
}
