//! The next level of a field. It has no uniform of its own.

/// The shader's stem.
pub const STEM: &str = "field/coarsen";
