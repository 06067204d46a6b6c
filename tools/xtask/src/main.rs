//! `cargo xtask`: everything a first user or a developer does with this repository, one command each.
//!
//! It stands outside the workspace's layers: no crate of Orogeny is linked, so that it builds in seconds and still
//! runs when they do not build. Each module is one command, or what several of them share.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a command line tool talks to its user")]

mod args;
mod cargo;
mod check;
mod instructions;
mod launch;
mod setup;
mod suite;

use std::process::ExitCode;

use args::Command;

fn main() -> ExitCode {
    let command = match args::parse(std::env::args_os()) {
        Ok(command) => command,
        Err(err) => {
            eprintln!("error: {err:#}\n\n{}", args::HELP);
            return ExitCode::from(2);
        }
    };
    match run(command) {
        Ok(code) => code,
        Err(err) => {
            eprintln!("error: {err:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(command: Command) -> anyhow::Result<ExitCode> {
    match command {
        Command::Help => {
            println!("{}", args::HELP);
            Ok(ExitCode::SUCCESS)
        }
        Command::Setup => setup::run(),
        Command::Run(program_args) => launch::run(&program_args),
        Command::Demo(folder) => launch::demo(folder),
        Command::Test(options) => suite::run(&options),
        Command::Golden => launch::golden(),
        Command::Pictures => launch::pictures(),
        Command::Instructions { is_kept } => instructions::run(is_kept),
        Command::Check(selection) => check::run(&selection),
        Command::Bench(bench_args) => launch::bench(&bench_args),
    }
}
