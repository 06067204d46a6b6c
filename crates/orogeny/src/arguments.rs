//! The command line: global options and the list of commands. Each command's own arguments lie beside it.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::commands::{
    apply, brushes, check, compact, custom, demo, doctor, edit, export, import, info, jump, layer, log,
    materials, new, presets, redo, render, replay, salvage, serve, undo,
};

/// A GPU brush engine for heightfields: make, import, brush, undo, draw and export terrains.
#[derive(Debug, Parser)]
#[command(name = "orogeny", version, propagate_version = true, max_term_width = 120)]
pub struct CommandLine {
    /// What holds for every command.
    #[command(flatten)]
    pub global: Global,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// Options that every command takes.
#[derive(Debug, Args)]
#[command(next_help_heading = "Global options")]
pub struct Global {
    /// What calculates: `auto` (a real GPU, else `cpu`), `cpu` (native code on all cores), `software` (a software driver,
    /// slow) or a part of an adapter's name; `doctor` lists them
    #[arg(long, global = true, value_name = "ADAPTER", default_value = "auto")]
    pub adapter: String,
    /// Mebibytes of pages that stay in memory or in textures
    #[arg(long, global = true, value_name = "MIB", default_value_t = 1024, value_parser = clap::value_parser!(u64).range(1..=1 << 24))]
    pub page_budget: u64,
    /// Threads of the CPU back end [default: one a core]
    #[arg(long, global = true, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// The folder of your presets [default: what OROGENY_PRESETS says, else `orogeny/presets` in the system's folder for data]
    #[arg(long, global = true, value_name = "FOLDER")]
    pub presets: Option<PathBuf>,
    /// Report as one JSON object on standard output; errors as one on standard error
    #[arg(long, global = true)]
    pub json: bool,
    /// Say more on standard error: -v what is done, -vv every step
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub verbose: u8,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Open a window to paint in
    Edit(edit::Arguments),
    /// Let other programs and browsers read and brush terrains
    Serve(serve::Arguments),
    /// Make a flat terrain
    New(new::Arguments),
    /// Read a file of another program: makes a terrain of it, or writes it into a layer of one
    Import(import::Arguments),
    /// Run a recipe: all of its operations or, on an error, none
    Apply(apply::Arguments),
    /// List and change the layer stack
    Layer(layer::Arguments),
    /// Take back the last operations, bit for bit
    Undo(undo::Arguments),
    /// Do again what was undone, bit for bit
    Redo(redo::Arguments),
    /// Go to any entry of the history, on a branch too, bit for bit
    Jump(jump::Arguments),
    /// List what was done
    Log(log::Arguments),
    /// Tell what a terrain is
    Info(info::Arguments),
    /// Verify all of a terrain: every page, every delta, every checksum; repair it where asked to
    Check(check::Arguments),
    /// Give space back; limit what the history takes
    Compact(compact::Arguments),
    /// Copy what can be read of a damaged terrain into a new one
    Salvage(salvage::Arguments),
    /// Make a new terrain by doing again all that the history says
    Replay(replay::Arguments),
    /// Write heights for another program; the file's ending tells the format
    Export(export::Arguments),
    /// Draw a picture
    Render(render::Arguments),
    /// List the brushes with their parameters, ranges and defaults
    Brushes(brushes::Arguments),
    /// List, show, draw, share and save presets: brushes under names
    Presets(presets::Arguments),
    /// List the material sets of pictures, or write one to start a set of your own from
    Materials(materials::Arguments),
    /// Look over a custom brush, once or whenever its file changes
    Custom(custom::Arguments),
    /// Tell what this machine can do
    Doctor(doctor::Arguments),
    /// Do the main job on a real terrain that comes along: import, brush, undo, export, draw
    Demo(demo::Arguments),
}

/// Arguments that are well formed and make no sense together.
#[derive(Debug)]
pub struct WrongUse(pub &'static str);

impl std::fmt::Display for WrongUse {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0)
    }
}

impl std::error::Error for WrongUse {}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn the_definition_is_sound() {
        CommandLine::command().debug_assert();
    }

    #[test]
    fn global_options_may_stand_on_either_side() {
        for line in ["orogeny --json --adapter cpu log t", "orogeny log t --json --adapter cpu"] {
            let line = CommandLine::try_parse_from(line.split(' ')).unwrap();
            assert!(line.global.json && line.global.adapter == "cpu");
        }
    }
}
