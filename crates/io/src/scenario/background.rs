//! Background mesh of a scenario, and regions of finer cells.

use std::sync::Arc;

use mesh::generate::{
    Region, RegionShape, Size, expected_cells, expected_cells_where, mirrored, refined_box, refined_inside,
};
use mesh::search::SurfaceIndex;
use mesh::{Aabb, BoundaryMesh, FacetId, Placed, Point, SimplexMesh};

use super::body::BodyKeys;
use super::condition::FluidCondition;
use super::error::{Location, ScenarioError};
use super::geometry::{LineSize, check_corners, in_file, input_path, polygon_lines, read_gmsh, surface_of_lines};
use super::key::Quantity;
use super::table::{At, Components, Named, OrTable, choices, keys};
use crate::files::extension;
use crate::memory::{available, shortage};

choices! {
    /// Background mesh, on which the fluid is discretised.
    pub enum Background ["kind"] {
        /// Box with cells of graded size; sides `left` and `right` (across x), `bottom` and `top` (across y). In 3D
        /// `front`, at the lower y, and `back` are across y, `bottom` and `top` across z.
        GradedBox = "graded-box" {
            /// Lowest corner.
            min: Components<f64> [unit(Quantity::LENGTH)],
            /// Highest corner.
            max: At<Components<f64>> [unit(Quantity::LENGTH)],
            /// Mean diameter of the cells: a number, or sizes graded along an axis.
            size: At<OrTable<f64, GradedSize>> [unit(Quantity::LENGTH), positive],
            /// Regions near which cells are finer, between `min` and `max`. Where several sizes apply, the smallest one counts.
            refine: Vec<At<Refinement>>,
            /// Whether the mirror image across the left side is added.
            mirrored: bool = false,
            /// Condition on each side.
            boundary: At<Named<FluidCondition>>,
        },
        /// Polygon, or inside of a smooth curve through its corners, in 2D. Sides `side-1`, `side-2` and so on after each
        /// corner, `surface` for a smooth curve; `hole-1` and so on for holes.
        Polygon = "polygon" {
            /// Corners, in order.
            corners: Vec<Components<f64>> [unit(Quantity::LENGTH)],
            /// Corners of holes, a list for each hole.
            holes: Vec<Vec<Components<f64>>> [unit(Quantity::LENGTH)],
            /// Mean diameter of the cells.
            size: At<f64> [unit(Quantity::LENGTH), positive],
            /// Regions near which cells are finer. Where several sizes apply, the smallest one counts.
            refine: Vec<At<Refinement>>,
            /// Whether outline and holes are periodic cubic splines through their corners. The outline is then one side.
            smooth: bool = false,
            /// Condition on each side.
            boundary: At<Named<FluidCondition>>,
        },
        /// Mesh of any shape from a Gmsh file (`.msh`, version 4.1 or 2.2). Its sides are the physical groups of the
        /// curves (2D) or surfaces (3D) on its boundary; every part of the boundary belongs to one.
        Mesh = "mesh" {
            /// Path of the file, relative to the scenario.
            file: At<String>,
            /// Factor by which the coordinates of the file are multiplied.
            scale: f64 [positive] = 1.0,
            /// Condition on each side.
            boundary: At<Named<FluidCondition>>,
        },
    }
}

impl Background {
    /// Returns the conditions on the sides.
    pub(crate) fn boundary(&self) -> &At<Named<FluidCondition>> {
        let (Self::GradedBox { boundary, .. } | Self::Polygon { boundary, .. } | Self::Mesh { boundary, .. }) = self;
        boundary
    }
}

keys! {
    /// Size of cells that is linear in a coordinate between a fine and a coarse region.
    pub struct GradedSize {
        /// Size where the coordinate is above `coarse_from`.
        coarse: f64 [unit(Quantity::LENGTH), positive],
        /// Size where the coordinate is below `fine_until`.
        fine: f64 [unit(Quantity::LENGTH), positive],
        /// Coordinate up to which cells are fine.
        fine_until: f64 [unit(Quantity::LENGTH)],
        /// Coordinate from which on cells are coarse.
        coarse_from: f64 [unit(Quantity::LENGTH)],
        /// The coordinate.
        axis: Axis,
    }
}

