//! What of a terrain lies behind nearer ground.
//!
//! Around the eye, for each of [`NUM_BINS`] directions, the steepest sight line is kept that nearer ground is known to block: a ray across a box goes over ground
//! that is nowhere lower than the box's lowest height. A box all of which lies below these lines cannot be seen.

use glam::DVec3;

use crate::Bounds;

/// Directions around the eye.
const NUM_BINS: usize = 1024;

/// A box as the eye has it.
struct Seen {
    index: usize,
    nearest_m: f64,
    furthest_m: f64,
    /// The first and the last bin that it reaches into, counted on from the first; `None`: the eye is over it.
    span: Option<[usize; 2]>,
    /// The steepest sight line to any of it.
    highest: f64,
    /// The sight line up to which it blocks, at least.
    blocked: f64,
}

/// For each box, whether anything of it may be seen over the others by an eye over one of them; all may by any other. They lie beside one another; the ground in each is between its lowest and its highest height.
#[must_use]
pub fn above_horizon(boxes: &[Bounds], eye_m: DVec3) -> Vec<bool> {
    let mut by_nearest: Vec<Seen> =
        boxes.iter().enumerate().map(|(index, bounds)| Seen::new(index, bounds, eye_m)).collect();
    by_nearest.sort_by(|a, b| a.nearest_m.total_cmp(&b.nearest_m));
    let mut by_furthest: Vec<&Seen> = by_nearest.iter().collect();
    by_furthest.sort_by(|a, b| a.furthest_m.total_cmp(&b.furthest_m));
    let mut nearer = by_furthest.into_iter().peekable();
    let mut horizon = [f64::NEG_INFINITY; NUM_BINS];
    let mut is_above = vec![true; boxes.len()];
    // From under the ground, or from beside it, sight lines may pass below what would block them.
    let is_over_ground = by_nearest.iter().any(|seen| seen.span.is_none() && seen.blocked <= 0.0);
    if !is_over_ground {
        return is_above;
    }
    for seen in &by_nearest {
        // Only what is nearer as a whole is sure to be in front.
        while let Some(blocker) = nearer.next_if(|blocker| blocker.furthest_m <= seen.nearest_m) {
            blocker.raise(&mut horizon);
        }
        if let (Some([first, last]), Some(is_above)) = (seen.span, is_above.get_mut(seen.index)) {
            let hidden = |bin: usize| horizon.get(bin % NUM_BINS).is_some_and(|line| *line > seen.highest);
            *is_above = !(first..=last).all(hidden);
        }
    }
    is_above
}

impl Seen {
    fn new(index: usize, bounds: &Bounds, eye_m: DVec3) -> Self {
        let (min, max) = (bounds.min_m - eye_m, bounds.max_m - eye_m);
        let corners = [[min.x, min.z], [max.x, min.z], [min.x, max.z], [max.x, max.z]];
        let beside = |low: f64, high: f64| if low > 0.0 { low } else { (-high).max(0.0) };
        let nearest_m = beside(min.x, max.x).hypot(beside(min.z, max.z));
        let furthest_m = corners.iter().map(|[x, z]| x.hypot(*z)).fold(0.0, f64::max);
        let over = |height_m: f64, when_above_m: f64, when_below_m: f64| {
            height_m / if height_m > 0.0 { when_above_m } else { when_below_m }
        };
        Self {
            index,
            nearest_m,
            furthest_m,
            span: (nearest_m > 0.0).then(|| span(corners)),
            highest: over(max.y, nearest_m, furthest_m),
            blocked: over(min.y, furthest_m, nearest_m),
        }
    }

    /// Raises the horizon in all bins that lie in the box's span as a whole.
    fn raise(&self, horizon: &mut [f64; NUM_BINS]) {
        let Some([first, last]) = self.span else { return };
        for bin in first + 1..last {
            if let Some(line) = horizon.get_mut(bin % NUM_BINS) {
                *line = line.max(self.blocked);
            }
        }
    }
}

