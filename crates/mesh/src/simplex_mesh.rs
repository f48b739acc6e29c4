//! A conforming mesh of simplices.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use crate::search::CellIndex;
use crate::simplex::points_of;
use crate::topology::Topology;
use crate::{
    BoundaryMesh, CellId, Coordinates, Error, FacetId, MAX_CELL_VERTICES, MAX_FACET_VERTICES, Point, Simplex, Tag,
    Vector, VertexId, facet_normal, simplex_measure,
};

/// A conforming mesh of triangles (D = 2) or tetrahedra (D = 3), immutable after construction.
///
/// Every cell is positively oriented, every facet belongs to one or two cells. Boundary facets and cells may carry a
/// [`Tag`], an index into [`SimplexMesh::tag_names`]: the name of a part of the boundary, or of a group of cells.
#[derive(Clone, Debug)]
pub struct SimplexMesh<const D: usize> {
    vertices: Vec<Point<D>>,
    cell_to_vertex: Vec<VertexId>,
    topology: Topology,
    measures: Measures,
    coordinates: Coordinates,
    tag_names: Vec<String>,
    facet_tag: Vec<Option<Tag>>,
    cell_tag: Vec<Option<Tag>>,
    cell_index: OnceLock<CellIndex<D>>,
}

/// Stored volumes and areas, without the weight of the coordinates.
#[derive(Clone, Debug)]
struct Measures {
    cell_to_volume: Vec<f64>,
    facet_to_measure: Vec<f64>,
    volume: f64,
}

