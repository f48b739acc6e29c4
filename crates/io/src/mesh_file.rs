//! Mesh files of any format: contents, quality, and conversion.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use mesh::{Aabb, BoundaryMesh, CellId, Placed, Point, SimplexMesh, Tensor, VertexId, det};

use crate::Error;
use crate::cut::{VtkMesh, read_vtk};
use crate::files::{extension, write_whole};
use crate::gmsh::{GmshFile, GmshFormat, GmshMesh, write};
use crate::surface::Surface;
use crate::vtk::{Grid, simplex_type};

/// Content of a mesh file.
pub enum MeshFile {
    /// Triangles in the plane.
    Plane(GmshMesh<2>),
    /// Tetrahedra.
    Space(GmshMesh<3>),
    /// Closed line in the plane.
    Curve(BoundaryMesh<2>, Vec<Point<2>>),
    /// Triangles in space without an inside.
    Surface(BoundaryMesh<3>, Vec<Point<3>>),
}

impl MeshFile {
    /// Reads a file by the extension of its name: `msh`, `vtu`, `vtk`, `stl` or `obj`.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::MeshFile`], [`Error::Surface`].
    pub fn read(path: &Path) -> Result<Self, Error> {
        let refused = |problem: String| Error::MeshFile { path: path.to_owned(), problem };
        match extension(path).as_str() {
            "msh" => {
                let file = GmshFile::read(path)?;
                let dimension = file.dimension();
                let content = match (dimension, file.has_cells(dimension)) {
                    (2, true) => file.mesh().map(Self::Plane),
                    (2, false) => file.surface().map(|(lines, positions)| Self::Curve(lines, positions)),
                    (_, true) => file.mesh().map(Self::Space),
                    (_, false) => file.surface().map(|(triangles, positions)| Self::Surface(triangles, positions)),
                };
                content.map_err(refused)
            }
            "vtu" | "vtk" => Ok(match read_vtk(path)? {
                VtkMesh::Plane(mesh) => Self::Plane(of_order_1(mesh)),
                VtkMesh::Space(mesh) => Self::Space(of_order_1(mesh)),
            }),
            "stl" | "obj" => {
                let surface = Surface::read(path)?;
                Ok(Self::Surface(surface.boundary().clone(), surface.positions().to_vec()))
            }
            _ => Err(refused("its name must end in .msh, .vtu, .vtk, .stl or .obj".to_owned())),
        }
    }

    /// Returns numbers of elements, sizes and quality.
    pub fn statistics(&self) -> MeshStatistics {
        match self {
            Self::Plane(found) => of_mesh(found),
            Self::Space(found) => of_mesh(found),
            Self::Curve(lines, positions) => of_surface(lines, positions),
            Self::Surface(triangles, positions) => of_surface(triangles, positions),
        }
    }

    /// Writes the content by the extension of a name: `msh`, in the given format; `vtu`; `stl`, the surface of a mesh.
    ///
    /// # Errors
    /// [`Error::MeshOutput`]: an extension or content that cannot be written. [`Error::Write`], [`Error::Vtk`].
    pub fn write(&self, path: &Path, format: GmshFormat) -> Result<(), Error> {
        let refused = |problem| Err(Error::MeshOutput { path: path.to_owned(), problem });
        match (extension(path).as_str(), self) {
            ("msh", Self::Plane(found)) => write(path, &found.mesh, &found.edge_nodes, format),
            ("msh", Self::Space(found)) => write(path, &found.mesh, &found.edge_nodes, format),
            ("msh", _) => {
                refused("this surface has no inside, and only meshes of an inside are written as .msh; use .stl")
            }
            ("vtu", Self::Plane(found)) => grid(&found.mesh).write(path, 0),
            ("vtu", Self::Space(found)) => grid(&found.mesh).write(path, 0),
            ("stl", Self::Space(found)) => write_stl(path, &found.mesh.boundary(), found.mesh.vertices()),
            ("stl", Self::Surface(triangles, positions)) => write_stl(path, triangles, positions),
            ("stl" | "vtu", _) => {
                refused("this content is not written in that format; use .msh for meshes, .stl for surfaces in space")
            }
            _ => refused("its name must end in .msh, .vtu or .stl"),
        }
    }
}

