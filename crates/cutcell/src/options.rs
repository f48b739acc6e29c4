//! Options of an overlay.

/// Settings of an overlay.
#[derive(Clone, Debug, PartialEq)]
pub struct OverlayOptions {
    /// Thickness below which a fluid part is left out, as a fraction of the mean cell size. Bodies at such a distance
    /// touch, and a facet at such a distance from a face of the background lies on it. From 0 to below 1.
    pub relative_tolerance: f64,
    /// Whether self-intersecting surfaces are errors. The check takes about as long as the cut of a fine surface; a
    /// simulation may check its surfaces once.
    pub refuse_self_intersections: bool,
}

impl OverlayOptions {
    /// Returns the default options: a tolerance of 1e-13 cell sizes, with the check for self-intersections.
    pub fn new() -> Self {
        Self { relative_tolerance: 1e-13, refuse_self_intersections: true }
    }

    /// Returns the same options without the check for self-intersections.
    #[must_use]
    pub fn without_self_intersection_check(self) -> Self {
        Self { refuse_self_intersections: false, ..self }
    }
}

impl Default for OverlayOptions {
    fn default() -> Self {
        Self::new()
    }
}
