//! Faces between fluid parts with the local data that penalties evaluate.

use algebra::{Contributions, DofId, LocalSystem};
use cutcell::PartId;
use mesh::{Vector, mean};
use xfem_space::FaceValue;

use crate::terms::BodyForce;
use crate::{FilmValues, FluidFields, FluidGeometry};

/// A face with the known velocity on it.
pub struct FluidFace<'a, const D: usize> {
    /// Geometry and jumps.
    pub value: &'a FaceValue<D>,
    /// Largest `|u*·n|` over the vertices of the face.
    pub normal_speed: f64,
    /// Largest `|u*|` over the vertices of the face.
    pub speed: f64,
    /// Smaller share `χ` of the films in the two parts; zero if one of them has no film. The factor `1 - χ` reduces
    /// penalties, which otherwise suppress gradients of pressure and shear across a film of a few cells. Zero also
    /// between a sliver of a film and a thicker part of it: the penalties extend pressure and velocity to slivers.
    pub film: f64,
    /// The same for the penalty of the pressure. Where a film ends at an edge it is the larger share: the gradient of
    /// the pressure ends there, too.
    pub film_of_pressure: f64,
}

impl<'a, const D: usize> FluidFace<'a, D> {
    /// Creates a face from the known velocity, one value per dof of the space, and the films in its parts.
    pub fn new(value: &'a FaceValue<D>, known_velocity: &[Vector<D>], films: Option<&FilmValues<D>>) -> Self {
        let of = |part: &PartId| films.and_then(|films| films.of(*part));
        let share = |part: &PartId| of(part).map_or(0.0, |film| film.share);
        let is_sliver = |part: &PartId| of(part).is_some_and(|film| film.is_sliver);
        let [film, film_of_pressure] = if is_sliver(&value.parts[0]) == is_sliver(&value.parts[1]) {
            let least = value.parts.iter().map(share).fold(1.0, f64::min);
            let at_edge = value.parts.iter().filter_map(of).filter(|film| film.at_edge);
            [least, at_edge.map(|film| film.share).fold(least, f64::max)]
        } else {
            [0.0; 2]
        };
        let mut face = Self { value, normal_speed: 0.0, speed: 0.0, film, film_of_pressure };
        for &dof in value.face_dofs() {
            let u = known_velocity[dof as usize];
            face.normal_speed = face.normal_speed.max(u.dot(&value.normal).abs());
            face.speed = face.speed.max(u.norm());
        }
        face
    }
}

/// The face penalties `c_F ([∇φ]n, [∇ψ]n)_F` of all components of velocity and pressure.
///
/// One item per face and component (velocity components, then pressure), so that the pattern holds no couplings that
/// are always zero.
///
/// On a plane of symmetry the jump of the pressure is that of `∇p - f` with the body force `f`, since `∂p/∂n = f·n` in
/// fluid at rest there. It is zero for fluid that rests on the plane, and differs from that of `∇p` only if the force
/// is not symmetric. Other faces have the jump of `∇p` alone, which is right for forces without jumps.
pub struct FluidFaces<'a, const D: usize> {
    fields: FluidFields<'a>,
    geometry: FluidGeometry<'a, D>,
    /// Weights of velocity and pressure, with the measure of the face.
    weights: Vec<[f64; 2]>,
    /// Jump `2 f·n` of the body force on each face of a plane of symmetry, zero on others; empty without a force.
    jumps_of_force: Vec<f64>,
}

impl<'a, const D: usize> FluidFaces<'a, D> {
    /// Evaluates the weights `c_F` of velocity and pressure on all faces.
    pub fn new(
        geometry: FluidGeometry<'a, D>,
        fields: FluidFields<'a>,
        weights: impl Fn(&FluidFace<'_, D>) -> [f64; 2],
    ) -> Self {
        let weights = |value: &FaceValue<D>| {
            let face = FluidFace::new(value, geometry.known_velocity, geometry.films);
            weights(&face).map(|weight| weight * value.weight * value.share)
        };
        let weights = geometry.faces.iter().map(weights).collect();
        Self { fields, geometry, weights, jumps_of_force: Vec::new() }
    }

    /// Sets the body force, which acts in the jumps of the pressure on planes of symmetry.
    pub fn with_force(mut self, force: Option<&BodyForce<'_, D>>) -> Self {
        let Some(force) = force else { return self };
        self.jumps_of_force =
            self.geometry.faces.iter().map(|value| jump_of_force(self.geometry, value, force)).collect();
        self
    }
}

impl<const D: usize> FluidFaces<'_, D> {
    /// Returns the normal of a face on a plane of symmetry that is not along an axis. The first item of such a face has
    /// all components of the velocity, the others have none.
    fn oblique(&self, face: usize) -> Option<Vector<D>> {
        self.geometry.faces[face].odd.filter(|normal| normal.amax() < 1.0)
    }

