//! From values to coded bytes and back, in buffers that are used again.

use zstd::bulk::{Compressor, Decompressor};

use super::{DecodeError, planes};

const HEADER_BYTES: usize = 6;

/// Buffers up to this size are kept for a thread's next page: they are those of pages with up to 512 samples a side.
const MAX_KEPT_BYTES: usize = 1 << 20;

/// Speed is worth more than the last percent: higher levels gain little on these planes.
const ZSTD_LEVEL: i32 = 1;

/// How the values of a page became planes.
pub(super) struct Header {
    /// How often they were predicted.
    pub(super) order: u8,
    /// How many low bits were left out.
    pub(super) shift: u32,
    /// What the first prediction starts from: the page's first value.
    pub(super) base: u32,
}

/// What coding a page needs beside the page. Kept from one page to the next: making it anew takes a good part of the time.
#[derive(Default)]
pub(super) struct Workspace {
    residuals: Vec<u32>,
    once_predicted: Vec<u32>,
    pub(super) planes: Vec<u8>,
    coded: Vec<u8>,
    compressor: Option<Compressor<'static>>,
    decompressor: Option<Decompressor<'static>>,
}

impl Workspace {
    pub(super) fn encode(&mut self, values: &[u32], side: usize) -> std::io::Result<Vec<u8>> {
        let header = self.predict(values, side);
        let num_samples = values.len();
        self.planes.resize(num_samples * 4, 0);
        planes::split(&self.residuals, header.shift, &mut self.planes);

        let compressor = match &mut self.compressor {
            Some(compressor) => compressor,
            none => none.insert(Compressor::new(ZSTD_LEVEL)?),
        };
        let mut bytes = header.to_bytes().to_vec();
        self.coded.resize(zstd::compress_bound(num_samples), 0);
        // A frame for each plane, so that each has an entropy code of its own.
        for plane in self.planes.chunks_exact(num_samples.max(1)) {
            let size_in_bytes = compressor.compress_to_buffer(plane, self.coded.as_mut_slice())?;
            bytes.extend_from_slice(self.coded.get(..size_in_bytes).unwrap_or_default());
        }
        bytes.shrink_to_fit();
        Ok(bytes)
    }

    /// Fills `residuals` and says how.
    fn predict(&mut self, values: &[u32], side: usize) -> Header {
        self.residuals.resize(values.len(), 0);
        let order = planes::best_order(values, side);
        let base = if order == 0 { 0 } else { values.first().copied().unwrap_or_default() };
        let used_bits = match order {
            0 => {
                self.residuals.copy_from_slice(values);
                values.iter().fold(0, |used_bits, value| used_bits | value)
            }
            1 => planes::predict(values, side, base, &mut self.residuals),
            _ => {
                self.once_predicted.resize(values.len(), 0);
                planes::predict(values, side, base, &mut self.once_predicted);
                planes::predict(&self.once_predicted, side, 0, &mut self.residuals)
            }
        };
        // Where nothing remains there is nothing to shift.
        let shift = if used_bits == 0 { 0 } else { used_bits.trailing_zeros() };
        Header { order, shift, base }
    }

    /// What remained of each value, from compressed planes.
    pub(super) fn join(
        &mut self,
        compressed: &[u8],
        shift: u32,
        residuals: &mut [u32],
    ) -> Result<(), DecodeError> {
        let expected = residuals.len() * 4;
        let refused = |err: std::io::Error| DecodeError::Compression {
            size_in_bytes: compressed.len(),
            expected,
            reason: err.to_string(),
        };
        self.planes.resize(expected, 0);
        let decompressor = match &mut self.decompressor {
            Some(decompressor) => decompressor,
            none => none.insert(Decompressor::new().map_err(refused)?),
        };
        let actual =
            decompressor.decompress_to_buffer(compressed, self.planes.as_mut_slice()).map_err(refused)?;
        if actual != expected {
            return Err(DecodeError::Length { expected, actual });
        }
        planes::join(&self.planes, shift, residuals);
        Ok(())
    }

    /// Frees buffers that only an unusually large page needs.
    pub(super) fn let_go_of_much(&mut self) {
        if self.planes.capacity() > MAX_KEPT_BYTES {
            (self.residuals, self.once_predicted) = Default::default();
            (self.planes, self.coded) = Default::default();
        }
    }
}

impl Header {
    /// What pages in the first codec have, which has no header.
    pub(super) const IMPLIED: Self = Self { order: 1, shift: 0, base: 0 };

    const fn to_bytes(&self) -> [u8; HEADER_BYTES] {
        let [b0, b1, b2, b3] = self.base.to_le_bytes();
        [self.order, self.shift as u8, b0, b1, b2, b3]
    }

    /// The header and what comes after it.
    pub(super) fn from_bytes(bytes: &[u8]) -> Result<(Self, &[u8]), DecodeError> {
        match bytes {
            [order, shift, b0, b1, b2, b3, compressed @ ..]
                if *order <= planes::MAX_ORDER && u32::from(*shift) < u32::BITS =>
            {
                let base = u32::from_le_bytes([*b0, *b1, *b2, *b3]);
                Ok((Self { order: *order, shift: u32::from(*shift), base }, compressed))
            }
            _ => Err(DecodeError::Header { size_in_bytes: bytes.len() }),
        }
    }
}
