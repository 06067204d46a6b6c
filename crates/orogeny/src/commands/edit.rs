//! `edit`: the editor's window.

use std::path::PathBuf;

use clap::Args;
use orogeny_editor::EditorOptions;
use orogeny_engine::presets::user_folder;
use orogeny_engine::{Error, ImportRequest, Quiet, Settings, Terrain};

use super::demo::{RASTER, RASTER_NAME};
use crate::session::Session;

/// What `edit` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrain [default: the one that was open last, or one that comes along]
    terrain: Option<PathBuf>,
    /// The file that remembers keys, brushes and recent terrains [default: `orogeny/editor.json` in the system's folder for data]
    #[arg(long, value_name = "FILE")]
    preferences: Option<PathBuf>,
}

/// Opens the window, and returns when it is closed.
///
/// # Errors
/// When there is no screen, or nothing that could draw.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let settings = session.settings();
    let of_bundled = settings.clone();
    let options = EditorOptions {
        settings,
        presets: session.presets(),
        log: session.log().cloned().unwrap_or_default(),
        own_brushes: user_folder().map(|folder| folder.join("brushes")),
        preferences: arguments.preferences.clone().or_else(|| Some(user_folder()?.join("editor.json"))),
        bundled: Box::new(move || bundled(&of_bundled)),
    };
    Ok(orogeny_editor::run(options, arguments.terrain.clone())?)
}

/// The terrain that comes along, made in the user's folder where it is not there yet.
fn bundled(settings: &Settings) -> orogeny_engine::Result<PathBuf> {
    let folder = user_folder().unwrap_or_else(std::env::temp_dir);
    let path = folder.join("frazier.orogeny");
    if path.exists() {
        return Ok(path);
    }
    let wrong = |source| Error::Write { path: folder.clone(), source };
    std::fs::create_dir_all(&folder).map_err(wrong)?;
    let raster = folder.join(RASTER_NAME);
    std::fs::write(&raster, RASTER).map_err(wrong)?;
    let (terrain, _) =
        Terrain::from_raster(&path, &ImportRequest::new(&raster), settings.clone(), &mut Quiet)?;
    terrain.close()?;
    std::fs::remove_file(&raster).map_err(wrong)?;
    Ok(path)
}
