//! Shapes of bodies: one function for each kind.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use mesh::generate::{BallOptions, ClosedLine, Size, ball, graded_box, half_ball, inside, mirrored, structured_box};
use mesh::{BoundaryMesh, Placed, Point, SimplexMesh, Tag, Vector, VertexId};

use super::error::{ErrorKind, Location, ScenarioError};
use super::key::Quantity;
use super::table::{At, Components, choices};
use crate::Error;
use crate::files::extension;
use crate::gmsh::GmshFile;
use crate::memory::shortage_of_body;
use crate::surface::Surface;

choices! {
    /// Shape of a body.
    pub enum Shape ["kind"] {
        /// Disk, and ball in 3D; tag `surface`.
        Ball = "ball" {
            /// Centre.
            centre: Components<f64> [unit(Quantity::LENGTH)],
            /// Radius.
            radius: f64 [unit(Quantity::LENGTH), positive],
            /// Mean diameter of the cells; in 3D, mean length of their edges.
            size: f64 [unit(Quantity::LENGTH), positive],
            /// Whether the polygon or polyhedron has the area or volume of the ball; its vertices lie on the surface of
            /// the ball otherwise.
            area_preserving: bool = false,
        },
        /// Half of a disk with `x` not below that of the centre, in 2D; tags `left` (the diameter) and `surface`.
        HalfBall = "half-ball" {
            /// Centre of the disk.
            centre: Components<f64> [unit(Quantity::LENGTH)],
            /// Radius.
            radius: f64 [unit(Quantity::LENGTH), positive],
            /// Mean diameter of the cells.
            size: f64 [unit(Quantity::LENGTH), positive],
            /// Whether the polygon has the area of the disk; its vertices lie on the circle otherwise.
            area_preserving: bool = false,
            /// Whether the mirror image is added: an exactly symmetric disk with tag `surface`.
            mirrored: bool = false,
        },
        /// Box; tags `left`, `right`, `bottom`, `top`, and in 3D `front`, `back`.
        Box = "box" {
            /// Lowest corner.
            min: Components<f64> [unit(Quantity::LENGTH)],
            /// Highest corner.
            max: Components<f64> [unit(Quantity::LENGTH)],
            /// Mean diameter of the cells; or `n`.
            size: Option<f64> [unit(Quantity::LENGTH), positive, group(0)],
            /// Number of bricks along each axis, divided into 2 triangles or 6 tetrahedra; or `size`.
            n: Option<Components<usize>> [between(1.0, f64::INFINITY), group(1)],
        },
        /// Ring between two circles, in 2D; tags `outer` and `inner`. In 3D a tube is a `mesh` from a file.
        Annulus = "annulus" {
            /// Centre.
            centre: Components<f64> [unit(Quantity::LENGTH)],
            /// Radius of the outer circle.
            outer: f64 [unit(Quantity::LENGTH), positive],
            /// Radius of the inner circle.
            inner: f64 [unit(Quantity::LENGTH), positive],
            /// Mean diameter of the cells.
            size: f64 [unit(Quantity::LENGTH), positive],
        },
        /// All points within a distance of a segment, in 2D; tag `surface`. In 3D a capsule is a `mesh` from a file.
        Capsule = "capsule" {
            /// One end of the segment.
            from: Components<f64> [unit(Quantity::LENGTH)],
            /// The other end.
            to: Components<f64> [unit(Quantity::LENGTH)],
            /// The distance, radius of the round ends.
            radius: f64 [unit(Quantity::LENGTH), positive],
            /// Mean diameter of the cells.
            size: f64 [unit(Quantity::LENGTH), positive],
        },
        /// Simple polygon, or smooth curve through its corners, in 2D. Tags `side-1`, `side-2` and so on for the sides
        /// after each corner, `surface` for a smooth curve; `hole-1` and so on for holes.
        Polygon = "polygon" {
            /// Corners, in order.
            corners: Vec<Components<f64>> [unit(Quantity::LENGTH)],
            /// Corners of holes, a list for each hole.
            holes: Vec<Vec<Components<f64>>> [unit(Quantity::LENGTH)],
            /// Largest length of the segments into which the sides are divided.
            size: f64 [unit(Quantity::LENGTH), positive],
            /// Whether outline and holes are periodic cubic splines through their corners. The outline is then one part,
            /// `surface`, for conditions and forces.
            smooth: bool = false,
        },
        /// Mesh from a Gmsh file (`.msh`, version 4.1 or 2.2), with the names of its physical groups as tags. For
        /// bodies that do not deform, also a closed surface: `.stl` or `.obj` in 3D, lines or triangles of a Gmsh file.
        Mesh = "mesh" {
            /// Path of the file, relative to the scenario.
            file: At<String>,
            /// Factor by which the coordinates of the file are multiplied.
            scale: f64 [positive] = 1.0,
        },
    }
}

