//! What can go wrong between a page and the one who needs it.

/// An error of whatever stands behind a [`crate::PageStore`].
pub type BoxError = Box<dyn std::error::Error + Send + Sync>;

/// The result of working with pages.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// A page that cannot be had or kept.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// What stands behind the pages failed; nothing was changed there.
    #[error(transparent)]
    Source(BoxError),
    /// The budget does not hold the pages that one step of work needs at once. Raise the budget.
    #[error("a budget of {budget_in_bytes} bytes holds {num_pages} pages, at least {needed} are needed")]
    Budget {
        /// The budget.
        budget_in_bytes: u64,
        /// Pages it holds.
        num_pages: u64,
        /// Pages that are needed at once.
        needed: u64,
    },
    /// The GPU failed.
    #[error(transparent)]
    Gpu(#[from] orogeny_gpu::Error),
}
