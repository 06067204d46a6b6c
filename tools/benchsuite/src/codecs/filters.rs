//! What is done to values before they are compressed, where the product does something else.

use orogeny_store::codec::planes;

use crate::ground::SIDE;

/// What is done to values before they are compressed.
#[derive(Clone, Copy)]
pub enum Filter {
    /// Nothing: four bytes after four bytes.
    None,
    /// The bytes of the same significance together.
    Shuffle,
    /// Two-dimensional prediction, then the bytes of the same significance together.
    LorenzoShuffle,
    /// The same, without the zero bits at the low end that all that remains shares.
    LorenzoShiftShuffle,
}

impl Filter {
    /// Fills `bytes`, which is 4 x as long as `values`, and gives the number of bits that were left out.
    pub fn apply(self, values: &[u32], residuals: &mut [u32], bytes: &mut [u8]) -> u8 {
        let mut shift = 0;
        match self {
            Self::None => {
                for (value, bytes) in values.iter().zip(bytes.as_chunks_mut().0) {
                    *bytes = value.to_le_bytes();
                }
            }
            Self::Shuffle => {
                for (plane, significance) in bytes.chunks_exact_mut(values.len()).zip(0..) {
                    for (byte, value) in plane.iter_mut().zip(values) {
                        *byte = (value >> (8 * significance)) as u8;
                    }
                }
            }
            Self::LorenzoShuffle => {
                planes::predict(values, SIDE, 0, residuals);
                planes::split(residuals, 0, bytes);
            }
            Self::LorenzoShiftShuffle => {
                let used_bits = planes::predict(values, SIDE, 0, residuals);
                shift = used_bits.trailing_zeros() % u32::BITS;
                planes::split(residuals, shift, bytes);
            }
        }
        shift as u8
    }

    /// The inverse of [`Self::apply`].
    pub fn undo(self, shift: u8, bytes: &[u8], values: &mut [u32]) {
        match self {
            Self::None => {
                for (value, bytes) in values.iter_mut().zip(bytes.as_chunks().0) {
                    *value = u32::from_le_bytes(*bytes);
                }
            }
            Self::Shuffle => {
                values.fill(0);
                for (plane, significance) in bytes.chunks_exact(values.len()).zip(0..) {
                    for (byte, value) in plane.iter().zip(values.iter_mut()) {
                        *value |= u32::from(*byte) << (8 * significance);
                    }
                }
            }
            Self::LorenzoShuffle | Self::LorenzoShiftShuffle => {
                planes::join(bytes, shift.into(), values);
                planes::unpredict(values, SIDE, 0);
            }
        }
    }
}
