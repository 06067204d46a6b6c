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
}

impl Filter {
    /// Fills `bytes`, which is 4 x as long as `values`.
    pub fn apply(self, values: &[u32], residuals: &mut [u32], bytes: &mut [u8]) {
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
        }
    }

    /// The inverse of [`Self::apply`].
    pub fn undo(self, bytes: &[u8], values: &mut [u32]) {
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
            Self::LorenzoShuffle => {
                planes::join(bytes, 0, values);
                planes::unpredict(values, SIDE, 0);
            }
        }
    }
}
