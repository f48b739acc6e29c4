//! What can be wrong with the description of a rigid body.

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A density or time step is out of its range. Correct the number.
    #[error("{what} is {value:e}, but must be positive and finite")]
    Parameter {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The surface encloses no volume: it is flat, open, or turned inside out. Mend the mesh.
    #[error("the surface encloses the volume {volume:e}, but a body needs a positive one")]
    Volume {
        /// Enclosed volume.
        volume: f64,
    },
    /// A field does not have the dofs of a body.
    #[error("{what} has {found} entries, but {expected} are needed")]
    Length {
        /// The list or field.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },
}

/// A parameter that must be finite and positive.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err(Error::Parameter { what, value }) }
}
