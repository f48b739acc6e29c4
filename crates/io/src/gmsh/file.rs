//! Content of a Gmsh file.

use std::collections::HashMap;
use std::fmt;

/// Version of the format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GmshVersion {
    /// 2.2
    V22,
    /// 4.1
    V41,
}

impl fmt::Display for GmshVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::V22 => "2.2",
            Self::V41 => "4.1",
        })
    }
}

/// Content of a file: nodes, elements of each dimension, and names of physical groups.
#[derive(Clone, Debug)]
pub struct GmshFile {
    pub(super) version: GmshVersion,
    /// Positions of the nodes, with three components also in 2D.
    pub(super) points: Vec<[f64; 3]>,
    /// Elements of each dimension, 0 to 3.
    pub(super) elements: [Elements; 4],
    /// Names of physical groups, by dimension and number of the group.
    pub(super) names: HashMap<(usize, i32), String>,
}

/// Elements of one dimension.
#[derive(Clone, Debug, Default)]
pub(super) struct Elements {
    /// Order of the elements, all equal; 0 without elements.
    pub(super) order: usize,
    /// Indices of points. Each element has the same number of nodes.
    pub(super) nodes: Vec<usize>,
    /// Numbers of the elements in the file.
    pub(super) numbers: Vec<u64>,
    /// First physical group of each element; 0 for none.
    pub(super) groups: Vec<i32>,
    /// Elements in several groups.
    pub(super) n_ambiguous: usize,
}

impl Elements {
    /// Returns the nodes of each element.
    pub(super) fn nodes(&self) -> std::slice::ChunksExact<'_, usize> {
        self.nodes.chunks_exact(self.nodes.len().checked_div(self.numbers.len()).unwrap_or(1).max(1))
    }
}

impl GmshFile {
    /// Returns the version of the format.
    pub fn version(&self) -> GmshVersion {
        self.version
    }

    /// Returns whether there are elements of a dimension.
    pub fn has_cells(&self, dimension: usize) -> bool {
        self.elements.get(dimension).is_some_and(|elements| !elements.numbers.is_empty())
    }

    /// Returns the order of the elements of a dimension, 1 or 2; 0 without elements.
    pub fn order(&self, dimension: usize) -> usize {
        self.elements.get(dimension).map_or(0, |elements| elements.order)
    }

    /// Returns the dimension of space. It is 3 if there are tetrahedra or if the third coordinates of the nodes of the
    /// triangles (without triangles: of the lines) differ; otherwise 2.
    pub fn dimension(&self) -> usize {
        let [_, lines, triangles, _] = &self.elements;
        let planar = if self.has_cells(2) { triangles } else { lines };
        if self.has_cells(3) || self.is_spatial(planar.nodes.iter().copied()) { 3 } else { 2 }
    }

    /// Returns whether the third coordinates of nodes differ by more than round-off, relative to the other extents.
    pub(super) fn is_spatial(&self, nodes: impl Iterator<Item = usize> + Clone) -> bool {
        const ROUND_OFF: f64 = 1e-9;
        let extent = |axis: usize| {
            let coordinates = nodes.clone().map(|node| self.points[node][axis]);
            let (low, high) =
                coordinates.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            high - low
        };
        extent(2) > ROUND_OFF * extent(0).max(extent(1))
    }

    /// Returns the name of a physical group: its number if it has no name, `None` for number 0.
    pub(super) fn group_name(&self, dimension: usize, number: i32) -> Option<String> {
        let name = || self.names.get(&(dimension, number)).cloned().unwrap_or_else(|| number.to_string());
        (number != 0).then(name)
    }
}
