//! Bodies and contacts of a scenario.

use std::sync::Arc;

use contact::{ContactForm, DeformableObstacle, Penalty, RigidPlane};
use mesh::generate::{BallOptions, Size, ball, graded_box, half_ball, mirrored, structured_box};
use mesh::{BodyId, FacetId, Point, SimplexMesh, Vector};
use solid_svk::boundary::{facets_without_tags, tagged_facets, vertices_of};
use solid_svk::terms::Traction;
use solid_svk::{FacetTerm, GeneralisedAlpha, LameParameters, SaintVenantKirchhoff, SolidForm, SolidMesh, TimeScheme};
use solver::{Body, BodyKind, BodySupport, Contact, ContactObstacle, ElasticBody, PointField, SupportKind};

use super::lower::{body_id, side_axis, unknown_name, vector};
use super::motion::undeformed;
use super::problem::{Problem, ScenarioError};
use super::schema::{self, BodyCondition, ContactLaw, Material, Obstacle, Shape};
use super::{GivenBodyCondition, PlainBodyCondition, ScenarioFile};

/// A body.
pub(super) fn body<const D: usize>(file: &ScenarioFile, index: usize) -> Result<Body<D>, ScenarioError> {
    let given = &file.scenario().bodies[index];
    let mesh = shape(file, &format!("body.{index}.shape"), &given.shape)?;
    let kind = match &given.motion {
        None => BodyKind::Elastic(Box::new(elastic(file, index, mesh)?)),
        Some(motion) => undeformed(file, index, motion, &mesh)?,
    };
    Ok(Body { name: given.name.clone(), kind })
}

/// An elastic body on a mesh.
fn elastic<const D: usize>(
    file: &ScenarioFile,
    index: usize,
    mesh: SimplexMesh<D>,
) -> Result<ElasticBody<D>, ScenarioError> {
    let given = &file.scenario().bodies[index];
    let path = |key: &str| format!("body.{index}.{key}");
    let fail = |key: &str, source: solid_svk::Error| file.error(&path(key), source);
    let missing = |key: &str| file.missing(&format!("body.{index}"), key);
    let solid = SolidMesh::new(mesh).map_err(|e| fail("shape", e))?;
    let lame = material(file, &path("material"), given.material.as_ref().ok_or_else(|| missing("material"))?)?;
    let density = given.density.ok_or_else(|| missing("density"))?;
    let gravity = vector(file, &path("gravity"), given.gravity.as_ref().ok_or_else(|| missing("gravity"))?)?;
    let form = SolidForm::new(density, SaintVenantKirchhoff::new(lame), gravity).map_err(|e| fail("density", e))?;
    let (supports, loads) = conditions(file, &path("boundary"), &solid, given)?;
    let constant = |key: &str, values: &Option<Vec<f64>>| -> Result<Option<PointField<D>>, ScenarioError> {
        let Some(values) = values else { return Ok(None) };
        let value: Vector<D> = vector(file, &path(key), values)?;
        Ok(Some(Arc::new(move |_: &Point<D>| value)))
    };
    let scheme = match given.time_scheme {
        None | Some(schema::TimeScheme::ImplicitEuler {}) => TimeScheme::ImplicitEuler,
        Some(schema::TimeScheme::GeneralisedAlpha { rho_inf }) => {
            TimeScheme::GeneralisedAlpha(GeneralisedAlpha::new(rho_inf).map_err(|e| fail("time_scheme.rho_inf", e))?)
        }
    };
    Ok(ElasticBody {
        scheme,
        supports,
        loads,
        initial_displacement: constant("initial_displacement", &given.initial_displacement)?,
        initial_velocity: constant("initial_velocity", &given.initial_velocity)?,
        solid,
        form,
    })
}

