//! Elastodynamics in the reference configuration, Saint Venant-Kirchhoff first.
//!
//! The unknown of a body is the **velocity** `v` of its vertices at the end of the step; displacement and
//! acceleration follow from it by a [`StepRule`], which a [`TimeScheme`] gives: `d = d_pred + c_d v`, `a = c_a v - a_pred`.
//!
//! Weak form on the reference domain, for all test functions `w` (residual = left minus right side):
//!
//! | line | formula | file |
//! |---|---|---|
//! | inertia | `(ρ a, w)` | `terms/inertia.rs` |
//! | internal work | `(P(F), ∇w)` | `terms/internal_work.rs` |
//! | body force | `-(ρ g, w)` | `terms/body_force.rs` |
//! | dead load | `-(t, w)` on facets | `terms/traction.rs` |
//! | follower pressure | `(p J F⁻ᵀ N, w)` on facets | `terms/pressure.rs` |
//!
//! Component `a` of the velocity of vertex `i` is dof `D i + a` of the body's field.
//!
//! ```
//! use algebra::{BlockLayout, Contributions};
//! use mesh::{Point, SimplexMesh, Vector, VertexId};
//! use solid_svk::{LameParameters, SaintVenantKirchhoff, SolidCells, SolidForm, SolidMesh, StepRule};
//!
//! let corners = vec![Point::<2>::new(0.0, 0.0), Point::<2>::new(1.0, 0.0), Point::<2>::new(0.0, 1.0)];
//! let solid = SolidMesh::new(SimplexMesh::new(corners, (0..3).map(VertexId).collect())?)?;
//! let steel = SaintVenantKirchhoff::new(LameParameters::from_young_poisson(2.1e12, 0.3)?);
//! let form = SolidForm::new(7.8, steel, Vector::<2>::new(0.0, -981.0))?;
//!
//! let rest = vec![Vector::<2>::zeros(); 3];
//! let step = StepRule::implicit_euler(1e-3, &rest, &rest)?;
//! let mut layout = BlockLayout::new();
//! let velocity = layout.push("solid velocity", solid.n_dofs());
//! let cells = SolidCells::new(&solid, &form, &step, &layout, velocity)?;
//! assert_eq!(cells.linear().len() + cells.internal_work().len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod boundary;
pub mod energy;
pub mod kinematics;
pub mod material;
pub mod terms;

mod cell;
mod error;
mod facet;
mod form;
mod solid_mesh;
mod step_rule;
mod time_scheme;

pub use cell::{SolidCell, SolidTerm};
pub use error::Error;
pub use facet::{FacetTerm, SolidFacet, SolidFacets};
pub use form::{InternalWorkCells, LinearCells, SolidCells, SolidForm};
pub use material::{LameParameters, LinearElastic, Material, SaintVenantKirchhoff};
pub use solid_mesh::SolidMesh;
pub use step_rule::{AffineInVelocity, Kinematics, StepRule};
pub use time_scheme::{GeneralisedAlpha, TimeScheme};

pub use algebra;
pub use mesh;
