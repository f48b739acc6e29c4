//! The fluid's form: named terms, and the items they are integrated over.

use algebra::{BlockLayout, Contributions, DofId, FieldId, LocalSystem};
use cutcell::{CutMesh, PartId};
use mesh::{MAX_CELL_VERTICES, SimplexMesh, Vector};
use xfem_space::{FaceValues, PartValues, XfemSpace, cutcell};

use crate::part_kernel::PartKernel;
use crate::terms::{
    BodyForce, CipPressure, CipVelocity, Convection, GhostPenalty, Incompressibility, Inertia, Viscous,
};
use crate::{CellTerm, FaceTerm, FluidCell, FluidFace};

/// The terms of the fluid, to be laid beside Eq. (4) of the paper.
pub struct FluidForm<'a, const D: usize> {
    /// `ρ/dt (u - u*, v)`; `None` for a steady problem.
    pub inertia: Option<Inertia>,
    /// `a^f(u, v)`.
    pub viscous: Viscous,
    /// `b(p, v) - b(q, u)`.
    pub incompressibility: Incompressibility,
    /// `c(u, u, v)`; `None` for Stokes.
    pub convection: Option<Convection>,
    /// `-(f, v)`.
    pub body_force: BodyForce<'a, D>,
    /// Velocity part of `s_h`.
    pub cip_velocity: CipVelocity,
    /// Pressure part of `s_h`.
    pub cip_pressure: CipPressure,
    /// `g_h`.
    pub ghost_penalty: GhostPenalty,
}

impl<const D: usize> FluidForm<'_, D> {
    /// The terms that [`FluidCells`] adds up, one by one: what its fused kernel has to agree with.
    pub fn linear_cell_terms(&self) -> [Option<&dyn CellTerm<D>>; 4] {
        [
            self.inertia.as_ref().map(|t| t as &dyn CellTerm<D>),
            Some(&self.viscous),
            Some(&self.incompressibility),
            Some(&self.body_force),
        ]
    }

    fn velocity_face_terms(&self) -> [&dyn FaceTerm<D>; 2] {
        [&self.cip_velocity, &self.ghost_penalty]
    }

    fn pressure_face_terms(&self) -> [&dyn FaceTerm<D>; 1] {
        [&self.cip_pressure]
    }
}

/// Geometry of a step, shared by all fluid terms, and the history on it.
pub struct FluidGeometry<'a, const D: usize> {
    /// The background.
    pub background: &'a SimplexMesh<D>,
    /// The cut.
    pub cut: &'a CutMesh<D>,
    /// The space.
    pub space: &'a XfemSpace<D>,
    /// Shape values on parts.
    pub parts: &'a PartValues<D>,
    /// Jumps over faces.
    pub faces: &'a FaceValues<D>,
    /// Velocity history `u*`, one value per dof of the space.
    pub history: &'a [Vector<D>],
}

/// Where velocity and pressure lie in the global vector: component `a` of the velocity of dof `k` at `D k + a`.
#[derive(Clone, Copy)]
pub struct FluidFields<'a> {
    /// The layout.
    pub layout: &'a BlockLayout,
    /// The velocity.
    pub velocity: FieldId,
    /// The pressure.
    pub pressure: FieldId,
}

impl FluidFields<'_> {
    /// Velocity of a dof of the space.
    #[inline]
    pub fn velocity_at<const D: usize>(&self, x: &[f64], dof: u32) -> Vector<D> {
        let start = self.layout.dof(self.velocity, D * dof as usize).index();
        Vector::from_column_slice(&x[start..start + D])
    }

    /// Pressure of a dof of the space.
    #[inline]
    pub fn pressure_at(&self, x: &[f64], dof: u32) -> f64 {
        x[self.layout.dof(self.pressure, dof as usize).index()]
    }
}

impl<const D: usize> FluidGeometry<'_, D> {
    /// A part with its local state, as the terms see it.
    pub fn cell(&self, fields: &FluidFields<'_>, part: PartId, x: &[f64]) -> FluidCell<'_, D> {
        let mut cell = FluidCell {
            simplex: self.background.simplex(self.cut.part_cell(part)),
            gradients: self.parts.gradients(part),
            points: self.parts.points(part),
            velocities: [Vector::zeros(); MAX_CELL_VERTICES],
            pressures: [0.0; MAX_CELL_VERTICES],
            histories: [Vector::zeros(); MAX_CELL_VERTICES],
        };
        for (i, &dof) in self.space.dofs(part).iter().enumerate() {
            cell.velocities[i] = fields.velocity_at(x, dof);
            cell.pressures[i] = fields.pressure_at(x, dof);
            cell.histories[i] = self.history[dof as usize];
        }
        cell
    }
}

/// The linear cell terms: inertia, viscous, incompressibility, body force. One item per part.
pub struct FluidCells<'a, const D: usize> {
    /// Geometry of the step.
    pub geometry: &'a FluidGeometry<'a, D>,
    /// Where the fields lie.
    pub fields: FluidFields<'a>,
    /// The terms.
    pub form: &'a FluidForm<'a, D>,
}

