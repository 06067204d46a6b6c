//! Droplets: whole numbers of rock, in any order, each within its reach.

use orogeny_field::{DROPLET_BUDGET, DropletKernel, Droplets, Plane, SampleRect};
use orogeny_reference::field::droplets;

use crate::support::{bits, highest, hilly, lowest, part, plane, rough, spiky, total};

fn droplet_kernel(droplets: &Droplets, spacing_m: f64) -> DropletKernel {
    DropletKernel::new("erode", droplets, spacing_m).unwrap()
}

/// The sums of droplets, traced in an order.
fn round_of(
    heights: &Plane,
    bounds: &SampleRect,
    kernel: &DropletKernel,
    indices: impl Iterator<Item = u32>,
) -> Vec<i32> {
    let mut sums = vec![0; bounds.area() as usize];
    for index in indices {
        droplets::trace(index, 3, heights, bounds, kernel, |x, z, units| {
            let end = x + units.len() as i32;
            assert!(bounds.contains(&SampleRect::new(x, z, end, z + 1)), "{x}..{end}, {z}");
            let place = (z - bounds.z0) as usize * bounds.width() as usize + (x - bounds.x0) as usize;
            droplets::add(&mut sums[place..], units);
        });
    }
    sums
}

#[test]
fn a_droplet_neither_wins_nor_loses_rock() {
    let rect = SampleRect::new(-20, 30, 77, 101);
    for radius in 1..=8 {
        let kernel = droplet_kernel(&Droplets { radius, ..Droplets::default() }, 10.0);
        let weights: f32 = kernel.disc.iter().flat_map(|part| part.weights).sum();
        assert!((weights - 1.0).abs() < 1.0e-5, "{weights}");
        for ground in [hilly(rect, 5, 100.0), rough(rect, 6, 30.0), spiky(rect, 2)] {
            let mut num_that_moved = 0;
            for index in 0..200 {
                let sums = round_of(&ground, &rect, &kernel, index..index + 1);
                assert_eq!(sums.iter().sum::<i32>(), 0);
                num_that_moved += u32::from(sums.iter().any(|sum| *sum != 0));
            }
            assert!(num_that_moved > 100, "{num_that_moved}");
        }
    }
}

#[test]
fn the_order_of_droplets_does_not_matter() {
    let rect = SampleRect::new(-20, 30, 77, 101);
    let kernel = droplet_kernel(&Droplets::default(), 10.0);
    let ground = hilly(rect, 5, 100.0);
    let forwards = round_of(&ground, &rect, &kernel, 0..4096);
    assert_eq!(round_of(&ground, &rect, &kernel, (0..4096).rev()), forwards);
    let shuffled = (0..4096).map(|index| (index * 2731 + 17) % 4096);
    assert_eq!(round_of(&ground, &rect, &kernel, shuffled), forwards);
}

/// A full round of the greediest droplets, all in one small place, as high as ground can be.
#[test]
fn sums_of_a_round_do_not_wrap() {
    let rect = SampleRect::new(0, 0, 6, 5);
    let greedy = Droplets { capacity: 64.0, erosion: 1.0, radius: 1, max_steps: 1024, ..Droplets::default() };
    let kernel = droplet_kernel(&greedy, 1000.0);
    let cliff = plane(rect, |x, z| 1.0e7 - 1.0e6 * (x + z) as f32);
    let mut largest = 0;
    for index in 0..4096 {
        let sums = round_of(&cliff, &rect, &kernel, index..index + 1);
        largest = largest.max(sums.iter().map(|sum| sum.abs()).max().unwrap());
    }
    assert!(largest > DROPLET_BUDGET / 4, "{largest}");
    // Half a metre, in 2^-16 m, is what a height of 1e7 m may have left from the round before.
    assert!(i64::from(largest) * 4096 + 32_768 < i64::from(i32::MAX), "{largest}");
    round_of(&cliff, &rect, &kernel, 0..4096);
}

