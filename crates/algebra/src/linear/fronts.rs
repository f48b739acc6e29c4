//! Fronts of an elimination on the pattern of `A + Aᵀ`.

use std::ops::Range;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::linalg::cholesky::{simplicial, supernodal};
use faer::sparse::linalg::{SymbolicSupernodalParams, amd, qr};
use faer::sparse::{FaerError, SymbolicSparseColMatRef};

use super::factors::inverse;
use super::nodes::NodeGraph;

/// Pairs (number of nodes, share of explicit zeros): supernodes of at most that many nodes are merged if the share is
/// not exceeded.
const RELAXATION: [(usize, f64); 4] = [(2, 1.0), (6, 0.2), (16, 0.05), (usize::MAX, 0.02)];

/// Supernodes of the factors of a matrix whose pattern is made symmetric, in the order of a multifrontal elimination.
///
/// Unknowns have a *position* in the order of elimination. A front has the pivots `first[s]..first[s + 1]`, which are
/// the unknowns of whole nodes, and the positions `below(s)` of the rows and columns that are coupled to them and
/// follow later. The order is a postorder: children come directly before their parent.
///
/// Source: Duff and Reid 1983, The multifrontal solution of indefinite sparse symmetric linear systems,
/// doi:10.1145/356044.356047; Amestoy, Davis and Duff 1996, doi:10.1137/S0895479894278952, for the order.
pub(super) struct Fronts {
    /// Pattern and nodes of the matrix, kept to recognise them.
    column_ptr: Vec<u32>,
    rows: Vec<u32>,
    nodes: Vec<u32>,
    /// Position to unknown.
    pub(super) order: Vec<u32>,
    /// Unknown to position.
    pub(super) position: Vec<u32>,
    first: Vec<usize>,
    below_ptr: Vec<usize>,
    below: Vec<u32>,
    /// Front to the first entry of its pivot block; one longer than the number of fronts.
    block_ptr: Vec<usize>,
    /// Front to the first entry of its rows below the pivot block; one longer than the number of fronts.
    lower_ptr: Vec<usize>,
    /// Front to the front that its update is added to; the number of fronts at a root.
    pub(super) parent: Vec<usize>,
    /// Largest number of entries of update matrices stored at the same time.
    pub(super) most_updates: usize,
}

