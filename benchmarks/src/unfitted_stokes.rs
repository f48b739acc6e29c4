//! Stokes flow with a known solution around a disk or sphere that cuts the mesh. The weak forms are those of this
//! library, or those of a published comparison with ngsxfem.

use std::collections::HashMap;
use std::f64::consts::PI;

use algebra::time::Affine;
use algebra::{
    BlockLayout, Constraints, Contributions, DofId, Equations, FieldId, Integral, LocalSystem, NewtonError,
    NewtonSettings, Workspace, newton,
};
use body::{SurfaceMotion, SurfaceVelocity};
use cutcell::{CutMesh, OverlayOptions, PartId};
use fluid_ns::terms::{
    BodyForce, CipPressure, CipProfile, CipVelocity, GhostPenalty, Incompressibility, Traction, Viscous,
};
use fluid_ns::{FluidFields, FluidForm, FluidGeometry, NewtonianFluid, OpenBoundary};
use interface_dg::terms::PenaltyProfile;
use interface_dg::{InterfacePoints, MortarForm, PieceValues};
use mesh::generate::structured_box;
use mesh::{BoundaryMesh, MAX_CELL_VERTICES, Placed, Point, SimplexMesh, SimplexRule, Tensor, Vector, VertexId};
use xfem_space::{FaceValue, PartValues, XfemSpace, boundary_dofs, boundary_points, face_values};

use crate::shapes::{BODY_CENTRE, SIDES, polygon, sphere};

/// Radius of the disk.
const RADIUS: f64 = 0.2;
/// Dynamic viscosity.
const VISCOSITY: f64 = 1.0;
/// The fluid. A steady flow does not depend on the density.
const FLUID: NewtonianFluid = NewtonianFluid { density: 1.0, viscosity: VISCOSITY };
/// Degree of quadrature on the interface.
const DEGREE: usize = 2;
/// Degree of quadrature of the errors.
const ERROR_DEGREE: usize = 4;

/// Weight `γ_Σ` of `γ_Σ μ/h_K (u - g, v)` in the published comparison.
///
/// The comparison has the side h of a square in all weights. In this library `h_K` is the side of the equilateral
/// triangle of the same area, 1.07 h, and `h_F` is the length of the face: h, and 1.41 h on diagonals.
const NITSCHE: f64 = 20.0;
/// Weight `γ_p` of `γ_p h_F³/μ ([∇p]n, [∇q]n)` in the published comparison.
const PRESSURE: f64 = 0.05;
/// Weight `γ_g` of `γ_g μ h_F ([∇u]n, [∇v]n)` in the published comparison.
const GHOST: f64 = 0.1;

/// Returns the velocity of the solution, `(sin πx cos πy, -cos πx sin πy)`. In 3D the third component is zero.
fn velocity<const D: usize>(x: &Point<D>, _time: f64) -> Vector<D> {
    let ((sx, cx), (sy, cy)) = ((PI * x[0]).sin_cos(), (PI * x[1]).sin_cos());
    let mut u = Vector::zeros();
    u[0] = sx * cy;
    u[1] = -cx * sy;
    u
}

/// Returns the gradient of the velocity; entry `(i, j)` is `∂u_i/∂x_j`.
fn velocity_gradient<const D: usize>(x: &Point<D>) -> Tensor<D> {
    let ((sx, cx), (sy, cy)) = ((PI * x[0]).sin_cos(), (PI * x[1]).sin_cos());
    let mut gradient = Tensor::zeros();
    gradient[(0, 0)] = PI * cx * cy;
    gradient[(0, 1)] = -PI * sx * sy;
    gradient[(1, 0)] = PI * sx * sy;
    gradient[(1, 1)] = -PI * cx * cy;
    gradient
}

/// Returns the pressure of the solution, `sin πx cos πy`.
fn pressure<const D: usize>(x: &Point<D>) -> f64 {
    (PI * x[0]).sin() * (PI * x[1]).cos()
}

