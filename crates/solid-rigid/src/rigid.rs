//! Rigid bodies.

use algebra::time::{Affine, Level, Row};
use algebra::{BlockLayout, Constraints, Contributions, DofId, FieldId, Integral};
use body::{Balance, Body, BodyState, BodyStep, StepTime, SurfaceMotion, SurfaceVelocity, VectorInTime};
use mesh::{BoundaryMesh, Placed, Point, Vector};

use crate::centre::RigidCentre;
use crate::modes::{Spin, mode, n_modes, spin_velocity};
use crate::terms::{Momentum, VariableGravity};
use crate::{Error, MassProperties, RigidMotion};

/// Relative difference below which two times are treated as equal.
const ROUND_OFF: f64 = 1e-9;

/// A given velocity of the centre, without rotation, until a body is released.
#[derive(Clone)]
pub struct Guide<const D: usize> {
    /// Time of the release. The guide prescribes the velocity at the end of every step that begins earlier.
    pub until: f64,
    /// Velocity at a time.
    pub velocity: VectorInTime<D>,
}

impl<const D: usize> Guide<D> {
    /// Returns whether the guide prescribes the motion in a step that begins at `start`.
    fn acts_from(&self, start: f64) -> bool {
        start < self.until * (1.0 - ROUND_OFF)
    }
}

/// A body that moves without deforming. Translations along axes and the rotation may be held, and a [`Guide`] may
/// prescribe the motion up to a time.
///
/// [`BodyState::inner`] contains the numbers of [`RigidMotion::to_numbers`].
pub struct RigidBody<const D: usize> {
    /// Name.
    pub name: String,
    /// The surface.
    pub boundary: BoundaryMesh<D>,
    /// Reference positions of the vertices of the surface.
    pub reference: Vec<Point<D>>,
    /// Mass, centre and second moment.
    pub mass: MassProperties<D>,
    /// Acceleration of gravity.
    pub gravity: Vector<D>,
    /// Gravity that varies in time, in addition to the constant one; `None`: zero.
    pub variable_gravity: Option<VectorInTime<D>>,
    /// Axes along which the centre is held.
    pub held_axes: [bool; D],
    /// Whether rotation is held.
    pub holds_rotation: bool,
    /// Given motion until the release of the body; `None` if it is free from the start.
    pub guide: Option<Guide<D>>,
    /// Velocity of the centre at the start.
    pub initial_velocity: Vector<D>,
    /// Spin at the start, rad/time.
    pub initial_spin: Spin,
}

impl<const D: usize> RigidBody<D> {
    /// Creates a body at rest without supports, of uniform density inside its surface.
    ///
    /// # Errors
    /// [`Error::Parameter`]: density not positive. [`Error::Volume`]: the surface does not enclose a positive volume.
    pub fn new(
        name: &str,
        boundary: BoundaryMesh<D>,
        reference: Vec<Point<D>>,
        density: f64,
        gravity: Vector<D>,
    ) -> Result<Self, Error> {
        let mass = MassProperties::of_surface(&Placed::new(&boundary, &reference), density)?;
        Ok(Self {
            name: name.to_owned(),
            boundary,
            reference,
            mass,
            gravity,
            variable_gravity: None,
            held_axes: [false; D],
            holds_rotation: false,
            guide: None,
            initial_velocity: Vector::zeros(),
            initial_spin: [0.0; 3],
        })
    }

    /// Returns the motion of the body in a state.
    pub fn motion(&self, state: &BodyState<D>) -> RigidMotion<D> {
        RigidMotion::from_numbers(&state.inner)
    }

    /// Returns whether a rigid mode is held. With rotational symmetry only the translation along the axis can be free.
    fn holds(&self, mode: usize) -> bool {
        let axial = self.boundary.coordinates().radial().map(|radial| mode < D && mode != radial);
        axial == Some(false) || self.held_axes.get(mode).copied().unwrap_or(self.holds_rotation)
    }

    /// Returns the positions of the vertices that a row of a time scheme gives for a spin and zero velocity at the
    /// stage.
    fn positions_by(&self, motion: &RigidMotion<D>, row: &Row, spin: &Spin) -> Vec<Point<D>> {
        let (centre, rotation) = motion.placed(row, &Vector::zeros(), spin);
        let placed = RigidMotion { centre, rotation, ..*motion };
        self.reference.iter().map(|x| placed.position(&self.mass, x)).collect()
    }

