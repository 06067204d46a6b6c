//! Planes: samples of any rectangle, apart from pages. What kernels that look at neighbours read and write.

use crate::{Error, Page, Result, SampleRect};

/// Samples of a rectangle of a grid, row by row; of some quantities several values a sample, channel after channel.
#[derive(Debug, Clone)]
pub struct Plane {
    rect: SampleRect,
    num_channels: u32,
    /// At least as many as it has values: memory that was a larger plane's keeps its length, so that it need not be filled anew.
    memory: Vec<f32>,
}

impl Plane {
    /// A plane of one channel that holds one value everywhere.
    #[must_use]
    pub fn constant(rect: SampleRect, value: f32) -> Self {
        Self::with_channels(rect, 1, value)
    }

    /// A plane of `num_channels` channels that holds one value everywhere.
    #[must_use]
    pub fn with_channels(rect: SampleRect, num_channels: u32, value: f32) -> Self {
        Self { rect, num_channels, memory: vec![value; num_values(&rect, num_channels)] }
    }

    /// From its values: channel by channel, row by row.
    ///
    /// # Errors
    /// [`Error::PlaneLength`] unless there are exactly as many as the rectangle has samples, for each channel.
    pub fn from_samples(rect: SampleRect, num_channels: u32, samples: Vec<f32>) -> Result<Self> {
        let expected = num_values(&rect, num_channels);
        if samples.len() == expected {
            Ok(Self { rect, num_channels, memory: samples })
        } else {
            let (width, depth, actual) = (rect.width(), rect.depth(), samples.len());
            Err(Error::PlaneLength { width, depth, num_channels, expected, actual })
        }
    }

    /// The same memory as a plane of another rectangle, whose values are not defined until they are written.
    #[must_use]
    pub fn reused(mut self, rect: SampleRect, num_channels: u32) -> Self {
        let num_values = num_values(&rect, num_channels);
        if self.memory.len() < num_values {
            self.memory.resize(num_values, 0.0);
        }
        Self { rect, num_channels, memory: self.memory }
    }

    /// The samples that it has, on their grid.
    #[must_use]
    pub const fn rect(&self) -> SampleRect {
        self.rect
    }

    /// Values a sample.
    #[must_use]
    pub const fn num_channels(&self) -> u32 {
        self.num_channels
    }

    /// All values, channel by channel, row by row.
    #[must_use]
    pub fn into_samples(mut self) -> Vec<f32> {
        self.memory.truncate(num_values(&self.rect, self.num_channels));
        self.memory
    }

    /// All values, channel by channel, row by row.
    #[must_use]
    pub fn samples(&self) -> &[f32] {
        self.memory.get(..num_values(&self.rect, self.num_channels)).unwrap_or_default()
    }

    /// All values, channel by channel, row by row, to be changed.
    #[must_use]
    pub fn samples_mut(&mut self) -> &mut [f32] {
        self.memory.get_mut(..num_values(&self.rect, self.num_channels)).unwrap_or_default()
    }

    /// How many values its memory could hold.
    #[must_use]
    pub fn capacity(&self) -> usize {
        self.memory.len()
    }

    /// Bytes that its memory takes.
    #[must_use]
    pub fn size_in_bytes(&self) -> u64 {
        self.capacity() as u64 * size_of::<f32>() as u64
    }

    /// Row `z` of the first channel, `z` on the grid; `None` where the plane does not have it.
    #[must_use]
    pub fn row(&self, z: i32) -> Option<&[f32]> {
        self.channel_row(0, z)
    }

    /// Row `z` of a channel; `None` where the plane does not have it.
    #[must_use]
    pub fn channel_row(&self, channel: u32, z: i32) -> Option<&[f32]> {
        self.memory.get(self.row_range(channel, z)?)
    }

    /// As [`Self::row`], to be changed.
    #[must_use]
    pub fn row_mut(&mut self, z: i32) -> Option<&mut [f32]> {
        let range = self.row_range(0, z)?;
        self.memory.get_mut(range)
    }

    /// Copies as much of a page, which lies at `page_rect`, as lies within a rectangle and in the plane, into its first channel.
    pub fn paste(&mut self, page: &Page, page_rect: &SampleRect, within: &SampleRect) {
        let rect = self.rect;
        let both = page_rect.intersection(within).intersection(&rect);
        let (x0, x1) = (both.x0.abs_diff(page_rect.x0), both.x1.abs_diff(page_rect.x0));
        let first = both.x0.abs_diff(rect.x0) as usize;
        for z in both.z0..both.z1 {
            let from = page.row(z.abs_diff(page_rect.z0), x0, x1);
            let to = self.row_mut(z).and_then(|row| row.get_mut(first..first + both.width() as usize));
            if let (Some(from), Some(to)) = (from, to) {
                to.copy_from_slice(from);
            }
        }
    }

    /// One value of the first channel; `None` where the plane does not have it.
    #[must_use]
    pub fn at(&self, x: i32, z: i32) -> Option<f32> {
        let column = usize::try_from(x.checked_sub(self.rect.x0)?).ok()?;
        self.row(z)?.get(column).copied()
    }

    fn row_range(&self, channel: u32, z: i32) -> Option<std::ops::Range<usize>> {
        let is_there = channel < self.num_channels && (self.rect.z0..self.rect.z1).contains(&z);
        let width = self.rect.width() as usize;
        let row = channel as usize * self.rect.depth() as usize + z.abs_diff(self.rect.z0) as usize;
        is_there.then(|| row * width..(row + 1) * width)
    }
}

impl PartialEq for Plane {
    fn eq(&self, other: &Self) -> bool {
        let shape = |plane: &Self| (plane.rect, plane.num_channels);
        shape(self) == shape(other) && self.samples() == other.samples()
    }
}

const fn num_values(rect: &SampleRect, num_channels: u32) -> usize {
    rect.area() as usize * num_channels as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_named_by_their_place_on_the_grid() {
        let rect = SampleRect::new(-2, 5, 1, 7);
        let samples: Vec<f32> = (0..12).map(|value| value as f32).collect();
        let mut plane = Plane::from_samples(rect, 2, samples).unwrap();
        assert_eq!(plane.row(6), Some(&[3.0, 4.0, 5.0][..]));
        assert_eq!(plane.channel_row(1, 5), Some(&[6.0, 7.0, 8.0][..]));
        assert_eq!((plane.row(7), plane.row(4), plane.channel_row(2, 5)), (None, None, None));
        assert_eq!(
            (plane.at(-2, 5), plane.at(0, 6), plane.at(1, 6), plane.at(-3, 6)),
            (Some(0.0), Some(5.0), None, None)
        );
        plane.row_mut(5).unwrap()[0] = 9.0;
        assert_eq!(plane.at(-2, 5), Some(9.0));
        assert!(Plane::from_samples(rect, 1, vec![0.0; 5]).is_err());
        assert_eq!(plane.reused(SampleRect::new(0, 0, 5, 5), 1).samples().len(), 25);
    }
}
