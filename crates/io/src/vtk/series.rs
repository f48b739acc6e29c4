//! `.pvd` files: indices of field files over time.

use std::path::{Path, PathBuf};

use crate::Error;
use crate::files::write_whole;

/// Time of a field file, and its path relative to the directory.
pub type Entry = (f64, String);

/// A series of field files with its index, which is rewritten after every file.
#[derive(Clone, Debug)]
pub struct Series {
    directory: PathBuf,
    name: String,
    entries: Vec<Entry>,
}

impl Series {
    /// Creates the series `NAME.pvd` in a directory, with its files in the folder `vtk` of that directory.
    pub fn new(directory: &Path, name: &str) -> Self {
        Self { directory: directory.to_owned(), name: name.to_owned(), entries: Vec::new() }
    }

    /// Returns the entries so far.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Replaces the entries by those at an earlier time, and writes the index if there are any.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn cut_back(&mut self, entries: Vec<Entry>) -> Result<(), Error> {
        self.entries = entries;
        if self.entries.is_empty() { Ok(()) } else { self.write_index() }
    }

    /// Writes the field file of a step with a closure, then the index.
    ///
    /// # Errors
    /// The error of the closure; [`Error::Write`].
    pub fn push(
        &mut self,
        step: usize,
        time: f64,
        write: impl FnOnce(&Path) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let file = format!("vtk/{}_{step:06}.vtu", self.name);
        write(&self.directory.join(&file))?;
        self.entries.push((time, file));
        self.write_index()
    }

    fn write_index(&self) -> Result<(), Error> {
        let entry = |(time, file): &Entry| {
            format!("    <DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{file}\"/>\n")
        };
        let entries: String = self.entries.iter().map(entry).collect();
        let text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  \
             <Collection>\n{entries}  </Collection>\n</VTKFile>\n"
        );
        write_whole(&self.directory.join(format!("{}.pvd", self.name)), text.as_bytes())
    }
}
