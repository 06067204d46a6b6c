//! A layer's content moved, turned and enlarged, place by place.

use orogeny_field::LayerTransform;

use super::sheet::ulps;
use super::{Plain, Sheet};

/// A place this near to a sample lies on it; and shares of the way between two samples are `f32`.
const PLACE_OFF: f64 = 4.0e-6;

/// What `stored` gives of a level, laid where a transform has it; `constant` lies beyond its edge.
pub fn placed(
    plain: &Plain<'_>,
    transform: &LayerTransform,
    constant: f64,
    stored: impl Fn(u8) -> Sheet,
) -> Sheet {
    let grid = plain.grid();
    let spacing_m = grid.spacing_m();
    let (sin, cos) = transform.rotation_deg.to_radians().sin_cos();
    // Back the way that it came: from where it was moved to, turned back and made smaller about its pivot.
    let back = |[x_m, z_m]: [f64; 2]| {
        let [pivot_x, pivot_z] = transform.pivot_m;
        let (x, z) = (x_m - pivot_x - transform.move_m[0], z_m - pivot_z - transform.move_m[1]);
        let turned = [x * cos + z * sin, z * cos - x * sin];
        [pivot_x + turned[0] / transform.scale, pivot_z + turned[1] / transform.scale]
    };
    let keeps_grid = transform.scale == 1.0 && (transform.rotation_deg % 90.0).abs() < 1.0e-9;
    let on_samples = |x: i32, z: i32| {
        let place = |x: i32, z: i32| {
            back([f64::from(x) * spacing_m, f64::from(z) * spacing_m]).map(|m| m / spacing_m)
        };
        if !keeps_grid {
            return place(x, z);
        }
        // What stays on the grid is moved by whole samples.
        let (first, here) = (place(0, 0), place(x, z));
        [0, 1].map(|axis| first[axis].round() + (here[axis] - first[axis]).round())
    };
    // What is made smaller is taken from the level whose samples come to lie as far apart as the terrain's.
    let top = plain.store.layout().top_level(&plain.store.grid());
    let coarser = ((1.0 / transform.scale).max(1.0).log2().floor() as u8).min(top - plain.level);
    let source = stored(plain.level + coarser);
    let finer = f64::from(1_u32 << coarser);
    let value = |x: i32, z: i32| {
        let [x, z] = on_samples(x, z).map(|place| place / finer);
        transform.height_scale * between(&source, x, z, constant)
    };
    let (width, depth) = (grid.width() as usize, grid.depth() as usize);
    let placed = Sheet::from_fn(width, depth, value);
    let (low, high) =
        source.values.iter().fold((constant, constant), |(low, high), v| (low.min(*v), high.max(*v)));
    let is_exact = keeps_grid && transform.height_scale == 1.0;
    let off = if is_exact {
        0.0
    } else {
        PLACE_OFF * (high - low) + ulps(4.0, source.largest().max(constant.abs()))
    };
    let mut placed = placed.off_by(off * transform.height_scale.abs().max(1.0));
    if is_exact {
        // They are samples.
        placed.values.iter_mut().for_each(|value| *value = f64::from(*value as f32));
    }
    placed
}

/// The Catmull-Rom spline through 4 x 4 samples, held to the lowest and the highest of them.
fn between(source: &Sheet, x: f64, z: f64, constant: f64) -> f64 {
    let on_sample = |place: f64| if (place - place.round()).abs() < 1.0e-6 { place.round() } else { place };
    let (x, z) = (on_sample(x), on_sample(z));
    let at = |x: i32, z: i32| {
        let is_inside = (0..source.width as i32).contains(&x) && (0..source.depth as i32).contains(&z);
        if is_inside { source.at(x, z) } else { constant }
    };
    let (cell_x, cell_z) = (x.floor() as i32, z.floor() as i32);
    if x == x.floor() && z == z.floor() {
        return at(cell_x, cell_z);
    }
    let (weights_x, weights_z) = (catmull_rom(x - x.floor()), catmull_rom(z - z.floor()));
    let (mut sum, mut low, mut high) = (0.0, f64::INFINITY, f64::NEG_INFINITY);
    for (dz, weight_z) in (-1..).zip(weights_z) {
        for (dx, weight_x) in (-1..).zip(weights_x) {
            let sample = at(cell_x + dx, cell_z + dz);
            sum += weight_x * weight_z * sample;
            (low, high) = (low.min(sample), high.max(sample));
        }
    }
    sum.clamp(low, high)
}

fn catmull_rom(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (-t3 + 2.0 * t2 - t),
        0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
        0.5 * (-3.0 * t3 + 4.0 * t2 + t),
        0.5 * (t3 - t2),
    ]
}
