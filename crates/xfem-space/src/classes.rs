//! Disjoint classes of numbers.

/// Disjoint classes of the numbers `0..n`, merged pair by pair (union-find). The lowest member stands for its class,
/// so that the result does not depend on the order of the merges.
#[derive(Clone, Debug)]
pub struct Classes {
    parent: Vec<u32>,
}

impl Classes {
    /// Creates `n` classes with one number each.
    pub fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    /// Returns the lowest member of the class of a number.
    pub fn lowest(&mut self, member: u32) -> u32 {
        let mut lowest = member;
        while self.parent[lowest as usize] != lowest {
            lowest = self.parent[lowest as usize];
        }
        let mut walk = member;
        while self.parent[walk as usize] != lowest {
            walk = std::mem::replace(&mut self.parent[walk as usize], lowest);
        }
        lowest
    }

    /// Merges the classes of two numbers.
    pub fn merge(&mut self, a: u32, b: u32) {
        let (a, b) = (self.lowest(a), self.lowest(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_member_stands_for_the_class() {
        let mut classes = Classes::new(7);
        for (a, b) in [(6, 5), (5, 2), (4, 3), (3, 6)] {
            classes.merge(a, b);
        }
        let lowest: Vec<u32> = (0..7).map(|k| classes.lowest(k)).collect();
        assert_eq!(lowest, [0, 1, 2, 2, 2, 2, 2]);
    }
}
