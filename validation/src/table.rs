//! Tables of comparisons on the terminal.

use crate::compare::Row;

/// Relative deviation that counts as round-off.
const ROUND_OFF: f64 = 1e-9;

/// Prints rows; `known` is the headline of the numbers to compare with.
pub(crate) fn print(rows: &[Row], known: &str) {
    let mut cells = vec![["quantity", known, "computed", "deviation", "band", "verdict"].map(str::to_owned)];
    cells.extend(rows.iter().map(|row| {
        let value = |x: f64| if row.is_property { yes_or_no(x) } else { number(x) };
        let comparison = &row.comparison;
        [
            comparison.quantity.clone(),
            comparison.known.map_or_else(dash, value),
            comparison.computed.map_or_else(dash, value),
            comparison.deviation.filter(|_| !row.is_property).map_or_else(dash, |d| deviation(d, comparison.known)),
            comparison.band.map_or_else(dash, |band| interval(band, value)),
            if row.passes() { "pass" } else { "fail" }.to_owned(),
        ]
    }));
    let width = |column: usize| cells.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..6).map(width).collect();
    for (k, row) in cells.iter().enumerate() {
        let line: Vec<String> = row.iter().zip(&widths).map(|(cell, w)| format!("{cell:<w$}")).collect();
        println!("  {}", line.join("  ").trim_end());
        if k == 0 {
            println!("  {}", widths.iter().map(|w| "-".repeat(*w)).collect::<Vec<_>>().join("  "));
        }
    }
    for row in rows.iter().filter(|row| !row.passes()) {
        println!("  {}: the band is there because: {}", row.comparison.quantity, row.reason);
    }
}

fn dash() -> String {
    "-".to_owned()
}

fn yes_or_no(x: f64) -> String {
    if x == 0.0 { "no" } else { "yes" }.to_owned()
}

/// Formats a deviation with its sign; round-off counts as zero.
fn deviation(d: f64, known: Option<f64>) -> String {
    match known {
        Some(known) if d.abs() <= ROUND_OFF * known.abs() => "0".to_owned(),
        _ => format!("{}{}", if d > 0.0 { "+" } else { "" }, number(d)),
    }
}

fn interval([low, high]: [f64; 2], value: impl Fn(f64) -> String) -> String {
    if low == high { value(low) } else { format!("{} to {}", value(low), value(high)) }
}

/// Four significant digits, without an exponent where that is readable.
fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let magnitude = x.abs().log10().floor();
    if !(-4.0..6.0).contains(&magnitude) {
        return format!("{x:.3e}");
    }
    let text = format!("{x:.*}", (3.0 - magnitude).max(0.0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (x, text) in [(0.111, "0.111"), (3.8412, "3.841"), (-573.21, "-573.2"), (0.0, "0"), (1e-7, "1.000e-7")] {
            assert_eq!(number(x), text);
        }
        assert_eq!(interval([0.108, 0.114], number), "0.108 to 0.114");
        assert_eq!(interval([1.0, 1.0], yes_or_no), "yes");
        assert_eq!((deviation(0.001, Some(0.111)), deviation(1e-17, Some(0.1))), ("+0.001".to_owned(), "0".to_owned()));
    }
}