impl<const D: usize> SimplexMesh<D> {
    /// Creates a mesh from its vertices and the vertices of its cells.
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
            .map(|corners| simplex_measure(&points_of::<D, MAX_FACET_VERTICES>(&vertices, corners)[..D]))
            .collect();
        let measures = Measures { volume: cell_to_volume.iter().sum(), cell_to_volume, facet_to_measure };
        Ok(Self {
            facet_tag: vec![None; topology.facet_to_cell.len()],
            cell_tag: vec![None; cell_to_vertex.len() / stride],
            vertices,
            cell_to_vertex,
            topology,
            measures,
            coordinates: Coordinates::default(),
            tag_names: Vec::new(),
            cell_index: OnceLock::new(),
        })
    }

    /// Returns the mesh with its vertices moved by `map`, with the same tags and coordinates.
    ///
    /// # Errors
    /// Positions that are not finite, cells without positive volume, negative radii in axisymmetric coordinates.
    pub fn mapped(&self, map: impl Fn(&Point<D>) -> Point<D>) -> Result<Self, Error> {
        let mut moved = Self::new(self.vertices.iter().map(map).collect(), self.cell_to_vertex.clone())?;
        moved.tag_names.clone_from(&self.tag_names);
        moved.facet_tag.clone_from(&self.facet_tag);
        moved.cell_tag.clone_from(&self.cell_tag);
        moved.with_coordinates(self.coordinates)
    }

    /// Returns the mesh in the given coordinates; those of a new mesh are Cartesian. Sizes, measures of cells and
    /// facets, and normals do not depend on the coordinates.
    ///
    /// # Errors
    /// For axisymmetric coordinates, [`Error::AxisInSpace`] if `D = 3` and [`Error::BehindAxis`] if a vertex has a
    /// negative radius.
    pub fn with_coordinates(self, coordinates: Coordinates) -> Result<Self, Error> {
        let Some(radial) = coordinates.radial() else { return Ok(Self { coordinates, ..self }) };
        if D != 2 {
            return Err(Error::AxisInSpace);
        }
        if let Some(index) = self.vertices.iter().position(|x| x[radial] < 0.0) {
            return Err(Error::BehindAxis { vertex: VertexId::new(index), radius: self.vertices[index][radial] });
        }
        Ok(Self { coordinates, ..self })
    }

    /// Returns the coordinates.
    #[inline]
    pub fn coordinates(&self) -> Coordinates {
        self.coordinates
    }

    /// Returns the mesh with tags on its boundary facets. `name_of` maps the points of a boundary facet to the name of
    /// its part of the boundary, or to `None`.
    #[must_use]
    pub fn with_boundary_tags<'a>(self, name_of: impl Fn(&[Point<D>]) -> Option<&'a str>) -> Self {
        let name = |facet| if self.is_boundary(facet) { name_of(&self.facet_points(facet)[..D]) } else { None };
        let names: Vec<Option<&'a str>> = self.facets().map(name).collect();
        self.with_facet_tags(|facet| names[facet.index()])
    }

    /// Returns the mesh with tags on its boundary facets. `name_of` maps a boundary facet to the name of its part of
    /// the boundary, or to `None`; it is not called for interior facets.
    #[must_use]
    pub fn with_facet_tags<'a>(mut self, name_of: impl Fn(FacetId) -> Option<&'a str>) -> Self {
        for facet in self.facets() {
            let name = if self.is_boundary(facet) { name_of(facet) } else { None };
            self.facet_tag[facet.index()] = name.map(|name| self.named(name));
        }
        self
    }

    /// Returns the mesh with its cells in groups. `name_of` maps a cell to the name of its group, or to `None`.
    #[must_use]
    pub fn with_cell_tags<'a>(mut self, name_of: impl Fn(CellId) -> Option<&'a str>) -> Self {
        for cell in self.cells() {
            self.cell_tag[cell.index()] = name_of(cell).map(|name| self.named(name));
        }
        self
    }

    /// Returns the tag of a name. Adds the name if no tag has it.
    fn named(&mut self, name: &str) -> Tag {
        self.tag(name).unwrap_or_else(|| {
            self.tag_names.push(name.to_owned());
            Tag::new(self.tag_names.len() - 1)
        })
    }

    /// Returns the number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.vertices.len()
    }

    /// Returns the number of cells.
    pub fn n_cells(&self) -> usize {
        self.cell_to_vertex.len() / (D + 1)
    }

    /// Returns the number of facets.
    pub fn n_facets(&self) -> usize {
        self.topology.facet_to_cell.len()
    }

    /// Returns all cells in ascending order.
    pub fn cells(&self) -> impl Iterator<Item = CellId> + use<D> {
        (0..self.n_cells()).map(CellId::new)
    }

    /// Returns all facets in ascending order.
    pub fn facets(&self) -> impl Iterator<Item = FacetId> + use<D> {
        (0..self.n_facets()).map(FacetId::new)
    }

    /// Returns the positions of the vertices.
    pub fn vertices(&self) -> &[Point<D>] {
        &self.vertices
    }

    /// Returns the position of a vertex.
    #[inline]
    pub fn vertex(&self, vertex: VertexId) -> Point<D> {
        self.vertices[vertex.index()]
    }

    /// Returns the vertices of a cell, `D + 1` of them.
    #[inline]
    pub fn cell(&self, cell: CellId) -> &[VertexId] {
        &self.cell_to_vertex[cell.index() * (D + 1)..][..=D]
    }

    /// Returns a cell as a simplex.
    #[inline]
    pub fn simplex(&self, cell: CellId) -> Simplex<D> {
        simplex(&self.vertices, self.cell(cell))
    }

    /// Returns a cell as a simplex with its vertices at other positions (one per vertex of the mesh).
    #[inline]
    pub fn simplex_at(&self, cell: CellId, positions: &[Point<D>]) -> Simplex<D> {
        simplex(positions, self.cell(cell))
    }

    /// Returns the volume (area in 2D) of a cell.
    #[inline]
    pub fn cell_volume(&self, cell: CellId) -> f64 {
        self.measures.cell_to_volume[cell.index()]
    }

    /// Returns the volume (area in 2D) of all cells.
    pub fn volume(&self) -> f64 {
        self.measures.volume
    }

    /// Returns the area (length in 2D) of a facet.
    #[inline]
    pub fn facet_measure(&self, facet: FacetId) -> f64 {
        self.measures.facet_to_measure[facet.index()]
    }

    /// Returns the `D` vertices of a facet, oriented outwards from its first cell.
    #[inline]
    pub fn facet(&self, facet: FacetId) -> &[VertexId] {
        &self.topology.facet_to_vertex[facet.index() * D..][..D]
    }

    /// Returns the positions of the vertices of a facet; only the first `D` are used.
    #[inline]
    pub fn facet_points(&self, facet: FacetId) -> [Point<D>; MAX_FACET_VERTICES] {
        points_of(&self.vertices, self.facet(facet))
    }

    /// Returns the one or two cells of a facet; the second entry is `None` on the boundary.
    #[inline]
    pub fn facet_to_cell(&self, facet: FacetId) -> [Option<CellId>; 2] {
        self.topology.facet_to_cell[facet.index()]
    }

    /// Returns the `D + 1` facets of a cell; facet `i` is opposite to vertex `i`.
    #[inline]
    pub fn cell_to_facet(&self, cell: CellId) -> &[FacetId] {
        &self.topology.cell_to_facet[cell.index() * (D + 1)..][..=D]
    }

    /// Returns whether a facet belongs to one cell only.
    #[inline]
    pub fn is_boundary(&self, facet: FacetId) -> bool {
        self.facet_to_cell(facet)[1].is_none()
    }

    /// Returns the search structure for the cells; built by the first call.
    pub fn cell_index(&self) -> &CellIndex<D> {
        self.cell_index.get_or_init(|| self.cell_index_at(&self.vertices))
    }

    /// Builds a search structure for the cells with the vertices at other positions (one per vertex of the mesh).
    pub fn cell_index_at(&self, positions: &[Point<D>]) -> CellIndex<D> {
        CellIndex::new(self.cells().map(|cell| self.simplex_at(cell, positions)).collect())
    }

    /// Returns the names of the tags.
    pub fn tag_names(&self) -> &[String] {
        &self.tag_names
    }

    /// Returns the tag with the given name.
    pub fn tag(&self, name: &str) -> Option<Tag> {
        self.tag_names.iter().position(|n| n == name).map(Tag::new)
    }

    /// Returns the names of the parts of the boundary, in the order of their tags.
    pub fn boundary_names(&self) -> Vec<&str> {
        self.names_of(&self.facet_tag)
    }

    /// Returns the names of the groups of cells, in the order of their tags.
    pub fn group_names(&self) -> Vec<&str> {
        self.names_of(&self.cell_tag)
    }

    fn names_of(&self, tags: &[Option<Tag>]) -> Vec<&str> {
        let in_use: BTreeSet<usize> = tags.iter().flatten().map(|tag| tag.index()).collect();
        in_use.into_iter().map(|tag| self.tag_names[tag].as_str()).collect()
    }

    /// Returns the tag of a facet; `None` for interior facets and for boundary facets without a tag.
    pub fn facet_tag(&self, facet: FacetId) -> Option<Tag> {
        self.facet_tag[facet.index()]
    }

    /// Returns the tag of a cell; `None` for a cell without a group.
    pub fn cell_tag(&self, cell: CellId) -> Option<Tag> {
        self.cell_tag[cell.index()]
    }

    /// Returns the outward unit normal of the facets with a tag; `None` if there are none or they do not lie in one
    /// plane.
    ///
    /// Normals may differ by 1e-9, and distances from the plane may be 1e-9 times distances within the plane.
    pub fn tag_normal(&self, tag: Tag) -> Option<Vector<D>> {
        const TOLERANCE: f64 = 1e-9;
        let mut plane = None;
        for facet in self.facets().filter(|facet| self.facet_tag(*facet) == Some(tag)) {
            let points = &self.facet_points(facet)[..D];
            let normal = facet_normal(points);
            let (origin, common) = *plane.get_or_insert((points[0], normal));
            let is_off = |x: &Point<D>| (x - origin).dot(&common).abs() > TOLERANCE * (x - origin).norm();
            if (normal - common).norm() > TOLERANCE || points.iter().any(is_off) {
                return None;
            }
        }
        plane.map(|(_, normal)| normal)
    }

    /// Returns the boundary of the mesh: facets with one cell, oriented outwards.
    pub fn boundary(&self) -> BoundaryMesh<D> {
        let mut facet_to_vertex = Vec::new();
        let mut facet_to_cell = Vec::new();
        let mut tags = Vec::new();
        for facet in self.facets().filter(|&f| self.is_boundary(f)) {
            facet_to_vertex.extend_from_slice(self.facet(facet));
            facet_to_cell.extend(self.facet_to_cell(facet)[0]);
            tags.push(self.facet_tag(facet));
        }
        BoundaryMesh::new(facet_to_vertex, facet_to_cell, tags).with_coordinates(self.coordinates)
    }
}

