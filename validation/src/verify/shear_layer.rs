//! A fluid layer over an elastic one, sheared by an oscillating plate: the one flow with a deforming body that is known exactly.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use cutwater::mesh::VertexId;
use cutwater::mesh::generate::structured_box;
use cutwater::solid_svk::{LameParameters, SaintVenantKirchhoff, SolidForm, SolidMesh, TimeScheme};
use cutwater::solver::{Body, BodyKind, BodySupport, ElasticBody, FluidBoundary, SupportKind};

use super::Failure;
use super::flow::{self, Flow, Known, P, T, V};
use super::record::{Figure, Record};

/// Height of the elastic layer, and of both.
const INTERFACE: f64 = 0.5;
const PLATE: f64 = 1.0;
/// Density of both; shear modulus; viscosity; frequency; speed of the plate.
const DENSITY: f64 = 1.0;
const MU: f64 = 2.0;
const VISCOSITY: f64 = 0.1;
const OMEGA: f64 = TAU;
const SPEED: f64 = 0.01;
/// Time of the comparison: half a period.
const END: f64 = 0.5;
/// Interface velocity of the reference, amplitude and phase.
const KNOWN_INTERFACE: [f64; 2] = [5.555_197e-4, 3.026_732];
/// Asked orders in h and in the time step.
const ORDERS: [f64; 2] = [1.9, 0.95];

/// Measures orders in h, with dt ~ h², and in dt.
///
/// # Errors
/// A step fails.
pub(super) fn measure(record: &mut Record, _out: &Path) -> Result<(), Failure> {
    let layer = Layer::new();
    // The closed form beside the published numbers of the example.
    record.near_relative(
        "closed form: amplitude of the interface velocity",
        layer.at_interface.abs(),
        KNOWN_INTERFACE[0],
        1e-6,
    );
    record.near("closed form: its phase", layer.at_interface.phase(), KNOWN_INTERFACE[1], 1e-5);
    let sizes: &[usize] = if record.full { &[10, 20, 40, 80] } else { &[10, 20, 40] };
    let mut in_space = Vec::new();
    for &n in sizes {
        let steps = 40 * (n / 10) * (n / 10);
        in_space.push((1.0 / n as f64, errors([n, n], steps)?));
    }
    // Nothing depends on x: a mesh that is fine in y alone leaves little but the error in time.
    let fine = if record.full { [20, 160] } else { [10, 80] };
    let mut in_time = Vec::new();
    for k in 0..if record.full { 4 } else { 3 } {
        let steps = 20 << k;
        in_time.push((END / steps as f64, errors(fine, steps)?));
    }
    for (unit, sequence, order) in [("h", in_space, ORDERS[0]), ("dt", in_time, ORDERS[1])] {
        let pick = |k: usize| sequence.iter().map(|(x, e): &(f64, [f64; 2])| (*x, e[k])).collect::<Vec<_>>();
        record.order("fluid velocity in L2", unit, &pick(0), order);
        record.show_order("displacement, largest error", unit, &pick(1));
        record.figures.push(Figure {
            title: format!("Shear layer: errors against {unit}"),
            x_title: unit.to_owned(),
            curves: vec![("fluid velocity".to_owned(), pick(0)), ("displacement".to_owned(), pick(1))],
            is_log: true,
        });
    }
    record.note("The interface cuts the cells; orders in h with dt ~ h². Errors at half a period, from exact values at the start.");
    Ok(())
}

/// Errors of velocity and displacement with 1/h cells in x and in y.
fn errors([n_x, n_y]: [usize; 2], steps: usize) -> Result<[f64; 2], Failure> {
    let layer = Arc::new(Layer::new());
    let known = Known { flow: Arc::clone(&layer), density: DENSITY, viscosity: VISCOSITY, convects: true, open: &[] };
    // An odd number of rows: the interface lies in the middle of cells.
    let rows = 2 * (n_y / 2) + 1;
    let background = structured_box::<2>([0.0, 0.0], [0.4, PLATE], [(2 * n_x).div_ceil(5), rows])?;
    let mut setup = known.setup(background, END / steps as f64);
    // Nothing depends on x: no vertical motion at the sides, and no normal traction.
    for (tag, condition) in &mut setup.fluid.boundary {
        if ["left", "right"].map(|side| setup.background.tag(side)).contains(&Some(*tag)) {
            *condition = FluidBoundary::Symmetry { axis: 1 };
        }
    }
    // The body is longer than the box; its ends, out of the fluid, move as they should.
    let mesh = structured_box::<2>([-0.2, 0.0], [0.6, INTERFACE], [4 * n_x / 5, n_y / 2])?;
    let vertices = (0..mesh.n_vertices()).map(VertexId::new);
    let (at_start, at_ends, velocity) = (Arc::clone(&layer), Arc::clone(&layer), Arc::clone(&layer));
    let ends = vertices.filter(|v| {
        let x = mesh.vertex(*v);
        x[0] < -1e-9 || x[0] > 0.4 + 1e-9 || x[1] == 0.0
    });
    let support = BodySupport {
        vertices: ends.collect(),
        kind: SupportKind::Displacement(Arc::new(move |x, t| [Some(at_ends.displacement(x[1], t)), Some(0.0)])),
    };
    let material = SaintVenantKirchhoff::new(LameParameters { mu: MU, lambda: 4.0 * MU });
    let body = ElasticBody {
        solid: SolidMesh::new(mesh)?,
        form: SolidForm::new(DENSITY, material, V::zeros())?,
        supports: vec![support],
        scheme: TimeScheme::ImplicitEuler,
        loads: Vec::new(),
        initial_displacement: Some(Arc::new(move |x| V::new(at_start.displacement(x[1], 0.0), 0.0))),
        initial_velocity: Some(Arc::new(move |x| V::new(velocity.speed(x[1], 0.0), 0.0))),
    };
    setup.bodies.push(Body { name: "layer".to_owned(), kind: BodyKind::Elastic(Box::new(body)) });
    let (state, _) = flow::run(&setup, steps)?;
    let body = setup.bodies[0].reference().iter().zip(&state.bodies[0].displacement);
    let displacement = body.map(|(x, d)| (d[0] - layer.displacement(x[1], state.time)).abs()).fold(0.0, f64::max);
    Ok([known.errors(&setup, &state).velocity, displacement])
}

