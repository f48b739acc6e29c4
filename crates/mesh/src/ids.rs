//! Indices of mesh entities, one type each so that they cannot be mixed up.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
        pub struct $name(pub u32);

        impl $name {
            /// The id of entry `index`.
            #[inline]
            pub fn new(index: usize) -> Self {
                debug_assert!(index < u32::MAX as usize);
                Self(index as u32)
            }

            /// Position in the arrays that belong to this kind of entity.
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
    /// A body: a closed surface laid over a background mesh.
    BodyId
);
id!(
    /// A named part of a boundary, an index into the tag names of its mesh.
    Tag
);