#[inline]
fn simplex<const D: usize>(positions: &[Point<D>], vertices: &[VertexId]) -> Simplex<D> {
    Simplex::new(&points_of::<D, MAX_CELL_VERTICES>(positions, vertices)[..=D])
}

#[cfg(test)]
mod tests {
    use crate::generate::{BallOptions, Size, graded_box, half_ball, structured_box};
    use crate::{SimplexMesh, Vector, VertexId};

    fn normal<const D: usize>(mesh: &SimplexMesh<D>, name: &str) -> Option<Vector<D>> {
        mesh.tag_normal(mesh.tag(name).unwrap())
    }

    #[test]
    fn cells_have_groups_of_their_own() {
        let mesh = structured_box([0.0, 0.0], [2.0, 1.0], [4, 1]).unwrap();
        let is_left = |mesh: &SimplexMesh<2>, cell| mesh.simplex(cell).centroid()[0] < 1.0;
        let whole = mesh.clone();
        let mesh = mesh.with_cell_tags(|cell| is_left(&whole, cell).then_some("left"));
        let moved = mesh.mapped(|x| x + Vector::<2>::new(5.0, 0.0)).unwrap();
        // The name of a side is that of a group, too.
        assert_eq!(moved.tag_names(), ["bottom", "top", "left", "right"].map(String::from).as_slice());
        assert_eq!((moved.boundary_names().len(), moved.group_names()), (4, vec!["left"]));
        let n_left = moved.cells().filter(|cell| moved.cell_tag(*cell) == moved.tag("left")).count();
        assert_eq!((n_left, moved.cells().filter(|cell| moved.cell_tag(*cell).is_none()).count()), (4, 4));
        let on_left = moved.facets().filter(|facet| moved.facet_tag(*facet) == moved.tag("left"));
        assert!(on_left.flat_map(|facet| moved.facet(facet)).all(|vertex| moved.vertex(*vertex)[0] == 5.0));
    }

