//! The cells of a file as a mesh, with checks of their geometry.

use std::collections::{HashMap, HashSet};

use ::mesh::{CellId, MAX_FACET_VERTICES, Point, Simplex, SimplexMesh, Vector, VertexId, facet_normal};

use super::elements::edges;
use super::file::{Elements, GmshFile};

/// Mesh of a file.
#[derive(Clone, Debug)]
pub struct GmshMesh<const D: usize> {
    /// Cells spanned by the corner nodes of the elements. Tags of cells are physical groups of dimension `D`, tags of
    /// facets are physical groups of dimension `D - 1`.
    pub mesh: SimplexMesh<D>,
    /// Position of the node on each edge of elements of order 2. The key has the ends of the edge in ascending order.
    /// Empty for order 1.
    pub edge_nodes: HashMap<[VertexId; 2], Point<D>>,
    /// Cells whose nodes were reordered to make their volume positive.
    pub n_turned: usize,
    /// Elements of dimension `D - 1` that are in a group but not on the boundary. They have no effect.
    pub n_inside: usize,
    /// Elements in several groups. The first group is used.
    pub n_ambiguous: usize,
}

impl GmshFile {
    /// Returns the mesh of the triangles (`D = 2`) or tetrahedra (`D = 3`).
    ///
    /// Vertices are the corner nodes that cells use, in the order of the file. A cell may have either orientation in
    /// the file.
    ///
    /// # Errors
    /// A text with cause and remedy, if there are no cells, nodes are out of the plane in 2D, cells have no volume or
    /// overlap across a facet, or a facet has more than two cells.
    pub fn mesh<const D: usize>(&self) -> Result<GmshMesh<D>, String> {
        let elements = &self.elements[D];
        if elements.numbers.is_empty() {
            let cells = if D == 2 { "triangles" } else { "tetrahedra" };
            return Err(format!("the file has no {cells}; make a mesh of dimension {D} before saving (`gmsh -{D}`)"));
        }
        if D == 2 && self.is_spatial(elements.nodes.iter().copied()) {
            return Err(
                "its triangles do not lie in the plane of x and y; set dimension = 3, or project them".to_owned()
            );
        }
        let (vertices, vertex_of) = self.corners::<D>(elements, D + 1);
        let vertex = |node: &usize| vertex_of[*node];
        let (mut cells, mut of_cell, mut n_turned) = (Vec::new(), Vec::new(), 0);
        let (mut known, mut n_ambiguous) = (HashSet::new(), elements.n_ambiguous);
        for (k, nodes) in elements.nodes().enumerate() {
            let mut cell: Vec<VertexId> = nodes[..=D].iter().map(vertex).collect();
            if !known.insert(sorted(&cell)) {
                // Version 2.2 repeats elements that are in several groups.
                n_ambiguous += 1;
                continue;
            }
            let points: Vec<Point<D>> = cell.iter().map(|v| vertices[v.index()]).collect();
            let volume = Simplex::new(&points).volume();
            if volume.abs() <= FLAT * ::mesh::diameter(&points).powi(D as i32) {
                let place = place(&Simplex::new(&points).centroid());
                return Err(format!(
                    "element {} near {place} is degenerate (no area or volume); repair the mesh there",
                    elements.numbers[k]
                ));
            }
            if volume < 0.0 {
                cell.swap(D - 1, D);
                n_turned += 1;
            }
            cells.extend(cell);
            of_cell.push(k);
        }
        let number = |cell: CellId| elements.numbers[of_cell[cell.index()]];
        let mesh = SimplexMesh::new(vertices, cells).map_err(|error| match error {
            ::mesh::Error::NonManifold { cells: [a, b], .. } => {
                let (a, b, side) = (number(a), number(b), if D == 2 { "an edge" } else { "a face" });
                format!("the elements {a}, {b} and at least one more share {side}; remove surplus elements")
            }
            error => error.to_string(),
        })?;
        check_folds(&mesh, number)?;
        if let Some([a, b]) = mesh.cell_index().overlapping_cells() {
            let (place, a, b) = (place(&mesh.simplex(a).centroid()), number(a), number(b));
            return Err(format!(
                "the elements {a} and {b} overlap near {place}: parts of the mesh cover each other, or the same part is there twice; remove one of \
                 them, or unite the parts"
            ));
        }
        let groups: Vec<Option<String>> = of_cell.iter().map(|k| self.group_name(D, elements.groups[*k])).collect();
        let edge_nodes = self.edge_nodes(elements, vertex)?;
        let mesh = mesh.with_cell_tags(|cell| groups[cell.index()].as_deref());
        let (mesh, n_inside, n_more) = self.with_facet_groups(mesh, &vertex_of);
        Ok(GmshMesh { mesh, edge_nodes, n_turned, n_inside, n_ambiguous: n_ambiguous + n_more })
    }

