//! What can go wrong on a GPU.

/// The result of GPU work.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// A failure of the GPU, its driver or the work given to it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no such adapter. Choose one that `doctor` lists, install a driver, or use the CPU back end.
    #[error("there is no {wanted} (found: {found}); {remedy}")]
    NoAdapter {
        /// What was asked for.
        wanted: String,
        /// The names of those there are.
        found: String,
        /// What to do.
        remedy: String,
    },
    /// The adapter does not give what the kernels need.
    #[error("the adapter {adapter} cannot be used: {reason}")]
    Unusable {
        /// Its name.
        adapter: String,
        /// What is missing.
        reason: String,
    },
    /// The device is gone: unplugged, reset by its driver, or destroyed. Nothing since the last check counts as done.
    #[error("the GPU device {adapter} was lost ({reason}); what was being done is undone")]
    DeviceLost {
        /// Its name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// No memory left for a buffer or texture. Lower the budget.
    #[error("the GPU is out of memory while making {what} of {size_in_bytes} bytes; lower the page budget")]
    OutOfMemory {
        /// What was being made.
        what: String,
        /// How large it was to be.
        size_in_bytes: u64,
    },
    /// The driver refused what it was told: a bug in Orogeny or in the driver.
    #[error("the GPU refused its work, which is a bug: {messages}")]
    Validation {
        /// What it said.
        messages: String,
    },
    /// The GPU did not finish in time: a hung driver or a runaway kernel.
    #[error("the GPU did not finish within {timeout_s} s")]
    Timeout {
        /// How long it was waited for.
        timeout_s: f32,
    },
    /// A kernel that was not embedded.
    #[error("there is no kernel `{stem}`")]
    NoKernel {
        /// Its stem, as `brush/raise`.
        stem: String,
    },
}
