//! What carries out batches.

use orogeny_field::{FieldId, HeightBounds, PageKey, Plane, SampleRect, TerrainGrid};
use orogeny_gpu::{DevicePlane, Gpu};
use orogeny_pages::PageStore;

use crate::Result;
use crate::plan::Batch;

/// What an operation met on its way, counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Notices {
    /// Heights that would have left what a terrain holds, and were clamped.
    pub num_clamped_heights: u64,
}

/// What an executor keeps pages in, counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct PageMemory {
    /// Bytes of memory.
    pub host_in_bytes: u64,
    /// Bytes of textures.
    pub textures_in_bytes: u64,
}

/// A field on some of its levels, as it is now.
#[derive(Debug, Clone, PartialEq)]
pub struct Levels {
    /// From full resolution on; `None` for a level that was not asked for.
    pub planes: Vec<Option<DevicePlane>>,
    /// What all of their heights lie within.
    pub bounds: HeightBounds,
}

/// Is told which share of something, 0..1, is done, and says whether to go on.
pub type Watch<'a> = &'a mut dyn FnMut(f64) -> bool;

/// Applies batches to pages. One operation at a time: batches of one stroke or fill in order, then [`finish`](Self::finish)
/// or [`cancel`](Self::cancel).
///
/// Pages stay resident from one operation to the next. Whoever changes them elsewhere (an undo) says so with
/// [`forget`](Self::forget).
pub trait Executor: Send {
    /// What carries out the work, for people.
    fn description(&self) -> String;

    /// Applies one batch. Pages that have to make room are saved to `store`.
    ///
    /// # Errors
    /// [`crate::Error::Pages`] when pages cannot be had or saved, [`crate::Error::Gpu`] when the GPU fails. The operation
    /// is then to be cancelled.
    fn run(&mut self, batch: &Batch, store: &mut dyn PageStore) -> Result<()> {
        self.run_watched(batch, store, &mut |_| true)
    }

    /// The same with a look now and then, where a batch takes long, at whether to go on.
    ///
    /// # Errors
    /// As [`run`](Self::run); [`crate::Error::Interrupted`] where it is not to go on.
    fn run_watched(&mut self, batch: &Batch, store: &mut dyn PageStore, watch: Watch<'_>) -> Result<()>;

    /// What a batch makes of a rectangle of ground in memory, which with all other fields that it looks at is among `fields`, as far
    /// as it looks. Nothing becomes resident, no operation is begun, and nothing is noticed. `None` where this back end can only do it over pages.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    fn run_over_planes(
        &mut self,
        batch: &Batch,
        fields: &[(FieldId, &Plane)],
        rect: SampleRect,
    ) -> Result<Option<Plane>> {
        _ = (batch, fields, rect);
        Ok(None)
    }

    /// A plane whose values are to be written: of memory that was [given back](Self::give_back), where there is any.
    fn plane(&mut self, rect: SampleRect) -> Plane {
        Plane::constant(rect, 0.0)
    }

    /// Takes the memory of a plane that is no longer needed, and keeps it as far as its budget goes.
    fn give_back(&mut self, plane: Plane) {
        drop(plane);
    }

    /// Saves what the operation has changed so far, to be looked at, and lets it go on.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    fn save(&mut self, store: &mut dyn PageStore) -> Result<()>;

    /// Ends the operation: all that it changed is saved to `store`. Only after this has returned may the operation be
    /// acknowledged.
    ///
    /// # Errors
    /// As [`run`](Self::run); nothing of the operation counts as done then.
    fn finish(&mut self, store: &mut dyn PageStore) -> Result<Notices>;

    /// Drops the operation, and with it everything that is resident: after a failure, or when what was saved could not be
    /// made durable.
    fn cancel(&mut self);

    /// Forgets pages that were changed elsewhere.
    fn forget(&mut self, keys: &[PageKey]);

    /// The device that pages are resident on, if they are on one.
    fn device(&self) -> Option<&Gpu> {
        None
    }

    /// What a field has come to, level by level from full resolution on: of each level all of the rectangle that is `wanted` of it, in its
    /// samples. The heights stay on the device. `None` where they do not lie on one, where hardly any of them do, or where that is too much at once.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    fn levels(
        &mut self,
        field: FieldId,
        grid: &TerrainGrid,
        wanted: &[SampleRect],
        store: &mut dyn PageStore,
    ) -> Result<Option<Levels>> {
        _ = (field, grid, wanted, store);
        Ok(None)
    }

    /// What its pages take now.
    fn memory(&self) -> PageMemory;
}
