//! What a scenario file may say: serde types, nothing else.
//!
//! Every physical and every penalty parameter must be given; there are no silent defaults. Units are those of the
//! file's `units`; in 2D all forces, masses and energies are per unit depth.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub use super::condition::{BodyCondition, FluidCondition, Size};

/// A scenario: everything that a run needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Name of the case.
    pub name: String,
    /// Where the case comes from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// Dimension of space.
    pub dimension: usize,
    /// Units of all numbers.
    pub units: Units,
    /// Time.
    pub time: Time,
    /// The fluid.
    pub fluid: Fluid,
    /// The background mesh with its boundary conditions.
    pub background: Background,
    /// The bodies.
    #[serde(default, rename = "body", skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<Body>,
    /// The mortar between fluid and bodies.
    pub interface: Interface,
    /// The contacts.
    #[serde(default, rename = "contact", skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<Contact>,
    /// What is written.
    #[serde(default)]
    pub output: Output,
    /// How the equations are solved.
    pub solver: Solver,
}

/// A system of units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Units {
    /// Centimetre, gram, second: dyn, erg, poise.
    #[serde(rename = "cgs")]
    Cgs,
}

/// `[time]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Time step, s.
    pub step: f64,
    /// End, s; a multiple of the step.
    pub end: f64,
    /// How often a step that fails is halved before the run stops; 4 if not given, 0 to stop at once.
    #[serde(default = "most_halvings", skip_serializing_if = "is_most_halvings")]
    pub most_halvings: usize,
}

fn most_halvings() -> usize {
    4
}

#[allow(clippy::trivially_copy_pass_by_ref)] // what serde asks for
fn is_most_halvings(value: &usize) -> bool {
    *value == most_halvings()
}

/// `[fluid]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fluid {
    /// Density, g/cm³.
    pub density: f64,
    /// Dynamic viscosity, poise.
    pub viscosity: f64,
    /// `γ_g` of the ghost penalty.
    pub gamma_ghost: f64,
    /// `γ_p` of the interior penalty of the pressure.
    pub gamma_pressure: f64,
    /// Interior penalty of the velocity.
    pub cip: Cip,
    /// Form of the convective term; "standard" if not given.
    #[serde(default)]
    pub convection: Convection,
    /// Constant force per volume, dyn/cm³; none if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body_force: Option<Vec<f64>>,
    /// Constant velocity at the start, cm/s; at rest if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_velocity: Option<Vec<f64>>,
}

/// Scaling of the interior penalty of the velocity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "profile", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Cip {
    /// With the measure of a face: calibrated to the results of the paper.
    Paper {
        /// `γ_1`.
        gamma_1: f64,
    },
    /// With the squared diameter of a face: vanishes under refinement.
    Consistent {
        /// `γ_u`.
        gamma_u: f64,
    },
}

/// Form of the convective term.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Convection {
    /// `ρ (u·∇u, v)`.
    #[default]
    Standard,
    /// With `ρ/2 (div u) u·v` added.
    Skew,
    /// None: Stokes flow.
    None,
}

/// `[background]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Background {
    /// A box with cells of graded size.
    GradedBox(GradedBox),
}

/// A box with cells of graded size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradedBox {
    /// Lowest corner, cm.
    pub min: Vec<f64>,
    /// Highest corner, cm.
    pub max: Vec<f64>,
    /// Size of cells.
    pub size: Size,
    /// Whether the box is completed by its mirror image across its left side.
    #[serde(default, skip_serializing_if = "is_false")]
    pub mirrored: bool,
    /// What holds on each side: left, right, bottom, top.
    pub boundary: BTreeMap<String, FluidCondition>,
}

