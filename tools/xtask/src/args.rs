//! The command line of `cargo xtask`: words in, one [`Command`] out, nothing done yet.

use std::ffi::OsString;
use std::path::PathBuf;

use anyhow::{Context as _, bail};
use lexopt::prelude::*;

use crate::check::Selection;
use crate::suite::Options;

/// What `cargo xtask help` prints.
pub const HELP: &str = "\
Usage: cargo xtask COMMAND

  setup                   install what is missing: a Vulkan loader, a software Vulkan driver, clippy, rustfmt
  demo [DIR]              build Orogeny and do its main job on the bundled terrain, into DIR (default: out/demo)
  run -- ARGS             build Orogeny and run `orogeny ARGS`
  test [FILTER...]        set up, then run every test whose name contains one of FILTER (default: all)
      --quick             only the unit tests that need neither a GPU driver nor other processes
      --long              also the long ones (sets OROGENY_TEST_LONG=1)
  check                   formatting, shaders, lints, documentation, structure, licences; each step timed
      --only NAME         only this step (repeatable)
      --skip NAME         all but this step (repeatable)
  instructions            count the instructions of the CPU kernels beside the kept counts
      --keep              keep these counts
  pictures                draw the pictures of the guide to the editor anew; look at them before you keep them
  golden                  draw the golden pictures anew; look at what changed before you keep it
  bench [WHAT...]         measure speed: arguments go to tools/benchsuite
  help                    this text

Exit code: 0 done, 1 failed, 2 wrong use.";

/// What the user asks for.
#[derive(Debug, PartialEq)]
pub enum Command {
    /// Print [`HELP`].
    Help,
    /// Install what is missing.
    Setup,
    /// Run `orogeny` with these arguments.
    Run(Vec<OsString>),
    /// Run the demo into a folder.
    Demo(Option<PathBuf>),
    /// Run the tests.
    Test(Options),
    /// Count instructions; keep the counts.
    Instructions {
        /// Whether the counts are kept.
        is_kept: bool,
    },
    /// Draw the golden pictures anew.
    Golden,
    /// Draw the pictures of the guide to the editor anew.
    Pictures,
    /// Run the static checks.
    Check(Selection),
    /// Run the benchmarks with these arguments.
    Bench(Vec<OsString>),
}

/// Reads the words of a command line, the program's name first.
///
/// # Errors
///
/// A command, option or argument that does not exist, by name.
pub fn parse(words: impl IntoIterator<Item = OsString>) -> anyhow::Result<Command> {
    let mut parser = lexopt::Parser::from_iter(words.into_iter().collect::<Vec<_>>());
    let name = match parser.next()? {
        Some(Value(name)) => name.string()?,
        None | Some(Long("help") | Short('h')) => return Ok(Command::Help),
        Some(other) => return Err(other.unexpected().into()),
    };
    match name.as_str() {
        "help" => no_more(parser, Command::Help),
        "setup" => no_more(parser, Command::Setup),
        "golden" => no_more(parser, Command::Golden),
        "pictures" => no_more(parser, Command::Pictures),
        "run" => Ok(Command::Run(passed_through(&mut parser)?)),
        "bench" => Ok(Command::Bench(passed_through(&mut parser)?)),
        "demo" => demo(parser),
        "instructions" => instructions(parser),
        "test" => test(parser),
        "check" => check(parser),
        _ => bail!("there is no command `{name}`"),
    }
}

fn no_more(mut parser: lexopt::Parser, command: Command) -> anyhow::Result<Command> {
    match parser.next()? {
        None => Ok(command),
        Some(Long("help") | Short('h')) => Ok(Command::Help),
        Some(other) => Err(other.unexpected().into()),
    }
}

/// All words left, as they are; the `--` that may set them off is not one of them.
fn passed_through(parser: &mut lexopt::Parser) -> anyhow::Result<Vec<OsString>> {
    let mut words: Vec<OsString> = parser.raw_args()?.collect();
    if words.first().is_some_and(|word| word == "--") {
        words.remove(0);
    }
    Ok(words)
}