/// Positions of nodes on curved edges. The key has the ends of the edge in ascending order.
pub(super) type EdgeNodes<const D: usize> = HashMap<[VertexId; 2], Point<D>>;

/// Geometry of a body.
pub(super) enum Geometry<const D: usize> {
    /// A mesh of the body, and nodes on curved edges for elements of order 2.
    Mesh(Box<SimplexMesh<D>>, EdgeNodes<D>),
    /// Lines around the body, and the size of the cells of a mesh between them.
    Lines(Vec<ClosedLine>, f64),
    /// The surface of the body, with the positions of its vertices.
    Surface(BoundaryMesh<D>, Vec<Point<D>>),
}

impl<const D: usize> Geometry<D> {
    /// Builds the geometry of a shape.
    ///
    /// # Errors
    /// A mesh that cannot be generated or read, or a shape that does not exist in dimension `D`.
    pub(super) fn new(shape: &At<Shape>) -> Result<Self, ScenarioError> {
        let fail = |error| refuse(&shape.at, error);
        if D != 2 && matches!(**shape, Shape::Annulus { .. } | Shape::Capsule { .. } | Shape::Polygon { .. }) {
            let message = "this shape exists in two dimensions only; use a ball, a box or a mesh from a file (`kind = \"mesh\"`: .msh, or .stl and .obj for bodies that do not deform), or dimension = 2";
            return Err(shape.at.invalid(message));
        }
        check_memory::<D>(shape)?;
        Ok(match &**shape {
            Shape::Ball { radius, size, .. } | Shape::HalfBall { radius, size, .. } if size > radius => {
                let message = format!(
                    "cells of {size} do not resolve a radius of {radius}; give at most the radius, and better a fifth"
                );
                return Err(shape.at.part("size").invalid(message));
            }
            Shape::Ball { centre, radius, size, area_preserving } => {
                let options = BallOptions { area_preserving: *area_preserving };
                let centre = centre.vector::<D>();
                let ball = ball(centre.into(), *radius, *size, &options).map_err(fail)?;
                let nodes = nodes_on_ball(&ball, centre);
                Self::Mesh(Box::new(ball), nodes)
            }
            Shape::HalfBall { centre, radius, size, area_preserving, mirrored: is_whole } => {
                let options = BallOptions { area_preserving: *area_preserving };
                let centre = centre.vector::<D>();
                let half = half_ball(centre.into(), *radius, *size, &options);
                let ball =
                    if *is_whole { half.and_then(|half| mirrored(&half, 0, centre[0])) } else { half }.map_err(fail)?;
                let nodes = nodes_on_ball(&ball, centre);
                Self::Mesh(Box::new(ball), nodes)
            }
            Shape::Box { min, max, size, n } => {
                check_corners(min, max, &shape.at.part("max"))?;
                let (min, max) = (min.vector::<D>().into(), max.vector::<D>().into());
                let mesh = match (size, n) {
                    (Some(h), None) => graded_box(min, max, &Size::uniform(*h)),
                    (None, Some(n)) => structured_box(min, max, std::array::from_fn(|axis| n[axis])),
                    _ => return Err(shape.at.error(ErrorKind::Either("size", "n"))),
                };
                Self::Mesh(Box::new(mesh.map_err(fail)?), HashMap::new())
            }
            Shape::Annulus { centre, outer, inner, size } => {
                let circle = |radius, name| ClosedLine::circle(planar(centre), radius, *size, name).map_err(fail);
                if inner >= outer {
                    return Err(shape
                        .at
                        .part("inner")
                        .invalid("the inner circle is not inside the outer one; make it smaller"));
                }
                Self::Lines(vec![circle(*outer, "outer")?, circle(*inner, "inner")?], *size)
            }
            Shape::Capsule { from, to, radius, size } => {
                let ends = [planar(from), planar(to)];
                Self::Lines(vec![ClosedLine::capsule(ends, *radius, *size, "surface").map_err(fail)?], *size)
            }
            Shape::Polygon { corners, holes, size, smooth } => {
                Self::Lines(polygon_lines(&shape.at, corners, holes, LineSize::Uniform(*size), *smooth)?, *size)
            }
            Shape::Mesh { file, scale } => Self::read(file)?.scaled(*scale).map_err(|error| file.at.error(error))?,
        })
    }

