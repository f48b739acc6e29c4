//! Background mesh, fluid and mortar of a scenario.

use std::f64::consts::PI;
use std::sync::Arc;

use cutcell::OverlayOptions;
use fluid_ns::NewtonianFluid;
use fluid_ns::terms::CipProfile;
use mesh::generate::{Region, RegionShape, Size, expected_cells, inside, mirrored, refined_box};
use mesh::{Aabb, Coordinates, FacetId, Placed, Point, SimplexMesh, Tag, Vector};
use solver::body::TimeField;
use solver::interface_dg::terms::PenaltyProfile;
use solver::{FluidBoundary, FluidSetup, Stabilisation};

use super::error::ScenarioError;
use super::field::{Field, FieldFormula};
use super::geometry::{
    CELLS_IN_SQUARE, check_corners, in_file, input_path, normal_along_axis, polygon_lines, read_gmsh,
};
use super::key::Quantity;
use super::table::{At, Components, Named, OrTable, choices, keys};
use crate::files::extension;
use crate::memory::{available, shortage};

keys! {
    /// The fluid.
    pub struct Fluid {
        /// Density.
        density: f64 [unit(Quantity::DENSITY), positive],
        /// Dynamic viscosity.
        viscosity: f64 [unit(Quantity::VISCOSITY), positive],
        /// Stabilisation of fluid and interface: a set of parameters, or a table with a set and changes.
        stabilisation: OrTable<StabilisationChoice, StabilisationKeys> = "standard",
        /// Form of the convective term.
        convection: ConvectionChoice = "standard",
        /// Force per volume; none if left out.
        body_force: Option<Field> [unit(Quantity::FORCE_DENSITY)],
        /// Velocity at the start; at rest if left out.
        initial_velocity: Option<Field> [unit(Quantity::VELOCITY)],
    }
}

choices! {
    /// A set of stabilisation parameters.
    #[derive(Copy, Eq)]
    pub enum StabilisationChoice {
        /// The set for all problems, with which the method is verified.
        Standard = "standard",
        /// A calibration to the results of MOX-Report 44/2019: `γ_Σ = 1e5`, and a numerical viscosity that does not vanish
        /// under refinement.
        Paper = "paper-44-2019",
    }
}

keys! {
    /// A set of stabilisation parameters with changes.
    pub struct StabilisationKeys {
        /// The set.
        set: StabilisationChoice = "standard",
        /// Penalty on the jump of the velocity at the interface.
        penalty: Option<InterfacePenalty>,
        /// Interior penalty of the velocity.
        cip: Option<Cip>,
        /// Parameter `γ_p` of the interior penalty of the pressure.
        gamma_pressure: Option<f64> [positive],
        /// Parameter `γ_g` of the ghost penalty.
        gamma_ghost: Option<f64> [non_negative],
    }
}

choices! {
    /// Penalty on the jump of the velocity at the interface.
    pub enum InterfacePenalty ["kind"] {
        /// Viscosity in both directions, convection and inertia in the normal one only.
        Split = "split" {
            /// Parameter `γ_n`.
            gamma_normal: f64 [positive],
            /// Parameter `γ_t`.
            gamma_tangential: f64 [positive],
        },
        /// Viscosity alone, the form of the paper.
        Uniform = "uniform" {
            /// Parameter `γ_Σ`.
            gamma_sigma: f64 [positive],
        },
    }
}

choices! {
    /// Interior penalty of the velocity.
    pub enum Cip ["profile"] {
        /// Weights a face by its measure; calibrated to the results of the paper.
        Paper = "paper" {
            /// Parameter `γ_1`.
            gamma_1: f64 [non_negative],
        },
        /// Weights a face by the square of its diameter; vanishes under refinement.
        Consistent = "consistent" {
            /// Parameter `γ_u`.
            gamma_u: f64 [non_negative],
        },
    }
}

impl Fluid {
    /// Returns the name of the set of stabilisation parameters, and whether some are changed.
    pub fn stabilisation_name(&self) -> String {
        let name = |set: &StabilisationChoice| match set {
            StabilisationChoice::Standard => "standard",
            StabilisationChoice::Paper => "paper-44-2019",
        };
        match &self.stabilisation {
            OrTable::Plain(set) => name(set).to_owned(),
            OrTable::Table(table) => format!("{}, changed", name(&table.set)),
        }
    }
}