/// Heights above 128 m are multiples of 2^-16 m: nothing at all may be lost, whatever it is added to.
#[test]
fn changes_too_small_for_a_height_are_kept_for_later() {
    let mut heights: Vec<f32> = (0..100).map(|index| 130.0 + 97.0 * (index * index) as f32).collect();
    let before: f64 = heights.iter().map(|height| f64::from(*height)).sum();
    let mut changes = vec![0; 100];
    let mut given = 0;
    for round in 0..1000 {
        for (index, change) in (0_i32..).zip(&mut changes) {
            let units = (index * 31 + round * 17) % 7 - 2;
            *change += units;
            given += i64::from(units);
        }
        droplets::settle_row(&mut heights, &mut changes);
    }
    let after: f64 = heights.iter().map(|height| f64::from(*height)).sum();
    let left: i64 = changes.iter().map(|change| i64::from(*change)).sum();
    assert_eq!((after - before) * 65_536.0, (given - left) as f64);
    assert!(given > 50_000);
    // Of the highest, at 950,000 m, an ulp is 4,096 units.
    assert!(changes.iter().all(|change| change.abs() <= 2048), "{changes:?}");
}

#[test]
fn droplets_carry_rock_downhill_and_keep_it() {
    let rect = SampleRect::new(0, 0, 128, 128);
    let kernel = droplet_kernel(&Droplets::default(), 10.0);
    let ground = hilly(rect, 5, 100.0);
    let mut heights = ground.clone();
    droplets::run(&mut heights, &kernel, 16_384, 0);
    let off = (total(&heights) - total(&ground))
        / f64::from(highest(&ground) - lowest(&ground))
        / rect.area() as f64;
    assert!(off.abs() < 1.0e-7, "{off:e} of the relief");
    let energy = |plane: &Plane| plane.samples().iter().map(|height| f64::from(*height).powi(2)).sum::<f64>();
    assert!(energy(&heights) < energy(&ground));
    let change = heights.samples().iter().zip(ground.samples()).map(|(new, old)| (new - old).abs());
    let largest = change.fold(0.0, f32::max);
    assert!(largest > 0.5 && largest < 50.0, "{largest} m");
    // Later rounds are others.
    let mut later = ground.clone();
    droplets::run(&mut later, &kernel, 16_384, 1000);
    assert_ne!(bits(&later), bits(&heights));
    // On a plain there is no way to go.
    let plain = Plane::constant(rect, 300.0);
    let mut same = plain.clone();
    droplets::run(&mut same, &kernel, 1000, 0);
    assert_eq!(bits(&same), bits(&plain));
}

#[test]
fn a_droplet_sees_no_further_than_its_reach() {
    let bounds = SampleRect::new(-50, 10, 250, 230);
    let ground = hilly(bounds, 5, 100.0);
    let kernel = droplet_kernel(&Droplets { max_steps: 20, ..Droplets::default() }, 10.0);
    let reach = kernel.reach() as i32;
    let mut num_within = 0;
    for index in 0..500 {
        let [x, z] = droplets::start(index, 3, &bounds, &kernel);
        assert!(bounds.contains(&SampleRect::new(x, z, x + 2, z + 2)));
        let window = SampleRect::new(x, z, x + 1, z + 1).grown(reach).intersection(&bounds);
        let mut seen = Vec::new();
        droplets::trace(index, 3, &ground, &bounds, &kernel, |x, z, units| {
            seen.push((x, z, units.to_vec()));
            for (x, units) in (x..).zip(units) {
                assert!(*units == 0 || window.contains(&SampleRect::new(x, z, x + 1, z + 1)));
            }
        });
        let mut seen_in_window = Vec::new();
        droplets::trace(index, 3, &part(&ground, window), &bounds, &kernel, |x, z, units| {
            seen_in_window.push((x, z, units.to_vec()));
        });
        assert_eq!(seen_in_window, seen, "droplet {index}");
        num_within += u32::from(bounds.grown(-reach).contains(&window));
    }
    assert!(num_within > 50, "{num_within}");
}
