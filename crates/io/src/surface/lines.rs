//! Lines of surface files.

use std::str::SplitWhitespace;

/// Corners of a triangle.
pub(super) type Triangle = [[f64; 3]; 3];

/// Calls a closure with the words of each line. The number of the line is added to its errors.
pub(super) fn for_each_line(
    text: &str,
    mut read: impl FnMut(SplitWhitespace<'_>) -> Result<(), String>,
) -> Result<(), String> {
    text.lines()
        .enumerate()
        .try_for_each(|(k, line)| read(line.split_whitespace()).map_err(|what| format!("line {}: {what}", k + 1)))
}

pub(super) fn coordinates<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<[f64; 3], String> {
    let mut x = [0.0_f64; 3];
    for slot in &mut x {
        let word = words.next().ok_or("a vertex needs three coordinates")?;
        *slot = word.parse().map_err(|_| format!("`{word}` is not a number"))?;
        if !slot.is_finite() {
            return Err(format!("the coordinate `{word}` is not finite"));
        }
    }
    Ok(x)
}
