//! Ends of films at edges of surfaces, with open fluid behind them.

use std::f64::consts::PI;

use cutcell::CutMesh;
use mesh::{Aabb, FacetId, Point, SimplexMesh, Vector, mean};
use xfem_space::{PartValues, XfemSpace};

use crate::film::{FilmSurfaces, FilmValues, RAMP, centroid, gap};

/// Resistance of the open fluid behind an end, as a length of film relative to the gap: half of the pressure difference
/// `32 μ q/(π δ²)` between the sides of a thin wall with a slit of width `δ` and the flux `q`, divided by the gradient
/// `12 μ q/δ³` in a film. Stokes flow. Source: Hasimoto 1958, DOI 10.1143/JPSJ.13.633.
const OPEN_FLUID: f64 = 16.0 / (12.0 * PI);
/// Largest factor of the conductance.
const LARGEST: f64 = 4.0;
/// Least slope of the pressure along a film, relative to its gradient in a cell, for a direction to the end.
const LEAST_SLOPE: f64 = 0.2;
// Search for the end, relative to the diameter of a cell: largest distance, length of a step, and length of a step at
// which a film bends too much to have an edge.
const REACH: f64 = 2.0;
const STEP: f64 = 0.125;
const LEAST_STEP: f64 = 1e-3;
/// Number of halvings of the step in which a film ends.
const HALVINGS: usize = 24;

impl<const D: usize> FilmValues<D> {
    /// Changes the conductance in the last parts of films that end at edges.
    ///
    /// A part without film has the pressure of open fluid at all of its dofs, also if a film reaches into it. The
    /// pressure of the film then falls to that of open fluid up to a cell before the edge. The distance in which it
    /// falls is `1/|∇_τ N|`, with the sum `N` of the shape functions of dofs in open fluid and its gradient `∇_τ N`
    /// along the film. From the same origin, where `N` is zero, the distance to the edge is `ℓ`, and the open fluid
    /// behind it resists like a film of length `0.42 δ`. The conductance is multiplied by
    ///
    /// `1/(|∇_τ N| (ℓ + 0.42 δ))`,
    ///
    /// with which the difference of the pressures is that of the whole film for the same flux. The factor is at most 4.
    /// A film that becomes thicker without an edge is not changed.
    pub(crate) fn extend_to_edges(
        &mut self,
        background: &SimplexMesh<D>,
        cut: &CutMesh<D>,
        space: &XfemSpace<D>,
        parts: &PartValues<D>,
        surfaces: &FilmSurfaces<D>,
    ) {
        let mut open = vec![false; space.len()];
        for part in cut.all_parts().filter(|part| self.of(*part).is_none()) {
            space.dofs(part).iter().for_each(|&dof| open[dof as usize] = true);
        }
        let mut near = Vec::new();
        for part in cut.all_parts() {
            let Some(film) = self.of_mut(part) else { continue };
            let in_open: Vec<_> = (0..=D).filter(|&i| open[space.dofs(part)[i] as usize]).collect();
            if in_open.is_empty() || in_open.len() > D {
                continue;
            }
            let gradient: Vector<D> = in_open.iter().map(|&i| parts.gradients(part)[i]).sum();
            let along = gradient - film.normal * gradient.dot(&film.normal);
            let slope = along.norm();
            let simplex = background.simplex(cut.part_cell(part));
            let middle = centroid(&simplex, parts, part);
            let Some(coordinates) = simplex.barycentric(&middle).filter(|_| slope > LEAST_SLOPE * gradient.norm())
            else {
                continue;
            };
            let size = simplex.diameter();
            surfaces.facets_near(&Aabb::of_points(simplex.points()).expanded((REACH + RAMP[1]) * size), &mut near);
            if let Some(edge) = surfaces.edge(&middle, &(along / slope), size, &near) {
                let value: f64 = in_open.iter().map(|&i| coordinates[i]).sum();
                let length = value + slope * (edge + OPEN_FLUID * film.gap);
                film.end_with(1.0 / length.max(1.0 / LARGEST));
            }
        }
    }
}

impl<const D: usize> FilmSurfaces<D> {
    /// Returns the distance along a direction from a point in a film to the edge at which the film ends; `None` if
    /// there is none within two diameters of the cell. The facets `near` contain all within this distance.
    fn edge(&self, from: &Point<D>, along: &Vector<D>, size: f64, near: &[FacetId]) -> Option<f64> {
        let feet = |x: &Point<D>| self.feet(x, near).filter(|feet| gap(feet) < RAMP[1] * size);
        let (mut inside, mut step) = (*from, STEP * size);
        while (inside - from).dot(along) < REACH * size && step > LEAST_STEP * size {
            // To the middle between the surfaces, which may bend.
            let off = mean(&feet(&inside)?.map(|foot| foot.point)) - inside;
            let middle = inside + off - along * off.dot(along);
            if feet(&middle).is_some() {
                inside = middle;
            }
            let mut outside = inside + along * step;
            if feet(&outside).is_some() {
                inside = outside;
                continue;
            }
            for _ in 0..HALVINGS {
                let half = mean(&[inside, outside]);
                *(if feet(&half).is_some() { &mut inside } else { &mut outside }) = half;
            }
            // Past an edge, the closest point of its surface remains at the edge.
            let last = feet(&inside)?;
            let past = last.iter().map(|foot| (inside - foot.point).dot(along)).fold(0.0, f64::max);
            if past > 0.5 * gap(&last) {
                return Some((inside - from).dot(along) - past);
            }
            step *= 0.5;
        }
        None
    }
}
