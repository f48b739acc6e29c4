//! Defects of surface files.

/// Where a surface file is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Its name.
    Name,
    /// A line, from 1.
    Line(usize),
    /// A byte, from 0.
    Byte(usize),
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Name => f.write_str("name"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Defects of a surface file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{at}: {what}")]
pub struct Malformed {
    /// Where.
    pub at: Place,
    /// The defect, and the expected content.
    pub what: String,
}

impl Malformed {
    pub(super) fn line(line: usize, what: impl Into<String>) -> Self {
        Self { at: Place::Line(line), what: what.into() }
    }
}