    /// Returns the positions of the nodes that are corners of elements, and the vertex of each node of the file. Other
    /// nodes have an identifier of no vertex.
    pub(super) fn corners<const D: usize>(
        &self,
        elements: &Elements,
        n_corners: usize,
    ) -> (Vec<Point<D>>, Vec<VertexId>) {
        let mut is_used = vec![false; self.points.len()];
        elements.nodes().flat_map(|nodes| &nodes[..n_corners]).for_each(|node| is_used[*node] = true);
        let mut vertices = Vec::new();
        let no_vertex = VertexId::new(self.points.len());
        let vertex_of = self.points.iter().zip(is_used).map(|(x, is_used)| {
            if !is_used {
                return no_vertex;
            }
            vertices.push(Point::from_fn(|axis, _| x[axis]));
            VertexId::new(vertices.len() - 1)
        });
        let vertex_of = vertex_of.collect();
        (vertices, vertex_of)
    }

    /// Returns the position of the node on each edge; fails if two elements have different ones.
    fn edge_nodes<const D: usize>(
        &self,
        elements: &Elements,
        vertex: impl Fn(&usize) -> VertexId,
    ) -> Result<HashMap<[VertexId; 2], Point<D>>, String> {
        let mut edge_nodes = HashMap::new();
        if elements.order == 2 {
            for (nodes, number) in elements.nodes().zip(&elements.numbers) {
                for (ends, node) in edges(D).iter().zip(&nodes[D + 1..]) {
                    let [a, b] = ends.map(|k| vertex(&nodes[k]));
                    let position = |node: usize| Point::<D>::from_fn(|axis, _| self.points[node][axis]);
                    let (x, length) = (position(*node), (position(nodes[ends[0]]) - position(nodes[ends[1]])).norm());
                    let other = edge_nodes.insert([a.min(b), a.max(b)], x);
                    if other.is_some_and(|other| (other - x).norm() > FLAT.sqrt() * length) {
                        let place = place(&x);
                        return Err(format!(
                            "element {number} and one before it have different nodes in the middle of their common edge near {place}; unite the parts of the mesh there, \
                             with these nodes"
                        ));
                    }
                }
            }
        }
        Ok(edge_nodes)
    }

    /// Returns the mesh with tags of its boundary facets, the number of facet elements in groups that are not on the
    /// boundary, and the number of facet elements in several groups.
    fn with_facet_groups<const D: usize>(
        &self,
        mesh: SimplexMesh<D>,
        vertex_of: &[VertexId],
    ) -> (SimplexMesh<D>, usize, usize) {
        let facets = &self.elements[D - 1];
        let mut groups = HashMap::new();
        let mut n_ambiguous = facets.n_ambiguous;
        // Group 0: the element is in no physical group.
        for (nodes, group) in facets.nodes().zip(&facets.groups).filter(|(_, group)| **group != 0) {
            let corners: Vec<VertexId> = nodes[..D].iter().map(|node| vertex_of[*node]).collect();
            let first = *groups.entry(sorted(&corners)).or_insert(*group);
            n_ambiguous += usize::from(first != *group);
        }
        let group = |facet| groups.get(&sorted(mesh.facet(facet)));
        let of_facet = |facet| if mesh.is_boundary(facet) { self.group_name(D - 1, *group(facet)?) } else { None };
        let names: Vec<Option<String>> = mesh.facets().map(of_facet).collect();
        let n_inside = groups.len() - names.iter().flatten().count();
        (mesh.with_facet_tags(|facet| names[facet.index()].as_deref()), n_inside, n_ambiguous)
    }
}

/// Largest volume of a degenerate cell, divided by its diameter to the power `D`.
const FLAT: f64 = 1e-14;

/// Checks that the two cells of each interior facet lie on opposite sides of it.
fn check_folds<const D: usize>(mesh: &SimplexMesh<D>, number: impl Fn(CellId) -> u64) -> Result<(), String> {
    for facet in mesh.facets() {
        let [Some(a), Some(b)] = mesh.facet_to_cell(facet) else { continue };
        let points: [Point<D>; MAX_FACET_VERTICES] = mesh.facet_points(facet);
        let opposite = mesh.cell(b).iter().find(|vertex| !mesh.facet(facet).contains(vertex));
        let normal: Vector<D> = facet_normal(&points[..D]);
        if opposite.is_some_and(|vertex| (mesh.vertex(*vertex) - points[0]).dot(&normal) <= 0.0) {
            let (a, b, place) = (number(a), number(b), place(&points[0]));
            return Err(format!(
                "the elements {a} and {b} lie on the same side of their common facet near {place}: the mesh is folded; repair it there"
            ));
        }
    }
    Ok(())
}

/// Returns identifiers in ascending order.
fn sorted(vertices: &[VertexId]) -> Vec<VertexId> {
    let mut sorted = vertices.to_vec();
    sorted.sort_unstable();
    sorted
}

/// Formats a point.
pub(super) fn place<const D: usize>(x: &Point<D>) -> String {
    let coordinates: Vec<String> = x.iter().map(|coordinate| format!("{coordinate:.6}")).collect();
    format!("({})", coordinates.join(", "))
}
