//! The weights of a whole stroke. The kernel's uniforms are those of a brush and of a plane.

/// The shader's stem.
pub const STEM: &str = "field/weights";