    #[test]
    fn plane_parts_have_a_normal() {
        let plane = graded_box([0.0, 0.0], [1.0, 2.0], &Size::uniform(0.3)).unwrap();
        assert_eq!(normal(&plane, "left"), Some(Vector::<2>::new(-1.0, 0.0)));
        assert_eq!(normal(&plane, "top"), Some(Vector::<2>::new(0.0, 1.0)));
        let space = structured_box([0.0; 3], [1.0, 2.0, 3.0], [2, 2, 2]).unwrap();
        assert_eq!(normal(&space, "front"), Some(Vector::<3>::new(0.0, -1.0, 0.0)));
        let half = half_ball([1.0, 2.0], 1.0, 0.3, &BallOptions::default()).unwrap();
        assert_eq!(normal(&half, "left"), Some(Vector::<2>::new(-1.0, 0.0)));
        assert_eq!(normal(&half, "surface"), None);
        // One normal, but two planes.
        let at = |x: f64, y: f64| Vector::<2>::new(x, y);
        let vertices = vec![at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(2.0, 1.0), at(3.0, 1.0), at(2.0, 2.0)];
        let steps = SimplexMesh::new(vertices, (0..6).map(VertexId::new).collect()).unwrap();
        let steps = steps.with_boundary_tags(|points| (points[0][1] == points[1][1]).then_some("bottoms"));
        assert_eq!(normal(&steps, "bottoms"), None);
        let turned = Vector::<2>::new(0.6, 0.8);
        let along = Vector::<2>::new(0.8, -0.6);
        let vertices = plane.vertices().iter().map(|x| turned * x[0] - along * x[1]).collect();
        let cells = plane.cells().flat_map(|cell| plane.cell(cell).to_vec()).collect();
        let oblique = SimplexMesh::<2>::new(vertices, cells).unwrap();
        let oblique =
            oblique.with_boundary_tags(|points| points.iter().all(|x| x.dot(&turned) > 1.0 - 1e-12).then_some("end"));
        assert!((normal(&oblique, "end").unwrap() - turned).norm() < 1e-12);
    }
}
