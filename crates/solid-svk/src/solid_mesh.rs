//! A body in its reference configuration: mesh, nodes, boundary, and the data of cells and facets for terms.

use std::collections::HashMap;

use mesh::{
    Barycentric, BoundaryMesh, CellId, Coordinates, FacetId, MAX_CELL_NODES, Order, Placed, Point, ShapeFunctions,
    SimplexMesh, Vector, VertexId,
};

use crate::Error;
use crate::deformation::Deformation;
use crate::kinematics::{deformation_gradient, gradient};
use crate::tabulated::Tabulated;

/// The data of the mesh of a body that are constant in time; built once, borrowed in every step.
///
/// Cells are isoparametric elements of order 1 or 2. *Nodes* carry the unknowns: the vertices of the mesh, followed for
/// order 2 by one node on each edge. Nodes have the identifiers of vertices. The boundary consists of linear facets
/// through all nodes: two segments for each edge of order 2, four triangles for each triangle.
#[derive(Clone, Debug)]
pub struct SolidMesh<const D: usize> {
    mesh: SimplexMesh<D>,
    order: Order,
    nodes: Vec<Point<D>>,
    /// Stride: nodes of a cell.
    cell_to_node: Vec<VertexId>,
    /// Stride `D + 1`.
    part_to_node: Vec<VertexId>,
    cells: CellTables<D>,
    cell_to_group: Vec<usize>,
    boundary: BoundaryMesh<D>,
    /// Quadrature points for loads on each part of an element's facet, in coordinates of the whole facet.
    facet_points: Vec<Tabulated>,
    /// Gradients of the shape functions behind each boundary facet, in its middle. Stride: nodes of a cell.
    surface_gradients: Vec<Vector<D>>,
    /// Shape functions divided by the radius at the same points, with the same stride; empty in Cartesian coordinates.
    surface_hoop: Vec<f64>,
    /// Measure of the boundary facets of each cell, with the weight of the coordinates.
    surface_measures: Vec<f64>,
}

/// A point of a cell at which the stress is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct CellPoint<'a, const D: usize> {
    /// Quadrature weight times the reference volume element times [`mesh::Coordinates::weight`].
    pub weight: f64,
    /// Gradients of the shape functions, one per node.
    pub gradients: &'a [Vector<D>],
    /// Index of the radial component, and the values `N_i/R`, one per node; `None` in Cartesian coordinates.
    pub hoop: Option<(usize, &'a [f64])>,
}

impl<const D: usize> CellPoint<'_, D> {
    /// Returns the deformation of a displacement, given at the nodes of the cell.
    #[inline]
    pub fn deformation(&self, displacement: &[Vector<D>]) -> Deformation<D> {
        let stretch = |(radial, shapes): (usize, &[f64])| {
            1.0 + displacement.iter().zip(shapes).map(|(d, shape)| d[radial] * shape).sum::<f64>()
        };
        Deformation {
            gradient: deformation_gradient(&gradient(displacement, self.gradients)),
            hoop: self.hoop.map(stretch),
        }
    }
}

/// Integrals and quadrature points of cells.
#[derive(Clone, Debug, Default)]
struct CellTables<const D: usize> {
    /// Volumes of the cells, without the weight of the coordinates.
    volumes: Vec<f64>,
    /// Weights of the quadrature points, with the weight of the coordinates. Stride: points of a cell.
    weights: Vec<f64>,
    /// Gradients of the shape functions at these points. Stride: points of a cell times its nodes.
    gradients: Vec<Vector<D>>,
    /// Shape functions divided by the radius there. Stride: that of the gradients; empty in Cartesian coordinates.
    hoop: Vec<f64>,
    /// Mass matrices of the cells for a density of one. Stride: square of the nodes of a cell.
    mass: Vec<f64>,
}

