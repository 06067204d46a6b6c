//! `layer`: the layer stack. Each subcommand but `list` is one operation, as a recipe has it.

mod add;
mod brush;
mod collapse;
mod done;
mod duplicate;
mod list;
mod mask;
mod move_layer;
mod refresh;
mod remove;
mod set;
mod words;

use clap::Subcommand;

pub use words::notes;

use crate::session::Session;

/// What `layer` takes.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List the stack, from the top
    List(list::Arguments),
    /// Make a layer: of heights, unless `--procedural`, `--effect` or `--group` says otherwise
    Add(Box<add::Arguments>),
    /// Change a layer; what is not given stays as it is
    Set(Box<set::Arguments>),
    /// Move a layer, or a group with its layers, within the stack
    Move(move_layer::Arguments),
    /// Take a layer out of the stack; what was in a group is in the group's own group then
    Remove(remove::Arguments),
    /// Copy a layer, with its heights and its mask, on top of itself
    Duplicate(duplicate::Arguments),
    /// Bake what a layer shows into heights that can be painted on
    Collapse(collapse::Arguments),
    /// Change where a layer counts
    Mask(mask::Arguments),
    /// Work out anew an effect that is kept, as erosion is, or a mask that a brush made
    Refresh(refresh::Arguments),
}

/// Does what is asked for.
///
/// # Errors
/// When a layer is not there, or cannot be what it is to be; nothing was changed then.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    match &arguments.action {
        Action::List(arguments) => list::run(arguments, session),
        Action::Add(arguments) => add::run(arguments, session),
        Action::Set(arguments) => set::run(arguments, session),
        Action::Move(arguments) => move_layer::run(arguments, session),
        Action::Remove(arguments) => remove::run(arguments, session),
        Action::Duplicate(arguments) => duplicate::run(arguments, session),
        Action::Collapse(arguments) => collapse::run(arguments, session),
        Action::Mask(arguments) => mask::run(arguments, session),
        Action::Refresh(arguments) => refresh::run(arguments, session),
    }
}
