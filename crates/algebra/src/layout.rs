//! Where the unknowns of each field lie in the global vector.

use std::ops::Range;

/// A global degree of freedom: a row and column of the system.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct DofId(pub u32);

impl DofId {
    /// The dof at position `index` of the global vector.
    #[inline]
    pub fn new(index: usize) -> Self {
        debug_assert!(index < u32::MAX as usize);
        Self(index as u32)
    }

    /// Position in the global vector.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A field of unknowns, registered in a [`BlockLayout`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct FieldId(pub u32);

/// The fields of a problem, one contiguous range of dofs each, in the order in which they were registered.
///
/// ```
/// let mut layout = algebra::BlockLayout::new();
/// let velocity = layout.push("velocity", 10);
/// let pressure = layout.push("pressure", 5);
/// assert_eq!(layout.range(pressure), 10..15);
/// assert_eq!(layout.dof(velocity, 3).index(), 3);
/// assert_eq!(layout.len(), 15);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BlockLayout {
    names: Vec<String>,
    offsets: Vec<usize>,
}

impl BlockLayout {
    /// A layout without fields.
    pub fn new() -> Self {
        Self { names: Vec::new(), offsets: vec![0] }
    }

    /// Registers a field with `len` unknowns.
    pub fn push(&mut self, name: &str, len: usize) -> FieldId {
        if self.offsets.is_empty() {
            self.offsets.push(0);
        }
        let field = FieldId(self.names.len() as u32);
        self.names.push(name.to_owned());
        self.offsets.push(self.len() + len);
        field
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.offsets.last().copied().unwrap_or(0)
    }

    /// Whether there are no unknowns.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of fields.
    pub fn n_fields(&self) -> usize {
        self.names.len()
    }

    /// All fields in order.
    pub fn fields(&self) -> impl Iterator<Item = FieldId> + use<> {
        (0..self.names.len() as u32).map(FieldId)
    }

    /// Dofs of a field, as positions in the global vector.
    pub fn range(&self, field: FieldId) -> Range<usize> {
        let k = field.0 as usize;
        self.offsets[k]..self.offsets[k + 1]
    }

    /// Dof number `local` of a field.
    #[inline]
    pub fn dof(&self, field: FieldId, local: usize) -> DofId {
        debug_assert!(local < self.range(field).len());
        DofId::new(self.offsets[field.0 as usize] + local)
    }

    /// Name of a field.
    pub fn name(&self, field: FieldId) -> &str {
        &self.names[field.0 as usize]
    }
}
