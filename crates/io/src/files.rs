//! Files that are complete whenever they are visible: written under another name, then renamed.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::Error;

/// Creates a directory and its parents.
pub(crate) fn create_directory(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(|source| Error::Write { path: path.to_owned(), source })
}

/// Writes a file under another name and renames it, so that it is complete whenever it is visible.
///
/// # Errors
/// [`Error::Write`].
pub fn write_whole(path: &Path, content: &[u8]) -> Result<(), Error> {
    write_with(path, |file| file.write_all(content)).map_err(|source| Error::Write { path: path.to_owned(), source })
}

/// Writes a file with a closure, as [`write_whole`] does.
pub(crate) fn write_with<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
) -> Result<(), E> {
    let partial = partial(path);
    let mut file = BufWriter::new(File::create(&partial)?);
    write(&mut file)?;
    file.flush()?;
    fs::rename(&partial, path)?;
    Ok(())
}

/// Name of a file while it is being written, with the same extension.
pub(crate) fn partial(path: &Path) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    path.with_file_name(format!(".partial-{name}"))
}
