//! Positions of the unknowns of each field in the global vector.

use std::ops::Range;

/// A global degree of freedom: a row and column of the system.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct DofId(u32);

impl DofId {
    /// Creates the dof at position `index` of the global vector, below `u32::MAX` (checked in debug builds only).
    #[inline]
    pub const fn new(index: usize) -> Self {
        debug_assert!(index < u32::MAX as usize);
        Self(index as u32)
    }

    /// Returns the position in the global vector.
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// A field of unknowns, registered in a [`BlockLayout`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct FieldId(u32);

impl FieldId {
    /// Creates the identifier of the field with a given index in the order of registration, from zero.
    pub const fn new(index: usize) -> Self {
        Self(index as u32)
    }

    /// Returns the index of the field in the order of registration, from zero.
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Identity of a dof across time steps: field, component and key of the node.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct DofKey {
    field: u32,
    component: u32,
    node: u64,
}

impl DofKey {
    /// Returns the key as four numbers without a fraction.
    pub(crate) fn to_numbers(self) -> [f64; 4] {
        [self.field, self.component, self.node as u32, (self.node >> 32) as u32].map(f64::from)
    }

    /// Restores a key from the numbers of [`DofKey::to_numbers`]; `None` for other numbers.
    pub(crate) fn from_numbers(numbers: &[f64; 4]) -> Option<Self> {
        let [field, component, low, high] = numbers.map(|x| x as u32);
        let key = Self { field, component, node: u64::from(high) << 32 | u64::from(low) };
        (key.to_numbers() == *numbers).then_some(key)
    }
}

/// The fields of a problem, one contiguous range of dofs each, in the order of their registration.
///
/// A field has a number of *components* (unknowns) at each of its *nodes*. Component `c` of node `k` is dof
/// `components * k + c` of the field. Fields may share nodes, as velocity and pressure do. Orderings and
/// preconditioners of the linear solvers use nodes. Nodes have no effect on the solution.
///
/// A node has a *key*, by which solvers that keep old factors recognise the node in the system of another time step.
/// The default key is the index of the node in its field.
///
/// ```
/// use algebra::{BlockLayout, DofId};
///
/// let mut layout = BlockLayout::new();
/// let velocity = layout.push("velocity", 5, 2);
/// let pressure = layout.push_on(velocity, "pressure", 1);
/// assert_eq!(layout.range(pressure), 10..15);
/// assert_eq!(layout.dof(velocity, 3, 1), DofId::new(7));
/// assert_eq!(layout.nodes(), [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 0, 1, 2, 3, 4]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BlockLayout {
    fields: Vec<FieldBlock>,
    /// Keys of each set of nodes. A list is empty for default keys.
    keys: Vec<Vec<u64>>,
    n_dofs: usize,
    n_nodes: usize,
}

#[derive(Clone, Debug, PartialEq)]
struct FieldBlock {
    name: String,
    first_dof: usize,
    components: usize,
    first_node: usize,
    n_nodes: usize,
    /// Index into `BlockLayout::keys`.
    node_set: usize,
    /// Round-off of each component; empty if zero.
    rounding: Vec<f64>,
}

impl FieldBlock {
    /// Creates a field from its first dof and the first of its nodes, with round-off zero.
    fn new(
        name: &str,
        components: usize,
        first_dof: usize,
        first_node: usize,
        n_nodes: usize,
        node_set: usize,
    ) -> Self {
        Self { name: name.to_owned(), first_dof, components, first_node, n_nodes, node_set, rounding: Vec::new() }
    }

    fn range(&self) -> Range<usize> {
        self.first_dof..self.first_dof + self.components * self.n_nodes
    }
}

impl BlockLayout {
    /// Creates a layout without fields.
    pub fn new() -> Self {
        Self::default()
    }

    /// Registers a field on `n_nodes` nodes of its own.
    pub fn push(&mut self, name: &str, n_nodes: usize, components: usize) -> FieldId {
        self.push_nodes(name, n_nodes, components, Vec::new())
    }

    /// Registers a field on nodes of its own with given keys, one per node. Keys must be distinct (not checked).
    pub fn push_keyed(&mut self, name: &str, keys: Vec<u64>, components: usize) -> FieldId {
        self.push_nodes(name, keys.len(), components, keys)
    }

    /// Registers a field on the nodes of another one.
    pub fn push_on(&mut self, other: FieldId, name: &str, components: usize) -> FieldId {
        let &FieldBlock { first_node, n_nodes, node_set, .. } = &self.fields[other.index()];
        self.add(FieldBlock::new(name, components, self.n_dofs, first_node, n_nodes, node_set))
    }

    fn push_nodes(&mut self, name: &str, n_nodes: usize, components: usize, keys: Vec<u64>) -> FieldId {
        let (first_node, node_set) = (self.n_nodes, self.keys.len());
        self.keys.push(keys);
        self.n_nodes += n_nodes;
        self.add(FieldBlock::new(name, components, self.n_dofs, first_node, n_nodes, node_set))
    }

