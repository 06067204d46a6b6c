//! How much a whole stroke takes of what is made, as data: a mask that is yet to be worked out.

use std::sync::Arc;

use orogeny_field::{Footprint, Instance, Page, SampleRect};
use orogeny_pages::PageStore;

use crate::Result;
use crate::gate::GatePlan;

/// The one weight of a wash stroke, 0..1 at each sample: the largest of all instances, times what a gate lets through.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// How instances cover samples.
    pub footprint: Footprint,
    /// In stroke order.
    pub instances: Vec<Instance>,
    /// The samples that each may reach; same order.
    pub bounds: Vec<SampleRect>,
    /// Where it may act.
    pub gate: Option<Arc<GatePlan>>,
}

impl Weights {
    /// The samples beyond which all weights are 0.
    #[must_use]
    pub fn rect(&self) -> SampleRect {
        self.bounds.iter().fold(SampleRect::EMPTY, |all, bound| all.bounds_with(bound))
    }

    /// What the gate lets through on the pages of a rectangle that any instance may reach; none where there is no gate.
    ///
    /// # Errors
    /// [`crate::Error::Pages`] when what the gate looks at cannot be read.
    pub(crate) fn pages_let_through(
        &self,
        rect: &SampleRect,
        store: &mut dyn PageStore,
    ) -> Result<Vec<(SampleRect, Page)>> {
        match &self.gate {
            Some(gate) => gate.pages(&rect.intersection(&self.rect()), store),
            None => Ok(Vec::new()),
        }
    }
}