keys! {
    /// Region near which cells are finer.
    pub struct Refinement {
        /// The region.
        near: RegionChoice,
        /// Size of the cells in the region.
        size: f64 [unit(Quantity::LENGTH), positive],
        /// Increase of the size over the distance from the region, from cell to cell about this fraction.
        growth: f64 [between(0.01, 0.5)] = 0.1,
    }
}

choices! {
    /// A region of the background.
    pub enum RegionChoice ["kind"] {
        /// Ball, a disk in 2D.
        Ball = "ball" {
            /// Centre.
            centre: Components<f64> [unit(Quantity::LENGTH)],
            /// Radius.
            radius: f64 [unit(Quantity::LENGTH), positive],
        },
        /// Box.
        Box = "box" {
            /// Lowest corner.
            min: Components<f64> [unit(Quantity::LENGTH)],
            /// Highest corner.
            max: Components<f64> [unit(Quantity::LENGTH)],
        },
        /// Point.
        Point = "point" {
            /// Position.
            at: Components<f64> [unit(Quantity::LENGTH)],
        },
        /// Segment of a line.
        Line = "line" {
            /// One end.
            from: Components<f64> [unit(Quantity::LENGTH)],
            /// The other end.
            to: Components<f64> [unit(Quantity::LENGTH)],
        },
        /// Inside of a polygon, in 2D.
        Polygon = "polygon" {
            /// Corners, in order.
            corners: Vec<Components<f64>> [unit(Quantity::LENGTH)],
        },
        /// Surface of a body where its shape stands.
        Body = "body" {
            /// Name of the body; copies have names of their own.
            name: At<String>,
            /// Distance from the surface up to which the size is that of the region.
            within: f64 [unit(Quantity::LENGTH), non_negative] = 0.0,
        },
    }
}

choices! {
    /// A coordinate axis.
    #[derive(Copy, Eq)]
    pub enum Axis {
        /// First axis.
        X = "x",
        /// Second axis.
        Y = "y",
        /// Third axis.
        Z = "z",
    }
}

/// Generates or reads the background.
pub(super) fn background<const D: usize>(
    given: &At<Background>,
    bodies: &[At<BodyKeys>],
) -> Result<SimplexMesh<D>, ScenarioError> {
    let (min, max, size, refine, is_mirrored) = match &**given {
        Background::GradedBox { min, max, size, refine, mirrored, .. } => (min, max, size, refine, mirrored),
        Background::Polygon { corners, holes, size, refine, smooth, .. } => {
            return polygon(&given.at, corners, holes, *smooth, size, refine, bodies);
        }
        Background::Mesh { file, scale, .. } => return background_from_file(file, *scale),
    };
    let field = size_field::<D>(size).ok_or_else(|| {
        size.at.part("axis").invalid("there is no third axis with dimension = 2; use axis = \"x\" or axis = \"y\"")
    })?;
    check_corners(min, max, &max.at)?;
    let min = min.vector::<D>();
    let corners = [min, max.vector::<D>()].map(<[f64; D]>::from);
    let sides = (0..D).map(|axis| corners[1][axis] - corners[0][axis]);
    let shortest = sides.fold(f64::INFINITY, f64::min);
    if let OrTable::Plain(h) = &**size
        && *h > shortest * (1.0 + 1e-9)
    {
        let n = expected_cells(corners[0], corners[1], &field, &[]);
        return Err(size.at.invalid(format!(
            "cells of the size {h} do not fit into the shortest side of the box, {shortest}; give at most {shortest}, which makes about {n:.1e} cells"
        )));
    }
    let too_many = |n_cells| shortage(n_cells, available()).map_or(Ok(()), |shortage| Err(size.at.invalid(shortage)));
    // Checked first: the regions below are compared with the size.
    too_many(expected_in_box(corners, &field, &[], *is_mirrored))?;
    let regions = refine.iter().map(|given| region(given, corners, &field, bodies)).collect::<Result<Vec<_>, _>>()?;
    let n_cells = expected_in_box(corners, &field, &regions, *is_mirrored);
    too_many(n_cells)?;
    let box_mesh = refined_box(corners[0], corners[1], &field, &regions).map_err(|error| {
        let at = match error {
            mesh::Error::Parameter(parameter) if parameter.what == "side of the box" => &max.at,
            mesh::Error::Parameter(_) => &size.at,
            _ => &given.at,
        };
        at.error(error)
    })?;
    if *is_mirrored { mirrored(&box_mesh, 0, min[0]).map_err(|error| given.at.error(error)) } else { Ok(box_mesh) }
}

