//! Each term alone: values by hand on one or two triangles, tangents, and quadrature of its definition on cut parts.

use algebra::time::{Affine, ImplicitEuler, Level, TimeScheme};
use algebra::{
    BlockLayout, BlockSystem, Constraints, Contributions, FieldId, Integral, LocalSystem, Sites, Term, check_tangent,
};
use cutcell::{CutMesh, OverlayOptions, PartId};
use fluid_ns::terms::{
    Backflow, BodyForce, CipPressure, CipProfile, CipVelocity, Convection, GhostPenalty, Incompressibility, Inertia,
    Traction, Viscous,
};
use fluid_ns::{
    FluidCell, FluidCells, FluidFace, FluidFaces, FluidFields, FluidForm, FluidGeometry, OpenBoundary, face_powers,
};
use mesh::generate::structured_box;
use mesh::{Placed, Point, SimplexMesh, Tensor, Vector, VertexId};
use xfem_space::{FaceValue, PartValues, XfemSpace, boundary_points, face_values};

type V = Vector<2>;

const TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

/// The unit square in two triangles; their common face is the diagonal from (0, 0) to (1, 1).
const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

fn mesh(points: &[[f64; 2]], cells: &[u32]) -> SimplexMesh<2> {
    let vertices = points.iter().map(|x| Point::<2>::new(x[0], x[1])).collect();
    SimplexMesh::new(vertices, cells.iter().map(|&v| VertexId(v)).collect()).expect("a mesh")
}

/// A fluid on a background, around a body or without one.
struct Fixture<const D: usize> {
    background: SimplexMesh<D>,
    cut: CutMesh<D>,
    space: XfemSpace<D>,
    parts: PartValues<D>,
    faces: Vec<FaceValue<D>>,
    history: Vec<Vector<D>>,
    acceleration: Affine<Vector<D>>,
    layout: BlockLayout,
    velocity: FieldId,
    pressure: FieldId,
}

impl<const D: usize> Fixture<D> {
    /// Creates a fixture with a step of length 0.5. `history` maps the number and the vertex of each dof to its
    /// history.
    fn new(
        background: SimplexMesh<D>,
        body: Option<&SimplexMesh<D>>,
        scheme: &dyn TimeScheme,
        history: impl Fn(usize, VertexId) -> Vector<D>,
    ) -> Self {
        let boundary = body.map(SimplexMesh::boundary);
        let placed = body.zip(boundary.as_ref()).map(|(body, boundary)| Placed::new(boundary, body.vertices()));
        let surfaces: Vec<_> = placed.into_iter().collect();
        let cut = CutMesh::overlay(&background, &surfaces, &OverlayOptions::new()).expect("a closed surface");
        let space = XfemSpace::new(&background, &cut);
        let parts = PartValues::new(&background, &cut);
        let faces = face_values(&background, &cut, &space, &parts);
        let history: Vec<_> = space.vertices().iter().enumerate().map(|(k, v)| history(k, *v)).collect();
        let level = Level { velocity: history.clone(), ..Level::default() };
        let acceleration = Affine::new(&scheme.weights(0.5, true).stage_acceleration, &level);
        let mut layout = BlockLayout::new();
        let velocity = layout.push("velocity", space.len(), D);
        let pressure = layout.push_on(velocity, "pressure", 1);
        Self { background, cut, space, parts, faces, history, acceleration, layout, velocity, pressure }
    }

    fn geometry(&self) -> FluidGeometry<'_, D> {
        let Self { background, cut, space, parts, faces, history, acceleration, .. } = self;
        FluidGeometry { background, cut, space, parts, faces, known_velocity: history, acceleration, films: None }
    }

    fn fields(&self) -> FluidFields<'_> {
        FluidFields { layout: &self.layout, velocity: self.velocity, pressure: self.pressure }
    }

    fn cells(&self) -> FluidCells<'_, D> {
        FluidCells::new(self.geometry(), self.fields())
    }

    /// Returns the dof of a vertex.
    fn dof(&self, vertex: usize) -> usize {
        self.space.vertices().iter().position(|v| v.index() == vertex).expect("a dof")
    }

    /// Returns the sum of the residuals of all items.
    fn assembled(&self, contributions: &dyn Contributions, x: &[f64]) -> Vec<f64> {
        let mut system = BlockSystem::new(&self.layout, &[contributions], &Constraints::new());
        system.assemble_residual(&[contributions], x);
        system.residual().to_vec()
    }

    fn random_state(&self) -> Vec<f64> {
        (0..self.layout.len()).map(|k| noise(3 * k + 1)).collect()
    }
}

