//! Erosion by running water. Its uniform is [`orogeny_field::PipesKernel`] itself.

/// The shader's stem.
pub const STEM: &str = "field/pipes";
