//! Meshes without outside tools.
use crate::{Error, SimplexMesh};

/// Size field.
#[derive(Clone, Debug, PartialEq)]
pub struct Size(f64);
impl Size {
    /// The same size everywhere.
    pub fn uniform(h: f64) -> Self {
        Self(h)
    }
}
/// A box.
pub fn graded_box<const D: usize>(_min: [f64; D], _max: [f64; D], _size: &Size) -> Result<SimplexMesh<D>, Error> {
    Err(Error::Dimension { shape: "box", dimension: D })
}
