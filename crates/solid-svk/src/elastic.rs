//! Elastic bodies.

use algebra::time::{Affine, StepRule};
use algebra::{BlockLayout, Constraints, Contributions, FieldId, Integral};
use body::{
    Balance, Body, BodyState, BodyStep, CellOutput, PointField, StepTime, SurfaceMotion, SurfaceStress, VectorInTime,
};
use mesh::{BoundaryMesh, Point, Vector, require};

use crate::energy::{balance, momentum, stresses};
use crate::supports::{Support, SupportKind, stop};
use crate::terms::BodyForce;
use crate::{Error, Load, SolidCells, SolidFacets, SolidForm, SolidMesh, SolidStress};

/// Supports, loads and initial fields of an elastic body. By default there are none, and the body is at rest.
#[derive(Clone)]
pub struct ElasticOptions<const D: usize> {
    /// Supports; a support replaces earlier ones of the same dof.
    pub supports: Vec<Support<D>>,
    /// Loads on the boundary.
    pub loads: Vec<Load<D>>,
    /// Gravity that varies in time, in addition to the gravity of the form; `None`: zero.
    pub variable_gravity: Option<VectorInTime<D>>,
    /// Displacement at the start; zero if `None`.
    pub initial_displacement: Option<PointField<D>>,
    /// Velocity at the start; zero if `None`.
    pub initial_velocity: Option<PointField<D>>,
}

impl<const D: usize> Default for ElasticOptions<D> {
    fn default() -> Self {
        Self {
            supports: Vec::new(),
            loads: Vec::new(),
            variable_gravity: None,
            initial_displacement: None,
            initial_velocity: None,
        }
    }
}

/// An elastic body: a mesh in the reference configuration whose velocities at the nodes are unknown.
pub struct ElasticBody<const D: usize> {
    name: String,
    solid: SolidMesh<D>,
    form: SolidForm<D>,
    options: ElasticOptions<D>,
}

impl<const D: usize> ElasticBody<D> {
    /// Creates a body from mesh and weak form.
    ///
    /// # Errors
    /// [`Error::UnknownVertex`], [`Error::UnknownFacet`]: a node of a support or a facet of a load does not exist.
    /// [`Error::Parameter`]: a normal without unit length. [`Error::MissingMaterial`]: a group without a material.
    pub fn new(name: &str, solid: SolidMesh<D>, form: SolidForm<D>, options: ElasticOptions<D>) -> Result<Self, Error> {
        let (n_vertices, n_facets) = (solid.nodes().len(), solid.boundary().n_facets());
        for support in &options.supports {
            if let Some(&vertex) = support.vertices.iter().find(|v| v.index() >= n_vertices) {
                return Err(Error::UnknownVertex { vertex, n_vertices });
            }
            if let SupportKind::Symmetry { normal } = support.kind {
                let length = normal.norm();
                require((length - 1.0).abs() < 1e-9, "length of the normal of a symmetry", length, "one")?;
            }
        }
        if let Some(&facet) = options.loads.iter().flat_map(|load| &load.facets).find(|f| f.index() >= n_facets) {
            return Err(Error::UnknownFacet { facet, n_facets });
        }
        let (found, n_groups) = (form.inertia.densities.len(), solid.n_groups());
        if found < n_groups {
            return Err(Error::MissingMaterial { found, n_groups });
        }
        Ok(Self { name: name.to_owned(), solid, form, options })
    }

    /// Returns the mesh.
    pub fn solid(&self) -> &SolidMesh<D> {
        &self.solid
    }

    /// Returns the weak form.
    pub fn form(&self) -> &SolidForm<D> {
        &self.form
    }

    fn at_start(&self, field: &Option<PointField<D>>) -> Vec<Vector<D>> {
        self.solid.nodes().iter().map(|x| field.as_ref().map_or(Vector::zeros(), |f| f(x))).collect()
    }
}

impl<const D: usize> Body<D> for ElasticBody<D> {
    fn name(&self) -> &str {
        &self.name
    }

    fn surface(&self) -> &BoundaryMesh<D> {
        self.solid.boundary()
    }

    fn reference(&self) -> &[Point<D>] {
        self.solid.nodes()
    }

    fn is_movable(&self) -> bool {
        true
    }

    fn deforms(&self) -> bool {
        true
    }

    fn initial(&self) -> BodyState<D> {
        let mut velocity = self.at_start(&self.options.initial_velocity);
        let nodes = self.solid.nodes().iter().zip(&mut velocity);
        if let Some(radial) = self.solid.mesh().coordinates().radial() {
            nodes.filter(|(x, _)| x[radial] == 0.0).for_each(|(_, v)| v[radial] = 0.0);
        }
        stop(&self.options.supports, &mut velocity);
        BodyState::new(self.at_start(&self.options.initial_displacement), velocity)
    }