    /// Reads a mesh or a surface.
    fn read(file: &At<String>) -> Result<Self, ScenarioError> {
        let path = input_path(file);
        if extension(&path) == "msh" {
            let content = read_gmsh(file, &path)?;
            let in_file = |problem: String| in_file(file, &path, problem);
            if !content.has_cells(D) {
                let (surface, positions) = content.surface::<D>().map_err(in_file)?;
                return Ok(Self::outwards(surface, positions));
            }
            let found = content.mesh::<D>().map_err(in_file)?;
            return Ok(Self::Mesh(Box::new(found.mesh), found.edge_nodes));
        }
        if !["stl", "obj"].contains(&extension(&path).as_str()) {
            return Err(in_file(file, &path, "its name must end in .msh, .stl or .obj".to_owned()));
        }
        if D != 3 {
            return Err(file.at.invalid(
                "a body in two dimensions is read from a Gmsh file, .msh; change the file, or use a polygon",
            ));
        }
        let surface = Surface::read(&path).map_err(|error| unreadable(file, error))?;
        let positions = surface.positions().iter().map(|x| Point::from_fn(|axis, _| x[axis])).collect();
        closed(&surface).map_err(|problem| in_file(file, &path, problem))?;
        let facets = surface.boundary().facets().flat_map(|facet| surface.boundary().facet(facet).to_vec());
        Ok(Self::outwards(BoundaryMesh::from_facets(facets.collect()), positions))
    }

    /// Creates a surface with its normals turned outwards.
    fn outwards(surface: BoundaryMesh<D>, positions: Vec<Point<D>>) -> Self {
        let is_inward = Placed::new(&surface, &positions).enclosed().volume < 0.0;
        Self::Surface(if is_inward { surface.reversed() } else { surface }, positions)
    }

    /// Returns the geometry with other positions.
    fn mapped(self, map: impl Fn(&Point<D>) -> Point<D>) -> Result<Self, mesh::Error> {
        let planar = |x: &[f64; 2]| {
            let x = map(&Point::from_fn(|axis, _| x[axis]));
            [x[0], x[1]]
        };
        Ok(match self {
            Self::Mesh(mesh, nodes) => {
                let nodes = nodes.into_iter().map(|(ends, x)| (ends, map(&x))).collect();
                Self::Mesh(Box::new(mesh.mapped(map)?), nodes)
            }
            Self::Lines(lines, size) => {
                let moved = |line: ClosedLine| ClosedLine {
                    points: line.points.iter().map(planar).collect(),
                    middles: line.middles.iter().map(planar).collect(),
                    ..line
                };
                Self::Lines(lines.into_iter().map(moved).collect(), size)
            }
            Self::Surface(surface, positions) => Self::Surface(surface, positions.iter().map(map).collect()),
        })
    }

    fn scaled(self, by: f64) -> Result<Self, mesh::Error> {
        self.mapped(|x| x * by)
    }

    /// Returns the geometry at another place.
    ///
    /// # Errors
    /// A shift so large that rounding destroys the mesh.
    pub(super) fn shifted(self, by: Vector<D>) -> Result<Self, mesh::Error> {
        self.mapped(|x| x + by)
    }

    /// Returns the mesh of the inside, with nodes for elements of order 2.
    ///
    /// # Errors
    /// The geometry is a surface, or lines that do not bound a region.
    pub(super) fn into_mesh(self, shape: &At<Shape>) -> Result<(SimplexMesh<D>, EdgeNodes<D>), ScenarioError> {
        match self {
            Self::Mesh(mesh, nodes) => Ok((*mesh, nodes)),
            Self::Lines(lines, size) => {
                let area = lines.first().map_or(0.0, |line| line.area().abs());
                refuse_shortage(&shape.at.part("size"), CELLS_IN_SQUARE * area / size.powi(2))?;
                let mesh = inside(&lines, size).map_err(|error| refuse(&shape.at, error))?;
                Ok((mesh, nodes_on_lines(&lines)))
            }
            Self::Surface(..) => Err(shape.at.invalid(
                "an elastic body needs a mesh, and this shape is a surface; use a file with triangles (2D) or tetrahedra (3D), or give a motion",
            )),
        }
    }

