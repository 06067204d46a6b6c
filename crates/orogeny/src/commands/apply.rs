//! `apply`: runs a recipe.

use std::fmt;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::anyhow;
use clap::Args;
use orogeny_engine::{Applied, BrushType, Dropped, MemoryUse, Recipe};
use serde::Serialize;

use crate::output::{count, dropped_line, text_of, write_notices};
use crate::progress::ProgressWatch;
use crate::session::Session;

/// The longest recipe, in bytes.
const MAX_RECIPE_BYTES: u64 = 256 << 20;

/// What `apply` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// A file of `{"operations": […]}`; `-` is standard input
    recipe: PathBuf,
    /// Run it and take it back: whether it would work, and what it would do
    #[arg(long)]
    dry_run: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    dry_run: bool,
    backend: String,
    operations: Vec<Applied>,
    /// What went from the history.
    dropped: Dropped,
    memory: MemoryUse,
    elapsed_s: f64,
}

/// Runs the recipe.
///
/// # Errors
/// When the recipe cannot be understood, or an operation fails; none was done then.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let mut recipe = Recipe::from_json_text(&read(&arguments.recipe)?, &session.presets())?;
    if let Some(folder) = arguments.recipe.parent() {
        recipe.resolve_files(folder);
    }
    let mut terrain = session.open(&arguments.terrain)?;
    let backend = terrain.backend_description()?;
    let start = Instant::now();
    let mut watch = ProgressWatch::new();
    let operations = if arguments.dry_run {
        terrain.try_out(&recipe.operations, &mut watch)?
    } else {
        terrain.apply(&recipe.operations, &mut watch)?
    };
    drop(watch);
    let elapsed_s = start.elapsed().as_secs_f64();
    let (dropped, memory) = (terrain.take_dropped_history()?, terrain.memory());
    terrain.close()?;
    session.output().report(&Report {
        terrain: text_of(&arguments.terrain),
        dry_run: arguments.dry_run,
        backend,
        operations,
        dropped,
        memory,
        elapsed_s,
    })
}

fn read(path: &Path) -> anyhow::Result<String> {
    let is_stdin = path == Path::new("-");
    let failed = |err: std::io::Error| match is_stdin {
        true => anyhow!("the recipe on standard input could not be read: {err}"),
        false => anyhow!("the recipe `{}` could not be read: {err}", path.display()),
    };
    let source: Box<dyn std::io::Read> = if is_stdin {
        Box::new(std::io::stdin())
    } else {
        Box::new(std::fs::File::open(path).map_err(failed)?)
    };
    let mut text = String::new();
    let length = source.take(MAX_RECIPE_BYTES + 1).read_to_string(&mut text).map_err(failed)?;
    if length as u64 > MAX_RECIPE_BYTES {
        return Err(anyhow!("the recipe is longer than {MAX_RECIPE_BYTES} bytes: cut it into several"));
    }
    Ok(text)
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let num_operations = self.operations.len() as u64;
        for (index, applied) in self.operations.iter().enumerate() {
            writeln!(f, "{:>3}/{num_operations}  {}", index + 1, one_line(applied))?;
        }
        write_notices(f, dropped_line(&self.dropped).as_slice())?;
        let Self { terrain, backend, elapsed_s, .. } = self;
        let did = if self.dry_run { "tried out, and took back," } else { "applied" };
        let operations = count(num_operations, "operation");
        writeln!(f, "{did} {operations} on {terrain} in {elapsed_s:.2} s, on {backend}")
    }
}

/// What an operation did, in a line.
fn one_line(applied: &Applied) -> String {
    let pages = count(applied.num_pages as u64, "page");
    let brush = applied.brush.map_or("", BrushType::name);
    let what = format!("{} {brush}", applied.operation);
    let mut line = format!("{what:<18} {pages:>10}  {:.3} s", applied.elapsed_s);
    if applied.notices.num_clamped_heights > 0 {
        let heights = count(applied.notices.num_clamped_heights, "height");
        line.push_str(&format!("  note: {heights} beyond what a terrain holds were clamped"));
    }
    line
}
