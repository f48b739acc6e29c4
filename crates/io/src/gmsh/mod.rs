//! Meshes of Gmsh: files `.msh` of version 2.2 and 4.1, as text or in binary.
//!
//! Physical groups of cells and of facets become tags of the mesh, with their names.

mod elements;
mod file;
mod mesh;
mod parse;
mod scan;
mod surface;
mod write;

pub use self::mesh::GmshMesh;
pub use file::{GmshFile, GmshVersion};
pub use write::{GmshFormat, write};