    /// Adds the penalty `c_F ([∇u]n, [∇v]n)_F` of the components along an oblique plane of symmetry.
    fn add_oblique(&self, face: usize, x: &[f64], out: &mut LocalSystem) {
        let value = &self.geometry.faces[face];
        let weight = value.along_plane() * self.weights[face][0];
        let terms = || (0..).step_by(D).zip(value.dofs().iter().zip(value.jumps()));
        let jump: Vector<D> = terms().map(|(_, (dof, j))| self.fields.velocity_at::<D>(x, *dof) * *j).sum();
        let residual = weight * jump;
        for (row, (_, test)) in terms() {
            out.add_vector::<D>(row, residual * *test);
            if !out.has_tangent() {
                continue;
            }
            terms().for_each(|(column, (_, trial))| out.add_block::<D, D>(row, column, weight * (test * trial)));
        }
    }
}

impl<const D: usize> Contributions for FluidFaces<'_, D> {
    fn name(&self) -> &'static str {
        "fluid faces"
    }

    fn len(&self) -> usize {
        self.weights.len() * (D + 1)
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let (face, component) = (item / (D + 1), item % (D + 1));
        let FluidFields { layout, velocity, pressure } = self.fields;
        if component < D && self.oblique(face).is_some() {
            if component == 0 {
                let dofs = self.geometry.faces[face].dofs().iter();
                out.extend(dofs.flat_map(|&dof| layout.node(velocity, dof as usize)));
            }
            return;
        }
        let (field, component) = if component < D { (velocity, component) } else { (pressure, 0) };
        let dofs = self.geometry.faces[face].dofs();
        out.extend(dofs.iter().map(|&dof| layout.dof(field, dof as usize, component)));
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let (face, component) = (item / (D + 1), item % (D + 1));
        let value = &self.geometry.faces[face];
        if component < D && self.oblique(face).is_some() {
            if component == 0 {
                self.add_oblique(face, x, out);
            }
            return;
        }
        if component < D && value.odd.is_some_and(|normal| normal.iamax() == component) {
            return;
        }
        let weight = self.weights[face][usize::from(component == D)];
        if weight == 0.0 {
            return;
        }
        let of_force = self.jumps_of_force.get(face).filter(|_| component == D);
        let mut jump = -of_force.copied().unwrap_or(0.0);
        for (&dof, j) in value.dofs().iter().zip(value.jumps()) {
            jump += j * if component < D {
                self.fields.velocity_at::<D>(x, dof)[component]
            } else {
                self.fields.pressure_at(x, dof)
            };
        }
        for (i, j_i) in value.jumps().iter().enumerate() {
            out.add(i, weight * jump * j_i);
        }
        if !out.has_tangent() {
            return;
        }
        for (k, j_k) in value.jumps().iter().enumerate() {
            let rows = out.column_mut(k).iter_mut().zip(value.jumps());
            rows.for_each(|(row, j_i)| *row += weight * j_k * j_i);
        }
    }

    fn is_linear(&self) -> bool {
        true
    }
}

/// Returns the jump `2 f·n` of a body force on a face of a plane of symmetry; zero on other faces.
fn jump_of_force<const D: usize>(
    geometry: FluidGeometry<'_, D>,
    value: &FaceValue<D>,
    force: &BodyForce<'_, D>,
) -> f64 {
    let middle = || mean(&geometry.background.facet_points(value.facet)[..D]);
    value.odd.map_or(0.0, |_| 2.0 * (force.force)(&middle(), force.time).dot(&value.normal))
}

/// Returns the powers of [`FluidFaces`] at the state `x` for three weights `c_F`: `Σ c_F |[∇u]n|²_F` for the first two,
/// and `Σ c_F ([∇p - f]n, [∇p]n)_F` for the last one. The jumps are evaluated once for all weights.
pub fn face_powers<const D: usize>(
    geometry: FluidGeometry<'_, D>,
    fields: FluidFields<'_>,
    force: Option<&BodyForce<'_, D>>,
    x: &[f64],
    weights: impl Fn(&FluidFace<'_, D>) -> [f64; 3],
) -> [f64; 3] {
    let mut powers = [0.0; 3];
    for value in geometry.faces {
        let (mut of_velocity, mut of_pressure) = (Vector::<D>::zeros(), 0.0);
        for (&dof, jump) in value.dofs().iter().zip(value.jumps()) {
            of_velocity += fields.velocity_at::<D>(x, dof) * *jump;
            of_pressure += fields.pressure_at(x, dof) * jump;
        }
        let along = of_velocity.dot(&(value.along_plane() * of_velocity));
        let of_force = force.map_or(0.0, |force| jump_of_force(geometry, value, force));
        let products = [along, along, of_pressure * (of_pressure - of_force)];
        let weights = weights(&FluidFace::new(value, geometry.known_velocity, geometry.films));
        for ((power, weight), product) in powers.iter_mut().zip(weights).zip(products) {
            *power += weight * value.weight * value.share * product;
        }
    }
    powers
}
