//! Where the points of a stroke come from: all at once from a recipe, or one after another from a hand that is watched.

use orogeny_brush::Executor;
use orogeny_field::{FieldId, PointerSample, SampleRect};

use crate::pages::RecordedPages;
use crate::{Error, Result};

/// Whoever draws a stroke.
pub(crate) trait Hand {
    /// The next points; `None` when there are no more.
    ///
    /// # Errors
    /// [`Error::Cancelled`]: the stroke is to be taken back.
    fn next_points(&mut self, so_far: &mut SoFar<'_, '_, '_>) -> Result<Option<Vec<PointerSample>>>;

    /// All of the points so far were lost, and are to be given again.
    fn begin_again(&mut self) {}
}

/// What a stroke has come to so far.
pub(crate) struct SoFar<'a, 'pages, 'recorder> {
    pub(crate) executor: &'a mut dyn Executor,
    pub(crate) pages: &'a mut RecordedPages<'pages, 'recorder>,
    /// The field that is painted.
    pub(crate) field: FieldId,
    /// Samples that may have changed since this was last asked for.
    pub(crate) changed: SampleRect,
}

/// A stroke whose points are all known.
pub(crate) struct Known(pub(crate) Option<Vec<PointerSample>>);

impl Hand for Known {
    fn next_points(&mut self, _so_far: &mut SoFar<'_, '_, '_>) -> Result<Option<Vec<PointerSample>>> {
        Ok(self.0.take())
    }
}

/// A stroke that ended without a point, or grew beyond what one may have.
pub(crate) fn check_num_points(num_points: usize) -> Result<()> {
    let limit = orogeny_field::MAX_STROKE_POINTS;
    match num_points {
        0 => Err(Error::Field(orogeny_field::Error::EmptyStroke)),
        _ if num_points > limit => {
            Err(Error::Field(orogeny_field::Error::TooManyPoints { num_points, limit }))
        }
        _ => Ok(()),
    }
}
