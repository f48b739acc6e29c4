//! Background mesh and fluid of a scenario.

use std::f64::consts::PI;
use std::sync::Arc;

use fluid_ns::NewtonianFluid;
use fluid_ns::terms::CipProfile;
use mesh::generate::{Size, graded_box, mirrored};
use mesh::{Point, SimplexMesh, Vector};
use solver::{FluidBoundary, FluidSetup, TimeField};

use super::lower::{side_axis, unknown_name, vector};
use super::problem::{Problem, ScenarioError};
use super::schema::{self, Background, Cip, Convection, FluidCondition};
use super::{GivenFluidCondition, InflowProfile, PlainFluidCondition, ScenarioFile};

/// The background mesh.
pub(super) fn background<const D: usize>(file: &ScenarioFile) -> Result<SimplexMesh<D>, ScenarioError> {
    let Background::GradedBox(graded) = &file.scenario().background;
    let min: Vector<D> = vector(file, "background.min", &graded.min)?;
    let max: Vector<D> = vector(file, "background.max", &graded.max)?;
    let size = match &graded.size {
        schema::Size::Uniform(h) => Size::uniform(*h),
        schema::Size::Graded(size) => Size::Graded {
            fine: size.fine,
            fine_until: size.fine_until,
            coarse: size.coarse,
            coarse_from: size.coarse_from,
            axis: size.axis.index(),
        },
    };
    let fail = |path: &str, source: mesh::Error| file.error(path, source);
    let mesh = graded_box::<D>(min.into(), max.into(), &size).map_err(|e| fail(culprit(&e), e))?;
    if graded.mirrored {
        return mirrored(&mesh, 0, min[0]).map_err(|e| fail("background.mirrored", e));
    }
    Ok(mesh)
}

/// The key that an error of the generator is about.
fn culprit(error: &mesh::Error) -> &'static str {
    match error {
        mesh::Error::Generate { what: "side of the box", .. } => "background.max",
        mesh::Error::Generate { .. } => "background.size",
        _ => "background",
    }
}

/// The fluid with its boundary conditions.
pub(super) fn fluid<const D: usize>(
    file: &ScenarioFile,
    background: &SimplexMesh<D>,
) -> Result<FluidSetup<D>, ScenarioError> {
    let fluid = &file.scenario().fluid;
    let Background::GradedBox(graded) = &file.scenario().background;
    let sides = background.tag_names();
    if let Some(name) = graded.boundary.keys().find(|name| !sides.contains(name)) {
        return Err(unknown_name(file, &format!("background.boundary.{name}"), "side", name, sides));
    }
    let mut boundary = Vec::new();
    for side in sides {
        let missing = || file.error("background.boundary", Problem::Missing { key: side.clone() });
        let condition = graded.boundary.get(side).ok_or_else(missing)?;
        let tag = background.tag(side).ok_or_else(missing)?;
        boundary.push((tag, fluid_boundary(file, background, side, condition)?));
    }
    let constant = |path: &str, values: &Option<Vec<f64>>| -> Result<Option<Vector<D>>, ScenarioError> {
        values.as_ref().map(|v| vector(file, path, v)).transpose()
    };
    Ok(FluidSetup {
        material: NewtonianFluid { density: fluid.density, viscosity: fluid.viscosity },
        cip: match fluid.cip {
            Cip::Paper { gamma_1 } => CipProfile::Paper { gamma_1 },
            Cip::Consistent { gamma_u } => CipProfile::Consistent { gamma_u },
        },
        gamma_pressure: fluid.gamma_pressure,
        gamma_ghost: fluid.gamma_ghost,
        convection: match fluid.convection {
            Convection::Standard => Some(false),
            Convection::Skew => Some(true),
            Convection::None => None,
        },
        body_force: constant("fluid.body_force", &fluid.body_force)?.map(|f| Arc::new(move |_: &Point<D>, _| f) as _),
        initial_velocity: constant("fluid.initial_velocity", &fluid.initial_velocity)?
            .map(|u| Arc::new(move |_: &Point<D>| u) as _),
        boundary,
    })
}

/// What holds on one side.
fn fluid_boundary<const D: usize>(
    file: &ScenarioFile,
    background: &SimplexMesh<D>,
    side: &str,
    condition: &FluidCondition,
) -> Result<FluidBoundary<D>, ScenarioError> {
    let path = format!("background.boundary.{side}");
    let axis = side_axis::<D>(side).unwrap_or_default();
    Ok(match condition {
        FluidCondition::Plain(PlainFluidCondition::NoSlip) => FluidBoundary::NoSlip,
        FluidCondition::Plain(PlainFluidCondition::Symmetry) => FluidBoundary::Symmetry { axis },
        FluidCondition::Plain(PlainFluidCondition::Free) => FluidBoundary::Open { traction: None, backflow: true },
        FluidCondition::Given(GivenFluidCondition::Velocity { value }) => {
            let u: Vector<D> = vector(file, &format!("{path}.value"), value)?;
            FluidBoundary::Velocity(Arc::new(move |_, _| u))
        }
        FluidCondition::Given(GivenFluidCondition::Inflow { profile, maximum, ramp }) => {
            FluidBoundary::Velocity(inflow(background, side, axis, *profile, *maximum, *ramp))
        }
        FluidCondition::Given(GivenFluidCondition::Traction { value }) => {
            let t: Vector<D> = vector(file, &format!("{path}.value"), value)?;
            FluidBoundary::Open { traction: Some(Arc::new(move |_, _, _| t)), backflow: true }
        }
        FluidCondition::Given(GivenFluidCondition::Pressure { value }) => {
            let p = *value;
            FluidBoundary::Open { traction: Some(Arc::new(move |_, n: &Vector<D>, _| n * -p)), backflow: true }
        }
    })
}

/// Inflow normal to a side, zero at the ends of its extent, rising as `(1 - cos(π t/ramp))/2`.
fn inflow<const D: usize>(
    background: &SimplexMesh<D>,
    side: &str,
    axis: usize,
    profile: InflowProfile,
    maximum: f64,
    ramp: Option<f64>,
) -> TimeField<D> {
    let corner = background.vertices()[0];
    let (low, high) = background.vertices().iter().fold((corner, corner), |(a, b), x| (a.inf(x), b.sup(x)));
    let inward = if matches!(side, "left" | "bottom" | "front") { 1.0 } else { -1.0 };
    Arc::new(move |x, t| {
        let InflowProfile::Parabolic = profile;
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