/// Returns the body force, `2 π² μ u + ∇p`.
fn force<const D: usize>(x: &Point<D>, _time: f64) -> Vector<D> {
    let ((sx, cx), (sy, cy)) = ((PI * x[0]).sin_cos(), (PI * x[1]).sin_cos());
    let viscous = 2.0 * PI * PI * VISCOSITY;
    let mut f = Vector::zeros();
    f[0] = viscous * sx * cy + PI * cx * cy;
    f[1] = -viscous * cx * sy - PI * sx * sy;
    f
}

/// Returns the traction of the solution with the published forms, `μ ∇u n - p n`.
fn published_traction<const D: usize>(x: &Point<D>, n: &Vector<D>, _time: f64) -> Vector<D> {
    velocity_gradient(x) * n * VISCOSITY - n * pressure(x)
}

/// Returns the traction of the solution, `T n`.
fn traction<const D: usize>(x: &Point<D>, n: &Vector<D>, _time: f64) -> Vector<D> {
    FLUID.stress(pressure(x), &velocity_gradient(x)) * n
}

/// Returns the mortar with the uniform penalty of the published comparison.
fn mortar(gamma_sigma: f64) -> MortarForm {
    MortarForm::new(FLUID, PenaltyProfile::Uniform { gamma_sigma }, 0.0)
}

/// Cut, space and shape values of steady Stokes flow in the box `[-1/2, 1/2]^D` around a ball of radius 0.2. The
/// velocity is prescribed on the ball (weakly) and on all sides except `x = 1/2`, where the traction is prescribed.
///
/// The background has N² squares of two triangles, or N³ cubes of six tetrahedra.
pub struct UnfittedStokes<const D: usize> {
    has_published_forms: bool,
    background: SimplexMesh<D>,
    cut: CutMesh<D>,
    space: XfemSpace<D>,
    parts: PartValues<D>,
    faces: Vec<FaceValue<D>>,
    pieces: PieceValues<D>,
    /// Velocity of the previous step, zero.
    at_rest: Vec<Vector<D>>,
    /// Acceleration of a steady flow, zero.
    no_acceleration: Affine<Vector<D>>,
    /// Surface of the ball.
    boundary: BoundaryMesh<D>,
    /// Positions of its vertices, in a list of one body.
    positions: Vec<Vec<Point<D>>>,
    layout: BlockLayout,
    velocity: FieldId,
    pressure: FieldId,
    constraints: Constraints,
    mortar: MortarForm,
}

impl<const D: usize> UnfittedStokes<D> {
    fn new(n: u32, (positions, boundary): (Vec<Point<D>>, BoundaryMesh<D>)) -> Self {
        let background = mirrored_box::<D>(n as usize);
        let cut = CutMesh::overlay(&background, &[Placed::new(&boundary, &positions)], &OverlayOptions::new())
            .expect("a closed surface");
        let space = XfemSpace::new(&background, &cut);
        let parts = PartValues::new(&background, &cut);
        let faces = face_values(&background, &cut, &space, &parts);
        let pieces = PieceValues::new(&background, &cut, &parts, &[&boundary], DEGREE);
        let mut layout = BlockLayout::new();
        let velocity_field = layout.push("velocity", space.len(), D);
        let pressure = layout.push_on(velocity_field, "pressure", 1);
        let mut constraints = Constraints::new();
        for name in SIDES.iter().filter(|name| **name != "right") {
            let Some(tag) = background.tag(name) else { continue };
            for dof in boundary_dofs(&background, &cut, &space, tag) {
                let u = velocity(&background.vertex(space.vertex(dof)), 0.0);
                (0..D).for_each(|a| constraints.set(layout.dof(velocity_field, dof as usize, a), u[a]));
            }
        }
        Self {
            has_published_forms: false,
            at_rest: vec![Vector::zeros(); space.len()],
            no_acceleration: Affine { slope: 0.0, predicted: Vec::new() },
            mortar: mortar(NITSCHE),
            background,
            cut,
            space,
            parts,
            faces,
            pieces,
            boundary,
            positions: vec![positions],
            layout,
            velocity: velocity_field,
            pressure,
            constraints,
        }
    }

    /// Returns the problem with the weight `gamma_sigma` of the Nitsche penalty instead of the published 20.
    #[must_use]
    pub fn with_nitsche(mut self, gamma_sigma: f64) -> Self {
        self.mortar = mortar(gamma_sigma);
        self
    }

