//! Bodies without a fluid around them, for the checks of solids and contact.

use std::sync::Arc;

use cutwater::algebra::NewtonSettings;
use cutwater::algebra::time::{GeneralisedAlpha, TimeScheme};
use cutwater::contact::{ContactForm, PenaltyLaw, RigidPlane};
use cutwater::mesh::{BodyId, FacetId, SimplexMesh, Vector};
use cutwater::solid_svk::supports::tagged_facets;
use cutwater::solid_svk::{
    ElasticBody, ElasticOptions, LameParameters, Material, SolidForm, SolidMesh, Support, SupportKind,
};
use cutwater::solver::body::Body;
use cutwater::solver::{Contact, ContactObstacle, Setup};

use super::{DirectRun, Failure, P, V};

// The ball of the paper: radius, cm, and Lame parameters, dyn/cm².
pub(crate) const RADIUS: f64 = 4.0;
pub(crate) const MU: f64 = 2e6;
pub(crate) const LAMBDA: f64 = 8e6;
pub(crate) const LAME: LameParameters = LameParameters { mu: MU, lambda: LAMBDA };

/// Parameter of Nitsche's method: the default of scenarios, and a hundred times this value.
pub(super) const GAMMA_0: [f64; 2] = [10.0, 1000.0];

/// A time scheme.
pub(crate) type Scheme = Arc<dyn TimeScheme>;

/// The parts of an elastic body, and the scheme that advances it.
pub(crate) struct Elastic<const D: usize> {
    pub(crate) scheme: Scheme,
    pub(super) solid: SolidMesh<D>,
    pub(super) form: SolidForm<D>,
    pub(crate) options: ElasticOptions<D>,
}

impl<const D: usize> Elastic<D> {
    pub(super) fn body(self, name: &str) -> Result<Arc<dyn Body<D>>, Failure> {
        Ok(Arc::new(ElasticBody::new(name, self.solid, self.form, self.options)?))
    }

    /// Holds a named part of the boundary.
    pub(crate) fn hold(&mut self, part: &str, kind: SupportKind<D>) -> Result<(), Failure> {
        let vertices = self.solid.boundary().vertices_of(&tagged_facets(&self.solid, part)?);
        self.options.supports.push(Support { vertices, kind });
        Ok(())
    }

    /// Returns the facets of a named part of the boundary.
    pub(crate) fn part(&self, name: &str) -> Result<Vec<FacetId>, Failure> {
        Ok(tagged_facets(&self.solid, name)?)
    }
}

/// Returns an elastic body of linear elements without supports and loads, at rest.
pub(crate) fn elastic<const D: usize>(
    mesh: SimplexMesh<D>,
    density: f64,
    material: impl Material<D> + 'static,
    gravity: Vector<D>,
    scheme: Scheme,
) -> Result<Elastic<D>, Failure> {
    elastic_of(SolidMesh::new(mesh)?, density, material, gravity, scheme)
}

/// Returns an elastic body of given elements without supports and loads, at rest.
pub(super) fn elastic_of<const D: usize>(
    solid: SolidMesh<D>,
    density: f64,
    material: impl Material<D> + 'static,
    gravity: Vector<D>,
    scheme: Scheme,
) -> Result<Elastic<D>, Failure> {
    let form = SolidForm::new(density, material, gravity)?;
    Ok(Elastic { solid, form, options: ElasticOptions::default(), scheme })
}

/// A contact of the first body.
pub(crate) struct Touch<const D: usize> {
    pub(super) facets: Vec<FacetId>,
    pub(super) form: ContactForm<D>,
    pub(super) obstacle: ContactObstacle<D>,
}

/// Returns the contact of facets with the plane `y = 0` below them, with the penalty of a contact form and its size.
pub(crate) fn floor(facets: Vec<FacetId>, penalty: f64, size: f64) -> Result<Touch<2>, Failure> {
    floor_by(facets, ContactForm::new(PenaltyLaw::new(penalty, 0.0)?, size)?)
}

/// Returns the contact of facets with the plane `y = 0` below them.
pub(super) fn floor_by(facets: Vec<FacetId>, form: ContactForm<2>) -> Result<Touch<2>, Failure> {
    Ok(Touch {
        facets,
        form,
        obstacle: ContactObstacle::Rigid(Box::new(RigidPlane::new(P::zeros(), V::new(0.0, -1.0))?)),
    })
}

/// Returns the generalised-α scheme.
pub(super) fn second_order(rho_inf: f64) -> Result<Scheme, Failure> {
    Ok(Arc::new(GeneralisedAlpha::new(rho_inf).ok_or("rho_inf is from 0 to 1")?))
}

/// Creates the run of bodies in vacuum from time zero, with the scheme and a contact of the first one.
pub(crate) fn run<const D: usize>(
    bodies: Vec<Elastic<D>>,
    touch: Option<Touch<D>>,
    dt: f64,
    tolerance: f64,
) -> Result<DirectRun<D>, Failure> {
    let scheme = Arc::clone(&bodies.first().ok_or("there is no body")?.scheme);
    let built = bodies.into_iter().enumerate().map(|(k, body)| body.body(&format!("body {k}")));
    let bodies = built.collect::<Result<Vec<_>, _>>()?;
    run_of(bodies, touch, scheme, [dt, tolerance])
}

/// Starts a run of bodies without a fluid, of which the first may have a contact, with a step and a tolerance of
/// Newton's method.
pub(super) fn run_of<const D: usize>(
    bodies: Vec<Arc<dyn Body<D>>>,
    touch: Option<Touch<D>>,
    scheme: Scheme,
    [dt, tolerance]: [f64; 2],
) -> Result<DirectRun<D>, Failure> {
    let contact = |Touch { facets, form, obstacle }| Contact::new(&bodies, BodyId::new(0), facets, form, obstacle);
    let contacts = touch.map(contact).transpose()?.into_iter().collect();
    let newton = NewtonSettings::new(tolerance);
    DirectRun::new(Setup { fluid: None, bodies, contacts, scheme, dt, most_halvings: 0, approach: None, newton })
}

/// Returns a support whose displacement grows linearly in time until 1; components with `None` are free.
pub(super) fn pushed(to: [Option<f64>; 2]) -> SupportKind<2> {
    SupportKind::Displacement(Arc::new(move |_, time| to.map(|d| d.map(|d| d * time))))
}
