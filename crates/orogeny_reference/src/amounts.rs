//! From the distance to an instance's centre to the amount `A` with which a brush acts on a sample.

use multiversion::multiversion;
use orogeny_field::{Bitmap, Falloff, FalloffFormula, Footprint, Instance, WeightMode};

use crate::falloff::{Curve, Formula, Gauss, HardEdge, Linear, Power, Sigmoid, Smooth, Sphere, Tip};
use crate::store::lerp;
use crate::transcendental::exp_minus_one;

/// Writes the amounts of one instance for the samples `first_x ..` of row `z`, in sample coordinates of the terrain.
///
/// In [`WeightMode::Wash`] an amount is the instance's `a w`, to be gathered by [`gather`].
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(amounts: &mut [f32], first_x: i32, z: i32, instance: &Instance, footprint: &Footprint) {
    let falloff = &footprint.falloff;
    let is_segment = footprint.is_segment;
    match falloff.formula {
        FalloffFormula::HardEdge => row_of::<HardEdge>(amounts, first_x, z, instance, falloff, is_segment),
        FalloffFormula::Linear => row_of::<Linear>(amounts, first_x, z, instance, falloff, is_segment),
        FalloffFormula::Smooth => row_of::<Smooth>(amounts, first_x, z, instance, falloff, is_segment),
        FalloffFormula::Sphere => row_of::<Sphere>(amounts, first_x, z, instance, falloff, is_segment),
        FalloffFormula::Tip => row_of::<Tip>(amounts, first_x, z, instance, falloff, is_segment),
        FalloffFormula::Gauss => row_of::<Gauss>(amounts, first_x, z, instance, falloff, is_segment),
        FalloffFormula::Power => row_of::<Power>(amounts, first_x, z, instance, falloff, is_segment),
        FalloffFormula::Sigmoid => row_of::<Sigmoid>(amounts, first_x, z, instance, falloff, is_segment),
        FalloffFormula::Curve => row_of::<Curve>(amounts, first_x, z, instance, falloff, is_segment),
    }
    if let Some(bitmap) = &footprint.alpha {
        for (place, amount) in amounts.iter_mut().enumerate() {
            *amount *= alpha(bitmap, instance, offset(first_x.wrapping_add(place as i32), z, instance));
        }
    }
    if footprint.weight_mode == WeightMode::BuildUp {
        // Exactly 0 where the weight is 0, since `exp_minus_one(0)` is.
        for amount in amounts {
            *amount = -exp_minus_one(*amount);
        }
    }
}

/// The way from an instance's centre to a sample, in samples.
#[inline(always)]
#[must_use]
pub fn offset(x: i32, z: i32, instance: &Instance) -> [f32; 2] {
    let [cell_x, cell_z] = instance.cell;
    let [fraction_x, fraction_z] = instance.fraction;
    [x.wrapping_sub(cell_x) as f32 - fraction_x, z.wrapping_sub(cell_z) as f32 - fraction_z]
}

/// How far along an instance's segment the place nearest to a sample lies, 0..1.
#[inline(always)]
#[must_use]
pub fn along_segment([dx, dz]: [f32; 2], instance: &Instance) -> f32 {
    let [end_x, end_z] = instance.segment;
    ((dx * end_x + dz * end_z) * instance.inverse_segment_squared).clamp(0.0, 1.0)
}

#[inline(always)]
fn row_of<F: Formula>(
    amounts: &mut [f32],
    first_x: i32,
    z: i32,
    instance: &Instance,
    falloff: &Falloff,
    is_segment: bool,
) {
    if is_segment {
        for (place, amount) in amounts.iter_mut().enumerate() {
            let [dx, dz] = offset(first_x.wrapping_add(place as i32), z, instance);
            let along = along_segment([dx, dz], instance);
            let [end_x, end_z] = instance.segment;
            let (dx, dz) = (dx - along * end_x, dz - along * end_z);
            let r = (dx * dx + dz * dz).sqrt() * instance.inverse_radius;
            *amount = F::bounded_weight(r, falloff) * instance.amplitude;
        }
        return;
    }
    let [cell_x, cell_z] = instance.cell;
    let [fraction_x, fraction_z] = instance.fraction;
    let dz = z.wrapping_sub(cell_z) as f32 - fraction_z;
    let dz2 = dz * dz;
    let mut cells_x = first_x.wrapping_sub(cell_x);
    for amount in amounts.iter_mut() {
        let dx = cells_x as f32 - fraction_x;
        cells_x = cells_x.wrapping_add(1);
        let r = (dx * dx + dz2).sqrt() * instance.inverse_radius;
        *amount = F::bounded_weight(r, falloff) * instance.amplitude;
    }
}

/// The bitmap's value at a place, bilinear between the middles of pixels: the square about the instance's circle, turned.
#[inline(always)]
#[must_use]
pub fn alpha(bitmap: &Bitmap, instance: &Instance, [dx, dz]: [f32; 2]) -> f32 {
    let [cos, sin] = instance.axis;
    let along = |d: f32, size: u32| (d * instance.inverse_radius * 0.5 + 0.5) * size as f32 - 0.5;
    let x = along((dx * cos + dz * sin) * instance.mirror, bitmap.width());
    let y = along(dz * cos - dx * sin, bitmap.height());
    let (left, top) = (x.floor(), y.floor());
    let (share_x, share_y) = (x - left, y - top);
    let (left, top) = (left as i32, top as i32);
    let upper = lerp(bitmap.pixel(left, top), bitmap.pixel(left.saturating_add(1), top), share_x);
    let below = top.saturating_add(1);
    let lower = lerp(bitmap.pixel(left, below), bitmap.pixel(left.saturating_add(1), below), share_x);
    lerp(upper, lower, share_y)
}