    /// Returns the names of the parts of the surface, in the order of its tags.
    pub(super) fn part_names(&self) -> Vec<String> {
        match self {
            Self::Mesh(mesh, _) => mesh.tag_names().to_vec(),
            Self::Lines(lines, _) => names_of_lines(lines),
            Self::Surface(..) => Vec::new(),
        }
    }

    /// Returns the surface with the positions of its own vertices.
    pub(super) fn into_surface(self) -> (BoundaryMesh<D>, Vec<Point<D>>) {
        let mesh = match self {
            Self::Surface(surface, positions) => return (surface, positions),
            Self::Lines(lines, _) => return surface_of_lines(lines),
            Self::Mesh(mesh, _) => mesh,
        };
        let whole = mesh.boundary();
        let mut numbers: Vec<Option<VertexId>> = vec![None; mesh.n_vertices()];
        let mut positions = Vec::new();
        let mut facets = Vec::with_capacity(D * whole.n_facets());
        let tags = whole.facets().map(|facet| whole.tag(facet)).collect();
        for vertex in whole.facets().flat_map(|facet| whole.facet(facet)) {
            facets.push(*numbers[vertex.index()].get_or_insert_with(|| {
                positions.push(mesh.vertex(*vertex));
                VertexId::new(positions.len() - 1)
            }));
        }
        (BoundaryMesh::new(facets, Vec::new(), tags), positions)
    }
}

/// Number of triangles in a square with sides of the size of a cell.
const CELLS_IN_SQUARE: f64 = 2.7;
/// Number of tetrahedra in a cube with sides of the size of a cell.
const CELLS_IN_CUBE: f64 = 6.0;

/// Estimates the number of cells of a shape whose mesh is always generated, from its area or volume. Returns also the
/// key that decides it; `None` for other shapes.
pub(super) fn expected_cells<const D: usize>(shape: &Shape) -> Option<(f64, &'static str)> {
    let per_measure = |size: f64| if D == 2 { CELLS_IN_SQUARE } else { CELLS_IN_CUBE } / size.powi(D as i32);
    let measure_of_ball = |radius: f64| if D == 2 { PI * radius.powi(2) } else { 4.0 / 3.0 * PI * radius.powi(3) };
    match shape {
        Shape::Ball { radius, size, .. } => Some((measure_of_ball(*radius) * per_measure(*size), "size")),
        Shape::HalfBall { radius, size, .. } => Some((0.5 * measure_of_ball(*radius) * per_measure(*size), "size")),
        Shape::Box { n: Some(n), .. } => {
            // A brick has `D!` simplices.
            let of_brick: usize = (1..=D).product();
            Some((n.iter().map(|n| *n as f64).product::<f64>() * of_brick as f64, "n"))
        }
        Shape::Box { min, max, size: Some(size), .. } => {
            Some(((max.vector::<D>() - min.vector::<D>()).product().abs() * per_measure(*size), "size"))
        }
        _ => None,
    }
}

/// Checks that there is memory for the cells of a shape whose mesh is always generated.
fn check_memory<const D: usize>(shape: &At<Shape>) -> Result<(), ScenarioError> {
    expected_cells::<D>(shape).map_or(Ok(()), |(n_cells, key)| refuse_shortage(&shape.at.part(key), n_cells))
}

fn refuse_shortage(at: &Location, n_cells: f64) -> Result<(), ScenarioError> {
    shortage_of_body(n_cells).map_or(Ok(()), |shortage| Err(at.invalid(shortage)))
}

/// Checks that the highest corner of a box, at a location, is above the lowest one along each axis.
pub(super) fn check_corners(min: &Components<f64>, max: &Components<f64>, at: &Location) -> Result<(), ScenarioError> {
    let is_below = |axis: &usize| min[*axis] >= max[*axis];
    let found = (0..max.len()).find(is_below);
    found.map_or(Ok(()), |axis| {
        let (low, high) = (min[axis], max[axis]);
        Err(at.part(axis).invalid(format!("this is {high}, but must be above that of min, which is {low}")))
    })
}

