//! Quantities of one body after a step, for histories and summaries.

use contact::ContactReport;
use cutcell::InterfacePiece;
use mesh::{BodyId, Placed, Point, Vector, mean};
use solid_rigid::modes::{Spin, nearest_spin};
use solver::interface_dg::InterfaceTraction;
use solver::{BodyReport, Contact, Setup, StepReport, StepView};

/// One body after a step. The last axis is vertical.
///
/// Quantities are in the units of the scenario. In 2D Cartesian coordinates forces, powers and volumes are per unit
/// depth; in axisymmetric coordinates they are those of the whole body.
pub(crate) struct BodyMeasures<'a, const D: usize> {
    pub(crate) view: &'a StepView<'a, D>,
    pub(crate) step: &'a StepReport<D>,
    /// Index of the body in the setup.
    pub(crate) index: usize,
    /// Positions of the vertices at the end of the step.
    positions: Vec<Point<D>>,
    /// See [`distance`].
    pub(crate) distance: f64,
    /// Centre of mass, or of the enclosed volume if the motion is prescribed.
    pub(crate) centre: Point<D>,
    /// Velocity of the centre.
    pub(crate) centre_velocity: Vector<D>,
    /// Contact force on the body, as slave and as master.
    pub(crate) contact_force: Vector<D>,
    /// Power of contact on the body, as slave and as master, at the stage of the step.
    pub(crate) contact_power: f64,
    /// Angle by which the vertices are rotated about their mean in the plane of the first two axes, from -π to π, and
    /// their angular velocity there.
    pub(crate) rotation: [f64; 2],
    /// Angular velocity of the vertices about their mean.
    pub(crate) spin: Spin,
    /// Force of the fluid on the body: integral of [`InterfaceTraction::total`], `T^f n + (1 - α) (T^s - T^f) n +
    /// S (u - v)` with `n` out of the body, on the geometry of the step. It is the residual of the discrete equations
    /// of the fluid tested with unit translations.
    pub(crate) fluid_force: Vector<D>,
    /// Integral of the fluid's traction `T^f n` alone. The difference to `fluid_force` vanishes with mesh refinement.
    pub(crate) traction_force: Vector<D>,
    /// Torque of the total traction about the centre of the enclosed volume. In 2D only the third component is not
    /// zero.
    pub(crate) torque: [f64; 3],
}

impl<'a, const D: usize> BodyMeasures<'a, D> {
    /// Returns the measures of the body with an index in the setup, or `None` before the first step. `bottom` is the
    /// height of the lowest vertex of the background.
    pub(crate) fn new(view: &'a StepView<'a, D>, index: usize, bottom: f64) -> Option<Self> {
        let step = view.report?;
        let (body, now) = (&view.setup.bodies[index], &view.state.bodies[index]);
        let positions = now.positions(body.reference());
        let (centre, centre_velocity) = match &step.bodies[index].balance {
            Some(balance) => (balance.centre_of_mass, balance.momentum / balance.mass),
            None => {
                let centre = Placed::new(body.surface(), &positions).enclosed().centre;
                let velocity = body.given_velocity(&centre, view.state.time);
                (centre, velocity.unwrap_or(Vector::repeat(f64::NAN)))
            }
        };
        let (mut contact_force, mut contact_power) = (Vector::zeros(), 0.0);
        for (contact, found) in view.setup.contacts.iter().zip(&step.contacts) {
            if contact.body().index() == index {
                contact_force += found.force;
                contact_power += found.powers[0];
            }
            if contact.master().is_some_and(|master| master.index() == index) {
                contact_force -= found.force;
                contact_power += found.powers[1];
            }
        }
        let mut measures = Self {
            distance: distance(view, index, bottom)?,
            rotation: rotation(body.reference(), &positions, now.velocity()),
            spin: nearest_spin(&positions, now.velocity()),
            view,
            step,
            index,
            positions,
            centre,
            centre_velocity,
            contact_force,
            contact_power,
            fluid_force: Vector::zeros(),
            traction_force: Vector::zeros(),
            torque: [0.0; 3],
        };
        if let Some(fluid) = &view.state.fluid {
            let centre = Placed::new(body.surface(), &fluid.positions[index]).enclosed().centre;
            for (_, traction) in pieces(view, step, index) {
                measures.fluid_force += traction.total() * traction.measure;
                measures.traction_force += traction.fluid * traction.measure;
                for (sum, moment) in measures.torque.iter_mut().zip(traction.moment(&centre)) {
                    *sum += moment * traction.measure;
                }
            }
            let coordinates = body.surface().coordinates();
            measures.fluid_force = coordinates.resultant(measures.fluid_force);
            measures.traction_force = coordinates.resultant(measures.traction_force);
            measures.torque = coordinates.moment(measures.torque);
        }
        Some(measures)
    }

