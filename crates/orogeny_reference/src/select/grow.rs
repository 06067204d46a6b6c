//! Growing and shrinking by a disc, exactly.
//!
//! Samples that are wholly selected take the time of a distance transform, however large the disc is. It is that of two passes
//! (Felzenszwalb & Huttenlocher 2012), of which the second only asks whether the distance is at most the radius: a sample with
//! the next selected one of its column `d` rows away covers `√(r² − d²)` samples of its row to both sides, so that running
//! maxima take the place of a lower envelope of parabolas. Samples that are partly selected are few, mostly: the disc is taken
//! chord by chord, each the larger of two running maxima over powers of two (Urbach & Wilkinson 2008).

use multiversion::multiversion;
use orogeny_field::{Plane, SampleRect};

use super::ON_A_SAMPLE;

/// Columns that are worked at once where the selection is soft: rows of so many stay in the second-level cache.
const STRIP: i32 = 256;

/// How many samples away a value still counts.
#[must_use]
pub fn reach(radius: f64) -> u32 {
    (radius + ON_A_SAMPLE) as u32
}

/// The largest value within `radius` samples, 0 and more, of each sample. The plane holds values 0..1 and no NaN; what comes of it
/// is smaller by [`reach`] on each side.
#[must_use]
pub fn grown(plane: &Plane, radius: f64) -> Plane {
    spread(plane, radius, Range { least: 0.0, most: 1.0 })
}

/// The smallest value within `radius` samples, as [`grown`].
#[must_use]
pub fn shrunk(mut plane: Plane, radius: f64) -> Plane {
    // What is negated comes back with the same bits.
    negate(&mut plane);
    let mut spread = spread(&plane, radius, Range { least: -1.0, most: 0.0 });
    negate(&mut spread);
    spread
}

fn negate(plane: &mut Plane) {
    // Of both zeros it makes +0.
    plane.samples_mut().iter_mut().for_each(|value| *value = 0.0 - *value);
}

/// What the values of a plane are within.
#[derive(Clone, Copy)]
struct Range {
    least: f32,
    most: f32,
}

/// A disc of samples: for each number of rows from its middle, how many samples it has to either side there.
struct Disc {
    chords: Vec<i32>,
}

impl Disc {
    fn new(radius: f64) -> Self {
        let radius = radius + ON_A_SAMPLE;
        let chord = |away: u32| (radius * radius - f64::from(away).powi(2)).max(0.0).sqrt() as i32;
        Self { chords: (0..=radius as u32).map(chord).collect() }
    }

    fn reach(&self) -> i32 {
        self.chords.len() as i32 - 1
    }

    /// The chord so many rows away; negative where there is none.
    #[inline(always)]
    fn chord(&self, away: u32) -> i32 {
        self.chords.get(away as usize).copied().unwrap_or(NO_CHORD)
    }
}

/// Long enough to cover nothing, and short enough to be added to.
const NO_CHORD: i32 = i32::MIN / 2;

fn spread(plane: &Plane, radius: f64, range: Range) -> Plane {
    let disc = Disc::new(radius);
    let mut target = Plane::constant(plane.rect().grown(-disc.reach()), range.least);
    if !target.rect().is_empty() {
        spread_whole(&mut target, plane, &disc, range);
        spread_rest(&mut target, plane, &disc, range);
    }
    target
}

/// Spreads samples that have all of it.
fn spread_whole(target: &mut Plane, plane: &Plane, disc: &Disc, range: Range) {
    let (rect, rows) = (plane.rect(), target.rect().z0..target.rect().z1);
    let width = rect.width() as usize;
    let nowhere = disc.chords.len() as u16;
    let mut away = vec![nowhere; width];
    let mut from_north = vec![nowhere; width * target.rect().depth() as usize];
    let mut of_rows = from_north.chunks_exact_mut(width);
    for z in rect.z0..rows.end {
        step(&mut away, plane.row(z).unwrap_or_default(), range.most, nowhere);
        if z >= rows.start
            && let Some(row) = of_rows.next()
        {
            row.copy_from_slice(&away);
        }
    }
    away.fill(nowhere);
    let mut of_rows = from_north.chunks_exact_mut(width).rev();
    for z in (rows.start..rect.z1).rev() {
        step(&mut away, plane.row(z).unwrap_or_default(), range.most, nowhere);
        if z < rows.end
            && let (Some(nearest), Some(row)) = (of_rows.next(), target.row_mut(z))
        {
            for (nearest, south) in nearest.iter_mut().zip(&away) {
                *nearest = (*nearest).min(*south);
            }
            if nearest.iter().any(|away| *away < nowhere) {
                cover(row, nearest, disc, range.most);
            }
        }
    }
}