fn shape<const D: usize>(file: &ScenarioFile, path: &str, shape: &Shape) -> Result<SimplexMesh<D>, ScenarioError> {
    let at = |key: &str| format!("{path}.{key}");
    let fail = |source: mesh::Error| file.error(path, source);
    match shape {
        Shape::Ball { centre, radius, size, area_preserving } => {
            let centre: Vector<D> = vector(file, &at("centre"), centre)?;
            let options = BallOptions { area_preserving: *area_preserving };
            ball(centre.into(), *radius, *size, &options).map_err(fail)
        }
        Shape::HalfBall { centre, radius, size, area_preserving, mirrored: whole } => {
            let centre: Vector<D> = vector(file, &at("centre"), centre)?;
            let options = BallOptions { area_preserving: *area_preserving };
            let half = half_ball(centre.into(), *radius, *size, &options).map_err(fail)?;
            if *whole { mirrored(&half, 0, centre[0]).map_err(fail) } else { Ok(half) }
        }
        Shape::Box { min, max, size, n } => {
            let min: Vector<D> = vector(file, &at("min"), min)?;
            let max: Vector<D> = vector(file, &at("max"), max)?;
            match (size, n) {
                (Some(h), None) => graded_box(min.into(), max.into(), &Size::uniform(*h)).map_err(fail),
                (None, Some(n)) => {
                    let problem = || Problem::Components { found: n.len(), dimension: D };
                    let n: [usize; D] = n.as_slice().try_into().map_err(|_| file.error(&at("n"), problem()))?;
                    structured_box(min.into(), max.into(), n).map_err(fail)
                }
                _ => Err(file.error(path, Problem::Either { a: "size", b: "n" })),
            }
        }
    }
}

fn material(file: &ScenarioFile, path: &str, material: &Material) -> Result<LameParameters, ScenarioError> {
    let Material::SaintVenantKirchhoff { mu, lambda, young, poisson } = *material;
    match (mu, lambda, young, poisson) {
        (Some(mu), Some(lambda), None, None) => LameParameters::new(mu, lambda).map_err(|e| file.error(path, e)),
        (None, None, Some(young), Some(poisson)) => {
            LameParameters::from_young_poisson(young, poisson).map_err(|e| file.error(path, e))
        }
        _ => Err(file.error(path, Problem::Either { a: "mu and lambda", b: "young and poisson" })),
    }
}

type Loads<const D: usize> = Vec<(Vec<FacetId>, Arc<dyn FacetTerm<D>>)>;

/// What holds and loads a body. Clamps come last, so that they win where parts meet.
fn conditions<const D: usize>(
    file: &ScenarioFile,
    path: &str,
    solid: &SolidMesh<D>,
    given: &schema::Body,
) -> Result<(Vec<BodySupport<D>>, Loads<D>), ScenarioError> {
    let mut supports = Vec::new();
    let mut loads: Loads<D> = Vec::new();
    for (name, condition) in &given.boundary {
        let path = format!("{path}.{name}");
        let known = solid.mesh().tag_names();
        let unknown = |_| unknown_name(file, &path, "part of the surface", name, known);
        let facets = tagged_facets(solid, name).map_err(unknown)?;
        let mut hold = |kind| supports.push(BodySupport { vertices: vertices_of(solid, &facets), kind });
        match condition {
            BodyCondition::Plain(PlainBodyCondition::Clamped) => hold(SupportKind::Clamped),
            BodyCondition::Plain(PlainBodyCondition::Symmetry) => {
                let known: Vec<String> = known.iter().filter(|name| side_axis::<D>(name).is_some()).cloned().collect();
                let axis = side_axis::<D>(name).ok_or_else(|| unknown_name(file, &path, "plane side", name, &known))?;
                hold(SupportKind::Symmetry { axis });
            }
            BodyCondition::Given(GivenBodyCondition::Displacement { value }) => {
                let d: Vector<D> = vector(file, &format!("{path}.value"), value)?;
                hold(SupportKind::Displacement(Arc::new(move |_, _| std::array::from_fn(|a| Some(d[a])))));
            }
            BodyCondition::Given(GivenBodyCondition::Traction { value }) => {
                let traction = vector(file, &format!("{path}.value"), value)?;
                loads.push((facets, Arc::new(Traction::<D> { traction })));
            }
        }
    }
    // Where two meet, the later one holds: a clamp, else a displacement, else a plane of symmetry.
    supports.sort_by_key(|support| match support.kind {
        SupportKind::Symmetry { .. } => 0,
        SupportKind::Displacement(_) => 1,
        SupportKind::Clamped => 2,
    });
    Ok((supports, loads))
}

