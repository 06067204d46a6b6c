//! One decoder per format; each gives a [`Source`].

mod flat;
mod hgt;
mod npy;
pub(crate) mod png;
mod raw;
mod tiff;

use crate::error::Result;
use crate::format::Format;
use crate::options::ImportOptions;
use crate::place::Place;
use crate::source::Source;

/// Opens a file as its format. Declared sizes are checked before anything is allocated for them.
pub(crate) fn open(place: &Place, options: &ImportOptions) -> Result<Source> {
    match place.format {
        Format::Png => png::open(place, options),
        Format::R16 | Format::Raw | Format::R32 => raw::open(place, options),
        Format::Tiff => tiff::open(place, options),
        Format::Hgt => hgt::open(place, options),
        Format::Npy => npy::open(place, options),
        Format::Exr => Err(place.unsupported("it is read as the bitmap of a brush, not as heights")),
    }
}
