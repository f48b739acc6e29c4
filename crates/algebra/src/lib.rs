//! Blocks of unknowns, local systems, sparse assembly, Newton's method and linear solvers.
//!
//! The crate has no mesh and no space dimension; of physics it has only displacement, velocity and acceleration of the
//! time schemes, and how contact and pressure act in them ([`time::Weights`]). Its parts:
//!
//! 1. Fields of unknowns are registered in a [`BlockLayout`], prescribed values and ties in [`Constraints`].
//! 2. Physics arrives as [`Contributions`]: items (cells, faces, ...) that name their dofs and fill a [`LocalSystem`]
//!    with residual and tangent. A weak form is an [`Integral`] of [`Term`]s over [`Sites`]. [`check_tangent`] compares
//!    tangents with finite differences of residuals.
//! 3. [`Equations`] are layout, contributions and constraints. [`newton`] solves them in a [`Workspace`], which
//!    recycles memory from solve to solve, though size and pattern may change.
//! 4. Inside, a [`BlockSystem`] builds the [`Pattern`] with its scatter map. It assembles linear contributions once and
//!    the others in each iteration, in parallel, with the same bits for any number of threads. It owns the scales of
//!    the matrix ([`Equilibration`]), in whose norms convergence is measured.
//! 5. A [`LinearSolver`], by default the sparse [`DirectSolver`], solves for the corrections. The factorisation is kept
//!    while corrections with it contract.
//!
//! ```
//! use algebra::*;
//!
//! /// A chain of hanging springs: force `e + e³` at elongation e between neighbours, and a load on each joint.
//! struct Chain { joints: usize }
//!
//! impl Contributions for Chain {
//!     fn len(&self) -> usize { self.joints - 1 }
//!     fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
//!         out.extend([DofId::new(item), DofId::new(item + 1)]);
//!     }
//!     fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
//!         let e = x[item + 1] - x[item];
//!         let (force, stiffness, load) = (e + e.powi(3), 1.0 + 3.0 * e.powi(2), 2.0);
//!         out.add_vector(0, [-force, force - load]);
//!         out.add_block(0, 0, [[stiffness, -stiffness], [-stiffness, stiffness]]); // column by column
//!     }
//!     fn name(&self) -> &'static str { "chain" }
//! }
//!
//! let mut layout = BlockLayout::new();
//! let position = layout.push("position", 4, 1);
//! let mut constraints = Constraints::new();
//! constraints.set(layout.dof(position, 0, 0), 0.0);
//! let chain = Box::new(Chain { joints: 4 });
//! assert!(check_tangent(chain.as_ref(), &[0.0, 0.3, 0.1, 1.0], 1e-5) < 1e-8);
//! let equations = Equations { layout: &layout, contributions: vec![chain], constraints: &constraints };
//!
//! let mut x = vec![0.0; 4];
//! let report = newton(&equations, &mut x, &mut Workspace::new(), &NewtonSettings::new(1e-12))?;
//! assert!((x[3] - x[2] - 1.0).abs() < 1e-10); // the last spring has the force 2 = e + e³, e = 1
//! assert!(report.factorizations <= report.iterations);
//! # Ok::<(), NewtonError>(())
//! ```

mod anderson;
mod block_system;
mod check;
mod constraints;
mod contributions;
mod forcing;
mod integral;
mod layout;
mod linear;
mod local_system;
mod newton;
mod pattern;
mod scatter;
mod tied;
pub mod time;
mod workspace;

pub use anderson::Anderson;
pub use block_system::{BlockSystem, ContributionTiming};
pub use check::{TangentDeviation, check_tangent, worse, worst_tangent_entry};
pub use constraints::Constraints;
pub use contributions::{Contributions, for_each_residual};
pub use forcing::Forcing;
pub use integral::{Integral, Sites, Term};
pub use layout::{BlockLayout, DofId, DofKey, FieldId};
pub use linear::{
    BlockGaussSeidel, BlockGaussSeidelSettings, BlockSolver, DirectSolver, Equilibration, Fill, Gmres, GmresSettings,
    LaggedSettings, LaggedSolver, LinearError, LinearMap, LinearReport, LinearSolver, LinearSystem, MatrixView,
    ScaledMatrix, Scaling, condition_number,
};
pub use local_system::LocalSystem;
pub use newton::{Equations, NewtonError, NewtonReport, NewtonSettings, newton};
pub use pattern::Pattern;
pub use scatter::{RegimeHash, power, regime_of};
pub use tied::Tied;
pub use workspace::Workspace;
