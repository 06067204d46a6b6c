//! `materials`: the material sets that come with the program, and one of them as a file to start from.

use std::fmt;

use clap::Args;
use orogeny_engine::{MaterialDescription, Materials, material_descriptions};
use serde::Serialize;
use serde_json::Value;

use crate::session::Session;

/// What `materials` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// One set, as the JSON that a set of your own can start from
    name: Option<String>,
}

#[derive(Debug, Serialize)]
struct List {
    sets: Vec<MaterialDescription>,
}

/// A set as it is written.
#[derive(Debug, Serialize)]
#[serde(transparent)]
struct Set(Value);

/// Lists the sets, or writes one.
///
/// # Errors
/// When there is no such set.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    match &arguments.name {
        None => session.output().report(&List { sets: material_descriptions()? }),
        Some(name) => {
            let text = Materials::Factory(name.clone()).to_json()?;
            session.output().report(&Set(serde_json::from_str(&text)?))
        }
    }
}

impl fmt::Display for List {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for MaterialDescription { name, description, layers } in &self.sets {
            writeln!(f, "{name:<10} {description}")?;
            writeln!(f, "           {}", layers.join(", "))?;
        }
        Ok(())
    }
}

impl fmt::Display for Set {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{:#}", self.0)
    }
}
