//! TIFF: f32 metres in deflated strips with the floating-point predictor, little-endian, BigTIFF where it must be.
//!
//! The `tiff` crate's encoder borrows itself while an image is open, so it cannot wait for the next rows, and it lacks
//! the predictor. The file is simple enough to write here: header, strips, directory. With a spacing it is a GeoTIFF
//! in metres of no named system, its first sample at (0, 0).

use std::fs::File;
use std::io::{BufWriter, Seek, SeekFrom, Write};

use tiff::encoder::compression::{CompressionAlgorithm, Deflate};

use super::{RowSink, Target};
use crate::error::Result;
use crate::place::Place;

/// How many bytes of samples a strip has at least.
const STRIP_BYTES: u64 = 1 << 18;
/// How many strips an image has at most: their places are held until the end.
const MAX_STRIPS: u32 = 1 << 16;
/// The longest a file may get before it is a BigTIFF, bytes: offsets have 32 bits, and deflate may add a little.
const MAX_CLASSIC_BYTES: u64 = 0xf000_0000;

/// Begins an image file.
pub(super) fn create(file: BufWriter<File>, target: &Target) -> Result<Box<dyn RowSink>> {
    let bytes = u64::from(target.width) * u64::from(target.depth) * 4;
    Ok(Box::new(TiffSink::new(file, target, bytes > MAX_CLASSIC_BYTES)?))
}

struct TiffSink {
    file: BufWriter<File>,
    place: Place,
    width: u32,
    depth: u32,
    spacing_m: Option<f64>,
    rows_per_strip: u32,
    is_big: bool,
    /// Rows after the predictor, until they are a strip.
    strip: Vec<u8>,
    rows_in_strip: u32,
    /// Bytes written.
    offset: u64,
    /// Where each strip is, and its length in bytes.
    strips: Vec<(u64, u64)>,
}

impl TiffSink {
    fn new(file: BufWriter<File>, target: &Target, is_big: bool) -> Result<Self> {
        let rows_for_size =
            u32::try_from(STRIP_BYTES.div_ceil(u64::from(target.width) * 4)).unwrap_or(u32::MAX);
        let mut sink = Self {
            file,
            place: target.place.clone(),
            width: target.width,
            depth: target.depth,
            spacing_m: target.spacing_m,
            rows_per_strip: rows_for_size.max(target.depth.div_ceil(MAX_STRIPS)).min(target.depth),
            is_big,
            strip: Vec::new(),
            rows_in_strip: 0,
            offset: 0,
            strips: Vec::new(),
        };
        // The directory's place is filled in at the end.
        sink.write(if is_big { b"II\x2b\0\x08\0\0\0\0\0\0\0\0\0\0\0" } else { b"II\x2a\0\0\0\0\0" })?;
        Ok(sink)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.file.write_all(bytes).map_err(|err| self.place.writing(err))?;
        self.offset += bytes.len() as u64;
        Ok(())
    }

    fn write_strip(&mut self) -> Result<()> {
        let mut packed = Vec::new();
        Deflate::default().write_to(&mut packed, &self.strip).map_err(|err| self.place.writing(err))?;
        self.strips.push((self.offset, packed.len() as u64));
        self.strip.clear();
        self.rows_in_strip = 0;
        self.write(&packed)
    }

    fn directory(&self) -> Vec<Entry> {
        let (offsets, lengths): (Vec<u64>, Vec<u64>) = self.strips.iter().copied().unzip();
        let mut directory = vec![
            Entry::longs(256, [self.width]),
            Entry::longs(257, [self.depth]),
            Entry::shorts(258, [32]), // bits in a sample
            Entry::shorts(259, [8]),  // deflate
            Entry::shorts(262, [1]),  // black is zero
            Entry::offsets(273, &offsets, self.is_big),
            Entry::shorts(277, [1]), // one band
            Entry::longs(278, [self.rows_per_strip]),
            Entry::offsets(279, &lengths, self.is_big),
            Entry::shorts(284, [1]), // bands interleaved
            Entry::shorts(317, [3]), // floating-point predictor
            Entry::shorts(339, [3]), // IEEE floats
        ];
        if let Some(spacing_m) = self.spacing_m {
            directory.push(Entry::doubles(33550, [spacing_m, spacing_m, 0.0]));
            directory.push(Entry::doubles(33922, [0.0; 6]));
            // Header; projected; samples are points; no named system; metres.
            let keys =
                [[1, 1, 0, 4], [1024, 0, 1, 1], [1025, 0, 1, 2], [3072, 0, 1, 32767], [3076, 0, 1, 9001]];
            directory.push(Entry::shorts(34735, keys.into_iter().flatten()));
        }
        directory
    }

    /// Writes the directory, values that do not fit into its entries first, and gives its place.
    fn write_directory(&mut self) -> Result<u64> {
        let field_bytes = if self.is_big { 8 } else { 4 };
        let mut table = Vec::new();
        let directory = self.directory();
        self.push_number(&mut table, directory.len() as u64, if self.is_big { 8 } else { 2 });
        for entry in &directory {
            table.extend(entry.tag.to_le_bytes());
            table.extend(entry.kind.to_le_bytes());
            self.push_number(&mut table, entry.count, field_bytes);
            if entry.value.len() <= field_bytes {
                table.extend(&entry.value);
                table.resize(table.len() + field_bytes - entry.value.len(), 0);
            } else {
                self.align()?;
                let offset = self.offset;
                self.push_number(&mut table, offset, field_bytes);
                self.write(&entry.value)?;
            }
        }
        // No further directory.
        self.push_number(&mut table, 0, field_bytes);
        self.align()?;
        let offset = self.offset;
        self.write(&table)?;
        Ok(offset)
    }

