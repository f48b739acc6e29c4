//! xfem-space.