/// Returns the size of the cells; `None` if it is graded along an axis that the space does not have.
fn size_field<const D: usize>(size: &OrTable<f64, GradedSize>) -> Option<Size> {
    match size {
        OrTable::Plain(h) => Some(Size::uniform(*h)),
        OrTable::Table(graded) => {
            let axis = graded.axis as usize;
            let &GradedSize { fine, fine_until, coarse, coarse_from, .. } = graded;
            (axis < D).then_some(Size::Graded { fine, fine_until, coarse, coarse_from, axis })
        }
    }
}

fn bounds<const D: usize>(corners: &[Components<f64>]) -> [[f64; D]; 2] {
    let Aabb { low, high } = Aabb::of_points(&corners.iter().map(Components::vector::<D>).collect::<Vec<_>>());
    [low.into(), high.into()]
}

fn expected_in_box<const D: usize>(
    [min, max]: [[f64; D]; 2],
    size: &Size,
    regions: &[Region<D>],
    is_mirrored: bool,
) -> f64 {
    expected_cells(min, max, size, regions) * if is_mirrored { 2.0 } else { 1.0 }
}

fn expected_in_polygon<const D: usize>(
    corners: &[Components<f64>],
    holes: &[Vec<Components<f64>>],
    [min, max]: [[f64; D]; 2],
    size: &Size,
    regions: &[Region<D>],
) -> f64 {
    let is_inside = |x: &Point<D>| {
        let crosses = |(a, b): (&Components<f64>, &Components<f64>)| {
            (a[1] > x[1]) != (b[1] > x[1]) && x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        };
        let sides = |line: &[Components<f64>]| {
            line.iter().zip(line.iter().cycle().skip(1)).filter(|side| crosses(*side)).count()
        };
        holes.iter().map(|hole| &hole[..]).chain([corners]).map(sides).sum::<usize>() % 2 == 1
    };
    expected_cells_where(min, max, size, regions, is_inside)
}

/// Estimates the number of cells of a background. Returns `None` if it is read from a file, or its keys are invalid.
pub(super) fn expected<const D: usize>(given: &Background, bodies: &[At<BodyKeys>]) -> Option<f64> {
    let regions = |refine: &[At<Refinement>], bounds, size: &Size| {
        refine.iter().map(|given| region::<D>(given, bounds, size, bodies).ok()).collect::<Option<Vec<_>>>()
    };
    match given {
        Background::GradedBox { min, max, size, refine, mirrored, .. } => {
            check_corners(min, max, &max.at).ok()?;
            let (corners, size) = ([min, max].map(|x| x.vector::<D>().into()), size_field::<D>(size)?);
            Some(expected_in_box(corners, &size, &regions(refine, corners, &size)?, *mirrored))
        }
        Background::Polygon { corners, holes, size, refine, .. } => {
            let (bounds, size) = (bounds(corners), Size::uniform(**size));
            let n_cells = expected_in_polygon(corners, holes, bounds, &size, &regions(refine, bounds, &size)?);
            n_cells.is_finite().then_some(n_cells)
        }
        Background::Mesh { .. } => None,
    }
}

