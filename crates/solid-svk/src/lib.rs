//! Deformable solids: elastodynamics in the reference configuration.
//!
//! The unknown of a body is the **velocity** `v` of its nodes at the stage of the step. Displacement and acceleration
//! at the stage follow from `v` by the time scheme ([`algebra::time`]): `d = d_pred + c_d v`, `a = a_pred + c_a v`.
//! [`ElasticBody`] is the body that a simulation uses; the example below assembles its parts by hand.
//!
//! Weak form on the reference domain, for all test functions `w` (residual = left minus right side):
//!
//! | line | formula | file |
//! |---|---|---|
//! | inertia | `(ρ a, w)` | `terms/inertia.rs` |
//! | internal work | `(P(F), ∇w)` | `terms/internal_work.rs`; in axisymmetric coordinates `terms/hoop_work.rs` |
//! | body force | `-(ρ g, w)` | `terms/body_force.rs` |
//! | dead load | `-(t, w)` on facets | `terms/traction.rs` |
//! | follower pressure | `(p J F⁻ᵀ N, w)` on facets | `terms/pressure.rs` |
//!
//! ```
//! use algebra::time::{ImplicitEuler, Level, StepRule, TimeScheme};
//! use algebra::{BlockLayout, Contributions};
//! use mesh::{Point, SimplexMesh, Vector, VertexId};
//! use solid_svk::{LameParameters, SaintVenantKirchhoff, SolidCells, SolidForm, SolidMesh};
//!
//! let corners = vec![Point::<2>::new(0.0, 0.0), Point::<2>::new(1.0, 0.0), Point::<2>::new(0.0, 1.0)];
//! let solid = SolidMesh::new(SimplexMesh::new(corners, (0..3).map(VertexId).collect())?)?;
//! let steel = SaintVenantKirchhoff::new(LameParameters::from_young_poisson(2.1e12, 0.3)?);
//! let form = SolidForm::new(7.8, steel, Vector::<2>::new(0.0, -981.0))?;
//!
//! let rest = vec![Vector::<2>::zeros(); 3];
//! let level = Level { displacement: rest.clone(), velocity: rest, ..Level::default() };
//! let rule = StepRule::new(&ImplicitEuler.weights(1e-3, true), &level);
//! let mut layout = BlockLayout::new();
//! let velocity = layout.push("solid velocity", 3, 2);
//! let cells = SolidCells { solid: &solid, rule: &rule, layout: &layout, velocity };
//! assert_eq!(form.inertia_and_body_force(cells).len() + form.internal_work(cells).len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod energy;
pub mod kinematics;
pub mod material;
pub mod supports;
mod tabulated;
pub mod terms;

mod cell;
mod deformation;
mod elastic;
mod error;
mod facet;
mod form;
mod load;
mod mass;
mod solid_mesh;
mod stress;

pub use cell::{SolidCell, SolidCells, SolidPoint, SolidPoints};
pub use deformation::Deformation;
pub use elastic::{ElasticBody, ElasticOptions};
pub use error::Error;
pub use facet::{SolidFacet, SolidFacets};
pub use form::SolidForm;
pub use load::Load;
pub use material::{LameParameters, LinearElastic, Material, MaterialInSpace, NeoHookean, SaintVenantKirchhoff};
pub use mesh::{MAX_CELL_NODES, Order, ShapeFunctions};
pub use solid_mesh::{CellPoint, SolidMesh};
pub use stress::SolidStress;
pub use supports::{DisplacementField, Support, SupportKind};
