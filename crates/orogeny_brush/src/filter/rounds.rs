//! Rounds of droplets on several threads.
//!
//! The droplets of a round all run over the same ground, and what they change is summed in whole units, whose order does not matter. So
//! each thread sums what its share of them changes, and the bits are those of [`droplets::run_while`], which is one thread's.

use orogeny_field::{DropletKernel, Plane, SampleRect};
use orogeny_reference::field::droplets;
use rayon::prelude::*;

/// Sums of changes take at most so much memory beside the first, which is always there.
const MAX_SUMS_IN_BYTES: u64 = 1 << 29;

/// Runs `num_droplets` over a plane in rounds, from the first on, with a look before each at whether to go on, given the share of the
/// droplets that have run; whether all of them have.
pub(super) fn run_while(
    heights: &mut Plane,
    kernel: &DropletKernel,
    num_droplets: u32,
    threads: &rayon::ThreadPool,
    mut goes_on: impl FnMut(f64) -> bool,
) -> bool {
    let bounds = heights.rect();
    let num_sums = num_sums(threads.current_num_threads(), bounds.area());
    let mut sums: Vec<_> = (0..num_sums).map(|_| vec![0_i32; heights.samples().len()]).collect();
    let per_round = DropletKernel::droplets_per_round(bounds.area());
    let (mut left, mut round) = (num_droplets, 0_u32);
    while left > 0 {
        if !goes_on(1.0 - f64::from(left) / f64::from(num_droplets)) {
            return false;
        }
        let count = left.min(per_round);
        let share = count.div_ceil(num_sums as u32);
        threads.install(|| {
            let firsts: Vec<_> = (0..count).step_by(share as usize).collect();
            let ground = &*heights;
            firsts.into_par_iter().zip(&mut sums).for_each(|(first, sums)| {
                trace(first..count.min(first + share), round, ground, &bounds, kernel, sums);
            });
            settle(heights, &mut sums);
        });
        (left, round) = (left - count, round.wrapping_add(1));
    }
    true
}

/// One for each thread, as far as there may be memory for them.
fn num_sums(num_threads: usize, num_samples: u64) -> usize {
    let fitting = MAX_SUMS_IN_BYTES / (num_samples.max(1) * 4);
    num_threads.clamp(1, 1 + usize::try_from(fitting).unwrap_or(usize::MAX - 1))
}

/// Adds what some droplets of a round change.
fn trace(
    droplets: std::ops::Range<u32>,
    round: u32,
    heights: &Plane,
    bounds: &SampleRect,
    kernel: &DropletKernel,
    sums: &mut [i32],
) {
    let width = bounds.width() as usize;
    for index in droplets {
        droplets::trace(index, round, heights, bounds, kernel, |x, z, units| {
            let place = z.wrapping_sub(bounds.z0) as usize * width + x.wrapping_sub(bounds.x0) as usize;
            droplets::add(sums.get_mut(place..).unwrap_or_default(), units);
        });
    }
}

/// Applies all sums to the heights; what the heights are too coarse for is left in the first.
fn settle(heights: &mut Plane, sums: &mut [Vec<i32>]) {
    let Some((first, others)) = sums.split_first_mut() else { return };
    let width = (heights.rect().width() as usize).max(1);
    let mut rows: Vec<_> = first.chunks_mut(width).map(|row| (row, Vec::new())).collect();
    for sums in others {
        for ((_, others), row) in rows.iter_mut().zip(sums.chunks_mut(width)) {
            others.push(row);
        }
    }
    let rows = heights.samples_mut().par_chunks_mut(width).zip(rows).with_min_len(16);
    rows.for_each(|(heights, (first, others))| {
        for other in others {
            for (sum, more) in first.iter_mut().zip(other) {
                *sum += std::mem::take(more);
            }
        }
        droplets::settle_row(heights, first);
    });
}

#[cfg(test)]
mod tests {
    use orogeny_field::{Droplets, hash};

    use super::*;

    #[test]
    fn on_any_number_of_threads_the_bits_are_those_of_one() {
        let rect = SampleRect::new(-7, 3, 293, 243);
        let mut ground = Plane::constant(rect, 0.0);
        for (place, height) in (0_u32..).zip(ground.samples_mut()) {
            *height = 40.0 * hash::uniform(place % 300, place / 300, 1) + (place % 300) as f32 * 0.5;
        }
        let kernel = DropletKernel::new("erode", &Droplets::default(), 4.0).unwrap();
        let per_round = DropletKernel::droplets_per_round(rect.area());
        for num_droplets in [1, 16, 17, per_round, 3 * per_round + 5] {
            let mut expected = ground.clone();
            droplets::run(&mut expected, &kernel, num_droplets, 0);
            assert_ne!(expected, ground);
            for num_threads in [1, 2, 3, 7] {
                let threads = rayon::ThreadPoolBuilder::new().num_threads(num_threads).build().unwrap();
                let mut found = ground.clone();
                assert!(run_while(&mut found, &kernel, num_droplets, &threads, |_| true));
                assert!(found == expected, "{num_droplets} droplets on {num_threads} threads");
            }
        }
    }

    #[test]
    fn sums_are_as_many_as_memory_allows_and_one_at_least() {
        assert_eq!(num_sums(8, 1 << 20), 8);
        assert_eq!(num_sums(8, 1 << 26), 3);
        assert_eq!(num_sums(8, 1 << 40), 1);
        assert_eq!(num_sums(0, 0), 1);
    }

    #[test]
    fn who_says_no_is_heard_before_the_next_round() {
        let mut heights = Plane::constant(SampleRect::new(0, 0, 64, 64), 5.0);
        let kernel = DropletKernel::new("erode", &Droplets::default(), 1.0).unwrap();
        let threads = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let mut num_looks = 0;
        let ended = run_while(&mut heights, &kernel, 100, &threads, |_| {
            num_looks += 1;
            num_looks < 3
        });
        assert!(!ended && num_looks == 3);
    }
}
