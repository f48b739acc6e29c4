//! Stokes flow around a disk or sphere that cuts the mesh, with a known solution.

use std::f64::consts::PI;

use algebra::{BlockLayout, Constraints, Contributions, FieldId, NonlinearProblem};
use cutcell::{CutMesh, OverlayOptions};
use fluid_ns::terms::{
    BodyForce, CipPressure, CipProfile, CipVelocity, GhostPenalty, Incompressibility, Traction, Viscous,
};
use fluid_ns::{FluidCells, FluidFaces, FluidFields, FluidForm, FluidGeometry, NewtonianFluid, OpenBoundary};
use interface_dg::{BodySide, InterfacePieces, MortarForm, PieceValues};
use mesh::generate::structured_box;
use mesh::{BoundaryMesh, Placed, Point, SimplexMesh, Tensor, Vector, VertexId};
use xfem_space::{BoundaryValues, FaceValues, PartValues, XfemSpace, boundary_dofs};

use crate::published_forms::{TransposedGradient, project_sides};
use crate::{BODY_CENTRE, polygon, sphere};

/// Radius of the disk.
const RADIUS: f64 = 0.2;
/// Dynamic viscosity.
pub(crate) const VISCOSITY: f64 = 1.0;
/// Degree of quadrature of the forms.
const DEGREE: usize = 2;
/// Degree of quadrature of the errors.
const ERROR_DEGREE: usize = 4;

/// The weights of the stabilisation, each in front of the form that this library has for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StokesWeights {
    /// `γ_Σ` of `γ_Σ μ/h_K (u - g, v)`.
    pub nitsche: f64,
    /// `γ_p` of `γ_p h_F³/μ ([∇p]n, [∇q]n)`.
    pub pressure: f64,
    /// `γ_g` of `γ_g μ h_F ([∇u]n, [∇v]n)`.
    pub ghost: f64,
}

impl StokesWeights {
    /// The numbers of the published comparison: 20, 0.05, 0.1.
    ///
    /// There h is the side of a square everywhere. Here `h_K` is the side of the equilateral triangle of the same area,
    /// 1.07 h, and `h_F` the length of the face, h on two of three faces and 1.41 h on diagonals.
    pub const PUBLISHED: Self = Self { nitsche: 20.0, pressure: 0.05, ghost: 0.1 };
}

/// Velocity of the solution, `(sin πx cos πy, -cos πx sin πy)`, without third component.
pub(crate) fn velocity<const D: usize>(x: &Point<D>, _time: f64) -> Vector<D> {
    let ((sx, cx), (sy, cy)) = ((PI * x[0]).sin_cos(), (PI * x[1]).sin_cos());
    let mut u = Vector::zeros();
    u[0] = sx * cy;
    u[1] = -cx * sy;
    u
}

/// Its gradient.
fn velocity_gradient<const D: usize>(x: &Point<D>) -> Tensor<D> {
    let ((sx, cx), (sy, cy)) = ((PI * x[0]).sin_cos(), (PI * x[1]).sin_cos());
    let mut gradient = Tensor::zeros();
    gradient[(0, 0)] = PI * cx * cy;
    gradient[(0, 1)] = -PI * sx * sy;
    gradient[(1, 0)] = PI * sx * sy;
    gradient[(1, 1)] = -PI * cx * cy;
    gradient
}

/// Pressure of the solution, `sin πx cos πy`.
fn pressure<const D: usize>(x: &Point<D>) -> f64 {
    (PI * x[0]).sin() * (PI * x[1]).cos()
}

/// Body force, `2 π² μ u + ∇p`.
fn force<const D: usize>(x: &Point<D>, _time: f64) -> Vector<D> {
    let ((sx, cx), (sy, cy)) = ((PI * x[0]).sin_cos(), (PI * x[1]).sin_cos());
    let viscous = 2.0 * PI * PI * VISCOSITY;
    let mut f = Vector::zeros();
    f[0] = viscous * sx * cy + PI * cx * cy;
    f[1] = -viscous * cx * sy - PI * sx * sy;
    f
}

/// Traction of the solution with the published forms, `μ ∇u n - p n`.
fn published_traction<const D: usize>(x: &Point<D>, n: &Vector<D>, _time: f64) -> Vector<D> {
    velocity_gradient(x) * n * VISCOSITY - n * pressure(x)
}

/// Traction of the solution, `T n`.
fn traction<const D: usize>(x: &Point<D>, n: &Vector<D>, _time: f64) -> Vector<D> {
    NewtonianFluid { density: 1.0, viscosity: VISCOSITY }.stress(pressure(x), &velocity_gradient(x)) * n
}

