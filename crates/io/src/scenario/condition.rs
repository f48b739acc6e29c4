//! Conditions of a scenario on the boundary of the fluid.

use std::f64::consts::PI;
use std::sync::Arc;

use mesh::{Aabb, Point, SimplexMesh, Tag, Vector, unit_vector};
use solver::body::TimeField;
use solver::{FluidBoundary, TractionField};

use super::error::ScenarioError;
use super::field::{Field, FieldFormula};
use super::geometry::plane_normal;
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
        /// Flow across a plane part and not along it: the end of a long channel.
        Parallel = "parallel" {
            /// Pressure of the fluid on the part, where it flows in and where it flows out; zero if left out.
            pressure: Option<At<FieldFormula>> [unit(Quantity::PRESSURE)],
        },
        /// No traction. Where fluid flows in, the traction is `ρ (u·n) u/2`, so that the inflow brings no energy.
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
            /// Largest speed, which may be a formula of the time `t`.
            maximum: At<FieldFormula> [unit(Quantity::VELOCITY)],
            /// Time over which the speed rises smoothly from zero; at once if left out.
            ramp: Option<f64> [unit(Quantity::TIME), positive],
        },
        /// Given traction; where fluid flows in, `ρ (u·n) u/2` is added.
        Traction = "traction" {
            /// Force per area on the fluid.
            value: Field [unit(Quantity::PRESSURE)],
        },
        /// Pressure outside: the traction `-p n`. Where fluid flows in, `p` is the total pressure, that of a reservoir at rest: the pressure
        /// on the side is lower by `ρ u²/2`.
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
        /// Parabola over the extent of the part along each axis, zero at its ends. On the axis of axisymmetric
        /// coordinates it is largest. A part that ends at a plane of symmetry needs `velocity` with a formula.
        Parabolic = "parabolic",
    }
}

pub(super) fn tagged_vertices<const D: usize>(mesh: &SimplexMesh<D>, tag: Tag) -> Vec<Point<D>> {
    let facets = mesh.facets().filter(|facet| mesh.facet_tag(*facet) == Some(tag));
    facets.flat_map(|facet| mesh.facet(facet)).map(|vertex| mesh.vertex(*vertex)).collect()
}

/// Number of times at which given velocities are checked.
const N_TIMES: usize = 17;
/// The ratio whose multiples are farthest from being periodic.
const GOLDEN_RATIO: f64 = 1.618_033_988_749_895;

/// Returns the times at which given velocities are checked: start, end, and times between them that are multiples of no
/// period.
pub(super) fn sampled([start, end]: [f64; 2]) -> impl Iterator<Item = f64> {
    let fractions = (1..N_TIMES - 1).map(|k| (k as f64 * GOLDEN_RATIO).fract());
    let mut fractions: Vec<f64> = [0.0, 1.0].into_iter().chain(fractions).collect();
    fractions.sort_by(f64::total_cmp);
    fractions.into_iter().map(move |fraction| start + (end - start) * fraction)
}

/// Largest distance of a plane of symmetry from a vertex on it, relative to the size of the domain.
const ON_PLANE: f64 = 1e-9;

/// Returns the largest distance of a plane of symmetry from a vertex on it.
pub(super) fn on_plane<const D: usize>(background: &SimplexMesh<D>) -> f64 {
    Aabb::of_points(background.vertices()).extent().max() * ON_PLANE
}

