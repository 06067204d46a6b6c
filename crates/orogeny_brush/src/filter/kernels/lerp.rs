//! One plane pulled to another by a mask.

/// The shader's stem.
pub const STEM: &str = "field/lerp";
