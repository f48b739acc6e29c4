//! The mortaring form.

use algebra::{Contributions, DofId, FieldId, LocalSystem};
use fluid_ns::{FluidFields, FluidGeometry, NewtonianFluid};
use mesh::{BoundaryMesh, MAX_CELL_VERTICES, Point, Tensor, Vector};

use crate::piece_values::{MortarPoint, PieceValues};
use crate::terms::{AdjointConsistency, Consistency, Penalty};

/// What is known of a body's velocity.
pub enum BodySide<'a, const D: usize> {
    /// Vertex velocities, unknown or tied to unknowns: component `a` of that of vertex `v` lies at `D v + a` of the field.
    Unknown {
        /// The velocity field of the body.
        field: FieldId,
        /// Its boundary.
        boundary: &'a BoundaryMesh<D>,
    },
    /// Given at every point of the body.
    Prescribed {
        /// Velocity at a point where the body was at the first time, for the second one.
        #[allow(clippy::type_complexity)]
        velocity: &'a (dyn Fn(&Point<D>, [f64; 2]) -> Vector<D> + Send + Sync),
        /// Begin and end of the step.
        times: [f64; 2],
    },
}

/// The three mortaring terms.
pub struct MortarForm {
    /// `-(T^f(u, p) n^f, v - w)`.
    pub consistency: Consistency,
    /// `-(u - v_s, T^f(v, -q) n^f)`.
    pub adjoint_consistency: AdjointConsistency,
    /// `γ_Σ μ^f/h_K (u - v_s, v - w)`.
    pub penalty: Penalty,
}

impl MortarForm {
    /// The form for a fluid, with the penalty parameter `γ_Σ`.
    pub fn new(fluid: NewtonianFluid, gamma_sigma: f64) -> Self {
        let viscosity = fluid.viscosity;
        Self {
            consistency: Consistency { viscosity },
            adjoint_consistency: AdjointConsistency { viscosity },
            penalty: Penalty { gamma_sigma, viscosity },
        }
    }
}

/// All interface pieces of a step. Linear: the geometry is frozen and the traction is the fluid's.
pub struct InterfacePieces<'a, const D: usize> {
    /// Geometry of the step.
    pub geometry: &'a FluidGeometry<'a, D>,
    /// Where the fluid's fields lie.
    pub fields: FluidFields<'a>,
    /// Quadrature points.
    pub values: &'a PieceValues<D>,
    /// The bodies, in the order of the overlay.
    pub bodies: &'a [BodySide<'a, D>],
    /// The terms.
    pub form: &'a MortarForm,
}

impl<const D: usize> InterfacePieces<'_, D> {
    /// Calls `visit` with each quadrature point of a piece, fields evaluated.
    pub(crate) fn for_each_point(&self, item: usize, x: &[f64], mut visit: impl FnMut(&MortarPoint<'_, D>)) {
        let piece = &self.geometry.cut.interface()[item];
        let gradients = self.values.gradients(item);
        let mut velocities = [Vector::<D>::zeros(); MAX_CELL_VERTICES];
        let mut pressures = [0.0; MAX_CELL_VERTICES];
        let mut grad_u = Tensor::<D>::zeros();
        for (i, &dof) in self.geometry.space.dofs(piece.part).iter().enumerate() {
            velocities[i] = self.fields.velocity_at(x, dof);
            pressures[i] = self.fields.pressure_at(x, dof);
            grad_u += velocities[i] * gradients[i].transpose();
        }
        let body = &self.bodies[piece.body.index()];
        let mut on_facet = [Vector::<D>::zeros(); MAX_CELL_VERTICES];
        if let BodySide::Unknown { field, boundary } = body {
            for (slot, vertex) in on_facet.iter_mut().zip(boundary.facet(piece.facet)) {
                let start = self.fields.layout.dof(*field, D * vertex.index()).index();
                *slot = Vector::from_column_slice(&x[start..start + D]);
            }
        }
        let viscosity = self.form.consistency.viscosity;
        let viscous_traction = (grad_u + grad_u.transpose()) * -piece.normal * viscosity;
        for at in self.values.points(item) {
            let mut jump = Vector::zeros();
            let mut pressure = 0.0;
            for i in 0..=D {
                jump += velocities[i] * at.fluid[i];
                pressure += pressures[i] * at.fluid[i];
            }
            match body {
                BodySide::Unknown { .. } => (0..D).for_each(|k| jump -= on_facet[k] * at.solid[k]),
                BodySide::Prescribed { velocity, times } => jump -= velocity(&at.point, *times),
            }
            visit(&MortarPoint {
                at,
                piece,
                gradients,
                cell_size: self.values.cell_size(item),
                jump,
                pressure,
                traction: viscous_traction + piece.normal * pressure,
                is_unknown: matches!(body, BodySide::Unknown { .. }),
            });
        }
    }
}

impl<const D: usize> Contributions for InterfacePieces<'_, D> {
    fn name(&self) -> &'static str {
        "interface"
    }

    fn len(&self) -> usize {
        self.geometry.cut.interface().len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let piece = &self.geometry.cut.interface()[item];
        let FluidFields { layout, velocity, pressure } = self.fields;
        let dofs = self.geometry.space.dofs(piece.part);
        for &dof in dofs {
            out.extend((0..D).map(|a| layout.dof(velocity, D * dof as usize + a)));
        }
        out.extend(dofs.iter().map(|&dof| layout.dof(pressure, dof as usize)));
        if let BodySide::Unknown { field, boundary } = &self.bodies[piece.body.index()] {
            for vertex in boundary.facet(piece.facet) {
                out.extend((0..D).map(|a| layout.dof(*field, D * vertex.index() + a)));
            }
        }
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        self.for_each_point(item, x, |q| {
            self.form.consistency.add(q, out);
            self.form.adjoint_consistency.add(q, out);
            self.form.penalty.add(q, out);
        });
    }

    fn is_linear(&self) -> bool {
        true
    }
}
