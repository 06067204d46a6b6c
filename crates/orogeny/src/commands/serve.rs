//! `serve`: terrains for other programs, over HTTP.

use std::env::VarError;
use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use orogeny_service::{Limits, Running, ServiceOptions, Token};

use crate::cancel;
use crate::session::Session;

/// The variable that may hold the token.
const TOKEN_VARIABLE: &str = "OROGENY_TOKEN";

/// What `serve` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrains; clients call them by their names without the ending
    #[arg(required = true, value_name = "TERRAIN")]
    terrains: Vec<PathBuf>,
    /// Where to listen; port 0 for any that is free. Any other address than this machine's own needs a token
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:4750")]
    listen: SocketAddr,
    /// A file with the token that clients must give: 16 letters and digits or more [default: OROGENY_TOKEN, if that is set]
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
    /// The folder of files that operations may name, as pictures for brushes [default: none may be read]
    #[arg(long, value_name = "FOLDER")]
    files: Option<PathBuf>,
    /// The most connections at a time
    #[arg(long, value_name = "N", default_value_t = Limits::default().connections)]
    max_connections: usize,
    /// The most mebibytes that one request may send
    #[arg(long, value_name = "MIB", default_value_t = Limits::default().body_in_bytes >> 20, value_parser = max_body)]
    max_body: usize,
}

fn max_body(text: &str) -> Result<usize, String> {
    let mebibytes: usize = text.parse().map_err(|err| format!("{err}"))?;
    if (1..=4096).contains(&mebibytes) { Ok(mebibytes) } else { Err("it may be 1 to 4096".to_owned()) }
}

/// Serves until it is asked to stop, by Ctrl-C or by the system.
///
/// # Errors
/// When a terrain cannot be opened or the address cannot be listened at.
pub fn run(arguments: Arguments, session: &Session) -> anyhow::Result<()> {
    let token = match (&arguments.token_file, std::env::var(TOKEN_VARIABLE)) {
        (Some(file), _) => {
            let text = std::fs::read_to_string(file)
                .with_context(|| format!("the token cannot be read from `{}`", file.display()))?;
            Some(Token::new(&text)?)
        }
        (None, Ok(text)) => Some(Token::new(&text)?),
        (None, Err(VarError::NotPresent)) => None,
        (None, Err(err)) => anyhow::bail!("{TOKEN_VARIABLE} cannot be used: {err}"),
    };
    let limits = Limits {
        connections: arguments.max_connections.max(1),
        body_in_bytes: arguments.max_body << 20,
        ..Limits::default()
    };
    let options = ServiceOptions {
        terrains: arguments.terrains,
        address: arguments.listen,
        token,
        files: arguments.files,
        limits,
        settings: session.settings(),
        presets: session.presets(),
    };
    // Asked for before it is said that it serves: whoever reads that may stop it at once.
    cancel::watch();
    let running = Running::start(options)?;
    session.output().report(&Serving { address: running.address(), terrains: running.names().to_vec() })?;
    cancel::wait();
    Ok(running.stop()?)
}

/// What is served where.
#[derive(Debug, serde::Serialize)]
struct Serving {
    address: SocketAddr,
    terrains: Vec<String>,
}

impl fmt::Display for Serving {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> = self.terrains.iter().map(|name| format!("`{name}`")).collect();
        writeln!(f, "serving {} at http://{}/", names.join(", "), self.address)
    }
}
