//! Tables on the terminal.

use crate::compare::Compared;

/// Largest relative deviation that is round-off.
const ROUND_OFF: f64 = 1e-9;

/// Prints rows of cells under a headline, in columns.
pub(crate) fn print<const N: usize>(head: [&str; N], rows: impl Iterator<Item = [String; N]>) {
    let mut lines = vec![head.map(str::to_owned)];
    lines.extend(rows);
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(width);
    lines.insert(1, widths.map(|width| "-".repeat(width)));
    let text = lines.iter().map(|line| {
        let cells: Vec<String> = line.iter().zip(widths).map(|(cell, w)| format!("{cell:<w$}")).collect();
        format!("  {}\n", cells.join("  ").trim_end())
    });
    // At once, so that progress of other runs is not printed between the rows.
    print!("{}", text.collect::<String>());
}

/// Prints comparisons; `known` is the headline of the numbers to compare with.
pub(crate) fn print_comparisons(rows: &[Compared], known: &str) {
    let cells = rows.iter().map(|row| {
        let value = |x: f64| if row.is_property { yes_or_no(x) } else { short(x) };
        [
            row.quantity.clone(),
            row.known.map_or_else(dash, value),
            row.computed.map_or_else(dash, value),
            row.deviation.filter(|_| !row.is_property).map_or_else(dash, |d| deviation(d, row.known)),
            row.band.map_or_else(dash, |band| interval(band, value)),
            if row.passes() { "pass" } else { "fail" }.to_owned(),
        ]
    });
    print(["quantity", known, "computed", "deviation", "band", "verdict"], cells);
    for row in rows.iter().filter(|row| !row.passes()) {
        println!("  {}: the band is there because: {}", row.quantity, row.reason);
    }
}

fn dash() -> String {
    "-".to_owned()
}

fn yes_or_no(x: f64) -> String {
    if x == 0.0 { "no" } else { "yes" }.to_owned()
}

/// Formats a deviation with its sign; round-off is shown as zero.
fn deviation(d: f64, known: Option<f64>) -> String {
    match known {
        Some(known) if d.abs() <= ROUND_OFF * known.abs() => "0".to_owned(),
        _ => format!("{}{}", if d > 0.0 { "+" } else { "" }, short(d)),
    }
}

fn interval([low, high]: [f64; 2], value: impl Fn(f64) -> String) -> String {
    if low == high { value(low) } else { format!("{} to {}", value(low), value(high)) }
}

/// Returns a number with four significant digits, without an exponent from 1e-3 to 1e5.
pub(crate) fn short(x: f64) -> String {
    if x != 0.0 && !(1e-3..1e5).contains(&x.abs()) {
        return format!("{x:.3e}");
    }
    let digits = if x == 0.0 { 0 } else { (3 - x.abs().log10().floor() as i32).clamp(0, 9) };
    let text = format!("{x:.*}", digits as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let numbers = [(0.0, "0"), (17.27, "17.27"), (0.05, "0.05"), (3.8412, "3.841"), (-573.21, "-573.2")];
        for (x, text) in numbers.into_iter().chain([(-594.5, "-594.5"), (0.111, "0.111"), (1e-9, "1.000e-9")]) {
            assert_eq!(short(x), text);
        }
        assert_eq!(interval([0.108, 0.114], short), "0.108 to 0.114");
        assert_eq!(interval([1.0, 1.0], yes_or_no), "yes");
        assert_eq!((deviation(0.001, Some(0.111)), deviation(1e-17, Some(0.1))), ("+0.001".to_owned(), "0".to_owned()));
    }
}
