//! The mean slip on surfaces along films.

use algebra::{DofId, Sites};
use body::SurfaceVelocity;
use mesh::{Tensor, Vector};

use crate::InterfacePoints;
use crate::slip_patch::{SlipPatch, along_surface};

/// The surfaces along films: one item and one site per side of a body in a fluid part.
#[derive(Clone)]
pub struct MeanSlips<'a, const D: usize>(pub InterfacePoints<'a, D>);

/// The mean slip `m`, mean of `P (u - v_s)` over one side of a body in a fluid part with a film, with the projection
/// `P = I - n ⊗ n`.
///
/// Local unknowns: velocity component `a` of fluid node `i` at row `D i + a`, then the velocities of the nodes of the
/// body on the surface, unless its motion is prescribed.
pub struct MeanSlip<const D: usize> {
    /// The mean.
    pub value: Vector<D>,
    /// Measure of the surface, with the weight of the coordinates.
    pub weight: f64,
    /// Length `χ d`: thickness `d` of the layer ([`fluid_ns::FilmPart::layer`]) times the share `χ` of the film
    /// ([`fluid_ns::FilmPart::share`]). Zero for `α < 1`: then the whole slip is penalised, because the traction of the
    /// solid varies on the surface.
    pub thickness: f64,
    /// Viscous length ([`crate::PieceValues::viscous_length`]).
    pub viscous_length: f64,
    /// Derivatives of the mean with respect to the local unknowns.
    pub derivatives: Vec<Vector<D>>,
}

impl<const D: usize> MeanSlips<'_, D> {
    fn patches(&self) -> &[SlipPatch<D>] {
        self.0.values.patches()
    }

    /// Calls `visit` with the mean slip of each piece of the interface on a surface along a film, given its number.
    pub(crate) fn for_each_piece(&self, x: &[f64], mut visit: impl FnMut(usize, &MeanSlip<D>)) {
        for (item, patch) in self.patches().iter().enumerate() {
            self.visit(item, x, |slip| patch.pieces.iter().for_each(|piece| visit(*piece, slip)));
        }
    }
}

impl<const D: usize> Sites for MeanSlips<'_, D> {
    type Site = MeanSlip<D>;

    fn len(&self) -> usize {
        self.patches().len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let (patch, fields) = (&self.patches()[item], self.0.fields);
        let dofs = self.0.geometry.space.dofs(patch.part);
        dofs.iter().for_each(|&dof| out.extend(fields.layout.node(fields.velocity, dof as usize)));
        if let Some(field) = self.0.surfaces[patch.body.index()].field() {
            patch.solid.iter().for_each(|(node, _)| out.extend(fields.layout.node(field, node.index())));
        }
    }

    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        let (patch, points) = (&self.patches()[item], &self.0);
        let mut value = Vector::zeros();
        let mut derivatives = Vec::new();
        let mut add = |mean: &Tensor<D>| derivatives.extend((0..D).map(|a| mean.column(a).into_owned()));
        for (dof, mean) in points.geometry.space.dofs(patch.part).iter().zip(&patch.fluid) {
            value += mean * points.fields.velocity_at(x, *dof);
            add(mean);
        }
        match &points.surfaces[patch.body.index()].velocity {
            SurfaceVelocity::Field(field) => {
                for (node, mean) in &patch.solid {
                    value -= mean * Vector::from(points.fields.layout.at(*field, node.index(), x));
                    add(&-mean);
                }
            }
            SurfaceVelocity::Given(of_body) => {
                for &piece in &patch.pieces {
                    let along = along_surface(&points.geometry.cut.interface()[piece].normal);
                    for at in points.values.points(piece) {
                        value -= along * of_body(&at.point) * (at.weight / patch.weight);
                    }
                }
            }
        }
        visit(&MeanSlip {
            value,
            weight: patch.weight,
            thickness: points.film_thickness(patch),
            viscous_length: points.values.viscous_length(patch.pieces[0]),
            derivatives,
        });
    }
}
