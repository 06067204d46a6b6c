//! Screens that no one sees, for windows.

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A process that ends with the test.
#[derive(Debug)]
pub struct Killed(pub Child);

impl Drop for Killed {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

/// A screen of X of 1440 x 900 pixels, which ends with the test.
#[derive(Debug)]
pub struct Screen {
    _server: Killed,
    /// What names it to programs, as `DISPLAY`.
    pub display: String,
}

impl Screen {
    /// A new one; what it shows is in a file in `framebuffer_folder`, where that is given. `None` where there is no program that makes one.
    #[must_use]
    pub fn new(framebuffer_folder: Option<&Path>) -> Option<Self> {
        let mut command = Command::new("Xvfb");
        command.args(["-displayfd", "1", "-screen", "0", "1440x900x24", "-noreset"]);
        if let Some(folder) = framebuffer_folder {
            command.arg("-fbdir").arg(folder);
        }
        let mut server = Killed(command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().ok()?);
        let mut number = String::new();
        BufReader::new(server.0.stdout.take()?).read_line(&mut number).ok()?;
        Some(Self { _server: server, display: format!(":{}", number.trim()) })
    }
}
