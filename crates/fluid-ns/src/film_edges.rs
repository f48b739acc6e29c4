//! Ends of films at edges of surfaces, with open fluid behind them.

use std::f64::consts::PI;

use cutcell::{CutMesh, PartId};
use mesh::search::Foot;
use mesh::{Aabb, FacetId, Point, SimplexMesh, Vector, mean, simplex_measure};
use xfem_space::{Classes, FaceValue, PartValues, XfemSpace};

use crate::film::{FRONT, FilmFoot, FilmSurfaces, FilmValues, LastPiece, RAMP, SHORTEST, centroid, gap};
use crate::film_layer::extent;

/// Length of film with the resistance of the open fluid behind the end of a film between a plate and a wall, relative
/// to the gap, in Stokes flow. Source: runs with 10 and 20 cells across the film (`cargo xtask verify films`).
const OVER_WALL: f64 = 0.63;
/// The same for a film between plates that end at the same place, which is that of one side of a slit in a thin wall:
/// half of the pressure difference `32 μ q/(π δ²)` between the sides of a slit of width `δ` with the flux `q`, divided
/// by the gradient `12 μ q/δ³` in a film. Sources: Hasimoto 1958, DOI 10.1143/JPSJ.13.633, for the slit; Dagan,
/// Weinbaum, Pfeffer 1982, DOI 10.1017/S0022112082003255, for thick walls.
const SLIT: f64 = 16.0 / (12.0 * PI);
/// Share of this resistance that the discrete open fluid has at a gap as wide as a cell. Over a wall it is that of one
/// side of a slit as wide as a cell.
const ON_MESH: f64 = SLIT / OVER_WALL;
/// Smallest gradient of `N` along the film relative to the whole one for which it determines the direction to the edge
/// ([`FilmValues::extend_to_edges`]).
const LEAST_SLOPE: f64 = 0.2;
// Search for the edge, with lengths relative to the diameter of a cell: largest distance, length of a step, and
// smallest length of a step. If shorter steps would be needed, the film bends too much to have an edge.
const REACH: f64 = 2.0;
const STEP: f64 = 0.125;
const LEAST_STEP: f64 = 1e-3;
/// Cosine of the angle between the directions of two edges above which they enclose a corner: 75 degrees. Corners of
/// regular polygons with more than four sides, at most 72 degrees, are parts of a rounded edge.
const CORNER: f64 = 0.26;
/// Ratio of the gaps at two points of the search, one step apart, beyond which they are not in one film.
const WIDENS: f64 = 2.0;
/// Distance from a facet, relative to the diameter of a cell, below which it is taken as zero.
const NEGLIGIBLE: f64 = 1e-9;
/// Smallest difference of the values of a linear function at two vertices in [`fraction_of_simplex`], relative to the
/// largest value.
const SEPARATION: f64 = 1e-4;
/// Number of bisections of the step in which a film ends.
const HALVINGS: usize = 12;

