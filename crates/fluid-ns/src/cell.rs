//! Fluid parts with the local data that terms evaluate.

use algebra::{DofId, RegimeHash, Sites};
use cutcell::PartId;
use mesh::{MAX_CELL_VERTICES, Point, Tensor, Vector};
use xfem_space::{HoopMoments, Moments};

use crate::{FilmPart, FluidFields, FluidGeometry};

/// A fluid part with its local state. P1: gradients are constant on it.
///
/// Local unknowns: velocity component `a` of node `i` at row `D i + a`, then the pressures of the nodes.
pub struct FluidCell<'a, const D: usize> {
    /// Gradients of the shape functions; only the first `D + 1` are used.
    pub gradients: &'a [Vector<D>; MAX_CELL_VERTICES],
    /// Moments of the part.
    pub moments: &'a Moments,
    /// Radial component, and moments with the radius in the denominator; `None` in Cartesian coordinates.
    pub hoop: Option<(usize, &'a HoopMoments)>,
    /// Velocity `u` of each node at the stage; only the first `D + 1` are used, here and below.
    pub velocities: [Vector<D>; MAX_CELL_VERTICES],
    /// Acceleration `a` of each node at the stage.
    pub accelerations: [Vector<D>; MAX_CELL_VERTICES],
    /// Derivative of the acceleration of a node with respect to its velocity.
    pub acceleration_slope: f64,
    /// Pressure of each node.
    pub pressures: [f64; MAX_CELL_VERTICES],
    /// The film in the part, if there is one.
    pub film: Option<&'a FilmPart<D>>,
    /// The part.
    pub part: PartId,
    geometry: FluidGeometry<'a, D>,
}

impl<const D: usize> FluidCell<'_, D> {
    /// Returns the first row of the velocity of a node.
    #[inline]
    pub fn velocity_row(&self, node: usize) -> usize {
        D * node
    }

    /// Returns the row of the pressure of a node.
    #[inline]
    pub fn pressure_row(&self, node: usize) -> usize {
        D * (D + 1) + node
    }

    /// Returns the gradient of the velocity, `grad[(a, b)] = ∂u_a/∂x_b`.
    #[inline]
    pub fn grad_velocity(&self) -> Tensor<D> {
        // The compiler unrolls this; it does not unroll the `sum` of matrices or an inclusive range.
        (0..D + 1).fold(Tensor::zeros(), |sum, i| sum + self.velocities[i] * self.gradients[i].transpose())
    }

    /// Calls `visit` with position, weight and shape values of the points of a rule that is exact for the given degree.
    pub fn for_each_point(&self, degree: usize, visit: impl FnMut(&Point<D>, f64, &[f64; MAX_CELL_VERTICES])) {
        let FluidGeometry { background, cut, parts, .. } = self.geometry;
        parts.for_each_point(background, cut, self.part, degree, visit);
    }
}

/// The parts of a step: one item and one site per part.
#[derive(Clone, Copy)]
pub struct FluidCells<'a, const D: usize> {
    geometry: FluidGeometry<'a, D>,
    fields: FluidFields<'a>,
    with_pressure: bool,
    /// Floor of the pressure in films; `None` if no term depends on it.
    floor: Option<f64>,
}

impl<'a, const D: usize> FluidCells<'a, D> {
    /// Creates the sites of terms that couple velocity and pressure.
    pub fn new(geometry: FluidGeometry<'a, D>, fields: FluidFields<'a>) -> Self {
        Self { geometry, fields, with_pressure: true, floor: None }
    }

    /// Creates the sites of terms that couple velocities only. Their items have no rows of pressures, and their sites
    /// neither pressure nor acceleration.
    pub fn of_velocity(geometry: FluidGeometry<'a, D>, fields: FluidFields<'a>) -> Self {
        Self { geometry, fields, with_pressure: false, floor: None }
    }

    /// Creates the sites of [`crate::terms::Cavitation`] for a floor of the pressure. Their regime is the set of
    /// vertices of films with a pressure below the floor.
    pub fn with_floor(geometry: FluidGeometry<'a, D>, fields: FluidFields<'a>, floor: f64) -> Self {
        Self { floor: Some(floor), ..Self::new(geometry, fields) }
    }
}

impl<'a, const D: usize> Sites for FluidCells<'a, D> {
    type Site = FluidCell<'a, D>;

    fn len(&self) -> usize {
        self.geometry.cut.n_parts()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let dofs = self.geometry.space.dofs(PartId(item as u32));
        let FluidFields { layout, velocity, pressure } = self.fields;
        dofs.iter().for_each(|&dof| out.extend(layout.node(velocity, dof as usize)));
        if self.with_pressure {
            dofs.iter().for_each(|&dof| out.extend(layout.node(pressure, dof as usize)));
        }
    }

    #[inline]
    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        let FluidGeometry { space, parts, acceleration, .. } = self.geometry;
        let part = PartId(item as u32);
        let mut cell = FluidCell {
            gradients: parts.gradients(part),
            moments: parts.moments(part),
            hoop: parts.coordinates().radial().zip(parts.hoop(part)),
            velocities: [Vector::zeros(); MAX_CELL_VERTICES],
            accelerations: [Vector::zeros(); MAX_CELL_VERTICES],
            acceleration_slope: acceleration.slope,
            pressures: [0.0; MAX_CELL_VERTICES],
            film: self.geometry.films.and_then(|films| films.of(part)),
            geometry: self.geometry,
            part,
        };
        for (i, &dof) in space.dofs(part).iter().enumerate() {
            let v = self.fields.velocity_at(x, dof);
            cell.velocities[i] = v;
            if self.with_pressure {
                cell.accelerations[i] = acceleration.at(dof as usize, v);
                cell.pressures[i] = self.fields.pressure_at(x, dof);
            }
        }
        visit(&cell);
    }

    /// Returns the hash of the vertices of films whose pressure is below the floor; `None` without a floor.
    fn regime(&self, item: usize, x: &[f64]) -> Option<u64> {
        let (floor, films, part) = (self.floor?, self.geometry.films?, PartId(item as u32));
        let mut hash = RegimeHash::default();
        hash.extend([item as u64]);
        if films.of(part).is_some() {
            let dofs = self.geometry.space.dofs(part).iter();
            let below = dofs.filter(|dof| self.fields.pressure_at(x, **dof) < floor);
            hash.extend(below.map(|dof| u64::from(*dof)));
        }
        Some(hash.value())
    }
}