fn of_order_1<const D: usize>(mesh: SimplexMesh<D>) -> GmshMesh<D> {
    GmshMesh { mesh, edge_nodes: HashMap::new(), n_turned: 0, n_inside: 0, n_ambiguous: 0 }
}

/// Numbers of elements, sizes and quality of a mesh or surface.
#[derive(Default, Clone, Debug, PartialEq)]
pub struct MeshStatistics {
    /// Dimension of space.
    pub dimension: usize,
    /// Name of the elements.
    pub elements: &'static str,
    /// Order of the elements.
    pub order: usize,
    /// Number of elements.
    pub n_elements: usize,
    /// Number of vertices.
    pub n_vertices: usize,
    /// Lowest and highest coordinate along each axis.
    pub extent: Vec<[f64; 2]>,
    /// Area in 2D and volume in 3D, enclosed by a surface.
    pub volume: f64,
    /// Shortest, mean and longest edge of the elements.
    pub edges: [f64; 3],
    /// Smallest and mean quality of cells; `None` for a surface. See [`quality`].
    pub quality: Option<[f64; 2]>,
    /// Connected parts.
    pub n_parts: usize,
    /// Sides of facets of a surface that do not have exactly one neighbour; zero for a closed surface.
    pub n_open: usize,
    /// Cells whose nodes were in the order of a negative volume.
    pub n_turned: usize,
    /// Elements of groups that do not lie on the boundary.
    pub n_inside: usize,
    /// Elements in several groups.
    pub n_ambiguous: usize,
    /// Cells of order 2 whose curved edges fold them.
    pub n_folded: usize,
    /// Centroid of the corners of the first folded cell.
    pub first_folded: Option<Vec<f64>>,
    /// Number and total volume (2D: area) of the cells of each group, by name; `None` for cells without a group.
    pub cell_groups: BTreeMap<Option<String>, (usize, f64)>,
    /// Number and total area (2D: length) of the boundary facets of each group, by name; `None` without a group.
    pub boundary_groups: BTreeMap<Option<String>, (usize, f64)>,
}

/// Returns the mean ratio of a simplex of a given volume (2D: area): 1 if it is regular, 0 if it is flat.
///
/// Source: Liu, Joe 1994, BIT 34, doi:10.1007/bf01955874.
pub fn quality<const D: usize>(corners: &[Point<D>], volume: f64) -> f64 {
    let squares: f64 = edges(corners).map(|length| length * length).sum();
    match D {
        2 => 4.0 * 3.0_f64.sqrt() * volume / squares,
        _ => 12.0 * (3.0 * volume).powf(2.0 / 3.0) / squares,
    }
}

fn edges<const D: usize>(corners: &[Point<D>]) -> impl Iterator<Item = f64> {
    corners.iter().enumerate().flat_map(move |(k, a)| corners[..k].iter().map(move |b| (a - b).norm()))
}

