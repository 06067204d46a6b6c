//! From the distance to an instance's centre to the amount `A` with which a brush acts on a sample.

use multiversion::multiversion;
use orogeny_field::{Falloff, FalloffFormula, Instance, WeightMode};

use crate::falloff::{Formula, Gauss, HardEdge, Linear, Power, Sigmoid, Smooth, Sphere, Tip};
use crate::transcendental::exp_minus_one;

/// Writes the amounts of one instance for the samples `first_x ..` of row `z`, in sample coordinates of the terrain.
///
/// In [`WeightMode::Wash`] an amount is the instance's `a w`, to be gathered by [`keep_largest`].
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(
    amounts: &mut [f32],
    first_x: i32,
    z: i32,
    instance: &Instance,
    falloff: &Falloff,
    mode: WeightMode,
) {
    match falloff.formula {
        FalloffFormula::HardEdge => row_of::<HardEdge>(amounts, first_x, z, instance, falloff, mode),
        FalloffFormula::Linear => row_of::<Linear>(amounts, first_x, z, instance, falloff, mode),
        FalloffFormula::Smooth => row_of::<Smooth>(amounts, first_x, z, instance, falloff, mode),
        FalloffFormula::Sphere => row_of::<Sphere>(amounts, first_x, z, instance, falloff, mode),
        FalloffFormula::Tip => row_of::<Tip>(amounts, first_x, z, instance, falloff, mode),
        FalloffFormula::Gauss => row_of::<Gauss>(amounts, first_x, z, instance, falloff, mode),
        FalloffFormula::Power => row_of::<Power>(amounts, first_x, z, instance, falloff, mode),
        FalloffFormula::Sigmoid => row_of::<Sigmoid>(amounts, first_x, z, instance, falloff, mode),
    }
}

#[inline(always)]
fn row_of<F: Formula>(
    amounts: &mut [f32],
    first_x: i32,
    z: i32,
    instance: &Instance,
    falloff: &Falloff,
    mode: WeightMode,
) {
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
    if mode == WeightMode::BuildUp {
        // Exactly 0 where the weight is 0, since `exp_minus_one(0)` is.
        for amount in amounts {
            *amount = -exp_minus_one(*amount);
        }
    }
}

/// Keeps the larger of each weight and amount: the one weight of a wash stroke.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn keep_largest(weights: &mut [f32], amounts: &[f32]) {
    for (weight, amount) in weights.iter_mut().zip(amounts) {
        *weight = weight.max(*amount);
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
        ];
        let instance = Instance {
            cell: [1_048_000, 70],
            fraction: [0.3, 0.7],
            inverse_radius: 1.0 / 61.3,
            amplitude: -1.7,
            reference_height_m: 0.0,
            inverse_radius_m: 1.0,
        };
        for shape in shapes {
            for falloff_ratio in [0.0, 0.3, 1.0] {
                let numbers = Falloff::from(Profile { shape, falloff_ratio });
                for mode in [WeightMode::Direct, WeightMode::BuildUp, WeightMode::Wash] {
                    let mut found = [f32::NAN; 131];
                    row(&mut found, 1_047_935, 83, &instance, &numbers, mode);
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
}