    /// Returns the state of a motion. The list of accelerations is empty unless `with_accelerations`.
    fn state(&self, motion: &RigidMotion<D>, with_accelerations: bool) -> BodyState<D> {
        let at: Vec<Point<D>> = self.reference.iter().map(|x| motion.position(&self.mass, x)).collect();
        let level = Level {
            displacement: at.iter().zip(&self.reference).map(|(x, reference)| x - reference).collect(),
            velocity: at.iter().map(|x| motion.velocity_at(x)).collect(),
            acceleration: at.iter().filter(|_| with_accelerations).map(|x| motion.acceleration_at(x)).collect(),
        };
        BodyState { inner: motion.to_numbers(), level }
    }
}

impl<const D: usize> Body<D> for RigidBody<D> {
    fn name(&self) -> &str {
        &self.name
    }

    fn surface(&self) -> &BoundaryMesh<D> {
        &self.boundary
    }

    fn reference(&self) -> &[Point<D>] {
        &self.reference
    }

    fn is_movable(&self) -> bool {
        (0..n_modes(D)).any(|m| !self.holds(m))
    }

    fn initial(&self) -> BodyState<D> {
        self.state(&RigidMotion::initial(&self.mass, self.initial_velocity, self.initial_spin), false)
    }

    fn geometry(&self, start: &BodyState<D>, time: &StepTime) -> Vec<Point<D>> {
        let row = &time.weights.extrapolated[0];
        if row.velocity == 0.0 {
            return start.positions(&self.reference);
        }
        self.positions_by(&self.motion(start), row, &[0.0; 3])
    }

    fn step<'s>(
        &'s self,
        start: &'s BodyState<D>,
        time: &StepTime,
        layout: &mut BlockLayout,
    ) -> Box<dyn BodyStep<D> + 's> {
        let motion = self.motion(start);
        let momentum = motion.momentum(&self.mass, self.gravity, &time.weights);
        let vertices = layout.push(&self.name, self.reference.len(), D);
        let whole = layout.push(&format!("{} as a whole", self.name), 1, n_modes(D));
        let geometry = self.geometry(start, time);
        let centre = motion.placed(&time.weights.extrapolated[0], &Vector::zeros(), &[0.0; 3]).0;
        let largest =
            |of: fn(&Vector<D>) -> f64, from: Point<D>| geometry.iter().map(|x| of(&(x - from))).fold(0.0, f64::max);
        let rounding = time.rounding(largest(Vector::amax, Point::zeros()));
        layout.set_rounding(vertices, &[rounding; D]);
        let turning = rounding / largest(Vector::norm, centre);
        let of_modes = (0..n_modes(D)).map(|mode| if mode < D { rounding } else { turning });
        layout.set_rounding(whole, &of_modes.collect::<Vec<_>>());
        let [shifted, end] = &time.weights.shifted;
        // Positions at the end are linearised about the spin at the start. Without inertia the spin at the start does
        // not approximate that of the step, and zero is used.
        let has_inertia = time.weights.has_inertia();
        let spin = if has_inertia { motion.spin } else { [0.0; 3] };
        let velocities = geometry.iter().map(|x| spin_velocity(&spin, &(x - centre)));
        let at_end = self.positions_by(&motion, end, &spin);
        let predicted = at_end.iter().zip(velocities).map(|(x, v)| x - v * end.slope).collect();
        let surface = SurfaceMotion {
            boundary: &self.boundary,
            start: self.positions_by(&motion, shifted, &[0.0; 3]),
            end: Affine { slope: end.slope, predicted },
            geometry,
            stage: None,
            velocity: SurfaceVelocity::Field(vertices),
        };
        let force = self.variable_gravity(time.stage()) * self.mass.mass;
        let weight = self.variable_gravity.as_ref().map(|_| VariableGravity { force });
        Box::new(RigidStep {
            body: self,
            start,
            time: *time,
            motion,
            centre,
            momentum,
            weight,
            vertices,
            whole,
            surface,
        })
    }

    fn at_rows(&self, state: &BodyState<D>, rates: &BodyState<D>, rows: &[Row; 2]) -> BodyState<D> {
        self.state(&self.motion(state).at_rows(&self.motion(rates), rows), false)
    }

    fn variable_gravity(&self, time: f64) -> Vector<D> {
        self.variable_gravity.as_ref().map_or(Vector::zeros(), |gravity| gravity(time))
    }

    fn is_released(&self, time: &StepTime) -> bool {
        self.guide.as_ref().is_some_and(|guide| guide.acts_from(time.end - time.length) && !guide.acts_from(time.end))
    }

    fn balance(&self, state: &BodyState<D>) -> Option<Balance<D>> {
        let motion = self.motion(state);
        let mass = self.mass.mass;
        Some(Balance {
            kinetic_energy: motion.kinetic_energy(&self.mass),
            elastic_energy: 0.0,
            potential_energy: -mass * self.gravity.dot(&motion.centre),
            mass,
            centre_of_mass: motion.centre,
            momentum: motion.velocity * mass,
            momentum_rate: if state.level.acceleration.is_empty() {
                Vector::zeros()
            } else {
                motion.acceleration * mass
            },
            body_force: self.gravity * mass,
            volume: Placed::new(&self.boundary, &self.reference).enclosed().volume,
            smallest_volume_ratio: 1.0,
            smallest_volume_at: Point::zeros(),
        })
    }
}

