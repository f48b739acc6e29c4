//! Errors in the description of a rigid body.

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The density is not positive and finite.
    #[error(transparent)]
    Parameter(#[from] mesh::ParameterError),
    /// The surface encloses no volume: it is flat, open, or turned inside out. Repair the mesh.
    #[error("the surface encloses the volume {volume:e}, but a body needs a positive one")]
    Volume {
        /// Enclosed volume.
        volume: f64,
    },
}
