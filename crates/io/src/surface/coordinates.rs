//! Coordinates in lines of surface files.

use super::Malformed;

/// Three numbers from words of a line.
pub(super) fn coordinates<'a>(line: usize, mut words: impl Iterator<Item = &'a str>) -> Result<[f64; 3], Malformed> {
    let mut x = [0.0_f64; 3];
    for slot in &mut x {
        let word = words.next().ok_or_else(|| Malformed::line(line, "a vertex needs three coordinates"))?;
        *slot = word.parse().map_err(|_| Malformed::line(line, format!("`{word}` is not a number")))?;
        if !slot.is_finite() {
            return Err(Malformed::line(line, format!("the coordinate `{word}` is not finite")));
        }
    }
    Ok(x)
}