pub(super) fn fluid_boundary<const D: usize>(
    background: &SimplexMesh<D>,
    tag: Tag,
    condition: &At<FluidCondition>,
    times: [f64; 2],
) -> Result<FluidBoundary<D>, ScenarioError> {
    let points = || tagged_vertices(background, tag);
    let traction_of = |pressure: &At<FieldFormula>| -> Result<TractionField<D>, ScenarioError> {
        let p = pressure.over_time(&pressure.at, &points(), &times)?;
        Ok(Arc::new(move |x, n, t| n * -p(x, t)))
    };
    Ok(match &**condition {
        FluidCondition::NoSlip => FluidBoundary::NoSlip,
        FluidCondition::Symmetry { normal } => {
            let normal = plane_normal(&condition.at, background, tag, normal.as_ref())?;
            let (points, room) = (points(), on_plane(background));
            if points.iter().any(|x| normal.dot(&(x - points[0])).abs() > room) {
                return Err(condition.at.part("normal").invalid(
                    "this part of the boundary does not lie in a plane across the normal; for flow straight out of the domain use `parallel`",
                ));
            }
            FluidBoundary::Symmetry { normal: unsigned(normal) }
        }
        FluidCondition::Parallel { pressure } => FluidBoundary::Parallel {
            normal: unsigned(plane_normal(&condition.at, background, tag, None)?),
            traction: pressure.as_ref().map(traction_of).transpose()?,
        },
        FluidCondition::Free => FluidBoundary::Open { traction: None, backflow: true },
        FluidCondition::Velocity { value } => FluidBoundary::Velocity(value.over_time(&points(), &times)?),
        FluidCondition::Inflow { profile: InflowProfile::Parabolic, maximum, ramp } => {
            let normal = plane_normal(&condition.at, background, tag, None)?;
            if normal.iter().filter(|n| **n != 0.0).count() > 2 {
                return Err(condition.at.invalid(
                    "the plane of this inflow contains no axis, so that the edges along which its parabola is zero are not known; use `velocity` with a formula",
                ));
            }
            let maximum = maximum.over_time(&maximum.at, &points(), &times)?;
            let radial = background.coordinates().radial();
            FluidBoundary::Velocity(parabolic_inflow(&points(), normal, radial, maximum, *ramp))
        }
        FluidCondition::Traction { value } => {
            let value = value.over_time(&points(), &times)?;
            FluidBoundary::Open { traction: Some(Arc::new(move |x, _, t| value(x, t))), backflow: true }
        }
        FluidCondition::Pressure { value } => {
            FluidBoundary::Open { traction: Some(traction_of(value)?), backflow: true }
        }
    })
}

/// Returns a normal whose largest component is positive.
fn unsigned<const D: usize>(normal: Vector<D>) -> Vector<D> {
    normal * normal[normal.iamax()].signum()
}

/// Returns the inflow against the outward normal of a plane. It is a product of parabolas over the extents of the
/// points along the projections of the axes on the plane, zero at the ends. On the axis of axisymmetric coordinates,
/// with the radius along `radial`, it is largest and not zero. It rises as `(1 - cos(π t/ramp))/2`.
fn parabolic_inflow<const D: usize>(
    points: &[Point<D>],
    normal: Vector<D>,
    radial: Option<usize>,
    maximum: impl Fn(&Point<D>, f64) -> f64 + Send + Sync + 'static,
    ramp: Option<f64>,
) -> TimeField<D> {
    let across = (0..D).filter(|axis| *axis != normal.iamax());
    let extents = across.map(|axis| {
        let along = unit_vector::<D>(axis) - normal * normal[axis];
        let of_points = || points.iter().map(|x| along.dot(x));
        let (low, high) = (of_points().fold(f64::INFINITY, f64::min), of_points().fold(f64::NEG_INFINITY, f64::max));
        (along, if radial == Some(axis) && low == 0.0 { -high } else { low }, high)
    });
    let extents: Vec<_> = extents.collect();
    Arc::new(move |x, t| {
        let across = extents.iter().map(|(along, low, high)| {
            let s = (along.dot(x) - low) / (high - low);
            4.0 * s * (1.0 - s)
        });
        let rise = ramp.filter(|ramp| t < *ramp).map_or(1.0, |ramp| 0.5 * (1.0 - (PI * t / ramp).cos()));
        -normal * (maximum(x, t) * rise * across.product::<f64>())
    })
}
