//! The commands, one a file: its arguments, what it does, what it reports.

pub mod apply;
pub mod brushes;
pub mod check;
pub mod compact;
pub mod custom;
pub mod demo;
pub mod doctor;
pub mod edit;
pub mod export;
pub mod import;
pub mod info;
pub mod jump;
pub mod layer;
pub mod log;
pub mod materials;
pub mod new;
pub mod presets;
pub mod redo;
pub mod render;
pub mod replay;
pub mod salvage;
pub mod serve;
mod travel;
pub mod undo;

use crate::arguments::Command;
use crate::session::Session;

/// Runs a command.
///
/// # Errors
/// Why it failed; unless it says otherwise, nothing was changed.
pub fn run(command: Command, session: &Session) -> anyhow::Result<()> {
    match command {
        Command::Edit(arguments) => edit::run(&arguments, session),
        Command::New(arguments) => new::run(&arguments, session),
        Command::Import(arguments) => import::run(arguments, session),
        Command::Apply(arguments) => apply::run(&arguments, session),
        Command::Layer(arguments) => layer::run(&arguments, session),
        Command::Undo(arguments) => undo::run(&arguments, session),
        Command::Redo(arguments) => redo::run(&arguments, session),
        Command::Jump(arguments) => jump::run(&arguments, session),
        Command::Check(arguments) => check::run(&arguments, session),
        Command::Compact(arguments) => compact::run(&arguments, session),
        Command::Salvage(arguments) => salvage::run(&arguments, session),
        Command::Serve(arguments) => serve::run(arguments, session),
        Command::Replay(arguments) => replay::run(&arguments, session),
        Command::Log(arguments) => log::run(&arguments, session),
        Command::Info(arguments) => info::run(&arguments, session),
        Command::Export(arguments) => export::run(arguments, session),
        Command::Render(arguments) => render::run(arguments, session),
        Command::Brushes(arguments) => brushes::run(&arguments, session),
        Command::Materials(arguments) => materials::run(&arguments, session),
        Command::Custom(arguments) => custom::run(&arguments, session),
        Command::Presets(arguments) => presets::run(&arguments, session),
        Command::Doctor(arguments) => doctor::run(&arguments, session),
        Command::Demo(arguments) => demo::run(&arguments, session),
    }
}
