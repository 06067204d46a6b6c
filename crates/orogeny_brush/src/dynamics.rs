//! What pressure, tilt and chance make of a brush at one place.

use orogeny_field::hash::{bits_to_uniform, hash};
use orogeny_field::{Brush, Curve};

use crate::sampler::PlacedSample;

/// What each kind of chance is drawn by, beside the instance's number.
const JITTER_RADIUS: u32 = 0x71;
const JITTER_STRENGTH: u32 = 0x72;
const JITTER_DISTANCE: u32 = 0x73;
const JITTER_ANGLE: u32 = 0x74;
/// The angle of an alpha bitmap that is turned at random.
const ALPHA_ANGLE: u32 = 0x75;

/// A brush at one place of a stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Touch {
    /// What the radius is multiplied by, 0..1.
    pub(crate) radius: f64,
    /// What the strength is multiplied by, 0..1.
    pub(crate) strength: f64,
    /// The flow, 0..1.
    pub(crate) flow: f64,
    /// How far the centre is off, in radii of the brush.
    pub(crate) offset: [f64; 2],
    /// A random angle, radians.
    pub(crate) angle: f64,
}

impl Touch {
    /// The brush at a place, with the stroke's seed.
    pub(crate) fn of(brush: &Brush, seed: u32, place: &PlacedSample) -> Self {
        let chance = |kind: u32| f64::from(bits_to_uniform(hash(place.index, kind, seed)));
        let (pressure, tilt) = (place.pen.pressure, place.pen.tilt);
        let by_pressure = |curve: Option<&Curve>, is_scaled: bool| match curve {
            Some(curve) => curve.value(pressure),
            None if is_scaled => pressure,
            None => 1.0,
        };
        let by_tilt = |curve: Option<&Curve>| curve.map_or(1.0, |curve| curve.value(tilt));
        let dynamics = &brush.dynamics;
        let radius = by_pressure(dynamics.pressure_to_radius.as_ref(), brush.pressure.scales_radius())
            * by_tilt(dynamics.tilt_to_radius.as_ref());
        let strength = by_pressure(dynamics.pressure_to_strength.as_ref(), brush.pressure.scales_strength())
            * by_tilt(dynamics.tilt_to_strength.as_ref());
        let flow = by_pressure(dynamics.pressure_to_flow.as_ref(), brush.pressure.scales_flow())
            * by_tilt(dynamics.tilt_to_flow.as_ref());
        let jitter = brush.jitter;
        // The square root spreads places evenly over the disc.
        let distance = jitter.position * chance(JITTER_DISTANCE).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * chance(JITTER_ANGLE)).sin_cos();
        Self {
            radius: radius * (1.0 - jitter.radius * chance(JITTER_RADIUS)),
            strength: strength * (1.0 - jitter.strength * chance(JITTER_STRENGTH)),
            flow: flow * brush.flow,
            offset: [distance * cos, distance * sin],
            angle: std::f64::consts::TAU * chance(ALPHA_ANGLE),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::Pen;
    use orogeny_field::{BrushType, Jitter, PressureTarget};

    fn place(index: u32, pressure: f64, tilt: f64) -> PlacedSample {
        PlacedSample {
            position: [0.0; 2],
            pen: Pen { pressure, tilt },
            direction: [1.0, 0.0],
            index,
            rested_s: None,
        }
    }

    fn curve(points: &[[f64; 2]]) -> Option<Curve> {
        Some(Curve::new("a test", points.to_vec()).unwrap())
    }

    #[test]
    fn a_curve_stands_in_for_the_plain_scaling_and_tilt_multiplies() {
        let mut brush = Brush { pressure: PressureTarget::Both, ..Brush::new(BrushType::Raise, 10.0, 1.0) };
        let plain = Touch::of(&brush, 1, &place(0, 0.25, 1.0));
        assert_eq!((plain.radius, plain.strength, plain.flow, plain.offset), (0.25, 0.25, 1.0, [0.0, 0.0]));
        brush.dynamics.pressure_to_radius = curve(&[[0.0, 1.0], [1.0, 0.5]]);
        brush.dynamics.tilt_to_strength = curve(&[[0.0, 1.0], [1.0, 0.0]]);
        brush.dynamics.pressure_to_flow = curve(&[[0.0, 0.0], [1.0, 1.0]]);
        let bent = Touch::of(&brush, 1, &place(0, 0.5, 0.5));
        assert_eq!((bent.radius, bent.strength, bent.flow), (0.75, 0.25, 0.5));
    }

    #[test]
    fn chance_stays_within_its_bounds_and_differs_from_place_to_place() {
        let jitter = Jitter { radius: 0.5, position: 2.0, strength: 0.25 };
        let brush = Brush { jitter, ..Brush::new(BrushType::Raise, 10.0, 1.0) };
        let touches: Vec<_> = (0..500).map(|index| Touch::of(&brush, 7, &place(index, 1.0, 0.0))).collect();
        assert!(touches.iter().all(|touch| (0.5..=1.0).contains(&touch.radius)));
        assert!(touches.iter().all(|touch| (0.75..=1.0).contains(&touch.strength)));
        let distances: Vec<_> = touches.iter().map(|touch| touch.offset[0].hypot(touch.offset[1])).collect();
        assert!(distances.iter().all(|distance| *distance <= 2.0));
        let mean = distances.iter().sum::<f64>() / 500.0;
        assert!((mean - 4.0 / 3.0).abs() < 0.1, "a disc's mean distance is two thirds of its radius: {mean}");
        assert_eq!(touches[3], Touch::of(&brush, 7, &place(3, 1.0, 0.0)));
        assert_ne!(touches[3], Touch::of(&brush, 8, &place(3, 1.0, 0.0)));
    }
}