/// Checks that the triangles of a surface bound a body.
///
/// # Errors
/// A text with cause, place and remedy: no triangles, or a side without exactly one neighbour of the same orientation.
fn closed(surface: &Surface) -> Result<(), String> {
    let sides = || {
        let of_facet = |v: [VertexId; 3]| [[v[0], v[1]], [v[1], v[2]], [v[2], v[0]]];
        let boundary = surface.boundary();
        boundary.facets().flat_map(move |facet| of_facet(std::array::from_fn(|k| boundary.facet(facet)[k])))
    };
    let mut count: HashMap<[VertexId; 2], usize> = HashMap::new();
    sides().for_each(|side| *count.entry(side).or_insert(0) += 1);
    if count.is_empty() {
        return Err("it has no triangles; save the surface again".to_owned());
    }
    for [a, b] in sides() {
        let (along, against) = (count[&[a, b]], count.get(&[b, a]).copied().unwrap_or(0));
        let problem = match (along, against) {
            (1, 1) => continue,
            (1, 0) => "the surface is open",
            (2, 0) => "two triangles have opposite orientations",
            _ => "more than two triangles meet",
        };
        let x = surface.positions()[a.index()];
        return Err(format!("{problem} at a side from ({}, {}, {}); close it, or repair it there", x[0], x[1], x[2]));
    }
    Ok(())
}

/// Size of the segments of lines.
#[derive(Clone, Copy)]
pub(super) enum LineSize<'a> {
    /// Largest length of a segment.
    Uniform(f64),
    /// Length as a function of position.
    Graded(&'a dyn Fn([f64; 2]) -> f64),
}

/// Returns the outline of a polygon and its holes.
pub(super) fn polygon_lines(
    at: &Location,
    corners: &[Components<f64>],
    holes: &[Vec<Components<f64>>],
    size: LineSize<'_>,
    is_smooth: bool,
) -> Result<Vec<ClosedLine>, ScenarioError> {
    let line = |corners: &[Components<f64>], part: String, name: &dyn Fn(usize) -> String| {
        let corners: Vec<[f64; 2]> = corners.iter().map(planar).collect();
        let line = match size {
            LineSize::Uniform(h) if is_smooth => ClosedLine::smooth(&corners, h, &name(0)),
            LineSize::Uniform(h) => ClosedLine::polygon(&corners, h, name),
            LineSize::Graded(h) if is_smooth => ClosedLine::graded_smooth(&corners, h, &name(0)),
            LineSize::Graded(h) => ClosedLine::graded_polygon(&corners, h, name),
        };
        line.map_err(|error| match &error {
            mesh::Error::Parameter(parameter) if parameter.what == SEGMENTS => refuse(&at.part("size"), error),
            _ => refuse(&at.part(part), error),
        })
    };
    let side = |k: usize| if is_smooth { "surface".to_owned() } else { format!("side-{}", k + 1) };
    let mut lines = vec![line(corners, "corners".to_owned(), &side)?];
    for (k, hole) in holes.iter().enumerate() {
        lines.push(line(hole, format!("holes.{k}"), &|_| format!("hole-{}", k + 1))?);
    }
    Ok(lines)
}

/// Name, in errors of `mesh`, of a parameter that is computed from the size.
const SEGMENTS: &str = "number of segments of a side";

fn planar(x: &Components<f64>) -> [f64; 2] {
    [x[0], x[1]]
}

/// Returns an error about a shape, with the remedy if it does not exist in the dimension.
fn refuse(at: &Location, error: mesh::Error) -> ScenarioError {
    match error {
        mesh::Error::Dimension { .. } => at.invalid(format!("{error}; use a box, or dimension = 2")),
        _ => at.error(error),
    }
}

