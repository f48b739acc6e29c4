//! Dimensions of quantities, and the names of their units.

/// Dimension of a quantity: exponents of length, mass and time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Exponent of length.
    pub length: i8,
    /// Exponent of mass.
    pub mass: i8,
    /// Exponent of time.
    pub time: i8,
}

#[allow(missing_docs)] // each constant is the quantity that it names
impl Quantity {
    pub const NUMBER: Self = Self::new(0, 0, 0);
    pub const LENGTH: Self = Self::new(1, 0, 0);
    pub const MASS: Self = Self::new(0, 1, 0);
    pub const TIME: Self = Self::new(0, 0, 1);
    pub const VELOCITY: Self = Self::new(1, 0, -1);
    pub const ACCELERATION: Self = Self::new(1, 0, -2);
    /// Angular velocity.
    pub const RATE: Self = Self::new(0, 0, -1);
    pub const DENSITY: Self = Self::new(-3, 1, 0);
    /// Dynamic viscosity.
    pub const VISCOSITY: Self = Self::new(-1, 1, -1);
    pub const FORCE: Self = Self::new(1, 1, -2);
    /// Force per area: pressure, traction, stiffness.
    pub const PRESSURE: Self = Self::new(-1, 1, -2);
    /// Force per volume.
    pub const FORCE_DENSITY: Self = Self::new(-2, 1, -2);
    pub const ENERGY: Self = Self::new(2, 1, -2);
    pub const POWER: Self = Self::new(2, 1, -3);
    /// Volume per time.
    pub const FLUX: Self = Self::new(3, 0, -1);

    const fn new(length: i8, mass: i8, time: i8) -> Self {
        Self { length, mass, time }
    }

    /// Returns the unit in the system cgs (`system` 0) or SI (1); empty for pure numbers.
    pub(super) fn label_in(self, system: usize) -> String {
        let named = NAMED.iter().find(|(named, _)| *named == self);
        named.map_or_else(|| self.label_of(BASES[system]), |(_, names)| names[system].to_owned())
    }

    /// Returns the unit as a product of powers of units of mass, length and time; empty for pure numbers.
    pub(super) fn label_of(self, base: [&str; 3]) -> String {
        let exponents = [self.mass, self.length, self.time];
        let product = |sign: i8| {
            let factors = base.iter().zip(exponents).filter(|(_, exponent)| exponent * sign > 0);
            let powers = factors.map(|(unit, exponent)| match exponent.abs() {
                1 => (*unit).to_owned(),
                2 => format!("{unit}²"),
                3 => format!("{unit}³"),
                n => format!("{unit}^{n}"),
            });
            powers.collect::<Vec<String>>()
        };
        quotient(&product(1).join(" "), &product(-1))
    }
}

/// Quantities with unit names of their own in the systems cgs and SI.
const NAMED: [(Quantity, [&str; 2]); 6] = [
    (Quantity::FORCE, ["dyn", "N"]),
    (Quantity::PRESSURE, ["dyn/cm²", "Pa"]),
    (Quantity::FORCE_DENSITY, ["dyn/cm³", "N/m³"]),
    (Quantity::VISCOSITY, ["poise", "Pa s"]),
    (Quantity::ENERGY, ["erg", "J"]),
    (Quantity::POWER, ["erg/s", "W"]),
];

/// Units of mass, length and time in the systems cgs and SI.
const BASES: [[&str; 3]; 2] = [["g", "cm", "s"], ["kg", "m", "s"]];

/// Returns the text of a quotient of products.
pub(super) fn quotient(above: &str, below: &[String]) -> String {
    match below {
        [] => above.to_owned(),
        [one] => format!("{}/{one}", if above.is_empty() { "1" } else { above }),
        _ => format!("{}/({})", if above.is_empty() { "1" } else { above }, below.join(" ")),
    }
}