/// Gathers the amounts of an instance into the one weight of a wash stroke: the larger of both, or with a flow under 1 a share
/// of the way to it.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn gather(weights: &mut [f32], amounts: &[f32], flow: f32) {
    if flow < 1.0 {
        for (weight, amount) in weights.iter_mut().zip(amounts) {
            *weight += flow * (*amount - *weight).max(0.0);
        }
    } else {
        for (weight, amount) in weights.iter_mut().zip(amounts) {
            *weight = weight.max(*amount);
        }
    }
}

/// Multiplies amounts by what a gate lets through, 0..1.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn let_through(amounts: &mut [f32], gate: &[f32]) {
    for (amount, gate) in amounts.iter_mut().zip(gate) {
        *amount *= gate;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff;
    use orogeny_field::{Profile, ProfileShape};

    /// Rows are compiled for several instruction sets and the best is taken; one sample at a time, none is.
    #[test]
    fn a_row_has_the_bits_of_its_samples_one_by_one() {
        let shapes = [
            ProfileShape::Linear,
            ProfileShape::Smooth,
            ProfileShape::Sphere,
            ProfileShape::Tip,
            ProfileShape::Gauss,
            ProfileShape::Power { power: 2.7 },
            ProfileShape::Sigmoid { steepness: 3.0 },
            ProfileShape::Curve(
                orogeny_field::Curve::new("a test", vec![[0.0, 0.0], [0.3, 0.8], [1.0, 1.0]]).unwrap(),
            ),
        ];
        let instance = Instance {
            cell: [1_048_000, 70],
            fraction: [0.3, 0.7],
            inverse_radius: 1.0 / 61.3,
            amplitude: -1.7,
            inverse_radius_m: 1.0,
            ..Instance::EVERYWHERE
        };
        for shape in shapes {
            for falloff_ratio in [0.0, 0.3, 1.0] {
                let numbers = Falloff::from(Profile { shape: shape.clone(), falloff_ratio });
                for mode in [WeightMode::Direct, WeightMode::BuildUp, WeightMode::Wash] {
                    let mut found = [f32::NAN; 131];
                    let footprint =
                        Footprint { falloff: numbers.clone(), weight_mode: mode, ..Footprint::EVERYWHERE };
                    row(&mut found, 1_047_935, 83, &instance, &footprint);
                    for (place, found) in found.iter().enumerate() {
                        let dx = (1_047_935 + place as i32 - 1_048_000) as f32 - 0.3;
                        let dz = 13.0 - 0.7;
                        let r = (dx * dx + dz * dz).sqrt() * instance.inverse_radius;
                        let amount = falloff::weight(r, &numbers) * -1.7;
                        let expected =
                            if mode == WeightMode::BuildUp { -exp_minus_one(amount) } else { amount };
                        assert_eq!(found.to_bits(), expected.to_bits(), "{shape:?} {mode:?} at {place}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_bitmap_is_turned_and_mirrored_with_the_instance() {
        // White in its right half, along x.
        let bitmap = Bitmap::new(2, 1, vec![0.0, 1.0]).unwrap();
        let instance = Instance { inverse_radius: 0.1, ..Instance::EVERYWHERE };
        let (east, south, west) = ([5.0, 0.0], [0.0, 5.0], [-5.0, 0.0]);
        assert_eq!((alpha(&bitmap, &instance, east), alpha(&bitmap, &instance, west)), (1.0, 0.0));
        assert_eq!(alpha(&bitmap, &instance, [0.0, 0.0]), 0.5);
        let turned = Instance { axis: [0.0, 1.0], ..instance };
        assert_eq!((alpha(&bitmap, &turned, south), alpha(&bitmap, &turned, east)), (1.0, 0.5));
        let mirrored = Instance { mirror: -1.0, ..instance };
        assert_eq!((alpha(&bitmap, &mirrored, east), alpha(&bitmap, &mirrored, west)), (0.0, 1.0));
    }

    #[test]
    fn a_wash_with_flow_comes_nearer_and_never_goes_beyond() {
        let mut weights = [0.0, 0.5, 0.9];
        gather(&mut weights, &[0.8, 0.8, 0.8], 0.5);
        assert_eq!(weights, [0.4, 0.65, 0.9]);
        gather(&mut weights, &[0.8, 0.8, 0.8], 1.0);
        assert_eq!(weights, [0.8, 0.8, 0.9]);
    }

    #[test]
    fn distance_from_a_segment_is_that_from_its_nearest_place() {
        let instance = Instance {
            cell: [10, 10],
            inverse_radius: 0.25,
            segment: [8.0, 0.0],
            inverse_segment_squared: 1.0 / 64.0,
            ..Instance::EVERYWHERE
        };
        let linear = Falloff::from(Profile { shape: ProfileShape::Linear, falloff_ratio: 1.0 });
        let footprint = Footprint { falloff: linear, is_segment: true, ..Footprint::EVERYWHERE };
        let mut found = [f32::NAN; 17];
        row(&mut found, 6, 11, &instance, &footprint);
        assert_eq!(found[8], 0.75, "beside the middle");
        assert_eq!(found[4], 0.75, "beside the beginning");
        assert_eq!(found[0], 0.0);
        assert!((found[2] - (1.0 - 5.0_f32.sqrt() / 4.0)).abs() < 1.0e-6, "before the beginning");
        assert!((found[14] - found[2]).abs() < 1.0e-6, "beyond the end");
    }
}