impl<const D: usize> SolidMesh<D> {
    /// Creates a body of linear elements that occupies the mesh in its reference configuration.
    ///
    /// # Errors
    /// [`Error::DegenerateCell`]: a cell without finite gradients.
    pub fn new(mesh: SimplexMesh<D>) -> Result<Self, Error> {
        Self::build(mesh, Order::Linear, |_, middle| middle)
    }

    /// Creates a body of elements with straight edges; nodes of order 2 are in the middles of the edges.
    ///
    /// # Errors
    /// As [`SolidMesh::new`].
    pub fn of_order(mesh: SimplexMesh<D>, order: Order) -> Result<Self, Error> {
        Self::build(mesh, order, |_, middle| middle)
    }

    /// Creates a body of quadratic elements with curved edges. `node` maps the ends of an edge, in ascending order, and
    /// the middle between them to the position of the edge's node.
    ///
    /// # Errors
    /// [`Error::DegenerateCell`]: the map of a cell from the reference simplex has no inverse at a quadrature point, or
    /// in the middle of a part, because the cell is too thin or too curved.
    pub fn curved(mesh: SimplexMesh<D>, node: impl Fn([VertexId; 2], Point<D>) -> Point<D>) -> Result<Self, Error> {
        Self::build(mesh, Order::Quadratic, node)
    }

    fn build(
        mesh: SimplexMesh<D>,
        order: Order,
        node: impl Fn([VertexId; 2], Point<D>) -> Point<D>,
    ) -> Result<Self, Error> {
        let mut nodes = mesh.vertices().to_vec();
        let mut edge_to_node = HashMap::new();
        let mut cell_to_node = Vec::with_capacity(mesh.n_cells() * order.n_nodes(D));
        for cell in mesh.cells() {
            let on_edge = |ends: [VertexId; 2]| {
                *edge_to_node.entry(ends).or_insert_with(|| {
                    nodes.push(node(ends, (mesh.vertex(ends[0]) + mesh.vertex(ends[1])) * 0.5));
                    VertexId::new(nodes.len() - 1)
                })
            };
            order.push_nodes(mesh.cell(cell), on_edge, &mut cell_to_node);
        }
        let cells = CellTables::new(order, &nodes, &cell_to_node, mesh.coordinates())?;
        let part_to_node = parts::<D>(order, &cell_to_node);

        let mut facet_to_node = Vec::new();
        let (mut facet_to_cell, mut tags) = (Vec::new(), Vec::new());
        for facet in mesh.facets().filter(|&facet| mesh.is_boundary(facet)) {
            order.push_nodes(mesh.facet(facet), |ends| edge_to_node[&ends], &mut facet_to_node);
            facet_to_cell.extend(mesh.facet_to_cell(facet)[0]);
            tags.push(mesh.facet_tag(facet));
        }
        let boundary =
            BoundaryMesh::of_elements(order, facet_to_node, &facet_to_cell, &tags).with_coordinates(mesh.coordinates());

        let mut body = Self {
            cell_to_group: vec![0; mesh.n_cells()],
            facet_points: facet_points(order, D - 1, mesh.coordinates()),
            mesh,
            order,
            nodes,
            cell_to_node,
            part_to_node,
            cells,
            boundary,
            surface_gradients: Vec::new(),
            surface_hoop: Vec::new(),
            surface_measures: Vec::new(),
        };
        (body.surface_gradients, body.surface_hoop) = body.shapes_on_surface();
        body.surface_measures = body.measures_of_surface();
        Ok(body)
    }

    /// Returns the body with its cells in groups, which may differ in density and material
    /// ([`crate::SolidForm::of_groups`]). By default all cells are in group 0.
    ///
    /// Shapes: `cell_to_group` has one entry per cell.
    ///
    /// # Errors
    /// [`Error::Groups`]: not one entry per cell.
    pub fn with_groups(mut self, cell_to_group: Vec<usize>) -> Result<Self, Error> {
        let (found, n_cells) = (cell_to_group.len(), self.mesh.n_cells());
        if found != n_cells {
            return Err(Error::Groups { found, n_cells });
        }
        self.cell_to_group = cell_to_group;
        Ok(self)
    }

