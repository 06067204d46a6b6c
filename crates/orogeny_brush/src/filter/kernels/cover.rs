//! Where there is another ground. Its uniform is [`Part`] itself.

use orogeny_field::{Part, Placement, SampleRect};

use super::places;
use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/cover";

pub(super) fn data(placement: &Placement, part: &Part, has_selection: bool, rect: &SampleRect) -> OwnData {
    let mut data = OwnData::uniform(part).with_constants(&[("HAS_SELECTION", u32::from(has_selection))]);
    data.storage = places(placement, rect);
    data
}