/// A rigid body in one step.
///
/// Velocity `V` and spin `ω` are the unknowns. The velocities of the vertices are tied to them,
/// `v_i = V + ω × (x_i - c)` with the positions at which the background is cut, so that fluid and contact act on a
/// rigid body as on any other.
struct RigidStep<'s, const D: usize> {
    body: &'s RigidBody<D>,
    start: &'s BodyState<D>,
    time: StepTime,
    motion: RigidMotion<D>,
    /// Centre at the positions at which the background is cut.
    centre: Point<D>,
    momentum: Momentum<D>,
    /// Force of a gravity that varies in time, at the stage.
    weight: Option<VariableGravity<D>>,
    /// Field of the velocities of the vertices.
    vertices: FieldId,
    /// Field of `V` and `ω`, with one node.
    whole: FieldId,
    surface: SurfaceMotion<'s, D>,
}

impl<const D: usize> BodyStep<D> for RigidStep<'_, D> {
    fn surface(&self) -> &SurfaceMotion<'_, D> {
        &self.surface
    }

    fn constrain(&self, layout: &BlockLayout, constraints: &mut Constraints) {
        for (i, x) in self.surface.geometry.iter().enumerate() {
            let arm = x - self.centre;
            for (a, dof) in layout.node(self.vertices, i).enumerate() {
                let masters = layout.node(self.whole, 0).enumerate().map(|(m, to)| (to, mode(m, &arm)[a]));
                let masters: Vec<(DofId, f64)> = masters.filter(|(_, factor)| *factor != 0.0).collect();
                constraints.tie(dof, &masters);
            }
        }
        let start = self.time.end - self.time.length;
        let guided = self.body.guide.as_ref().filter(|guide| guide.acts_from(start));
        let guided = guided.map(|guide| (guide.velocity)(self.time.end));
        for (m, dof) in layout.node(self.whole, 0).enumerate() {
            // Velocity at the end of the step: zero for held modes, that of the guide before the release.
            let by_guide = guided.map(|velocity| if m < D { velocity[m] } else { 0.0 });
            let end = if self.body.holds(m) { Some(0.0) } else { by_guide };
            if let Some(end) = end {
                let RigidMotion { velocity, spin, .. } = &self.motion;
                let before = if m < D { velocity[m] } else { spin[m - D] };
                constraints.set(dof, self.time.weights.stage_velocity(end, before));
            }
        }
    }

    fn contributions<'p>(&'p self, layout: &'p BlockLayout) -> Vec<Box<dyn Contributions + 'p>> {
        let centre = RigidCentre { layout, whole: self.whole };
        vec![Box::new(Integral::linear("rigid body", centre, vec![&self.momentum]))]
    }

    fn loads<'p>(&'p self, layout: &'p BlockLayout) -> Vec<Box<dyn Contributions + 'p>> {
        let centre = RigidCentre { layout, whole: self.whole };
        let integral = |weight| Box::new(Integral::linear("variable weight", centre, vec![weight as _])) as _;
        self.weight.iter().map(integral).collect()
    }

    fn guess(&self, layout: &BlockLayout, x: &mut [f64]) {
        layout.set(self.vertices, self.start.velocity().iter().map(|v| (*v).into()), x);
        let RigidMotion { velocity, spin, .. } = &self.motion;
        for (value, dof) in velocity.iter().chain(spin).zip(layout.node(self.whole, 0)) {
            x[dof.index()] = *value;
        }
    }

    fn end(&self, layout: &BlockLayout, x: &[f64]) -> BodyState<D> {
        let whole = &x[layout.range(self.whole)];
        let mut spin = [0.0; 3];
        spin[..whole.len() - D].copy_from_slice(&whole[D..]);
        let velocity = Vector::from_column_slice(&whole[..D]);
        let weights = &self.time.weights;
        let motion = self.motion.after(&self.momentum.inertia, weights, velocity, spin);
        self.body.state(&motion, weights.acceleration != Row::default())
    }
}
