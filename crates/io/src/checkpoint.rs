//! Checkpoints: files from which a run is resumed.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::Error;
use crate::files::{read, write_whole};
use crate::scenario::ScenarioFile;
use crate::summary::SummaryBuilder;
use crate::vtk::series::Entry;

/// First bytes of a file.
const MAGIC: &[u8; 8] = b"CUTWATER";
/// Version of the format. A file of another version is an error.
const FORMAT: u32 = 10;
/// Bytes before the header: magic, version and length of the header.
const BEFORE_HEADER: usize = 8 + 4 + 8;
/// Bytes of the checksum at the end.
const CHECKSUM: usize = 4;
/// Number of files that are kept.
const KEPT: usize = 2;

/// A point from which a run is resumed: the state, and how far the files of results had come.
///
/// Layout of a file, little-endian: `CUTWATER`; version of the format, 4 bytes; length of the header, 8 bytes; the
/// header, JSON; numbers of state and linear solver, 8 bytes each; CRC-32 of all preceding bytes, 4 bytes.
pub(crate) struct Checkpoint {
    pub(crate) header: Header,
    /// Lists of the state ([`solver::State::to_lists`]).
    pub(crate) lists: Vec<Vec<f64>>,
    /// Lists of the linear solver ([`solver::algebra::Workspace::memory`]).
    pub(crate) memory: Vec<Vec<f64>>,
}

/// The part of a checkpoint without the numbers of the state and of the linear solver.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Header {
    /// Step at whose end the checkpoint was written.
    pub(crate) step: usize,
    /// Steps of the whole run.
    pub(crate) n_steps: usize,
    /// Time at its end.
    pub(crate) time: f64,
    /// The scenario without end time and output, which may change.
    pub(crate) scenario: String,
    /// Lengths of the lists of the state.
    pub(crate) lists: Vec<usize>,
    /// Lengths of the lists of the linear solver.
    pub(crate) memory: Vec<usize>,
    /// Lengths of the tables ([`crate::TABLES`]), bytes.
    pub(crate) histories: [u64; 3],
    /// The summary so far.
    pub(crate) summary: SummaryBuilder,
    /// Entries of the series of field files.
    pub(crate) series: Vec<Vec<Entry>>,
}

impl Checkpoint {
    /// Writes the checkpoint into a directory, then removes all but the last two.
    pub(crate) fn write(&self, directory: &Path) -> Result<(), Error> {
        let header = serde_json::to_vec(&self.header)?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend(FORMAT.to_le_bytes());
        bytes.extend((header.len() as u64).to_le_bytes());
        bytes.extend(header);
        self.lists.iter().chain(&self.memory).flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        write_whole(&path(directory, self.header.step), &bytes)?;
        keep_last(directory)
    }

    /// Reads a checkpoint.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Checkpoint`].
    fn read(path: &Path) -> Result<Self, Error> {
        Self::parse(&read(path)?).map_err(|problem| Error::Checkpoint { path: path.to_owned(), problem })
    }

