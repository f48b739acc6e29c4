//! The quadrature points of the interface with their local states.

use std::sync::Arc;

use algebra::{DofId, Sites};
use body::{SurfaceMotion, SurfaceVelocity};
use cutcell::InterfacePiece;
use fluid_ns::{FluidFields, FluidGeometry, NewtonianFluid};
use mesh::{BodyId, MAX_CELL_VERTICES, MAX_FACET_NODES, Tensor, Vector, VertexId};

use crate::slip_patch::SlipPatch;
use crate::{PiecePoint, PieceValues, SolidShare, SolidTraction};

/// The interface pieces of a step: one item per piece, one site per quadrature point.
#[derive(Clone)]
pub struct InterfacePoints<'a, const D: usize> {
    /// Geometry of the step.
    pub geometry: FluidGeometry<'a, D>,
    /// The fluid's fields.
    pub fields: FluidFields<'a>,
    /// Quadrature points.
    pub values: &'a PieceValues<D>,
    /// The surfaces of the bodies, in the order of the overlay.
    pub surfaces: Vec<&'a SurfaceMotion<'a, D>>,
    /// The fluid.
    pub fluid: NewtonianFluid,
    /// The share of the solid in the traction; `None` if the traction is that of the fluid alone, `α = 1`.
    pub solid: Option<SolidShare<'a, D>>,
}

/// A quadrature point of the interface with its local state.
///
/// Local unknowns: velocity component `a` of fluid node `i` at row `D i + a`, then the pressures of the fluid nodes,
/// then the velocity of the nodes of the body on the facet, unless its motion is prescribed, then the other unknowns on
/// which the traction of the solid depends.
pub struct MortarPoint<'a, const D: usize> {
    /// Geometry and shape values.
    pub at: &'a PiecePoint<D>,
    /// The piece.
    pub piece: &'a InterfacePiece<D>,
    /// Gradients of the fluid's shape functions.
    pub gradients: &'a [Vector<D>; MAX_CELL_VERTICES],
    /// Size `h_K` of the background cell.
    pub cell_size: f64,
    /// Viscous length, over which the velocity can change: `h_K`, or less in films ([`PieceValues::viscous_length`]).
    pub viscous_length: f64,
    /// Largest speed `|u* - v^n|` of the fluid relative to the body on the piece, known before the step.
    pub relative_speed: f64,
    /// Largest acceleration of the fluid relative to the body on the piece, at the start of the step; `None` if
    /// accelerations are not known.
    pub relative_acceleration: Option<f64>,
    /// Velocity `u` of the fluid.
    pub velocity: Vector<D>,
    /// Fluid velocity minus velocity of the body.
    pub jump: Vector<D>,
    /// Length `χ d` on surfaces along films ([`crate::MeanSlip::thickness`]); zero elsewhere.
    pub film_thickness: f64,
    /// Pressure.
    pub pressure: f64,
    /// Additional pressure on the body in the last part of a film ([`fluid_ns::LastPiece`]), and its derivatives with
    /// respect to the pressures of the fluid nodes; `None` elsewhere.
    pub at_end: Option<(f64, [f64; MAX_CELL_VERTICES])>,
    /// Traction `T^f(u, p) n^f`.
    pub traction: Vector<D>,
    /// Weight `α` of the traction of the fluid.
    pub alpha: f64,
    /// Traction of the solid, of weight `1 - α`; `None` if `α = 1`.
    pub solid: Option<Arc<SolidTraction<D>>>,
    /// Number of nodes of the body on the facet with unknown velocities; zero if the motion of the body is prescribed.
    pub n_solid: usize,
}

impl<const D: usize> MortarPoint<'_, D> {
    /// Returns the normal `n^f = -n`, into the body.
    #[inline]
    pub fn fluid_normal(&self) -> Vector<D> {
        -self.piece.normal
    }

    /// Returns the force on the body per area at the end of a film ([`crate::terms::FilmEnd`]).
    #[inline]
    pub fn force_at_end(&self) -> Vector<D> {
        self.piece.normal * self.at_end.map_or(0.0, |(pressure, _)| -self.alpha * pressure)
    }

    /// Returns the traction of the mortar, `α T^f n^f + (1 - α) T^s n^f`.
    #[inline]
    pub fn shared_traction(&self) -> Vector<D> {
        let of_fluid = self.traction * self.alpha;
        self.solid.as_ref().map_or(of_fluid, |solid| of_fluid + solid.traction * solid.weight)
    }

    /// Returns the basis of the jump `v - w`: first row and value of each vector-valued test function. They are
    /// negative for the body.
    #[inline]
    pub fn jump_basis(&self) -> impl Iterator<Item = (usize, f64)> + Clone + '_ {
        let fluid = (0..=D).map(|i| (self.velocity_row(i), self.at.fluid[i]));
        let first_solid = (D + 1) * (D + 1);
        let solid = (0..self.n_solid).map(move |k| (first_solid + D * k, -self.at.solid[k]));
        fluid.chain(solid)
    }

    /// Returns the first row of the velocity of a fluid node.
    #[inline]
    pub fn velocity_row(&self, node: usize) -> usize {
        D * node
    }

    /// Returns the row of the pressure of a fluid node.
    #[inline]
    pub fn pressure_row(&self, node: usize) -> usize {
        D * (D + 1) + node
    }
}