impl<const D: usize> Contributions for FluidCells<'_, D> {
    fn name(&self) -> &'static str {
        "fluid cells"
    }

    fn len(&self) -> usize {
        self.geometry.cut.n_parts()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let dofs = self.geometry.space.dofs(PartId(item as u32));
        let FluidFields { layout, velocity, pressure } = self.fields;
        for &dof in dofs {
            out.extend((0..D).map(|a| layout.dof(velocity, D * dof as usize + a)));
        }
        out.extend(dofs.iter().map(|&dof| layout.dof(pressure, dof as usize)));
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let part = PartId(item as u32);
        let cell = self.geometry.cell(&self.fields, part, x);
        let kernel = PartKernel::new(cell.gradients, self.geometry.parts.mass(part), &cell.velocities);
        kernel.add_linear(self.form, &cell, out);
        self.form.body_force.add(&cell, out);
    }

    fn is_linear(&self) -> bool {
        true
    }
}

/// Convection, the one nonlinear term of the fluid. One item per part, velocity dofs only.
pub struct FluidConvection<'a, const D: usize> {
    /// Geometry of the step.
    pub geometry: &'a FluidGeometry<'a, D>,
    /// Where the fields lie.
    pub fields: FluidFields<'a>,
    /// The terms.
    pub form: &'a FluidForm<'a, D>,
}

impl<const D: usize> Contributions for FluidConvection<'_, D> {
    fn name(&self) -> &'static str {
        "fluid convection"
    }

    fn len(&self) -> usize {
        if self.form.convection.is_some() { self.geometry.cut.n_parts() } else { 0 }
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let FluidFields { layout, velocity, .. } = self.fields;
        for &dof in self.geometry.space.dofs(PartId(item as u32)) {
            out.extend((0..D).map(|a| layout.dof(velocity, D * dof as usize + a)));
        }
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        if let Some(convection) = &self.form.convection {
            let FluidGeometry { parts, space, .. } = self.geometry;
            let part = PartId(item as u32);
            let mut velocities = [Vector::zeros(); MAX_CELL_VERTICES];
            for (slot, &dof) in velocities.iter_mut().zip(space.dofs(part)) {
                *slot = self.fields.velocity_at(x, dof);
            }
            PartKernel::new(parts.gradients(part), parts.mass(part), &velocities).add_convection(convection, out);
        }
    }
}

/// The face terms. One item per face and component (velocity components, then pressure), so that the pattern holds
/// no couplings that are always zero.
pub struct FluidFaces<'a, const D: usize> {
    fields: FluidFields<'a>,
    geometry: &'a FluidGeometry<'a, D>,
    /// Weights of velocity and pressure, with the measure of the face.
    weights: Vec<[f64; 2]>,
}

impl<'a, const D: usize> FluidFaces<'a, D> {
    /// The face terms of a form, with their weights evaluated.
    pub fn new(geometry: &'a FluidGeometry<'a, D>, fields: FluidFields<'a>, form: &FluidForm<'_, D>) -> Self {
        let weights = geometry
            .faces
            .as_slice()
            .iter()
            .map(|value| {
                let face = FluidFace::new(value, geometry.history);
                let velocity: f64 = form.velocity_face_terms().iter().map(|term| term.weight(&face)).sum();
                let pressure: f64 = form.pressure_face_terms().iter().map(|term| term.weight(&face)).sum();
                [velocity * value.measure * value.share, pressure * value.measure * value.share]
            })
            .collect();
        Self { fields, geometry, weights }
    }
}

impl<const D: usize> Contributions for FluidFaces<'_, D> {
    fn name(&self) -> &'static str {
        "fluid faces"
    }

    fn len(&self) -> usize {
        self.weights.len() * (D + 1)
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let (face, component) = (item / (D + 1), item % (D + 1));
        let FluidFields { layout, velocity, pressure } = self.fields;
        for &dof in self.geometry.faces.as_slice()[face].dofs() {
            out.push(if component < D {
                layout.dof(velocity, D * dof as usize + component)
            } else {
                layout.dof(pressure, dof as usize)
            });
        }
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let (face, component) = (item / (D + 1), item % (D + 1));
        let value = &self.geometry.faces.as_slice()[face];
        if value.odd_component == Some(component) {
            return;
        }
        let weight = self.weights[face][usize::from(component == D)];
        let mut jump = 0.0;
        for (&dof, j) in value.dofs().iter().zip(value.jumps()) {
            jump += j * if component < D {
                self.fields.velocity_at::<D>(x, dof)[component]
            } else {
                self.fields.pressure_at(x, dof)
            };
        }
        for (i, j_i) in value.jumps().iter().enumerate() {
            out.add(i, weight * jump * j_i);
        }
        for (k, j_k) in value.jumps().iter().enumerate() {
            let rows = out.column_mut(k).iter_mut().zip(value.jumps());
            rows.for_each(|(row, j_i)| *row += weight * j_k * j_i);
        }
    }

    fn is_linear(&self) -> bool {
        true
    }
}
