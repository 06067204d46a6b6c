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
    /// Text that is no set of materials.
    #[error("the material set cannot be read: {reason}")]
    MaterialJson {
        /// What is wrong with it, and in which line.
        reason: String,
    },
    /// A set of no layers, or of too many.
    #[error("a material set of {num_layers} layers cannot be used: give 1 to {limit}")]
    MaterialLayers {
        /// How many it has.
        num_layers: usize,
        /// The most.
        limit: usize,
    },
    /// A value of a set, or of one of its layers.
    #[error("`{field}` of {of} cannot be {value}: {limit}")]
    MaterialValue {
        /// Whose: the set's, or a layer's by its place and name.
        of: String,
        /// Which.
        field: String,
        /// What it is.
        value: String,
        /// What is allowed, or what to do.
        limit: String,
    },
    /// Heights between which no terrain lies.
    #[error("heights from {low_m} m to {high_m} m are no range: give two finite numbers, the lower first")]
    HeightRange {
        /// The lower limit.
        low_m: f32,
        /// The upper one.
        high_m: f32,
    },
    /// A set that does not ship with the program.
    #[error("there is no factory set `{name}`: the sets are {known}")]
    UnknownFactorySet {
        /// What was asked for.
        name: String,
        /// The ones there are.
        known: String,
    },
}