    fn step<'s>(
        &'s self,
        start: &'s BodyState<D>,
        time: &StepTime,
        layout: &mut BlockLayout,
    ) -> Box<dyn BodyStep<D> + 's> {
        let rule = StepRule::new(&time.weights, &start.level);
        let field = layout.push(&self.name, self.reference().len(), D);
        let geometry = self.geometry(start, time);
        let farthest = geometry.iter().map(|x| x.amax()).fold(0.0, f64::max);
        layout.set_rounding(field, &[time.rounding(farthest); D]);
        let mut surface = SurfaceMotion::of_field(self.surface(), self.reference(), start, geometry, time, field);
        let displacement = &time.weights.stage_displacement;
        surface.stage = time.weights.pressure_at_stage.then(|| Affine {
            slope: displacement.slope,
            predicted: start.positions_by(displacement, self.reference()),
        });
        let acceleration = self.variable_gravity(time.stage());
        let weight = BodyForce { acceleration, ..self.form.body_force.clone() };
        let weight = self.options.variable_gravity.as_ref().map(|_| weight);
        Box::new(ElasticStep { body: self, start, time: *time, rule, weight, field, surface })
    }

    fn balance(&self, state: &BodyState<D>) -> Option<Balance<D>> {
        let (solid, form, acceleration) = (&self.solid, &self.form, &state.level.acceleration);
        let momentum_rate = if acceleration.is_empty() { Vector::zeros() } else { momentum(solid, form, acceleration) };
        Some(Balance { momentum_rate, ..balance(solid, form, state.displacement(), state.velocity()) })
    }

    fn variable_gravity(&self, time: f64) -> Vector<D> {
        self.options.variable_gravity.as_ref().map_or(Vector::zeros(), |gravity| gravity(time))
    }

    fn cells(&self, state: &BodyState<D>) -> Option<CellOutput<'_, D>> {
        let stress = stresses(&self.solid, &self.form, state.displacement());
        Some(CellOutput { cell_to_vertex: self.solid.parts(), stress })
    }
}

/// An elastic body in one step.
struct ElasticStep<'s, const D: usize> {
    body: &'s ElasticBody<D>,
    start: &'s BodyState<D>,
    time: StepTime,
    rule: StepRule<Vector<D>>,
    /// Load of a gravity that varies in time, at the stage.
    weight: Option<BodyForce<D>>,
    field: FieldId,
    surface: SurfaceMotion<'s, D>,
}

impl<const D: usize> ElasticStep<'_, D> {
    /// Constrains the radial velocity of nodes on the axis of axisymmetric coordinates.
    fn constrain_axis(&self, layout: &BlockLayout, constraints: &mut Constraints) {
        let Some(radial) = self.body.solid.mesh().coordinates().radial() else { return };
        for (node, _) in self.body.solid.nodes().iter().enumerate().filter(|(_, x)| x[radial] == 0.0) {
            let velocity = self.time.weights.stage_velocity(0.0, self.start.velocity()[node][radial]);
            constraints.set(layout.dof(self.field, node, radial), velocity);
        }
    }

    fn cells<'p>(&'p self, layout: &'p BlockLayout) -> SolidCells<'p, D> {
        SolidCells { solid: &self.body.solid, rule: &self.rule, layout, velocity: self.field }
    }
}

impl<const D: usize> BodyStep<D> for ElasticStep<'_, D> {
    fn surface(&self) -> &SurfaceMotion<'_, D> {
        &self.surface
    }

    fn constrain(&self, layout: &BlockLayout, constraints: &mut Constraints) {
        let supports = |symmetric: bool| {
            let supports = self.body.options.supports.iter();
            supports.filter(move |support| matches!(support.kind, SupportKind::Symmetry { .. }) == symmetric)
        };
        let constrain = |support: &Support<D>, constraints: &mut Constraints| {
            support.constrain(self.cells(layout), self.start, &self.time, constraints);
        };
        supports(false).for_each(|support| constrain(support, constraints));
        self.constrain_axis(layout, constraints);
        // Planes of symmetry are linear equations of dofs, some of which are prescribed now.
        supports(true).for_each(|support| constrain(support, constraints));
    }

    fn contributions<'p>(&'p self, layout: &'p BlockLayout) -> Vec<Box<dyn Contributions + 'p>> {
        let (form, cells) = (&self.body.form, self.cells(layout));
        vec![Box::new(form.inertia_and_body_force(cells)), Box::new(form.internal_work(cells))]
    }

    fn loads<'p>(&'p self, layout: &'p BlockLayout) -> Vec<Box<dyn Contributions + 'p>> {
        let integral = |load: &'p Load<D>| {
            let facets = SolidFacets { cells: self.cells(layout), facets: &load.facets, time: self.time.stage() };
            let integral = if load.is_linear { Integral::linear } else { Integral::new };
            Box::new(integral(load.name, facets, vec![load.term.as_ref()])) as Box<dyn Contributions + 'p>
        };
        let weight = self.weight.iter().map(|weight| {
            let integral = Integral::linear("variable weight", self.cells(layout), vec![weight]);
            Box::new(integral) as Box<dyn Contributions + 'p>
        });
        self.body.options.loads.iter().map(integral).chain(weight).collect()
    }

    fn guess(&self, layout: &BlockLayout, x: &mut [f64]) {
        layout.set(self.field, self.start.velocity().iter().map(|v| (*v).into()), x);
    }

    fn end(&self, layout: &BlockLayout, x: &[f64]) -> BodyState<D> {
        let velocity: Vec<_> = layout.values(self.field, x).map(Vector::<D>::from).collect();
        BodyState { level: self.time.weights.end(&self.start.level, &velocity), inner: Vec::new() }
    }

    fn stress<'p>(
        &'p self,
        layout: &'p BlockLayout,
        positions: &'p [Point<D>],
    ) -> Option<Box<dyn SurfaceStress<D> + 'p>> {
        let materials = &self.body.form.internal_work.materials;
        Some(Box::new(SolidStress { cells: self.cells(layout), materials, positions }))
    }
}