fn instructions(mut parser: lexopt::Parser) -> anyhow::Result<Command> {
    let mut is_kept = false;
    while let Some(arg) = parser.next()? {
        match arg {
            Long("keep") => is_kept = true,
            Long("help") | Short('h') => return Ok(Command::Help),
            other => return Err(other.unexpected().into()),
        }
    }
    Ok(Command::Instructions { is_kept })
}

fn demo(mut parser: lexopt::Parser) -> anyhow::Result<Command> {
    let mut folder = None;
    while let Some(arg) = parser.next()? {
        match arg {
            Value(value) if folder.is_none() => folder = Some(PathBuf::from(value)),
            Long("help") | Short('h') => return Ok(Command::Help),
            other => return Err(other.unexpected().into()),
        }
    }
    Ok(Command::Demo(folder))
}

fn test(mut parser: lexopt::Parser) -> anyhow::Result<Command> {
    let mut options = Options::default();
    while let Some(arg) = parser.next()? {
        match arg {
            Long("quick") => options.quick = true,
            Long("long") => options.long = true,
            Long("help") | Short('h') => return Ok(Command::Help),
            Value(filter) => options.filters.push(filter.string()?),
            other => return Err(other.unexpected().into()),
        }
    }
    Ok(Command::Test(options))
}

fn check(mut parser: lexopt::Parser) -> anyhow::Result<Command> {
    let mut selection = Selection::default();
    while let Some(arg) = parser.next()? {
        match arg {
            Long("only") => selection.only.push(step_name(&mut parser, "--only")?),
            Long("skip") => selection.skip.push(step_name(&mut parser, "--skip")?),
            Long("help") | Short('h') => return Ok(Command::Help),
            other => return Err(other.unexpected().into()),
        }
    }
    Ok(Command::Check(selection))
}

fn step_name(parser: &mut lexopt::Parser, option: &str) -> anyhow::Result<String> {
    parser.value()?.string().with_context(|| format!("{option} takes the name of a step"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(line: &str) -> anyhow::Result<Command> {
        parse(std::iter::once("xtask").chain(line.split_whitespace()).map(OsString::from))
    }

    #[test]
    fn every_command_is_in_the_help() {
        for name in
            ["setup", "demo", "run", "test", "check", "bench", "instructions", "golden", "pictures", "help"]
        {
            assert!(parsed(name).is_ok(), "{name}");
            assert!(HELP.lines().any(|line| line.trim_start().starts_with(name)), "{name}");
        }
    }

    #[test]
    fn nothing_or_a_help_flag_asks_for_help() {
        for line in ["", "--help", "-h", "test --help", "demo -h", "check --help", "setup --help"] {
            assert_eq!(parsed(line).unwrap(), Command::Help, "{line}");
        }
    }

    #[test]
    fn program_arguments_pass_through_untouched() {
        let expected = Command::Run(["info", "--json", "--", "-x"].map(OsString::from).to_vec());
        assert_eq!(parsed("run -- info --json -- -x").unwrap(), expected);
        assert_eq!(parsed("run info --json -- -x").unwrap(), expected);
        assert_eq!(
            parsed("bench raise --keep").unwrap(),
            Command::Bench(vec!["raise".into(), "--keep".into()])
        );
    }

    #[test]
    fn test_and_check_take_their_options_in_any_order() {
        let expected = Options { quick: true, long: true, filters: vec!["raise".into(), "page".into()] };
        assert_eq!(parsed("test raise --long page --quick").unwrap(), Command::Test(expected));
        let expected = Selection { only: vec!["fmt".into(), "docs".into()], skip: vec!["deny".into()] };
        assert_eq!(parsed("check --only fmt --skip=deny --only docs").unwrap(), Command::Check(expected));
    }

    #[test]
    fn wrong_use_is_named() {
        for (line, named) in [
            ("frobnicate", "frobnicate"),
            ("setup now", "now"),
            ("demo one two", "two"),
            ("test --slow", "--slow"),
            ("check fmt", "fmt"),
            ("check --only", "--only"),
        ] {
            let message = format!("{:#}", parsed(line).unwrap_err());
            assert!(message.contains(named), "{line}: {message}");
        }
    }
}
