//! The weak form of a solid: its named terms, and what they add to the system.

use std::sync::Arc;

use algebra::{BlockLayout, Contributions, DofId, FieldId, LocalSystem};
use mesh::{CellId, Vector};

use crate::error::{length, positive};
use crate::terms::{BodyForce, Inertia, InternalWork};
use crate::{Error, Material, SolidCell, SolidMesh, SolidTerm, StepRule};

/// The terms of elastodynamics on the cells of a body.
#[derive(Clone, Debug)]
pub struct SolidForm<const D: usize> {
    /// `(ρ a, w)`
    pub inertia: Inertia,
    /// `(P(F), ∇w)`
    pub internal_work: InternalWork<D>,
    /// `-(ρ g, w)`
    pub body_force: BodyForce<D>,
}

impl<const D: usize> SolidForm<D> {
    /// The form of a homogeneous body: density in the reference configuration, material, and body force per mass
    /// (an acceleration).
    ///
    /// # Errors
    /// [`Error::Parameter`]: density not positive, acceleration not finite.
    pub fn new(density: f64, material: impl Material<D> + 'static, gravity: Vector<D>) -> Result<Self, Error> {
        positive("density", density)?;
        if let Some(&value) = gravity.iter().find(|g| !g.is_finite()) {
            return Err(Error::Parameter { what: "body force", value, must: "finite" });
        }
        Ok(Self {
            inertia: Inertia { density },
            internal_work: InternalWork { material: Arc::new(material) },
            body_force: BodyForce { density, acceleration: gravity },
        })
    }

    /// Terms with a constant tangent.
    fn linear_terms(&self) -> [&dyn SolidTerm<D>; 2] {
        [&self.inertia, &self.body_force]
    }
}

/// The cells of one body in one step, ready to give its two contributions.
#[derive(Clone, Copy, Debug)]
pub struct SolidCells<'a, const D: usize> {
    mesh: &'a SolidMesh<D>,
    form: &'a SolidForm<D>,
    step: &'a StepRule<D>,
    first_dof: usize,
}

impl<'a, const D: usize> SolidCells<'a, D> {
    /// The cells of a body whose velocity is the field `field`.
    ///
    /// # Errors
    /// [`Error::Length`]: field or step rule do not fit the mesh.
    pub fn new(
        mesh: &'a SolidMesh<D>,
        form: &'a SolidForm<D>,
        step: &'a StepRule<D>,
        layout: &BlockLayout,
        field: FieldId,
    ) -> Result<Self, Error> {
        let range = layout.range(field);
        length("field of the body", range.len(), mesh.n_dofs())?;
        length("step rule", step.n_vertices(), mesh.mesh().n_vertices())?;
        Ok(Self { mesh, form, step, first_dof: range.start })
    }

    /// Inertia and body force.
    pub fn linear(&self) -> LinearCells<'a, D> {
        LinearCells { cells: *self }
    }

    /// Internal work.
    pub fn internal_work(&self) -> InternalWorkCells<'a, D> {
        InternalWorkCells { cells: *self }
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        for vertex in self.mesh.mesh().cell(CellId::new(item)) {
            out.extend((0..D).map(|a| DofId::new(self.first_dof + D * vertex.index() + a)));
        }
    }

    fn cell(&self, item: usize, x: &[f64]) -> SolidCell<'a, D> {
        let velocity = &x[self.first_dof..self.first_dof + self.mesh.n_dofs()];
        SolidCell::new(self.mesh, self.step, CellId::new(item), velocity)
    }
}

/// Inertia and body force of a body: affine in velocity, assembled once per nonlinear solve.
#[derive(Clone, Copy, Debug)]
pub struct LinearCells<'a, const D: usize> {
    cells: SolidCells<'a, D>,
}

impl<const D: usize> Contributions for LinearCells<'_, D> {
    fn len(&self) -> usize {
        self.cells.mesh.mesh().n_cells()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        self.cells.dofs(item, out);
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let cell = self.cells.cell(item, x);
        for term in self.cells.form.linear_terms() {
            term.add(&cell, out);
        }
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn name(&self) -> &'static str {
        "solid inertia and body force"
    }
}

/// Internal work of a body: nonlinear in velocity, but for a linear material.
#[derive(Clone, Copy, Debug)]
pub struct InternalWorkCells<'a, const D: usize> {
    cells: SolidCells<'a, D>,
}

impl<const D: usize> Contributions for InternalWorkCells<'_, D> {
    fn len(&self) -> usize {
        self.cells.mesh.mesh().n_cells()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        self.cells.dofs(item, out);
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        self.cells.form.internal_work.add(&self.cells.cell(item, x), out);
    }

    fn is_linear(&self) -> bool {
        self.cells.form.internal_work.material.is_linear()
    }

    fn name(&self) -> &'static str {
        "solid internal work"
    }
}
