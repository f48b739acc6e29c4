//! Labels of units.

use cutwater::io::scenario::{Quantity, System, Units};

/// Quantities by the words of their marks, and whether they are totals per unit depth.
const MARKS: [(&str, Quantity, bool); 7] = [
    ("<length>", Quantity::LENGTH, false),
    ("<velocity>", Quantity::VELOCITY, false),
    ("<acceleration>", Quantity::ACCELERATION, false),
    ("<pressure>", Quantity::PRESSURE, false),
    ("<force>", Quantity::FORCE, true),
    ("<energy>", Quantity::ENERGY, true),
    ("<flux>", Quantity::FLUX, true),
];

/// Writes the units of plane problems in centimetres, grams and seconds in place of the marks of quantities, such as
/// `height [<length>]`. The cases of the paper, and the checks that call this, have these units.
pub(crate) fn cgs(text: &str) -> String {
    let units = Units::Plain(System::Cgs);
    let mut text = text.to_owned();
    for (mark, quantity, is_total) in MARKS {
        if text.contains(mark) {
            let label = if is_total { units.total_label(quantity, 2) } else { units.label(quantity) };
            text = text.replace(mark, &label);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::cgs;

    #[test]
    fn marks_become_units() {
        assert_eq!(cgs("a [<length>] b [<velocity>, <acceleration>]"), "a [cm] b [cm/s, cm/s²]");
        assert_eq!(cgs("[<pressure>] <force> <energy> <flux>"), "[dyn/cm²] dyn/cm erg/cm cm³/(s cm)");
    }
}
