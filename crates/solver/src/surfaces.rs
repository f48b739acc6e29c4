//! Values on the surfaces of the bodies at the start of a step, on the cut of the step.

use algebra::NewtonError;
use algebra::time::Level;
use cutcell::CutMesh;
use mesh::{MAX_FACET_NODES, Point, Tensor, Vector};
use xfem_space::{PartValues, XfemSpace};

use crate::extension::Extension;
use crate::{FluidState, Setup, State};

/// One vector for each node of a body on a facet.
type OnFacet<const D: usize> = [Vector<D>; MAX_FACET_NODES];

/// Surfaces of the bodies at the start of a step, and the cut of the step.
pub(crate) struct Surfaces<'a, const D: usize> {
    pub(crate) setup: &'a Setup<D>,
    pub(crate) previous: &'a State<D>,
    /// Positions of the vertices at the start.
    pub(crate) at_start: Vec<Vec<Point<D>>>,
    /// Positions of the vertices at which the background is cut.
    pub(crate) positions: &'a [Vec<Point<D>>],
    /// Time from the start of the step to the cut.
    pub(crate) lead: f64,
    pub(crate) cut: &'a CutMesh<D>,
    pub(crate) space: &'a XfemSpace<D>,
    pub(crate) parts: &'a PartValues<D>,
}

impl<const D: usize> Surfaces<'_, D> {
    /// Returns a vector for each node of the body on the facet of an interface piece.
    fn on_facet(&self, item: usize, of: impl Fn(usize) -> Vector<D>) -> OnFacet<D> {
        let piece = &self.cut.interface()[item];
        self.setup.bodies[piece.body.index()].surface().at_nodes(piece.facet, |node| of(node.index()))
    }

    /// Returns the velocities of the body of an interface piece.
    pub(crate) fn velocities(&self, item: usize) -> OnFacet<D> {
        let velocity = self.previous.bodies[self.cut.interface()[item].body.index()].velocity();
        self.on_facet(item, |node| velocity[node])
    }

    /// Returns the velocities of the body of an interface piece; if accelerations are known, the velocities are
    /// extrapolated to the stage.
    pub(crate) fn extrapolated_velocities(&self, item: usize) -> OnFacet<D> {
        let level = &self.previous.bodies[self.cut.interface()[item].body.index()].level;
        let gained = |node| level.acceleration.get(node).map_or(Vector::zeros(), |a: &Vector<D>| a * self.lead);
        self.on_facet(item, |node| level.velocity[node] + gained(node))
    }

    /// Returns the acceleration at a fixed point, `∂u/∂t`, of a fluid of velocity `u` that moves with the body of an
    /// interface piece: `a - ∇u w` with the acceleration `a` of the body and the velocity `w` of its surface.
    pub(crate) fn accelerations(&self, item: usize, velocity: &[Vector<D>]) -> OnFacet<D> {
        let piece = &self.cut.interface()[item];
        let nodes = self.space.dofs(piece.part).iter().zip(self.parts.gradients(piece.part));
        let grad_u: Tensor<D> = nodes.map(|(dof, g)| velocity[*dof as usize] * g.transpose()).sum();
        let body = piece.body.index();
        let Level { velocity: of_surface, acceleration, .. } = &self.previous.bodies[body].level;
        let (positions, at_start) = (&self.positions[body], &self.at_start[body]);
        let moved = |node: usize| match self.lead {
            0.0 => of_surface[node],
            lead => (positions[node] - at_start[node]) / lead,
        };
        self.on_facet(item, |node| {
            let of_body = acceleration.get(node).copied().unwrap_or_else(Vector::zeros);
            of_body - grad_u * moved(node)
        })
    }

    /// Transfers velocity and acceleration of the fluid to the space of the step, and extends both to uncovered dofs:
    /// those without a value on the space before.
    ///
    /// The extensions use values of the bodies, whose surfaces at the start of the step differ from those of the cut if
    /// the geometry is extrapolated. The velocity is given where it holds, on the surface at the start. The
    /// acceleration at a fixed point is given on the surface of the cut, with an error of first order in the distance
    /// of the two surfaces. Given at the start, its error would be this distance times the gradient of the
    /// acceleration, which is large.
    ///
    /// # Errors
    /// The extension fails.
    pub(crate) fn carry(
        &self,
        before: &FluidState<D>,
        extension: &Extension<'_, D>,
    ) -> Result<Level<Vector<D>>, NewtonError> {
        let places = |item: usize, positions: &[Vec<Point<D>>]| {
            let body = self.cut.interface()[item].body.index();
            self.on_facet(item, |node| positions[body][node])
        };
        let mut velocity = extension.sources.carry(&before.velocity);
        extension.fill(&mut velocity, |item| [self.velocities(item), places(item, &self.at_start)])?;
        let mut acceleration = Vec::new();
        if !before.acceleration.is_empty() {
            acceleration = extension.sources.carry(&before.acceleration);
            let on_cut = |item| places(item, self.positions);
            extension.fill(&mut acceleration, |item| [self.accelerations(item, &velocity), on_cut(item)])?;
        }
        Ok(Level { velocity, acceleration, ..Level::default() })
    }
}
