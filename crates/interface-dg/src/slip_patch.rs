//! Pieces of the interface on which the mean slip along a film is penalised.

use std::collections::BTreeMap;

use cutcell::{CutMesh, PartId};
use fluid_ns::FilmValues;
use mesh::{BodyId, BoundaryMesh, MAX_CELL_VERTICES, Tensor, Vector, VertexId};

use crate::PiecePoint;

/// Cosine of the largest angle, 60 degrees, between the normals of a surface and of the film for a surface along the
/// film.
const ALONG: f64 = 0.5;

/// The pieces of one side of a body along the film in a fluid part.
///
/// The velocity in a layer of the film is a linear function. If the penalty forced it to equal the velocity of the body
/// on the whole surface, it could not vary along the film. Therefore the penalty acts on the mean of the slip over the
/// patch.
#[derive(Clone, Debug)]
pub(crate) struct SlipPatch<const D: usize> {
    /// Numbers of the pieces, at least one.
    pub(crate) pieces: Vec<usize>,
    /// The fluid part.
    pub(crate) part: PartId,
    /// The body.
    pub(crate) body: BodyId,
    /// Length `χ d`: thickness `d` of the layer ([`fluid_ns::FilmPart::layer`]) times the share `χ` of the film
    /// ([`fluid_ns::FilmPart::share`]).
    pub(crate) thickness: f64,
    /// Sum of the weights of all points.
    pub(crate) weight: f64,
    /// Mean of `N_i P` for each fluid vertex, with the projection `P = I - n ⊗ n` onto the surface.
    pub(crate) fluid: [Tensor<D>; MAX_CELL_VERTICES],
    /// Mean of `N_k P` for each node of the body on the surface.
    pub(crate) solid: Vec<(VertexId, Tensor<D>)>,
}

/// Returns the projection onto a surface with a unit normal.
pub(crate) fn along_surface<const D: usize>(normal: &Vector<D>) -> Tensor<D> {
    Tensor::identity() - normal * normal.transpose()
}

/// Collects the patches of a cut, and for each piece the number of its patch. `points` returns the quadrature points of
/// a piece.
pub(crate) fn patches<'p, const D: usize>(
    cut: &CutMesh<D>,
    films: &FilmValues<D>,
    surfaces: &[&BoundaryMesh<D>],
    points: impl Fn(usize) -> &'p [PiecePoint<D>],
) -> (Vec<SlipPatch<D>>, Vec<Option<usize>>) {
    let mut of_piece = vec![None; cut.interface().len()];
    let mut numbers = BTreeMap::new();
    let mut patches: Vec<SlipPatch<D>> = Vec::new();
    for (item, piece) in cut.interface().iter().enumerate() {
        let weight: f64 = points(item).iter().map(|at| at.weight).sum();
        let Some(film) = films.of(piece.part).filter(|_| weight > 0.0) else { continue };
        let across = piece.normal.dot(&film.normal);
        if across.abs() < ALONG {
            continue;
        }
        let number = *numbers.entry((piece.part, piece.body, across > 0.0)).or_insert(patches.len());
        if number == patches.len() {
            patches.push(SlipPatch {
                pieces: Vec::new(),
                part: piece.part,
                body: piece.body,
                thickness: film.share * film.layer,
                weight: 0.0,
                fluid: [Tensor::zeros(); MAX_CELL_VERTICES],
                solid: Vec::new(),
            });
        }
        of_piece[item] = Some(number);
        let patch = &mut patches[number];
        patch.pieces.push(item);
        patch.weight += weight;
        let along = along_surface(&piece.normal);
        let nodes = surfaces[piece.body.index()].nodes(piece.facet);
        for at in points(item) {
            let fluid = patch.fluid.iter_mut().zip(&at.fluid);
            fluid.for_each(|(sum, value)| *sum += along * (at.weight * value));
            for (node, value) in nodes.iter().zip(&at.solid) {
                let known = patch.solid.iter().position(|(other, _)| other == node);
                let position = known.unwrap_or_else(|| {
                    patch.solid.push((*node, Tensor::zeros()));
                    patch.solid.len() - 1
                });
                patch.solid[position].1 += along * (at.weight * value);
            }
        }
    }
    for patch in &mut patches {
        patch.fluid.iter_mut().for_each(|sum| *sum /= patch.weight);
        patch.solid.iter_mut().for_each(|(_, sum)| *sum /= patch.weight);
    }
    (patches, of_piece)
}
