//! Thin films between opposite surfaces: gaps, and the conductance of the flux that linear velocities do not represent.

use cutcell::{CutMesh, PartId};
use mesh::search::{Foot, SurfaceIndex};
use mesh::{
    Aabb, BoundaryMesh, FacetId, MAX_CELL_VERTICES, Placed, Point, SimplexMesh, Tag, Vector, VertexId, are_opposite,
    facet_normal, simplex_measure,
};
use xfem_space::PartValues;

use crate::film_layer::{Layers, extent};

/// A point is in front of a facet if the scalar product of the unit normal and the direction from the closest point of
/// the facet to the point is at least this value: they enclose less than 60 degrees.
pub(crate) const FRONT: f64 = 0.5;
/// Difference of distances that are taken as equal, relative to the largest coordinate of surfaces: a few roundings.
const SAME_DISTANCE: f64 = 16.0 * f64::EPSILON;
/// Gaps in extents of the cell across the film: up to the first the share `χ` is one, from the second on zero, linear
/// between. Two layers of cells carry 3/4 of the flux of a film, four layers 15/16.
pub(crate) const RAMP: [f64; 2] = [2.0, 4.0];
/// Largest fraction of the flux in a part that slip may carry. With the standard parameters it carries at most 0.69.
const LARGEST_SLIP: f64 = 0.75;
/// Largest thickness of a sliver relative to the gap.
const SLIVER: f64 = 1e-4;
/// Smallest length by which the conductance of the last part is divided, relative to that in which the discrete
/// pressure falls. The factors of this length have the same lower bound ([`FilmValues::extend_to_edges`]).
pub(crate) const SHORTEST: f64 = 0.25;
/// Factor of the component of gradients and forces across a film in its last part ([`FilmPart::acting`]).
const ACROSS: f64 = 0.1;
/// Degree of quadrature of the conductance: the square of a linear gap.
const DEGREE: usize = 2;

/// Surfaces between which films form, at fixed positions, with the fluid on the side of their normals.
#[derive(Clone, Debug)]
pub struct FilmSurfaces<const D: usize> {
    index: SurfaceIndex<D>,
    normals: Vec<Vector<D>>,
    /// Difference of distances that are taken as equal.
    rounding: f64,
}

