//! Where a ray meets the ground: down the hierarchy of lowest and highest heights, then cell by cell, on the bilinear patch between
//! four samples.

use glam::DVec3;
use orogeny_field::{HeightBounds, TerrainGrid};

use crate::{Bounds, Tile};

/// What is asked of a terrain to pick on it. `Tile`s and samples lie on the terrain.
pub trait Ground {
    /// The lowest and highest height of a tile, or less and more: of all its samples, the last ones included, which are the first of the
    /// next tile's.
    fn bounds(&self, tile: Tile) -> HeightBounds;

    /// A sample's height, metres.
    fn height_m(&self, sample: [u32; 2]) -> f32;
}

/// A half line; one whose numbers are not finite, or that goes nowhere, meets nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it begins, metres.
    pub origin_m: DVec3,
    /// Where it goes; of length 1.
    pub direction: DVec3,
}

/// The first point of the ground on a ray, metres from its origin on; from above or from below. `None` where there is none.
#[must_use]
pub fn pick(ray: &Ray, grid: &TerrainGrid, ground: &impl Ground) -> Option<f64> {
    if !ray.origin_m.is_finite() || !ray.direction.is_finite() || ray.direction == DVec3::ZERO {
        return None;
    }
    let mut before = None;
    // Nearest last, so that it is taken first.
    let mut open: Vec<_> = entry(ray, Tile::root(grid), grid, ground).into_iter().collect();
    while let Some(Candidate { tile, range }) = open.pop() {
        if tile.level == 0 {
            // Tiles have no common inside: the first that is met is the nearest.
            if let Some(distance_m) = pick_in_tile(ray, tile, range, &mut before, grid, ground) {
                return Some(distance_m);
            }
            continue;
        }
        let first = open.len();
        open.extend(tile.children().filter_map(|child| entry(ray, child, grid, ground)));
        if let Some(children) = open.get_mut(first..) {
            children.sort_by(|a, b| b.range[0].total_cmp(&a.range[0]));
        }
    }
    None
}

struct Candidate {
    tile: Tile,
    /// From where to where the ray is in its box, metres.
    range: [f64; 2],
}

fn entry(ray: &Ray, tile: Tile, grid: &TerrainGrid, ground: &impl Ground) -> Option<Candidate> {
    let bounds = Bounds::of_samples(tile.samples(grid)?, ground.bounds(tile), grid.spacing_m());
    let range = range_in(ray, &bounds)?;
    Some(Candidate { tile, range })
}

/// From where to where a ray is within a box.
fn range_in(ray: &Ray, bounds: &Bounds) -> Option<[f64; 2]> {
    let mut range = [0.0_f64, f64::INFINITY];
    for axis in 0..3 {
        let (origin, direction) = (ray.origin_m[axis], ray.direction[axis]);
        // A box is larger by as much as the numbers are exact; a flat one has some height.
        let largest = origin.abs() + bounds.min_m[axis].abs().max(bounds.max_m[axis].abs());
        let slack = 1.0e-9 + 8.0 * f64::EPSILON * largest;
        let (min, max) = (bounds.min_m[axis] - slack, bounds.max_m[axis] + slack);
        if direction == 0.0 {
            if origin < min || origin > max {
                return None;
            }
            continue;
        }
        let (a, b) = ((min - origin) / direction, (max - origin) / direction);
        range = [range[0].max(a.min(b)), range[1].min(a.max(b))];
    }
    (range[0] <= range[1]).then_some(range)
}

