//! Ends of films at edges of surfaces, with open fluid behind them.

use std::f64::consts::PI;

use cutcell::{CutMesh, PartId};
use mesh::search::Foot;
use mesh::{Aabb, FacetId, Point, SimplexMesh, Vector, mean};
use xfem_space::{FaceValue, PartValues, XfemSpace};

use crate::film::{FRONT, FilmFoot, FilmSurfaces, FilmValues, RAMP, centroid, gap};

/// Resistance of the open fluid behind an end, as a length of film relative to the gap: half of the pressure difference
/// `32 μ q/(π δ²)` between the sides of a thin wall with a slit of width `δ` and the flux `q`, divided by the gradient
/// `12 μ q/δ³` in a film. Stokes flow. Source: Hasimoto 1958, DOI 10.1143/JPSJ.13.633.
const OPEN_FLUID: f64 = 16.0 / (12.0 * PI);
/// Least slope of the pressure along a film, relative to its gradient in a cell, for a direction to the end.
const LEAST_SLOPE: f64 = 0.2;
// Search for the end, relative to the diameter of a cell: largest distance, length of a step, and length of a step at
// which a film bends too much to have an edge.
const REACH: f64 = 2.0;
const STEP: f64 = 0.125;
const LEAST_STEP: f64 = 1e-3;
/// Volume of a part relative to its cell, and distance from a facet relative to the diameter of a cell, that are zero.
const NEGLIGIBLE: f64 = 1e-9;
/// Number of halvings of the step in which a film ends.
const HALVINGS: usize = 12;

impl<const D: usize> FilmValues<D> {
    /// Changes the conductance in the last parts of films that end at edges of their `surfaces`. It precedes
    /// [`FilmValues::subtract_slip`].
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
    /// Dofs in open fluid have the velocity of open fluid, too, so that only the share `1 - N` of the parabola that
    /// layers represent is there: the missing flux is that of `d² + N (δ² - d²)` in place of `d²`.
    /// A part with vertices in open fluid behind both ends of a short film has the length between them, with twice the
    /// resistance of open fluid. A film that becomes thicker without an edge is not changed.
    pub fn extend_to_edges(
        &mut self,
        background: &SimplexMesh<D>,
        cut: &CutMesh<D>,
        space: &XfemSpace<D>,
        parts: &PartValues<D>,
        faces: &[FaceValue<D>],
        surfaces: &FilmSurfaces<D>,
    ) {
        let mut open = vec![false; space.len()];
        for part in self.open_fluid(background, cut, parts, faces) {
            space.dofs(part).iter().for_each(|&dof| open[dof as usize] = true);
        }
        let mut near = Vec::new();
        for part in cut.all_parts() {
            let Some(film) = self.of_mut(part) else { continue };
            let in_open: Vec<_> = (0..=D).filter(|&i| open[space.dofs(part)[i] as usize]).collect();
            if in_open.is_empty() {
                continue;
            }
            let simplex = background.simplex(cut.part_cell(part));
            let middle = centroid(background, cut, parts, part);
            let Some(coordinates) = simplex.barycentric(&middle) else { continue };
            let along_film = |v: Vector<D>| v - film.normal * v.dot(&film.normal);
            let gradient = |vertices: &[usize]| vertices.iter().map(|&i| parts.gradients(part)[i]).sum::<Vector<D>>();
            let size = simplex.diameter();
            surfaces.facets_near(&Aabb::of_points(simplex.points()).expanded((REACH + RAMP[1]) * size), &mut near);
            let edge = |along: Vector<D>| surfaces.edge(&middle, &along, size, &near);
            let exit = OPEN_FLUID * film.gap;
            let (value, rises) = (in_open.iter().map(|&i| coordinates[i]).sum::<f64>(), gradient(&in_open));
            let shape = |x: &Point<D>| value + rises.dot(&(x - middle));
            let falls = along_film(rises);
            let slope = falls.norm();
            if slope > LEAST_SLOPE * rises.norm() {
                let Some(ahead) = edge(falls / slope) else { continue };
                film.end_with(value + slope * (ahead.max(0.0) + exit), shape);
                continue;
            }
            // A short film, with open fluid behind the edges on both sides.
            let slopes = (0..=D).map(|i| along_film(parts.gradients(part)[i]));
            let Some(along) = slopes.max_by(|a, b| a.norm().total_cmp(&b.norm())) else { continue };
            let along = along.normalize();
            let (Some(ahead), Some(behind)) = (edge(along), edge(-along)) else { continue };
            let is_ahead = |i: &usize| (simplex.points()[*i] - middle).dot(&along) > 0.5 * (ahead - behind);
            if in_open.iter().any(is_ahead) && !in_open.iter().all(is_ahead) {
                let slope = along_film(gradient(&(0..=D).filter(is_ahead).collect::<Vec<_>>())).norm();
                film.end_with(slope * (ahead + behind + 2.0 * exit), shape);
            }
        }
    }
}