/// Generates a background between lines.
fn polygon<const D: usize>(
    at: &Location,
    corners: &[Components<f64>],
    holes: &[Vec<Components<f64>>],
    is_smooth: bool,
    size: &At<f64>,
    refine: &[At<Refinement>],
    bodies: &[At<BodyKeys>],
) -> Result<SimplexMesh<D>, ScenarioError> {
    let coarse = Size::uniform(**size);
    let bounds = bounds(corners);
    let too_many = |n_cells| shortage(n_cells, available()).map_or(Ok(()), |shortage| Err(size.at.invalid(shortage)));
    too_many(expected_in_polygon(corners, holes, bounds, &coarse, &[]))?;
    let regions = refine.iter().map(|given| region(given, bounds, &coarse, bodies)).collect::<Result<Vec<_>, _>>()?;
    too_many(expected_in_polygon(corners, holes, bounds, &coarse, &regions))?;
    let near = |x: [f64; 2]| {
        let x = Point::<D>::from_fn(|axis, _| x[axis]);
        regions.iter().map(|region| region.at(&x)).fold(**size, f64::min)
    };
    let sizes = if refine.is_empty() { LineSize::Uniform(**size) } else { LineSize::Graded(&near) };
    let lines = polygon_lines(at, corners, holes, sizes, is_smooth)?;
    refined_inside(&lines, **size, &regions).map_err(|error| at.error(error))
}

/// Reads a background.
fn background_from_file<const D: usize>(file: &At<String>, scale: f64) -> Result<SimplexMesh<D>, ScenarioError> {
    let path = input_path(file);
    if extension(&path) != "msh" {
        return Err(file
            .at
            .invalid("a background is read from a Gmsh file, whose name ends in .msh; save the mesh in that format"));
    }
    let found = read_gmsh(file, &path)?.mesh::<D>().map_err(|problem| in_file(file, &path, problem))?;
    if let Some(shortage) = shortage(found.mesh.n_cells() as f64, available()) {
        return Err(file.at.invalid(shortage));
    }
    let mesh = found.mesh.mapped(|x| x * scale).map_err(|error| file.at.error(error))?;
    let is_bare = |facet: &FacetId| mesh.is_boundary(*facet) && mesh.facet_tag(*facet).is_none();
    let mut bare = mesh.facets().filter(is_bare);
    if let Some(first) = bare.next() {
        let (n, x) = (bare.count() + 1, mesh.vertex(mesh.facet(first)[0]));
        let problem = format!(
            "{n} facets of the boundary belong to no physical group, the first one at {:?}; give every part of the boundary a group and save again",
            x.as_slice(),
        );
        return Err(in_file(file, &path, problem));
    }
    Ok(mesh)
}

/// Builds a region near which a background between two corners, with cells of size `coarse`, is refined.
fn region<const D: usize>(
    given: &At<Refinement>,
    [min, max]: [[f64; D]; 2],
    coarse: &Size,
    bodies: &[At<BodyKeys>],
) -> Result<Region<D>, ScenarioError> {
    let surface = |(boundary, positions): (BoundaryMesh<D>, Vec<Point<D>>), is_filled, within| {
        let index = Arc::new(SurfaceIndex::new(&Placed::new(&boundary, &positions)));
        RegionShape::Surface { index, is_filled, within }
    };
    let shape = match &given.near {
        RegionChoice::Ball { centre, radius } => RegionShape::Segment { ends: [centre.vector(); 2], within: *radius },
        RegionChoice::Box { min, max } => RegionShape::Box(Aabb { low: min.vector(), high: max.vector() }),
        RegionChoice::Point { at } => RegionShape::Segment { ends: [at.vector(); 2], within: 0.0 },
        RegionChoice::Line { from, to } => RegionShape::Segment { ends: [from.vector(), to.vector()], within: 0.0 },
        RegionChoice::Polygon { corners } => {
            if D != 2 {
                return Err(given.at.part("near").invalid("a polygon is a region in 2D; use a box or a body"));
            }
            surface(
                surface_of_lines(polygon_lines(
                    &given.at.part("near"),
                    corners,
                    &[],
                    LineSize::Uniform(f64::MAX),
                    false,
                )?),
                true,
                0.0,
            )
        }
        RegionChoice::Body { name, within } => {
            let found = bodies.iter().find(|body| *body.name == **name);
            let names = bodies.iter().map(|body| body.name.as_str());
            let body = found.ok_or_else(|| name.at.unknown("body", name, names))?;
            surface(body.geometry()?.into_surface(), false, *within)
        }
    };
    let region = Region { shape, size: given.size, growth: given.growth };
    region.check(min, max, coarse).map_err(|error| given.at.error(mesh::Error::from(error)))?;
    Ok(region)
}
