//! Bodies of prescribed motion: the smallest implementation of the traits.

use algebra::time::{Affine, Row};
use algebra::{BlockLayout, Constraints, Contributions};
use mesh::{BoundaryMesh, Point, Vector};

use crate::{
    Balance, Body, BodyState, BodyStep, ParticleVelocity, StepTime, SurfaceMotion, SurfaceVelocity, TimeField,
};

/// A body with a prescribed motion. It has no unknowns.
///
/// `velocity` must be the time derivative of `position` along the path of each particle, which is not checked.
pub struct PrescribedBody<const D: usize> {
    /// Name.
    pub name: String,
    /// The surface.
    pub boundary: BoundaryMesh<D>,
    /// Reference positions of the vertices of the surface.
    pub reference: Vec<Point<D>>,
    /// Position at a time, from the reference position.
    pub position: TimeField<D>,
    /// Velocity of the particles of the surface.
    pub velocity: ParticleVelocity<D>,
}

impl<const D: usize> PrescribedBody<D> {
    fn state(&self, time: f64) -> BodyState<D> {
        let at: Vec<Point<D>> = self.reference.iter().map(|x| (self.position)(x, time)).collect();
        let displacement = at.iter().zip(&self.reference).map(|(x, reference)| x - reference).collect();
        BodyState::new(displacement, at.iter().map(|x| (self.velocity)(x, [time; 2])).collect())
    }

    /// Returns the accelerations of the vertices at the end `t` of a step by the one-sided difference of second order,
    /// `(3 v(t) - 4 v(t - Δt/2) + v(t - Δt))/Δt`.
    fn acceleration(&self, end: &BodyState<D>, time: &StepTime) -> Vec<Vector<D>> {
        let before = |part: f64| self.state(time.end - part * time.length).level.velocity;
        let earlier = before(0.5).into_iter().zip(before(1.0));
        let rate =
            |(v, (middle, start)): (&Vector<D>, (Vector<D>, Vector<D>))| (v * 3.0 - middle * 4.0 + start) / time.length;
        end.velocity().iter().zip(earlier).map(rate).collect()
    }
}

impl<const D: usize> Body<D> for PrescribedBody<D> {
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
        false
    }

    fn initial(&self) -> BodyState<D> {
        self.state(0.0)
    }

    fn geometry(&self, start: &BodyState<D>, time: &StepTime) -> Vec<Point<D>> {
        if time.extrapolates() {
            self.state(time.geometry_time()).positions(&self.reference)
        } else {
            start.positions(&self.reference)
        }
    }

    fn step<'s>(&'s self, start: &'s BodyState<D>, time: &StepTime, _: &mut BlockLayout) -> Box<dyn BodyStep<D> + 's> {
        let (times, shifted) = ([time.geometry_time(), time.stage()], &time.weights.shifted[0]);
        let mut end = self.state(time.end);
        if time.weights.acceleration != Row::default() {
            end.level.acceleration = self.acceleration(&end, time);
        }
        let surface = SurfaceMotion {
            boundary: &self.boundary,
            geometry: self.geometry(start, time),
            start: start.positions_by(shifted, &self.reference),
            // The shifted positions at the end of this step are those at the start of the next step.
            end: Affine { slope: 0.0, predicted: end.positions_by(shifted, &self.reference) },
            stage: None,
            velocity: SurfaceVelocity::Given(Box::new(move |x| (self.velocity)(x, times))),
        };
        Box::new(PrescribedStep { surface, end })
    }

    fn given_velocity(&self, x: &Point<D>, time: f64) -> Option<Vector<D>> {
        Some((self.velocity)(x, [time; 2]))
    }

    fn balance(&self, _: &BodyState<D>) -> Option<Balance<D>> {
        None
    }
}

/// A body of prescribed motion in one step.
struct PrescribedStep<'s, const D: usize> {
    surface: SurfaceMotion<'s, D>,
    end: BodyState<D>,
}

impl<const D: usize> BodyStep<D> for PrescribedStep<'_, D> {
    fn surface(&self) -> &SurfaceMotion<'_, D> {
        &self.surface
    }

    fn constrain(&self, _: &BlockLayout, _: &mut Constraints) {}

    fn contributions<'p>(&'p self, _: &'p BlockLayout) -> Vec<Box<dyn Contributions + 'p>> {
        Vec::new()
    }

    fn guess(&self, _: &BlockLayout, _: &mut [f64]) {}

    fn end(&self, _: &BlockLayout, _: &[f64]) -> BodyState<D> {
        self.end.clone()
    }
}