    fn parse(bytes: &[u8]) -> Result<Self, String> {
        const DAMAGED: &str = "the file is damaged";
        if !bytes.starts_with(MAGIC) {
            return Err("this is not a checkpoint".to_owned());
        }
        let format = bytes.get(8..12).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes).ok_or(DAMAGED)?;
        if format != FORMAT {
            return Err(format!("it has version {format} of the format, and this program reads version {FORMAT}"));
        }
        let end = bytes.len().checked_sub(CHECKSUM).filter(|end| *end >= BEFORE_HEADER).ok_or(DAMAGED)?;
        if bytes[end..] != crc32fast::hash(&bytes[..end]).to_le_bytes() {
            return Err(format!("{DAMAGED}: its checksum is wrong"));
        }
        let length = bytes[12..BEFORE_HEADER].try_into().map(u64::from_le_bytes).map_err(|_| DAMAGED)?;
        let begin = usize::try_from(length).ok().and_then(|length| BEFORE_HEADER.checked_add(length));
        let begin = begin.filter(|begin| *begin <= end).ok_or(DAMAGED)?;
        let header = serde_json::from_slice(&bytes[BEFORE_HEADER..begin]).map_err(|e| format!("{DAMAGED}: {e}"))?;
        let Header { lists: ref lengths, memory: ref lengths_of_memory, .. } = header;
        let numbers = bytes[begin..end].chunks_exact(8).map(|b| f64::from_le_bytes(std::array::from_fn(|k| b[k])));
        let mut numbers = numbers.collect::<Vec<_>>().into_iter();
        let mut next = |lengths: &[usize]| -> Option<Vec<Vec<f64>>> {
            let list =
                |n: &usize| Some(numbers.by_ref().take(*n).collect::<Vec<f64>>()).filter(|list| list.len() == *n);
            lengths.iter().map(list).collect()
        };
        match (next(lengths), next(lengths_of_memory), numbers.next()) {
            (Some(lists), Some(memory), None) => Ok(Self { header, lists, memory }),
            _ => Err(DAMAGED.to_owned()),
        }
    }

    /// Reads the last checkpoint in a directory; if it is damaged, the one before. Returns with it the error of the
    /// last one, if any.
    ///
    /// # Errors
    /// [`Error::NoCheckpoint`]; [`Error::Read`] or [`Error::Checkpoint`] for the last file if none can be read.
    pub(crate) fn last(directory: &Path) -> Result<(Self, Option<Error>), Error> {
        let mut first_error = None;
        for path in files(directory).iter().rev() {
            match Self::read(path) {
                Ok(checkpoint) => return Ok((checkpoint, first_error)),
                Err(error) => first_error = first_error.or(Some(error)),
            }
        }
        Err(first_error.unwrap_or_else(|| Error::NoCheckpoint { directory: directory.to_owned() }))
    }
}

/// Returns step and time of the bytes of a checkpoint.
///
/// # Errors
/// A text with the cause, if they are not a checkpoint of this version of the format.
pub fn checkpoint_time(bytes: &[u8]) -> Result<(usize, f64), String> {
    Checkpoint::parse(bytes).map(|checkpoint| (checkpoint.header.step, checkpoint.header.time))
}

/// Returns the text of a scenario without end time and output, with the checksums of the tables that it names.
///
/// # Errors
/// [`Error::Text`], [`Error::Read`].
pub(crate) fn problem_text(file: &ScenarioFile) -> Result<String, Error> {
    let mut table = file.with_inputs(|_, path| Ok(format!("{:08x}", crc32fast::hash(&read(path)?))))?;
    if let Some(root) = table.as_table_mut() {
        root.remove("output");
        root.get_mut("time").and_then(|time| time.as_table_mut()).and_then(|time| time.remove("end"));
    }
    Ok(toml::to_string(&table)?)
}

/// Returns the first key of which two texts of scenarios have different values; an empty text if there is none.
pub(crate) fn first_difference(before: &str, after: &str) -> String {
    fn find(before: Option<&toml::Value>, after: Option<&toml::Value>, key: &str) -> Option<String> {
        let below = |name: &str| if key.is_empty() { name.to_owned() } else { format!("{key}.{name}") };
        match (before, after) {
            (Some(toml::Value::Table(before)), Some(toml::Value::Table(after))) => {
                let names = before.keys().chain(after.keys());
                names.into_iter().find_map(|name| find(before.get(name), after.get(name), &below(name)))
            }
            (Some(toml::Value::Array(before)), Some(toml::Value::Array(after))) => (0..before.len().max(after.len()))
                .find_map(|item| find(before.get(item), after.get(item), &below(&item.to_string()))),
            _ => (before != after).then(|| key.to_owned()),
        }
    }
    let [before, after] = [before, after].map(|text| text.parse().ok().map(toml::Value::Table));
    find(before.as_ref(), after.as_ref(), "").unwrap_or_default()
}

/// Returns the probes of a scenario, which determine the columns of `probes.csv`.
///
/// # Errors
/// [`Error::Text`].
pub(crate) fn probes_text(file: &ScenarioFile) -> Result<String, Error> {
    let table = file.with_inputs(|_, path| Ok(path.display().to_string()))?;
    let probes = table.get("output").and_then(|output| output.get("probes"));
    Ok(probes.map(toml::to_string).transpose()?.unwrap_or_default())
}

/// Removes all checkpoints in a directory but the last ones. A run that is killed after it has written a checkpoint
/// leaves one too many.
///
/// # Errors
/// [`Error::Write`].
pub(crate) fn keep_last(directory: &Path) -> Result<(), Error> {
    let files = files(directory);
    files[..files.len().saturating_sub(KEPT)].iter().try_for_each(|path| remove(path))
}

