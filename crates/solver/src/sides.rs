//! Forces of the fluid on the boundary of the background.

use std::collections::BTreeMap;

use algebra::BlockLayout;
use mesh::{Point, Tag, Tensor, Vector, moment_of};
use xfem_space::boundary_points;

use crate::fluid_step::FluidStep;

/// Degree of quadrature on sides: a constant stress and a linear pressure times a linear function.
const SIDE_DEGREE: usize = 2;

/// Force of the fluid on a part of the background's boundary, with the weight of the coordinates. With rotational
/// symmetry, [`mesh::Coordinates::resultant`] and [`mesh::Coordinates::moment`] return those on the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideForce<const D: usize> {
    /// Sum of the forces at the vertices.
    pub force: Vector<D>,
    /// `Σ f xᵀ` of the forces `f` at the vertices `x`.
    pub first_moment: Tensor<D>,
}

impl<const D: usize> SideForce<D> {
    /// Returns a zero force.
    fn zero() -> Self {
        Self { force: Vector::zeros(), first_moment: Tensor::zeros() }
    }

    /// Returns the moment about a point, component `k` about axis `k`; in 2D only the last one is not zero.
    pub fn moment(&self, about: &Point<D>) -> [f64; 3] {
        moment_of(&(self.first_moment - self.force * about.transpose()))
    }
}

impl<const D: usize> FluidStep<'_, D> {
    /// Returns the force of the fluid on each part of the boundary, in the order of the setup; zero for open parts.
    ///
    /// At a dof with a constrained velocity, the residual of its equation is the reaction of the side: its traction
    /// times the shape function, integrated. Reactions balance all other forces. At a dof that several sides have in
    /// common, the force on each is the integral of the stress on it plus an equal share of the rest of the reaction.
    pub(crate) fn side_forces(&self, layout: &BlockLayout, x: &[f64], reactions: &[f64]) -> Vec<SideForce<D>> {
        let background = &self.setup.background;
        let sides = &self.setup.boundary;
        let mut of_dofs: BTreeMap<u32, Vec<(usize, Vector<D>)>> = BTreeMap::new();
        for (k, (tag, _)) in sides.iter().enumerate().filter(|(_, (tag, _))| !self.setup.is_open(Some(*tag))) {
            for (dof, traction) in self.stress_on(*tag, layout, x) {
                of_dofs.entry(dof).or_default().push((k, traction));
            }
        }
        let mut forces = vec![SideForce::zero(); sides.len()];
        for (dof, of_sides) in of_dofs {
            let reaction: Vector<D> = self.fields(layout).velocity_at(reactions, dof);
            let known: Vector<D> = of_sides.iter().map(|(_, traction)| traction).sum();
            let rest = (reaction - known) / of_sides.len() as f64;
            let place = background.vertex(self.space.vertex(dof));
            for (side, traction) in of_sides {
                forces[side].force -= traction + rest;
                forces[side].first_moment -= (traction + rest) * place.transpose();
            }
        }
        forces
    }

    /// Returns for each dof of a side the integral of the traction `T^f n` times the shape function.
    fn stress_on(&self, tag: Tag, layout: &BlockLayout, x: &[f64]) -> BTreeMap<u32, Vector<D>> {
        let (background, fields) = (&self.setup.background, self.fields(layout));
        let mut tractions = BTreeMap::new();
        for point in boundary_points(background, &self.cut, tag, SIDE_DEGREE) {
            let cell = self.cut.part_cell(point.part);
            let Some(gradients) = background.simplex(cell).barycentric_gradients() else { continue };
            let dofs = self.space.dofs(point.part);
            let (grad_u, pressure) = fields.grad_and_pressure(x, dofs, &gradients, &point.shape);
            let viscous = self.setup.material.viscous_traction(&grad_u, &point.normal);
            let traction = (viscous - point.normal * pressure) * point.weight;
            let on_side = background.facet(point.facet);
            for (i, &dof) in dofs.iter().enumerate() {
                if on_side.contains(&self.space.vertex(dof)) {
                    *tractions.entry(dof).or_insert_with(Vector::zeros) += traction * point.shape[i];
                }
            }
        }
        tractions
    }
}