/// The time-harmonic solution: `d = A sin k y` below the interface, `u = B cosh κ(y - H_s) + C sinh κ(y - H_s)` above, real
/// parts of complex amplitudes times `e^{iωt}`.
struct Layer {
    /// `k = ω sqrt(ρ/μ)`
    wave_number: f64,
    /// `κ = sqrt(i ω ρ/μ_f) = (1 + i) s`, this is s.
    s: f64,
    /// `A`
    solid: Complex,
    /// `B`
    at_interface: Complex,
    /// `C`
    shear: Complex,
}

impl Layer {
    fn new() -> Self {
        let wave_number = OMEGA * (DENSITY / MU).sqrt();
        let s = (0.5 * OMEGA * DENSITY / VISCOSITY).sqrt();
        let (sin, cos) = (wave_number * INTERFACE).sin_cos();
        // For A = 1: iω sin kH = B, μ k cos kH = μ_f κ C; then scaled to the speed of the plate.
        let b = Complex(0.0, OMEGA * sin);
        let c = Complex(MU * wave_number * cos / VISCOSITY, 0.0).over(Complex(s, s));
        let (cosh, sinh) = hyperbolic(s * (PLATE - INTERFACE));
        let solid = Complex(SPEED, 0.0).over(b.times(cosh).plus(c.times(sinh)));
        Self { wave_number, s, solid, at_interface: b.times(solid), shear: c.times(solid) }
    }

    /// Displacement of the solid.
    fn displacement(&self, y: f64, t: f64) -> f64 {
        self.solid.real_at(t) * (self.wave_number * y).sin()
    }

    /// Velocity of the solid, and of the fluid above it.
    fn speed(&self, y: f64, t: f64) -> f64 {
        if y <= INTERFACE {
            return Complex(0.0, OMEGA).times(self.solid).real_at(t) * (self.wave_number * y).sin();
        }
        self.in_fluid(y, t)
    }

    /// Velocity of the fluid, and its smooth continuation.
    fn in_fluid(&self, y: f64, t: f64) -> f64 {
        let (cosh, sinh) = hyperbolic(self.s * (y - INTERFACE));
        self.at_interface.times(cosh).plus(self.shear.times(sinh)).real_at(t)
    }
}

impl Flow for Layer {
    fn velocity(&self, x: &P, t: f64) -> V {
        V::new(self.in_fluid(x[1], t), 0.0)
    }
    fn gradient(&self, x: &P, t: f64) -> T {
        let (cosh, sinh) = hyperbolic(self.s * (x[1] - INTERFACE));
        let slope = self.at_interface.times(sinh).plus(self.shear.times(cosh)).times(Complex(self.s, self.s));
        T::new(0.0, slope.real_at(t), 0.0, 0.0)
    }
    fn pressure(&self, _: &P, _: f64) -> f64 {
        0.0
    }
}

/// `cosh (1 + i) z` and `sinh (1 + i) z`
fn hyperbolic(z: f64) -> (Complex, Complex) {
    let (sin, cos) = z.sin_cos();
    (Complex(z.cosh() * cos, z.sinh() * sin), Complex(z.sinh() * cos, z.cosh() * sin))
}

/// Real and imaginary part.
#[derive(Clone, Copy)]
struct Complex(f64, f64);

impl Complex {
    fn plus(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }

    fn times(self, other: Self) -> Self {
        Self(self.0 * other.0 - self.1 * other.1, self.0 * other.1 + self.1 * other.0)
    }

    fn over(self, other: Self) -> Self {
        let size = other.0 * other.0 + other.1 * other.1;
        self.times(Self(other.0 / size, -other.1 / size))
    }

    fn abs(self) -> f64 {
        self.0.hypot(self.1)
    }

    fn phase(self) -> f64 {
        self.1.atan2(self.0)
    }

    /// Real part of the amplitude times `e^{iωt}`.
    fn real_at(self, t: f64) -> f64 {
        let (sin, cos) = (OMEGA * t).sin_cos();
        self.0 * cos - self.1 * sin
    }
}