impl<const D: usize> FilmValues<D> {
    /// Changes the conductance in the last parts of films that end at edges of their `surfaces`, and sets the pressure
    /// up to the edge ([`LastPiece`]). It precedes [`FilmValues::subtract_slip`].
    ///
    /// Problem: the pressure of a film falls to that of open fluid one cell before its edge, because dofs of the cell
    /// with the edge are in open fluid: a part without film has the pressure of open fluid at all of its dofs.
    /// Remedy: the conductance of the last parts, which have dofs in open fluid, is multiplied by
    ///
    /// `1/(F - ∂N/∂t ε)`, `F = Σ d_i ∂φ_i/∂t`,
    ///
    /// with which the flux across the edge is that of a pressure that falls linearly to that of open fluid behind the
    /// edge. The symbols are
    ///
    /// - `t`: unit vector along the film and across the edge, towards the film.
    /// - `F`: sum over the dofs of the film, with their shape functions `φ_i` and distances `d_i` from the edge. It is
    ///   the gradient of the discrete pressure, zero at dofs in open fluid, relative to that of the linear one.
    /// - `N`: sum of the shape functions of dofs in open fluid. The discrete pressure begins to fall where `N` is zero.
    /// - `ε = c δ (1 - 2/3 δ²/h²)`, at least zero: length of film with the resistance of the open fluid behind the
    ///   edge, for the gap `δ` and the extent `h` of the cell across the film. It is `c = 0.63` if one of two surfaces
    ///   ends, and 0.42 if both end at the same place. The second term is the resistance that the discrete open fluid
    ///   has already.
    ///
    /// Special cases:
    ///
    /// - If the discrete pressure does not fall to that of open fluid before the edge, the film covers only a fraction
    ///   of the length in which it falls. The conductance is also divided by the fraction.
    /// - A part with the edge in it conducts before the edge only.
    /// - At a corner, where edges in two directions enclose more than 75° and are both near, the lengths of both are
    ///   added. The pressure there is like the product of the distances from the edges, so that the mean flux across an
    ///   edge is half of that of a linear pressure.
    /// - A part with vertices in open fluid behind both ends of a short film has the length between the ends, with
    ///   twice `ε`.
    /// - A film that becomes thicker without an edge is not changed.
    ///
    /// The factor is at most 4. Dofs in open fluid also have the velocity of open fluid, so that only the share `1 - N`
    /// of the parabola that layers represent is there. The missing flux is therefore that of `d² + N (δ² - d²)` in
    /// place of `d²`.
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
            let on_mesh = ON_MESH * (film.gap / extent(simplex.points(), &film.normal)).powi(2);
            let exit = |edge: &Edge<D>| film.gap * edge.open_fluid * (1.0 - on_mesh).max(0.0);
            let (value, rises) = (in_open.iter().map(|&i| coordinates[i]).sum::<f64>(), gradient(&in_open));
            let shape = |x: &Point<D>| value + rises.dot(&(x - middle));
            let falls = along_film(rises);
            if falls.norm() > LEAST_SLOPE * rises.norm() {
                let Some(end) = edge(falls.normalize()) else { continue };
                let slope = falls.dot(&end.outwards);
                // Lengths relative to that in which the discrete pressure falls.
                let mut lengths = [value + slope * end.distance.max(0.0), slope * exit(&end)];
                let from_edge = |x: &Point<D>| end.distance - (x - middle).dot(&end.outwards);
                let share = |i: usize| -from_edge(&simplex.points()[i]) * parts.gradients(part)[i].dot(&end.outwards);
                let mut fall: f64 = (0..=D).filter(|i| !in_open.contains(i)).map(share).sum();
                let along_edge = falls - end.outwards * slope;
                let is_corner = |other: &Edge<D>| other.outwards.dot(&end.outwards) < CORNER && other.distance < size;
                if along_edge.norm() > LEAST_SLOPE * slope
                    && let Some(other) = edge(along_edge.normalize()).filter(is_corner)
                {
                    let slope = falls.dot(&other.outwards).max(0.0);
                    lengths[0] += slope * other.distance.max(0.0);
                    lengths[1] += slope * exit(&other);
                    fall = lengths[0];
                }
                let [ahead, exit] = lengths;
                let at_edge = simplex.barycentric(&(middle + end.outwards * end.distance));
                let ends_here = at_edge.is_some_and(|at| at[..=D].iter().all(|value| *value >= 0.0));
                let past_edge = |x: &Point<D>| -from_edge(x);
                let fraction = if ends_here { fraction_below_zero(background, cut, part, past_edge) } else { 1.0 };
                if ends_here || ahead >= 1.0 {
                    film.last_piece = LastPiece::new([ahead, exit], std::array::from_fn(|i| in_open.contains(&i)));
                }
                film.end_with((fall + exit) * ahead.clamp(SHORTEST, 1.0) / fraction.max(SHORTEST), shape);
                continue;
            }
            // A short film, with open fluid behind the edges on both sides.
            let slopes = (0..=D).map(|i| along_film(parts.gradients(part)[i]));
            let Some(along) = slopes.max_by(|a, b| a.norm().total_cmp(&b.norm())) else { continue };
            let along = along.normalize();
            let (Some(ahead), Some(behind)) = (edge(along), edge(-along)) else { continue };
            let halfway = 0.5 * (ahead.distance - behind.distance);
            let is_ahead = |i: &usize| (simplex.points()[*i] - middle).dot(&along) > halfway;
            if in_open.iter().any(is_ahead) && !in_open.iter().all(is_ahead) {
                let slope = along_film(gradient(&(0..=D).filter(is_ahead).collect::<Vec<_>>())).norm();
                let length = ahead.distance + behind.distance + exit(&ahead) + exit(&behind);
                film.end_with(slope * length, shape);
            }
        }
    }
}

impl<const D: usize> FilmValues<D> {
    /// Returns the parts of open fluid: those without film that are connected by faces and together have at least the
    /// volume of a cell. Fluid in a corner between two films is not open. Parts as small as round-off count: penalties
    /// on their faces tie their dofs to those of open fluid.
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
        let is_free = |part: &PartId| self.of(*part).is_none();
        let mut regions = Classes::new(fractions.len());
        for face in faces.iter().filter(|face| face.parts.iter().all(is_free)) {
            regions.merge(face.parts[0].0, face.parts[1].0);
        }
        let mut volumes = vec![0.0; fractions.len()];
        let free: Vec<_> = cut.all_parts().filter(is_free).collect();
        for part in &free {
            volumes[regions.lowest(part.0) as usize] += fractions[part.index()];
        }
        free.into_iter().filter(move |part| volumes[regions.lowest(part.0) as usize] >= 1.0)
    }
}

/// Returns the fraction of the volume of a part in which a linear function is below zero.
fn fraction_below_zero<const D: usize>(
    background: &SimplexMesh<D>,
    cut: &CutMesh<D>,
    part: PartId,
    function: impl Fn(&Point<D>) -> f64,
) -> f64 {
    let (mut below, mut whole) = (0.0, 0.0);
    cut.for_each_simplex(background, part, |points| {
        let volume = simplex_measure(points);
        whole += volume;
        below += volume * fraction_of_simplex(points.iter().map(&function).collect());
    });
    if whole > 0.0 { below / whole } else { 1.0 }
}

