//! Why something could not be done with a terrain.

use std::path::PathBuf;

/// The result of working with a terrain.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What went wrong. Unless a variant says otherwise, the terrain is as it was.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A value that cannot be used.
    #[error(transparent)]
    Field(#[from] orogeny_field::Error),
    /// A brush could not be applied.
    #[error(transparent)]
    Brush(#[from] orogeny_brush::Error),
    /// The terrain file could not be read or changed.
    #[error(transparent)]
    Store(#[from] orogeny_store::Error),
    /// A file of another program could not be read or written.
    #[error(transparent)]
    Format(#[from] orogeny_formats::Error),
    /// A custom brush does not compile. Mend what is named at its line.
    #[error(transparent)]
    Shader(#[from] orogeny_shaders::Error),
    /// A file that is longer than what it is for takes.
    #[error("`{}` is longer than {limit} bytes, the most that is read of such a file", path.display())]
    TooLong {
        /// The file.
        path: PathBuf,
        /// The limit.
        limit: u64,
    },
    /// The system gave no thread, or one ended early. Close other programs, or start this one again: what was done is on disk.
    #[error("a thread could not do its work: {detail}; close other programs, or start this one again")]
    Thread {
        /// What it said.
        detail: String,
    },
    /// The GPU could not be used.
    #[error(transparent)]
    Gpu(#[from] orogeny_gpu::Error),
    /// A recipe or operation that cannot be understood. Mend what is named.
    #[error("{place} cannot be understood: {detail}")]
    Operation {
        /// Which one.
        place: String,
        /// What is wrong with it.
        detail: String,
    },
    /// An operation of a recipe failed; none of the recipe was done.
    #[error("operation {number} of {count} ({name}) failed, none was done: {source}")]
    InRecipe {
        /// Which one, from 1.
        number: usize,
        /// How many there are.
        count: usize,
        /// Its `op`.
        name: &'static str,
        /// Why.
        source: Box<Error>,
    },
    /// A material set that cannot be used, or a size or name that none has.
    #[error(transparent)]
    Material(#[from] orogeny_geomip::Error),
    /// A file that is no material set. Mend what is named.
    #[error("`{}`: {source}", path.display())]
    MaterialFile {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<orogeny_geomip::Error>,
    },
    /// A picture that no texture can be made from.
    #[error("`{}` is no PNG that a texture can be made from: {detail}", path.display())]
    Texture {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        detail: String,
    },
    /// There is neither a GPU nor a software driver. Install one, or draw a map, which needs none.
    #[error(
        "there is no GPU and no software driver that could draw (found: {found}); install Mesa's driver (Debian and Ubuntu: `sudo apt-get \
         install -y libvulkan1 mesa-vulkan-drivers`), or draw a map by `--map`, which needs none"
    )]
    NothingDraws {
        /// The names of the adapters there are.
        found: String,
    },
    /// A window that cannot be drawn in. Install a driver for the system's screen, or work by the other commands.
    #[error(
        "the window cannot be drawn in: {detail}; install the system's graphics driver, or work without a window"
    )]
    NoSurface {
        /// What the driver said.
        detail: String,
    },
    /// A mask that the terrain does not have.
    #[error("there is no mask `{name}`; there are those of the layers {known}")]
    UnknownMask {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// A picture of the difference to nothing. Say to what.
    #[error(
        "there is nothing to show the difference to: name an entry of the history by `--since`; `log` lists those there are"
    )]
    NothingToCompare,
    /// A number of a picture that is out of its range.
    #[error("{what} is {value}; it may be {low} to {high}")]
    View {
        /// Which one.
        what: &'static str,
        /// What it was.
        value: f64,
        /// The least.
        low: f64,
        /// The most.
        high: f64,
    },
    /// There is no such layer.
    #[error("there is no layer {layer}; the terrain has {known}")]
    UnknownLayer {
        /// What was asked for.
        layer: String,
        /// The ones there are.
        known: String,
    },
    /// A name that another layer has. Give another one.
    #[error("there is a layer `{name}` already: no two layers of a terrain have the same name")]
    LayerNameTaken {
        /// The name.
        name: String,
    },
    /// A layer that is protected, or in a group that is.
    #[error("the layer `{name}` is locked: unlock it by `set_layer` with `locked` false")]
    LayerLocked {
        /// The layer, or the group, that is locked.
        name: String,
    },
    /// Something that cannot be done with a layer, for what it is.
    #[error("the layer `{name}` cannot be {done}: {why}")]
    LayerRefused {
        /// Which layer.
        name: String,
        /// What was to be done.
        done: &'static str,
        /// Why not, and what to do.
        why: String,
    },
    /// An opacity, or a share of a mask, that is none.
    #[error("`{field}` = {value} of the layer `{name}` cannot be used: it must be within 0 to 1")]
    LayerShare {
        /// Which layer.
        name: String,
        /// Which number.
        field: &'static str,
        /// What was given.
        value: f32,
    },
    /// More layers than a terrain has.
    #[error("the terrain has {limit} layers, the most there may be: collapse or remove some")]
    TooManyLayers {
        /// The limit.
        limit: usize,
    },
    /// A region, picture or raster that does not touch the terrain.
    #[error("{what} lies outside the terrain, which covers {width_m} x {depth_m} m")]
    OutsideTerrain {
        /// What.
        what: String,
        /// The terrain's extent along x, metres.
        width_m: f64,
        /// The terrain's extent along z, metres.
        depth_m: f64,
    },
    /// Ground that cannot be cloned.
    #[error("`{}` cannot be cloned: {detail}", path.display())]
    CloneSource {
        /// The file.
        path: PathBuf,
        /// Why not, and what to do.
        detail: String,
    },
    /// A raster whose samples lie at another distance than the terrain's.
    #[error(
        "`{}` has a sample every {raster_m} m, the terrain every {terrain_m} m; to take its samples one for one, give \
         the spacing {terrain_m}", path.display()
    )]
    SpacingDiffers {
        /// The raster.
        path: PathBuf,
        /// Its spacing in metres.
        raster_m: f64,
        /// The terrain's spacing in metres.
        terrain_m: f64,
    },
    /// A picture of no pixels, or of too many.
    #[error("a picture of {width} x {height} pixels cannot be made: each side takes 1 to {limit}")]
    PictureSize {
        /// Pixels along x.
        width: u32,
        /// Pixels along z.
        height: u32,
        /// The longest side.
        limit: u32,
    },
    /// What the history says cannot be done again.
    #[error("the history cannot be replayed{}: {detail}", at_entry(*entry))]
    CannotReplay {
        /// The operation; 0: all of it.
        entry: u32,
        /// Why.
        detail: String,
    },
    /// A file that an operation of someone else may not read. Give one in the folder that is open to it.
    #[error(
        "the file `{file}` is not among those that may be read here: give the name of one below the folder of shared files"
    )]
    FileNotAllowed {
        /// What was named.
        file: String,
    },
    /// An operation that cannot be taken back from under those that were done since. Undo those first.
    #[error("entry {entry} cannot be taken back: {detail}")]
    CannotTakeBack {
        /// The operation.
        entry: u32,
        /// Why, with the operations that are in the way.
        detail: String,
    },
    /// A level that the terrain does not have.
    #[error("there is no level {level}: the coarsest is {top}")]
    UnknownLevel {
        /// What was asked for.
        level: u8,
        /// The last one.
        top: u8,
    },
    /// A preset, or a name for one, that cannot be used. Mend what is named.
    #[error("{place} cannot be used: {detail}")]
    Preset {
        /// Which one, or its file.
        place: String,
        /// What is wrong with it.
        detail: String,
    },
    /// There is no such preset.
    #[error("there is no preset `{name}`; {advice}")]
    UnknownPreset {
        /// What was asked for.
        name: String,
        /// Names that could have been meant.
        advice: String,
    },
    /// There is a preset of that name, and nothing was said of replacing it.
    #[error(
        "there is a preset of the name `{name}` already, `{}`: give another name, or ask for it to be replaced",
        path.display()
    )]
    PresetExists {
        /// The name.
        name: String,
        /// Its file.
        path: PathBuf,
    },
    /// What comes with the program cannot be removed.
    #[error(
        "the preset `{name}` comes with the program and cannot be removed; one of yours with the same name stands in for it"
    )]
    FactoryPreset {
        /// The name.
        name: String,
    },
    /// The system names no folder for data.
    #[error("there is no folder for presets: name one with `--presets` or in `OROGENY_PRESETS`")]
    NoPresetFolder,
    /// A picture could not be coded.
    #[error("the picture could not be coded as PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// A file could not be read.
    #[error("`{}` could not be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file could not be written, or removed.
    #[error("`{}` could not be written: {source}", path.display())]
    Write {
        /// Where to.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The user cancelled.
    #[error("cancelled; nothing was changed")]
    Cancelled,
}

fn at_entry(entry: u32) -> String {
    if entry == 0 { String::new() } else { format!(" at entry {entry}") }
}

impl Error {
    /// The GPU's error, if it is one: what works on it is then of no more use.
    pub(crate) fn gpu(&self) -> Option<&orogeny_gpu::Error> {
        match self {
            Self::Brush(err) => err.gpu(),
            Self::Gpu(err) => Some(err),
            Self::InRecipe { source, .. } => source.gpu(),
            _ => None,
        }
    }

    /// Whether the machine is to blame, and not what was asked for.
    #[must_use]
    pub fn is_fault(&self) -> bool {
        match self {
            Self::InRecipe { source, .. } => source.is_fault(),
            Self::Store(err) => !err.is_refusal(),
            Self::Thread { .. } | Self::Gpu(_) | Self::NothingDraws { .. } | Self::Write { .. } => true,
            Self::Brush(err) => err.gpu().is_some(),
            _ => false,
        }
    }
}
