//! What keeps the service from starting.

use std::net::SocketAddr;
use std::path::PathBuf;

/// The result of starting or running the service.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why the service could not be started, or not be ended well.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A terrain could not be opened, or not be closed.
    #[error("`{}`: {source}", path.display())]
    Terrain {
        /// Its file.
        path: PathBuf,
        /// Why.
        source: Box<orogeny_engine::Error>,
    },
    /// No terrain was given. Give one or more.
    #[error("there is no terrain to serve: give the path of one or more")]
    NoTerrain,
    /// Two terrains would have the same name. Rename one of the files.
    #[error("two terrains are called `{name}`, by which clients would know them: rename one of the files")]
    SameName {
        /// The name.
        name: String,
    },
    /// A file without a name that clients could use.
    #[error("`{}` has no name that an address can hold: rename it, by letters, digits, `-`, `_`, `.` and spaces", path.display())]
    Name {
        /// The file.
        path: PathBuf,
    },
    /// Other machines could paint. Give a token, or listen on this machine alone.
    #[error(
        "{address} can be reached from other machines, and there is no token: give one by `--token-file` or in OROGENY_TOKEN, or \
         listen on 127.0.0.1"
    )]
    NoToken {
        /// Where it was to listen.
        address: SocketAddr,
    },
    /// A token that is too easily guessed, or cannot be sent.
    #[error("the token cannot be used: {detail}; `openssl rand -hex 32` makes one that can")]
    Token {
        /// Why.
        detail: String,
    },
    /// The address cannot be listened at. Choose another port.
    #[error("cannot listen at {address}: {source}; choose another address by `--listen`")]
    Listen {
        /// Where it was to listen.
        address: SocketAddr,
        /// What the system said.
        source: std::io::Error,
    },
    /// The system gave no threads. Close other programs.
    #[error("the service's threads could not be started: {source}")]
    Runtime {
        /// What the system said.
        source: std::io::Error,
    },
}