/// A contact.
pub(super) fn contact<const D: usize>(
    file: &ScenarioFile,
    index: usize,
    bodies: &[Body<D>],
) -> Result<Contact<D>, ScenarioError> {
    let given = &file.scenario().contacts[index];
    let path = |key: &str| format!("contact.{index}.{key}");
    let fail = |source: contact::Error| file.error(&format!("contact.{index}"), source);
    let slave = body_id(file, &path("body"), &given.body, bodies)?;
    let yields = |body: BodyId| match &bodies[body.index()].kind {
        BodyKind::Elastic(_) => true,
        BodyKind::Rigid(rigid) => !(rigid.holds_rotation && rigid.held_axes.iter().all(|held| *held)),
        BodyKind::Prescribed(_) => false,
    };
    let nothing_yields = |why| {
        let body = given.body.clone();
        Err(file.error(&path("obstacle"), Problem::NothingYields { body, why }))
    };
    let ContactLaw::Penalty { gamma_contact_0 } = given.law;
    let law = Penalty::new(gamma_contact_0, given.offset).map_err(fail)?;
    let obstacle = match &given.obstacle {
        Obstacle::RigidPlane { .. } if !yields(slave) => {
            return nothing_yields("one has a given motion, the other is a rigid plane");
        }
        Obstacle::RigidPlane { point, normal } => {
            let point: Vector<D> = vector(file, &path("obstacle.point"), point)?;
            let normal: Vector<D> = vector(file, &path("obstacle.normal"), normal)?;
            if normal.norm() == 0.0 {
                return Err(file.error(&path("obstacle.normal"), Problem::ZeroVector));
            }
            ContactObstacle::Rigid(Box::new(RigidPlane::new(point, normal.normalize()).map_err(fail)?))
        }
        Obstacle::Body { name } => {
            let body = body_id(file, &path("obstacle.name"), name, bodies)?;
            if body == slave {
                return Err(file.error(&path("obstacle.name"), contact::Error::SelfContact));
            }
            if !yields(slave) && !yields(body) {
                return nothing_yields("both have a given motion");
            }
            let boundary = bodies[body.index()].boundary().clone();
            let facets = free_facets(file, body.index(), bodies)?;
            ContactObstacle::Body { body, surface: DeformableObstacle::new(boundary, facets).map_err(fail)? }
        }
    };
    Ok(Contact {
        body: slave,
        facets: free_facets(file, slave.index(), bodies)?,
        form: ContactForm::new(law, given.size).map_err(fail)?,
        obstacle,
    })
}

/// Facets that may touch something: those of no symmetry plane and no clamp.
fn free_facets<const D: usize>(
    file: &ScenarioFile,
    body: usize,
    bodies: &[Body<D>],
) -> Result<Vec<FacetId>, ScenarioError> {
    let held = file.scenario().bodies[body].boundary.iter();
    let held: Vec<&str> =
        held.filter(|(_, c)| matches!(c, BodyCondition::Plain(_))).map(|(name, _)| name.as_str()).collect();
    let Some(elastic) = bodies[body].elastic() else { return Ok(bodies[body].boundary().facets().collect()) };
    facets_without_tags(&elastic.solid, &held).map_err(|e| file.error(&format!("body.{body}.boundary"), e))
}