/// Goes on by a row: how many rows away the last whole sample of each column is, or `nowhere`.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn step(away: &mut [u16], row: &[f32], most: f32, nowhere: u16) {
    for (away, value) in away.iter_mut().zip(row) {
        let next = (*away + 1).min(nowhere);
        *away = if *value >= most { 0 } else { next };
    }
}

/// Covers what the chords about each sample of a row reach; the row's first sample is the one `reach` after that of `nearest`.
fn cover(row: &mut [f32], nearest: &[u16], disc: &Disc, most: f32) {
    let reach = disc.chords.len() - 1;
    let chord = |away: &u16| disc.chord((*away).into());
    let (before, here) = nearest.split_at_checked(reach).unwrap_or_default();
    let (here, after) = here.split_at_checked(row.len()).unwrap_or_default();
    let mut east = (-disc.reach()..).zip(before).map(|(x, away)| x + chord(away)).max().unwrap_or(NO_CHORD);
    for ((x, away), value) in (0..).zip(here).zip(row.iter_mut()) {
        east = east.max(x + chord(away));
        if east >= x {
            *value = most;
        }
    }
    let end = row.len() as i32;
    let mut west = (end..).zip(after).map(|(x, away)| x - chord(away)).min().unwrap_or(-NO_CHORD);
    for (x, (away, value)) in here.iter().zip(row).enumerate().rev() {
        let x = x as i32;
        west = west.min(x - chord(away));
        if west <= x {
            *value = most;
        }
    }
}

/// Spreads all other samples.
fn spread_rest(target: &mut Plane, plane: &Plane, disc: &Disc, range: Range) {
    let (rect, SampleRect { x0, z0, x1, z1 }) = (plane.rect(), target.rect());
    let reach = disc.reach();
    let mut maxima = Maxima::new(disc);
    for first in (x0..x1).step_by(STRIP as usize) {
        let end = x1.min(first + STRIP);
        let columns = first.abs_diff(x0) as usize..end.abs_diff(x0) as usize;
        let around = columns.start..columns.end + 2 * reach as usize;
        for z in rect.z0..rect.z1 {
            let row = plane.row(z).and_then(|row| row.get(around.clone())).unwrap_or_default();
            if !maxima.begin(row, range) {
                continue;
            }
            for target_z in (z - reach).max(z0)..=(z + reach).min(z1 - 1) {
                let row = target.row_mut(target_z).and_then(|row| row.get_mut(columns.clone()));
                if let Some(row) = row {
                    maxima.spread(row, disc.chord(target_z.abs_diff(z)), reach);
                }
            }
        }
    }
}

/// The largest values of 1, 2, 4, … samples of a row from each one on.
struct Maxima {
    tables: Vec<Vec<f32>>,
}

impl Maxima {
    fn new(disc: &Disc) -> Self {
        let longest = 2 * disc.reach() as usize + 1;
        let length = longest + STRIP as usize;
        Self { tables: vec![vec![0.0; length]; longest.ilog2() as usize + 1] }
    }

    /// Takes a row, without samples that have all of it; whether anything of it is left.
    fn begin(&mut self, row: &[f32], range: Range) -> bool {
        let Some((first, longer)) = self.tables.split_first_mut() else { return false };
        if !rest_of(first, row, range.least, range.most) {
            return false;
        }
        let mut shorter: &mut Vec<f32> = first;
        let mut length = 1;
        for table in longer {
            let second = shorter.get(length..).unwrap_or_default();
            larger_of(table, shorter, second);
            length *= 2;
            shorter = table;
        }
        true
    }

    /// Raises a row to the largest values within a chord about each sample; its first one lies `reach` after that of the tables.
    fn spread(&self, row: &mut [f32], chord: i32, reach: i32) {
        let length = 2 * chord + 1;
        let level = length.ilog2();
        let Some(table) = self.tables.get(level as usize) else { return };
        let from = |place: i32| table.get(place as usize..).unwrap_or_default();
        raise(row, from(reach - chord), from(reach + chord + 1 - (1 << level)));
    }
}

/// The values of a row that are below the most; whether any of them is above the least.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn rest_of(rest: &mut [f32], row: &[f32], least: f32, most: f32) -> bool {
    let mut is_any = false;
    for (rest, value) in rest.iter_mut().zip(row) {
        *rest = if *value >= most { least } else { *value };
        is_any |= *rest > least;
    }
    is_any
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn larger_of(larger: &mut [f32], first: &[f32], second: &[f32]) {
    for ((larger, first), second) in larger.iter_mut().zip(first).zip(second) {
        *larger = if first > second { *first } else { *second };
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn raise(row: &mut [f32], first: &[f32], second: &[f32]) {
    for ((value, first), second) in row.iter_mut().zip(first).zip(second) {
        let larger = if first > second { *first } else { *second };
        *value = if larger > *value { larger } else { *value };
    }
}
