//! Blocks of unknowns, local systems, sparse assembly, Newton's method and linear solvers.
//!
//! Nothing here knows a space dimension, a mesh or a physical quantity. How the parts meet:
//!
//! 1. Fields of unknowns are registered in a [`BlockLayout`], prescribed values in [`Constraints`].
//! 2. Physics arrives as [`Contributions`]: items (cells, faces, ...) that name their dofs and fill a [`LocalSystem`] with
//!    residual and tangent. [`check_tangent`] compares the two by finite differences.
//! 3. A [`NonlinearProblem`] is layout, contributions and constraints. [`newton`] solves it in a [`Workspace`], which
//!    recycles memory from solve to solve, though size and pattern may change.
//! 4. Inside, a [`BlockSystem`] builds the [`Pattern`] with its scatter map, assembles linear contributions once and the
//!    others in each iteration, in parallel and yet with the same bits for any number of threads.
//! 5. A [`LinearSolver`], by default the sparse [`DirectSolver`], solves for the corrections. Its factorisation is kept
//!    while it contracts. Convergence is measured in the norms of its [`Equilibration`].
//!
//! ```
//! use algebra::*;
//!
//! /// A chain of hanging springs: force `e + e³` at elongation e between neighbours, and a load on each joint.
//! struct Chain { layout: BlockLayout, constraints: Constraints }
//!
//! impl Contributions for Chain {
//!     fn len(&self) -> usize { self.layout.len() - 1 }
//!     fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
//!         out.extend([DofId::new(item), DofId::new(item + 1)]);
//!     }
//!     fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
//!         let e = x[item + 1] - x[item];
//!         let (force, stiffness, load) = (e + e.powi(3), 1.0 + 3.0 * e.powi(2), 2.0);
//!         out.add_vector(0, &[-force, force - load]);
//!         out.add_block(0, 0, 2, &[stiffness, -stiffness, -stiffness, stiffness]); // column by column
//!     }
//!     fn name(&self) -> &'static str { "chain" }
//! }
//!
//! impl NonlinearProblem for Chain {
//!     fn layout(&self) -> &BlockLayout { &self.layout }
//!     fn contributions(&self) -> Vec<&dyn Contributions> { vec![self] }
//!     fn constraints(&self) -> &Constraints { &self.constraints }
//! }
//!
//! let mut layout = BlockLayout::new();
//! let position = layout.push("position", 4);
//! let mut constraints = Constraints::new();
//! constraints.set(layout.dof(position, 0), 0.0);
//! let chain = Chain { layout, constraints };
//!
//! let mut x = vec![0.0; 4];
//! let report = newton(&chain, &mut x, &mut Workspace::new(), &NewtonSettings::new(1e-12))?;
//! assert!((x[3] - x[2] - 1.0).abs() < 1e-10); // the last spring bears 2 = e + e³ at e = 1
//! assert!(report.factorizations <= report.iterations);
//! # Ok::<(), NewtonError>(())
//! ```

mod block_system;
mod check;
mod constraints;
mod contributions;
mod faer_view;
mod layout;
mod linear;
mod local_system;
mod newton;
mod pattern;
mod scatter;
mod tied;
mod workspace;

pub use block_system::{BlockSystem, ContributionTiming};
pub use check::{TangentDeviation, check_tangent, worst_tangent_entry};
pub use constraints::Constraints;
pub use contributions::Contributions;
pub use layout::{BlockLayout, DofId, FieldId};
pub use linear::{
    BlockGaussSeidel, BlockGaussSeidelSettings, BlockSolver, DirectSolver, Equilibration, Fill, Gmres, GmresReport,
    GmresSettings, LaggedSettings, LaggedSolver, LinearError, LinearMap, LinearReport, LinearSolver, MatrixView,
    Scaling, Unknowns, condition_number,
};
pub use local_system::LocalSystem;
pub use newton::{Forcing, NewtonError, NewtonReport, NewtonSettings, NonlinearProblem, newton};
pub use pattern::{ItemMap, Pattern};
pub use tied::Tied;
pub use workspace::Workspace;
