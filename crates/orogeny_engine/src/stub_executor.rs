//! For tests: an executor that carries out nothing, but does what a test says with the first batch.

use orogeny_brush::{Batch, Executor, Notices, PageMemory, Result, Watch};
use orogeny_field::PageKey;
use orogeny_pages::PageStore;

use crate::Operation;

/// Calls what it holds for each batch.
pub(crate) struct StubExecutor<F>(pub(crate) F);

impl<F: FnMut() -> Result<()> + Send> Executor for StubExecutor<F> {
    fn description(&self) -> String {
        "an executor that carries out nothing".to_owned()
    }

    fn run_watched(&mut self, _batch: &Batch, _store: &mut dyn PageStore, _watch: Watch<'_>) -> Result<()> {
        (self.0)()
    }

    fn save(&mut self, _store: &mut dyn PageStore) -> Result<()> {
        Ok(())
    }

    fn finish(&mut self, _store: &mut dyn PageStore) -> Result<Notices> {
        Ok(Notices::default())
    }

    fn cancel(&mut self) {}

    fn forget(&mut self, _keys: &[PageKey]) {}

    fn memory(&self) -> PageMemory {
        PageMemory::default()
    }
}

/// A stroke that raises the ground at 8 m, 8 m by a metre.
pub(crate) fn dab() -> Operation {
    let text =
        r#"{"op": "stroke", "brush": {"type": "raise", "radius": 4, "strength": 1}, "points": [[8, 8]]}"#;
    Operation::from_json_text(text).unwrap()
}
