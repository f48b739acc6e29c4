//! A conforming mesh of simplices.

use std::sync::OnceLock;

use crate::search::CellIndex;
use crate::topology::Topology;
use crate::{BoundaryMesh, CellId, Error, FacetId, MAX_CELL_VERTICES, Point, Simplex, Tag, VertexId, simplex_measure};

/// A conforming mesh of triangles (D = 2) or tetrahedra (D = 3), immutable after construction.
///
/// Every cell is positively oriented, every facet belongs to one or two cells. Boundary facets may carry a
/// [`Tag`], an index into [`SimplexMesh::tag_names`].
#[derive(Clone, Debug)]
pub struct SimplexMesh<const D: usize> {
    vertices: Vec<Point<D>>,
    cell_to_vertex: Vec<VertexId>,
    topology: Topology,
    measures: Measures,
    tag_names: Vec<String>,
    facet_tag: Vec<Option<Tag>>,
    cell_index: OnceLock<CellIndex<D>>,
}

/// Volumes and areas, for all that passes over the whole mesh again and again.
#[derive(Clone, Debug)]
struct Measures {
    cell_to_volume: Vec<f64>,
    facet_to_measure: Vec<f64>,
    volume: f64,
}

impl<const D: usize> SimplexMesh<D> {
    /// A mesh from its vertices and the flat connectivity of its cells.
    ///
    /// Shapes: `cell_to_vertex` has stride `D + 1`.
    ///
    /// # Errors
    /// Wrong stride, no cells, unknown vertices, coordinates that are not finite, cells without positive volume,
    /// facets with more than two cells.
    pub fn new(vertices: Vec<Point<D>>, cell_to_vertex: Vec<VertexId>) -> Result<Self, Error> {
        const { assert!(D == 2 || D == 3, "meshes are of dimension 2 or 3") };
        let stride = D + 1;
        if !cell_to_vertex.len().is_multiple_of(stride) {
            return Err(Error::Stride { length: cell_to_vertex.len(), stride });
        }
        if cell_to_vertex.is_empty() {
            return Err(Error::Empty);
        }
        if let Some(index) = vertices.iter().position(|x| x.iter().any(|c| !c.is_finite())) {
            return Err(Error::NotFinite { vertex: VertexId::new(index) });
        }
        let mut cell_to_volume = Vec::with_capacity(cell_to_vertex.len() / stride);
        for (index, cell_vertices) in cell_to_vertex.chunks_exact(stride).enumerate() {
            let cell = CellId::new(index);
            if let Some(&vertex) = cell_vertices.iter().find(|v| v.index() >= vertices.len()) {
                return Err(Error::UnknownVertex { cell, vertex, n_vertices: vertices.len() });
            }
            let volume = simplex(&vertices, cell_vertices).volume();
            if volume.is_nan() || volume <= 0.0 {
                return Err(Error::Orientation { cell, volume });
            }
            cell_to_volume.push(volume);
        }
        let topology = Topology::new::<D>(&cell_to_vertex)?;
        let facet_to_measure = topology
            .facet_to_vertex
            .chunks_exact(D)
            .map(|corners| {
                let mut points = [Point::zeros(); MAX_CELL_VERTICES];
                for (slot, v) in points.iter_mut().zip(corners) {
                    *slot = vertices[v.index()];
                }
                simplex_measure(&points[..D])
            })
            .collect();
        let measures = Measures { volume: cell_to_volume.iter().sum(), cell_to_volume, facet_to_measure };
        let facet_tag = vec![None; topology.facet_to_cell.len()];
        Ok(Self {
            vertices,
            cell_to_vertex,
            topology,
            measures,
            tag_names: Vec::new(),
            facet_tag,
            cell_index: OnceLock::new(),
        })
    }

