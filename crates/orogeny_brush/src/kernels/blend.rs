//! Smooth, sharpen, smear, grab, clone, erosion, filled pits, masks of flow: all that pulls the ground to what a filter made of it. Its uniform says where that lies:
//! [`PlaneUniform`](crate::filter::kernels::PlaneUniform).

/// The shader's stem.
pub const STEM: &str = "brush/blend";