/// The first and the last bin of a box that the eye is not over: less than half of them.
fn span(corners: [[f64; 2]; 4]) -> [usize; 2] {
    let middle = corners.iter().fold([0.0, 0.0], |[x, z], corner| [x + corner[0], z + corner[1]]);
    let towards = middle[1].atan2(middle[0]);
    let turns = corners.map(|[x, z]| {
        // From the middle on, half a turn at most.
        let turn = z.atan2(x) - towards;
        turn - std::f64::consts::TAU * (turn / std::f64::consts::TAU).round()
    });
    let (low, high) =
        turns.iter().fold((0.0_f64, 0.0_f64), |(low, high), turn| (low.min(*turn), high.max(*turn)));
    let bins_a_turn = NUM_BINS as f64 / std::f64::consts::TAU;
    // Two turns on, so that no bin is below 0.
    let bin = |turn: f64| ((towards + turn) * bins_a_turn + 2.0 * NUM_BINS as f64).floor().max(0.0) as usize;
    [bin(low), bin(high)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_field::hash;
    use proptest::prelude::*;

    const SIDE: u32 = 12;
    const TILE_M: f64 = 100.0;

    /// Squares whose ground is somewhere between two heights.
    fn boxes(seed: u32) -> Vec<Bounds> {
        let of = |x: u32, z: u32| {
            let low_m = 300.0 * f64::from(hash::uniform(x, z, seed)).powi(3);
            let high_m = low_m + 60.0 * f64::from(hash::uniform(x, z, seed + 1));
            let corner = |x: u32, z: u32, height_m: f64| {
                DVec3::new(f64::from(x) * TILE_M, height_m, f64::from(z) * TILE_M)
            };
            Bounds { min_m: corner(x, z, low_m), max_m: corner(x + 1, z + 1, high_m) }
        };
        (0..SIDE).flat_map(|z| (0..SIDE).map(move |x| of(x, z))).collect()
    }

    proptest! {
        #[test]
        fn nothing_that_is_seen_over_the_lowest_ground_is_left_out(
            seed in 0_u32..1000, eye in (-300.0..1500.0_f64, 0.0..500.0_f64, -300.0..1500.0_f64), within in (0.0..1.0_f64, 0.0..1.0_f64),
        ) {
            let (boxes, eye) = (boxes(seed), DVec3::new(eye.0, eye.1, eye.2));
            for (bounds, is_above) in boxes.iter().zip(above_horizon(&boxes, eye)) {
                if is_above { continue; }
                let size = bounds.max_m - bounds.min_m;
                let top = DVec3::new(bounds.min_m.x + size.x * within.0, bounds.max_m.y, bounds.min_m.z + size.z * within.1);
                // Somewhere on the way to it the ray is below the lowest that the ground there may be.
                let is_blocked = (1..4000).any(|step| {
                    let place = eye + (top - eye) * (f64::from(step) / 4000.0);
                    boxes.iter().any(|other| {
                        other != bounds && place.x >= other.min_m.x && place.x <= other.max_m.x
                            && place.z >= other.min_m.z && place.z <= other.max_m.z && place.y < other.min_m.y
                    })
                });
                prop_assert!(is_blocked, "{top} from {eye}");
            }
        }
    }

    #[test]
    fn much_is_hidden_behind_a_wall_and_nothing_from_above() {
        let mut boxes = boxes(7);
        let row = SIDE as usize;
        for bounds in boxes.iter_mut().skip(2 * row).take(row) {
            (bounds.min_m.y, bounds.max_m.y) = (1000.0, 1010.0);
        }
        let num_seen =
            |eye: DVec3| above_horizon(&boxes, eye).into_iter().filter(|is_above| *is_above).count();
        let near = num_seen(DVec3::new(600.0, 400.0, 50.0));
        assert!(near < 60, "{near}");
        assert_eq!(num_seen(DVec3::new(600.0, 9000.0, 600.0)), boxes.len());
        assert_eq!(num_seen(DVec3::new(600.0, -500.0, 600.0)), boxes.len());
    }
}
