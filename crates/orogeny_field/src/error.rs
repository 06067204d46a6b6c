//! What can be wrong with a value before any work is done on it.

/// The result of a check.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// A value that cannot be used, with its limit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A selection of no shape, or of several.
    #[error(
        "the `shape` of a selection is one of `all`, `nothing`, `keep`, `rectangle`, `lasso`, `gate` and `mask`, alone"
    )]
    SelectShape,
    /// A field of a selection whose value cannot be used.
    #[error("`{field}` = {value} of a selection cannot be used: {limit}")]
    SelectValue {
        /// Which one; one within the shape as in `shape.region`.
        field: String,
        /// What was given.
        value: String,
        /// What is allowed.
        limit: String,
    },
    /// A terrain of no samples, or of too many. Choose a size within the limit.
    #[error("a terrain of {width} x {depth} samples cannot be made: each side takes 1 to {limit} samples")]
    TerrainSize {
        /// Samples along x.
        width: u64,
        /// Samples along z.
        depth: u64,
        /// The longest side.
        limit: u32,
    },
    /// A sample spacing that is not a usable number of metres.
    #[error("a sample spacing of {spacing_m} m cannot be used: give {min_m} to {max_m} m")]
    Spacing {
        /// What was given.
        spacing_m: f64,
        /// The finest.
        min_m: f64,
        /// The coarsest.
        max_m: f64,
    },
    /// A page size that the atlas cannot hold.
    #[error("a page of {size} x {size} samples cannot be used: give a power of two from {min} to {max}")]
    PageSize {
        /// What was given.
        size: u32,
        /// The smallest.
        min: u32,
        /// The largest.
        max: u32,
    },
    /// A page built from the wrong number of samples.
    #[error("a page of {size} x {size} samples needs {expected} heights, {actual} were given")]
    PageLength {
        /// Samples a side.
        size: u32,
        /// `size * size`.
        expected: usize,
        /// What was given.
        actual: usize,
    },
    /// A plane built from the wrong number of values.
    #[error(
        "a plane of {width} x {depth} samples with {num_channels} values each needs {expected}, {actual} were given"
    )]
    PlaneLength {
        /// Samples along x.
        width: u32,
        /// Samples along z.
        depth: u32,
        /// Values a sample.
        num_channels: u32,
        /// How many it needs.
        expected: usize,
        /// What was given.
        actual: usize,
    },
    /// A height that is NaN, infinite or beyond what a terrain holds.
    #[error("the height {height_m} of {what} cannot be stored: heights are finite and within ±{limit_m} m")]
    Height {
        /// What it was the height of.
        what: String,
        /// The height, in metres.
        height_m: f32,
        /// [`crate::MAX_HEIGHT_M`].
        limit_m: f32,
    },
    /// A region whose numbers are not a rectangle.
    #[error(
        "the region [{x_m}, {z_m}, {width_m}, {depth_m}] is no rectangle: all four must be finite, width and depth above 0"
    )]
    Region {
        /// West edge, metres.
        x_m: f64,
        /// North edge, metres.
        z_m: f64,
        /// Extent along x, metres.
        width_m: f64,
        /// Extent along z, metres.
        depth_m: f64,
    },
    /// A stroke point that is not a place, or one absurdly far away.
    #[error("stroke point {index} ({what} = {value}) cannot be used: {limit}")]
    Point {
        /// Which point, from 0.
        index: usize,
        /// Which of its values.
        what: &'static str,
        /// The value.
        value: f64,
        /// What is allowed.
        limit: String,
    },
    /// A stroke with no points.
    #[error("the stroke has no points: give at least one [x, z]")]
    EmptyStroke,
    /// A stroke of more points than one stroke takes. Cut it.
    #[error("the stroke has {num_points} points, the limit is {limit}; cut it into several")]
    TooManyPoints {
        /// How many it has.
        num_points: usize,
        /// The limit.
        limit: usize,
    },
    /// A brush type that does not exist.
    #[error("there is no brush type `{name}`: {known}")]
    BrushType {
        /// What was asked for.
        name: String,
        /// The ones there are.
        known: String,
    },
    /// A field that the brush does not have.
    #[error("the brush `{brush}` has no field `{field}`: {known}")]
    BrushField {
        /// The brush's type.
        brush: &'static str,
        /// What was given.
        field: String,
        /// The ones it has.
        known: String,
    },
    /// A field that the brush needs and was not given.
    #[error("the brush `{brush}` needs `{field}`: {why}")]
    MissingField {
        /// The brush's type.
        brush: &'static str,
        /// The field to give.
        field: &'static str,
        /// When it is needed.
        why: &'static str,
    },
    /// A field whose value the brush cannot use.
    #[error("`{field}` = {value} of the brush `{brush}` cannot be used: {limit}")]
    BrushValue {
        /// The brush's type.
        brush: &'static str,
        /// Which field; one within an object with that object's name before it, as in `distortion.octaves`.
        field: String,
        /// Its value, as it was written.
        value: String,
        /// What is allowed.
        limit: String,
    },
    /// Control points that make no curve.
    #[error("{what} is no curve: {reason}")]
    Curve {
        /// Which one.
        what: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A noise whose features are too small for the terrain's samples to show.
    #[error(
        "a `feature_size` of {feature_size_m} m cannot be seen on samples {spacing_m} m apart: give {limit_m} m or more"
    )]
    FeatureSize {
        /// Metres of the first octave's cell.
        feature_size_m: f64,
        /// Metres between samples.
        spacing_m: f64,
        /// Two samples.
        limit_m: f64,
    },
    /// A picture that is none.
    #[error("a bitmap of {width} x {height} pixels cannot be used: {reason}")]
    Bitmap {
        /// Pixels along x.
        width: u32,
        /// Pixels from top to bottom.
        height: u32,
        /// What is wrong with it.
        reason: String,
    },
    /// A brush that no layer can be made of.
    #[error("no {content} layer can be made of the brush `{brush}`: {why}")]
    LayerBrush {
        /// The brush's type.
        brush: &'static str,
        /// What the layer was to be: `procedural` or `effect`.
        content: &'static str,
        /// Why not, and what to do.
        why: &'static str,
    },
    /// A number of a layer, or of its mask, that is out of its range.
    #[error("`{field}` = {value} of a layer cannot be used: it must be within {low} to {high}")]
    LayerValue {
        /// Which one.
        field: &'static str,
        /// What was given.
        value: f64,
        /// The least.
        low: f64,
        /// The most.
        high: f64,
    },
    /// A term of a mask between two heights that are one.
    #[error("`low` and `high` of a mask's term are both {low} m: they must differ")]
    LayerRange {
        /// Both, in metres.
        low: f64,
    },
    /// A term of a mask that is worked out from nothing, or from several things.
    #[error("a term of a mask has one of `gate`, `heights` and `mask`")]
    MaskSource,
}
