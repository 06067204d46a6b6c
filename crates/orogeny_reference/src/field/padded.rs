//! Rows cut into parts of one length, each with a sample more at both ends: what kernels that look at the eight neighbours
//! loop over, whether or not there is ground beyond.

use orogeny_field::{Plane, SampleRect};

/// A channel of a plane.
#[derive(Debug, Clone, Copy)]
pub struct Channel<'a>(pub &'a Plane, pub u32);

/// Samples of a part.
pub(super) const LANES: usize = 64;

/// A part with the samples on both sides of it.
pub(super) type Padded = [f32; LANES + 2];

/// What is read where the region has ended.
#[derive(Debug, Clone, Copy)]
pub(super) enum Beyond {
    /// Always this.
    Value(f32),
    /// The nearest sample of the region.
    Nearest,
}

/// Where a part lies, and what there is around it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place<'a> {
    /// Its first sample.
    pub x: i32,
    /// Its row.
    pub z: i32,
    /// The region.
    pub bounds: &'a SampleRect,
}

impl Place<'_> {
    /// The part of a channel `dz` rows on: sample `x - 1` first. Out of the plane itself, or, where a row ends, put together
    /// in the buffer.
    pub(super) fn row<'a>(
        &self,
        Channel(plane, channel): Channel<'a>,
        dz: i32,
        beyond: Beyond,
        buffer: &'a mut Padded,
    ) -> &'a Padded {
        // What is there: of a window the plane may end before the region does, and then nobody asks for what is beyond.
        let there = plane.rect().intersection(self.bounds);
        let mut z = self.z.saturating_add(dz);
        if z < there.z0 || z >= there.z1 {
            match beyond {
                Beyond::Value(value) => {
                    *buffer = [value; LANES + 2];
                    return buffer;
                }
                Beyond::Nearest => z = z.clamp(there.z0, there.z1.saturating_sub(1).max(there.z0)),
            }
        }
        let first = there.x0.abs_diff(plane.rect().x0) as usize;
        let row =
            plane.channel_row(channel, z).and_then(|row| row.get(first..first + there.width() as usize));
        let row = row.unwrap_or_default();
        // From the first sample that is there to the first one asked for.
        let skipped = i64::from(self.x) - 1 - i64::from(there.x0);
        if skipped >= 0
            && let Some(whole) = row.get(skipped as usize..).and_then(|rest| rest.first_chunk())
        {
            return whole;
        }
        let (west, east) = match beyond {
            Beyond::Value(value) => (value, value),
            Beyond::Nearest => {
                (row.first().copied().unwrap_or_default(), row.last().copied().unwrap_or_default())
            }
        };
        let num_west = (-skipped).clamp(0, LANES as i64 + 2) as usize;
        let rest = row.get(skipped.max(0) as usize..).unwrap_or_default();
        let num_there = rest.len().min(LANES + 2 - num_west);
        if let Some((before, after)) = buffer.split_at_mut_checked(num_west)
            && let Some((within, after)) = after.split_at_mut_checked(num_there)
        {
            before.fill(west);
            within.copy_from_slice(rest.get(..num_there).unwrap_or_default());
            after.fill(east);
        }
        buffer
    }
}

/// The sample at a place of a part; the places of loops over whole parts are known to be within.
#[inline(always)]
pub(super) fn at<const N: usize>(part: &[f32; N], place: usize) -> f32 {
    part.get(place).copied().unwrap_or_default()
}

/// `max(value, 0)`, and 0 for NaN.
#[inline(always)]
pub(super) fn positive(value: f32) -> f32 {
    if value > 0.0 { value } else { 0.0 }
}

/// The smaller of two that are no NaN, in one instruction.
#[inline(always)]
pub(super) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger of two that are no NaN, in one instruction.
#[inline(always)]
pub(super) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_beyond_the_region_is_made_up() {
        // The plane holds more than the region to the west and north, and ends with it to the east and south.
        let rect = SampleRect::new(-4, -3, 100, 9);
        let samples = (-3..9).flat_map(|z| (-4..100).map(move |x| (1000 * z + x) as f32));
        let plane = Plane::from_samples(rect, 1, samples.collect()).unwrap();
        let bounds = SampleRect::new(0, 0, 100, 9);
        let is_inside = |x: i32, z: i32| bounds.contains(&SampleRect::new(x, z, x + 1, z + 1));
        for (x, z) in [(0, 0), (1, 4), (20, 8), (35, 2), (36, 0), (90, 3), (99, 8)] {
            let place = Place { x, z, bounds: &bounds };
            for dz in -1..=1 {
                let mut buffers = [[f32::NAN; LANES + 2]; 2];
                let [a, b] = &mut buffers;
                let walled = place.row(Channel(&plane, 0), dz, Beyond::Value(-7.5), a);
                let nearest = place.row(Channel(&plane, 0), dz, Beyond::Nearest, b);
                for (column, (walled, nearest)) in (x - 1..).zip(walled.iter().zip(nearest)) {
                    let of = |x: i32, z: i32| (1000 * z + x) as f32;
                    let expected = if is_inside(column, z + dz) { of(column, z + dz) } else { -7.5 };
                    assert_eq!(*walled, expected, "{column}, {}", z + dz);
                    assert_eq!(*nearest, of(column.clamp(0, 99), (z + dz).clamp(0, 8)));
                }
            }
        }
    }
}
