//! Rasters that lie otherwise than their file has them: turned by quarters, then mirrored.
//!
//! A row that is only read backwards streams. For all else rows are needed that come late in the file, or pieces of all of them: then
//! the heights are put down once, in memory or, where they are many, in a temporary file, and read from there a band at a time.

use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};

use tempfile::SpooledTempFile;

use crate::error::{Error, Result};
use crate::options::ImportOptions;
use crate::place::Place;
use crate::source::RowSource;

/// Bytes of a height.
const HEIGHT_BYTES: usize = size_of::<f32>();
/// Bytes of heights that are kept in memory; more of them go into a file.
const MAX_BYTES_IN_MEMORY: usize = 64 << 20;
/// Bytes of rows that are made at once.
const BAND_BYTES: usize = 32 << 20;

/// Which sides of a raster change places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Flip {
    /// None.
    #[default]
    None,
    /// East and west: each row is read backwards.
    EastWest,
    /// North and south: the last row comes first.
    NorthSouth,
    /// Both, as half a turn does.
    Both,
}

impl Flip {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::None, Self::EastWest, Self::NorthSouth, Self::Both];

    /// Whether it is none: what does nothing is not written down.
    pub(crate) const fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }
}

/// How a delivered raster is read from that of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Turn {
    /// Whether columns of the file are delivered as rows.
    pub is_transposed: bool,
    /// Whether the file's columns are read from the east.
    is_x_reversed: bool,
    /// Whether its rows are read from the south.
    is_z_reversed: bool,
}

impl Turn {
    /// What options say; degrees between quarters are refused elsewhere.
    pub const fn of(options: &ImportOptions) -> Self {
        let quarters = options.rotate_degrees / 90 % 4;
        let (is_transposed, is_x_reversed, is_z_reversed) = match quarters {
            0 => (false, false, false),
            1 => (true, false, true),
            2 => (false, true, true),
            _ => (true, true, false),
        };
        let flips_x = matches!(options.flip, Flip::EastWest | Flip::Both);
        let flips_z = matches!(options.flip, Flip::NorthSouth | Flip::Both);
        // After a quarter what runs east was a column of the file.
        let (of_x, of_z) = if is_transposed { (flips_z, flips_x) } else { (flips_x, flips_z) };
        Self { is_transposed, is_x_reversed: is_x_reversed != of_x, is_z_reversed: is_z_reversed != of_z }
    }

    /// The size of what is delivered of so many samples along x and z.
    pub const fn size(self, [width, depth]: [u32; 2]) -> [u32; 2] {
        if self.is_transposed { [depth, width] } else { [width, depth] }
    }

    /// Where a place of the file comes to lie, in shares of its sides from the north-west corner on.
    pub fn place(self, [x, z]: [f64; 2]) -> [f64; 2] {
        let x = if self.is_x_reversed { 1.0 - x } else { x };
        let z = if self.is_z_reversed { 1.0 - z } else { z };
        if self.is_transposed { [z, x] } else { [x, z] }
    }

    /// The rows of a file of so many samples as they are delivered.
    pub fn rows(self, rows: Box<dyn RowSource>, size: [u32; 2], place: &Place) -> Box<dyn RowSource> {
        if self == Self::default() {
            return rows;
        }
        if !self.is_transposed && !self.is_z_reversed {
            return Box::new(Backwards(rows));
        }
        let [width, depth] = size.map(|side| side as usize);
        let heights = tempfile::spooled_tempfile(MAX_BYTES_IN_MEMORY);
        let place = place.clone();
        Box::new(Turned {
            turn: self,
            rows: Some(rows),
            heights,
            place,
            width,
            depth,
            next: 0,
            band: Vec::new(),
            band_bytes: BAND_BYTES,
        })
    }
}

/// Rows that are read from the east.
struct Backwards(Box<dyn RowSource>);

impl RowSource for Backwards {
    fn read_row(&mut self, row: &mut [f32]) -> Result<()> {
        self.0.read_row(row)?;
        row.reverse();
        Ok(())
    }
}

/// Rows of which the first may need the last of the file.
struct Turned {
    turn: Turn,
    /// The file's rows, until they are put down.
    rows: Option<Box<dyn RowSource>>,
    /// Where they are put down.
    heights: SpooledTempFile,
    place: Place,
    /// Samples along x and z of the file.
    width: usize,
    depth: usize,
    /// The row that is delivered next.
    next: usize,
    /// Delivered rows that were made already, the last one first.
    band: Vec<Vec<f32>>,
    band_bytes: usize,
}

impl RowSource for Turned {
    fn read_row(&mut self, row: &mut [f32]) -> Result<()> {
        if let Some(rows) = self.rows.take() {
            self.put_down(rows)?;
        }
        if self.band.is_empty() {
            self.band = if self.turn.is_transposed { self.columns()? } else { vec![self.row_of_file()?] };
            self.next += self.band.len();
            self.band.reverse();
        }
        for (to, from) in row.iter_mut().zip(self.band.pop().unwrap_or_default()) {
            *to = from;
        }
        Ok(())
    }
}

impl Turned {
    fn failed(&self, source: io::Error) -> Error {
        Error::Io { path: self.place.path.clone(), doing: "keep its heights until they are turned", source }
    }

