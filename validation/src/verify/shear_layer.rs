//! A fluid layer over an elastic one, sheared by an oscillating plate: the one flow with a deforming body that is known
//! exactly.

use std::f64::consts::TAU;
use std::sync::Arc;

use cutwater::algebra::time::ImplicitEuler;
use cutwater::mesh::generate::structured_box;
use cutwater::mesh::nalgebra::Complex;
use cutwater::mesh::{FacetId, VertexId};
use cutwater::solid_svk::{
    ElasticBody, ElasticOptions, LameParameters, Load, SaintVenantKirchhoff, SolidForm, SolidMesh, Support, SupportKind,
};
use cutwater::solver::{FluidBoundary, Setup, StepReport};

use super::dry::{Scheme, second_order};
use super::flow::{self, Flow, KnownFlow, fluid_mut, fluid_of, set_side, wet};
use super::signal::mean;
use super::{DirectRun, Failure, P, Record, T, V, short};

// Height of the elastic layer, and of both.
const INTERFACE: f64 = 0.5;
const PLATE: f64 = 1.0;
// Length of the box, and overhang of the body on either side.
const LENGTH: f64 = 0.4;
const OVERHANG: f64 = 0.2;
/// Round-off of coordinates.
const ROUND_OFF: f64 = 1e-9;
// Density of both; shear modulus; viscosity; frequency; speed of the plate.
const DENSITY: f64 = 1.0;
const MU: f64 = 2.0;
const VISCOSITY: f64 = 0.1;
const OMEGA: f64 = TAU;
const SPEED: f64 = 0.01;
/// Time of the comparison: half a period.
const END: f64 = 0.5;
/// Interface velocity of the reference, amplitude and phase.
const KNOWN_INTERFACE: [f64; 2] = [5.555_197e-4, 3.026_732];
/// Amplitude and phase of the measured quantities: displacement of the interface, its shear stress, shear stress at the
/// plate.
const KNOWN: [(&str, [f64; 2]); 3] = [
    ("displacement of the interface", [8.841_371e-5, 1.455_936]),
    ("shear stress at the interface", [5.980_346e-4, -1.685_657]),
    ("shear stress at the plate", [7.919_957e-3, 0.788_526]),
];
/// Required orders in h and in the time step.
const ORDERS: [f64; 2] = [1.9, 0.95];
/// Weights α of the fluid's traction in the mortar other than 1.
const WEIGHTS: [f64; 2] = [0.5, 0.0];
// Required order of the scheme of second order in the time step, and its spectral radius.
const SECOND_ORDER: f64 = 1.8;
const RHO_INF: f64 = 0.5;

