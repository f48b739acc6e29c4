//! Kinds of elements, by their numbers in the format.

/// Kind of an element that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kind {
    pub(super) number: i32,
    pub(super) dimension: usize,
    pub(super) order: usize,
    pub(super) n_nodes: usize,
}

/// Kinds that are read. Source: Gmsh reference manual, element types.
const KINDS: [Kind; 7] = [
    Kind { number: 15, dimension: 0, order: 1, n_nodes: 1 },
    Kind { number: 1, dimension: 1, order: 1, n_nodes: 2 },
    Kind { number: 2, dimension: 2, order: 1, n_nodes: 3 },
    Kind { number: 4, dimension: 3, order: 1, n_nodes: 4 },
    Kind { number: 8, dimension: 1, order: 2, n_nodes: 3 },
    Kind { number: 9, dimension: 2, order: 2, n_nodes: 6 },
    Kind { number: 11, dimension: 3, order: 2, n_nodes: 10 },
];

impl Kind {
    /// Returns the kind with a number.
    ///
    /// # Errors
    /// A text with the name of the kind and a remedy, if its elements are not read.
    pub(super) fn with_number(number: i32) -> Result<Self, String> {
        let known = KINDS.into_iter().find(|kind| kind.number == number);
        known.ok_or_else(|| match number {
            3 | 10 | 16 => refused("a quadrangle", "make the mesh of triangles, without recombination"),
            5 | 12 | 17 => refused("a hexahedron", "make the mesh of tetrahedra"),
            6 | 13 | 18 => refused("a prism", "make the mesh of tetrahedra, without layers of prisms"),
            7 | 14 | 19 => refused("a pyramid", "make the mesh of tetrahedra"),
            20..=31 | 92 | 93 => refused("of order 3 or higher", "make the mesh of order 1 or 2 (`gmsh -order 2`)"),
            _ => refused(&format!("of the unknown kind {number}"), "make the mesh of triangles or tetrahedra"),
        })
    }

    /// Returns the kind of the elements of a dimension and order.
    pub(super) fn of(dimension: usize, order: usize) -> Option<Self> {
        KINDS.into_iter().find(|kind| kind.dimension == dimension && kind.order == order)
    }
}

fn refused(found: &str, remedy: &str) -> String {
    format!("this element is {found}, which is not read; {remedy}")
}

/// Corners at the ends of the edges of an element of order 2, in the order of the nodes in the format.
///
/// Source: Gmsh reference manual, node ordering.
pub(super) fn edges(dimension: usize) -> &'static [[usize; 2]] {
    const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [3, 0], [2, 3], [1, 3]];
    match dimension {
        1 => &EDGES[..1],
        2 => &EDGES[..3],
        _ => &EDGES,
    }
}
