//! `presets`: brushes under names.

mod files;
mod list;
mod pictures;
mod show;

use std::path::PathBuf;

use anyhow::ensure;
use clap::{Args, Subcommand};

use crate::arguments::WrongUse;
use crate::session::Session;

/// What `presets` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(subcommand)]
    action: Option<Action>,
    /// Draw all of them, with their names, into this PNG
    #[arg(long, value_name = "FILE")]
    gallery: Option<PathBuf>,
    /// Pixels from one preset of the gallery to the next
    #[arg(long, value_name = "N", requires = "gallery", default_value_t = 160)]
    size: u32,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List them: name, brush, tags, what for, where from; so does no action at all
    List,
    /// Tell what one is, as its file holds it
    Show {
        /// Its name; capitals and punctuation do not matter
        name: String,
    },
    /// Write one to a file, with its picture, for others
    Export {
        /// Its name
        name: String,
        /// The JSON file to write
        file: PathBuf,
    },
    /// Take one from a file into your own
    Import {
        /// The JSON file
        file: PathBuf,
        /// Replace one of yours that has the same name
        #[arg(long)]
        replace: bool,
    },
    /// Save a brush under a name
    Save(files::Save),
    /// Remove one of yours
    Remove {
        /// Its name
        name: String,
    },
    /// Draw one
    Thumbnail {
        /// Its name
        name: String,
        /// The PNG to write
        file: PathBuf,
        /// Pixels along x; it is three quarters as high
        #[arg(long, value_name = "N", default_value_t = 256)]
        size: u32,
    },
}

/// Does what is asked for.
///
/// # Errors
/// When a preset is not there or cannot be used, or a file cannot be read or written; nothing was changed then.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let Arguments { action, gallery, size } = arguments;
    if let Some(file) = gallery {
        ensure!(action.is_none(), WrongUse("`--gallery` draws all presets: give it without an action"));
        return pictures::draw_gallery(file, *size, session);
    }
    match action {
        None | Some(Action::List) => list::run(session),
        Some(Action::Show { name }) => show::run(name, session),
        Some(Action::Export { name, file }) => files::export(name, file, session),
        Some(Action::Import { file, replace }) => files::import(file, *replace, session),
        Some(Action::Save(arguments)) => files::save(arguments, session),
        Some(Action::Remove { name }) => files::remove(name, session),
        Some(Action::Thumbnail { name, file, size }) => pictures::draw_thumbnail(name, file, *size, session),
    }
}