impl<const D: usize> FilmValues<D> {
    /// Returns the parts of open fluid: those without film that are connected by faces and together have at least the
    /// volume of a cell. Fluid in a corner between two films is not open. Parts of negligible volume are left out.
    fn open_fluid(
        &self,
        background: &SimplexMesh<D>,
        cut: &CutMesh<D>,
        parts: &PartValues<D>,
        faces: &[FaceValue<D>],
    ) -> impl Iterator<Item = PartId> {
        let coordinates = background.coordinates();
        let fraction = |part: PartId| {
            let simplex = background.simplex(cut.part_cell(part));
            parts.moments(part).volume() / (simplex.volume() * coordinates.weight(&simplex.centroid()))
        };
        let fractions: Vec<_> = cut.all_parts().map(fraction).collect();
        let is_free = |part: &PartId| self.of(*part).is_none() && fractions[part.index()] > NEGLIGIBLE;
        let mut regions = Regions::new(fractions.len());
        for face in faces.iter().filter(|face| face.parts.iter().all(is_free)) {
            regions.join(face.parts[0].index(), face.parts[1].index());
        }
        let mut volumes = vec![0.0; fractions.len()];
        let free: Vec<_> = cut.all_parts().filter(is_free).collect();
        for part in &free {
            volumes[regions.of(part.index())] += fractions[part.index()];
        }
        free.into_iter().filter(move |part| volumes[regions.of(part.index())] >= 1.0)
    }
}

/// Disjoint sets of connected items.
struct Regions(Vec<usize>);

impl Regions {
    fn new(n: usize) -> Self {
        Self((0..n).collect())
    }

    /// Returns the item that stands for the region of an item, the smallest one in it.
    fn of(&mut self, item: usize) -> usize {
        let mut of = item;
        while self.0[of] != of {
            self.0[of] = self.0[self.0[of]];
            of = self.0[of];
        }
        of
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b)] = a.min(b);
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
            let past = |foot: &FilmFoot<D>| (inside - foot.point).dot(along);
            let at_edge =
                |foot: &&FilmFoot<D>| past(foot) > 0.5 * gap(&last) && !self.continues(foot, along, size, near);
            if let Some(past) = last.iter().filter(at_edge).map(past).reduce(f64::max) {
                return Some((inside - from).dot(along) - past);
            }
            step *= 0.5;
        }
        None
    }
    /// Returns whether a surface continues in a direction from one of its points, bent by less than 60 degrees.
    fn continues(&self, foot: &FilmFoot<D>, along: &Vector<D>, size: f64, near: &[FacetId]) -> bool {
        let tolerance = NEGLIGIBLE * size;
        near.iter().any(|facet| {
            let points = &self.facet_points(*facet);
            let contains = || Foot::on_facet(&foot.point, points).squared_distance <= tolerance.powi(2);
            let farthest = || points.iter().map(|x| (x - foot.point).dot(along)).fold(0.0, f64::max);
            self.normal(*facet).dot(&foot.normal) > FRONT && contains() && farthest() > tolerance
        })
    }
}
