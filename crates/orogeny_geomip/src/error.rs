//! What can be wrong with a description of materials.

/// The result of a check.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// A value that cannot be used, with its limit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A surface that does not ship with the program.
    #[error("there is no surface `{name}`: the surfaces are {known}")]
    UnknownSurface {
        /// What was asked for.
        name: String,
        /// The ones there are.
        known: String,
    },
    /// A size that a surface's texture cannot have.
    #[error("a surface of {size} x {size} texels cannot be made: give a power of two from {min} to {max}")]
    SurfaceSize {
        /// What was given.
        size: u32,
        /// The smallest.
        min: u32,
        /// The largest.
        max: u32,
    },
}
