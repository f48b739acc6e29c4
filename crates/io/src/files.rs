//! Reading of whole files, and writing such that no reader finds an incomplete file.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::Path;

use crate::Error;

/// Largest file that is read, bytes. The limit is for devices, which have no end.
const MOST_BYTES: u64 = 1 << 33;
/// Largest scenario, bytes.
#[cfg(feature = "simulation")]
const MOST_OF_SCENARIO: u64 = 1 << 26;

/// Reads a file.
///
/// # Errors
/// [`Error::Read`]: also if it has more than 8 GB.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Error> {
    read_up_to(path, MOST_BYTES)
}

fn read_up_to(path: &Path, most: u64) -> Result<Vec<u8>, Error> {
    let failed = |source| Error::Read { path: path.to_owned(), source };
    let mut bytes = Vec::new();
    File::open(path).and_then(|file| file.take(most + 1).read_to_end(&mut bytes)).map_err(failed)?;
    if bytes.len() as u64 > most {
        return Err(failed(io::Error::new(io::ErrorKind::FileTooLarge, format!("it has more than {most} bytes"))));
    }
    Ok(bytes)
}

/// Reads a file of text.
///
/// # Errors
/// [`Error::Read`]: also if it has more than 8 GB. [`Error::NotUtf8`].
pub fn read_text(path: &Path) -> Result<String, Error> {
    text(path, read(path)?)
}

/// Reads a scenario.
///
/// # Errors
/// [`Error::Read`]: also if it has more than 64 MB. [`Error::NotUtf8`].
#[cfg(feature = "simulation")]
pub(crate) fn read_scenario(path: &Path) -> Result<String, Error> {
    text(path, read_up_to(path, MOST_OF_SCENARIO)?)
}

fn text(path: &Path, bytes: Vec<u8>) -> Result<String, Error> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..valid].iter().filter(|b| **b == b'\n').count() + 1;
        Error::NotUtf8 { path: path.to_owned(), line }
    })
}

/// Returns the extension of a name in lower case; empty if there is none.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default()
}

pub(crate) fn create_directory(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(|source| Error::Write { path: path.to_owned(), source })
}

/// Writes a file under another name and renames it when it is on the disk, so that it is complete whenever it is
/// visible, also after a loss of power.
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
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let partial = path.with_file_name(format!(".partial-{name}"));
    let mut file = BufWriter::new(File::create(&partial)?);
    write(&mut file)?;
    file.flush()?;
    file.get_ref().sync_all()?;
    fs::rename(&partial, path)?;
    sync_directory(path)?;
    Ok(())
}

/// Waits until the name of a file is on the disk, on Unix only: elsewhere directories cannot be opened.
fn sync_directory(path: &Path) -> io::Result<()> {
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if cfg!(unix) { File::open(directory)?.sync_all() } else { Ok(()) }
}