fn of_mesh<const D: usize>(found: &GmshMesh<D>) -> MeshStatistics {
    let GmshMesh { mesh, edge_nodes, n_turned, n_inside, n_ambiguous } = found;
    let name = |tag: Option<mesh::Tag>| tag.map(|tag| mesh.tag_names()[tag.index()].clone());
    let mut lengths = Vec::new();
    let (mut smallest, mut sum) = (f64::INFINITY, 0.0);
    let mut cell_groups: BTreeMap<_, (usize, f64)> = BTreeMap::new();
    for cell in mesh.cells() {
        let simplex = mesh.simplex(cell);
        lengths.extend(edges(simplex.points()));
        let of_cell = quality(simplex.points(), mesh.cell_volume(cell));
        (smallest, sum) = (smallest.min(of_cell), sum + of_cell);
        add(&mut cell_groups, name(mesh.cell_tag(cell)), mesh.cell_volume(cell));
    }
    let is_curved = !edge_nodes.is_empty();
    let folded: Vec<CellId> = mesh.cells().filter(|cell| is_curved && is_folded(mesh, edge_nodes, *cell)).collect();
    let mut boundary_groups = BTreeMap::new();
    for facet in mesh.facets().filter(|facet| mesh.is_boundary(*facet)) {
        add(&mut boundary_groups, name(mesh.facet_tag(facet)), mesh.facet_measure(facet));
    }
    MeshStatistics {
        dimension: D,
        elements: if D == 2 { "triangles" } else { "tetrahedra" },
        order: if edge_nodes.is_empty() { 1 } else { 2 },
        n_elements: mesh.n_cells(),
        n_vertices: mesh.n_vertices(),
        extent: extent(mesh.vertices()),
        volume: mesh.volume(),
        edges: shortest_mean_longest(&lengths),
        quality: Some([smallest, sum / mesh.n_cells() as f64]),
        n_parts: n_parts(mesh.n_vertices(), mesh.cells().map(|cell| mesh.cell(cell))),
        n_open: 0,
        n_turned: *n_turned,
        n_inside: *n_inside,
        n_ambiguous: *n_ambiguous,
        n_folded: folded.len(),
        first_folded: folded.first().map(|cell| mesh.simplex(*cell).centroid().as_slice().to_vec()),
        cell_groups,
        boundary_groups,
    }
}

/// Returns whether the map of a cell of order 2 from the reference simplex has no positive determinant at a corner, at
/// the middle of an edge, or at the centroid.
fn is_folded<const D: usize>(
    mesh: &SimplexMesh<D>,
    edge_nodes: &HashMap<[VertexId; 2], Point<D>>,
    cell: CellId,
) -> bool {
    let vertices = mesh.cell(cell);
    let node = |j: usize, k: usize| {
        let (a, b) = (vertices[j].min(vertices[k]), vertices[j].max(vertices[k]));
        let middle = || (mesh.vertex(a) + mesh.vertex(b)) * 0.5;
        if j == k { mesh.vertex(a) } else { edge_nodes.get(&[a, b]).copied().unwrap_or_else(middle) }
    };
    let determinant = |at: &dyn Fn(usize) -> f64| {
        // The map is Σ λ_k (2 λ_k - 1) x_k + Σ_{j<k} 4 λ_j λ_k x_jk.
        let derivative = |k: usize| {
            let of_node = |j: usize| node(j, k) * (4.0 * at(j) - f64::from(u8::from(j == k)));
            (0..=D).map(of_node).sum::<Point<D>>()
        };
        let first = derivative(0);
        let columns: Vec<Point<D>> = (1..=D).map(|k| derivative(k) - first).collect();
        det(&Tensor::from_columns(&columns))
    };
    let straight = mesh.simplex(cell).volume();
    let turns_over = |at: &dyn Fn(usize) -> f64| determinant(at) <= FOLDED * straight;
    let pairs = (0..=D).flat_map(|j| (0..=j).map(move |k| [j, k]));
    let mut ends = pairs.map(|pair| move |i: usize| pair.iter().filter(|k| **k == i).count() as f64 * 0.5);
    ends.any(|at| turns_over(&at)) || turns_over(&|_| 1.0 / (D + 1) as f64)
}

/// Largest determinant of the map of a folded cell, divided by its volume with straight edges.
const FOLDED: f64 = 1e-9;