/// Returns the residual of a cell term on the unit triangle: velocities (x, y of each node), then pressures.
fn residual(term: &dyn for<'a> Term<FluidCell<'a, 2>>, u: [V; 3], p: [f64; 3], history: [V; 3]) -> Vec<f64> {
    let fluid = Fixture::new(mesh(&TRIANGLE, &[0, 1, 2]), None, &ImplicitEuler, |_, v| history[v.index()]);
    let (vertices, mut x) = (fluid.space.vertices(), vec![0.0; 9]);
    fluid.layout.set(fluid.velocity, vertices.iter().map(|v| u[v.index()].into()), &mut x);
    fluid.layout.set(fluid.pressure, vertices.iter().map(|v| [p[v.index()]]), &mut x);
    let mut out = LocalSystem::new();
    out.reset(9);
    fluid.cells().visit(0, &x, |cell| term.add(cell, &mut out));
    out.residual().to_vec()
}

fn assert_close(computed: &[f64], expected: &[f64]) {
    assert_eq!(computed.len(), expected.len());
    for (a, b) in computed.iter().zip(expected) {
        assert!((a - b).abs() < 1e-13, "{computed:?} is not {expected:?}");
    }
}

fn nodal(u: impl Fn(f64, f64) -> [f64; 2]) -> [V; 3] {
    TRIANGLE.map(|x| V::from(u(x[0], x[1])))
}

#[test]
fn inertia() {
    let r = residual(&Inertia { density: 3.0 }, [V::new(2.0, -1.0); 3], [0.0; 3], [V::new(1.0, 1.0); 3]);
    // ρ/dt (u - u*) |K|/3 = 6 (1, -2) / 6 at each node.
    assert_close(&r, &[1.0, -2.0, 1.0, -2.0, 1.0, -2.0, 0.0, 0.0, 0.0]);
}

