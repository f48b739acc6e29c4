//! Units: labels of the numbers of a scenario. No number is converted.

use super::error::ScenarioError;
use super::quantity::{Quantity, quotient};
use super::table::{At, OrTable, choices, keys};

choices! {
    /// System of units.
    #[derive(Copy, Eq)]
    pub enum System {
        /// Centimetre, gram, second: dyn, erg, poise.
        Cgs = "cgs",
        /// Metre, kilogram, second: N, J, Pa.
        Si = "si",
        /// Millimetre, gram, second, without names of their own for derived quantities.
        MmGS = "mm-g-s",
    }
}

keys! {
    /// Names of three base units.
    pub struct UnitNames {
        /// Unit of length, such as `"mm"`.
        length: At<String>,
        /// Unit of mass, such as `"g"`.
        mass: At<String>,
        /// Unit of time, such as `"ms"`.
        time: At<String>,
    }
}

/// Units of all numbers of a scenario.
pub type Units = OrTable<System, UnitNames>;

impl Units {
    /// Checks that the names of units can be part of the names of columns.
    pub(super) fn check(&self) -> Result<(), ScenarioError> {
        let Self::Table(UnitNames { length, mass, time }) = self else { return Ok(()) };
        let is_bad = |name: &&At<String>| {
            name.trim().is_empty() || name.contains([',', '"', '[', ']']) || name.contains(char::is_control)
        };
        let refuse = |name: &At<String>| {
            let found = if name.trim().is_empty() { "empty".to_owned() } else { format!("`{}`", **name) };
            name.at.invalid(format!("the name of this unit is {found}; use letters and digits, such as \"mm\""))
        };
        [length, mass, time].into_iter().find(is_bad).map_or(Ok(()), |name| Err(refuse(name)))
    }

    /// Returns the unit of a quantity, such as `cm/s` or `dyn`; empty for pure numbers.
    pub fn label(&self, quantity: Quantity) -> String {
        match self {
            Self::Plain(System::MmGS) => quantity.label_of(["g", "mm", "s"]),
            Self::Plain(system) => quantity.label_in(*system as usize),
            Self::Table(names) => quantity.label_of([names.mass.as_str(), &names.length, &names.time]),
        }
    }

    /// Returns the unit of a force, mass, energy, power or flow of a domain of `dimension`. In 2D it is per unit depth.
    pub fn total_label(&self, quantity: Quantity, dimension: usize) -> String {
        self.per_depth(self.label(quantity), dimension)
    }

    /// Returns the unit of a moment. Where energies have a name of their own it is another one. In 2D it is per unit
    /// depth.
    pub fn moment_label(&self, dimension: usize) -> String {
        let [force, length, energy] = [Quantity::FORCE, Quantity::LENGTH, Quantity::ENERGY].map(|of| self.label(of));
        let is_named = matches!(self, Self::Plain(System::Cgs | System::Si));
        self.per_depth(if is_named { format!("{force} {length}") } else { energy }, dimension)
    }

    fn per_depth(&self, label: String, dimension: usize) -> String {
        if dimension == 3 {
            return label;
        }
        let (above, below) = label.split_once('/').unwrap_or((&label, ""));
        let below = [below.to_owned(), self.label(Quantity::LENGTH)];
        quotient(above, &below.into_iter().filter(|unit| !unit.is_empty()).collect::<Vec<_>>())
    }
}

/// Rounds a positive number down to two significant digits.
pub(crate) fn rounded_down(value: f64) -> f64 {
    let of = |value: f64| format!("{value:.1e}").parse().unwrap_or(value);
    let nearest = of(value);
    if nearest <= value { nearest } else { of(nearest - 0.1 * 10_f64.powf(value.log10().floor())) }
}

/// Rounds to four significant digits, without the sign of zero.
pub(crate) fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_down_to_two_digits() {
        for (value, rounded) in [(0.01671, 0.016), (0.0160001, 0.016), (0.00999, 0.0099), (1.0, 1.0), (99.99, 99.0)] {
            assert_eq!(rounded_down(value), rounded, "{value}");
        }
    }

    #[test]
    fn labels_follow_from_the_base_units() {
        let [length, mass, time] = ["mm", "g", "ms"].map(|name| At::nowhere(name.to_owned()));
        let named = UnitNames { length, mass, time };
        let (cgs, si, own) = (Units::Plain(System::Cgs), Units::Plain(System::Si), Units::Table(named));
        assert_eq!(Units::Plain(System::MmGS).label(Quantity::PRESSURE), "g/(mm s²)");
        for (quantity, labels) in [
            (Quantity::NUMBER, ["", "", ""]),
            (Quantity::VELOCITY, ["cm/s", "m/s", "mm/ms"]),
            (Quantity::DENSITY, ["g/cm³", "kg/m³", "g/mm³"]),
            (Quantity::RATE, ["1/s", "1/s", "1/ms"]),
            (Quantity::FORCE, ["dyn", "N", "g mm/ms²"]),
            (Quantity::PRESSURE, ["dyn/cm²", "Pa", "g/(mm ms²)"]),
        ] {
            assert_eq!([cgs.label(quantity), si.label(quantity), own.label(quantity)], labels);
        }
        assert_eq!(cgs.total_label(Quantity::POWER, 2), "erg/(s cm)");
        assert_eq!(cgs.total_label(Quantity::FORCE, 2), "dyn/cm");
        assert_eq!(own.total_label(Quantity::FORCE, 2), "g mm/(ms² mm)");
        assert_eq!(si.total_label(Quantity::ENERGY, 3), "J");
        assert_eq!([3, 2].map(|dimension| si.moment_label(dimension)), ["N m", "N m/m"]);
        assert_eq!(own.moment_label(3), "g mm²/ms²");
    }
}