    /// Returns the number of active elements: cells with fluid.
    pub fn n_active(&self) -> usize {
        self.background.cells().filter(|&cell| self.cut.parts(cell).len() > 0).count()
    }

    /// Recomputes the shape values on parts, faces and interface pieces, as every time step does before assembly.
    pub fn evaluate_shapes(&mut self) {
        self.parts = PartValues::new(&self.background, &self.cut);
        self.faces = face_values(&self.background, &self.cut, &self.space, &self.parts);
        self.pieces = PieceValues::new(&self.background, &self.cut, &self.parts, &[&self.boundary], DEGREE);
    }

    /// Calls a closure with the equations.
    pub fn with_equations<R>(&self, then: impl FnOnce(&Equations<'_>) -> R) -> R {
        let geometry = FluidGeometry {
            background: &self.background,
            cut: &self.cut,
            space: &self.space,
            parts: &self.parts,
            faces: &self.faces,
            known_velocity: &self.at_rest,
            films: None,
            acceleration: &self.no_acceleration,
        };
        let form = FluidForm {
            inertia: None,
            viscous: Viscous { viscosity: VISCOSITY },
            incompressibility: Incompressibility,
            hoop: None,
            hoop_convection: None,
            convection: None,
            film: None,
            cavitation: None,
            body_force: Some(BodyForce { force: &force, time: 0.0 }),
            cip_velocity: CipVelocity { profile: CipProfile::Consistent { gamma_u: 0.0 }, density: 1.0 },
            cip_pressure: CipPressure { gamma_pressure: PRESSURE, density: 1.0, viscosity: VISCOSITY, rate: 0.0 },
            ghost_penalty: GhostPenalty { gamma_ghost: GHOST, viscosity: VISCOSITY },
        };
        let fields = self.fields();
        let right = self.background.tag("right").expect("sides of a box are tagged");
        let outlet = boundary_points(&self.background, &self.cut, right, DEGREE + 1);
        let traction =
            Traction { traction: if self.has_published_forms { &published_traction } else { &traction }, time: 0.0 };
        let ball = SurfaceMotion {
            boundary: &self.boundary,
            geometry: self.positions[0].clone(),
            start: self.positions[0].clone(),
            end: Affine { slope: 0.0, predicted: self.positions[0].clone() },
            stage: None,
            velocity: SurfaceVelocity::Given(Box::new(|x| velocity(x, 0.0))),
        };
        let interface = InterfacePoints {
            geometry,
            fields,
            values: &self.pieces,
            surfaces: vec![&ball],
            fluid: FLUID,
            solid: None,
        };
        let mut contributions = form.contributions(geometry, fields);
        let outlet = OpenBoundary { geometry, fields, points: &outlet };
        contributions.push(Box::new(Integral::linear("open boundary", outlet, vec![&traction])));
        contributions.push(Box::new(self.mortar.contributions(interface)));
        if self.has_published_forms {
            contributions.push(Box::new(TransposedGradient { stokes: self, fields }));
        }
        then(&Equations { layout: &self.layout, contributions, constraints: &self.constraints })
    }

    fn fields(&self) -> FluidFields<'_> {
        FluidFields { layout: &self.layout, velocity: self.velocity, pressure: self.pressure }
    }

    /// Solves, and returns the errors in L2 of velocity, its gradient and pressure over the fluid.
    ///
    /// # Errors
    /// Newton's method fails.
    pub fn errors(&self) -> Result<[f64; 3], NewtonError> {
        let x = self.with_equations(|equations| {
            let mut x = vec![0.0; equations.layout.len()];
            newton(equations, &mut x, &mut Workspace::new(), &NewtonSettings::new(1e-9)).map(|_| x)
        })?;
        let fields = self.fields();
        let mut squares = [0.0; 3];
        for part in self.cut.all_parts() {
            let dofs = self.space.dofs(part);
            let mut gradient = Tensor::<D>::zeros();
            for (&dof, g) in dofs.iter().zip(self.parts.gradients(part)) {
                gradient += fields.velocity_at::<D>(&x, dof) * g.transpose();
            }
            self.parts.for_each_point(&self.background, &self.cut, part, ERROR_DEGREE, |at, weight, shape| {
                let u: Vector<D> = dofs.iter().zip(shape).map(|(&k, n)| fields.velocity_at(&x, k) * *n).sum();
                let p: f64 = dofs.iter().zip(shape).map(|(&k, n)| fields.pressure_at(&x, k) * n).sum();
                squares[0] += weight * (u - velocity(at, 0.0)).norm_squared();
                squares[1] += weight * (gradient - velocity_gradient(at)).norm_squared();
                squares[2] += weight * (p - pressure(at)).powi(2);
            });
        }
        Ok(squares.map(f64::sqrt))
    }
}

