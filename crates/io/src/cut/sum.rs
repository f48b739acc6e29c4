//! Sums of many numbers whose round-off does not grow with their count.

/// A sum with the round-off of its additions (Neumaier 1974).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sum {
    value: f64,
    lost: f64,
}

impl Sum {
    /// Adds a number.
    pub(super) fn add(&mut self, number: f64) {
        let sum = self.value + number;
        let (large, small) = if self.value.abs() >= number.abs() { (self.value, number) } else { (number, self.value) };
        self.lost += (large - sum) + small;
        self.value = sum;
    }

    /// The sum.
    pub(super) fn total(self) -> f64 {
        self.value + self.lost
    }

    /// The sum of all numbers of a sequence.
    pub(super) fn of(numbers: impl IntoIterator<Item = f64>) -> f64 {
        let mut sum = Self::default();
        numbers.into_iter().for_each(|number| sum.add(number));
        sum.total()
    }
}

#[cfg(test)]
mod tests {
    use super::Sum;

    #[test]
    fn small_numbers_are_not_lost_beside_large_ones() {
        assert_eq!(Sum::of([1.0, 1e100, 1.0, -1e100]), 2.0);
        assert_eq!(Sum::of(std::iter::repeat_n(0.1, 1_000_000)), 100_000.0);
        assert_eq!(Sum::of([]), 0.0);
    }
}
