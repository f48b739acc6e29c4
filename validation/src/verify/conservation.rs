//! Conservation of the volume that a moving body displaces: in the cut, cell by cell, and in the equation of continuity. As
//! the mesh does not move, no velocity of the mesh enters. The closure of cut cells is checked, and the balance of sweep,
//! outflow and leak.

use std::sync::Arc;

use cutwater::cutcell::FaceLabel;
use cutwater::mesh::FacetId;
use cutwater::solver::{FluidBoundary, Setup, State};
use cutwater::xfem_space::PartValues;

use super::flow::{Random, fluid_mut, fluid_of, polygon_of_particles, wet, wet_report};
use super::linear_flow::{Linear, background, nonagon};
use super::record::{Named, worse};
use super::{Failure, P, Run, T, V};

/// Name of the net leak, which no equation makes zero.
pub(super) const LEAK: &str = "over its sweep: net flow through the surface, relative to it";
const STEPS: usize = 6;
const DT: f64 = 0.02;
/// Area of the box.
const BOX: f64 = 3.0;

/// Motion of a body.
#[derive(Clone, Copy)]
enum Motion {
    /// Translation, and rotation about a point.
    Rigid { about: P, speed: V, spin: f64 },
    /// Constant velocities `a (X - about) + b` of the points: rotation, growth and shear.
    Swelling { about: P, a: T, b: V },
}

impl Motion {
    fn position(&self, x: &P, t: f64) -> P {
        match self {
            Self::Rigid { about, speed, spin } => {
                let (sin, cos) = (spin * t).sin_cos();
                about + speed * t + T::new(cos, -sin, sin, cos) * (x - about)
            }
            Self::Swelling { about, a, b } => x + (a * (x - about) + b) * t,
        }
    }

    /// Returns the velocity of the point that is at `x` at a time.
    fn velocity(&self, x: &P, t: f64) -> V {
        match self {
            Self::Rigid { about, speed, spin } => {
                let arm = x - about - speed * t;
                speed + V::new(-arm[1], arm[0]) * *spin
            }
            Self::Swelling { about, a, b } => {
                let back = (T::identity() + a * t).try_inverse().unwrap_or_else(T::zeros);
                a * back * (x - about - b * t) + b
            }
        }
    }
}

/// Fluxes of the discrete velocity out of all fluid parts.
struct Fluxes {
    /// Sum over parts of `|∫ div u - ∮ u·n|`, and over faces of the differences between the two sides.
    residual: f64,
    /// Flow out of the box.
    outflow: f64,
    /// `∫ v·n`, rate at which the body grows by the motion of its surface, and `∫ |v·n|`.
    growth: f64,
    swept: f64,
}

fn fluxes(setup: &Setup<2>, state: &State<2>, motion: &Motion) -> Result<Fluxes, Failure> {
    let (background, fluid) = (&fluid_of(setup)?.background, wet(state)?);
    let (cut, values) = (&fluid.cut, PartValues::new(background, &fluid.cut));
    let mut through_faces = vec![0.0; background.n_facets()];
    let mut residuals = vec![0.0; cut.n_parts()];
    // Velocity of a part, which is linear, at a point of its cell or beyond.
    let velocity = |part, x: &P| -> V {
        let origin = background.simplex(cut.part_cell(part)).points()[0];
        let shapes = values.gradients(part).iter().enumerate().map(|(k, g)| g.dot(&(x - origin)) + f64::from(k == 0));
        fluid.space.dofs(part).iter().zip(shapes).map(|(&dof, n)| fluid.velocity[dof as usize] * n).sum()
    };
    for part in cut.all_parts() {
        let cell = cut.part_cell(part);
        let of_gradients = fluid.space.dofs(part).iter().zip(values.gradients(part));
        let divergence: f64 = of_gradients.map(|(&dof, g)| fluid.velocity[dof as usize].dot(g)).sum();
        residuals[part.index()] += divergence * values.moments(part).volume();
        let mut leave = |from: P, to: P, face: FacetId| {
            let flux = velocity(part, &((from + to) * 0.5)).dot(&V::new(to[1] - from[1], from[0] - to[0]));
            residuals[part.index()] -= flux;
            through_faces[face.index()] += flux;
        };
        let faces = background.cell_to_facet(cell);
        if cut.is_whole(part) {
            let simplex = background.simplex(cell);
            let corners = simplex.points();
            // The face opposite to corner k.
            (0..3).for_each(|k| leave(corners[(k + 1) % 3], corners[(k + 2) % 3], faces[k]));
        }
        for piece in cut.part_pieces(part) {
            for (label, ends) in piece.faces() {
                if let FaceLabel::Cell(k) = label {
                    let [from, to] = [ends[0], ends[1]].map(|k| piece.points()[k as usize]);
                    leave(from, to, faces[usize::from(k)]);
                }
            }
        }
    }
    let (mut growth, mut swept) = (0.0, 0.0);
    for piece in cut.interface() {
        let middle = (piece.points[0] + piece.points[1]) * 0.5;
        residuals[piece.part.index()] += velocity(piece.part, &middle).dot(&piece.normal) * piece.measure;
        // The cut is that of the body at the start of the step.
        let rate = motion.velocity(&middle, state.time - setup.dt).dot(&piece.normal) * piece.measure;
        growth += rate;
        swept += rate.abs();
    }
    let (mut outflow, mut disagreement) = (0.0, 0.0);
    for (facet, flux) in background.facets().zip(through_faces) {
        if background.is_boundary(facet) {
            outflow += flux;
        } else {
            disagreement += f64::abs(flux);
        }
    }
    let residual = residuals.iter().map(|r| f64::abs(*r)).sum::<f64>() + disagreement;
    Ok(Fluxes { residual, outflow, growth, swept })
}