    fn put_down(&mut self, mut rows: Box<dyn RowSource>) -> Result<()> {
        let mut row = vec![0.0_f32; self.width];
        let mut bytes = Vec::with_capacity(self.width * HEIGHT_BYTES);
        for _ in 0..self.depth {
            rows.read_row(&mut row)?;
            bytes.clear();
            bytes.extend(row.iter().flat_map(|height_m| height_m.to_ne_bytes()));
            self.heights.write_all(&bytes).map_err(|source| self.failed(source))?;
        }
        Ok(())
    }

    /// Heights of one row of the file, from a column on.
    fn read(&mut self, row: usize, column: usize, num: usize) -> Result<Vec<f32>> {
        let at = (row * self.width + column) as u64 * HEIGHT_BYTES as u64;
        let mut bytes = vec![0; num * HEIGHT_BYTES];
        let read = self.heights.seek(SeekFrom::Start(at)).and_then(|_| self.heights.read_exact(&mut bytes));
        read.map_err(|source| self.failed(source))?;
        let (heights, _) = bytes.as_chunks();
        Ok(heights.iter().map(|height| f32::from_ne_bytes(*height)).collect())
    }

    /// The next row, where rows stay rows.
    fn row_of_file(&mut self) -> Result<Vec<f32>> {
        let row = if self.turn.is_z_reversed { self.depth - 1 - self.next } else { self.next };
        let mut heights = self.read(row, 0, self.width)?;
        if self.turn.is_x_reversed {
            heights.reverse();
        }
        Ok(heights)
    }

    /// The next rows, which are columns of the file: as many as may be in memory, as all of it has to be read for one.
    fn columns(&mut self) -> Result<Vec<Vec<f32>>> {
        let num = (self.band_bytes / (self.depth * HEIGHT_BYTES).max(1)).max(1);
        let num = num.min(self.width - self.next);
        let first = if self.turn.is_x_reversed { self.width - self.next - num } else { self.next };
        let mut columns = vec![Vec::with_capacity(self.depth); num];
        for row in 0..self.depth {
            let row = if self.turn.is_z_reversed { self.depth - 1 - row } else { row };
            let heights = self.read(row, first, num)?;
            columns.iter_mut().zip(heights).for_each(|(column, height_m)| column.push(height_m));
        }
        if self.turn.is_x_reversed {
            columns.reverse();
        }
        Ok(columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::Format;
    use crate::source::MemoryRows;

    /// The rows of 5 x 3 samples, made two at a time.
    fn turned(turn: Turn) -> Vec<f32> {
        let rows = Box::new(MemoryRows::new((0_u8..15).map(f32::from).collect()));
        let [width, depth] = turn.size([5, 3]).map(|side| side as usize);
        let place = Place { path: "a.npy".into(), format: Format::Npy };
        let mut heights = vec![f32::NAN; 15];
        let mut rows: Box<dyn RowSource> = if turn.is_transposed {
            Box::new(Turned {
                turn,
                rows: Some(rows),
                // It goes into a file at once.
                heights: tempfile::spooled_tempfile(0),
                place,
                width: 5,
                depth: 3,
                next: 0,
                band: Vec::new(),
                band_bytes: 2 * 3 * HEIGHT_BYTES,
            })
        } else {
            turn.rows(rows, [5, 3], &place)
        };
        assert_eq!(width * depth, 15);
        heights.chunks_exact_mut(width).for_each(|row| rows.read_row(row).unwrap());
        heights
    }

    #[test]
    fn every_sample_goes_where_its_place_goes() {
        for rotate_degrees in [0, 90, 180, 270] {
            for flip in Flip::ALL {
                let turn = Turn::of(&ImportOptions { rotate_degrees, flip, ..ImportOptions::default() });
                let heights = turned(turn);
                let [width, depth] = turn.size([5, 3]);
                for (index, height_m) in (0..15_u32).zip(0_u8..) {
                    let share = [f64::from(index % 5) / 4.0, f64::from(index / 5) / 2.0];
                    let [x, z] = turn.place(share);
                    let (x, z) = (x * f64::from(width - 1), z * f64::from(depth - 1));
                    let at = z.round() as usize * width as usize + x.round() as usize;
                    assert_eq!(heights[at], f32::from(height_m), "{rotate_degrees} {flip:?} {index}");
                }
            }
        }
    }

    #[test]
    fn a_quarter_is_clockwise_and_mirrors_come_after_it() {
        let of = |rotate_degrees, flip| {
            turned(Turn::of(&ImportOptions { rotate_degrees, flip, ..ImportOptions::default() }))
        };
        // What was the western column, from the south, is the northern row, from the west.
        let quarter = of(90, Flip::None);
        assert_eq!(quarter[..3], [10.0, 5.0, 0.0]);
        assert_eq!(quarter[12..], [14.0, 9.0, 4.0]);
        assert_eq!(of(90, Flip::EastWest)[..3], [0.0, 5.0, 10.0]);
        assert_eq!(of(90, Flip::NorthSouth)[..3], [14.0, 9.0, 4.0]);
        assert_eq!(of(180, Flip::Both), of(0, Flip::None));
        assert_eq!(of(270, Flip::Both), quarter);
    }
}