    /// Returns the report of the step on the body.
    pub(crate) fn body(&self) -> &'a BodyReport<D> {
        &self.step.bodies[self.index]
    }

    /// Returns the vertical extent at the end of the step.
    pub(crate) fn height(&self) -> f64 {
        self.body().highest - self.body().lowest.1[D - 1]
    }

    /// Returns the contacts of the body, as slave or as master.
    pub(crate) fn contacts(&self) -> impl Iterator<Item = &'a ContactReport<D>> {
        let contacts = self.view.setup.contacts.iter().zip(&self.step.contacts);
        contacts.filter(|(contact, _)| acts_on(contact, self.index)).map(|(_, found)| found)
    }

    /// Returns the largest penetration `[ε - Δ]₊` over all contacts of the body.
    pub(crate) fn penetration(&self) -> f64 {
        self.contacts().map(|contact| contact.largest_penetration).fold(0.0, f64::max)
    }

    /// Returns the number of quadrature points in contact.
    pub(crate) fn active_points(&self) -> usize {
        self.contacts().map(|contact| contact.n_active).sum()
    }

    /// Returns the volume of the body (2D: area).
    pub(crate) fn volume(&self) -> f64 {
        Placed::new(self.view.setup.bodies[self.index].surface(), &self.positions).enclosed().volume
    }

    /// Returns the power of the fluid on the body: the sum over the pieces of the interface of the mean total traction
    /// times the velocity of the body in the middle of the piece, both at the stage of the step.
    pub(crate) fn fluid_power(&self) -> f64 {
        let boundary = self.view.setup.bodies[self.index].surface();
        let alpha = self.view.previous.step_time(self.view.setup, self.step.substep.dt).weights.alpha_f;
        let [begin, end] = [self.view.previous, self.view.state].map(|state| state.bodies[self.index].velocity());
        let at_stage = |vertex: usize| end[vertex] * (1.0 - alpha) + begin[vertex] * alpha;
        let power = pieces(self.view, self.step, self.index).map(|(piece, traction)| {
            let share = |vertex: usize| (0..D).map(|k| piece.barycentric[k][vertex]).sum::<f64>() / D as f64;
            let vertices = boundary.facet(piece.facet).iter().enumerate();
            let velocity = vertices.map(|(k, v)| at_stage(v.index()) * share(k)).sum::<Vector<D>>();
            traction.measure * traction.total().dot(&velocity)
        });
        power.sum()
    }
}

/// Returns the pieces of the interface on the body with index `index`, and their tractions; none without a fluid.
pub(crate) fn pieces<'a, const D: usize>(
    view: &StepView<'a, D>,
    step: &'a StepReport<D>,
    index: usize,
) -> impl Iterator<Item = (&'a InterfacePiece<D>, &'a InterfaceTraction<D>)> {
    let cut = view.state.fluid.iter().flat_map(|fluid| fluid.cut.interface());
    let tractions = step.fluid.iter().flat_map(|fluid| &fluid.tractions);
    cut.zip(tractions).filter(move |(piece, _)| piece.body.index() == index)
}

/// Returns whether a body is the slave or the master of a contact.
pub(crate) fn acts_on<const D: usize>(contact: &Contact<D>, index: usize) -> bool {
    let master = contact.master().map(BodyId::index);
    contact.body().index() == index || master == Some(index)
}

/// Returns the smallest gap of the contacts in which a body is slave or master. If none of them has a gap, returns the
/// height of the lowest vertex of the body above `bottom`. Returns `None` before the first step.
pub fn distance<const D: usize>(view: &StepView<'_, D>, index: usize, bottom: f64) -> Option<f64> {
    let report = view.report?;
    let contacts = view.setup.contacts.iter().zip(&report.contacts);
    let gaps = contacts.filter(|(contact, _)| acts_on(contact, index)).filter_map(|(_, found)| found.minimum_gap);
    Some(gaps.reduce(f64::min).unwrap_or_else(|| report.bodies[index].lowest.1[D - 1] - bottom))
}

/// Returns the leading body, of which summaries and progress report distance and contact: the slave of the first
/// contact, else the first movable body, else the first body.
pub fn leading_body<const D: usize>(setup: &Setup<D>) -> Option<usize> {
    let slave = setup.contacts.first().map(|contact| contact.body().index());
    let movable = || setup.bodies.iter().position(|body| body.is_movable());
    slave.or_else(movable).or((!setup.bodies.is_empty()).then_some(0))
}

/// Returns the angle, from -π to π, and the angular velocity of the rotation of points about their mean that is nearest
/// to their motion. It is in the plane of the first two axes, positive from the first to the second axis.
fn rotation<const D: usize>(reference: &[Point<D>], now: &[Point<D>], velocity: &[Vector<D>]) -> [f64; 2] {
    let (before, after, drift) = (mean(reference), mean(now), mean(velocity));
    let (mut along, mut across, mut swept, mut square) = (0.0, 0.0, 0.0, 0.0);
    for ((x, y), v) in reference.iter().zip(now).zip(velocity) {
        let (r, s, v) = (x - before, y - after, v - drift);
        along += r[0] * s[0] + r[1] * s[1];
        across += r[0] * s[1] - r[1] * s[0];
        swept += s[0] * v[1] - s[1] * v[0];
        square += s[0] * s[0] + s[1] * s[1];
    }
    [across.atan2(along), swept / square]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_is_found_with_its_rate() {
        let reference = [[0.0, 0.0], [2.0, 0.0], [0.5, 1.0]].map(Point::<2>::from);
        let (angle, rate) = (2.0_f64, -1.5);
        let turned = |x: &Point<2>| {
            Point::<2>::new(3.0 + x[0] * angle.cos() - x[1] * angle.sin(), x[0] * angle.sin() + x[1] * angle.cos())
        };
        let now = reference.each_ref().map(turned);
        let velocity = now.map(|x| Vector::<2>::new(4.0 - rate * x[1], rate * x[0]));
        let [found, found_rate] = rotation(&reference, &now, &velocity);
        assert!((found - angle).abs() < 1e-14 && (found_rate - rate).abs() < 1e-13);
    }
}