fn of_surface<const D: usize>(surface: &BoundaryMesh<D>, positions: &[Point<D>]) -> MeshStatistics {
    let placed = Placed::new(surface, positions);
    let mut lengths = Vec::new();
    let mut sides: HashMap<Vec<VertexId>, usize> = HashMap::new();
    let mut boundary_groups = BTreeMap::new();
    for facet in surface.facets() {
        let vertices = surface.facet(facet);
        let corners: Vec<Point<D>> = vertices.iter().map(|vertex| positions[vertex.index()]).collect();
        lengths.extend(edges(&corners));
        for k in 0..D {
            let mut side: Vec<VertexId> =
                vertices.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, v)| *v).collect();
            side.sort_unstable();
            *sides.entry(side).or_insert(0) += 1;
        }
        add(&mut boundary_groups, None, placed.facet_measure(facet));
    }
    MeshStatistics {
        dimension: D,
        elements: if D == 2 { "lines" } else { "triangles of a surface" },
        order: 1,
        n_elements: surface.n_facets(),
        n_vertices: positions.len(),
        extent: extent(positions),
        volume: placed.enclosed().volume,
        edges: shortest_mean_longest(&lengths),
        n_parts: n_parts(positions.len(), surface.facets().map(|facet| surface.facet(facet))),
        n_open: sides.values().filter(|n| **n != 2).count(),
        boundary_groups,
        ..MeshStatistics::default()
    }
}

fn add(groups: &mut BTreeMap<Option<String>, (usize, f64)>, name: Option<String>, measure: f64) {
    let group = groups.entry(name).or_default();
    *group = (group.0 + 1, group.1 + measure);
}

fn extent<const D: usize>(points: &[Point<D>]) -> Vec<[f64; 2]> {
    let Aabb { low, high } = Aabb::of_points(points);
    (0..D).map(|axis| [low[axis], high[axis]]).collect()
}

/// Returns the shortest, mean and longest length. An edge has a length for each of its elements.
fn shortest_mean_longest(lengths: &[f64]) -> [f64; 3] {
    let shortest = lengths.iter().copied().reduce(f64::min).unwrap_or(0.0);
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    [shortest, lengths.iter().sum::<f64>() / lengths.len().max(1) as f64, longest]
}

/// Returns the number of connected parts: sets of elements that share no vertex (by union-find).
pub(crate) fn n_parts<'m>(n_vertices: usize, elements: impl Iterator<Item = &'m [VertexId]>) -> usize {
    let mut next: Vec<usize> = (0..n_vertices).collect();
    let mut is_used = vec![false; n_vertices];
    for element in elements {
        let first = last(&mut next, element[0].index());
        for vertex in element {
            is_used[vertex.index()] = true;
            let other = last(&mut next, vertex.index());
            next[other] = first;
        }
    }
    (0..n_vertices).filter(|k| is_used[*k] && next[*k] == *k).count()
}

/// Returns the representative of the set of vertex `k`, and shortens the chain to it.
fn last(next: &mut [usize], mut k: usize) -> usize {
    while next[k] != k {
        next[k] = next[next[k]];
        k = next[k];
    }
    k
}

/// Returns a mesh as a grid with the numbers of its groups.
fn grid<const D: usize>(mesh: &SimplexMesh<D>) -> Grid {
    let mut grid = Grid::default();
    for x in mesh.vertices() {
        grid.push_point(x);
    }
    for cell in mesh.cells() {
        grid.push_cell(simplex_type(D + 1), mesh.cell(cell).iter().map(|vertex| u64::from(vertex.0)));
    }
    // Groups have numbers from 1; 0: no group.
    let group = |cell| mesh.cell_tag(cell).map_or(0, |tag| tag.index() as i64 + 1);
    grid.add_cell_ids("group", mesh.cells().map(group).collect());
    let corners = |cell| mesh.simplex(cell);
    let of_cell = |cell| quality(corners(cell).points(), mesh.cell_volume(cell));
    grid.add_cell_data("quality", 1, mesh.cells().map(of_cell).collect());
    grid
}

/// Writes triangles as binary STL, whose numbers have seven digits.
fn write_stl(path: &Path, triangles: &BoundaryMesh<3>, positions: &[Point<3>]) -> Result<(), Error> {
    let placed = Placed::new(triangles, positions);
    let mut bytes = vec![b' '; 80];
    bytes.extend((triangles.n_facets() as u32).to_le_bytes());
    for facet in triangles.facets() {
        let corners = triangles.facet(facet).iter().map(|vertex| positions[vertex.index()]);
        for x in std::iter::once(placed.facet_normal(facet)).chain(corners) {
            x.iter().for_each(|coordinate| bytes.extend((*coordinate as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    write_whole(path, &bytes)
}