impl<const D: usize> FilmSurfaces<D> {
    /// Collects the surfaces of bodies, and the facets of the background's boundary for whose tag `is_wall` returns
    /// true.
    pub fn new(bodies: &[Placed<'_, D>], background: &SimplexMesh<D>, is_wall: impl Fn(Option<Tag>) -> bool) -> Self {
        let (mut facets, mut positions, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        let mut push = |points: &[Point<D>], normal: Vector<D>| {
            // A facet without measure has no normal.
            if simplex_measure(points) > 0.0 {
                facets.extend((0..D).map(|k| VertexId::new(positions.len() + k)));
                positions.extend_from_slice(points);
                normals.push(normal);
            }
        };
        for body in bodies {
            for facet in body.boundary().facets() {
                let points = &body.facet_points(facet)[..D];
                push(points, facet_normal(points));
            }
        }
        for facet in background.facets().filter(|f| background.is_boundary(*f) && is_wall(background.facet_tag(*f))) {
            let points = &background.facet_points(facet)[..D];
            push(points, -facet_normal(points));
        }
        let rounding = SAME_DISTANCE * positions.iter().map(|x| x.amax()).fold(0.0, f64::max);
        let index = SurfaceIndex::new(&Placed::new(&BoundaryMesh::from_facets(facets), &positions));
        Self { index, normals, rounding }
    }

    /// Returns the vertices of a facet.
    pub(crate) fn facet_points(&self, facet: FacetId) -> [Point<D>; D] {
        let points = self.index.surface().facet_points(facet);
        std::array::from_fn(|k| points[k])
    }

    /// Returns the unit normal of a facet.
    pub(crate) fn normal(&self, facet: FacetId) -> &Vector<D> {
        &self.normals[facet.index()]
    }

    /// Collects the facets whose bounding boxes overlap a region, in place of the previous ones.
    pub(crate) fn facets_near(&self, region: &Aabb<D>, near: &mut Vec<FacetId>) {
        self.index.facets_overlapping(region, near);
    }

    /// Returns the feet of a point of the fluid on the closest facet and on the closest facet opposite to it; `None`
    /// without two opposite facets.
    ///
    /// Only the facets `near` are considered that have the point in front of them, so that a film ends near the edge of
    /// a surface.
    pub(crate) fn feet(&self, x: &Point<D>, near: &[FacetId]) -> Option<[FilmFoot<D>; 2]> {
        let surface = self.index.surface();
        let in_front = |facet: &FacetId| {
            let (foot, normal) = (Foot::on_facet(x, &surface.facet_points(*facet)[..D]), self.normals[facet.index()]);
            let distance = foot.squared_distance.sqrt();
            let is_in_front = (x - foot.point).dot(&normal) >= FRONT * distance;
            is_in_front.then_some(FilmFoot { point: foot.point, distance, normal })
        };
        let in_front: Vec<_> = near.iter().filter_map(in_front).collect();
        let is_closer = |a: &&FilmFoot<D>, b: &&FilmFoot<D>| a.distance.total_cmp(&b.distance);
        let least = in_front.iter().min_by(is_closer)?.distance;
        // At an edge of a body facets on both sides of it have the same foot.
        let nearest = least + self.rounding;
        let pairs = in_front.iter().filter(|foot| foot.distance <= nearest).filter_map(|here| {
            let facing = in_front.iter().filter(|foot| are_opposite(&foot.normal, &here.normal));
            Some([*here, *facing.min_by(is_closer)?])
        });
        pairs.min_by(|[_, a], [_, b]| a.distance.total_cmp(&b.distance))
    }
}

/// The point of a facet that is closest to a point in a film.
#[derive(Clone, Copy)]
pub(crate) struct FilmFoot<const D: usize> {
    pub(crate) point: Point<D>,
    pub(crate) distance: f64,
    /// Unit normal of the facet.
    pub(crate) normal: Vector<D>,
}

/// Returns the gap between two feet of a point: the sum of its distances.
pub(crate) fn gap<const D: usize>(feet: &[FilmFoot<D>; 2]) -> f64 {
    feet[0].distance + feet[1].distance
}

/// A film in a fluid part.
#[derive(Clone, Debug)]
pub struct FilmPart<const D: usize> {
    /// Share `χ` of the missing flux that is added, from 0 to 1.
    pub share: f64,
    /// Gap `δ` at the centroid of the part.
    pub gap: f64,
    /// Unit normal of the closest surface: the direction across the film.
    pub normal: Vector<D>,
    /// Thickness `d` of the layer of cells, that with the missing flux of linear interpolation; at most the extent of a
    /// cut part across the film, and the gap.
    pub layer: f64,
    /// Flux that the layers of the whole film represent, relative to the flux that they lack. With the height `k` of
    /// the asperities, at most the extent of the cell, it is `(max(δ, k)/max(d, k))² - 1`.
    pub represented: f64,
    /// Quadrature points in the part and on its surfaces. Their weights contain the conductance times the viscosity:
    /// `χ max(d, min(k, h))²/12` in the part and `-χ s ℓ d²/12` on surfaces, with the symbols of
    /// [`crate::terms::Film`], times a factor in the last part of a film that ends at an edge. The sum of the weights
    /// on surfaces is at most three quarters of the sum in the part.
    pub points: Vec<(Point<D>, f64)>,
    /// Whether the part is so thin relative to the gap that its own terms do not determine its pressure and velocity.
    pub is_sliver: bool,
    /// Whether the film ends at an edge, and some vertices of the part are in the open fluid behind it.
    pub at_edge: bool,
    /// The pressure between this part and the edge at which the film ends; `None` if it ends elsewhere.
    pub last_piece: Option<LastPiece>,
}

/// Additional pressure on surfaces along the last part of a film: the force of the film between this part and the edge
/// at which it ends.
///
/// Problem: the cell with the edge has the pressure of open fluid. The surface between the last part and the edge
/// therefore lacks the pressure of the film.
/// Remedy: the pressure in the last part, relative to that of open fluid, acts on the surfaces along the film with a
/// factor. The factor is the quotient of two integrals along the film up to the edge: of the exact pressure, and of the
/// discrete one.
///
/// The exact pressure, relative to open fluid, falls linearly to zero at the distance `ℓ + ε` from where the discrete
/// pressure begins to fall. The edge is at the distance `ℓ`, and `ε` is the length of film with the resistance of the
/// open fluid. The test functions of the fluid that bodies displace have the same factor.
#[derive(Clone, Copy, Debug)]
pub struct LastPiece {
    /// The factor minus one.
    excess: f64,
    /// Whether a vertex of the part is in open fluid.
    is_open: [bool; MAX_CELL_VERTICES],
    /// Pressures of fluid at rest in the vertices, up to a constant.
    at_rest: [f64; MAX_CELL_VERTICES],
}

impl LastPiece {
    /// Creates the pressure for the lengths `[ℓ, ε]`, relative to that in which the discrete pressure falls.
    pub(crate) fn new([length, exit]: [f64; 2], is_open: [bool; MAX_CELL_VERTICES]) -> Option<Self> {
        let within = length.min(1.0);
        let (exact, found) = (length * (0.5 * length + exit) / (length + exit), within * (1.0 - 0.5 * within));
        (within > 0.0).then_some(Self { excess: exact / found - 1.0, is_open, at_rest: [0.0; MAX_CELL_VERTICES] })
    }

    /// Returns the additional pressure on a surface and its derivatives with respect to the pressures of the vertices,
    /// given these pressures and the values of the shape functions. Derivatives sum to zero.
    pub fn pressure(&self, pressures: &[f64], shape: &[f64]) -> (f64, [f64; MAX_CELL_VERTICES]) {
        let n_open = self.is_open.iter().filter(|is_open| **is_open).count() as f64;
        let inside: f64 = shape.iter().zip(self.is_open).filter(|(_, is_open)| !is_open).map(|(value, _)| value).sum();
        let mut derivatives = [0.0; MAX_CELL_VERTICES];
        let mut pressure = 0.0;
        for (i, p) in pressures.iter().enumerate() {
            derivatives[i] = self.excess * if self.is_open[i] { -inside / n_open } else { shape[i] };
            pressure += derivatives[i] * (p - self.at_rest[i]);
        }
        (pressure, derivatives)
    }
}

impl<const D: usize> FilmPart<D> {
    /// Returns the part of a gradient or a force that drives a flux: the vector itself, or, in the last part of a film
    /// that ends at an edge, the vector with a tenth of its component across the film. There vertices on both sides of
    /// the film may have the pressure of open fluid; a tenth is enough to determine the pressure.
    #[inline]
    pub fn acting(&self, v: Vector<D>) -> Vector<D> {
        if self.at_edge { v - self.normal * ((1.0 - ACROSS) * v.dot(&self.normal)) } else { v }
    }

    /// Marks the part as the last one of a film, and divides its conductance by `length`, at least 1/4: the length up
    /// to the edge relative to that in which the discrete pressure falls. At a point, `open` returns the sum `N` of the
    /// shape functions of dofs in open fluid. These dofs have the velocity of open fluid, so that the share `N` of the
    /// flux that layers represent is missing, too, and added to the conductance.
    pub(crate) fn end_with(&mut self, length: f64, open: impl Fn(&Point<D>) -> f64) {
        self.at_edge = true;
        for (x, weight) in &mut self.points {
            *weight *= (1.0 + open(x) * self.represented) / length.max(SHORTEST);
        }
    }
}

/// The films of all parts of a cut.
///
/// One layer of linear cells represents the shear flow between two moving surfaces, but not the parabolic flow that a
/// pressure gradient drives between them. `N` layers carry the fraction `1 - 1/N²` of the parabolic flow. The missing
/// flux per thickness is `d²/(12 μ)` times the gradient, with the thickness `d` of a layer ([`FilmPart::layer`]).
#[derive(Clone, Debug, Default)]
pub struct FilmValues<const D: usize> {
    films: Vec<FilmPart<D>>,
    /// For each part its position in `films` plus one; zero for a part without film.
    of_part: Vec<u32>,
}

impl<const D: usize> FilmValues<D> {
    /// Finds the films of all parts of a cut. The `roughness` is the height `k` of the asperities of both surfaces
    /// together, a length. A thinner film has the conductance of this thickness, or of the extent of its cell across
    /// the film if that is less.
    pub fn new(
        background: &SimplexMesh<D>,
        cut: &CutMesh<D>,
        parts: &PartValues<D>,
        surfaces: &FilmSurfaces<D>,
        roughness: f64,
    ) -> Self {
        let mut values = Self { films: Vec::new(), of_part: vec![0; cut.n_parts()] };
        let (layers, mut near) = (Layers::new(background), Vec::new());
        for part in cut.all_parts() {
            let simplex = background.simplex(cut.part_cell(part));
            let reach = RAMP[1] * simplex.diameter();
            surfaces.facets_near(&Aabb::of_points(simplex.points()).expanded(reach), &mut near);
            let middle = centroid(background, cut, parts, part);
            let Some(feet) = surfaces.feet(&middle, &near) else { continue };
            if feet.iter().any(|foot| surfaces.is_past_edge(&middle, foot, simplex.diameter(), &near)) {
                continue;
            }
            let (gap, normal) = (gap(&feet), feet[0].normal);
            let height = extent(simplex.points(), &normal);
            let share = ((RAMP[1] * height - gap) / ((RAMP[1] - RAMP[0]) * height)).clamp(0.0, 1.0);
            if share <= 0.0 {
                continue;
            }
            let mut corners = Vec::new();
            if !cut.is_whole(part) {
                cut.for_each_simplex(background, part, |points| corners.extend_from_slice(points));
            }
            let layer = layers.thickness(cut.part_cell(part), &normal);
            let layer = if corners.is_empty() { layer } else { extent(&corners, &normal).min(layer) };
            let is_sliver = layer < SLIVER * gap;
            let asperities = roughness.min(height);
            let thinnest = layer.min(gap).max(asperities);
            let represented = if thinnest > 0.0 { (gap.max(asperities) / thinnest).powi(2) - 1.0 } else { 0.0 };
            let mut points = Vec::new();
            parts.for_each_point(background, cut, part, DEGREE, |x, weight, _| {
                let gap = surfaces.feet(x, &near).map_or(gap, |feet| self::gap(&feet));
                let thickness = gap.min(layer).max(asperities);
                points.push((*x, weight * share * thickness.powi(2) / 12.0));
            });
            values.films.push(FilmPart {
                share,
                gap,
                normal,
                layer: layer.min(gap),
                represented,
                points,
                is_sliver,
                at_edge: false,
                last_piece: None,
            });
            values.of_part[part.index()] = values.films.len() as u32;
        }
        values
    }

    /// Subtracts the flux of slip from the missing flux. A penalty imposes the velocity on surfaces of bodies, so that
    /// the velocity slips there and drives a part of the flux.
    ///
    /// A gradient `G` of the pressure loads the surface of a layer of thickness `d` with the shear stress `G d/2`. With
    /// the penalty `γ_t μ/ℓ` the velocity slips by `G d ℓ/(2 γ_t μ)`. The slip falls to zero across the layer, or the
    /// other surface has the same slip. In either case the flux for each surface is `G s ℓ d²/(12 μ)` with `s = 3/γ_t`.
    /// In a layer with one surface this is exact up to a factor `1/(1 - ℓ/(γ_t d))`, since the adjoint consistent term
    /// reduces the penalty by `μ/d`: 1.03 with `ℓ = d` and the standard set. The body's share of the traction is taken
    /// as zero (`α = 1`).
    ///
    /// `length` returns `ℓ` on an interface piece, given its index. Surfaces across the film, such as the edge of a
    /// plate, do not contribute. At most 3/4 of the flux in a part are subtracted; the rest stabilises the pressure.
    pub fn subtract_slip(
        &mut self,
        background: &SimplexMesh<D>,
        cut: &CutMesh<D>,
        s: f64,
        length: impl Fn(usize) -> f64,
    ) {
        let coordinates = background.coordinates();
        let mut on_surfaces = vec![Vec::new(); self.films.len()];
        for (item, piece) in cut.interface().iter().enumerate() {
            let Some(number) = self.position(piece.part) else { continue };
            let film = &self.films[number];
            let middle = mesh::mean(&piece.points[..D]);
            let along = piece.normal.dot(&film.normal).powi(2);
            let area = along * piece.measure * coordinates.weight(&middle);
            on_surfaces[number].push((middle, area * film.share * s * length(item) * film.layer.powi(2) / 12.0));
        }
        for (film, slips) in self.films.iter_mut().zip(on_surfaces) {
            let [inside, by_slip] = [&film.points, &slips].map(|of| of.iter().map(|(_, weight)| weight).sum::<f64>());
            let part = (LARGEST_SLIP * inside / by_slip).min(1.0);
            film.points.extend(slips.into_iter().map(|(x, weight)| (x, -part * weight)));
        }
    }

    /// Sets the pressures of fluid at rest under a body force in the last parts of films that end at edges. Differences
    /// of these pressures cause no additional pressure ([`LastPiece`]).
    pub fn set_rest(&mut self, background: &SimplexMesh<D>, cut: &CutMesh<D>, force: impl Fn(&Point<D>) -> Vector<D>) {
        for part in cut.all_parts() {
            let Some(last) = self.of_mut(part).and_then(|film| film.last_piece.as_mut()) else { continue };
            let simplex = background.simplex(cut.part_cell(part));
            let force = force(&simplex.centroid());
            let heads = simplex.points().iter().map(|x| force.dot(x));
            last.at_rest.iter_mut().zip(heads).for_each(|(at_rest, head)| *at_rest = head);
        }
    }

    /// Returns the film in a part, if there is one.
    #[inline]
    pub fn of(&self, part: PartId) -> Option<&FilmPart<D>> {
        self.position(part).map(|position| &self.films[position])
    }

    /// Returns the film in a part for changes, if there is one.
    pub(crate) fn of_mut(&mut self, part: PartId) -> Option<&mut FilmPart<D>> {
        self.position(part).map(|position| &mut self.films[position])
    }

    #[inline]
    fn position(&self, part: PartId) -> Option<usize> {
        (*self.of_part.get(part.index())? as usize).checked_sub(1)
    }
}

/// Returns the centroid of a part, or the mean of its corners if its moments are zero because its volume is negligible.
pub(crate) fn centroid<const D: usize>(
    background: &SimplexMesh<D>,
    cut: &CutMesh<D>,
    parts: &PartValues<D>,
    part: PartId,
) -> Point<D> {
    let (simplex, moments) = (background.simplex(cut.part_cell(part)), parts.moments(part));
    let volume = moments.volume();
    if volume <= 0.0 {
        let mut corners = Vec::new();
        cut.for_each_simplex(background, part, |points| corners.extend_from_slice(points));
        return if corners.is_empty() { simplex.centroid() } else { mesh::mean(&corners) };
    }
    simplex.points().iter().enumerate().map(|(i, x)| x * (moments.of(i) / volume)).sum()
}