/// The first point of a tile's ground on a ray, which is in its box over a range.
fn pick_in_tile(
    ray: &Ray,
    tile: Tile,
    range: [f64; 2],
    before: &mut Option<End>,
    grid: &TerrainGrid,
    ground: &impl Ground,
) -> Option<f64> {
    let [first, last] = tile.samples(grid)?;
    let spacing_m = grid.spacing_m();
    // In samples, from the tile's first one: exact far from the origin.
    let origin = DVec3::new(
        ray.origin_m.x / spacing_m - f64::from(first[0]),
        ray.origin_m.y,
        ray.origin_m.z / spacing_m - f64::from(first[1]),
    );
    let direction = DVec3::new(ray.direction.x / spacing_m, ray.direction.y, ray.direction.z / spacing_m);
    let num_cells = [last[0] - first[0], last[1] - first[1]];
    let places = [(origin.x, direction.x, num_cells[0]), (origin.z, direction.z, num_cells[1])];
    // From line to line of samples, across which the ray goes in the order of its distance.
    let mut crossings = vec![range[0], range[1]];
    for (origin, direction, num_cells) in places {
        if direction != 0.0 {
            let at = (0..=num_cells).map(|line| (f64::from(line) - origin) / direction);
            crossings.extend(at.filter(|at| *at > range[0] && *at < range[1]));
        }
    }
    crossings.sort_by(f64::total_cmp);
    crossings.windows(2).find_map(|ends| {
        let [from, to] = ends else { return None };
        let middle = origin + direction * ((from + to) / 2.0);
        // A terrain of one row or column has one line of samples and no cell, but is seen where the ray meets that.
        let cell = [(middle.x, num_cells[0]), (middle.z, num_cells[1])]
            .map(|(place, num)| (place.floor().max(0.0) as u32).min(num.saturating_sub(1)));
        let height = |dx: u32, dz: u32| {
            let sample =
                [first[0] + (cell[0] + dx).min(num_cells[0]), first[1] + (cell[1] + dz).min(num_cells[1])];
            f64::from(ground.height_m(sample))
        };
        let corners = [height(0, 0), height(1, 0), height(0, 1), height(1, 1)];
        let local = DVec3::new(origin.x - f64::from(cell[0]), origin.y, origin.z - f64::from(cell[1]));
        let patch = Patch::under(local, direction, corners, *from);
        let (first, last) = (patch.above(0.0), patch.above(to - from));
        // Between two patches, each of which has the line between them just beyond its end.
        let slipped = before.take().is_some_and(|end| {
            (end.distance_m - from).abs() <= 1.0e-6 * (1.0 + from) && (end.above_m < 0.0) != (first < 0.0)
        });
        *before = Some(End { distance_m: *to, above_m: last });
        if slipped { Some(*from) } else { patch.first_root(to - from).map(|root| from + root) }
    })
}

/// How far the ground is above a ray where it left a cell.
struct End {
    distance_m: f64,
    above_m: f64,
}

/// How far the ground `a + (b − a) x + (c − a) z + (a − b − c + d) x z` is above a ray, as a polynomial of the way along it.
struct Patch {
    squared: f64,
    linear: f64,
    constant: f64,
}

impl Patch {
    /// From a point of the ray on, so that its numbers are small.
    fn under(origin: DVec3, direction: DVec3, [a, b, c, d]: [f64; 4], from: f64) -> Self {
        let (along_x, along_z, twist) = (b - a, c - a, (a - b) + (d - c));
        let start = origin + direction * from;
        Self {
            squared: twist * direction.x * direction.z,
            linear: along_x * direction.x
                + along_z * direction.z
                + twist * (start.x * direction.z + start.z * direction.x)
                - direction.y,
            constant: a + along_x * start.x + along_z * start.z + twist * start.x * start.z - start.y,
        }
    }

    fn above(&self, way: f64) -> f64 {
        (self.squared * way + self.linear) * way + self.constant
    }

    /// Where it is first 0, from 0 to a length.
    fn first_root(&self, length: f64) -> Option<f64> {
        let Self { squared, linear, constant } = *self;
        let discriminant = linear * linear - 4.0 * squared * constant;
        let roots = if squared == 0.0 {
            let root = if constant == 0.0 { 0.0 } else { -constant / linear };
            [root, f64::NAN]
        } else if discriminant >= 0.0 {
            // Without the difference of two near numbers.
            let sum = -0.5 * (linear + discriminant.sqrt().copysign(linear));
            [sum / squared, if sum == 0.0 { f64::NAN } else { constant / sum }]
        } else {
            [f64::NAN; 2]
        };
        let slack = 1.0e-9 * (1.0 + length);
        let within = roots.into_iter().filter(|root| *root >= -slack && *root <= length + slack);
        within.min_by(f64::total_cmp).map(|root| root.clamp(0.0, length))
    }
}