    /// Returns the group of a cell.
    #[inline]
    pub fn group(&self, cell: CellId) -> usize {
        self.cell_to_group[cell.index()]
    }

    /// Returns the number of groups.
    pub fn n_groups(&self) -> usize {
        self.cell_to_group.iter().max().map_or(0, |last| last + 1)
    }

    /// Returns the mesh, whose vertices are the first nodes.
    pub fn mesh(&self) -> &SimplexMesh<D> {
        &self.mesh
    }

    /// Returns the order of the elements.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Returns the positions of the nodes.
    pub fn nodes(&self) -> &[Point<D>] {
        &self.nodes
    }

    /// Returns the nodes of a cell: its vertices, then those on its edges.
    #[inline]
    pub fn cell(&self, cell: CellId) -> &[VertexId] {
        let n = self.order.n_nodes(D);
        &self.cell_to_node[cell.index() * n..][..n]
    }

    /// Returns the linear simplices through all nodes, for output: `D + 1` nodes each, the parts of a cell one after
    /// another. The parts of a linear element are the element itself.
    pub fn parts(&self) -> &[VertexId] {
        &self.part_to_node
    }

    /// Returns the number of parts of a cell.
    pub fn n_parts_of_cell(&self) -> usize {
        self.order.parts(D).len()
    }

    /// Returns the boundary: linear facets through the nodes.
    pub fn boundary(&self) -> &BoundaryMesh<D> {
        &self.boundary
    }

    /// Returns the boundary at the given positions of the nodes.
    pub fn placed<'m>(&'m self, positions: &'m [Point<D>]) -> Placed<'m, D> {
        Placed::new(&self.boundary, positions)
    }

    /// Returns the reference volume of a cell (2D: area), without the weight of the coordinates.
    #[inline]
    pub fn volume(&self, cell: CellId) -> f64 {
        self.cells.volumes[cell.index()]
    }

    /// Returns the mass matrix of a cell for unit density, row by row: the consistent mass `m_ij = ∫ N_i N_j` with the
    /// weight of the coordinates, or the redistributed mass of [`SolidMesh::without_mass_at`].
    ///
    /// The quadrature is exact on cells with straight edges.
    #[inline]
    pub fn mass(&self, cell: CellId) -> &[f64] {
        let n = self.order.n_nodes(D).pow(2);
        &self.cells.mass[cell.index() * n..][..n]
    }

    /// Returns the mass matrices of all cells, one after the other.
    pub(crate) fn masses_mut(&mut self) -> &mut [f64] {
        &mut self.cells.mass
    }

    /// Returns the points of a cell at which the stress is evaluated: weights, and gradients of the shape functions of
    /// its nodes.
    ///
    /// The rule has degree `2p - 2` for order `p`, which preserves the order of convergence: one point, and for order 2
    /// three in 2D and four in 3D. In Cartesian coordinates the strain components at all points are as many as the
    /// displacements of a cell without rigid motions, so that only rigid motions have no energy.
    ///
    /// Source: Ciarlet 2002, The Finite Element Method for Elliptic Problems, Thm. 4.1.6.
    #[inline]
    pub fn points(&self, cell: CellId) -> impl Iterator<Item = CellPoint<'_, D>> + use<'_, D> {
        let n_nodes = self.order.n_nodes(D);
        let n_points = self.cells.weights.len() / self.mesh.n_cells();
        let weights = &self.cells.weights[cell.index() * n_points..][..n_points];
        weights.iter().enumerate().map(move |(k, &weight)| {
            let of_point = (cell.index() * n_points + k) * n_nodes..(cell.index() * n_points + k + 1) * n_nodes;
            CellPoint {
                weight,
                gradients: &self.cells.gradients[of_point.clone()],
                hoop: self.mesh.coordinates().radial().map(|radial| (radial, &self.cells.hoop[of_point])),
            }
        })
    }

