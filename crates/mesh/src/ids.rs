//! Indices of mesh entities, one type for each kind of entity.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
        pub struct $name(pub u32);

        impl $name {
            /// Creates the id with the given index.
            #[inline]
            pub fn new(index: usize) -> Self {
                debug_assert!(index < u32::MAX as usize);
                Self(index as u32)
            }

            /// Returns the position in arrays over this kind of entity.
            #[inline]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.0.fmt(f)
            }
        }
    };
}

id!(
    /// A vertex of a mesh.
    VertexId
);
id!(
    /// A cell (triangle, tetrahedron) of a mesh.
    CellId
);
id!(
    /// A facet (edge, triangle) of a mesh.
    FacetId
);
id!(
    /// A body, given by a closed surface.
    BodyId
);
id!(
    /// A named part of a boundary, or a named group of cells: an index into the tag names of its mesh.
    Tag
);
