//! Conditions of a scenario on the boundary of the fluid.

use std::f64::consts::PI;
use std::sync::Arc;

use mesh::{Aabb, Point, SimplexMesh, Tag, Vector};
use solver::body::TimeField;
use solver::{FluidBoundary, FluidSetup};

use super::error::ScenarioError;
use super::field::{Field, FieldFormula};
use super::geometry::normal_along_axis;
use super::key::Quantity;
use super::table::{At, Components, choices};

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

pub(super) fn fluid_boundary<const D: usize>(
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