/// Measures orders in h, with dt ~ h², and in dt.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let layer = Layer::new();
    // The closed form is compared with the published numbers of the example.
    record.near_relative(
        "closed form: amplitude of the interface velocity",
        layer.at_interface.norm(),
        KNOWN_INTERFACE[0],
        1e-6,
    );
    record.near("closed form: its phase", layer.at_interface.arg(), KNOWN_INTERFACE[1], 1e-5);
    let sizes: &[usize] = if record.full { &[10, 20, 40, 80] } else { &[10, 20, 40] };
    let euler: Scheme = Arc::new(ImplicitEuler);
    let mut in_space = Vec::new();
    for &n in sizes {
        in_space.push((1.0 / n as f64, run([n, n], n_steps(n), &euler, 1.0)?));
    }
    // Nothing depends on x: a mesh that is fine in y alone leaves little but the error in time.
    let fine = if record.full { [20, 320] } else { [10, 160] };
    let mut in_time = Vec::new();
    for k in 0..5 {
        let steps = 80 << k;
        in_time.push((END / steps as f64, run(fine, steps, &euler, 1.0)?));
    }
    of_second_order(record, fine)?;
    weights(record, sizes, &euler)?;
    for (unit, sequence, order) in [("h", &in_space, ORDERS[0]), ("dt", &in_time, ORDERS[1])] {
        let pick = |of: fn(&LayerResults) -> f64| sequence.iter().map(|(x, m)| (*x, of(m))).collect::<Vec<_>>();
        let (fluid, solid) = (pick(|m| m.fluid), pick(|m| m.solid));
        record.order("fluid velocity in L2", unit, &fluid, order);
        if unit == "h" {
            record.order("displacement, largest error", unit, &solid, order);
        } else {
            record.show_order("displacement, largest error", unit, &solid);
            let changes =
                sequence.windows(2).map(|w| (w[0].0, largest_change(&w[0].1.displacement, &w[1].1.displacement)));
            record.order("displacement, largest change when dt is halved", unit, &changes.collect::<Vec<_>>(), order);
        }
        for (k, (name, _)) in KNOWN.iter().enumerate() {
            let errors = sequence.iter().map(|(x, m)| (*x, m.error(k))).collect::<Vec<_>>();
            let name = format!("{name}, relative error");
            // The stress at the plate is a difference quotient with an error of its own; in dt, a part of the error in
            // space remains.
            if unit == "h" && k < 2 {
                record.order(&name, unit, &errors, order);
            } else {
                record.show_order(&name, unit, &errors);
            }
        }
        record.log_figure(
            format!("Shear layer: errors against {unit}"),
            unit,
            vec![("fluid velocity".to_owned(), fluid), ("displacement".to_owned(), solid)],
        );
    }
    let [.., (h, finest)] = &in_space[..] else { return Err("a mesh at least".into()) };
    for ((name, [amplitude, phase]), measured) in KNOWN.into_iter().zip(finest.amplitudes) {
        record.show(format!("{name}: amplitude, h = {}", short(*h)), measured.norm(), Some(amplitude));
        record.show(format!("{name}: phase, h = {}", short(*h)), measured.arg(), Some(phase));
    }
    record.note(
        "The interface cuts the cells; orders in h with dt ~ h². Errors at half a period, from exact values at the \
         start. Complex amplitudes are put together from the values after a quarter and half of the period, means \
         over x; the stress at the interface is that of the mortar, with its penalty; that at the plate is the \
         one-sided difference quotient of second order of the velocities. With small dt, errors of displacement and \
         amplitudes keep the part that the mesh makes; the order of the displacement in dt is that of its changes.",
    );
    record.note(
        "The body sticks out of the box. The part of its upper side there carries the exact stress: without it the \
         vertices at the sides of the box lack half of their load, and the displacement has an error of first order \
         in h at these vertices alone. With it all of the displacement is of second order in h; the interface moves \
         along itself, so that nothing here tests the frozen geometry.",
    );
    Ok(())
}

/// Returns the number of steps for a size 1/n: errors of implicit Euler fall with those of the mesh.
fn n_steps(n: usize) -> usize {
    2 * n * n / 5
}

/// Measures orders in h with other weights of the fluid's traction in the mortar.
fn weights(record: &mut Record, sizes: &[usize], scheme: &Scheme) -> Result<(), Failure> {
    for alpha in WEIGHTS {
        let mut errors = [Vec::new(), Vec::new(), Vec::new()];
        for &n in sizes {
            let found = run([n, n], n_steps(n), scheme, alpha)?;
            for (errors, error) in errors.iter_mut().zip([found.fluid, found.solid, found.error(1)]) {
                errors.push((1.0 / n as f64, error));
            }
        }
        let names =
            ["fluid velocity in L2", "displacement, largest error", "shear stress at the interface, relative error"];
        for (name, errors) in names.into_iter().zip(&errors) {
            record.order(&format!("α = {alpha}: {name}"), "h", errors, ORDERS[0]);
        }
    }
    Ok(())
}

