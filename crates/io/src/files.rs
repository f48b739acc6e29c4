//! Files that are complete whenever they are visible: written under another name, then renamed.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::Error;

/// Creates a directory with everything above it.
pub(crate) fn create_directory(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(|source| Error::Write { path: path.to_owned(), source })
}

/// Writes a file in one piece.
pub(crate) fn write_whole(path: &Path, content: &[u8]) -> Result<(), Error> {
    write_with(path, |file| file.write_all(content)).map_err(|source| Error::Write { path: path.to_owned(), source })
}

/// Writes a file with a closure; it appears under its name when it is complete.
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

/// Bytes as text, in the alphabet of RFC 4648.
#[cfg(feature = "simulation")]
pub(crate) fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(4 * bytes.len().div_ceil(3));
    for chunk in bytes.chunks(3) {
        let byte = |k: usize| u32::from(chunk.get(k).copied().unwrap_or(0));
        let word = byte(0) << 16 | byte(1) << 8 | byte(2);
        for k in 0..4 {
            let letter = ALPHABET[(word >> (18 - 6 * k) & 63) as usize];
            text.push(if k <= chunk.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(all(test, feature = "simulation"))]
mod tests {
    use super::base64;

    #[test]
    fn base64_has_the_test_vectors_of_its_standard() {
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }
}