/// Returns the fraction of a simplex in which the linear function with given values at the vertices is below zero: the
/// sum of `v_i^D / Π_{j ≠ i} (v_i - v_j)` over negative values `v_i`. Values that are nearly equal are separated.
fn fraction_of_simplex(mut values: Vec<f64>) -> f64 {
    let scale = values.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
    values.sort_by(f64::total_cmp);
    for i in 1..values.len() {
        values[i] = values[i].max(values[i - 1] + SEPARATION * scale);
    }
    let factor = |i: usize| {
        let others = values.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, other)| values[i] / (values[i] - other)).product::<f64>()
    };
    let sum: f64 = (0..values.len()).filter(|&i| values[i] < 0.0).map(factor).sum();
    sum.clamp(0.0, 1.0)
}

/// The edge at which a film ends.
struct Edge<const D: usize> {
    /// Unit vector along the film, out of it and across the edge.
    outwards: Vector<D>,
    /// Distance of the edge from a point in the film, along this vector; negative past the edge.
    distance: f64,
    /// Length of film with the resistance of the open fluid behind the edge, relative to the gap.
    open_fluid: f64,
}

impl<const D: usize> FilmSurfaces<D> {
    /// Returns the edge at which the film ends in a direction from a point in it; `None` if there is none within two
    /// diameters of the cell. The facets `near` contain all within this distance.
    fn edge(&self, from: &Point<D>, along: &Vector<D>, size: f64, near: &[FacetId]) -> Option<Edge<D>> {
        let feet = |x: &Point<D>| self.feet(x, near).filter(|feet| gap(feet) < RAMP[1] * size);
        let (mut inside, mut step) = (*from, STEP * size);
        while (inside - from).dot(along) < REACH * size && step > LEAST_STEP * size {
            // To the middle between the surfaces, which may bend.
            let off = mean(&feet(&inside)?.map(|foot| foot.point)) - inside;
            let middle = inside + off - along * off.dot(along);
            if feet(&middle).is_some() {
                inside = middle;
            }
            // Behind an edge the next surface may be close enough for a film, which is another one.
            let widest = WIDENS * gap(&feet(&inside)?);
            let is_in_film = |x: &Point<D>| feet(x).is_some_and(|feet| gap(&feet) <= widest);
            let mut outside = inside + along * step;
            if is_in_film(&outside) {
                inside = outside;
                continue;
            }
            for _ in 0..HALVINGS {
                let half = mean(&[inside, outside]);
                *(if is_in_film(&half) { &mut inside } else { &mut outside }) = half;
            }
            // Past an edge, the closest point of its surface remains at the edge.
            let last = feet(&inside)?;
            let thickness: f64 = last.iter().map(|foot| (inside - foot.point).dot(&foot.normal)).sum();
            let past = |foot: &FilmFoot<D>| {
                let off = inside - foot.point;
                let across_edge = off - foot.normal * off.dot(&foot.normal);
                let (past, outwards) = (across_edge.norm(), across_edge.normalize());
                let is_past = past > 0.5 * thickness && outwards.dot(along) > FRONT;
                (is_past && !self.continues(foot, &outwards, size, near)).then_some((past, outwards))
            };
            let ends = [past(&last[0]), past(&last[1])];
            let open_fluid = if ends.iter().all(Option::is_some) { SLIT } else { OVER_WALL };
            if let Some((past, outwards)) = ends.into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0)) {
                return Some(Edge { distance: (inside - from).dot(&outwards) - past, outwards, open_fluid });
            }
            step *= 0.5;
        }
        None
    }

    /// Returns whether a point in front of a surface is past its edge, given its foot.
    pub(crate) fn is_past_edge(&self, x: &Point<D>, foot: &FilmFoot<D>, size: f64, near: &[FacetId]) -> bool {
        let off = x - foot.point;
        let along = off - foot.normal * off.dot(&foot.normal);
        let past = along.norm();
        past > NEGLIGIBLE * size && !self.continues(foot, &(along / past), size, near)
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

#[cfg(test)]
mod tests {
    use super::fraction_of_simplex;

    #[test]
    fn fractions_of_simplices_are_those_of_similar_simplices() {
        let cases: [(&[f64], f64); 11] = [
            (&[-1.0, 1.0, 1.0], 0.25),
            (&[-1.0, -1.0, 1.0], 0.75),
            (&[-1.0, 3.0, 3.0], 0.0625),
            (&[-1.0, 0.0, 1.0], 0.5),
            (&[-1.0, -2.0, -1.0], 1.0),
            (&[1.0, 2.0, 1.0], 0.0),
            (&[-1.0, 1.0, 1.0, 1.0], 0.125),
            (&[-1.0, -1.0, 1.0, 1.0], 0.5),
            (&[-1.0, -1.000001, -0.9999997, 1.0], 0.875),
            (&[-1.0, -1.0, -1.0, -1.0], 1.0),
            (&[-1.0, -1.000001, -1.000002], 1.0),
        ];
        for (values, fraction) in cases {
            let found = fraction_of_simplex(values.to_vec());
            assert!((found - fraction).abs() < 1e-3, "{values:?}: {found}");
        }
    }
}
