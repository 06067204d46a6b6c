//! Why a brush cannot be applied.

/// The result of planning or applying a brush.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// A brush that cannot be applied; nothing was changed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A value that cannot be used.
    #[error(transparent)]
    Field(#[from] orogeny_field::Error),
    /// Pages could not be had, kept or given back.
    #[error(transparent)]
    Pages(#[from] orogeny_pages::Error),
    /// A stroke so long, or spaced so closely, that it would not end. Use a larger radius or spacing, or cut it.
    #[error(
        "the stroke has over {limit} instances, {spacing_m} m apart; use a larger radius or spacing, or cut it"
    )]
    TooManyInstances {
        /// The limit.
        limit: u32,
        /// Metres between instances.
        spacing_m: f64,
    },
    /// More pages than one operation may change. Use a smaller radius or region.
    #[error(
        "it would change {num_pages} pages of the terrain at once, the limit is {limit}; use a smaller radius or region"
    )]
    TooManyPages {
        /// Pages that it would change.
        num_pages: u64,
        /// The limit.
        limit: u64,
    },
    /// What a filter looks at at once is more than a buffer of the GPU holds. Use a smaller width or fewer levels, or the CPU
    /// back end.
    #[error(
        "a filter looks at {width} x {depth} samples at once, and a buffer of the GPU holds {limit_in_bytes} bytes; use a smaller width or fewer levels, or `--adapter cpu`"
    )]
    PlaneSize {
        /// Samples along x.
        width: u32,
        /// Samples along z.
        depth: u32,
        /// The limit.
        limit_in_bytes: u64,
    },
    /// A region of more samples than are worked on at once. Use a smaller region, or a shorter stroke.
    #[error(
        "`{brush}` works on all of its region at once, and {width} x {depth} are {num_samples} samples, the limit is {limit}; give a smaller `region`, or use a shorter stroke"
    )]
    RegionSize {
        /// The brush's type.
        brush: &'static str,
        /// Samples along x.
        width: u32,
        /// Samples along z.
        depth: u32,
        /// Of both.
        num_samples: u64,
        /// The limit.
        limit: u64,
    },
    /// A clone that looks at more samples for a page than are worked on at once. Use fewer levels, or a larger scale.
    #[error(
        "what is cloned is made of {num_samples} samples at once, the limit is {limit}; use fewer `levels`, or a larger `scale`"
    )]
    CloneSize {
        /// Samples that it would look at.
        num_samples: u64,
        /// The limit.
        limit: u64,
    },
    /// Whoever watched the work said not to go on.
    #[error("it was interrupted")]
    Interrupted,
    /// The GPU failed.
    #[error(transparent)]
    Gpu(#[from] orogeny_gpu::Error),
    /// A user's kernel, which has no twin on the CPU. Choose a GPU or the software adapter.
    #[error(
        "a custom brush is a GPU kernel and cannot run on the CPU back end: use `--adapter software`, or a GPU"
    )]
    NeedsGpu,
    /// A wash could not put weights aside in the folder for temporary files. Free space there, or raise the page budget.
    #[error(
        "the temporary file of a stroke could not be used: {source}; free space, or raise the page budget"
    )]
    Spill {
        /// What the system said.
        source: std::io::Error,
    },
    /// The worker threads could not be started.
    #[error("the worker threads could not be started: {reason}")]
    Threads {
        /// What the system said.
        reason: String,
    },
    /// Work was given to an executor that does not fit what it was made for: a bug in the caller.
    #[error("the executor was made for pages of {expected} samples a side and got one of {actual}")]
    PageSize {
        /// What it was made for.
        expected: u32,
        /// What it got.
        actual: u32,
    },
}

impl Error {
    /// The GPU's error, if it is one: the executor is of no use then.
    #[must_use]
    pub const fn gpu(&self) -> Option<&orogeny_gpu::Error> {
        match self {
            Self::Gpu(err) | Self::Pages(orogeny_pages::Error::Gpu(err)) => Some(err),
            _ => None,
        }
    }

    /// Whether the GPU device is gone, so that the same work can be done again on a new one.
    #[must_use]
    pub const fn is_device_lost(&self) -> bool {
        matches!(self.gpu(), Some(orogeny_gpu::Error::DeviceLost { .. }))
    }
}