    /// Returns the deformation in the middle of one of the parts of a cell, for displacements of its nodes.
    pub(crate) fn deformation_in_part(&self, cell: CellId, part: usize, displacement: &[Vector<D>]) -> Deformation<D> {
        let (gradients, hoop) = self.shapes_at(cell, &self.order.middle(D, part));
        let hoop = self.mesh.coordinates().radial().map(|radial| (radial, &hoop[..]));
        CellPoint { weight: 0.0, gradients: &gradients, hoop }.deformation(displacement)
    }

    /// Returns the middle of a boundary facet as a point of the cell behind it. The stress is evaluated there
    /// only, so its quadrature weight is zero.
    #[inline]
    pub fn surface_point(&self, facet: FacetId) -> CellPoint<'_, D> {
        let n = self.order.n_nodes(D);
        let of_facet = facet.index() * n..(facet.index() + 1) * n;
        CellPoint {
            weight: 0.0,
            gradients: &self.surface_gradients[of_facet.clone()],
            hoop: self.mesh.coordinates().radial().map(|radial| (radial, &self.surface_hoop[of_facet])),
        }
    }

    /// Returns the measure of the boundary facets of a cell, with the weight of the coordinates in their middles.
    pub fn surface_measure(&self, cell: CellId) -> f64 {
        self.surface_measures[cell.index()]
    }

    /// Returns the quadrature points for loads on a boundary facet.
    pub(crate) fn facet_points(&self, facet: FacetId) -> &Tabulated {
        &self.facet_points[facet.index() % self.facet_points.len()]
    }

    /// Returns the gradients of the shape functions at a point of a cell, and their values divided by the radius; the
    /// latter are empty in Cartesian coordinates.
    fn shapes_at(&self, cell: CellId, at: &Barycentric) -> (Vec<Vector<D>>, Vec<f64>) {
        let mut nodes = [Point::zeros(); MAX_CELL_NODES];
        let n = gather(&self.nodes, self.cell(cell), &mut nodes);
        let (mut gradients, mut hoop) = (Vec::with_capacity(n), Vec::new());
        let shape = self.order.shape(D, at);
        shape.push_gradients(&nodes[..n], &mut gradients);
        push_hoop(&shape, &nodes[..n], &gradients, self.mesh.coordinates(), &mut hoop);
        (gradients, hoop)
    }

    fn shapes_on_surface(&self) -> (Vec<Vector<D>>, Vec<f64>) {
        let (mut gradients, mut hoop) = (Vec::new(), Vec::new());
        for facet in self.boundary.facets() {
            let Some(cell) = self.boundary.facet_to_cell(facet) else { continue };
            let middle = self.order.middle_of(D, self.cell(cell), self.boundary.facet(facet));
            let (of_gradients, of_hoop) = self.shapes_at(cell, &middle);
            gradients.extend(of_gradients);
            hoop.extend(of_hoop);
        }
        (gradients, hoop)
    }

    fn measures_of_surface(&self) -> Vec<f64> {
        let mut measures = vec![0.0; self.mesh.n_cells()];
        let placed = self.placed(&self.nodes);
        for facet in self.boundary.facets() {
            if let Some(cell) = self.boundary.facet_to_cell(facet) {
                measures[cell.index()] += placed.weighted_measure(facet);
            }
        }
        measures
    }
}

