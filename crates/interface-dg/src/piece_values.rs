//! Traces of fluid and solid on interface pieces.

use std::collections::BTreeMap;

use cutcell::CutMesh;
use fluid_ns::FilmValues;
use mesh::{BoundaryMesh, MAX_CELL_VERTICES, MAX_FACET_NODES, Order, Point, SimplexMesh, SimplexRule, Vector};
use xfem_space::{PartValues, XfemSpace};

use crate::PiecePoint;
use crate::slip_patch::{self, SlipPatch};

/// Largest viscous length of a piece in a film, in heights `V/A` of its part ([`PieceValues::set_films`]). The
/// symmetric mortar is coercive up to `γ_t/2` heights, 17.5 for the standard stabilisation; 8 is below half of this
/// bound.
const LARGEST_LENGTH_IN_HEIGHTS: f64 = 8.0;
/// Least height of a part in a film relative to the gap, which bounds the penalty in slivers.
const LEAST_HEIGHT: f64 = 1e-9;

/// Quadrature points of all interface pieces of a cut, computed once per step.
#[derive(Clone, Debug)]
pub struct PieceValues<const D: usize> {
    /// Points of all pieces.
    points: Vec<PiecePoint<D>>,
    /// Index of the first point of each piece, and the number of points.
    first: Vec<usize>,
    // The others have one value per piece.
    gradients: Vec<[Vector<D>; MAX_CELL_VERTICES]>,
    cell_sizes: Vec<f64>,
    viscous_lengths: Vec<f64>,
    relative_speeds: Vec<f64>,
    relative_accelerations: Option<Vec<f64>>,
    /// Number of the patch of each piece on a surface along a film.
    patch: Vec<Option<usize>>,
    patches: Vec<SlipPatch<D>>,
}

impl<const D: usize> PieceValues<D> {
    /// Creates the values with a rule on every piece that is exact for polynomials of the given degree, of two degrees
    /// more on bodies of order 2, and of one more with rotational symmetry. `surfaces` are those of the bodies.
    /// Relative speeds are zero, and viscous lengths are the sizes of the cells.
    pub fn new(
        background: &SimplexMesh<D>,
        cut: &CutMesh<D>,
        parts: &PartValues<D>,
        surfaces: &[&BoundaryMesh<D>],
        degree: usize,
    ) -> Self {
        let coordinates = background.coordinates();
        let rules = [Order::Linear, Order::Quadratic]
            .map(|order| SimplexRule::of_degree(D - 1, degree + 2 * (order.degree() - 1) + coordinates.degree()));
        let n = cut.interface().len();
        let mut values = Self {
            points: Vec::with_capacity(n * rules[0].points().len()),
            first: Vec::with_capacity(n + 1),
            gradients: Vec::with_capacity(n),
            cell_sizes: Vec::with_capacity(n),
            viscous_lengths: Vec::with_capacity(n),
            relative_speeds: vec![0.0; n],
            relative_accelerations: None,
            patch: vec![None; n],
            patches: Vec::new(),
        };
        for piece in cut.interface() {
            let (simplex, surface) = (background.simplex(piece.cell), surfaces[piece.body.index()]);
            let rule = rules[surface.order().degree() - 1];
            values.first.push(values.points.len());
            let gradients = parts.gradients(piece.part);
            values.gradients.push(*gradients);
            values.cell_sizes.push(parts.cell_size(piece.part));
            values.viscous_lengths.push(parts.cell_size(piece.part));
            for (barycentric, weight) in rule.points().iter().zip(rule.weights()) {
                let mut point = PiecePoint {
                    point: Point::zeros(),
                    measure: weight * piece.measure,
                    weight: 0.0,
                    fluid: [0.0; MAX_CELL_VERTICES],
                    in_facet: [0.0; D],
                    solid: [0.0; MAX_FACET_NODES],
                };
                for (corner, l) in barycentric[..D].iter().enumerate() {
                    point.point += piece.points[corner] * *l;
                    let in_facet = point.in_facet.iter_mut().zip(&piece.barycentric[corner]);
                    in_facet.for_each(|(sum, share)| *sum += l * share);
                }
                let shape = surface.shape(piece.facet, &point.in_facet);
                point.solid.copy_from_slice(&shape.values[..MAX_FACET_NODES]);
                point.weight = point.measure * coordinates.weight(&point.point);
                point.fluid[0] = 1.0;
                for (value, gradient) in point.fluid[..=D].iter_mut().zip(gradients) {
                    *value += gradient.dot(&(point.point - simplex.points()[0]));
                }
                values.points.push(point);
            }
        }
        values.first.push(values.points.len());
        values
    }

    /// Sets the relative speed of each piece: the largest `|u - v|` at its quadrature points. `fluid` has one velocity
    /// `u` per dof of the space. `body(k)` returns the velocities `v` of the nodes of the facet of piece `k`.
    pub fn set_relative_speeds(
        &mut self,
        cut: &CutMesh<D>,
        space: &XfemSpace<D>,
        fluid: &[Vector<D>],
        body: impl Fn(usize) -> [Vector<D>; MAX_FACET_NODES],
    ) {
        self.relative_speeds = self.largest_differences(cut, space, fluid, body);
    }

