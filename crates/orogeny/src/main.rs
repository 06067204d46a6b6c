//! The `orogeny` command: what a user types, mapped to the engine and back to text or JSON.
//!
//! There is no logic of terrains here. Exit codes: 0 done, 1 failed, 2 wrong use. What is reported goes to standard output,
//! errors, notes of `-v` and progress bars to standard error.

mod arguments;
mod cancel;
mod commands;
mod output;
mod progress;
mod session;
mod values;

use std::process::ExitCode;

use clap::Parser as _;

use crate::arguments::{Command, CommandLine, WrongUse};
use crate::output::Output;
use crate::session::Session;

const FAILED: u8 = 1;
const WRONG_USE: u8 = 2;

fn main() -> ExitCode {
    match CommandLine::try_parse() {
        Ok(line) => run(line),
        Err(err) => refuse(&err),
    }
}

fn run(line: CommandLine) -> ExitCode {
    let session = Session::new(&line.global, matches!(line.command, Command::Edit(_)));
    match commands::run(line.command, &session) {
        Ok(()) => ExitCode::SUCCESS,
        Err(err) if output::is_broken_pipe(&err) => ExitCode::SUCCESS, // the reader has seen enough, as `head` does
        Err(err) => {
            session.output().error(&err.to_string());
            ExitCode::from(if err.is::<WrongUse>() { WRONG_USE } else { FAILED })
        }
    }
}

/// Help and the version are answers; everything else is wrong use.
fn refuse(err: &clap::Error) -> ExitCode {
    let wants_json = std::env::args_os().any(|argument| argument == "--json");
    if err.use_stderr() && wants_json {
        let text = err.render().to_string();
        Output::new(true).error(text.trim_start_matches("error: ").trim_end());
    } else if err.print().is_err() {
        // Nobody reads: the exit code says what there is to say.
    }
    if err.use_stderr() { ExitCode::from(WRONG_USE) } else { ExitCode::SUCCESS }
}