impl<const D: usize> CellTables<D> {
    fn new(
        order: Order,
        nodes: &[Point<D>],
        cell_to_node: &[VertexId],
        coordinates: Coordinates,
    ) -> Result<Self, Error> {
        let n = order.n_nodes(D);
        let stress = Tabulated::of_degree(order, D, 2 * order.degree() - 2);
        let mass = Tabulated::of_degree(order, D, 2 * order.degree() + coordinates.degree());
        let mut tables = Self::default();
        let inside: Vec<_> = (0..order.parts(D).len()).map(|part| order.shape(D, &order.middle(D, part))).collect();
        let (mut local, mut unused) = ([Point::zeros(); MAX_CELL_NODES], Vec::new());
        for (index, of_cell) in cell_to_node.chunks_exact(n).enumerate() {
            gather(nodes, of_cell, &mut local);
            let cell = CellId::new(index);
            let ratio = |shape: &ShapeFunctions, gradients: &mut Vec<Vector<D>>| {
                let ratio = shape.push_gradients(&local[..n], gradients);
                if ratio > 0.0 { Ok(ratio) } else { Err(Error::DegenerateCell { cell }) }
            };
            let weight_at = |shape: &ShapeFunctions| coordinates.weight(&shape.at(&local[..n]));
            for (weight, shape) in &stress.points {
                let first = tables.gradients.len();
                tables.weights.push(weight * ratio(shape, &mut tables.gradients)? * weight_at(shape));
                push_hoop(shape, &local[..n], &tables.gradients[first..], coordinates, &mut tables.hoop);
            }
            for shape in &inside {
                ratio(shape, &mut unused)?;
            }
            let first = tables.mass.len();
            tables.mass.resize(first + n * n, 0.0);
            let mut volume = 0.0;
            for (weight, shape) in &mass.points {
                let weight = weight * ratio(shape, &mut unused)?;
                volume += weight;
                let weight = weight * weight_at(shape);
                for (i, row) in tables.mass[first..].chunks_exact_mut(n).enumerate() {
                    row.iter_mut().zip(&shape.values).for_each(|(m, value)| *m += weight * shape.values[i] * value);
                }
            }
            tables.volumes.push(volume);
            unused.clear();
        }
        Ok(tables)
    }
}

/// Appends the values of the shape functions at a point divided by its radius, in axisymmetric coordinates. On the
/// axis, where radial displacements are zero, the limit is the derivative with respect to the radius.
fn push_hoop<const D: usize>(
    shape: &ShapeFunctions,
    nodes: &[Point<D>],
    gradients: &[Vector<D>],
    coordinates: Coordinates,
    hoop: &mut Vec<f64>,
) {
    let Some(radial) = coordinates.radial() else { return };
    let radius = shape.at(nodes)[radial];
    let on_axis = |(_, gradient): (&f64, &Vector<D>)| gradient[radial];
    let off_axis = |(value, _): (&f64, &Vector<D>)| value / radius;
    let values = shape.values.iter().zip(gradients);
    if radius > 0.0 { hoop.extend(values.map(off_axis)) } else { hoop.extend(values.map(on_axis)) }
}

/// Returns the linear simplices of cells, given by their nodes.
fn parts<const D: usize>(order: Order, cell_to_node: &[VertexId]) -> Vec<VertexId> {
    let cells = cell_to_node.chunks_exact(order.n_nodes(D));
    let parts = |nodes: &[VertexId]| -> Vec<VertexId> {
        order.parts(D).iter().flat_map(|part| part[..=D].iter().map(|&k| nodes[k])).collect()
    };
    cells.flat_map(parts).collect()
}

/// Returns the quadrature points for loads on the parts of a facet. In Cartesian coordinates those of a linear facet
/// are its vertices. The other rules are exact for a uniform pressure; that on a triangle with quadratic nodes has
/// degree 4.
fn facet_points(order: Order, dimension: usize, coordinates: Coordinates) -> Vec<Tabulated> {
    let n_parts = order.parts(dimension).len();
    let of_part = |part: usize| match (order, coordinates.degree()) {
        (Order::Linear, 0) => Tabulated::of_vertices(order, dimension),
        (_, degree) => Tabulated::of_part(order, dimension, part, 2 * order.degree() + degree),
    };
    (0..n_parts).map(of_part).collect()
}

/// Copies the positions of nodes and returns their number.
fn gather<const D: usize>(all: &[Point<D>], nodes: &[VertexId], out: &mut [Point<D>; MAX_CELL_NODES]) -> usize {
    out.iter_mut().zip(nodes).for_each(|(slot, node)| *slot = all[node.index()]);
    nodes.len()
}