/// Cut, space and shape values of steady Stokes flow in the box `[-1/2, 1/2]^D` without a ball of radius 0.2: the
/// velocity is given on the ball (weakly) and on all sides but `x = 1/2`, where the traction is.
///
/// The background has N² squares of two triangles, or N³ cubes of six tetrahedra.
pub struct UnfittedStokes<const D: usize> {
    weights: StokesWeights,
    has_published_forms: bool,
    pub(crate) background: SimplexMesh<D>,
    pub(crate) cut: CutMesh<D>,
    pub(crate) space: XfemSpace<D>,
    pub(crate) parts: PartValues<D>,
    faces: FaceValues<D>,
    pub(crate) pieces: PieceValues<D>,
    at_rest: Vec<Vector<D>>,
    layout: BlockLayout,
    velocity: FieldId,
    pressure: FieldId,
    pub(crate) constraints: Constraints,
    mortar: MortarForm,
}

/// The problem, ready to be solved.
pub struct StokesProblem<'a, const D: usize> {
    stokes: &'a UnfittedStokes<D>,
    cells: FluidCells<'a, D>,
    faces: FluidFaces<'a, D>,
    outlet: OpenBoundary<'a, D>,
    interface: InterfacePieces<'a, D>,
    transposed_gradient: Option<TransposedGradient<'a, D>>,
}

/// Errors of a discrete solution over the fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StokesErrors {
    /// `‖u - u_h‖` in L2.
    pub velocity: f64,
    /// `‖∇u - ∇u_h‖` in L2.
    pub gradient: f64,
    /// `‖p - p_h‖` in L2.
    pub pressure: f64,
}

impl<const D: usize> UnfittedStokes<D> {
    fn new(n: u32, (positions, boundary): &(Vec<Point<D>>, BoundaryMesh<D>), weights: StokesWeights) -> Self {
        let background = falling_diagonals::<D>(n as usize);
        let cut = CutMesh::overlay(&background, &[Placed::new(boundary, positions)], &OverlayOptions::new())
            .expect("a closed surface");
        let space = XfemSpace::new(&background, &cut);
        let parts = PartValues::new(&background, &cut, DEGREE);
        let faces = FaceValues::new(&background, &cut, &space, &parts);
        let pieces = PieceValues::new(&background, &cut, &parts, DEGREE);
        let mut layout = BlockLayout::new();
        let velocity_field = layout.push("velocity", D * space.len());
        let pressure = layout.push("pressure", space.len());
        let mut constraints = Constraints::new();
        for name in SIDES.iter().filter(|name| **name != "right") {
            let Some(tag) = background.tag(name) else { continue };
            for dof in boundary_dofs(&background, &cut, &space, tag) {
                let u = velocity(&background.vertex(space.vertex(dof)), 0.0);
                (0..D).for_each(|a| constraints.set(layout.dof(velocity_field, D * dof as usize + a), u[a]));
            }
        }
        Self {
            weights,
            has_published_forms: false,
            at_rest: vec![Vector::zeros(); space.len()],
            mortar: MortarForm::new(NewtonianFluid { density: 1.0, viscosity: VISCOSITY }, weights.nitsche),
            background,
            cut,
            space,
            parts,
            faces,
            pieces,
            layout,
            velocity: velocity_field,
            pressure,
            constraints,
        }
    }

    /// Number of active elements: cells with fluid.
    pub fn n_active(&self) -> usize {
        self.background.cells().filter(|&cell| self.cut.parts(cell).len() > 0).count()
    }

    /// Computes the shape values on parts, faces and interface pieces anew: what a step does before it assembles.
    pub fn evaluate_shapes(&mut self) {
        self.parts = PartValues::new(&self.background, &self.cut, DEGREE);
        self.faces = FaceValues::new(&self.background, &self.cut, &self.space, &self.parts);
        self.pieces = PieceValues::new(&self.background, &self.cut, &self.parts, DEGREE);
    }

