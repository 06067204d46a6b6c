//! Selections, planes of values 0..1: outlines, growing and shrinking, soft edges.
//!
//! What is grown has at each sample the largest value no further away than the radius, what is shrunk the smallest: the grey-scale
//! dilation and erosion by a disc. So each contour moves by the radius, and not only that at a half: a hard edge stays
//! hard, and a soft one as wide as it was. A distance from the contour at a half would know of no other, and leave each edge one
//! sample wide. To shrink what is selected is to grow what is not; and since only what lies within the radius counts, a part of a
//! plane has the bits of the whole.
//!
//! Nothing here knows of a border: whoever calls it gives the samples beyond, and gets back a plane that is smaller by as many.

pub mod combine;
pub mod feather;
pub mod grow;
pub mod lasso;

/// Places this near to a whole sample, in samples, lie on it, as in [`orogeny_field::TerrainGrid::samples_in_region`].
const ON_A_SAMPLE: f64 = 1.0e-6;
