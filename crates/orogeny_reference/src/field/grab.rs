//! Ground moved as a whole: along with a brush from where it was to where it is, in steps so short that nothing folds over. Each
//! sample finds its way back to where it came from (a forward warp, as of Gain & Marais 2005).

use orogeny_field::GrabKernel;

use super::between::Ground;

/// One row from sample `(x, z)` on.
pub fn row(target: &mut [f32], x: i32, z: i32, ground: &Ground<'_>, kernel: &GrabKernel) {
    for (target, x) in target.iter_mut().zip(x..) {
        let [moved_x, moved_z] = moved(x, z, kernel);
        let (cell_x, cell_z) = ((-moved_x).floor(), (-moved_z).floor());
        let cell = [x.wrapping_add(cell_x as i32), z.wrapping_add(cell_z as i32)];
        *target = ground.between(cell, [-moved_x - cell_x, -moved_z - cell_z]);
    }
}

/// How far the ground that ends at a sample was moved, in samples: step by step from the last one back, by each drag's way
/// times its weight where the ground then was.
#[inline(always)]
#[must_use]
pub fn moved(x: i32, z: i32, kernel: &GrabKernel) -> [f32; 2] {
    let mut moved = [0.0_f32; 2];
    for step in (1..=kernel.num_steps).rev() {
        let [moved_x, moved_z] = moved;
        let gone = step as f32 * kernel.inverse_num_steps;
        for drag in &kernel.drags {
            let ([cell_x, cell_z], [fraction_x, fraction_z]) = (drag.cell, drag.fraction);
            let [way_x, way_z] = drag.way;
            let dx = x.wrapping_sub(cell_x) as f32 - fraction_x - moved_x - gone * way_x;
            let dz = z.wrapping_sub(cell_z) as f32 - fraction_z - moved_z - gone * way_z;
            let r = (dx * dx + dz * dz).sqrt() * drag.inverse_radius;
            let weight = if r < 1.0 { kernel.weight(r) } else { 0.0 };
            let [sum_x, sum_z] = &mut moved;
            *sum_x += weight * (way_x * kernel.inverse_num_steps);
            *sum_z += weight * (way_z * kernel.inverse_num_steps);
        }
    }
    moved
}