/// Returns the mirror image of [`structured_box`]. The diagonals of its squares go from the lower right to the upper
/// left, as in the published comparison.
fn mirrored_box<const D: usize>(n: usize) -> SimplexMesh<D> {
    let rising = structured_box::<D>([-0.5; D], [0.5; D], [n; D]).expect("a box");
    let mirrored = |x: &Point<D>| Point::<D>::from_fn(|axis, _| if axis == 0 { -x[axis] } else { x[axis] });
    let vertices = rising.vertices().iter().map(mirrored).collect();
    let mut cells: Vec<VertexId> = rising.cells().flat_map(|cell| rising.cell(cell).iter().copied()).collect();
    // A mirror image has the opposite orientation.
    cells.chunks_exact_mut(D + 1).for_each(|cell| cell.swap(0, 1));
    let side_of = |facet: &[Point<D>]| {
        let lies_on = |axis: usize, value: f64| facet.iter().all(|x| x[axis] == value);
        (0..D).flat_map(|axis| [(axis, -0.5), (axis, 0.5)]).zip(SIDES).find(|((k, v), _)| lies_on(*k, *v)).map(|s| s.1)
    };
    SimplexMesh::new(vertices, cells).expect("positive cells").with_boundary_tags(side_of)
}

impl UnfittedStokes<2> {
    /// Published errors of ngsxfem 2.1 on the same mesh: N, then the errors in L2 of the velocity, its gradient and the
    /// pressure. The viscous form of ngsxfem is `μ (∇u, ∇v)`, and velocities on the sides are a local L2 projection.
    /// The errors on the last mesh have fewer digits.
    pub const PUBLISHED_ERRORS: [(u32, [f64; 3]); 4] = [
        (32, [9.382e-4, 0.15064, 2.2667e-2]),
        (64, [2.3916e-4, 0.075268, 6.8153e-3]),
        (128, [6.0555e-5, 0.037621, 2.1170e-3]),
        (256, [1.5e-5, 0.0188, 6.8e-4]),
    ];

    /// Creates the problem around a disk, with edges of the length of the sides of the N² squares.
    pub fn around_disk(n: u32) -> Self {
        let n_edges = (std::f64::consts::TAU * RADIUS * f64::from(n)).round() as u32;
        Self::new(n, polygon(BODY_CENTRE, RADIUS, n_edges))
    }

    /// Returns the problem with the viscous form `μ (∇u, ∇v)` and the boundary values (a local L2 projection) of the
    /// published comparison, to compare errors.
    #[must_use]
    pub fn with_published_forms(mut self) -> Self {
        self.has_published_forms = true;
        project_sides(&mut self);
        self
    }
}

impl UnfittedStokes<3> {
    /// Creates the problem around a sphere, with facets of the size of the sides of the N³ cubes.
    pub fn around_sphere(n: u32) -> Self {
        let n_per_octant = (0.5 * std::f64::consts::PI * RADIUS * f64::from(n)).ceil() as u32;
        Self::new(n, sphere(BODY_CENTRE, RADIUS, n_per_octant))
    }
}

/// `-μ (∇uᵀ, ∇v)_Ω + μ (∇uᵀ n^f, v)_Σ + μ (u - g, ∇vᵀ n^f)_Σ`
///
/// Changes the viscous form from `2 μ (D(u), ∇v)` to `μ (∇u, ∇v)`, and the traction on the ball to `μ ∇u n - p n`.
/// Items are the parts, then the interface pieces.
struct TransposedGradient<'a, const D: usize> {
    stokes: &'a UnfittedStokes<D>,
    fields: FluidFields<'a>,
}