choices! {
    /// Form of the convective term.
    #[derive(Copy, Eq)]
    pub enum ConvectionChoice {
        /// `ρ (u·∇u, v)`.
        Standard = "standard",
        /// `ρ (u·∇u, v) + ρ/2 (∇·u, u·v)`.
        Skew = "skew",
        /// No convection: Stokes flow.
        None = "none",
    }
}

keys! {
    /// Mortar between fluid and bodies.
    pub struct Interface {
        /// Weight of the traction of the fluid; the rest is that of elastic bodies. Below 1 a run ends at once if the penalty is too
        /// small for the stiffness of the bodies.
        alpha: f64 [between(0.0, 1.0)] = 1.0,
    }
}

choices! {
    /// Background mesh, on which the fluid is discretised.
    pub enum Background ["kind"] {
        /// Box with cells of graded size; sides `left`, `right`, `bottom`, `top`, and in 3D `front`, `back`.
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
        /// Polygon with cells of one size, in 2D; sides `side-1`, `side-2` and so on after each corner, `hole-1` and so on for holes.
        Polygon = "polygon" {
            /// Corners, in order.
            corners: Vec<Components<f64>> [unit(Quantity::LENGTH)],
            /// Corners of holes, a list for each hole.
            holes: Vec<Vec<Components<f64>>> [unit(Quantity::LENGTH)],
            /// Mean diameter of the cells.
            size: At<f64> [unit(Quantity::LENGTH), positive],
            /// Condition on each side.
            boundary: At<Named<FluidCondition>>,
        },
        /// Mesh of any shape from a Gmsh file (`.msh`, version 4.1 or 2.2). Its sides are the physical groups of the curves (2D) or surfaces (3D) on its
        /// boundary; every part of the boundary belongs to one.
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
    pub(super) fn boundary(&self) -> &At<Named<FluidCondition>> {
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

choices! {
    /// Condition on a part of the boundary of the fluid.
    pub enum FluidCondition ["kind"] {
        /// No velocity.
        NoSlip = "no-slip",
        /// No velocity across a plane, no traction along it.
        Symmetry = "symmetry" {
            /// Normal of the plane; that of the facets if left out.
            normal: Option<Components<f64>>,
        },
        /// Flow across a plane part and not along it, without traction across it: the end of a long channel.
        Parallel = "parallel",
        /// No traction; inflow is stabilised.
        Free = "free",
        /// Given velocity.
        Velocity = "velocity" {
            /// Velocity.
            value: Field [unit(Quantity::VELOCITY)],
        },
        /// Inflow normal to a plane part.
        Inflow = "inflow" {
            /// Profile of the velocity.
            profile: InflowProfile,
            /// Largest speed.
            maximum: f64 [unit(Quantity::VELOCITY)],
            /// Time over which the speed rises smoothly from zero; at once if left out.
            ramp: Option<f64> [unit(Quantity::TIME), positive],
        },
        /// Given traction; inflow is stabilised.
        Traction = "traction" {
            /// Force per area on the fluid.
            value: Field [unit(Quantity::PRESSURE)],
        },
        /// Pressure outside: the traction `-p n`; inflow is stabilised.
        Pressure = "pressure" {
            /// Pressure `p`.
            value: At<FieldFormula> [unit(Quantity::PRESSURE)],
        },
    }
}

choices! {
    /// Profile of an inflow.
    #[derive(Copy, Eq)]
    pub enum InflowProfile {
        /// Parabola over the extent of the part along each axis, zero at its ends.
        Parabolic = "parabolic",
    }
}

fn background<const D: usize>(given: &At<Background>) -> Result<SimplexMesh<D>, ScenarioError> {
    let (min, max, size, refine, is_mirrored) = match &**given {
        Background::GradedBox { min, max, size, refine, mirrored, .. } => (min, max, size, refine, mirrored),
        Background::Polygon { corners, holes, size, .. } => {
            let next = corners.iter().cycle().skip(1);
            let area = 0.5 * corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>().abs();
            if let Some(shortage) = shortage(CELLS_IN_SQUARE * area / size.powi(2), available()) {
                return Err(size.at.invalid(shortage));
            }
            let lines = polygon_lines(&given.at, corners, holes, **size, false)?;
            return inside(&lines, **size).map_err(|error| given.at.error(error));
        }
        Background::Mesh { file, scale, .. } => return background_from_file(file, *scale),
    };
    let field = match &**size {
        OrTable::Plain(h) => Size::uniform(*h),
        OrTable::Table(graded) => Size::Graded {
            fine: graded.fine,
            fine_until: graded.fine_until,
            coarse: graded.coarse,
            coarse_from: graded.coarse_from,
            axis: graded.axis as usize,
        },
    };
    check_corners(min, max, &max.at)?;
    let min = min.vector::<D>();
    let corners = [min, max.vector::<D>()].map(<[f64; D]>::from);
    let regions = refine.iter().map(|given| region(given, corners, &field)).collect::<Result<Vec<_>, _>>()?;
    let n_cells = expected_cells(corners[0], corners[1], &field, &regions) * if *is_mirrored { 2.0 } else { 1.0 };
    if let Some(shortage) = shortage(n_cells, available()) {
        return Err(size.at.invalid(shortage));
    }
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
) -> Result<Region<D>, ScenarioError> {
    let shape = match &given.near {
        RegionChoice::Ball { centre, radius } => RegionShape::Segment { ends: [centre.vector(); 2], within: *radius },
        RegionChoice::Box { min, max } => RegionShape::Box(Aabb { low: min.vector(), high: max.vector() }),
        RegionChoice::Point { at } => RegionShape::Segment { ends: [at.vector(); 2], within: 0.0 },
        RegionChoice::Line { from, to } => RegionShape::Segment { ends: [from.vector(), to.vector()], within: 0.0 },
    };
    let region = Region { shape, size: given.size, growth: given.growth };
    region.check(min, max, coarse).map_err(|error| given.at.error(mesh::Error::from(error)))?;
    Ok(region)
}

fn stabilisation(given: &OrTable<StabilisationChoice, StabilisationKeys>) -> Stabilisation {
    let of_set = |set| match set {
        StabilisationChoice::Standard => Stabilisation::STANDARD,
        StabilisationChoice::Paper => Stabilisation::PAPER_44_2019,
    };
    let table = match given {
        OrTable::Plain(set) => return of_set(*set),
        OrTable::Table(table) => table,
    };
    let set = of_set(table.set);
    let penalty = table.penalty.as_ref().map(|penalty| match *penalty {
        InterfacePenalty::Split { gamma_normal, gamma_tangential } => {
            PenaltyProfile::Split { gamma_normal, gamma_tangential }
        }
        InterfacePenalty::Uniform { gamma_sigma } => PenaltyProfile::Uniform { gamma_sigma },
    });
    let cip = table.cip.as_ref().map(|cip| match *cip {
        Cip::Paper { gamma_1 } => CipProfile::Paper { gamma_1 },
        Cip::Consistent { gamma_u } => CipProfile::Consistent { gamma_u },
    });
    Stabilisation {
        penalty: penalty.unwrap_or(set.penalty),
        cip: cip.unwrap_or(set.cip),
        gamma_pressure: table.gamma_pressure.unwrap_or(set.gamma_pressure),
        gamma_ghost: table.gamma_ghost.unwrap_or(set.gamma_ghost),
    }
}

/// Builds the fluid with its boundary conditions and the weight of its traction in the mortar; `times` are the start and the end of the run.
pub(super) fn fluid<const D: usize>(
    (fluid, alpha, coordinates): (&Fluid, f64, Coordinates),
    given: &At<Background>,
    times: [f64; 2],
) -> Result<FluidSetup<D>, ScenarioError> {
    let background = background::<D>(given)?.with_coordinates(coordinates).map_err(|error| given.at.error(error))?;
    let conditions = given.boundary();
    let sides = background.boundary_names();
    if let Some((name, condition)) = conditions.0.iter().find(|(name, _)| !sides.contains(&name.as_str())) {
        return Err(condition.at.unknown("side", name, sides));
    }
    let mut boundary = Vec::new();
    for side in sides {
        let found = conditions.0.iter().find(|(name, _)| name == side).zip(background.tag(side));
        let missing = || conditions.at.invalid(format!("the condition on side `{side}` is missing; add it"));
        let ((_, condition), tag) = found.ok_or_else(missing)?;
        boundary.push((tag, fluid_boundary(&background, tag, condition, times)?));
    }
    let points = background.vertices();
    let body_force = fluid.body_force.as_ref().map(|force| force.over_time(points, &times)).transpose()?;
    let initial_velocity = fluid.initial_velocity.as_ref().map(|velocity| velocity.at_start(points)).transpose()?;
    Ok(FluidSetup {
        background,
        // The surfaces of meshes are simple; during a run an elastic body may fold onto itself.
        overlay: OverlayOptions::new().without_self_intersection_check(),
        material: NewtonianFluid { density: fluid.density, viscosity: fluid.viscosity },
        stabilisation: stabilisation(&fluid.stabilisation),
        alpha,
        convection: match fluid.convection {
            ConvectionChoice::Standard => Some(false),
            ConvectionChoice::Skew => Some(true),
            ConvectionChoice::None => None,
        },
        body_force,
        initial_velocity,
        boundary,
    })
}

/// Times at which the balance of a closed domain is checked.
const BALANCE_TIMES: usize = 17;
/// Largest net flow through the boundary of a closed domain, relative to the flow of the largest speeds through all of it: profiles are
/// interpolated on facets, with an error of second order in their size.
const LARGEST_NET_FLOW: f64 = 1e-2;

/// Returns a time and the net inflow at it if no part of the boundary is open and more fluid enters than leaves, or less. Velocities are those
/// that the solver prescribes at vertices: where conditions meet, walls come before given velocities.
pub(super) fn unbalanced<const D: usize>(fluid: &FluidSetup<D>, [start, end]: [f64; 2]) -> Option<(f64, f64)> {
    let is_open = |(_, condition): &(Tag, FluidBoundary<D>)| {
        matches!(condition, FluidBoundary::Open { .. } | FluidBoundary::Parallel { .. })
    };
    if fluid.boundary.iter().any(is_open) {
        return None;
    }
    let background = &fluid.background;
    let surface = &background.boundary();
    let placed = Placed::new(surface, background.vertices());
    let on = |tag: Tag| surface.facets().filter(move |facet| surface.tag(*facet) == Some(tag));
    let at = |time: f64| {
        let mut nodal = vec![Vector::<D>::zeros(); background.n_vertices()];
        for (tag, condition) in &fluid.boundary {
            let FluidBoundary::Velocity(velocity) = condition else { continue };
            let vertices = on(*tag).flat_map(|facet| surface.facet(facet));
            vertices.for_each(|v| nodal[v.index()] = velocity(&background.vertex(*v), time));
        }
        for (tag, _) in fluid.boundary.iter().filter(|(_, condition)| matches!(condition, FluidBoundary::NoSlip)) {
            on(*tag).flat_map(|facet| surface.facet(facet)).for_each(|v| nodal[v.index()] = Vector::zeros());
        }
        let of_facet = |facet: FacetId| {
            let (vertices, measure) = (surface.facet(facet), placed.facet_measure(facet));
            let sum: Vector<D> = vertices.iter().map(|v| nodal[v.index()]).sum();
            let middle = placed.facet_points(facet)[..D].iter().sum::<Point<D>>() / D as f64;
            let per_vertex = measure * background.coordinates().weight(&middle) / vertices.len() as f64;
            [-sum.dot(&placed.facet_normal(facet)) * per_vertex, sum.norm() * per_vertex]
        };
        surface.facets().map(of_facet).fold([0.0; 2], |sum, flow| [sum[0] + flow[0], sum[1] + flow[1]])
    };
    let times = (0..BALANCE_TIMES).map(|k| start + (end - start) * k as f64 / (BALANCE_TIMES - 1) as f64);
    let flows: Vec<(f64, [f64; 2])> = times.map(|time| (time, at(time))).collect();
    let largest = flows.iter().map(|(_, [_, all])| *all).fold(0.0, f64::max);
    flows.into_iter().map(|(time, [net, _])| (time, net)).find(|(_, net)| net.abs() > LARGEST_NET_FLOW * largest)
}

pub(super) fn tagged_vertices<const D: usize>(mesh: &SimplexMesh<D>, tag: Tag) -> Vec<Point<D>> {
    let facets = mesh.facets().filter(|facet| mesh.facet_tag(*facet) == Some(tag));
    facets.flat_map(|facet| mesh.facet(facet)).map(|vertex| mesh.vertex(*vertex)).collect()
}

/// Largest distance of a plane of symmetry from a vertex on it, relative to the size of the domain.
const ON_PLANE: f64 = 1e-9;

/// Returns the largest distance of a plane of symmetry from a vertex on it.
fn on_plane<const D: usize>(background: &SimplexMesh<D>) -> f64 {
    Aabb::of_points(background.vertices()).extent().max() * ON_PLANE
}

/// Returns the planes of symmetry: the number of the axis and the coordinate, with the largest distance of a vertex on them.
pub(super) fn symmetry_planes<const D: usize>(fluid: &FluidSetup<D>) -> (Vec<(usize, f64)>, f64) {
    let planes = fluid.boundary.iter().filter_map(|(tag, condition)| {
        let FluidBoundary::Symmetry { axis } = condition else { return None };
        tagged_vertices(&fluid.background, *tag).first().map(|x| (*axis, x[*axis]))
    });
    (planes.collect(), on_plane(&fluid.background))
}

fn fluid_boundary<const D: usize>(
    background: &SimplexMesh<D>,
    tag: Tag,
    condition: &At<FluidCondition>,
    times: [f64; 2],
) -> Result<FluidBoundary<D>, ScenarioError> {
    let points = || tagged_vertices(background, tag);
    Ok(match &**condition {
        FluidCondition::NoSlip => FluidBoundary::NoSlip,
        FluidCondition::Symmetry { normal } => {
            let (axis, _) = normal_along_axis(&condition.at, background, tag, normal.as_ref())?;
            let plane = points().first().map(|x| x[axis]);
            let room = on_plane(background);
            if points().iter().any(|x| plane.is_some_and(|plane| (x[axis] - plane).abs() > room)) {
                return Err(condition.at.part("normal").invalid(
                    "this part of the boundary does not lie in a plane across the normal; for flow straight out of the domain use `parallel`",
                ));
            }
            FluidBoundary::Symmetry { axis }
        }
        FluidCondition::Parallel => {
            let (axis, _) = normal_along_axis(&condition.at, background, tag, None)?;
            FluidBoundary::Parallel { axis }
        }
        FluidCondition::Free => FluidBoundary::Open { traction: None, backflow: true },
        FluidCondition::Velocity { value } => FluidBoundary::Velocity(value.over_time(&points(), &times)?),
        FluidCondition::Inflow { profile: InflowProfile::Parabolic, maximum, ramp } => {
            let (axis, normal) = normal_along_axis(&condition.at, background, tag, None)?;
            FluidBoundary::Velocity(parabolic_inflow(&points(), axis, -normal[axis], *maximum, *ramp))
        }
        FluidCondition::Traction { value } => {
            let value = value.over_time(&points(), &times)?;
            FluidBoundary::Open { traction: Some(Arc::new(move |x, _, t| value(x, t))), backflow: true }
        }
        FluidCondition::Pressure { value } => {
            let p = value.over_time(&value.at, &points(), &times)?;
            FluidBoundary::Open { traction: Some(Arc::new(move |x, n: &Vector<D>, t| n * -p(x, t))), backflow: true }
        }
    })
}

/// Returns the inflow along an axis that is zero at the ends of the extent of the points and rises as
/// `(1 - cos(π t/ramp))/2`.
fn parabolic_inflow<const D: usize>(
    points: &[Point<D>],
    axis: usize,
    inward: f64,
    maximum: f64,
    ramp: Option<f64>,
) -> TimeField<D> {
    let Aabb { low, high } = Aabb::of_points(points);
    Arc::new(move |x, t| {
        let across = (0..D).filter(|k| *k != axis).map(|k| {
            let s = (x[k] - low[k]) / (high[k] - low[k]);
            4.0 * s * (1.0 - s)
        });
        let rise = ramp.filter(|ramp| t < *ramp).map_or(1.0, |ramp| 0.5 * (1.0 - (PI * t / ramp).cos()));
        let mut u = Vector::zeros();
        u[axis] = inward * maximum * rise * across.product::<f64>();
        u
    })
}