/// Returns the names of the parts of lines, each once.
fn names_of_lines(lines: &[ClosedLine]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in lines.iter().flat_map(|line| &line.names) {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

/// Returns the surface of lines: the outer line first, then the lines around holes.
pub(super) fn surface_of_lines<const D: usize>(lines: Vec<ClosedLine>) -> (BoundaryMesh<D>, Vec<Point<D>>) {
    let names = names_of_lines(&lines);
    let (mut facets, mut positions, mut tags) = (Vec::new(), Vec::new(), Vec::new());
    for (k, line) in lines.into_iter().enumerate() {
        let is_outwards = (line.area() > 0.0) == (k == 0);
        let line = if is_outwards { line } else { line.reversed() };
        let (first, n) = (positions.len(), line.points.len());
        positions.extend(line.points.iter().map(|x| Point::from_fn(|axis, _| x[axis])));
        facets.extend((0..n).flat_map(|k| [first + k, first + (k + 1) % n]).map(VertexId::new));
        tags.extend(line.names.iter().map(|name| names.iter().position(|other| other == name).map(Tag::new)));
    }
    (BoundaryMesh::new(facets, Vec::new(), tags), positions)
}

/// Returns the nodes of elements of order 2 on lines. The points of the lines are the first vertices of the mesh.
fn nodes_on_lines<const D: usize>(lines: &[ClosedLine]) -> EdgeNodes<D> {
    let mut nodes = HashMap::new();
    let mut first = 0;
    for line in lines {
        let n = line.points.len();
        for (k, middle) in line.middles.iter().enumerate() {
            let [a, b] = [first + k, first + (k + 1) % n].map(VertexId::new);
            nodes.insert([a.min(b), a.max(b)], Point::from_fn(|axis, _| middle[axis]));
        }
        first += n;
    }
    nodes
}

/// Returns the nodes of elements of order 2 on the round edges of a ball.
fn nodes_on_ball<const D: usize>(mesh: &SimplexMesh<D>, centre: Point<D>) -> EdgeNodes<D> {
    let tag = mesh.tag("surface");
    let mut nodes = HashMap::new();
    for facet in mesh.facets().filter(|facet| tag.is_some() && mesh.facet_tag(*facet) == tag) {
        for (k, &a) in mesh.facet(facet).iter().enumerate() {
            for &b in &mesh.facet(facet)[..k] {
                let arms = [a, b].map(|vertex| mesh.vertex(vertex) - centre);
                let middle = (arms[0] + arms[1]).normalize() * arms[0].norm();
                nodes.insert([a.min(b), a.max(b)], centre + middle);
            }
        }
    }
    nodes
}

/// Returns the path of a file, whose name is relative to the scenario.
pub(super) fn input_path(file: &At<String>) -> PathBuf {
    file.at.file.parent().unwrap_or(Path::new("")).join(file.as_str())
}

/// Reads a Gmsh file.
pub(super) fn read_gmsh(file: &At<String>, path: &Path) -> Result<GmshFile, ScenarioError> {
    GmshFile::read(path).map_err(|error| unreadable(file, error))
}

/// Returns an error about the content of a file.
pub(super) fn in_file(file: &At<String>, path: &Path, problem: String) -> ScenarioError {
    unreadable(file, Error::MeshFile { path: path.to_owned(), problem })
}

fn unreadable(file: &At<String>, error: Error) -> ScenarioError {
    let advice = if matches!(error, Error::Read { .. }) { ", relative to the scenario" } else { "" };
    file.at.invalid(format!("{error}{advice}"))
}

/// Largest component of a unit normal that is round-off.
pub(super) const ROUND_OFF: f64 = 1e-9;

/// Returns the outward unit normal of a tagged part of a boundary; components of the size of round-off are zero.
///
/// A given normal replaces the normal of the facets.
///
/// # Errors
/// Facets that do not lie in one plane, or a given normal that is zero.
pub(super) fn plane_normal<const D: usize>(
    at: &Location,
    mesh: &SimplexMesh<D>,
    tag: Tag,
    given: Option<&Components<f64>>,
) -> Result<Vector<D>, ScenarioError> {
    let normal = match given {
        Some(given) => given.vector::<D>().try_normalize(0.0).ok_or_else(|| at.part("normal").invalid(ZERO_VECTOR))?,
        None => mesh.tag_normal(tag).ok_or_else(|| {
            at.invalid("this part of the boundary is not plane; use another condition, or give a symmetry its normal")
        })?,
    };
    let cleaned = normal.map(|n| if n.abs() > ROUND_OFF { n } else { 0.0 });
    Ok(cleaned.normalize())
}

/// Message about a vector that must give a direction.
pub(super) const ZERO_VECTOR: &str = "this vector is zero, but must give a direction";