/// `[[body]]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Name, for reports, files and contacts.
    pub name: String,
    /// Shape and size of cells.
    pub shape: Shape,
    /// Its motion; without one the body is elastic, and what follows says how.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<Motion>,
    /// Material of an elastic body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<Material>,
    /// Density of an elastic or free body, g/cm³.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Acceleration of gravity of an elastic or free body, cm/s².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity: Option<Vec<f64>>,
    /// How it is advanced in time; implicit Euler, as the fluid, if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_scheme: Option<TimeScheme>,
    /// What holds on tagged parts of the surface; parts that are not named are free.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub boundary: BTreeMap<String, BodyCondition>,
    /// Constant displacement at the start, cm; none if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_displacement: Option<Vec<f64>>,
    /// Constant velocity at the start, cm/s; at rest if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_velocity: Option<Vec<f64>>,
}

/// Shape of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Shape {
    /// A disk. Tag "surface".
    Ball {
        /// Centre, cm.
        centre: Vec<f64>,
        /// Radius, cm.
        radius: f64,
        /// Size of cells, cm.
        size: f64,
        /// Whether the polygon has the area of the disk, instead of its vertices on the circle.
        #[serde(default, skip_serializing_if = "is_false")]
        area_preserving: bool,
    },
    /// The half of a disk with `x` not below that of the centre. Tags "left" (the diameter) and "surface".
    HalfBall {
        /// Centre of the disk, cm.
        centre: Vec<f64>,
        /// Radius, cm.
        radius: f64,
        /// Size of cells, cm.
        size: f64,
        /// Whether the polygon has the area of the disk, instead of its vertices on the circle.
        #[serde(default, skip_serializing_if = "is_false")]
        area_preserving: bool,
        /// Whether it is completed by its mirror image: an exactly symmetric disk with the tag "surface".
        #[serde(default, skip_serializing_if = "is_false")]
        mirrored: bool,
    },
    /// A box. Tags left, right, bottom, top.
    Box {
        /// Lowest corner, cm.
        min: Vec<f64>,
        /// Highest corner, cm.
        max: Vec<f64>,
        /// Size of cells, cm; or `n`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        size: Option<f64>,
        /// Number of bricks along each axis, each of two triangles; or `size`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        n: Option<Vec<usize>>,
    },
}

/// What moves a body that does not deform. Angles are in radians, counter-clockwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Motion {
    /// None: an obstacle at rest.
    Fixed {},
    /// A steady rotation, from the start.
    Rotating {
        /// The point that stays, cm.
        centre: Vec<f64>,
        /// Angle per time, 1/s.
        angular_velocity: f64,
    },
    /// Formulas in the time `t`.
    Formula {
        /// Displacement from the shape's place, cm; one formula for each axis.
        displacement: Vec<String>,
        /// Angle by which the body is turned about its centre; not turned if not given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        angle: Option<String>,
        /// The centre before it is displaced, cm; for an angle.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        centre: Option<Vec<f64>>,
    },
    /// Its weight, the fluid and contacts: a free rigid body, with `density`, `gravity` and `initial_velocity`.
    Free {
        /// What is held all the same.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        held: Vec<Held>,
        /// Angular velocity at the start, 1/s; none if not given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        initial_spin: Option<f64>,
    },
    /// A table of times with displacements and angles.
    Table {
        /// A CSV file, relative to the scenario.
        file: String,
        /// The centre before it is displaced, cm; for a column of angles.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        centre: Option<Vec<f64>>,
    },
}

/// A motion that a free body does not make.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Held {
    /// Of its centre along the first axis.
    X,
    /// Of its centre along the second axis.
    Y,
    /// Of its centre along the third axis.
    Z,
    /// Turning.
    Rotation,
}

/// Material of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Material {
    /// `S = 2 μ E + λ tr(E) I`; `mu` and `lambda`, or `young` and `poisson`.
    SaintVenantKirchhoff {
        /// Shear modulus, dyn/cm².
        #[serde(default, skip_serializing_if = "Option::is_none")]
        mu: Option<f64>,
        /// First Lame parameter, dyn/cm².
        #[serde(default, skip_serializing_if = "Option::is_none")]
        lambda: Option<f64>,
        /// Young's modulus, dyn/cm².
        #[serde(default, skip_serializing_if = "Option::is_none")]
        young: Option<f64>,
        /// Poisson's ratio.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        poisson: Option<f64>,
    },
}