/// Measures the order in time of the scheme of second order: of the changes when the step is halved, which are free of
/// the error in space. The change of single dofs is shown: those inside of the body have values that no fluid has.
fn of_second_order(record: &mut Record, n: [usize; 2]) -> Result<(), Failure> {
    let scheme = second_order(RHO_INF)?;
    let mut changes = [Vec::new(), Vec::new(), Vec::new()];
    let mut coarser: Option<(f64, LayerResults)> = None;
    for k in 0..5 {
        let steps = 20 << k;
        let found = run(n, steps, &scheme, 1.0)?;
        if let Some((dt, coarser)) = &coarser {
            let [fluid, finer] = [&coarser.run.state, &found.run.state].map(wet);
            let of_velocity = flow::differences(&found.run.setup, &coarser.run.state, &found.run.state)?.velocity;
            changes[0].push((*dt, of_velocity));
            changes[1].push((*dt, largest_change(&coarser.displacement, &found.displacement)));
            changes[2].push((*dt, largest_change(&fluid?.velocity, &finer?.velocity)));
        }
        coarser = Some((END / steps as f64, found));
    }
    let [velocity, displacement, of_dofs] = &changes;
    record.order("generalised-α: fluid velocity, change in L2 when dt is halved", "dt", velocity, SECOND_ORDER);
    record.order("generalised-α: displacement, largest change when dt is halved", "dt", displacement, SECOND_ORDER);
    record.show_order("generalised-α: fluid velocity, largest change of a dof when dt is halved", "dt", of_dofs);
    Ok(())
}

/// Results of one run.
struct LayerResults {
    /// Error of the velocity of the fluid in L2, cm²/s.
    fluid: f64,
    /// The run at its end.
    run: DirectRun,
    /// Displacement of the vertices of the body, and its largest error.
    displacement: Vec<V>,
    solid: f64,
    /// Complex amplitudes, from the values after a quarter and half of the period, in the order of [`KNOWN`].
    amplitudes: [Complex<f64>; 3],
}

impl LayerResults {
    /// Returns the relative error of an amplitude.
    fn error(&self, k: usize) -> f64 {
        let (_, [amplitude, phase]) = KNOWN[k];
        (self.amplitudes[k] - Complex::from_polar(amplitude, phase)).norm() / amplitude
    }
}

/// Computes half a period with the weight `alpha` of the fluid's traction; `n` is the number 1/h in x and in y.
fn run(n: [usize; 2], steps: usize, scheme: &Scheme, alpha: f64) -> Result<LayerResults, Failure> {
    let layer = Arc::new(Layer::new());
    let known =
        KnownFlow { flow: Arc::clone(&layer), density: DENSITY, viscosity: VISCOSITY, convects: true, open: &[] };
    let solid = solid(n)?;
    let mut setup = Setup { scheme: Arc::clone(scheme), ..setup(&known, n, END / steps as f64)? };
    fluid_mut(&mut setup)?.alpha = alpha;
    let mut run = DirectRun::new(setup)?;
    let mut amplitudes = [Complex::new(0.0, 0.0); 3];
    for step in 1..=steps {
        let stage = run.state.step_time(&run.setup, run.setup.dt).stage();
        run.setup.bodies = vec![Arc::new(body(&layer, solid.clone(), stage)?)];
        let report = run.advance()?;
        // Real parts of the amplitudes times i, and times i².
        if 2 * step == steps || step == steps {
            for (amplitude, value) in amplitudes.iter_mut().zip(values(&run, &report)?) {
                *(if step == steps { &mut amplitude.re } else { &mut amplitude.im }) = -value;
            }
        }
    }
    let DirectRun { setup, state, .. } = &run;
    let vertices = setup.bodies[0].reference().iter().zip(state.bodies[0].displacement());
    let errors = vertices.map(|(x, d)| (d[0] - layer.displacement(x[1], state.time)).abs());
    let solid = errors.fold(0.0, f64::max);
    let fluid = known.errors(setup, state)?.velocity;
    let displacement = state.bodies[0].displacement().to_vec();
    Ok(LayerResults { fluid, displacement, solid, amplitudes, run })
}