    /// The same mesh with its boundary facets tagged: `name_of` maps the points of a boundary facet to the name
    /// of its part of the boundary, or to `None`.
    #[must_use]
    pub fn with_boundary_tags<'a>(self, name_of: impl Fn(&[Point<D>]) -> Option<&'a str>) -> Self {
        let names: Vec<Option<&'a str>> = self
            .facets()
            .map(|facet| {
                let mut points = [Point::zeros(); MAX_CELL_VERTICES];
                for (slot, v) in points.iter_mut().zip(self.facet(facet)) {
                    *slot = self.vertices[v.index()];
                }
                self.is_boundary(facet).then(|| name_of(&points[..D])).flatten()
            })
            .collect();
        self.with_facet_tags(|facet| names[facet.index()])
    }

    /// The same mesh with its boundary facets tagged: `name_of` maps a boundary facet to the name of its part of
    /// the boundary, or to `None`. It is not called for interior facets.
    #[must_use]
    pub fn with_facet_tags<'a>(mut self, name_of: impl Fn(FacetId) -> Option<&'a str>) -> Self {
        for facet in self.facets() {
            let name = if self.is_boundary(facet) { name_of(facet) } else { None };
            self.facet_tag[facet.index()] = name.map(|name| {
                let known = self.tag_names.iter().position(|n| n == name);
                Tag::new(known.unwrap_or_else(|| {
                    self.tag_names.push(name.to_owned());
                    self.tag_names.len() - 1
                }))
            });
        }
        self
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.vertices.len()
    }

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.cell_to_vertex.len() / (D + 1)
    }

    /// Number of facets.
    pub fn n_facets(&self) -> usize {
        self.topology.facet_to_cell.len()
    }

    /// All cells in order.
    pub fn cells(&self) -> impl Iterator<Item = CellId> + use<D> {
        (0..self.n_cells()).map(CellId::new)
    }

    /// All facets in order.
    pub fn facets(&self) -> impl Iterator<Item = FacetId> + use<D> {
        (0..self.n_facets()).map(FacetId::new)
    }

    /// Positions of the vertices.
    pub fn vertices(&self) -> &[Point<D>] {
        &self.vertices
    }

    /// Position of a vertex.
    #[inline]
    pub fn vertex(&self, vertex: VertexId) -> Point<D> {
        self.vertices[vertex.index()]
    }

    /// Vertices of a cell, `D + 1` of them.
    #[inline]
    pub fn cell(&self, cell: CellId) -> &[VertexId] {
        &self.cell_to_vertex[cell.index() * (D + 1)..][..=D]
    }

    /// A cell as a simplex.
    #[inline]
    pub fn simplex(&self, cell: CellId) -> Simplex<D> {
        simplex(&self.vertices, self.cell(cell))
    }

    /// A cell as a simplex, with its vertices at other positions (one per vertex of the mesh).
    #[inline]
    pub fn simplex_at(&self, cell: CellId, positions: &[Point<D>]) -> Simplex<D> {
        simplex(positions, self.cell(cell))
    }

    /// Volume (area in 2D) of a cell.
    #[inline]
    pub fn cell_volume(&self, cell: CellId) -> f64 {
        self.measures.cell_to_volume[cell.index()]
    }

    /// Volume (area in 2D) of all cells.
    pub fn volume(&self) -> f64 {
        self.measures.volume
    }

    /// Area (length in 2D) of a facet.
    #[inline]
    pub fn facet_measure(&self, facet: FacetId) -> f64 {
        self.measures.facet_to_measure[facet.index()]
    }

    /// Vertices of a facet, `D` of them, ordered outwards as seen from its first cell.
    #[inline]
    pub fn facet(&self, facet: FacetId) -> &[VertexId] {
        &self.topology.facet_to_vertex[facet.index() * D..][..D]
    }

    /// The one or two cells of a facet.
    #[inline]
    pub fn facet_to_cell(&self, facet: FacetId) -> [Option<CellId>; 2] {
        self.topology.facet_to_cell[facet.index()]
    }

    /// Facets of a cell, `D + 1` of them; the one at `i` lies opposite to the vertex at `i`.
    #[inline]
    pub fn cell_to_facet(&self, cell: CellId) -> &[FacetId] {
        &self.topology.cell_to_facet[cell.index() * (D + 1)..][..=D]
    }

    /// The cell on the other side of a facet.
    #[inline]
    pub fn neighbour(&self, cell: CellId, facet: FacetId) -> Option<CellId> {
        let [a, b] = self.facet_to_cell(facet);
        if a == Some(cell) { b } else { a }
    }

    /// Whether a facet has one cell only.
    #[inline]
    pub fn is_boundary(&self, facet: FacetId) -> bool {
        self.facet_to_cell(facet)[1].is_none()
    }

    /// The cells at their own positions, arranged for search; built at the first call.
    pub fn cell_index(&self) -> &CellIndex<D> {
        self.cell_index.get_or_init(|| CellIndex::new(self, &self.vertices))
    }

    /// Names of the tags.
    pub fn tag_names(&self) -> &[String] {
        &self.tag_names
    }

    /// The tag of that name.
    pub fn tag(&self, name: &str) -> Option<Tag> {
        self.tag_names.iter().position(|n| n == name).map(Tag::new)
    }

    /// Tag of a facet; interior facets have none.
    pub fn facet_tag(&self, facet: FacetId) -> Option<Tag> {
        self.facet_tag[facet.index()]
    }

    /// The boundary of the mesh: facets with one cell, oriented outwards.
    pub fn boundary(&self) -> BoundaryMesh<D> {
        let mut facet_to_vertex = Vec::new();
        let mut facet_to_cell = Vec::new();
        let mut tags = Vec::new();
        for facet in self.facets().filter(|&f| self.is_boundary(f)) {
            facet_to_vertex.extend_from_slice(self.facet(facet));
            facet_to_cell.extend(self.facet_to_cell(facet)[0]);
            tags.push(self.facet_tag(facet));
        }
        BoundaryMesh::new(facet_to_vertex, facet_to_cell, tags)
    }
}

#[inline]
fn simplex<const D: usize>(positions: &[Point<D>], vertices: &[VertexId]) -> Simplex<D> {
    let mut points = [Point::zeros(); MAX_CELL_VERTICES];
    for (slot, v) in points.iter_mut().zip(vertices) {
        *slot = positions[v.index()];
    }
    Simplex::new(&points[..=D])
}
