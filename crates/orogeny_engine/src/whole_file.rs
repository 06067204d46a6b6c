//! Files that appear whole or not at all.

use std::io::Write as _;
use std::path::Path;

use tempfile::NamedTempFile;

use crate::{Error, Result};

/// Writes a file, in the place of one that may be there.
///
/// # Errors
/// [`Error::Write`]; what was there is there then.
pub(crate) fn write(path: &Path, content: &[u8]) -> Result<()> {
    written_beside(path, content)?.persist(path).map_err(|err| failed(path, err.error))?;
    Ok(())
}

/// Writes a file, unless there is one already.
///
/// # Errors
/// [`Error::Write`], with [`std::io::ErrorKind::AlreadyExists`] where there is one.
pub(crate) fn write_new(path: &Path, content: &[u8]) -> Result<()> {
    written_beside(path, content)?.persist_noclobber(path).map_err(|err| failed(path, err.error))?;
    Ok(())
}

fn written_beside(path: &Path, content: &[u8]) -> Result<NamedTempFile> {
    let mut temporary =
        orogeny_formats::temporary_beside(path).map_err(|err| failed(path, std::io::Error::other(err)))?;
    temporary.write_all(content).map_err(|err| failed(path, err))?;
    temporary.as_file().sync_all().map_err(|err| failed(path, err))?;
    Ok(temporary)
}

fn failed(path: &Path, source: std::io::Error) -> Error {
    Error::Write { path: path.to_owned(), source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_there_is_replaced_only_where_that_is_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        write_new(&path, b"1").unwrap();
        let Err(Error::Write { source, .. }) = write_new(&path, b"2") else { panic!("it was replaced") };
        assert_eq!(source.kind(), std::io::ErrorKind::AlreadyExists);
        assert_eq!(std::fs::read(&path).unwrap(), b"1");
        write(&path, b"3").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"3");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn it_has_the_permissions_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        std::fs::write(folder.path().join("any"), "").unwrap();
        write(&folder.path().join("map.png"), b"1").unwrap();
        assert_eq!(mode(&folder.path().join("map.png")), mode(&folder.path().join("any")));
    }
}