/// Removes the checkpoints in a directory.
///
/// # Errors
/// [`Error::Write`].
pub(crate) fn remove_all(directory: &Path) -> Result<(), Error> {
    files(directory).iter().try_for_each(|path| remove(path))
}

fn remove(path: &Path) -> Result<(), Error> {
    std::fs::remove_file(path).map_err(|source| Error::Write { path: path.to_owned(), source })
}

/// Returns the steps of the checkpoints in a directory, in order.
pub fn checkpoint_steps(directory: &Path) -> Vec<usize> {
    let entries = std::fs::read_dir(directory).into_iter().flatten();
    let names = entries.filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()));
    let step = |name: String| name.strip_prefix("checkpoint-")?.strip_suffix(".bin")?.parse().ok();
    let mut steps: Vec<usize> = names.filter_map(step).collect();
    steps.sort_unstable();
    steps
}

/// Returns the path of the checkpoint of a step.
fn path(directory: &Path, step: usize) -> PathBuf {
    directory.join(format!("checkpoint-{step:08}.bin"))
}

/// Returns the checkpoints in a directory, the last one at the end.
fn files(directory: &Path) -> Vec<PathBuf> {
    checkpoint_steps(directory).into_iter().map(|step| path(directory, step)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary::Summary;

    fn bytes(test: &str) -> Vec<u8> {
        let directory = std::env::temp_dir().join(format!("cutwater-{test}-{}", std::process::id()));
        std::fs::create_dir_all(&directory).expect("a directory");
        let header = Header {
            step: 12,
            n_steps: 20,
            time: 0.1 + 0.2,
            scenario: "name = \"a\"".to_owned(),
            lists: vec![2, 0],
            memory: vec![1],
            histories: [10, 20, 0],
            summary: SummaryBuilder::new(Summary { dt: 0.1, ..Summary::default() }, 1.0),
            series: vec![vec![(0.1, "a".to_owned())]],
        };
        let (lists, memory) = (vec![vec![1.0 / 3.0, f64::NAN], vec![]], vec![vec![-0.0]]);
        Checkpoint { header, lists, memory }.write(&directory).expect("a file");
        let bytes = read(&directory.join("checkpoint-00000012.bin")).expect("the file");
        std::fs::remove_dir_all(directory).expect("the directory");
        bytes
    }

    #[test]
    fn the_first_difference_of_two_scenarios_is_found() {
        let text = "name = \"a\"\n[[body]]\nshape = { min = [0, 1] }\n[time]\nstep = 0.1\n";
        let differs = |from: &str, to: &str| first_difference(text, &text.replace(from, to));
        assert_eq!(differs("1]", "2]"), "body.0.shape.min.1");
        assert_eq!(differs("0.1", "0.2"), "time.step");
        assert_eq!(differs("step = 0.1", ""), "time.step");
        assert_eq!(differs("[time]", "density = 1\n[time]"), "body.0.density");
        assert_eq!(differs("", ""), "");
    }

    #[test]
    fn a_checkpoint_is_read_as_it_was_written() {
        let found = Checkpoint::parse(&bytes("written")).expect("a checkpoint");
        assert_eq!((found.header.step, found.header.time), (12, 0.1 + 0.2));
        assert_eq!(found.lists[0][0], 1.0 / 3.0);
        assert!(found.lists[0][1].is_nan() && found.lists[1].is_empty() && found.memory[0][0].is_sign_negative());
    }

    /// Checks that a change of any byte, and any missing end, is found.
    #[test]
    fn damage_is_found() {
        let whole = bytes("damaged");
        for at in 0..whole.len() {
            let mut changed = whole.clone();
            changed[at] ^= 1;
            assert!(Checkpoint::parse(&changed).is_err(), "byte {at}");
            assert!(Checkpoint::parse(&whole[..at]).is_err(), "the first {at} bytes");
        }
        let mut other = whole.clone();
        other[8] = FORMAT as u8 + 1;
        assert!(Checkpoint::parse(&other).is_err_and(|problem| problem.contains(&format!("version {}", FORMAT + 1))));
        assert!(Checkpoint::parse(b"something else").is_err_and(|problem| problem.contains("not a checkpoint")));
    }
}