    /// Sets the relative acceleration of each piece: the largest difference of the accelerations of fluid and body at
    /// its quadrature points. Arguments are those of [`PieceValues::set_relative_speeds`], with accelerations.
    pub fn set_relative_accelerations(
        &mut self,
        cut: &CutMesh<D>,
        space: &XfemSpace<D>,
        fluid: &[Vector<D>],
        body: impl Fn(usize) -> [Vector<D>; MAX_FACET_NODES],
    ) {
        self.relative_accelerations = Some(self.largest_differences(cut, space, fluid, body));
    }

    /// Returns for each piece the largest norm of the difference of fluid and body at its quadrature points.
    fn largest_differences(
        &self,
        cut: &CutMesh<D>,
        space: &XfemSpace<D>,
        fluid: &[Vector<D>],
        body: impl Fn(usize) -> [Vector<D>; MAX_FACET_NODES],
    ) -> Vec<f64> {
        let largest = |item: usize| {
            let (on_facet, dofs) = (body(item), space.dofs(cut.interface()[item].part));
            let difference = |at: &PiecePoint<D>| {
                let of_fluid: Vector<D> = dofs.iter().zip(at.fluid).map(|(dof, n)| fluid[*dof as usize] * n).sum();
                let of_body: Vector<D> = on_facet.iter().zip(&at.solid).map(|(v, n)| v * *n).sum();
                (of_fluid - of_body).norm()
            };
            self.points(item).iter().map(difference).fold(0.0, f64::max)
        };
        (0..cut.interface().len()).map(largest).collect()
    }

    /// Limits the viscous lengths of pieces in films to the gap of the film and to 8 heights `V/A` of the part, and
    /// collects the pieces on which the mean slip is penalised. `surfaces` are those of the bodies.
    ///
    /// The ghost penalty does not act in films. On a part with volume `V` and area `A` of the surface, linear
    /// velocities have `∫_A |2 μ D(u) n|² ≤ 2 μ A/V ∫_V 2 μ |D(u)|²`. On parts that are much thinner than the film, the
    /// penalty thus bounds the traction only if the viscous length is at most a multiple of the height `V/A`.
    pub fn set_films(&mut self, cut: &CutMesh<D>, surfaces: &[&BoundaryMesh<D>], films: &FilmValues<D>) {
        let mut areas = BTreeMap::new();
        for piece in cut.interface() {
            *areas.entry(piece.part).or_insert(0.0) += piece.measure;
        }
        for (length, piece) in self.viscous_lengths.iter_mut().zip(cut.interface()) {
            if let Some(film) = films.of(piece.part) {
                let height = cut.part_volume(piece.part) / areas[&piece.part];
                *length = length.min(film.gap).min(LARGEST_LENGTH_IN_HEIGHTS * height.max(LEAST_HEIGHT * film.gap));
            }
        }
        (self.patches, self.patch) = slip_patch::patches(cut, films, surfaces, |item| self.points(item));
    }

    /// Returns the quadrature points of a piece.
    #[inline]
    pub fn points(&self, piece: usize) -> &[PiecePoint<D>] {
        &self.points[self.first[piece]..self.first[piece + 1]]
    }

    /// Returns the gradients of the shape functions of the fluid part of a piece; only the first `D + 1` are used.
    #[inline]
    pub fn gradients(&self, piece: usize) -> &[Vector<D>; MAX_CELL_VERTICES] {
        &self.gradients[piece]
    }

    /// Returns the size `h_K` of the background cell of a piece.
    #[inline]
    pub fn cell_size(&self, piece: usize) -> f64 {
        self.cell_sizes[piece]
    }

    /// Returns the viscous length of a piece, over which the velocity can change: the size of the cell, or in films the
    /// smaller length of [`PieceValues::set_films`].
    #[inline]
    pub fn viscous_length(&self, piece: usize) -> f64 {
        self.viscous_lengths[piece]
    }

    /// Returns the largest speed of the fluid relative to the body on a piece; zero before
    /// [`PieceValues::set_relative_speeds`].
    #[inline]
    pub fn relative_speed(&self, piece: usize) -> f64 {
        self.relative_speeds[piece]
    }

    /// Returns the largest acceleration of the fluid relative to the body on a piece, if accelerations are known.
    #[inline]
    pub fn relative_acceleration(&self, piece: usize) -> Option<f64> {
        self.relative_accelerations.as_ref().map(|of_pieces| of_pieces[piece])
    }

    /// Returns the patch of a piece on a surface along a film; `None` for other pieces.
    #[inline]
    pub(crate) fn patch(&self, piece: usize) -> Option<&SlipPatch<D>> {
        self.patch[piece].map(|number| &self.patches[number])
    }

    /// Returns the patches of all surfaces along films.
    #[inline]
    pub(crate) fn patches(&self) -> &[SlipPatch<D>] {
        &self.patches
    }
}
