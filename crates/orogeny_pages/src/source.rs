//! Where pages come from and go to.

use std::collections::HashMap;

use orogeny_field::{FieldId, Page, PageKey, PageLayout};

use crate::BoxError;

/// The pages of a terrain during one operation. A page that was never painted is absent and holds its field's constant.
pub trait PageStore {
    /// How planes are cut.
    fn layout(&self) -> PageLayout;

    /// The height where a field has no page, in metres.
    fn constant(&self, field: FieldId) -> f32;

    /// The page as it is now, with what the operation has saved so far.
    ///
    /// # Errors
    /// Whatever stands behind could not read it.
    fn load(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError>;

    /// The page as it was before the operation.
    ///
    /// # Errors
    /// Whatever stands behind could not read it.
    fn load_before(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError>;

    /// Takes changed pages.
    ///
    /// # Errors
    /// Whatever stands behind could not take them.
    fn save(&mut self, pages: Vec<(PageKey, Page)>) -> Result<(), BoxError>;
}

/// Pages in memory only: for programs that need no file, and for tests.
#[derive(Debug, Clone, Default)]
pub struct MemoryPages {
    layout: PageLayout,
    constant_m: f32,
    before: HashMap<PageKey, Page>,
    now: HashMap<PageKey, Page>,
    num_loads: u64,
}

impl MemoryPages {
    /// No pages; every height is `constant_m` metres.
    #[must_use]
    pub fn new(layout: PageLayout, constant_m: f32) -> Self {
        Self { layout, constant_m, ..Self::default() }
    }

    /// Makes the pages as they are now those from before the next operation.
    pub fn commit(&mut self) {
        self.before.clone_from(&self.now);
    }

    /// The pages that are there, in no order.
    #[must_use]
    pub const fn pages_unsorted(&self) -> &HashMap<PageKey, Page> {
        &self.now
    }

    /// How often a page was asked for.
    #[must_use]
    pub const fn num_loads(&self) -> u64 {
        self.num_loads
    }
}

impl PageStore for MemoryPages {
    fn layout(&self) -> PageLayout {
        self.layout
    }

    fn constant(&self, _field: FieldId) -> f32 {
        self.constant_m
    }

    fn load(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError> {
        self.num_loads += 1;
        Ok(self.now.get(key).cloned())
    }

    fn load_before(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError> {
        Ok(self.before.get(key).cloned())
    }

    fn save(&mut self, pages: Vec<(PageKey, Page)>) -> Result<(), BoxError> {
        self.now.extend(pages);
        Ok(())
    }
}
