//! Heights at other places than a terrain's samples: for files that must have a certain size, or begin in the south.

use orogeny_field::SampleRect;

use crate::Result;
use crate::composite::Source;
use crate::{Observer, Terrain, progress::report};

/// Bytes of rows that are kept at once, of those of which two are needed.
const BAND_BYTES: u64 = 32 << 20;

/// How the samples of a region become another number of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fit {
    /// Its corners stay corners, and heights between samples are read along straight lines: the spacing differs then.
    #[default]
    Resample,
    /// Samples stay as they are: its middle is cut out, and where there are too few the edge goes on.
    Middle,
}

impl Fit {
    /// Samples of a region, of which it has `from` along an axis, between two of `to`.
    pub(crate) fn step(self, from: u32, to: u32) -> f64 {
        match self {
            Self::Resample => f64::from(from.max(1) - 1) / f64::from(to.max(2) - 1),
            Self::Middle => 1.0,
        }
    }
}

/// A number of samples that a file is to have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExportSize {
    /// Samples along x.
    pub width: u32,
    /// Samples along z.
    pub depth: u32,
    /// How they come about.
    pub fit: Fit,
}

/// Where along an axis a sample is read: at an index, and by a share of the way to the next one.
type Place = (u32, f32);

/// One axis of a region: which of its samples a file's are read at.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axis {
    pub(crate) places: Vec<Place>,
    /// Where the first one is, in samples of the level from the region's edge on.
    pub(crate) first: f64,
}

impl Axis {
    /// `to` samples of `from`.
    pub(crate) fn new(from: u32, to: u32, fit: Fit) -> Self {
        let last = from.max(1) - 1;
        let first = match fit {
            Fit::Resample => 0.0,
            Fit::Middle => ((i64::from(from) - i64::from(to)).div_euclid(2)) as f64,
        };
        let step = fit.step(from, to);
        let places = (0..to).map(|index| {
            let at = (first + f64::from(index) * step).clamp(0.0, f64::from(last));
            let whole = at.floor();
            (whole as u32, (at - whole) as f32)
        });
        Self { places: places.collect(), first }
    }

    /// The same places, read at a coarser level: of samples that begin at `start` those that begin at `coarse.0`, `coarse.1` of them, each for
    /// `scale`. What is made smaller is made of means then, and not of single samples.
    pub(crate) fn coarser(self, start: i32, coarse: (i32, u32), scale: u32) -> Self {
        let last = f64::from(coarse.1.max(1) - 1);
        let places = self.places.into_iter().map(|(index, share)| {
            let at = f64::from(start) + f64::from(index) + f64::from(share);
            let at = (at / f64::from(scale) - f64::from(coarse.0)).clamp(0.0, last);
            (at.floor() as u32, at.fract() as f32)
        });
        Self { places: places.collect(), ..self }
    }
}

/// Rows of a region, in any order.
struct Rows<'a> {
    terrain: &'a Terrain,
    source: Source,
    level: u8,
    rect: SampleRect,
    num_rows: u32,
    /// The last two bands, by the index of their first rows.
    bands: Vec<(u32, Vec<f32>)>,
}

impl Rows<'_> {
    fn row(&mut self, index: u32) -> Result<&[f32]> {
        let start = index / self.num_rows * self.num_rows;
        let width = self.rect.width() as usize;
        let place = match self.bands.iter().position(|(first, _)| *first == start) {
            Some(place) => place,
            None => {
                let rows = self.read(start)?;
                if self.bands.len() > 1 {
                    self.bands.remove(0);
                }
                self.bands.push((start, rows));
                self.bands.len() - 1
            }
        };
        let from = (index - start) as usize * width;
        Ok(self.bands.get(place).and_then(|(_, rows)| rows.get(from..from + width)).unwrap_or_default())
    }

    fn read(&self, start: u32) -> Result<Vec<f32>> {
        let SampleRect { x0, z0, x1, z1 } = self.rect;
        let from = z0.saturating_add_unsigned(start);
        let band = SampleRect::new(x0, from, x1, from.saturating_add_unsigned(self.num_rows).min(z1));
        let mut rows = vec![0.0; usize::try_from(band.area()).unwrap_or_default()];
        self.terrain.composite(self.source, self.level, band)?.read_rows(&mut rows)?;
        Ok(rows)
    }
}

impl Terrain {
    /// Gives rows of a region, read at the places of two axes, to `take`: the northern one first or, where that is asked for, the
    /// southern one.
    ///
    /// # Errors
    /// [`crate::Error::Store`]; what `take` says.
    pub(crate) fn fitted_rows(
        &self,
        (source, level, rect): (Source, u8, SampleRect),
        [along_x, along_z]: [&Axis; 2],
        is_south_first: bool,
        observer: &mut dyn Observer,
        mut take: impl FnMut(&[f32]) -> Result<()>,
    ) -> Result<()> {
        let row_bytes = u64::from(rect.width()).max(1) * size_of::<f32>() as u64;
        let num_rows = u32::try_from(BAND_BYTES / row_bytes).unwrap_or(u32::MAX).max(1);
        let mut rows = Rows { terrain: self, source, level, rect, num_rows, bands: Vec::new() };
        let total = along_z.places.len() as u64;
        let mut places = along_z.places.clone();
        if is_south_first {
            places.reverse();
        }
        let mut fitted = Vec::with_capacity(along_x.places.len());
        for (done, (index, share)) in (1_u64..).zip(places) {
            let mut row = rows.row(index)?.to_vec();
            if share > 0.0 {
                let next = rows.row(index + 1)?;
                row.iter_mut()
                    .zip(next)
                    .for_each(|(height_m, next_m)| *height_m += share * (next_m - *height_m));
            }
            let at = |index: u32| row.get(index as usize).copied().unwrap_or_default();
            fitted.clear();
            fitted.extend(along_x.places.iter().map(|(index, share)| match *share > 0.0 {
                true => at(*index) + share * (at(*index + 1) - at(*index)),
                false => at(*index),
            }));
            take(&fitted)?;
            report(observer, "exporting", done, total)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_stay_corners_and_the_middle_stays_in_the_middle() {
        let axis = Axis::new(5, 9, Fit::Resample);
        assert_eq!((axis.places[0], axis.places[1], axis.places[8]), ((0, 0.0), (0, 0.5), (4, 0.0)));
        assert_eq!((Fit::Resample.step(5, 9), axis.first), (0.5, 0.0));
        let cut = Axis::new(6, 4, Fit::Middle);
        assert_eq!(
            (cut.places.as_slice(), cut.first),
            ([(1, 0.0), (2, 0.0), (3, 0.0), (4, 0.0)].as_slice(), 1.0)
        );
        let padded = Axis::new(2, 5, Fit::Middle);
        let indices: Vec<_> = padded.places.iter().map(|(index, _)| *index).collect();
        assert_eq!((indices, padded.first), (vec![0, 0, 0, 1, 1], -2.0));
        // Nothing lies beyond the last sample, and one sample is one.
        for from in 1..40 {
            for to in 1..40 {
                for fit in [Fit::Resample, Fit::Middle] {
                    let places = Axis::new(from, to, fit).places;
                    let is_within =
                        |(index, share): &Place| *index < from && (*share == 0.0 || index + 1 < from);
                    assert!(
                        places.len() == to as usize && places.iter().all(is_within),
                        "{from} {to} {fit:?}"
                    );
                }
            }
        }
    }
}
