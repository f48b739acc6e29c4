//! One step of a rigid body.

use algebra::{BlockLayout, Constraints, Contributions, DofId, FieldId, LocalSystem};
use mesh::{Point, Vector};

use crate::error::positive;
use crate::modes::{Spin, mode, n_modes, n_rotations};
use crate::terms::Momentum;
use crate::{Error, MassProperties, RigidMotion};

/// A rigid body in one step: its inertia, and where it is at the begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidStep<const D: usize> {
    begin: RigidMotion<D>,
    momentum: Momentum<D>,
}

impl<const D: usize> RigidStep<D> {
    /// The step of length `dt` after `begin`, with the acceleration `gravity`.
    ///
    /// # Errors
    /// [`Error::Parameter`]: step or mass not positive.
    pub fn new(mass: &MassProperties<D>, begin: &RigidMotion<D>, gravity: Vector<D>, dt: f64) -> Result<Self, Error> {
        positive("time step", dt)?;
        positive("mass", mass.mass)?;
        let momentum = Momentum {
            mass: mass.mass,
            inertia: mass.inertia(&begin.rotation),
            gravity,
            velocity: begin.velocity,
            angular_momentum: begin.angular_momentum,
            dt,
        };
        Ok(Self { begin: *begin, momentum })
    }

    /// Length of the step.
    pub fn dt(&self) -> f64 {
        self.momentum.dt
    }

    /// Centre of mass at the begin of the step, about which the body turns.
    pub fn centre(&self) -> Point<D> {
        self.begin.centre
    }

    /// Inertia about the centre at the begin of the step.
    pub fn inertia(&self) -> &[Spin; 3] {
        &self.momentum.inertia
    }

    /// Ties the velocities of points of the body to its unknowns, `v_i = V + ω × (x_i - c)`.
    ///
    /// Shapes: `positions`: those of the points at the begin of the step; field `velocities`: `D` dofs per point; field
    /// `unknowns`: translations, then rotations.
    ///
    /// # Errors
    /// [`Error::Length`]: a field does not have these dofs.
    pub fn tie(
        &self,
        positions: &[Point<D>],
        layout: &BlockLayout,
        velocities: FieldId,
        unknowns: FieldId,
        constraints: &mut Constraints,
    ) -> Result<(), Error> {
        length("field of velocities", layout.range(velocities).len(), D * positions.len())?;
        length("field of unknowns", layout.range(unknowns).len(), n_modes(D))?;
        for (i, x) in positions.iter().enumerate() {
            let arm = x - self.begin.centre;
            for a in 0..D {
                let terms = (0..n_modes(D)).map(|m| (layout.dof(unknowns, m), mode(m, &arm)[a]));
                let terms: Vec<(DofId, f64)> = terms.filter(|(_, factor)| *factor != 0.0).collect();
                constraints.tie(layout.dof(velocities, D * i + a), &terms);
            }
        }
        Ok(())
    }

    /// What the body itself adds to the system.
    ///
    /// # Errors
    /// [`Error::Length`]: the field does not have the dofs of a body.
    pub fn momentum(&self, layout: &BlockLayout, unknowns: FieldId) -> Result<RigidMomentum<D>, Error> {
        length("field of unknowns", layout.range(unknowns).len(), n_modes(D))?;
        Ok(RigidMomentum { term: self.momentum, first_dof: layout.range(unknowns).start })
    }

    /// The motion at the end of the step, from the unknowns (translations, then rotations).
    pub fn end(&self, unknowns: &[f64]) -> RigidMotion<D> {
        let mut spin = [0.0; 3];
        spin[..n_rotations(D)].copy_from_slice(&unknowns[D..n_modes(D)]);
        self.begin.after(self, Vector::from_column_slice(&unknowns[..D]), spin)
    }
}

/// The balance of momentum of one body, as a contribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMomentum<const D: usize> {
    term: Momentum<D>,
    first_dof: usize,
}

impl<const D: usize> Contributions for RigidMomentum<D> {
    fn len(&self) -> usize {
        1
    }

    fn dofs(&self, _item: usize, out: &mut Vec<DofId>) {
        out.extend((self.first_dof..self.first_dof + n_modes(D)).map(DofId::new));
    }

    fn add(&self, _item: usize, x: &[f64], out: &mut LocalSystem) {
        let unknowns = &x[self.first_dof..self.first_dof + n_modes(D)];
        self.term.add(&Vector::from_column_slice(&unknowns[..D]), &unknowns[D..], out);
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn name(&self) -> &'static str {
        "rigid body"
    }
}

fn length(what: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Length { what, found, expected }) }
}
