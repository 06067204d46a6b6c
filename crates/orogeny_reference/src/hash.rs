//! The integer hash behind everything random. Planning draws from it too, so it lives with the vocabulary.

pub use orogeny_field::hash::{bits_to_signed, hash, signed_uniform, uniform};