    /// Calls a closure with the problem.
    pub fn with_problem<R>(&self, then: impl FnOnce(&StokesProblem<'_, D>) -> R) -> R {
        let geometry = FluidGeometry {
            background: &self.background,
            cut: &self.cut,
            space: &self.space,
            parts: &self.parts,
            faces: &self.faces,
            history: &self.at_rest,
        };
        let form = FluidForm {
            inertia: None,
            viscous: Viscous { viscosity: VISCOSITY },
            incompressibility: Incompressibility,
            convection: None,
            body_force: BodyForce { force: Some(&force), time: 0.0 },
            cip_velocity: CipVelocity { profile: CipProfile::Consistent { gamma_u: 0.0 }, density: 1.0 },
            cip_pressure: CipPressure {
                gamma_pressure: self.weights.pressure,
                density: 1.0,
                viscosity: VISCOSITY,
                rate: 0.0,
            },
            ghost_penalty: GhostPenalty { gamma_ghost: self.weights.ghost, viscosity: VISCOSITY },
        };
        let fields = FluidFields { layout: &self.layout, velocity: self.velocity, pressure: self.pressure };
        let right = self.background.tag("right").expect("sides of a box are tagged");
        then(&StokesProblem {
            stokes: self,
            cells: FluidCells { geometry: &geometry, fields, form: &form },
            faces: FluidFaces::new(&geometry, fields, &form),
            outlet: OpenBoundary {
                geometry: &geometry,
                fields,
                values: BoundaryValues::new(&self.background, &self.cut, right, DEGREE + 1),
                traction: Traction {
                    traction: Some(if self.has_published_forms { &published_traction } else { &traction }),
                    time: 0.0,
                },
                backflow: None,
            },
            interface: InterfacePieces {
                geometry: &geometry,
                fields,
                values: &self.pieces,
                bodies: &[BodySide::Prescribed { velocity: &|x, _| velocity(x, 0.0), times: [0.0; 2] }],
                form: &self.mortar,
            },
            transposed_gradient: self.has_published_forms.then_some(TransposedGradient { stokes: self, fields }),
        })
    }

    /// Errors of a discrete solution.
    pub fn errors(&self, x: &[f64]) -> StokesErrors {
        let parts = PartValues::new(&self.background, &self.cut, ERROR_DEGREE);
        let fields = FluidFields { layout: &self.layout, velocity: self.velocity, pressure: self.pressure };
        let mut squares = [0.0; 3];
        for part in self.cut.all_parts() {
            let dofs = self.space.dofs(part);
            let corners = self.background.simplex(self.cut.part_cell(part));
            let mut gradient = Tensor::<D>::zeros();
            for (&dof, g) in dofs.iter().zip(parts.gradients(part)) {
                gradient += fields.velocity_at::<D>(x, dof) * g.transpose();
            }
            for q in parts.points(part) {
                let at: Point<D> = corners.points().iter().zip(&q.shape).map(|(x, n)| x * *n).sum();
                let u: Vector<D> = dofs.iter().zip(&q.shape).map(|(&k, n)| fields.velocity_at(x, k) * *n).sum();
                let p: f64 = dofs.iter().zip(&q.shape).map(|(&k, n)| fields.pressure_at(x, k) * n).sum();
                squares[0] += q.weight * (u - velocity(&at, 0.0)).norm_squared();
                squares[1] += q.weight * (gradient - velocity_gradient(&at)).norm_squared();
                squares[2] += q.weight * (p - pressure(&at)).powi(2);
            }
        }
        let [velocity, gradient, pressure] = squares.map(f64::sqrt);
        StokesErrors { velocity, gradient, pressure }
    }
}

/// The box with the diagonals of its squares from the lower right to the upper left, as peers lay them: the mirror image
/// of the library's own.
fn falling_diagonals<const D: usize>(n: usize) -> SimplexMesh<D> {
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

/// Names of the sides of a box.
pub(crate) const SIDES: [&str; 6] = ["left", "right", "bottom", "top", "back", "front"];

impl UnfittedStokes<2> {
    /// Around a disk with edges as long as those of the N² squares.
    pub fn around_disk(n: u32, weights: StokesWeights) -> Self {
        let n_edges = (std::f64::consts::TAU * RADIUS * f64::from(n)).round() as u32;
        Self::new(n, &polygon(BODY_CENTRE, RADIUS, n_edges), weights)
    }

    /// The same with the viscous form and the data on the sides of the published comparison: `μ (∇u, ∇v)` and a local L2
    /// projection. Only for comparing errors.
    #[must_use]
    pub fn with_published_forms(mut self) -> Self {
        self.has_published_forms = true;
        project_sides(&mut self);
        self
    }
}

impl UnfittedStokes<3> {
    /// Around a sphere with facets as large as the sides of the N³ cubes.
    pub fn around_sphere(n: u32, weights: StokesWeights) -> Self {
        let n_per_octant = (0.5 * std::f64::consts::PI * RADIUS * f64::from(n)).ceil() as u32;
        Self::new(n, &sphere(BODY_CENTRE, RADIUS, n_per_octant), weights)
    }
}

impl<const D: usize> NonlinearProblem for StokesProblem<'_, D> {
    fn layout(&self) -> &BlockLayout {
        &self.stokes.layout
    }

    fn contributions(&self) -> Vec<&dyn Contributions> {
        let mut all: Vec<&dyn Contributions> = vec![&self.cells, &self.faces, &self.outlet, &self.interface];
        all.extend(self.transposed_gradient.iter().map(|c| c as &dyn Contributions));
        all
    }

    fn constraints(&self) -> &Constraints {
        &self.stokes.constraints
    }
}