    fn push_number(&self, table: &mut Vec<u8>, number: u64, num_bytes: usize) {
        table.extend(number.to_le_bytes().into_iter().take(num_bytes));
    }

    /// Values begin at multiples of 8, which suits every type.
    fn align(&mut self) -> Result<()> {
        while !self.offset.is_multiple_of(8) {
            self.write(&[0])?;
        }
        Ok(())
    }
}

impl RowSink for TiffSink {
    fn write_row(&mut self, row: &[f32]) -> Result<()> {
        predict(row, &mut self.strip);
        self.rows_in_strip += 1;
        if self.rows_in_strip == self.rows_per_strip {
            self.write_strip()?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        if self.rows_in_strip > 0 {
            self.write_strip()?;
        }
        let directory = self.write_directory()?;
        let (place_of_offset, num_bytes) = if self.is_big { (8, 8) } else { (4, 4) };
        let mut offset = Vec::new();
        self.push_number(&mut offset, directory, num_bytes);
        let patched = self
            .file
            .seek(SeekFrom::Start(place_of_offset))
            .and_then(|_| self.file.write_all(&offset))
            .and_then(|()| self.file.flush());
        patched.map_err(|err| self.place.writing(err))
    }
}

/// Appends a row as the floating-point predictor stores it (Adobe Photoshop TIFF technical note 3): all first bytes,
/// then all second ones and so on, most significant first, each less the one before it.
fn predict(row: &[f32], stored: &mut Vec<u8>) {
    let mut before = 0_u8;
    for byte in 0..4 {
        for height_m in row {
            let this = height_m.to_be_bytes().into_iter().nth(byte).unwrap_or_default();
            stored.push(this.wrapping_sub(before));
            before = this;
        }
    }
}

/// A tag and its values.
struct Entry {
    tag: u16,
    kind: u16,
    count: u64,
    value: Vec<u8>,
}

impl Entry {
    fn new<const N: usize>(tag: u16, kind: u16, values: impl IntoIterator<Item = [u8; N]>) -> Self {
        let value: Vec<u8> = values.into_iter().flatten().collect();
        Self { tag, kind, count: (value.len() / N) as u64, value }
    }

    fn shorts(tag: u16, values: impl IntoIterator<Item = u16>) -> Self {
        Self::new(tag, 3, values.into_iter().map(u16::to_le_bytes))
    }

    fn longs(tag: u16, values: impl IntoIterator<Item = u32>) -> Self {
        Self::new(tag, 4, values.into_iter().map(u32::to_le_bytes))
    }

    fn doubles(tag: u16, values: impl IntoIterator<Item = f64>) -> Self {
        Self::new(tag, 12, values.into_iter().map(f64::to_le_bytes))
    }

    /// Places and lengths in the file: 64 bits in a BigTIFF, else 32, where none is longer.
    #[expect(clippy::cast_possible_truncation, reason = "a classic file is shorter than its offsets reach")]
    fn offsets(tag: u16, values: &[u64], is_big: bool) -> Self {
        if is_big {
            Self::new(tag, 16, values.iter().map(|value| value.to_le_bytes()))
        } else {
            Self::longs(tag, values.iter().map(|&value| value as u32))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::{ByteOrder, Format, SampleType};
    use crate::sample::Encoding;
    use crate::{ImportOptions, open};

    /// A file beyond 4 GiB is no test; the form it has is.
    #[test]
    fn a_bigtiff_has_the_heights_of_a_classic_one() {
        let folder = tempfile::tempdir().unwrap();
        let (width, depth) = (300_u32, 500_u32);
        let heights_m: Vec<f32> = (0..width * depth).map(|n| (n % 997) as f32 * 0.5 - 40.0).collect();
        for is_big in [false, true] {
            let path = folder.path().join(format!("{is_big}.tif"));
            let target = Target {
                place: Place { path: path.clone(), format: Format::Tiff },
                width,
                depth,
                sample: SampleType::F32,
                encoding: Encoding::new(SampleType::F32, ByteOrder::Little, None),
                spacing_m: Some(4.0),
            };
            let file = BufWriter::new(File::create(&path).unwrap());
            let mut sink = Box::new(TiffSink::new(file, &target, is_big).unwrap());
            for row in heights_m.chunks_exact(width as usize) {
                sink.write_row(row).unwrap();
            }
            sink.finish().unwrap();
            assert_eq!(std::fs::read(&path).unwrap()[2], if is_big { 43 } else { 42 });
            let mut import = open(&path, &ImportOptions::default()).unwrap();
            let mut read = vec![0.0; heights_m.len()];
            assert_eq!(import.read_rows(&mut read).unwrap(), depth as usize);
            assert_eq!((read, import.info().spacing_m), (heights_m.clone(), Some(4.0)));
        }
    }
}
