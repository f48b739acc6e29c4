//! Elastic bodies moving, deforming and colliding inside an incompressible fluid, on a mesh that they cut.
//!
//! This crate re-exports the others; the names that most programs need are in [`prelude`].
//!
//! ```
//! use cutwater::prelude::*;
//!
//! let background = graded_box([0.0, 0.0], [10.0, 15.0], &Size::uniform(0.5))?;
//! let disk = ball([5.0, 7.0], 4.0, 0.1, &BallOptions { area_preserving: true })?;
//! let surface = disk.boundary();
//! let cut = CutMesh::overlay(&background, &[Placed::new(&surface, disk.vertices())], &OverlayOptions::new())?;
//! let exact = 150.0 - std::f64::consts::PI * 16.0;
//! assert!((cut.fluid_volume() - exact).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

//!
//! From a scenario to numbers, the whole path: a disk that sinks in a box of water.
//!
//! ```
//! use cutwater::io::{HistoryTable, ScenarioFile, run};
//!
//! let text = r#"
//!     name       = "sinking"
//!     dimension  = 2
//!     units      = "cgs"
//!     time       = { step = 0.01, end = 0.05 }
//!     fluid      = { density = 1.0, viscosity = 0.1 }
//!     background = { kind = "graded-box", min = [0, 0], max = [2, 3], size = 0.4, boundary = { left = "no-slip", right = "no-slip", bottom = "no-slip", top = "free" } }
//!     [[body]]
//!     name       = "disk"
//!     shape      = { kind = "ball", centre = [1, 2], radius = 0.5, size = 0.2 }
//!     motion     = "free"
//!     density    = 2.0
//!     gravity    = [0, -981]
//! "#;
//! let scenario = ScenarioFile::parse("sinking.toml".as_ref(), text, &[])?;
//! let directory = std::env::temp_dir().join(format!("cutwater-sinking-{}", std::process::id()));
//! let summary = run(&scenario, &directory, &mut ())?;
//! let height = HistoryTable::read(&directory.join("history.csv"))?.column("centre_y").unwrap_or_default();
//! let fall = 2.0 - height[height.len() - 1];
//! // Slower than in vacuum: the water has inertia.
//! assert!(summary.steps == 5 && fall > 0.0 && fall < 0.5 * 981.0 * 0.05_f64.powi(2));
//! # std::fs::remove_dir_all(&directory)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The same in a program, without a scenario:
//!
//! ```
//! use std::sync::Arc;
//!
//! use cutwater::algebra::time::GeneralisedAlpha;
//! use cutwater::fluid_ns::NewtonianFluid;
//! use cutwater::prelude::*;
//! use cutwater::solid_rigid::RigidBody;
//! use cutwater::solver::{FluidBoundary, FluidSetup};
//!
//! let background = graded_box::<2>([0.0, 0.0], [2.0, 3.0], &Size::uniform(0.4))?;
//! let mut fluid = FluidSetup::new(background, NewtonianFluid { density: 1.0, viscosity: 0.1 });
//! // Sides without a condition are open.
//! for side in ["left", "right", "bottom"] {
//!     let tag = fluid.background.tag(side).ok_or("a box has sides")?;
//!     fluid.boundary.push((tag, FluidBoundary::NoSlip));
//! }
//! let mesh = ball([1.0, 2.0], 0.5, 0.2, &BallOptions { area_preserving: true })?;
//! let gravity = Vector::<2>::new(0.0, -981.0);
//! let disk = RigidBody::new("disk", mesh.boundary(), mesh.vertices().to_vec(), 2.0, gravity)?;
//! let setup = Setup {
//!     fluid: Some(fluid),
//!     bodies: vec![Arc::new(disk)],
//!     contacts: Vec::new(),
//!     scheme: Arc::new(GeneralisedAlpha::new(0.0).ok_or("rho_inf is from 0 to 1")?),
//!     dt: 0.01,
//!     most_halvings: 0,
//!     approach: None,
//!     newton: NewtonSettings::new(1e-8),
//! };
//! let mut time_loop = TimeLoop::new(&setup, State::initial(&setup)?, Workspace::new());
//! time_loop.run(5, &mut [])?;
//! let balance = setup.bodies[0].balance(&time_loop.state().bodies[0]).ok_or("it has mass")?;
//! assert!(balance.centre_of_mass[1] < 2.0 && balance.centre_of_mass[1] > 2.0 - 0.5 * 981.0 * 0.05_f64.powi(2));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod prelude;

pub use algebra;
pub use body;
pub use contact;
pub use cutcell;
pub use fluid_ns;
pub use interface_dg;
pub use io;
pub use mesh;
#[cfg(feature = "report")]
pub use report;
pub use solid_rigid;
pub use solid_svk;
pub use solver;
pub use xfem_space;