    fn add(&mut self, field: FieldBlock) -> FieldId {
        self.n_dofs = field.range().end;
        self.fields.push(field);
        FieldId::new(self.fields.len() - 1)
    }

    /// Sets the round-off of each component of a field, in the unit of the component. The default is zero. Newton's
    /// method accepts errors of this size.
    ///
    /// # Panics
    /// `rounding` does not have one value per component.
    pub fn set_rounding(&mut self, field: FieldId, rounding: &[f64]) {
        let field = &mut self.fields[field.index()];
        assert_eq!(rounding.len(), field.components, "components of the field");
        field.rounding = rounding.to_vec();
    }

    /// Returns the round-off of each dof.
    pub fn rounding(&self) -> Vec<f64> {
        let of_dof = |f: &FieldBlock, k: usize| f.rounding.get(k % f.components).copied().unwrap_or(0.0);
        self.fields.iter().flat_map(|f| (0..f.range().len()).map(move |k| of_dof(f, k))).collect()
    }

    /// Returns the number of unknowns.
    pub fn len(&self) -> usize {
        self.n_dofs
    }

    /// Returns whether there are no unknowns.
    pub fn is_empty(&self) -> bool {
        self.n_dofs == 0
    }

    /// Returns all fields in order.
    pub fn fields(&self) -> impl Iterator<Item = FieldId> + use<> {
        (0..self.fields.len()).map(FieldId::new)
    }

    /// Returns the name of a field.
    pub fn name(&self, field: FieldId) -> &str {
        &self.fields[field.index()].name
    }

    /// Returns the number of nodes of a field.
    pub fn n_nodes(&self, field: FieldId) -> usize {
        self.fields[field.index()].n_nodes
    }

    /// Returns the index of the node set of a field. Fields that share nodes have the same index.
    pub fn node_set(&self, field: FieldId) -> usize {
        self.fields[field.index()].node_set
    }

    /// Returns the dofs of a field, as positions in the global vector.
    pub fn range(&self, field: FieldId) -> Range<usize> {
        self.fields[field.index()].range()
    }

    /// Returns the dof of one component at a node.
    #[inline]
    pub fn dof(&self, field: FieldId, node: usize, component: usize) -> DofId {
        let FieldBlock { first_dof, components, .. } = self.fields[field.index()];
        debug_assert!(component < components && node < self.n_nodes(field));
        DofId::new(first_dof + components * node + component)
    }

    /// Returns the dofs of all components at a node.
    #[inline]
    pub fn node(&self, field: FieldId, node: usize) -> impl DoubleEndedIterator<Item = DofId> + use<> {
        let FieldBlock { first_dof, components, .. } = self.fields[field.index()];
        debug_assert!(node < self.n_nodes(field));
        let first = first_dof + components * node;
        (first..first + components).map(DofId::new)
    }

    /// Returns the values of a field with `N` components at a node, from the global vector `x`.
    ///
    /// # Panics
    /// The field does not have `N` components.
    #[inline]
    pub fn at<const N: usize>(&self, field: FieldId, node: usize, x: &[f64]) -> [f64; N] {
        let FieldBlock { first_dof, components, .. } = self.fields[field.index()];
        assert!(components == N, "the field has {components} components, not {N}");
        let mut values = [0.0; N];
        values.copy_from_slice(&x[first_dof + N * node..][..N]);
        values
    }

    /// Returns the values of a field with `N` components at all its nodes, from the global vector `x`.
    ///
    /// # Panics
    /// The field does not have `N` components.
    pub fn values<const N: usize>(&self, field: FieldId, x: &[f64]) -> impl Iterator<Item = [f64; N]> {
        (0..self.n_nodes(field)).map(move |node| self.at(field, node, x))
    }

    /// Writes values of a field with `N` components, one per node in their order, into the global vector `x`. Nodes
    /// without a value are unchanged.
    pub fn set<const N: usize>(&self, field: FieldId, values: impl IntoIterator<Item = [f64; N]>, x: &mut [f64]) {
        for (slot, value) in x[self.range(field)].chunks_exact_mut(N).zip(values) {
            slot.copy_from_slice(&value);
        }
    }

    /// Returns the node of each dof. Nodes of different sets have different numbers. Fields on the same set share them.
    pub fn nodes(&self) -> Vec<u32> {
        let of_field = |f: &FieldBlock| {
            let (first, components) = (f.first_node, f.components);
            (first..first + f.n_nodes).flat_map(move |node| std::iter::repeat_n(node as u32, components))
        };
        self.fields.iter().flat_map(of_field).collect()
    }

    /// Returns the key of each dof.
    pub fn keys(&self) -> Vec<DofKey> {
        let mut keys = Vec::with_capacity(self.n_dofs);
        for (number, field) in self.fields.iter().enumerate() {
            for k in 0..field.n_nodes {
                let node = self.keys[field.node_set].get(k).copied().unwrap_or(k as u64);
                let dof = |component: usize| DofKey { field: number as u32, component: component as u32, node };
                keys.extend((0..field.components).map(dof));
            }
        }
        keys
    }
}
