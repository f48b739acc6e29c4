//! Bodies without a fluid around them, for the checks of solids and contact.

use std::sync::Arc;

use cutwater::algebra::{NewtonSettings, Workspace};
use cutwater::contact::{ContactForm, Penalty, RigidPlane};
use cutwater::mesh::{BodyId, Point, SimplexMesh, Vector};
use cutwater::solid_svk::boundary::{tagged_facets, vertices_of};
use cutwater::solid_svk::{GeneralisedAlpha, Material, SolidForm, SolidMesh, TimeScheme};
use cutwater::solver::dry::{DryReport, DrySetup, DryState, advance};
use cutwater::solver::{Body, BodyKind, BodySupport, Contact, ContactObstacle, ElasticBody, SupportKind};

use super::Failure;

pub(super) type P = Point<2>;
pub(super) type V = Vector<2>;

/// An elastic body without supports and loads, at rest.
pub(super) fn elastic<const D: usize>(
    mesh: SimplexMesh<D>,
    density: f64,
    material: impl Material<D> + 'static,
    gravity: Vector<D>,
    scheme: TimeScheme,
) -> Result<ElasticBody<D>, Failure> {
    Ok(ElasticBody {
        solid: SolidMesh::new(mesh)?,
        form: SolidForm::new(density, material, gravity)?,
        scheme,
        supports: Vec::new(),
        loads: Vec::new(),
        initial_displacement: None,
        initial_velocity: None,
    })
}

/// Holds a named part of the boundary.
pub(super) fn hold<const D: usize>(body: &mut ElasticBody<D>, part: &str, kind: SupportKind<D>) -> Result<(), Failure> {
    let vertices = vertices_of(&body.solid, &tagged_facets(&body.solid, part)?);
    body.supports.push(BodySupport { vertices, kind });
    Ok(())
}

/// A plane `y = 0` that a named part of a body must not pass, with the pressure `stiffness` times penetration.
pub(super) fn floor(body: &ElasticBody<2>, part: &str, stiffness: f64) -> Result<Contact<2>, Failure> {
    Ok(Contact {
        body: BodyId::new(0),
        facets: tagged_facets(&body.solid, part)?,
        form: ContactForm::new(Penalty::new(stiffness, 0.0)?, 1.0)?,
        obstacle: ContactObstacle::Rigid(Box::new(RigidPlane::new(P::zeros(), V::new(0.0, -1.0))?)),
    })
}

/// The generalised-α scheme.
pub(super) fn second_order(rho_inf: f64) -> Result<TimeScheme, Failure> {
    Ok(TimeScheme::GeneralisedAlpha(GeneralisedAlpha::new(rho_inf)?))
}

/// Bodies on their way.
pub(super) struct Run<const D: usize = 2> {
    pub(super) setup: DrySetup<D>,
    pub(super) state: DryState<D>,
    work: Workspace,
}

impl<const D: usize> Run<D> {
    /// Bodies at time zero.
    pub(super) fn new(bodies: Vec<ElasticBody<D>>, contacts: Vec<Contact<D>>, dt: f64, tolerance: f64) -> Self {
        let named = |(k, body): (usize, ElasticBody<D>)| Body {
            name: format!("body {k}"),
            kind: BodyKind::Elastic(Box::new(body)),
        };
        let bodies = bodies.into_iter().enumerate().map(named).collect();
        let setup = DrySetup { bodies, contacts, dt, newton: NewtonSettings::new(tolerance) };
        let state = DryState::initial(&setup);
        Self { setup, state, work: Workspace::new() }
    }

    /// One step.
    pub(super) fn advance(&mut self) -> Result<DryReport<D>, Failure> {
        let (state, report) = advance(&self.setup, &self.state, &mut self.work)?;
        self.state = state;
        Ok(report)
    }

    /// The first body.
    pub(super) fn body(&self) -> Result<&ElasticBody<D>, Failure> {
        Ok(self.setup.bodies.first().and_then(Body::elastic).ok_or("there is no elastic body")?)
    }

    /// Kinetic, elastic and potential energy of the first body, and its vertical momentum.
    pub(super) fn energy_and_momentum(&self) -> Result<(f64, f64), Failure> {
        let balance = self.state.balance(&self.setup, 0).ok_or("there is no elastic body")?;
        Ok((balance.energy(), balance.momentum[1]))
    }
}

/// A displacement that grows linearly in time until 1; components with `None` are free.
pub(super) fn pushed(to: [Option<f64>; 2]) -> SupportKind<2> {
    SupportKind::Displacement(Arc::new(move |_, time| to.map(|d| d.map(|d| d * time))))
}

/// The mesh with its vertices moved; boundary parts keep their names.
pub(super) fn mapped<const D: usize>(
    mesh: &SimplexMesh<D>,
    map: impl Fn(&Point<D>) -> Point<D>,
) -> Result<SimplexMesh<D>, Failure> {
    let cells = mesh.cells().flat_map(|cell| mesh.cell(cell)).copied().collect();
    let moved = SimplexMesh::new(mesh.vertices().iter().map(map).collect(), cells)?;
    Ok(moved.with_facet_tags(|facet| mesh.facet_tag(facet).map(|tag| mesh.tag_names()[tag.index()].as_str())))
}
