//! The geometry of a step: everything that is computed once and frozen during Newton's method.

use std::cell::OnceCell;
use std::time::Instant;

use cutcell::CutMesh;
use interface_dg::PieceValues;
use mesh::search::{CellIndex, SurfaceIndex};
use mesh::{Placed, Point, Vector};
use xfem_space::{FaceValues, PartValues, Transferred, VelocityField, XfemSpace, transfer};

use crate::setup::{BodyKind, FluidBoundary};
use crate::{Setup, State};

/// Degree of quadrature on parts: convection and mass are quadratic in P1 functions.
const PART_DEGREE: usize = 2;
/// Degree of quadrature on interface pieces: products of two P1 functions.
const PIECE_DEGREE: usize = 2;

/// Cut, space, shape values and history of a step.
pub struct StepGeometry<const D: usize> {
    /// Positions of the vertices of each body at step n.
    pub positions: Vec<Vec<Point<D>>>,
    /// The cut at these positions.
    pub cut: CutMesh<D>,
    /// The space on it.
    pub space: XfemSpace<D>,
    /// Shape values on fluid parts.
    pub parts: PartValues<D>,
    /// Jumps over faces.
    pub faces: FaceValues<D>,
    /// Traces on interface pieces.
    pub pieces: PieceValues<D>,
    /// Velocity history `u*`.
    pub history: Transferred<D>,
    /// Wall-clock time of the transfer, for reports only.
    pub seconds_transfer: f64,
}

impl<const D: usize> StepGeometry<D> {
    /// The geometry of the step after `previous`, given its cut.
    pub fn new(setup: &Setup<D>, previous: &State<D>, positions: Vec<Vec<Point<D>>>, cut: CutMesh<D>) -> Self {
        let background = &setup.background;
        let space = XfemSpace::new(background, &cut);
        let old =
            VelocityField { cut: &previous.fluid.cut, space: &previous.fluid.space, values: &previous.fluid.velocity };
        let bodies = BodyVelocity { setup, previous, positions: &positions, index: OnceCell::new() };
        let begin = Instant::now();
        let history = transfer(background, old, &cut, &space, &|_, x| bodies.at(x));
        let seconds_transfer = begin.elapsed().as_secs_f64();
        let parts = PartValues::new(background, &cut, PART_DEGREE);
        let mut faces = FaceValues::new(background, &cut, &space, &parts);
        for (tag, condition) in &setup.fluid.boundary {
            if let FluidBoundary::Symmetry { axis } = condition {
                faces.add_symmetry_plane(background, &cut, &space, &parts, *tag, *axis);
            }
        }
        let pieces = PieceValues::new(background, &cut, &parts, PIECE_DEGREE);
        Self { positions, cut, space, parts, faces, pieces, history, seconds_transfer }
    }
}

/// Velocity of the body at a point, or of the nearest point of a surface.
struct BodyVelocity<'a, const D: usize> {
    setup: &'a Setup<D>,
    previous: &'a State<D>,
    positions: &'a [Vec<Point<D>>],
    index: OnceCell<Vec<BodyIndex<D>>>,
}

struct BodyIndex<const D: usize> {
    cells: Option<CellIndex<D>>,
    surface: SurfaceIndex<D>,
}

impl<const D: usize> BodyVelocity<'_, D> {
    fn at(&self, x: &Point<D>) -> Vector<D> {
        let index = self.index.get_or_init(|| self.build());
        for (b, body) in self.setup.bodies.iter().enumerate() {
            if let (BodyKind::Elastic(elastic), Some(cells)) = (&body.kind, &index[b].cells)
                && let Some((cell, barycentric)) = cells.locate(x)
            {
                let vertices = elastic.solid.mesh().cell(cell);
                let velocity = &self.previous.bodies[b].velocity;
                return vertices.iter().zip(barycentric).map(|(v, l)| velocity[v.index()] * l).sum();
            }
        }
        for (b, of_body) in index.iter().enumerate() {
            if let Some(velocity) = self.undeformed(b, x)
                && of_body.surface.closest_signed(x).is_some_and(|closest| closest.distance < 0.0)
            {
                return velocity;
            }
        }
        let mut nearest: Option<(f64, Vector<D>)> = None;
        for (b, body) in self.setup.bodies.iter().enumerate() {
            let Some(closest) = index[b].surface.closest(x) else { continue };
            let distance = (closest.point - x).norm();
            if nearest.is_none_or(|(d, _)| distance < d) {
                let on_facet = || {
                    let vertices = body.boundary().facet(closest.facet);
                    let values = &self.previous.bodies[b].velocity;
                    vertices.iter().zip(closest.barycentric).map(|(v, l)| values[v.index()] * l).sum()
                };
                nearest = Some((distance, self.undeformed(b, x).unwrap_or_else(on_facet)));
            }
        }
        nearest.map_or(Vector::zeros(), |(_, velocity)| velocity)
    }

    /// Velocity at a point of a body whose velocity is known everywhere.
    fn undeformed(&self, b: usize, x: &Point<D>) -> Option<Vector<D>> {
        match &self.setup.bodies[b].kind {
            BodyKind::Elastic(_) => None,
            BodyKind::Rigid(_) => self.previous.bodies[b].rigid.map(|motion| motion.velocity_at(x)),
            BodyKind::Prescribed(given) => Some((given.velocity)(x, [self.previous.time; 2])),
        }
    }

    fn build(&self) -> Vec<BodyIndex<D>> {
        let bodies = self.setup.bodies.iter().zip(self.positions);
        bodies
            .map(|(body, x)| BodyIndex {
                cells: body.elastic().map(|elastic| CellIndex::new(elastic.solid.mesh(), x)),
                surface: SurfaceIndex::new(&Placed::new(body.boundary(), x)),
            })
            .collect()
    }
}