fn largest_change(a: &[V], b: &[V]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Computes means over x, in the order of [`KNOWN`].
fn values(DirectRun { setup, state, .. }: &DirectRun, report: &StepReport<2>) -> Result<[f64; 3], Failure> {
    let of_body = setup.bodies[0].reference().iter().zip(state.bodies[0].displacement());
    let displacement = of_body.filter(|(x, _)| x[1] == INTERFACE && is_in_box(x[0])).map(|(_, d)| d[0]);
    let stress = flow::force(state, report, 0, &P::zeros())?.0[0] / LENGTH;
    // One-sided difference of second order, over the plate and the two rows of vertices below it.
    let (background, fluid) = (&fluid_of(setup)?.background, wet(state)?);
    let vertices = || fluid.space.vertices().iter().map(|v| background.vertex(*v)).zip(&fluid.velocity);
    let below = vertices().map(|(x, _)| x[1]).filter(|y| *y < PLATE).fold(0.0, f64::max);
    let spacing = PLATE - below;
    let row = |k: f64| {
        let on_row = vertices().filter(|(x, _)| (x[1] - PLATE + k * spacing).abs() < 0.1 * spacing);
        mean(&on_row.map(|(_, u)| u[0]).collect::<Vec<_>>())
    };
    let at_plate = VISCOSITY * (3.0 * row(0.0) - 4.0 * row(1.0) + row(2.0)) / (2.0 * spacing);
    Ok([mean(&displacement.collect::<Vec<_>>()), stress, at_plate])
}

/// Returns the setup of the box of fluid and the body below it.
fn setup(known: &KnownFlow<Layer>, [n_x, n_y]: [usize; 2], dt: f64) -> Result<Setup<2>, Failure> {
    // An odd number of rows: the interface lies in the middle of cells.
    let rows = 2 * (n_y / 2) + 1;
    let background = structured_box::<2>([0.0, 0.0], [LENGTH, PLATE], [(2 * n_x).div_ceil(5), rows])?;
    let mut setup = known.setup(background, dt);
    // Nothing depends on x: no vertical motion at the sides, and no normal traction.
    set_side(&mut setup, "left", FluidBoundary::symmetry(1))?;
    set_side(&mut setup, "right", FluidBoundary::symmetry(1))?;
    setup.bodies.push(Arc::new(body(&known.flow, solid([n_x, n_y])?, 0.0)?));
    Ok(setup)
}

/// Returns the mesh of the elastic layer. It is longer than the box, so that its ends stay out of the fluid.
fn solid([n_x, n_y]: [usize; 2]) -> Result<SolidMesh<2>, Failure> {
    let (low, high) = ([-OVERHANG, 0.0], [LENGTH + OVERHANG, INTERFACE]);
    Ok(SolidMesh::new(structured_box::<2>(low, high, [4 * n_x / 5, n_y / 2])?)?)
}

/// Returns the body for the step that ends at a time. Its ends are free to slide. The part of its upper side beyond the
/// box carries the shear stress of the fluid.
fn body(layer: &Arc<Layer>, solid: SolidMesh<2>, time: f64) -> Result<ElasticBody<2>, Failure> {
    let mesh = solid.mesh();
    let on_base = |x: &P| x[1] == 0.0;
    let at_end = |x: &P| (x[0] - 0.5 * LENGTH).abs() > 0.5 * LENGTH + OVERHANG - ROUND_OFF;
    let vertices = |of: &dyn Fn(&P) -> bool| {
        let all = (0..mesh.n_vertices()).map(VertexId::new);
        all.filter(|v| of(&mesh.vertex(*v))).collect::<Vec<_>>()
    };
    let boundary = solid.boundary();
    let sticks_out = |facet: &FacetId| {
        let ends = boundary.facet(*facet).iter().map(|v| mesh.vertex(*v)).collect::<Vec<_>>();
        ends.iter().all(|x| x[1] == INTERFACE) && !is_in_box(0.5 * (ends[0][0] + ends[1][0]))
    };
    let facets: Vec<FacetId> = boundary.facets().filter(sticks_out).collect();
    let stress = VISCOSITY * layer.gradient(&P::new(0.0, INTERFACE), time)[(0, 1)];
    let (at_start, velocity) = (Arc::clone(layer), Arc::clone(layer));
    let options = ElasticOptions {
        supports: vec![
            Support { vertices: vertices(&on_base), kind: SupportKind::Clamped },
            Support { vertices: vertices(&|x| at_end(x) && !on_base(x)), kind: SupportKind::symmetry(1) },
        ],
        loads: vec![Load::traction(facets, Arc::new(move |_, _| V::new(stress, 0.0)))],
        initial_displacement: Some(Arc::new(move |x| V::new(at_start.displacement(x[1], 0.0), 0.0))),
        initial_velocity: Some(Arc::new(move |x| V::new(velocity.speed(x[1], 0.0), 0.0))),
        ..ElasticOptions::default()
    };
    let material = SaintVenantKirchhoff::new(LameParameters { mu: MU, lambda: 4.0 * MU });
    let form = SolidForm::new(DENSITY, material, V::zeros())?;
    Ok(ElasticBody::new("layer", solid, form, options)?)
}

fn is_in_box(x: f64) -> bool {
    (-ROUND_OFF..=LENGTH + ROUND_OFF).contains(&x)
}

/// The time-harmonic solution: `d = A sin k y` below the interface, `u = B cosh κ(y - H_s) + C sinh κ(y - H_s)` above,
/// real parts of complex amplitudes times `e^{iωt}`.
struct Layer {
    /// `k = ω sqrt(ρ/μ)`
    wave_number: f64,
    /// `κ = sqrt(i ω ρ/μ_f) = (1 + i) s`, this is s.
    s: f64,
    /// `A`
    solid: Complex<f64>,
    /// `B`
    at_interface: Complex<f64>,
    /// `C`
    shear: Complex<f64>,
}

impl Layer {
    fn new() -> Self {
        let wave_number = OMEGA * (DENSITY / MU).sqrt();
        let s = (0.5 * OMEGA * DENSITY / VISCOSITY).sqrt();
        let (sin, cos) = (wave_number * INTERFACE).sin_cos();
        // For A = 1: iω sin kH = B, μ k cos kH = μ_f κ C; then scaled to the speed of the plate.
        let b = Complex::new(0.0, OMEGA * sin);
        let c = over(Complex::new(MU * wave_number * cos / VISCOSITY, 0.0), Complex::new(s, s));
        let [cosh, sinh] = hyperbolic(s * (PLATE - INTERFACE));
        let solid = over(Complex::new(SPEED, 0.0), b * cosh + c * sinh);
        Self { wave_number, s, solid, at_interface: b * solid, shear: c * solid }
    }

    /// Returns the displacement of the solid.
    fn displacement(&self, y: f64, t: f64) -> f64 {
        real_at(self.solid, t) * (self.wave_number * y).sin()
    }

    /// Returns the velocity of the solid, and of the fluid above it.
    fn speed(&self, y: f64, t: f64) -> f64 {
        if y <= INTERFACE {
            return real_at(Complex::new(0.0, OMEGA) * self.solid, t) * (self.wave_number * y).sin();
        }
        self.in_fluid(y, t)
    }

    /// Returns the velocity of the fluid, and its smooth continuation.
    fn in_fluid(&self, y: f64, t: f64) -> f64 {
        let [cosh, sinh] = hyperbolic(self.s * (y - INTERFACE));
        real_at(self.at_interface * cosh + self.shear * sinh, t)
    }
}

impl Flow for Layer {
    fn velocity(&self, x: &P, t: f64) -> V {
        V::new(self.in_fluid(x[1], t), 0.0)
    }
    fn gradient(&self, x: &P, t: f64) -> T {
        let [cosh, sinh] = hyperbolic(self.s * (x[1] - INTERFACE));
        let slope = (self.at_interface * sinh + self.shear * cosh) * Complex::new(self.s, self.s);
        T::new(0.0, real_at(slope, t), 0.0, 0.0)
    }
    fn pressure(&self, _: &P, _: f64) -> f64 {
        0.0
    }
}

/// Returns `cosh` and `sinh` of `(1 + i) z`.
fn hyperbolic(z: f64) -> [Complex<f64>; 2] {
    let z = Complex::new(z, z);
    [z.cosh(), z.sinh()]
}

/// Returns the real part of an amplitude times `e^{iωt}`.
fn real_at(amplitude: Complex<f64>, t: f64) -> f64 {
    (amplitude * Complex::cis(OMEGA * t)).re
}

/// Returns a quotient, as the product with the inverse.
fn over(a: Complex<f64>, b: Complex<f64>) -> Complex<f64> {
    a * (b.conj() / b.norm_sqr())
}