impl<const D: usize> InterfacePoints<'_, D> {
    /// Returns the weight `α` of the traction of the fluid on a body.
    pub(crate) fn alpha(&self, body: BodyId) -> f64 {
        let share = self.solid.as_ref().filter(|solid| solid.stresses[body.index()].is_some());
        share.map_or(1.0, |solid| solid.alpha)
    }

    /// Returns the pressure between the last part of a film and its edge, for a piece along the film in that part.
    fn last_piece(&self, item: usize) -> Option<&fluid_ns::LastPiece> {
        let piece = &self.geometry.cut.interface()[item];
        self.values.patch(item)?;
        self.geometry.films?.of(piece.part)?.last_piece.as_ref()
    }

    /// Returns [`crate::MeanSlip::thickness`] of a patch.
    pub(crate) fn film_thickness(&self, patch: &SlipPatch<D>) -> f64 {
        if self.alpha(patch.body) == 1.0 { patch.thickness } else { 0.0 }
    }
}

impl<'a, const D: usize> Sites for InterfacePoints<'a, D> {
    type Site = MortarPoint<'a, D>;

    fn len(&self) -> usize {
        self.geometry.cut.interface().len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let piece = &self.geometry.cut.interface()[item];
        let first = out.len();
        let FluidFields { layout, velocity, pressure } = self.fields;
        let dofs = self.geometry.space.dofs(piece.part);
        dofs.iter().for_each(|&dof| out.extend(layout.node(velocity, dof as usize)));
        dofs.iter().for_each(|&dof| out.extend(layout.node(pressure, dof as usize)));
        let surface = self.surfaces[piece.body.index()];
        if let Some(field) = surface.field() {
            let nodes = surface.boundary.nodes(piece.facet).iter();
            nodes.for_each(|node| out.extend(layout.node(field, node.index())));
        }
        let stress = self.solid.as_ref().and_then(|solid| solid.stresses[piece.body.index()].as_ref());
        if let Some(stress) = stress {
            let mut of_stress = Vec::new();
            stress.dofs(piece.facet, &mut of_stress);
            of_stress.retain(|dof| !out[first..].contains(dof));
            out.extend(of_stress);
        }
    }

    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
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
        let surface = self.surfaces[piece.body.index()];
        let (mut on_facet, mut n_solid) = ([Vector::<D>::zeros(); MAX_FACET_NODES], 0);
        if let Some(field) = surface.field() {
            n_solid = surface.boundary.nodes(piece.facet).len();
            let velocity = |node: VertexId| self.fields.layout.at(field, node.index(), x).into();
            on_facet = surface.boundary.at_nodes(piece.facet, velocity);
        }
        let viscous_traction = self.fluid.viscous_traction(&grad_u, &-piece.normal);
        let solid = self.solid.as_ref().and_then(|solid| {
            let mut dofs = Vec::new();
            self.dofs(item, &mut dofs);
            solid.on_facet(piece.body, piece.facet, &dofs, x).map(Arc::new)
        });
        let last_piece = self.last_piece(item);
        let film_thickness = self.values.patch(item).map_or(0.0, |patch| self.film_thickness(patch));
        for at in self.values.points(item) {
            let mut velocity = Vector::zeros();
            let mut pressure = 0.0;
            for i in 0..=D {
                velocity += velocities[i] * at.fluid[i];
                pressure += pressures[i] * at.fluid[i];
            }
            let at_end = last_piece.map(|last| last.pressure(&pressures[..=D], &at.fluid));
            let mut jump = velocity;
            match &surface.velocity {
                SurfaceVelocity::Field(_) => (0..n_solid).for_each(|k| jump -= on_facet[k] * at.solid[k]),
                SurfaceVelocity::Given(of_body) => jump -= of_body(&at.point),
            }
            visit(&MortarPoint {
                at,
                piece,
                gradients,
                cell_size: self.values.cell_size(item),
                viscous_length: self.values.viscous_length(item),
                relative_speed: self.values.relative_speed(item),
                relative_acceleration: self.values.relative_acceleration(item),
                velocity,
                jump,
                film_thickness,
                pressure,
                at_end,
                traction: viscous_traction + piece.normal * pressure,
                alpha: self.alpha(piece.body),
                solid: solid.clone(),
                n_solid,
            });
        }
    }
}
