//! The weak form of a solid: its named terms.

use std::sync::Arc;

use algebra::{Integral, Term};
use mesh::{Vector, positive, require};

use crate::terms::{BodyForce, HoopWork, Inertia, InternalWork};
use crate::{Error, Material, SolidCells, SolidPoints};

/// The terms of elastodynamics on the cells of a body.
#[derive(Clone, Debug)]
pub struct SolidForm<const D: usize> {
    /// `(ρ a, w)`
    pub inertia: Inertia,
    /// `(P(F), ∇w)`
    pub internal_work: InternalWork<D>,
    /// Internal work in axisymmetric coordinates, instead of `internal_work`.
    pub hoop_work: HoopWork<D>,
    /// `-(ρ g, w)`
    pub body_force: BodyForce<D>,
}

impl<const D: usize> SolidForm<D> {
    /// Creates the form of a homogeneous body: density in the reference configuration, material, and body force per
    /// mass (an acceleration).
    ///
    /// # Errors
    /// [`Error::Parameter`]: density not positive, acceleration not finite.
    pub fn new(density: f64, material: impl Material<D> + 'static, gravity: Vector<D>) -> Result<Self, Error> {
        Self::of_groups(vec![(density, Arc::new(material))], gravity)
    }

    /// Creates the form of a body with density and material of each group of its cells
    /// ([`crate::SolidMesh::with_groups`]).
    ///
    /// # Errors
    /// [`Error::Parameter`]: a density not positive, acceleration not finite.
    pub fn of_groups(groups: Vec<(f64, Arc<dyn Material<D>>)>, gravity: Vector<D>) -> Result<Self, Error> {
        for &g in &gravity {
            require(g.is_finite(), "body force", g, "finite")?;
        }
        let densities =
            groups.iter().map(|(density, _)| positive("density", *density)).collect::<Result<Vec<_>, _>>()?;
        let materials: Vec<_> = groups.into_iter().map(|(_, material)| material).collect();
        Ok(Self {
            inertia: Inertia { densities: densities.clone() },
            internal_work: InternalWork { materials: materials.clone() },
            hoop_work: HoopWork { materials },
            body_force: BodyForce { densities, acceleration: gravity },
        })
    }

    /// Returns the material of a group of cells.
    pub(crate) fn material(&self, group: usize) -> &dyn Material<D> {
        self.internal_work.materials[group].as_ref()
    }

    /// Returns the inertia and body force: affine in velocity, assembled once per nonlinear solve.
    pub fn inertia_and_body_force<'a>(&'a self, cells: SolidCells<'a, D>) -> Integral<'a, SolidCells<'a, D>> {
        Integral::linear("solid inertia and body force", cells, vec![&self.inertia, &self.body_force])
    }

    /// Returns the internal work: nonlinear in velocity, unless the material is linear.
    pub fn internal_work<'a>(&'a self, cells: SolidCells<'a, D>) -> Integral<'a, SolidPoints<'a, D>> {
        let is_linear = self.internal_work.materials.iter().all(|material| material.is_linear());
        let integral = if is_linear { Integral::linear } else { Integral::new };
        let is_axisymmetric = cells.solid.mesh().coordinates().radial().is_some();
        let term: &dyn Term<_> = if is_axisymmetric { &self.hoop_work } else { &self.internal_work };
        integral("solid internal work", SolidPoints { cells }, vec![term])
    }
}
