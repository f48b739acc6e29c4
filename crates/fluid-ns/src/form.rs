//! The weak form of the fluid: named terms.

use algebra::{Contributions, Integral};

use crate::terms::{
    BodyForce, Cavitation, CipPressure, CipVelocity, Convection, Film, GhostPenalty, Hoop, HoopConvection,
    Incompressibility, Inertia, Viscous,
};
use crate::{FluidCells, FluidFace, FluidFaces, FluidFields, FluidGeometry};

/// The terms of the fluid, in the order of Eq. (4) of the paper; a term that is not in the paper follows a similar one.
pub struct FluidForm<'a, const D: usize> {
    /// `ρ (a, v)`; `None` for a steady problem.
    pub inertia: Option<Inertia>,
    /// `a^f(u, v)`.
    pub viscous: Viscous,
    /// `b(p, v) - b(q, u)`.
    pub incompressibility: Incompressibility,
    /// Hoop parts of `a^f` and `b`; `None` in Cartesian coordinates.
    pub hoop: Option<Hoop>,
    /// `c(u, u, v)`; `None` for Stokes.
    pub convection: Option<Convection>,
    /// Hoop part of the skew convection; `None` in Cartesian coordinates and without the skew part.
    pub hoop_convection: Option<HoopConvection>,
    /// `(κ (∇p - f), ∇q)_Ω - (κ_s (∇p - f), ∇q)_Σ`; `None` if films are not modelled.
    pub film: Option<Film<'a, D>>,
    /// Vapour in films; `None` if the pressure in films has no floor.
    pub cavitation: Option<Cavitation>,
    /// `-(f, v)`; `None` for no force.
    pub body_force: Option<BodyForce<'a, D>>,
    /// Velocity part of `s_h`.
    pub cip_velocity: CipVelocity,
    /// Pressure part of `s_h`.
    pub cip_pressure: CipPressure,
    /// `g_h`.
    pub ghost_penalty: GhostPenalty,
}

impl<'a, const D: usize> FluidForm<'a, D> {
    /// Returns the weak form on the parts and faces of a step: linear cell terms, convection, face penalties,
    /// cavitation.
    pub fn contributions<'p>(
        &'p self,
        geometry: FluidGeometry<'p, D>,
        fields: FluidFields<'p>,
    ) -> Vec<Box<dyn Contributions + 'p>> {
        let mut linear = Integral::linear("fluid cells", FluidCells::new(geometry, fields), Vec::new());
        linear.extend(self.inertia.as_ref());
        linear.extend(Some(&self.viscous));
        linear.extend(Some(&self.incompressibility));
        linear.extend(self.hoop.as_ref());
        linear.extend(self.body_force.as_ref());
        linear.extend(self.film.as_ref());
        let mut convection = Integral::new("fluid convection", FluidCells::of_velocity(geometry, fields), Vec::new());
        convection.extend(self.convection.as_ref());
        convection.extend(self.hoop_convection.as_ref());
        let faces = FluidFaces::new(geometry, fields, |face| self.face_weights(face));
        let faces = faces.with_force(self.body_force.as_ref());
        let mut all: Vec<Box<dyn Contributions + 'p>> = vec![Box::new(linear), Box::new(convection), Box::new(faces)];
        if let Some(cavitation) = &self.cavitation {
            let cells = FluidCells::with_floor(geometry, fields, cavitation.floor);
            all.push(Box::new(Integral::new("cavitation", cells, vec![cavitation])));
        }
        all
    }

    /// Returns the weights of the penalties of velocity and pressure on a face.
    pub fn face_weights(&self, face: &FluidFace<'_, D>) -> [f64; 2] {
        [self.cip_velocity.weight(face) + self.ghost_penalty.weight(face), self.cip_pressure.weight(face)]
    }
}