impl Fronts {
    /// Orders the nodes by minimum degree and finds the supernodes.
    pub(super) fn new(column_ptr: &[u32], rows: &[u32], nodes: &[u32]) -> Result<Self, FaerError> {
        let graph = NodeGraph::new(column_ptr, rows, nodes).both_ways();
        let n = graph.len();
        let mut memory = MemBuffer::try_new(StackReq::any_of(&[
            amd::order_scratch::<u32>(n, graph.rows.len()),
            simplicial::prefactorize_symbolic_cholesky_scratch::<u32>(n, graph.rows.len()),
            qr::postorder_scratch::<u32>(n),
            supernodal::factorize_supernodal_symbolic_cholesky_scratch::<u32>(n),
        ]))?;
        let stack = MemStack::new(&mut memory);
        let [mut order, mut position, mut post, mut counts] = [(); 4].map(|()| vec![0; n]);
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &graph.column_ptr, None, &graph.rows);
        amd::order(&mut order, &mut position, pattern, amd::Control::default(), stack)?;
        let mut tree = vec![0; n];
        let (ptr, upper) = upper_pattern(&graph, &order);
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &ptr, None, &upper);
        let links = simplicial::prefactorize_symbolic_cholesky(&mut tree, &mut counts, pattern, stack);
        // A postorder of the elimination tree has the same fill and makes supernodes contiguous.
        qr::postorder(&mut post, links, stack);
        let order: Vec<u32> = post.iter().map(|k| order[*k as usize]).collect();
        let (ptr, upper) = upper_pattern(&graph, &order);
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &ptr, None, &upper);
        let links = simplicial::prefactorize_symbolic_cholesky(&mut tree, &mut counts, pattern, stack);
        let relaxation = SymbolicSupernodalParams { relax: Some(&RELAXATION) };
        let supernodes =
            supernodal::factorize_supernodal_symbolic_cholesky(pattern, links, &counts, stack, relaxation)?;
        let mut fronts = Self::of_unknowns(&graph, &order, &supernodes);
        fronts.column_ptr.extend_from_slice(column_ptr);
        fronts.rows.extend_from_slice(rows);
        fronts.nodes.extend_from_slice(nodes);
        Ok(fronts)
    }

    /// Expands supernodes of nodes to fronts of unknowns.
    fn of_unknowns(
        graph: &NodeGraph,
        node_order: &[u32],
        supernodes: &supernodal::SymbolicSupernodalCholesky<u32>,
    ) -> Self {
        let order: Vec<u32> = node_order.iter().flat_map(|node| graph.unknowns(*node)).copied().collect();
        let mut first_of_node = vec![0];
        for node in node_order {
            first_of_node.push(first_of_node[first_of_node.len() - 1] + graph.unknowns(*node).len());
        }
        let position = inverse(&order);
        let n_fronts = supernodes.n_supernodes();
        let (mut front_of_node, mut first, mut below_ptr) = (vec![n_fronts; node_order.len()], vec![0], vec![0]);
        let (mut below, mut block_ptr, mut lower_ptr) = (Vec::new(), vec![0], vec![0]);
        for (s, end) in supernodes.supernode_end().iter().enumerate() {
            let supernode = supernodes.supernode(s);
            front_of_node[supernode.start()..*end as usize].fill(s);
            first.push(first_of_node[*end as usize]);
            for node in supernode.pattern() {
                below.extend(first_of_node[*node as usize] as u32..first_of_node[*node as usize + 1] as u32);
            }
            below_ptr.push(below.len());
            let (n_pivots, n_below) = (first[s + 1] - first[s], below_ptr[s + 1] - below_ptr[s]);
            block_ptr.push(block_ptr[s] + n_pivots * n_pivots);
            lower_ptr.push(lower_ptr[s] + n_pivots * n_below);
        }
        let next = |s| supernodes.supernode(s).pattern().iter().min().map_or(n_fronts, |k| front_of_node[*k as usize]);
        let parent: Vec<usize> = (0..n_fronts).map(next).collect();
        let (column_ptr, rows, nodes) = Default::default();
        let mut fronts = Self {
            column_ptr,
            rows,
            nodes,
            order,
            position,
            first,
            below_ptr,
            below,
            block_ptr,
            lower_ptr,
            parent,
            most_updates: 0,
        };
        fronts.most_updates = fronts.count_updates();
        fronts
    }

    /// Returns the largest number of entries of update matrices stored at the same time. The updates of the children
    /// are released after the update of the parent is computed.
    fn count_updates(&self) -> usize {
        let mut of_children = vec![0; self.len() + 1];
        let (mut now, mut most) = (0, 0);
        for s in 0..self.len() {
            let own = self.below(s).len().pow(2);
            most = most.max(now + own);
            now = now + own - of_children[s];
            of_children[self.parent[s]] += own;
        }
        most
    }

    /// Returns whether these are the fronts of a matrix with this pattern and these nodes.
    pub(super) fn belong_to(&self, column_ptr: &[u32], rows: &[u32], nodes: &[u32]) -> bool {
        self.column_ptr == column_ptr && self.rows == rows && self.nodes == nodes
    }

    /// Returns the number of fronts.
    pub(super) fn len(&self) -> usize {
        self.parent.len()
    }

    /// Returns the positions of the pivots of a front.
    pub(super) fn pivots(&self, s: usize) -> Range<usize> {
        self.first[s]..self.first[s + 1]
    }

    /// Returns the positions of the other rows and columns of a front.
    pub(super) fn below(&self, s: usize) -> &[u32] {
        &self.below[self.below_ptr[s]..self.below_ptr[s + 1]]
    }

    /// Returns the range of the entries of a pivot block among those of all fronts.
    pub(super) fn block(&self, s: usize) -> Range<usize> {
        self.block_ptr[s]..self.block_ptr[s + 1]
    }

    /// Returns the range of the rows of L below a pivot block among those of all fronts.
    pub(super) fn lower(&self, s: usize) -> Range<usize> {
        self.lower_ptr[s]..self.lower_ptr[s + 1]
    }

    /// Returns the range of the columns of U to the right of a pivot block, where the last front comes first: a
    /// backward substitution reads memory in its order.
    pub(super) fn upper(&self, s: usize) -> Range<usize> {
        self.n_lower() - self.lower_ptr[s + 1]..self.n_lower() - self.lower_ptr[s]
    }

    /// Returns the number of entries of all pivot blocks.
    pub(super) fn n_blocks(&self) -> usize {
        self.block_ptr[self.len()]
    }

    /// Returns the number of entries of L below all pivot blocks. U has as many to their right.
    pub(super) fn n_lower(&self) -> usize {
        self.lower_ptr[self.len()]
    }
}

/// Returns the upper triangle of a symmetric pattern in another order, compressed by columns with sorted rows.
fn upper_pattern(graph: &NodeGraph, order: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let position = inverse(order);
    let (mut column_ptr, mut rows) = (vec![0], Vec::with_capacity(graph.rows.len() / 2 + order.len()));
    for (k, node) in order.iter().enumerate() {
        let begin = rows.len();
        let above = graph.neighbours(*node).iter().map(|other| position[*other as usize]);
        rows.extend(above.filter(|other| *other as usize <= k));
        rows[begin..].sort_unstable();
        column_ptr.push(rows.len() as u32);
    }
    (column_ptr, rows)
}
