//! The pages of a running transaction, as an executor sees them.

use std::collections::{BTreeSet, HashMap};

use orogeny_field::{FieldId, Page, PageKey, PageLayout};
use orogeny_pages::{BoxError, PageStore};
use orogeny_store::Transaction;

/// Pages of a transaction, with a note of those that were changed.
pub(crate) struct TransactionPages<'a, 'store> {
    transaction: &'a mut Transaction<'store>,
    layout: PageLayout,
    constants: HashMap<FieldId, f32>,
    saved: BTreeSet<PageKey>,
}

impl<'a, 'store> TransactionPages<'a, 'store> {
    pub(crate) fn new(transaction: &'a mut Transaction<'store>, layout: PageLayout) -> Self {
        let constants = transaction.layers().iter().map(|layer| (layer.heights, layer.constant_m)).collect();
        Self { transaction, layout, constants, saved: BTreeSet::new() }
    }

    /// How many pages were saved.
    pub(crate) fn num_saved(&self) -> usize {
        self.saved.len()
    }
}

impl PageStore for TransactionPages<'_, '_> {
    fn layout(&self) -> PageLayout {
        self.layout
    }

    fn constant(&self, field: FieldId) -> f32 {
        self.constants.get(&field).copied().unwrap_or_default()
    }

    fn load(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError> {
        Ok(self.transaction.load_page(key)?)
    }

    fn load_before(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError> {
        Ok(self.transaction.load_page_before(key)?)
    }

    fn save(&mut self, pages: Vec<(PageKey, Page)>) -> Result<(), BoxError> {
        self.transaction.write_pages(&pages)?;
        self.saved.extend(pages.iter().map(|(key, _)| *key));
        Ok(())
    }
}
