//! The limit: a plain file that is overwritten and synced. All or nothing it is not, and it keeps nothing but the last commit.

use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;

use anyhow::Result;

use super::Write;

/// A file as long as the longest commit, its place on disk given out before anything is timed.
pub struct Overwritten {
    file: File,
    size_in_bytes: u64,
}

impl Overwritten {
    pub fn create(folder: &Path, longest: &[Write]) -> Result<Self> {
        let file = File::options().read(true).write(true).create_new(true).open(folder.join("pages"))?;
        let mut made = Self { file, size_in_bytes: 0 };
        made.commit(longest)?;
        made.size_in_bytes = made.file.metadata()?.len();
        Ok(made)
    }

    pub fn commit(&mut self, writes: &[Write]) -> Result<()> {
        self.file.seek(SeekFrom::Start(0))?;
        for Write { page, delta, .. } in writes {
            self.file.write_all(page)?;
            self.file.write_all(delta.as_deref().unwrap_or_default())?;
        }
        Ok(self.file.sync_data()?)
    }

    /// Some bytes, as many as a page has; from the beginning where they would reach past the end.
    pub fn read(&mut self, start: u64, num_bytes: usize) -> Result<Vec<u8>> {
        let is_inside = start + num_bytes as u64 <= self.size_in_bytes;
        self.file.seek(SeekFrom::Start(if is_inside { start } else { 0 }))?;
        let mut page = vec![0; num_bytes];
        self.file.read_exact(&mut page)?;
        Ok(page)
    }
}