/// Moves a body of given motion through a box, which may be open at the top. Returns the largest errors over the steps,
/// relative to the volume that the body sweeps: the sum of the errors in the volume balance of all cells; the
/// difference of the outflow and the growth of the body; the difference of the change of the covered area and the sweep
/// of the surface; and the net leak through the surface.
fn displaced(name: &str, corners: Vec<P>, motion: Motion, is_open: bool) -> Result<Named, Failure> {
    let known = Linear::at_rest(V::zeros()).known(0.05, if is_open { &["top"] } else { &[] });
    let mut setup = known.setup(background()?, DT);
    for (_, condition) in &mut fluid_mut(&mut setup)?.boundary {
        if matches!(condition, FluidBoundary::Velocity(_)) {
            *condition = FluidBoundary::NoSlip;
        }
    }
    let velocity = Arc::new(move |x: &P, [t, _]: [f64; 2]| motion.velocity(x, t));
    setup.bodies.push(polygon_of_particles(&[corners], move |x, t| motion.position(x, t), velocity));
    let mut run = Run::new(setup)?;
    let mut errors = [0.0_f64; 4];
    let mut before: Option<(f64, f64)> = None;
    for _ in 0..STEPS {
        let report = run.advance()?;
        let flow = fluxes(&run.setup, &run.state, &motion)?;
        let covered = BOX - wet(&run.state)?.cut.fluid_volume();
        // Velocities at corners are constant or turn: rates are linear in time or zero, and the trapezoidal rule is exact.
        let of_area = before.map_or(0.0, |(area, growth)| (covered - area) / DT - 0.5 * (growth + flow.growth));
        let now = [flow.residual, flow.outflow - flow.growth, of_area, wet_report(&report)?.flow.leak_net];
        for (error, value) in errors.iter_mut().zip(now) {
            *error = worse(*error, value.abs() / flow.swept);
        }
        before = Some((covered, flow.growth));
    }
    let names = [
        "every step, over its sweep: sum of what is missing in the volume balance of each cell",
        "every step, over its sweep: flow out of the box beside growth of the body",
        "every step, over its sweep: change of the covered area beside sweep of the surface",
        LEAK,
    ];
    Ok(names.into_iter().zip(errors).map(|(what, error)| (format!("{name}, {what}"), error)).collect())
}

/// Measures the errors of a body that moves and turns in a closed box.
pub(super) fn closed(centre: P, random: &mut Random) -> Result<Named, Failure> {
    let motion = rigid(centre, random);
    displaced("body that moves and turns in a closed box", nonagon(centre, random), motion, false)
}

/// Measures the errors of a body that moves and turns under an open side.
pub(super) fn open(centre: P, random: &mut Random) -> Result<Named, Failure> {
    let motion = rigid(centre, random);
    displaced("body that moves and turns under an open side", nonagon(centre, random), motion, true)
}

fn rigid(about: P, random: &mut Random) -> Motion {
    let speed = V::new(random.between(-0.7, 0.7), random.between(-0.7, 0.7));
    Motion::Rigid { about, speed, spin: random.between(1.0, 4.0) }
}

/// Measures the errors of a body that turns, swells and is sheared under an open side.
pub(super) fn swelling(about: P, random: &mut Random) -> Result<Named, Failure> {
    let mut entry = || random.between(-0.5, 0.5);
    let (shear, b) = (T::new(entry(), entry(), entry(), entry()), V::new(entry(), entry()));
    let a = shear + T::new(0.6, -1.0, 1.0, 0.6);
    let name = "body that turns, swells and is sheared under an open side";
    displaced(name, nonagon(about, random), Motion::Swelling { about, a, b }, true)
}