/// How a body is advanced in time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum TimeScheme {
    /// First order, as the fluid.
    ImplicitEuler {},
    /// Second order.
    GeneralisedAlpha {
        /// Spectral radius for the fastest vibrations, from 0 (removed in a step) to 1 (kept).
        rho_inf: f64,
    },
}

/// `[interface]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Interface {
    /// `γ_Σ`.
    pub gamma_sigma: f64,
    /// Weight of the fluid's traction; 1 only.
    pub alpha: f64,
}

/// `[[contact]]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Name of the body that must not touch (the slave).
    pub body: String,
    /// The law.
    pub law: ContactLaw,
    /// Contact size `s`, cm: the penalty is `gamma_contact_0 / s`.
    pub size: f64,
    /// Offset `ε`, cm: contact begins at this distance.
    pub offset: f64,
    /// What must not be touched (the master).
    pub obstacle: Obstacle,
}

/// A contact law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ContactLaw {
    /// `λ = -(γ_C0/s) [ε - Δ]₊`.
    Penalty {
        /// `γ_C0`.
        gamma_contact_0: f64,
    },
}

/// An obstacle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Obstacle {
    /// A plane that does not move.
    RigidPlane {
        /// A point on it, cm.
        point: Vec<f64>,
        /// Its normal, into the obstacle.
        normal: Vec<f64>,
    },
    /// Another body.
    Body {
        /// Its name.
        name: String,
    },
}

/// `[output]`, may be left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Output {
    /// Directory, if the command line names none; `results/NAME` if not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub directory: Option<String>,
    /// Steps between two sets of VTK files; 10 if not given, 0 for none.
    pub vtk_every: usize,
    /// Level of zlib compression of VTK files, 0 (none) to 9; 0 if not given.
    pub compression: u32,
    /// Pictures at the end of the run; true if not given.
    pub plots: bool,
    /// Events to be marked in the plots of the history.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<Mark>,
}

impl Default for Output {
    fn default() -> Self {
        Self { directory: None, vtk_every: 10, compression: 0, plots: true, marks: Vec::new() }
    }
}

/// An event known from elsewhere, to be compared with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mark {
    /// What happens.
    pub label: String,
    /// When, s.
    pub time: f64,
    /// Smallest distance then, cm, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub d_min: Option<f64>,
}

/// `[solver]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Solver {
    /// Newton's method.
    pub newton: Newton,
    /// The linear solver.
    pub linear: Linear,
}

/// Newton's method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Newton {
    /// Relative tolerance.
    pub tolerance: f64,
    /// Most corrections in a step.
    pub max_iterations: usize,
}

/// The linear solver.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Linear {
    /// Sparse LU.
    Direct {},
    /// Restarted flexible GMRES.
    Gmres {
        /// Preconditioner.
        preconditioner: Preconditioner,
        /// Iterations before a restart; 80 if left out. For block Gauss-Seidel.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        restart: Option<usize>,
        /// Solvers of the blocks; ILUT and Cholesky if left out. For block Gauss-Seidel.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        blocks: Option<Blocks>,
    },
}

/// A preconditioner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preconditioner {
    /// The factors of an old matrix, mended where an interface has moved.
    LaggedLu,
    /// One solve with the fluid, then one with each body, then one with the stiff couplings between them.
    BlockGaussSeidel,
}

/// How the blocks of a block Gauss-Seidel preconditioner are solved for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Blocks {
    /// Velocity and pressure of the fluid.
    pub fluid: FluidBlock,
    /// Every body.
    pub bodies: BodyBlock,
}

/// A solver of the fluid's block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FluidBlock {
    /// Sparse LU.
    Lu,
    /// Incomplete LU without fill.
    Ilu,
    /// Incomplete LU with a threshold.
    Ilut,
}

/// A solver of a body's block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BodyBlock {
    /// Sparse LU.
    Lu,
    /// Sparse Cholesky; LU where the block is not symmetric and positive definite.
    Cholesky,
    /// Incomplete LU without fill.
    Ilu,
    /// Incomplete LU with a threshold.
    Ilut,
}

fn is_false(value: &bool) -> bool {
    !value
}