#[test]
fn viscous() {
    // u = (y, 0): ∇u + ∇uᵀ swaps the components of the gradients (-1, -1), (1, 0), (0, 1).
    let r = residual(&Viscous { viscosity: 4.0 }, nodal(|_, y| [y, 0.0]), [0.0; 3], [V::zeros(); 3]);
    assert_close(&r, &[-2.0, -2.0, 0.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn incompressibility() {
    // p = 6: -p |K| ∇N_i. Divergence 1: |K|/3 in each pressure row.
    let r = residual(&Incompressibility, nodal(|x, _| [x, 0.0]), [6.0; 3], [V::zeros(); 3]);
    let third = 1.0 / 6.0;
    assert_close(&r, &[3.0, 3.0, -3.0, 0.0, 0.0, -3.0, third, third, third]);
}

#[test]
fn convection() {
    // u = (x, 0): u·∇u = (x, 0); ∫ x N_i = 1/24, 1/12, 1/24. The skew part adds half of it.
    let term = |skew| Convection { density: 24.0, skew };
    let r = residual(&term(false), nodal(|x, _| [x, 0.0]), [0.0; 3], [V::zeros(); 3]);
    assert_close(&r, &[1.0, 0.0, 2.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    let r = residual(&term(true), nodal(|x, _| [x, 0.0]), [0.0; 3], [V::zeros(); 3]);
    assert_close(&r, &[1.5, 0.0, 3.0, 0.0, 1.5, 0.0, 0.0, 0.0, 0.0]);
    // u = (y, 0): u·∇u = 0, although neither factor is zero.
    let r = residual(&term(true), nodal(|_, y| [y, 0.0]), [0.0; 3], [V::zeros(); 3]);
    assert_close(&r, &[0.0; 9]);
}

#[test]
fn body_force() {
    let force = |x: &Point<2>, t: f64| V::new(x[0] * t, 12.0);
    let r = residual(&BodyForce { force: &force, time: 24.0 }, [V::zeros(); 3], [0.0; 3], [V::zeros(); 3]);
    assert_close(&r, &[-1.0, -2.0, -2.0, -2.0, -1.0, -2.0, 0.0, 0.0, 0.0]);
}

#[test]
fn weights_of_the_face_terms() {
    // u* = (3, 1) at one end of the face, zero at the other; u*·n = ±2/√2 = √2.
    let history = |_, v| if v == VertexId(2) { V::new(3.0, 1.0) } else { V::zeros() };
    let fluid = Fixture::new(mesh(&SQUARE, &[0, 1, 2, 0, 2, 3]), None, &ImplicitEuler, history);
    let [value] = &fluid.faces[..] else { panic!("one interior face") };
    let h = 2.0_f64.sqrt();
    assert!((value.diameter - h).abs() < 1e-15 && (value.measure - h).abs() < 1e-15);
    let face = FluidFace::new(value, &fluid.history, None);
    assert!((face.normal_speed - h).abs() < 1e-14 && (face.speed - 10.0_f64.sqrt()).abs() < 1e-14);
    let consistent = CipVelocity { profile: CipProfile::Consistent { gamma_u: 0.1 }, density: 2.0 };
    assert!((consistent.weight(&face) - 0.1 * 2.0 * 2.0 * h).abs() < 1e-14);
    let paper = CipVelocity { profile: CipProfile::Paper { gamma_1: 0.7 }, density: 2.0 };
    assert!((paper.weight(&face) - 0.7 * 2.0 * h * h).abs() < 1e-14);
    let pressure = CipPressure { gamma_pressure: 0.3, density: 2.0, viscosity: 4.0, rate: 5.0 };
    let tau = 1.0 / (10.0 + 2.0 * 10.0_f64.sqrt() / h + 2.0);
    assert!((pressure.weight(&face) - 0.3 * h * tau).abs() < 1e-14);
    let ghost = GhostPenalty { gamma_ghost: 0.5, viscosity: 4.0 };
    assert_eq!(ghost.weight(&face), 0.0);
    let mut near_cut = *value;
    near_cut.is_ghost = true;
    assert!((ghost.weight(&FluidFace::new(&near_cut, &fluid.history, None)) - 2.0 * h).abs() < 1e-14);
}

#[test]
fn a_face_penalises_the_jump_over_its_whole_length() {
    // The unit square in two triangles, with a field that is one at (1, 0) and zero elsewhere. Its gradient is (1, -1)
    // below the diagonal and zero above, the jump of its normal derivative is √2, and the row of the vertex is c_F |F|
    // jump² = c_F 2 √2.
    let fluid = Fixture::new(mesh(&SQUARE, &[0, 1, 2, 0, 2, 3]), None, &ImplicitEuler, |_, _| V::new(1.0, -1.0));
    let form = FluidForm { inertia: None, convection: None, ..form(2.0, 4.0) };
    let faces = FluidFaces::new(fluid.geometry(), fluid.fields(), |face| form.face_weights(face));
    // u* = (1, -1): |u*·n| = √2 = |u*|, h_F = √2.
    let length = 2.0_f64.sqrt();
    let c_velocity = 0.1 * 2.0 * 2.0 * length;
    let c_pressure = 0.3 * length / (10.0 + 2.0 + 2.0);
    for (row, c) in [(2 * fluid.dof(1), c_velocity), (2 * fluid.dof(1) + 1, c_velocity), (8 + fluid.dof(1), c_pressure)]
    {
        let mut x = vec![0.0; 12];
        x[row] = 1.0;
        let sum = fluid.assembled(&faces, &x);
        assert!((sum[row] - c * length * 2.0).abs() < 1e-13, "{} {}", sum[row], c * length * 2.0);
        assert!(sum.iter().sum::<f64>().abs() < 1e-13, "constants have no jump");
    }
    // Powers of u = (2, 3) and p = 5 at the vertex.
    let mut x = vec![0.0; 12];
    (x[2 * fluid.dof(1)], x[2 * fluid.dof(1) + 1], x[8 + fluid.dof(1)]) = (2.0, 3.0, 5.0);
    let weights = |face: &FluidFace<'_, 2>| {
        let [velocity, pressure] = form.face_weights(face);
        [velocity, 0.5 * velocity, pressure]
    };
    let [velocity, half, pressure] = face_powers(fluid.geometry(), fluid.fields(), None, &x, weights);
    assert!((velocity - c_velocity * length * 2.0 * 13.0).abs() < 1e-12, "{velocity}");
    assert!((half - 0.5 * velocity).abs() < 1e-12, "{half} {velocity}");
    assert!((pressure - c_pressure * length * 2.0 * 25.0).abs() < 1e-12, "{pressure}");
}

#[test]
fn open_boundary() {
    let force = |inflow: f64, backflow: bool, traction: bool| {
        let mesh =
            mesh(&TRIANGLE, &[0, 1, 2]).with_boundary_tags(|x| x.iter().all(|x| x[1] == 0.0).then_some("bottom"));
        // The normal of the bottom is (0, -1): a history that points upwards is inflow.
        let fluid = Fixture::new(mesh, None, &ImplicitEuler, |_, _| V::new(1.0, inflow));
        let t = |_: &Point<2>, n: &V, time: f64| n * time;
        let (t, backflow) =
            (traction.then_some(Traction { traction: &t, time: 7.0 }), backflow.then_some(Backflow { density: 3.0 }));
        let tag = fluid.background.tag("bottom").expect("tagged");
        let values = boundary_points(&fluid.background, &fluid.cut, tag, 3);
        assert_eq!(values.len(), 2);
        let points = OpenBoundary { geometry: fluid.geometry(), fields: fluid.fields(), points: &values };
        let mut open = Integral::linear("open boundary", points, Vec::new());
        open.extend(t.as_ref());
        open.extend(backflow.as_ref());
        let x = [5.0, 1.0, 5.0, 1.0, 5.0, 1.0, 0.0, 0.0, 0.0];
        let deviation = check_tangent(&open, &x, 1e-5);
        assert!(deviation < 1e-9, "{deviation:e}");
        let sum = fluid.assembled(&open, &x);
        // By vertex, independent of the numbering.
        (0..3).flat_map(|v| fluid.layout.at::<2>(fluid.velocity, fluid.dof(v), &sum)).collect::<Vec<_>>()
    };
    // -ρ/2 (-2) (5, 1) on a unit length, half to either end.
    assert_close(&force(2.0, true, false), &[7.5, 1.5, 7.5, 1.5, 0.0, 0.0]);
    assert_close(&force(-2.0, true, false), &[0.0; 6]);
    assert_close(&force(2.0, false, false), &[0.0; 6]);
    // -(t, v) with t = 7 n = (0, -7).
    assert_close(&force(2.0, false, true), &[0.0, 3.5, 0.0, 3.5, 0.0, 0.0]);
}

/// Returns a form with all terms but a body force, with the given density and viscosity.
fn form<'a, const D: usize>(density: f64, viscosity: f64) -> FluidForm<'a, D> {
    FluidForm {
        inertia: Some(Inertia { density }),
        viscous: Viscous { viscosity },
        incompressibility: Incompressibility,
        hoop: None,
        hoop_convection: None,
        convection: Some(Convection { density, skew: false }),
        film: None,
        cavitation: None,
        body_force: None,
        cip_velocity: CipVelocity { profile: CipProfile::Consistent { gamma_u: 0.1 }, density },
        cip_pressure: CipPressure { gamma_pressure: 0.3, density, viscosity, rate: 5.0 },
        ghost_penalty: GhostPenalty { gamma_ghost: 0.5, viscosity },
    }
}

/// Returns a pseudo-random number between -1 and 1.
fn noise(k: usize) -> f64 {
    let x = ((k as f64 + 1.0) * 12.9898).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

/// Returns a background cut by a box, with a random history.
fn cut_by_a_box<const D: usize>() -> Fixture<D> {
    let background = structured_box::<D>([0.0; D], [1.0; D], [4; D]).expect("a box");
    let body = structured_box::<D>([0.28; D], [0.69; D], [1; D]).expect("a box");
    let history = |k: usize, _| Vector::from_fn(|a, _| noise(5 * k + a));
    let fluid = Fixture::new(background, Some(&body), &ImplicitEuler, history);
    let n_cut = fluid.cut.all_parts().filter(|part| !fluid.cut.is_whole(*part)).count();
    assert!(n_cut >= 8 && n_cut < fluid.cut.n_parts(), "{n_cut} cut parts");
    fluid
}

/// State, trial or test function at a point.
#[derive(Clone, Copy)]
struct Field<const D: usize> {
    velocity: Vector<D>,
    /// `grad[(a, b)] = ∂u_a/∂x_b`
    gradient: Tensor<D>,
    acceleration: Vector<D>,
    pressure: f64,
}

impl<const D: usize> Field<D> {
    fn zero() -> Self {
        Self { velocity: Vector::zeros(), gradient: Tensor::zeros(), acceleration: Vector::zeros(), pressure: 0.0 }
    }
}

/// The integrand of a term for transporting field, field and test function, linear in each that it depends on.
type Integrand<const D: usize> = fn(&Field<D>, &Field<D>, &Field<D>) -> f64;

/// Computes residual and tangent of an integrand on one part, by a rule of degree 4. A quadratic integrand depends on
/// the transporting field.
fn by_quadrature<const D: usize>(
    fluid: &Fixture<D>,
    part: PartId,
    x: &[f64],
    integrand: Integrand<D>,
    quadratic: bool,
) -> LocalSystem {
    let (a, fields, dofs) = (&fluid.acceleration, fluid.fields(), fluid.space.dofs(part));
    let gradients = fluid.parts.gradients(part);
    let n_velocities = D * (D + 1);
    let mut out = LocalSystem::new();
    out.reset(n_velocities + D + 1);
    fluid.parts.for_each_point(&fluid.background, &fluid.cut, part, 4, |_, weight, shape| {
        // The basis function of a local row; its velocity and acceleration are scaled.
        let basis = |row: usize, velocity: f64, acceleration: f64| {
            let mut basis = Field::zero();
            if row < n_velocities {
                let (node, mut unit) = (row / D, Vector::<D>::zeros());
                unit[row % D] = 1.0;
                basis.velocity = unit * (velocity * shape[node]);
                basis.gradient = unit * gradients[node].transpose() * velocity;
                basis.acceleration = unit * (acceleration * shape[node]);
            } else {
                basis.pressure = shape[row - n_velocities];
            }
            basis
        };
        let mut state = Field::zero();
        for (i, &dof) in dofs.iter().enumerate() {
            let v = fields.velocity_at(x, dof);
            state.velocity += v * shape[i];
            state.gradient += v * gradients[i].transpose();
            state.acceleration += a.at(dof as usize, v) * shape[i];
            state.pressure += fields.pressure_at(x, dof) * shape[i];
        }
        for row in 0..out.len() {
            let test = basis(row, 1.0, 0.0);
            out.add(row, weight * integrand(&state, &state, &test));
            for column in 0..out.len() {
                let trial = basis(column, 1.0, a.slope);
                let transported = if quadratic { integrand(&trial, &state, &test) } else { 0.0 };
                out.add_tangent(row, column, weight * (integrand(&state, &trial, &test) + transported));
            }
        }
    });
    out
}

/// Returns the largest deviation of residual and tangent, relative to the largest entry of each.
fn deviation(found: &LocalSystem, expected: &LocalSystem) -> f64 {
    let relative = |a: &[f64], b: &[f64]| {
        let largest = b.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        assert!(largest > 0.0 && a.len() == b.len());
        a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / largest
    };
    relative(found.residual(), expected.residual()).max(relative(found.tangent(), expected.tangent()))
}

/// A term, its integrand, and whether that is quadratic.
type Definition<'t, const D: usize> = (&'t dyn for<'a> Term<FluidCell<'a, D>>, Integrand<D>, bool);

fn closed_forms_are_their_definitions<const D: usize>() {
    const DENSITY: f64 = 1.3;
    const VISCOSITY: f64 = 0.7;
    let fluid = cut_by_a_box::<D>();
    let x = fluid.random_state();
    let [plain, skew] = [false, true].map(|skew| Convection { density: DENSITY, skew });
    let terms: [Definition<'_, D>; 5] = [
        (&Inertia { density: DENSITY }, |_, u, v| DENSITY * u.acceleration.dot(&v.velocity), false),
        (
            &Viscous { viscosity: VISCOSITY },
            |_, u, v| VISCOSITY * (u.gradient + u.gradient.transpose()).dot(&v.gradient),
            false,
        ),
        (&Incompressibility, |_, u, v| -u.pressure * v.gradient.trace() + v.pressure * u.gradient.trace(), false),
        (&plain, |w, u, v| DENSITY * (u.gradient * w.velocity).dot(&v.velocity), true),
        (
            &skew,
            |w, u, v| {
                let transport = u.gradient * w.velocity + u.velocity * (0.5 * w.gradient.trace());
                DENSITY * transport.dot(&v.velocity)
            },
            true,
        ),
    ];
    let mut worst = [0.0_f64; 5];
    let mut out = LocalSystem::new();
    for part in fluid.cut.all_parts() {
        for ((term, integrand, quadratic), worst) in terms.iter().zip(&mut worst) {
            let expected = by_quadrature(&fluid, part, &x, *integrand, *quadratic);
            out.reset(expected.len());
            fluid.cells().visit(part.index(), &x, |cell| term.add(cell, &mut out));
            *worst = worst.max(deviation(&out, &expected));
        }
    }
    assert!(worst.iter().all(|worst| *worst < 1e-13), "{worst:?}");
}

#[test]
fn closed_forms_are_their_definitions_in_2d_and_3d() {
    closed_forms_are_their_definitions::<2>();
    closed_forms_are_their_definitions::<3>();
}

fn tangents_are_derivatives<const D: usize>() {
    let fluid = cut_by_a_box::<D>();
    let x = fluid.random_state();
    let force = |x: &Point<D>, t: f64| x * (3.0 + t) + Vector::repeat(1.0);
    let form = form(1.3, 0.7);
    let check = |contributions: &dyn Contributions| {
        let deviation = check_tangent(contributions, &x, 1e-5);
        assert!(deviation < 1e-8, "{}: {deviation:e}", contributions.name());
    };
    let body_force = BodyForce { force: &force, time: 0.3 };
    let linear = |name, term| check(&Integral::linear(name, fluid.cells(), vec![term]));
    linear("inertia", &Inertia { density: 1.3 });
    linear("viscous", &form.viscous);
    linear("incompressibility", &form.incompressibility);
    linear("body force", &body_force);
    for skew in [false, true] {
        let term = Convection { density: 1.3, skew };
        check(&Integral::new("convection", fluid.cells(), vec![&term]));
        let sites = FluidCells::of_velocity(fluid.geometry(), fluid.fields());
        check(&Integral::new("convection of velocities", sites, vec![&term]));
    }
    let form = FluidForm { body_force: Some(body_force), ..form };
    form.contributions(fluid.geometry(), fluid.fields()).iter().for_each(|part| check(part.as_ref()));
}

#[test]
fn tangents_are_derivatives_in_2d_and_3d() {
    tangents_are_derivatives::<2>();
    tangents_are_derivatives::<3>();
}

#[test]
fn a_form_is_the_sum_of_the_terms_that_it_has() {
    let fluid = cut_by_a_box::<2>();
    let x = fluid.random_state();
    let force = |x: &Point<2>, t: f64| x * (3.0 + t) + Vector::repeat(1.0);
    for combination in 0..8 {
        let has = |bit: usize| combination & bit == bit;
        let convection = Convection { density: 1.3, skew: has(2) };
        let full = form(1.3, 0.7);
        let form = FluidForm {
            inertia: full.inertia.filter(|_| has(1)),
            convection: Some(convection),
            film: None,
            cavitation: None,
            body_force: has(4).then_some(BodyForce { force: &force, time: 0.3 }),
            ..full
        };
        let mut terms: Vec<&dyn Term<FluidCell<'_, 2>>> = vec![&form.viscous, &form.incompressibility];
        terms.extend(form.inertia.iter().map(|term| term as &dyn Term<FluidCell<'_, 2>>));
        terms.extend(form.body_force.iter().map(|term| term as &dyn Term<FluidCell<'_, 2>>));
        terms.extend(form.convection.iter().map(|term| term as &dyn Term<FluidCell<'_, 2>>));
        let expected = fluid.assembled(&Integral::new("terms", fluid.cells(), terms), &x);
        let [cells, convection, _] = &form.contributions(fluid.geometry(), fluid.fields())[..] else {
            panic!("cells, convection, faces")
        };
        let found = fluid
            .assembled(cells.as_ref(), &x)
            .into_iter()
            .zip(fluid.assembled(convection.as_ref(), &x))
            .map(|(a, b)| a + b);
        for (found, expected) in found.zip(expected) {
            assert!((found - expected).abs() < 1e-13, "combination {combination}: {found} {expected}");
        }
    }
}