impl<const D: usize> TransposedGradient<'_, D> {
    fn part(&self, item: usize) -> PartId {
        let n_parts = self.stokes.cut.n_parts();
        if item < n_parts { PartId(item as u32) } else { self.stokes.cut.interface()[item - n_parts].part }
    }
}

impl<const D: usize> Contributions for TransposedGradient<'_, D> {
    fn name(&self) -> &'static str {
        "transposed gradient"
    }

    fn len(&self) -> usize {
        self.stokes.cut.n_parts() + self.stokes.cut.interface().len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        for &dof in self.stokes.space.dofs(self.part(item)) {
            out.extend(self.fields.layout.node(self.fields.velocity, dof as usize));
        }
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let part = self.part(item);
        let g = self.stokes.parts.gradients(part);
        let dofs = self.stokes.space.dofs(part);
        let mut u = [Vector::<D>::zeros(); MAX_CELL_VERTICES];
        u.iter_mut().zip(dofs).for_each(|(u, &dof)| *u = self.fields.velocity_at(x, dof));
        let grad_u: Tensor<D> = u.iter().zip(g).map(|(u, g)| u * g.transpose()).sum();
        let n_parts = self.stokes.cut.n_parts();
        let Some(piece) = item.checked_sub(n_parts) else {
            let weight = -VISCOSITY * self.stokes.parts.moments(part).volume();
            for i in 0..=D {
                out.add_vector::<D>(D * i, grad_u.transpose() * g[i] * weight);
                for j in 0..=D {
                    out.add_block::<D, D>(D * i, D * j, g[j] * g[i].transpose() * weight);
                }
            }
            return;
        };
        let n = -self.stokes.cut.interface()[piece].normal;
        for q in self.stokes.pieces.points(piece) {
            let weight = VISCOSITY * q.weight;
            let jump = u.iter().zip(&q.fluid).map(|(u, n)| u * *n).sum::<Vector<D>>() - velocity(&q.point, 0.0);
            for i in 0..=D {
                let force = grad_u.transpose() * n * q.fluid[i] + n * g[i].dot(&jump);
                out.add_vector::<D>(D * i, force * weight);
                for j in 0..=D {
                    let k = g[j] * n.transpose() * q.fluid[i] + n * g[i].transpose() * q.fluid[j];
                    out.add_block::<D, D>(D * i, D * j, k * weight);
                }
            }
        }
    }

    fn is_linear(&self) -> bool {
        true
    }
}

/// Replaces the prescribed velocities on the sides of a square by those of the published comparison. They are the mean
/// at each vertex of the L2 projections on its two boundary edges. Unconstrained dofs stay unconstrained.
fn project_sides(stokes: &mut UnfittedStokes<2>) {
    let rule = SimplexRule::of_degree(1, 4);
    let mut at_vertex: HashMap<u32, (Vector<2>, f64)> = HashMap::new();
    for facet in stokes.background.facets().filter(|&facet| stokes.background.is_boundary(facet)) {
        let ends = stokes.background.facet(facet);
        let corners: Vec<Point<2>> = ends.iter().map(|&v| stokes.background.vertex(v)).collect();
        for (k, end) in ends.iter().enumerate() {
            let (sum, n) = at_vertex.entry(end.0).or_insert((Vector::zeros(), 0.0));
            *n += 1.0;
            for (l, weight) in rule.points().iter().zip(rule.weights()) {
                let u = velocity(&(corners[0] * l[0] + corners[1] * l[1]), 0.0);
                // The dual basis of the two shape functions on an edge of unit length.
                *sum += u * (weight * (6.0 * l[k] - 2.0));
            }
        }
    }
    let mut projected = Constraints::new();
    for (node, vertex) in stokes.space.vertices().iter().enumerate() {
        for (component, dof) in stokes.layout.node(stokes.velocity, node).enumerate() {
            if stokes.constraints.get(dof).is_some() {
                let (sum, n) = at_vertex[&vertex.0];
                projected.set(dof, sum[component] / n);
            }
        }
    }
    stokes.constraints = projected;
}
