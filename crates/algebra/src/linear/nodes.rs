//! The graph of the nodes of a matrix. A node is a group of unknowns with almost the same couplings.

use std::collections::VecDeque;

/// Unknowns of each node, and couplings of nodes by a matrix.
#[derive(Debug, Default)]
pub(super) struct NodeGraph {
    /// Node to its first position in `unknowns`; one longer than the number of nodes.
    pub(super) first: Vec<usize>,
    /// Unknowns, node by node.
    pub(super) unknowns: Vec<u32>,
    /// Node to its first neighbour; one longer than the number of nodes.
    pub(super) column_ptr: Vec<u32>,
    /// Neighbours of each node, itself included, ascending: the rows that its columns have entries in.
    pub(super) rows: Vec<u32>,
}

impl NodeGraph {
    /// Creates the graph of a square matrix compressed by columns, given by its pattern and the node of each unknown.
    pub(super) fn new(column_ptr: &[u32], rows: &[u32], nodes: &[u32]) -> Self {
        let n_nodes = nodes.iter().max().map_or(0, |last| *last as usize + 1);
        let mut first = vec![0; n_nodes + 1];
        for node in nodes {
            first[*node as usize + 1] += 1;
        }
        for node in 0..n_nodes {
            first[node + 1] += first[node];
        }
        let mut unknowns = vec![0; nodes.len()];
        let mut next = first.clone();
        for (unknown, node) in nodes.iter().enumerate() {
            unknowns[next[*node as usize]] = unknown as u32;
            next[*node as usize] += 1;
        }
        let mut graph = Self { first, unknowns, column_ptr: vec![0], rows: Vec::new() };
        let mut mark = vec![usize::MAX; n_nodes];
        for node in 0..n_nodes {
            let begin = graph.rows.len();
            for &column in &graph.unknowns[graph.first[node]..graph.first[node + 1]] {
                for row in &rows[column_ptr[column as usize] as usize..column_ptr[column as usize + 1] as usize] {
                    let neighbour = nodes[*row as usize];
                    if mark[neighbour as usize] != node {
                        mark[neighbour as usize] = node;
                        graph.rows.push(neighbour);
                    }
                }
            }
            graph.rows[begin..].sort_unstable();
            graph.column_ptr.push(graph.rows.len() as u32);
        }
        graph
    }

    /// Returns the graph with every coupling in both directions: that of `A + Aᵀ`.
    pub(super) fn both_ways(mut self) -> Self {
        let mut neighbours = vec![Vec::new(); self.len()];
        for node in 0..self.len() as u32 {
            for &other in self.neighbours(node) {
                neighbours[node as usize].push(other);
                neighbours[other as usize].push(node);
            }
        }
        self.rows.clear();
        self.column_ptr.truncate(1);
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
            self.rows.extend_from_slice(list);
            self.column_ptr.push(self.rows.len() as u32);
        }
        self
    }

    /// Returns the number of nodes.
    pub(super) fn len(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// Returns the unknowns of a node.
    pub(super) fn unknowns(&self, node: u32) -> &[u32] {
        &self.unknowns[self.first[node as usize]..self.first[node as usize + 1]]
    }

    /// Returns the neighbours of a node, itself included, ascending.
    pub(super) fn neighbours(&self, node: u32) -> &[u32] {
        &self.rows[self.column_ptr[node as usize] as usize..self.column_ptr[node as usize + 1] as usize]
    }

    /// Returns the nodes in reverse Cuthill-McKee order, in which coupled nodes are close to each other. The graph must
    /// have every coupling in both directions.
    ///
    /// Source: George and Liu 1981, Computer solution of large sparse positive definite systems, chapter 4.
    pub(super) fn reverse_cuthill_mckee(&self) -> Vec<u32> {
        let mut order: Vec<u32> = Vec::with_capacity(self.len());
        let mut is_placed = vec![false; self.len()];
        let mut level = vec![u32::MAX; self.len()];
        for start in 0..self.len() as u32 {
            if is_placed[start as usize] {
                continue;
            }
            let begin = order.len();
            self.visit(self.peripheral(start, &mut level), &mut order, &mut is_placed);
            debug_assert!(order.len() > begin);
        }
        order.reverse();
        order
    }

    /// Appends the nodes that can be reached, nearest first; among equally near ones those with few neighbours first.
    fn visit(&self, start: u32, order: &mut Vec<u32>, is_placed: &mut [bool]) {
        let mut next = order.len();
        order.push(start);
        is_placed[start as usize] = true;
        while next < order.len() {
            let begin = order.len();
            for &node in self.neighbours(order[next]) {
                if !std::mem::replace(&mut is_placed[node as usize], true) {
                    order.push(node);
                }
            }
            order[begin..].sort_by_key(|node| self.neighbours(*node).len());
            next += 1;
        }
    }

    /// Returns a pseudo-peripheral node among those that can be reached from `start`.
    fn peripheral(&self, start: u32, level: &mut [u32]) -> u32 {
        let (mut node, mut depth) = (start, None);
        loop {
            let (far, d) = self.farthest(node, level);
            if depth.is_some_and(|depth| d <= depth) {
                return node;
            }
            (node, depth) = (far, Some(d));
        }
    }

    /// Returns the node with the fewest neighbours among those farthest from `start`, and its distance.
    fn farthest(&self, start: u32, level: &mut [u32]) -> (u32, u32) {
        let mut queue = VecDeque::from([start]);
        let mut reached = vec![start];
        level[start as usize] = 0;
        while let Some(node) = queue.pop_front() {
            for &other in self.neighbours(node) {
                if level[other as usize] == u32::MAX {
                    level[other as usize] = level[node as usize] + 1;
                    queue.push_back(other);
                    reached.push(other);
                }
            }
        }
        let depth = reached.last().map_or(0, |node| level[*node as usize]);
        let rim = reached.iter().copied().filter(|node| level[*node as usize] == depth);
        let far = rim.min_by_key(|node| self.neighbours(*node).len()).unwrap_or(start);
        reached.iter().for_each(|node| level[*node as usize] = u32::MAX);
        (far, depth)
    }
}
